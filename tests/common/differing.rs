//! Functions and fields of the C API whose parameters, names or layout differ between versions of
//! the engine. They access the engine directly and not through the shim, so that tests can compare
//! the shim's adaptations with them.
//!
//! # Safety of all functions
//!
//! Pointers are valid as for the C function, and arrays have the engine's sizes.

#![allow(dead_code, reason = "each program uses only some of the functions")]

use mujoco_safe::sys::{
    self, mjData, mjModel, mjOption, mjvCamera, mjvGeom, mjvLight, mjvOption, mjvPerturb, mjvScene,
};

/// Calls a function whose last argument is new in 3.5.0: the address of a normal.
macro_rules! ray {
    ($function:ident($($argument:expr),*)) => {{
        #[cfg(engine_since = "3.5.0")]
        let distance = sys::$function($($argument,)* std::ptr::null_mut());
        #[cfg(not(engine_since = "3.5.0"))]
        let distance = sys::$function($($argument),*);
        distance
    }};
}

/// Calls `mj_step2`. In 3.5.0 it does not clear the flag by which sensors use the forces on bodies
/// a second time, and they would be those of the previous step.
pub(crate) unsafe fn step2(m: *const mjModel, d: *mut mjData) {
    // SAFETY: the caller's promise.
    unsafe {
        #[cfg(all(engine_since = "3.5.0", not(engine_since = "3.17.0")))]
        ((*d).flg_rnepost = 0);
        sys::mj_step2(m, d);
    }
}

/// Calls `mj_ray`.
pub(crate) unsafe fn ray(
    (m, d): (*const mjModel, *const mjData),
    [point, direction]: [*const f64; 2],
    groups: *const u8,
    with_static: bool,
    body: i32,
    geom: &mut i32,
) -> f64 {
    // SAFETY: the caller's promise.
    unsafe { ray!(mj_ray(m, d, point, direction, groups, with_static.into(), body, geom)) }
}

/// Calls `mj_rayMesh`.
pub(crate) unsafe fn ray_mesh(
    m: *const mjModel,
    d: *const mjData,
    geom: i32,
    [point, direction]: [*const f64; 2],
) -> f64 {
    // SAFETY: the caller's promise.
    unsafe { ray!(mj_rayMesh(m, d, geom, point, direction)) }
}

/// Calls `mj_rayHfield`.
pub(crate) unsafe fn ray_hfield(
    m: *const mjModel,
    d: *const mjData,
    geom: i32,
    [point, direction]: [*const f64; 2],
) -> f64 {
    // SAFETY: the caller's promise.
    unsafe { ray!(mj_rayHfield(m, d, geom, point, direction)) }
}

/// Calls `mju_rayGeom`.
pub(crate) unsafe fn ray_geom(
    [pos, mat, size]: [*const f64; 3],
    [point, direction]: [*const f64; 2],
    geom_type: i32,
) -> f64 {
    // SAFETY: the caller's promise.
    unsafe { ray!(mju_rayGeom(pos, mat, size, point, direction, geom_type)) }
}

/// Writes the full inertia matrix with `mj_fullM`.
pub(crate) unsafe fn full_m(m: *const mjModel, d: *const mjData, full: &mut [f64]) {
    // SAFETY: the caller's promise.
    unsafe {
        #[cfg(engine_since = "3.10.0")]
        sys::mj_fullM(m, d, full.as_mut_ptr());
        #[cfg(not(engine_since = "3.10.0"))]
        sys::mj_fullM(m, full.as_mut_ptr(), (*d).qM);
    }
}

/// Returns the sum of the numbers of the solver's iterations: one number, and since 3.0.0 one for
/// each island.
pub(crate) fn solver_iterations(d: &mjData) -> i32 {
    #[cfg(engine_since = "3.0.0")]
    return d.solver_niter.iter().sum();
    #[cfg(not(engine_since = "3.0.0"))]
    return d.solver_iter;
}

/// Returns the pixels of all textures.
pub(crate) fn texture_bytes(m: &mjModel) -> *const u8 {
    #[cfg(engine_since = "3.2.1")]
    return m.tex_data;
    #[cfg(not(engine_since = "3.2.1"))]
    return m.tex_rgb;
}

/// Returns the number of bytes of each pixel of a texture.
pub(crate) unsafe fn texture_channels(m: &mjModel, texture: usize) -> usize {
    // SAFETY: the caller's promise.
    #[cfg(engine_since = "3.2.1")]
    return unsafe { *m.tex_nchannel.add(texture) as usize };
    #[cfg(not(engine_since = "3.2.1"))]
    return (m, texture, 3).2;
}

/// Returns the texture for the colour of a material, or -1.
pub(crate) unsafe fn material_texture(m: &mjModel, material: usize) -> i32 {
    // SAFETY: the caller's promise.
    #[cfg(engine_since = "3.2.1")]
    return unsafe { *m.mat_texid.add(material * sys::mjNTEXROLE as usize + sys::mjTEXROLE_RGB as usize) };
    // SAFETY: the caller's promise.
    #[cfg(not(engine_since = "3.2.1"))]
    return unsafe { *m.mat_texid.add(material) };
}

/// Returns `texid`, `texuniform` and `texrepeat` of a geom of a scene. The scenes of some engines
/// have the material instead.
pub(crate) unsafe fn scene_geom_texture(m: &mjModel, geom: &mjvGeom) -> (i32, i32, [f32; 2]) {
    #[cfg(not(engine_since = "3.2.1"))]
    return (m, (geom.texid, geom.texuniform, geom.texrepeat)).1;
    #[cfg(engine_since = "3.2.1")]
    {
        let Ok(material) = usize::try_from(geom.matid) else { return (-1, 0, [0.0; 2]) };
        // SAFETY: the caller's promise, and a material of the model.
        unsafe {
            let repeat = [0, 1].map(|axis| *m.mat_texrepeat.add(2 * material + axis));
            (material_texture(m, material), i32::from(*m.mat_texuniform.add(material)), repeat)
        }
    }
}

/// Places of the normals and texture coordinates of all meshes: before 2.3.3 a vertex has one of
/// each, so the places and the faces are those of the vertices.
pub(crate) struct MeshPlaces {
    pub(crate) normaladr: *const i32,
    pub(crate) normalnum: *const i32,
    pub(crate) texcoordnum: *const i32,
    pub(crate) facenormal: *const i32,
    pub(crate) facetexcoord: *const i32,
}

impl MeshPlaces {
    pub(crate) fn of(m: &mjModel) -> Self {
        #[cfg(engine_since = "2.3.7")]
        return Self {
            normaladr: m.mesh_normaladr,
            normalnum: m.mesh_normalnum,
            texcoordnum: m.mesh_texcoordnum,
            facenormal: m.mesh_facenormal,
            facetexcoord: m.mesh_facetexcoord,
        };
        #[cfg(not(engine_since = "2.3.7"))]
        return Self {
            normaladr: m.mesh_vertadr,
            normalnum: m.mesh_vertnum,
            texcoordnum: m.mesh_vertnum,
            facenormal: m.mesh_face,
            facetexcoord: m.mesh_face,
        };
    }
}

/// Returns 1 for a directional light, else 0.
pub(crate) unsafe fn is_directional(m: &mjModel, light: usize) -> u8 {
    // SAFETY: the caller's promise.
    #[cfg(engine_since = "3.3.3")]
    return unsafe { *m.light_type.add(light) == sys::mjLIGHT_DIRECTIONAL as i32 }.into();
    // SAFETY: the caller's promise.
    #[cfg(not(engine_since = "3.3.3"))]
    return unsafe { *m.light_directional.add(light) };
}

/// Returns the initial activity of the equality constraints.
pub(crate) fn equality_active(m: &mjModel) -> *const u8 {
    #[cfg(engine_since = "3.0.0")]
    return m.eq_active0;
    #[cfg(not(engine_since = "3.0.0"))]
    return m.eq_active;
}

/// Returns a dense row of a matrix whose rows are described by start, number of elements and
/// columns of each.
unsafe fn dense_row(
    values: *const f64,
    [starts, counts, columns]: [*const i32; 3],
    row: usize,
    width: usize,
) -> Vec<f64> {
    let mut dense = vec![0.0; width];
    // SAFETY: the caller's promise.
    unsafe {
        let start = *starts.add(row) as usize;
        for at in start..start + *counts.add(row) as usize {
            dense[*columns.add(at) as usize] = *values.add(at);
        }
    }
    dense
}

/// Returns a dense row of the tendon Jacobian.
pub(crate) unsafe fn tendon_jacobian(m: &mjModel, d: &mjData, tendon: usize) -> Vec<f64> {
    let nv = m.nv as usize;
    // SAFETY: the caller's promise.
    unsafe {
        #[cfg(engine_since = "3.6.0")]
        return dense_row(d.ten_J, [m.ten_J_rowadr, m.ten_J_rownnz, m.ten_J_colind], tendon, nv);
        #[cfg(not(engine_since = "3.6.0"))]
        if sys::mj_isSparse(m) == 0 {
            super::read(d.ten_J, nv * tendon, nv)
        } else {
            dense_row(d.ten_J, [d.ten_J_rowadr, d.ten_J_rownnz, d.ten_J_colind], tendon, nv)
        }
    }
}

/// Returns a dense row of the actuator moments.
pub(crate) unsafe fn actuator_moment(m: &mjModel, d: &mjData, actuator: usize) -> Vec<f64> {
    let nv = m.nv as usize;
    // SAFETY: the caller's promise.
    unsafe {
        #[cfg(engine_since = "3.2.5")]
        return dense_row(d.actuator_moment, [d.moment_rowadr, d.moment_rownnz, d.moment_colind], actuator, nv);
        #[cfg(not(engine_since = "3.2.5"))]
        super::read(d.actuator_moment, nv * actuator, nv)
    }
}

/// Options that newer engines lack: their present values, or the constant behaviour of those
/// engines. The first three are `apirate`, `mpr_tolerance` (`ccd_tolerance`) and `mpr_iterations`
/// (`ccd_iterations`), the last is `collision`.
pub(crate) fn options(raw: &mjOption) -> [f64; 4] {
    #[cfg(engine_since = "3.5.0")]
    return [100.0, raw.ccd_tolerance, raw.ccd_iterations.into(), 0.0];
    #[cfg(not(engine_since = "3.5.0"))]
    return [raw.apirate, raw.mpr_tolerance, raw.mpr_iterations.into(), raw.collision.into()];
}

/// Returns 1 for a directional light of a scene, else 0.
pub(crate) fn scene_light_directional(light: &mjvLight) -> u8 {
    #[cfg(engine_since = "3.3.3")]
    return (light.type_ == sys::mjLIGHT_DIRECTIONAL as i32).into();
    #[cfg(not(engine_since = "3.3.3"))]
    return light.directional;
}

/// Calls `mjv_moveCamera`.
pub(crate) unsafe fn move_camera(
    m: *const mjModel,
    action: i32,
    [dx, dy]: [f64; 2],
    scene: &mjvScene,
    camera: &mut mjvCamera,
) {
    // SAFETY: the caller's promise.
    unsafe {
        #[cfg(engine_since = "3.11.0")]
        {
            let _ = scene;
            sys::mjv_moveCamera(m, action, dx, dy, camera);
        }
        #[cfg(not(engine_since = "3.11.0"))]
        sys::mjv_moveCamera(m, action, dx, dy, scene, camera);
    }
}

/// Calls `mjv_select` for a window of this aspect ratio and a position in it. Writes the geom and
/// the skin.
pub(crate) unsafe fn select(
    (m, d): (*const mjModel, *const mjData),
    options: *const mjvOption,
    [aspect, x, y]: [f64; 3],
    scene: *const mjvScene,
    point: *mut f64,
    (geom, skin): (*mut i32, *mut i32),
) -> i32 {
    // SAFETY: the caller's promise.
    unsafe {
        #[cfg(engine_since = "3.0.0")]
        return sys::mjv_select(m, d, options, aspect, x, y, scene, point, geom, &mut -1, skin);
        #[cfg(not(engine_since = "3.0.0"))]
        sys::mjv_select(m, d, options, aspect, x, y, scene, point, geom, skin)
    }
}

/// Sets the target of the selected point, which engines from 2.3.3 have, to that of the body.
pub(crate) fn target_selected_point(perturbation: &mut mjvPerturb) {
    #[cfg(engine_since = "2.3.7")]
    {
        perturbation.refselpos = perturbation.refpos;
    }
    #[cfg(not(engine_since = "2.3.7"))]
    let _ = perturbation;
}
