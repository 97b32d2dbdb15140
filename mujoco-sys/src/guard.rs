//! Guarded engine functions. The C shim's `mujoco_sys_mj_step` is `mj_step`, except that an engine
//! error (`mju_error`) becomes a return code instead of ending the process.
//!
//! A guarded function returns [`OK`] or an error code. After an error, [`message`] returns this
//! thread's error text. An error restores the stack top inside the given `mjData`, and since 2.3
//! removes the contacts and constraints, whose arrays may not exist yet; other changes made by the
//! failed call remain. Guards nest, and each thread has its own chain.
//!
//! The functions have the parameters of 2.2.2 with every version of the engine; `shim/compat.h`
//! adapts them.
//!
//! # Safety of all functions in this module
//!
//! [`install`] was called before in this process, and the arguments satisfy the requirements of the
//! C function of the same name. An engine error must not jump over a Rust frame: callbacks must not
//! raise an engine error from Rust code.

use std::os::raw::{c_char, c_int, c_void};

use crate::{mjContact, mjData, mjModel, mjVFS, mjtNum, mjvCamera, mjvGeom, mjvOption, mjvPerturb, mjvScene};

/// The call succeeded.
pub const OK: c_int = 0;
/// The engine raised an error; [`message`] has its text.
pub const ERROR: c_int = 1;
/// The XML compiler ran out of memory.
pub const OUT_OF_MEMORY: c_int = 2;
/// The XML compiler threw a C++ exception; [`message`] has its text.
pub const EXCEPTION: c_int = 3;

macro_rules! guarded {
    ($($(#[$doc:meta])* $shim:ident = $name:ident($($argument:ident: $type:ty),* $(,)?);)*) => {
        unsafe extern "C" {
            $(
                $(#[$doc])*
                #[doc = concat!("The engine's `", stringify!($name), "`, guarded.")]
                #[link_name = stringify!($shim)]
                pub fn $name($($argument: $type),*) -> c_int;
            )*
        }
    };
}

/// Position of the top of the stack inside an `mjData`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StackMark {
    top: usize,
    base: usize,
}

/// Setting of a thread that [`begin_full`] replaces.
#[repr(C)]
#[derive(Debug)]
pub struct Full {
    data: *mut mjData,
    is_fatal: c_int,
    count: c_int,
    has_failed: c_int,
}

/// A part of the engine's pipeline.
pub type Part = unsafe extern "C" fn(m: *const mjModel, d: *mut mjData);

unsafe extern "C" {
    /// Calls parts of the pipeline in sequence behind one guard, which is cheaper than one guard
    /// for each.
    #[link_name = "mujoco_sys_parts"]
    pub fn parts(m: *const mjModel, d: *mut mjData, parts: *const Part, count: c_int) -> c_int;

    /// `mj_step` without the engine's check of `qpos` and `qvel`, which calls a function for each
    /// number. The caller has checked that every number is within `mjMAXVAL`. The results are those
    /// of `mj_step`, bit for bit.
    #[link_name = "mujoco_sys_step_prechecked"]
    pub fn step_prechecked(m: *const mjModel, d: *mut mjData) -> c_int;

    /// Writes the top of the stack inside `d` to `at`. Not an engine function.
    #[link_name = "mujoco_sys_stack_mark"]
    pub fn stack_mark(d: *const mjData, at: *mut StackMark);

    /// Releases everything that was allocated on the stack inside `d` since `at` was written.
    #[link_name = "mujoco_sys_stack_restore"]
    pub fn stack_restore(d: *mut mjData, at: *const StackMark);

    /// Installs the guards' handlers as `mju_user_error` and `mju_user_warning`, for the whole
    /// process. Warnings go to `warn`, or to standard error without it. Also replaces the engine's
    /// collision functions by checked ones, which raise an engine error for inputs on which the
    /// engine would access memory out of bounds or not return, and which skip contacts between two
    /// geoms of one body where a row of the sparse Jacobian would overflow.
    #[link_name = "mujoco_sys_install"]
    pub fn install(warn: Option<unsafe extern "C" fn(*const c_char)>);

    /// Returns 1 if the engine's sensors of distances measure these types of geoms by another
    /// method than its own, because its collision function was replaced: see `shim/interpose.c`.
    #[link_name = "mujoco_sys_changes_distance"]
    pub fn changes_distance(type1: c_int, type2: c_int) -> c_int;

    /// Handles a full constraint buffer of a data in this thread. The engine then removes the
    /// constraints, but since 2.3 not their numbers, with which its later stages would read them;
    /// this clears the numbers.
    ///
    /// `is_fatal` makes it an error. Required while a model with an adhesion actuator
    /// (`mjTRN_BODY`) is simulated: the engine would write out of bounds.
    ///
    /// The engine warns only while `warning[mjWARN_CNSTRFULL].number` is zero. Writes the previous
    /// setting, for [`end_full`].
    #[link_name = "mujoco_sys_begin_full"]
    pub fn begin_full(d: *mut mjData, is_fatal: c_int, outer: *mut Full);

    /// Restores the setting that [`begin_full`] wrote, and writes the number of warnings. Returns 1
    /// if the call between must fail, although it has returned, else 0.
    #[link_name = "mujoco_sys_end_full"]
    pub fn end_full(outer: *const Full, count: *mut c_int) -> c_int;

    /// Returns the number of significant digits that `mj_save_last_xml` prints: 17, enough for
    /// every double to be read back exactly, or 6 with an engine whose precision cannot be set.
    #[link_name = "mujoco_sys_xml_digits"]
    pub fn xml_digits() -> c_int;

    /// Returns 1 during a guarded call of this thread, else 0.
    #[link_name = "mujoco_sys_is_guarded"]
    pub fn is_guarded() -> c_int;

    /// Returns the text of this thread's last caught error. Valid until the next error.
    #[link_name = "mujoco_sys_message"]
    pub fn message() -> *const c_char;
}

guarded! {
    mujoco_sys_mj_version = mj_version(result: *mut c_int);

    mujoco_sys_mj_loadXML = mj_load_xml(
        filename: *const c_char, vfs: *const mjVFS, error: *mut c_char, error_size: c_int, result: *mut *mut mjModel,
    );
    mujoco_sys_mj_saveLastXML = mj_save_last_xml(
        filename: *const c_char, m: *const mjModel, error: *mut c_char, error_size: c_int, result: *mut c_int,
    );
    mujoco_sys_mj_printSchema = mj_print_schema(
        filename: *const c_char, buffer: *mut c_char, buffer_size: c_int, html: c_int, pad: c_int, result: *mut c_int,
    );
    /// Decodes a texture that the model has by reference, since 3.17: `size` receives the width and
    /// the height. `mju_free` frees the pixels.
    mujoco_sys_mj_loadTexture = mj_load_texture(
        m: *const mjModel, texture: c_int, data: *mut *mut u8, size: *mut c_int, colorspace: *mut c_int, error: *mut c_char,
        error_size: c_int, result: *mut c_int,
    );
    mujoco_sys_mj_copyModel = mj_copy_model(dest: *mut mjModel, m: *const mjModel, result: *mut *mut mjModel);
    /// Adds a copy of a buffer to a virtual file system (before 3.1.3 with `mj_makeEmptyFileVFS`).
    /// Writes 0 to `*result`, or 1 if the file system is full, 2 if it has a file of this name, and
    /// 3 for any other failure.
    mujoco_sys_mj_addBufferVFS = mj_add_buffer_vfs(
        vfs: *mut mjVFS, name: *const c_char, buffer: *const c_void, size: c_int, result: *mut c_int,
    );
    mujoco_sys_mj_loadModel = mj_load_model(filename: *const c_char, vfs: *const mjVFS, result: *mut *mut mjModel);
    mujoco_sys_mj_saveModel = mj_save_model(m: *const mjModel, filename: *const c_char, buffer: *mut c_void, size: c_int);
    mujoco_sys_mj_makeData = mj_make_data(m: *const mjModel, result: *mut *mut mjData);
    mujoco_sys_mj_copyData = mj_copy_data(
        dest: *mut mjData, m: *const mjModel, src: *const mjData, result: *mut *mut mjData,
    );
    mujoco_sys_mj_resetData = mj_reset_data(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_resetDataKeyframe = mj_reset_data_keyframe(m: *const mjModel, d: *mut mjData, key: c_int);
    mujoco_sys_mj_setConst = mj_set_const(m: *mut mjModel, d: *mut mjData);

    mujoco_sys_mj_step = mj_step(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_step1 = mj_step1(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_step2 = mj_step2(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_forward = mj_forward(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_inverse = mj_inverse(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_forwardSkip = mj_forward_skip(m: *const mjModel, d: *mut mjData, stage: c_int, skip_sensor: c_int);
    mujoco_sys_mj_inverseSkip = mj_inverse_skip(m: *const mjModel, d: *mut mjData, stage: c_int, skip_sensor: c_int);

    mujoco_sys_mj_kinematics = mj_kinematics(m: *const mjModel, d: *mut mjData);
    /// `mj_comPos`, and since 3.0 `mj_flex` in a model with flexes.
    mujoco_sys_mj_comPos = mj_com_pos(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_camlight = mj_camlight(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_tendon = mj_tendon(m: *const mjModel, d: *mut mjData);
    /// `mj_crb`, or its successor `mj_makeM`, which includes the armature of tendons.
    mujoco_sys_mj_crb = mj_crb(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_factorM = mj_factor_m(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_collision = mj_collision(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_makeConstraint = mj_make_constraint(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_projectConstraint = mj_project_constraint(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_transmission = mj_transmission(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_comVel = mj_com_vel(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_passive = mj_passive(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_referenceConstraint = mj_reference_constraint(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_fwdPosition = mj_fwd_position(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_fwdVelocity = mj_fwd_velocity(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_fwdActuation = mj_fwd_actuation(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_fwdAcceleration = mj_fwd_acceleration(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_fwdConstraint = mj_fwd_constraint(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_invPosition = mj_inv_position(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_invVelocity = mj_inv_velocity(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_invConstraint = mj_inv_constraint(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_compareFwdInv = mj_compare_fwd_inv(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_sensorPos = mj_sensor_pos(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_sensorVel = mj_sensor_vel(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_sensorAcc = mj_sensor_acc(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_energyPos = mj_energy_pos(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_energyVel = mj_energy_vel(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_Euler = mj_euler(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_RungeKutta = mj_runge_kutta(m: *const mjModel, d: *mut mjData, order: c_int);

    mujoco_sys_mj_jacSubtreeCom = mj_jac_subtree_com(m: *const mjModel, d: *mut mjData, jacp: *mut mjtNum, body: c_int);
    mujoco_sys_mj_jacPointAxis = mj_jac_point_axis(
        m: *const mjModel, d: *mut mjData, jacp: *mut mjtNum, jacr: *mut mjtNum,
        point: *const mjtNum, axis: *const mjtNum, body: c_int,
    );
    mujoco_sys_mj_solveM = mj_solve_m(m: *const mjModel, d: *mut mjData, x: *mut mjtNum, y: *const mjtNum, n: c_int);
    mujoco_sys_mj_rne = mj_rne(m: *const mjModel, d: *mut mjData, with_acceleration: c_int, result: *mut mjtNum);
    mujoco_sys_mj_rnePostConstraint = mj_rne_post_constraint(m: *const mjModel, d: *mut mjData);
    mujoco_sys_mj_subtreeVel = mj_subtree_vel(m: *const mjModel, d: *mut mjData);
    /// Allocates numbers on the engine's stack. [`stack_restore`] releases them.
    mujoco_sys_mj_stackAlloc = mj_stack_alloc(d: *mut mjData, size: c_int, result: *mut *mut mjtNum);

    mujoco_sys_mj_solveM2 = mj_solve_m2(m: *const mjModel, d: *mut mjData, x: *mut mjtNum, y: *const mjtNum, n: c_int);
    mujoco_sys_mj_addM = mj_add_m(
        m: *const mjModel, d: *mut mjData, dst: *mut mjtNum, rownnz: *mut c_int, rowadr: *mut c_int, colind: *mut c_int,
    );
    mujoco_sys_mj_applyFT = mj_apply_ft(
        m: *const mjModel, d: *mut mjData, force: *const mjtNum, torque: *const mjtNum, point: *const mjtNum,
        body: c_int, qfrc_target: *mut mjtNum,
    );
    mujoco_sys_mj_objectVelocity = mj_object_velocity(
        m: *const mjModel, d: *const mjData, object_type: c_int, object: c_int, result: *mut mjtNum, local: c_int,
    );
    mujoco_sys_mj_objectAcceleration = mj_object_acceleration(
        m: *const mjModel, d: *const mjData, object_type: c_int, object: c_int, result: *mut mjtNum, local: c_int,
    );
    mujoco_sys_mj_constraintUpdate = mj_constraint_update(
        m: *const mjModel, d: *mut mjData, jar: *const mjtNum, cost: *mut mjtNum, with_cone_hessian: c_int,
    );
    mujoco_sys_mj_addContact = mj_add_contact(
        m: *const mjModel, d: *mut mjData, contact: *const mjContact, result: *mut c_int,
    );
    mujoco_sys_mj_ray = mj_ray(
        m: *const mjModel, d: *const mjData, point: *const mjtNum, vector: *const mjtNum, geomgroup: *const u8,
        with_static: u8, bodyexclude: c_int, geom: *mut c_int, result: *mut mjtNum,
    );
    mujoco_sys_mj_printData = mj_print_data(m: *const mjModel, d: *mut mjData, filename: *const c_char);
    /// Calls `mjCOLLISIONFUNC[type1][type2]` for two geoms. Writes the number of contacts to
    /// `*result`, or -1 if the table has no function.
    mujoco_sys_collide = collide(
        m: *const mjModel, d: *mut mjData, contacts: *mut mjContact, type1: c_int, type2: c_int, geom1: c_int,
        geom2: c_int, margin: mjtNum, result: *mut c_int,
    );

    mujoco_sys_mjd_transitionFD = mjd_transition_fd(
        m: *const mjModel, d: *mut mjData, eps: mjtNum, centered: c_int,
        a: *mut mjtNum, b: *mut mjtNum, c: *mut mjtNum, d_out: *mut mjtNum,
    );

    mujoco_sys_mjv_makeScene = mjv_make_scene(m: *const mjModel, scn: *mut mjvScene, maxgeom: c_int);
    mujoco_sys_mjv_updateScene = mjv_update_scene(
        m: *const mjModel, d: *mut mjData, opt: *const mjvOption, pert: *const mjvPerturb, cam: *mut mjvCamera,
        catmask: c_int, scn: *mut mjvScene,
    );
    mujoco_sys_mjv_addGeoms = mjv_add_geoms(
        m: *const mjModel, d: *mut mjData, opt: *const mjvOption, pert: *const mjvPerturb, catmask: c_int,
        scn: *mut mjvScene,
    );
    mujoco_sys_mjv_makeLights = mjv_make_lights(m: *const mjModel, d: *mut mjData, scn: *mut mjvScene);
    mujoco_sys_mjv_updateCamera = mjv_update_camera(
        m: *const mjModel, d: *mut mjData, cam: *mut mjvCamera, scn: *mut mjvScene,
    );
    mujoco_sys_mjv_makeConnector = mjv_make_connector(
        geom: *mut mjvGeom, type_: c_int, width: mjtNum, a0: mjtNum, a1: mjtNum, a2: mjtNum, b0: mjtNum, b1: mjtNum,
        b2: mjtNum,
    );
    mujoco_sys_mjv_cameraInModel = mjv_camera_in_model(
        headpos: *mut mjtNum, forward: *mut mjtNum, up: *mut mjtNum, scn: *const mjvScene,
    );
    mujoco_sys_mjv_cameraInRoom = mjv_camera_in_room(
        headpos: *mut mjtNum, forward: *mut mjtNum, up: *mut mjtNum, scn: *const mjvScene,
    );
    mujoco_sys_mjv_room2model = mjv_room2model(
        modelpos: *mut mjtNum, modelquat: *mut mjtNum, roompos: *const mjtNum, roomquat: *const mjtNum,
        scn: *const mjvScene,
    );
    mujoco_sys_mjv_model2room = mjv_model2room(
        roompos: *mut mjtNum, roomquat: *mut mjtNum, modelpos: *const mjtNum, modelquat: *const mjtNum,
        scn: *const mjvScene,
    );
    mujoco_sys_mjv_frustumHeight = mjv_frustum_height(scn: *const mjvScene, result: *mut mjtNum);
    mujoco_sys_mjv_moveCamera = mjv_move_camera(
        m: *const mjModel, action: c_int, reldx: mjtNum, reldy: mjtNum, scn: *const mjvScene, cam: *mut mjvCamera,
    );
    mujoco_sys_mjv_moveModel = mjv_move_model(
        m: *const mjModel, action: c_int, reldx: mjtNum, reldy: mjtNum, roomup: *const mjtNum, scn: *mut mjvScene,
    );
    mujoco_sys_mjv_movePerturb = mjv_move_perturb(
        m: *const mjModel, d: *const mjData, action: c_int, reldx: mjtNum, reldy: mjtNum, scn: *const mjvScene,
        pert: *mut mjvPerturb,
    );
    mujoco_sys_mjv_initPerturb = mjv_init_perturb(
        m: *const mjModel, d: *mut mjData, scn: *const mjvScene, pert: *mut mjvPerturb,
    );
    mujoco_sys_mjv_applyPerturbPose = mjv_apply_perturb_pose(
        m: *const mjModel, d: *mut mjData, pert: *const mjvPerturb, flg_paused: c_int,
    );
    mujoco_sys_mjv_applyPerturbForce = mjv_apply_perturb_force(
        m: *const mjModel, d: *mut mjData, pert: *const mjvPerturb,
    );
    /// Does nothing in engines before 2.3, which have no plugins. The initialiser of the library
    /// must be sound.
    mujoco_sys_mj_loadPluginLibrary = mj_load_plugin_library(path: *const c_char);
    mujoco_sys_mjv_select = mjv_select(
        m: *const mjModel, d: *const mjData, vopt: *const mjvOption, aspectratio: mjtNum, relx: mjtNum, rely: mjtNum,
        scn: *const mjvScene, selpnt: *mut mjtNum, geomid: *mut c_int, flexid: *mut c_int, skinid: *mut c_int,
        result: *mut c_int,
    );
}
