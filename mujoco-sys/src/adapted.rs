//! Functions whose parameters, and values whose place in the engine's structs, differ between
//! versions of the engine. They have one signature for all versions, and raise no error.
//!
//! # Safety of all functions in this module
//!
//! Pointers and indices are valid as for the C function or field that the documentation names.

use std::os::raw::{c_char, c_int};

use crate::{
    mjContact, mjData, mjModel, mjOption, mjSolverStat, mjtByte, mjtNum, mjvCamera, mjvGLCamera, mjvGeom, mjvLight,
    mjvOption, mjvPerturb, mjvScene,
};

/// Row of a matrix: `count` values at `values`, in the columns `columns`, or in all columns if that
/// is null.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Values.
    pub values: *const mjtNum,
    /// Columns of the values, or null for a dense row.
    pub columns: *const c_int,
    /// Number of values.
    pub count: c_int,
}

/// Normals and texture coordinates of a mesh, as ranges of `mesh_normal` and `mesh_texcoord`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct MeshFaces {
    /// First normal.
    pub normaladr: c_int,
    /// Number of normals.
    pub normalnum: c_int,
    /// First texture coordinates.
    pub texcoordadr: c_int,
    /// Number of texture coordinates.
    pub texcoordnum: c_int,
    /// Three indices of normals for each face, relative to the first normal.
    pub facenormal: *const c_int,
    /// Three indices of texture coordinates for each face, relative to the first; null without
    /// texture coordinates.
    pub facetexcoord: *const c_int,
}

/// Texture of a geom of a scene. Since 3.2 only the material is known, whose texture is that of the
/// model.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SceneTexture {
    /// Material, or -1.
    pub material: c_int,
    /// Texture, or -1.
    pub texture: c_int,
    /// `texrepeat`.
    pub repeat: [f32; 2],
    /// `texuniform`.
    pub uniform: c_int,
}

/// Projection of a camera of a scene.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SceneProjection {
    /// Half the width of the near plane, or 0 if it follows from the aspect ratio (`frustum_width`,
    /// since 3.0).
    pub half_width: f32,
    /// 1 for an orthographic projection (since 3.2), else 0.
    pub orthographic: c_int,
}

/// Flex of a scene.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SceneFlex {
    /// Positions of the vertices; 3 `vertnum`.
    pub vert: *const f32,
    /// Number of vertices.
    pub vertnum: c_int,
    /// Vertices of the edges; 2 `edgenum`.
    pub edge: *const c_int,
    /// Number of edges.
    pub edgenum: c_int,
    /// Positions of the corners of the faces; 9 `facenum`.
    pub face: *const f32,
    /// Normals at the corners of the faces; 9 `facenum`.
    pub normal: *const f32,
    /// Texture coordinates of the corners of the faces; 6 `facenum`.
    pub texcoord: *const f32,
    /// Number of faces in use.
    pub facenum: c_int,
    /// 1 if the engine's renderer draws the vertices, else 0.
    pub shows_vertices: c_int,
    /// 1 if the engine's renderer draws the edges, else 0.
    pub shows_edges: c_int,
}

/// Side of a contact: a geom, or a flex with an element or a vertex. Absent parts are -1.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ContactSide {
    /// Geom.
    pub geom: c_int,
    /// Flex.
    pub flex: c_int,
    /// Element of the flex.
    pub elem: c_int,
    /// Vertex of the flex.
    pub vert: c_int,
}

/// Options that only some versions have, or whose names differ.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct AdaptedOptions {
    /// `apirate`; 100 since 3.3.7.
    pub apirate: mjtNum,
    /// `mpr_tolerance`, `ccd_tolerance` since 3.2.
    pub ccd_tolerance: mjtNum,
    /// `ls_tolerance`, since 3.0.
    pub ls_tolerance: mjtNum,
    /// `o_friction`, since 3.0.
    pub o_friction: [mjtNum; 5],
    /// `mpr_iterations`, `ccd_iterations` since 3.2.
    pub ccd_iterations: c_int,
    /// `collision`; since 3.0 `mjCOL_ALL`.
    pub collision: c_int,
    /// `ls_iterations`, since 3.0.
    pub ls_iterations: c_int,
    /// `sdf_iterations`, since 3.0.
    pub sdf_iterations: c_int,
    /// `sdf_initpoints`, since 3.0.
    pub sdf_initpoints: c_int,
    /// `disableactuator`, since 3.0.1.
    pub disableactuator: c_int,
}

macro_rules! adapted {
    ($($(#[$doc:meta])* $shim:ident = $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)?;)*) => {
        unsafe extern "C" {
            $(
                $(#[$doc])*
                #[link_name = stringify!($shim)]
                pub fn $name($($argument: $type),*) $(-> $result)?;
            )*
        }
    };
}

adapted! {
    /// Calls `mj_fullM`.
    mujoco_sys_fullM = full_m(m: *const mjModel, d: *const mjData, dst: *mut mjtNum);
    /// Calls `mj_rayMesh`.
    mujoco_sys_rayMesh = ray_mesh(
        m: *const mjModel, d: *const mjData, geom: c_int, point: *const mjtNum, vector: *const mjtNum,
    ) -> mjtNum;
    /// Calls `mj_rayHfield`.
    mujoco_sys_rayHfield = ray_hfield(
        m: *const mjModel, d: *const mjData, geom: c_int, point: *const mjtNum, vector: *const mjtNum,
    ) -> mjtNum;
    /// Calls `mju_rayGeom`.
    mujoco_sys_rayGeom = ray_geom(
        pos: *const mjtNum, mat: *const mjtNum, size: *const mjtNum, point: *const mjtNum, vector: *const mjtNum,
        geomtype: c_int,
    ) -> mjtNum;
    /// Calls `mju_rotVecMat` (`mju_mulMatVec3` since 3.2.5).
    mujoco_sys_rotVecMat = rot_vec_mat(res: *mut mjtNum, vec: *const mjtNum, mat: *const mjtNum);
    /// Calls `mju_rotVecMatT` (`mju_mulMatTVec3` since 3.2.5).
    mujoco_sys_rotVecMatT = rot_vec_mat_t(res: *mut mjtNum, vec: *const mjtNum, mat: *const mjtNum);
    /// Writes the row of `actuator_moment` for an actuator.
    mujoco_sys_momentRow = moment_row(m: *const mjModel, d: *const mjData, actuator: c_int, row: *mut Row);
    /// Writes the row of `ten_J` for a tendon, in the layout of the present options.
    mujoco_sys_tendonRow = tendon_row(m: *const mjModel, d: *const mjData, tendon: c_int, row: *mut Row);
    /// Computes `actuator_velocity` from the moments. The model has one control and one force for
    /// each actuator.
    mujoco_sys_actuatorVelocity = actuator_velocity(m: *const mjModel, d: *mut mjData);
    /// Writes the row of the factor L in `qLD` without its diagonal of ones. The count is -1 for
    /// engines before 3.3.3 except 3.3.0, which store L with `dof_Madr` and `dof_parentid`.
    mujoco_sys_factorRow = factor_row(m: *const mjModel, d: *const mjData, dof: c_int, row: *mut Row);
    /// Writes the row of the lower triangle of the inertia matrix `M`, with the diagonal element
    /// last. The count is -1 for engines before 3.10, which store `qM` with `dof_Madr` and
    /// `dof_parentid`.
    mujoco_sys_inertiaRow = inertia_row(m: *const mjModel, d: *const mjData, dof: c_int, row: *mut Row);
    /// Returns the stored elements of the inertia matrix, `qM` (`M` since 3.10).
    mujoco_sys_inertia = inertia(d: *const mjData) -> *const mjtNum;
    /// Returns the number of the stored elements of the inertia matrix, `nM` (`nC` since 3.10).
    mujoco_sys_inertiaLength = inertia_len(m: *const mjModel) -> c_int;
    /// Reads the offset of the selected point's target from that of the centre of mass (3) and the
    /// inertia at the point (1), which newer engines have; 4 numbers, else unchanged.
    mujoco_sys_getGrip = get_grip(pert: *const mjvPerturb, grip: *mut mjtNum);
    /// Writes these four numbers.
    mujoco_sys_setGrip = set_grip(pert: *mut mjvPerturb, grip: *const mjtNum);
    /// Returns the flags of the equality constraints that are enforced, `eq_active`, or since 3.0
    /// enforced initially, `eq_active0`; neq.
    mujoco_sys_equalityActive = equality_active(m: *const mjModel) -> *mut mjtByte;
    /// Returns 1 if an equality constraint is enforced (`mjModel.eq_active`, since 3.0
    /// `mjData.eq_active`), else 0.
    mujoco_sys_equalityEnforced = equality_enforced(m: *const mjModel, d: *const mjData, equality: c_int) -> c_int;
    /// Returns 1 if an equality constraint couples sites instead of bodies (`eq_objtype`, since
    /// 3.2.3), else 0.
    mujoco_sys_equalityCouplesSites = equality_couples_sites(m: *const mjModel, equality: c_int) -> c_int;
    /// Returns the address of an actuator's activation (`actuator_actadr` since 2.3.7), or -1.
    mujoco_sys_activation = activation(m: *const mjModel, actuator: c_int) -> c_int;
    /// Writes the normals and texture coordinates of a mesh. Before 2.3.3 they are those of its
    /// vertices.
    mujoco_sys_meshFaces = mesh_faces(m: *const mjModel, mesh: c_int, result: *mut MeshFaces);
    /// Returns the pixels of all textures, `tex_rgb` (`tex_data` since 3.2.1); ntexdata.
    mujoco_sys_textureBytes = texture_bytes(m: *const mjModel) -> *mut mjtByte;
    /// Returns the number of bytes of a texture's pixels (`tex_nchannel`): 3 before 3.2.1.
    mujoco_sys_textureChannels = texture_channels(m: *const mjModel, texture: c_int) -> c_int;
    /// Returns the texture for the colour of a material, or -1 (`mat_texid`).
    mujoco_sys_materialTexture = material_texture(m: *const mjModel, material: c_int) -> c_int;
    /// Returns 1 if a light is directional (`light_directional`, `light_type` since 3.3.3), else 0.
    mujoco_sys_lightDirectional = light_directional(m: *const mjModel, light: c_int) -> c_int;
    /// Makes a light directional, or else a spotlight.
    mujoco_sys_setLightDirectional = set_light_directional(m: *mut mjModel, light: c_int, directional: c_int);
    /// Returns the rest length of a tendon's spring (`tendon_lengthspring`): one number, or since
    /// 2.3 the two ends of a range.
    mujoco_sys_tendonRestLength = tendon_rest_length(m: *const mjModel, tendon: c_int, count: *mut c_int) -> *mut mjtNum;
    /// Returns the number of the solver's recorded iterations for an island, and writes the place
    /// of their statistics (`solver`). Returns 0 if the engine records none for this island.
    /// Without islands, all constraints are those of the first one.
    mujoco_sys_solverIterations = solver_iterations(
        d: *const mjData, island: c_int, statistics: *mut *const mjSolverStat,
    ) -> c_int;
    /// Returns the texture of a geom of a scene (`texid`, `texrepeat`, `texuniform`; `matid` since
    /// 3.2).
    mujoco_sys_sceneGeomTexture = scene_geom_texture(geom: *const mjvGeom) -> SceneTexture;
    /// Sets the texture of a geom of a scene. Returns 0 if a geom without a material cannot have a
    /// texture, which is so since 3.2.
    mujoco_sys_setSceneGeomTexture = set_scene_geom_texture(geom: *mut mjvGeom, texture: *const SceneTexture) -> c_int;
    /// Returns the kind of a light of a scene (`directional`, `type` since 3.3.3): 0 for a spot
    /// light, 1 for a directional light, 2 for one that the engine's OpenGL renderer does not draw.
    mujoco_sys_sceneLightKind = scene_light_kind(light: *const mjvLight) -> c_int;
    /// Returns 1 if a geom of a scene casts shadows (not decoration since 3.0.1; `castshadow` since
    /// 4.0), else 0.
    mujoco_sys_sceneGeomCastsShadow = scene_geom_casts_shadow(geom: *const mjvGeom) -> c_int;
    /// Sets a keyframe to the state of the data (`mj_setKeyframe`). Returns 0, or -1 with engines
    /// before 3.2, which have no such function.
    mujoco_sys_setKeyframe = set_keyframe(m: *mut mjModel, d: *const mjData, key: c_int) -> c_int;
    /// Returns the texture that the engine's OpenGL renderer draws on a material, or -1: since
    /// 3.2.1 that of the base colour only.
    mujoco_sys_drawnTexture = drawn_texture(m: *const mjModel, material: c_int) -> c_int;
    /// Returns 1 if the engine converts the pixels of a texture from the sRGB colour space
    /// (`colorspace`, since 3.3.3), else 0.
    mujoco_sys_textureIsSrgb = texture_is_srgb(m: *const mjModel, texture: c_int) -> c_int;
    /// Sets the projection of a camera to that of the free camera of a model (`orthographic`, since
    /// 3.2).
    mujoco_sys_setFreeProjection = set_free_projection(camera: *mut mjvCamera, m: *const mjModel);
    /// Returns the projection of a camera of a scene.
    mujoco_sys_sceneProjection = scene_projection(camera: *const mjvGLCamera) -> SceneProjection;
    /// Sets the projection of a camera of a scene. Returns 0 if the engine has no such projection.
    mujoco_sys_setSceneProjection = set_scene_projection(camera: *mut mjvGLCamera, projection: *const SceneProjection) -> c_int;
    /// Returns 1 if a scene had too few places for the geoms of the last update or addition, for
    /// engines that record it in the scene (since 3.3.7).
    mujoco_sys_sceneIsFull = scene_is_full(scn: *const mjvScene) -> c_int;
    /// Returns the number of flexes of a scene: 0 before 3.0.
    mujoco_sys_sceneFlexes = scene_flexes(scn: *const mjvScene) -> c_int;
    /// Writes a flex of a scene.
    mujoco_sys_sceneFlex = scene_flex(scn: *const mjvScene, flex: c_int, result: *mut SceneFlex);
    /// Sets the positions of the flexes of a new scene to zero and removes their faces, which
    /// `mjv_makeScene` leaves uninitialised.
    mujoco_sys_clearSceneFlexes = clear_scene_flexes(m: *const mjModel, scn: *mut mjvScene);
    /// Sets the visible groups of flexes (`flexgroup`, since 3.0); mjNGROUP.
    mujoco_sys_setFlexGroups = set_flex_groups(opt: *mut mjvOption, groups: *const mjtByte);
    /// Sets the visible layer of three-dimensional flexes (`flex_layer`) and the visible depth of
    /// bounding volumes (`bvh_depth`), since 3.0.
    mujoco_sys_setLayers = set_layers(opt: *mut mjvOption, flex_layer: c_int, bvh_depth: c_int);
    /// Returns the state of the plugins (`plugin_state`, since 2.3), or null.
    mujoco_sys_pluginState = plugin_state(d: *const mjData) -> *mut mjtNum;
    /// Returns the length of the state of the plugins, `npluginstate`.
    mujoco_sys_pluginStateLength = plugin_state_len(m: *const mjModel) -> usize;
    /// Returns 1 if an instance of a plugin has a function that resets its state, else 0: the
    /// engine then leaves the state as it finds the memory.
    mujoco_sys_pluginHasReset = plugin_has_reset(m: *const mjModel, instance: c_int) -> c_int;
    /// Returns the plastic deformation of the flexes (`plastic`, since 4.0), or null.
    mujoco_sys_plastic = plastic(d: *const mjData) -> *mut mjtNum;
    /// Returns the length of the plastic deformation of the flexes, `nplastic`.
    mujoco_sys_plasticLength = plastic_len(m: *const mjModel) -> usize;
    /// Returns side 0 or 1 of a contact (`geom1`, `geom2`; `geom`, `flex`, `elem`, `vert` since
    /// 3.0).
    mujoco_sys_contactSide = contact_side(contact: *const mjContact, side: c_int) -> ContactSide;
    /// Sets the fields of a contact between `geom1` and `geom2` that 2.2.2 does not have.
    mujoco_sys_completeContact = complete_contact(contact: *mut mjContact);
    /// Returns the buffers of delays (`history`, since 3.5), or null.
    mujoco_sys_history = history(d: *const mjData) -> *mut mjtNum;
    /// Returns the length of the buffers of delays (`nhistory`, since 3.5), or 0.
    mujoco_sys_historyLength = history_len(m: *const mjModel) -> c_int;
    /// Writes the controls of an actuator at a time, from its buffer of delays (`mj_readCtrl`,
    /// since 3.5). Without a buffer, the present controls.
    mujoco_sys_readCtrl = read_ctrl(
        m: *const mjModel, d: *const mjData, id: c_int, time: mjtNum, interp: c_int, result: *mut mjtNum,
    );
    /// Writes the reading of a sensor at a time, likewise (`mj_readSensor`, since 3.5).
    mujoco_sys_readSensor = read_sensor(
        m: *const mjModel, d: *const mjData, id: c_int, time: mjtNum, interp: c_int, result: *mut mjtNum,
    );
    /// Sets the controls to their neutral values (`mj_resetCtrl`, since 3.11), zero before.
    mujoco_sys_resetCtrl = reset_ctrl(m: *const mjModel, d: *mut mjData);
    /// Returns the name of an input of an actuator (`mj_actuatorInputName`, since 3.11), or null.
    mujoco_sys_actuatorInputName = actuator_input_name(m: *const mjModel, id: c_int, input: c_int) -> *const c_char;
    /// Returns 1 if a point is inside a site (`mj_insideSite`, since 3.13), else 0; -1 before 3.13.
    mujoco_sys_insideSite = inside_site(
        m: *const mjModel, d: *const mjData, site: c_int, point: *const mjtNum,
    ) -> c_int;
    /// Returns the distance at which a ray hits a flex, or -1 (`mju_rayFlex` since 3.0,
    /// `mj_rayFlex` since 3.5), and writes the nearest vertex.
    mujoco_sys_rayFlex = ray_flex(
        m: *const mjModel, d: *const mjData, layer: c_int, vertices: c_int, edges: c_int, faces: c_int, skin: c_int,
        flex: c_int, point: *const mjtNum, vector: *const mjtNum, vertex: *mut c_int,
    ) -> mjtNum;
    /// Returns the root of the first kinematic tree that sleeps initially (`mjSLEEP_INIT`, since
    /// 3.4), or -1.
    mujoco_sys_initiallyAsleep = initially_asleep(m: *const mjModel) -> c_int;
    /// Returns 1 if the kinematic tree of a body sleeps (`tree_asleep`, since 3.4), else 0.
    mujoco_sys_isAsleep = is_asleep(m: *const mjModel, d: *const mjData, body: c_int) -> c_int;
    /// Wakes all kinematic trees (since 3.4), and returns the number of those that slept. If
    /// `recompute_static` is 1, the next call that computes poses also computes those of static
    /// bodies.
    mujoco_sys_wake = wake(m: *const mjModel, d: *mut mjData, recompute_static: c_int) -> c_int;
    /// Reads the options that only some versions have, or the defaults of those that the engine
    /// does not have.
    mujoco_sys_getOptions = get_options(opt: *const mjOption, options: *mut AdaptedOptions);
    /// Writes those of the options that the engine has.
    mujoco_sys_setOptions = set_options(opt: *mut mjOption, options: *const AdaptedOptions);
    /// Returns the number of stored elements of the sparse constraint Jacobian (`nnzJ`, or `nJ`
    /// since 3.2.5), or 0 before 2.3.
    mujoco_sys_jacobianElements = jacobian_elements(d: *const mjData) -> c_int;
    /// Disables the islands of a model with flexes with 3.3.4 to 3.5, which write out of bounds if
    /// the rows of a contact belong to different trees.
    mujoco_sys_disableUnsafeIslands = disable_unsafe_islands(m: *mut mjModel);
    /// Returns the bytes of the stack, or since 2.3 of the arena that contains the stack.
    mujoco_sys_arenaBytes = arena_bytes(d: *const mjData) -> usize;
}
