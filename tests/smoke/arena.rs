//! No accessor returns memory of the arena that the engine has not written. Before each call the
//! tests fill the memory that the call may allocate with a pattern, and look for the pattern in all
//! arrays afterwards.

use mujoco_safe::callback::Callbacks;
use mujoco_safe::data::{ConeHessian, SensorUpdate, Warning};
use mujoco_safe::enums::{Cone, Integrator, JacobianStorage, Solver};
use mujoco_safe::model::DisableFlags;
use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions, VisualFlags};
use mujoco_safe::sys::{adapted, mjContact, mjNENABLE};
use mujoco_safe::{Data, MatrixView, Model, Result, Stage, sample};

use crate::cases::cases;

const PATTERN: u8 = 0xA5;
const WORD: [u8; 4] = [PATTERN; 4];

/// The result of an accessor.
trait Values {
    /// Returns `true` if a value is the pattern.
    fn has_pattern(&self) -> bool {
        false
    }

    fn is_empty(&self) -> bool {
        false
    }
}

impl Values for usize {}
impl Values for f64 {}
impl Values for bool {}
impl Values for &[u8] {}
impl Values for &[i64] {}

impl Values for &[i32] {
    fn has_pattern(&self) -> bool {
        self.iter().any(|value| value.to_ne_bytes() == WORD)
    }

    fn is_empty(&self) -> bool {
        <[i32]>::is_empty(self)
    }
}

impl Values for &[f64] {
    fn has_pattern(&self) -> bool {
        self.iter().any(|value| value.to_ne_bytes() == [PATTERN; 8])
    }

    fn is_empty(&self) -> bool {
        <[f64]>::is_empty(self)
    }
}

impl<const N: usize> Values for &[[f64; N]] {
    fn has_pattern(&self) -> bool {
        self.as_flattened().has_pattern()
    }

    fn is_empty(&self) -> bool {
        self.as_flattened().is_empty()
    }
}

impl<const N: usize> Values for &[[i32; N]] {
    fn has_pattern(&self) -> bool {
        self.as_flattened().has_pattern()
    }
}

impl Values for MatrixView<'_> {
    fn has_pattern(&self) -> bool {
        self.as_slice().has_pattern()
    }
}

macro_rules! check {
    ($data:ident $after:ident: $($name:ident)*) => {
        $(assert!(!$data.$name().has_pattern(), "{} after {}", stringify!($name), $after);)*
    };
}

macro_rules! empty {
    ($data:ident: $($name:ident)*) => {
        [$((stringify!($name), $data.$name().is_empty())),*]
    };
}

/// Asserts that all arrays are written.
fn check(data: &Data, after: &str) {
    data_readers! { check data after: }
    for contact in data.contacts() {
        let numbers = [contact.frame().as_slice(), contact.pos(), contact.friction(), &[contact.dist()]];
        assert!(!numbers.concat().as_slice().has_pattern(), "contact after {after}");
        assert!(
            contact.geoms().iter().flatten().all(|geom| geom.index() < data.model().ngeom()),
            "geoms after {after}"
        );
        assert!(contact.dim() <= 6 && (!contact.is_active() || data.nefc() > 0), "contact after {after}");
        if let Ok(force) = contact.force() {
            assert!(![force.force, force.torque].concat().as_slice().has_pattern(), "force after {after}");
        }
    }
}

/// Fills the arena behind its first `kept` bytes with the pattern.
fn fill(data: &mut Data, kept: usize) {
    // SAFETY: the stack is empty between calls, and each caller keeps the memory that the next call
    // reads.
    unsafe {
        let raw = &mut *data.as_mut_ptr();
        assert_eq!(raw.pstack, 0);
        let length = adapted::arena_bytes(raw) - kept;
        raw.arena.cast::<u8>().add(kept).write_bytes(PATTERN, length);
    }
}

/// Makes a call of a simulation that computes contacts and constraints.
fn with_none(data: &mut Data, name: &str, call: impl FnOnce(&mut Data) -> Result<()>) {
    fill(data, 0);
    call(data).unwrap();
    check(data, name);
}

/// Makes a call that computes the constraints of the present contacts.
fn with_contacts(data: &mut Data, name: &str, call: impl FnOnce(&mut Data) -> Result<()>) {
    fill(data, data.ncon() * size_of::<mjContact>());
    call(data).unwrap();
    check(data, name);
}

/// Makes a call that adds arrays to the present ones.
fn with_all(data: &mut Data, name: &str, call: impl FnOnce(&mut Data) -> Result<()>) {
    // SAFETY: reads a number.
    let used = unsafe { (*data.as_ptr()).parena };
    fill(data, used);
    call(data).unwrap();
    check(data, name);
}

/// Computes forward dynamics by parts.
fn by_parts(data: &mut Data) {
    with_none(data, "collision", |data| {
        data.kinematics()?;
        data.com_pos()?;
        data.camlight()?;
        data.compute_tendon()?;
        data.compute_crb()?;
        data.factor_m()?;
        data.collision()
    });
    for _ in 0..2 {
        with_contacts(data, "make_constraint", Data::make_constraint);
    }
    with_all(data, "transmission", Data::transmission);
    with_all(data, "project_constraint", Data::project_constraint);
    with_all(data, "compute_ten_velocity", Data::compute_ten_velocity);
    with_all(data, "compute_actuator_velocity", Data::compute_actuator_velocity);
    with_all(data, "com_vel", Data::com_vel);
    with_all(data, "passive", Data::passive);
    with_all(data, "reference_constraint", Data::reference_constraint);
    with_all(data, "compute_qfrc_bias", Data::compute_qfrc_bias);
    with_all(data, "fwd_actuation", Data::fwd_actuation);
    with_all(data, "fwd_acceleration", Data::fwd_acceleration);
    with_all(data, "inv_constraint", Data::inv_constraint);
    with_all(data, "fwd_constraint", Data::fwd_constraint);
    with_all(data, "rne_post_constraint", Data::rne_post_constraint);
}

/// Makes all calls that compute constraints.
fn all_calls(data: &mut Data) {
    with_none(data, "forward", Data::forward);
    let mut twin = data.clone();
    check(&twin, "clone");
    by_parts(data);
    assert_eq!((data.qacc(), data.efc_force()), (twin.qacc(), twin.efc_force()));

    with_none(data, "step", Data::step);
    with_none(data, "inverse", Data::inverse);
    with_all(data, "inverse_skip", |data| data.inverse_skip(Stage::Velocity, SensorUpdate::Compute));
    with_none(data, "step1", Data::step1);
    with_all(data, "constraint_update", |data| {
        data.constraint_update(&vec![-0.1; data.nefc()], ConeHessian::Compute).map(|_| ())
    });
    with_all(data, "step2", Data::step2);
    with_none(data, "fwd_position", Data::fwd_position);
    with_all(data, "fwd_velocity", Data::fwd_velocity);
    with_all(data, "forward_skip", |data| data.forward_skip(Stage::Velocity, SensorUpdate::Compute));
    with_all(data, "euler", Data::euler);
    with_none(data, "inv_position", Data::inv_position);
    with_all(data, "inv_velocity", Data::inv_velocity);
    with_all(data, "inv_constraint", Data::inv_constraint);

    let callbacks = Callbacks::new()
        .with_control(|context| check(context, "the control callback"))
        .with_passive(|context| check(context, "the passive callback"));
    twin.with_callbacks(callbacks, |data| {
        with_none(data, "step with callbacks", Data::step);
        with_none(data, "inverse with callbacks", Data::inverse);
    });
}

#[test]
fn flags_of_newer_engines_leave_only_written_memory() {
    // SAFETY: no other thread uses the model. The engine has the flags, and the results are
    // discarded.
    let set = |data: &mut Data, flags: u32| unsafe {
        (*data.model().as_ptr().cast_mut()).opt.enableflags = flags as i32;
    };
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut used = 0;
    for flag in (0..mjNENABLE).map(|bit| 1 << bit) {
        for solver in [Solver::Pgs, Solver::Newton] {
            edit(&mut data, |options| options.solver = solver);
            set(&mut data, flag);
            data.reset_to_key("squat").unwrap();
            // With some flags a step with this integrator is an error.
            if (0..20).all(|_| data.step().is_ok()) {
                assert!(data.nefc() > 0);
                all_calls(&mut data);
                used += 1;
            }
            set(&mut data, 0);
            data.reset().unwrap();
        }
    }
    assert!(used >= 8);
}

fn edit(data: &mut Data, edit: impl FnOnce(&mut mujoco_safe::Options)) {
    data.edit_model(|model| model.edit_options(edit)).unwrap();
}

#[test]
fn every_call_leaves_only_written_memory() {
    let colliders = Model::from_xml_str(include_str!("../models/colliders.xml")).unwrap();
    for model in [sample::humanoid(), colliders] {
        let mut data = Data::new(model).unwrap();
        let mut rows = 0;
        for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
            for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
                for (cone, noslip_iterations) in [(Cone::Pyramidal, 0), (Cone::Elliptic, 3)] {
                    for disable in [DisableFlags::empty(), DisableFlags::WARMSTART] {
                        edit(&mut data, |options| {
                            (options.jacobian, options.solver, options.cone) = (jacobian, solver, cone);
                            (options.noslip_iterations, options.disable) = (noslip_iterations, disable);
                        });
                        println!("{jacobian:?} {solver:?} {cone:?} {disable:?}");
                        data.reset_to_key(0).unwrap();
                        for _ in 0..20 {
                            data.step().unwrap();
                        }
                        all_calls(&mut data);
                        rows += data.nefc();
                    }
                }
            }
        }
        assert!(rows > 0);
    }
}

#[test]
fn arrays_of_constraints_are_empty_until_they_are_computed() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let empty = |data: &Data| -> Vec<&str> {
        let all = data_readers! { empty data: };
        all.into_iter().filter(|(name, empty)| name.starts_with("efc_") && *empty).map(|(name, _)| name).collect()
    };
    let of_dual = |name: &&str| name.starts_with("efc_A") || name.starts_with("efc_Y");
    let total = empty(&data).len();
    data.step1().unwrap();
    let mut missing = empty(&data);
    missing.retain(|name| !of_dual(name) && !name.starts_with("efc_J_"));
    assert_eq!(missing, ["efc_b", "efc_state", "efc_force"]);
    data.step2().unwrap();
    // The humanoid's Jacobian is dense, and its solver is Newton's.
    assert!(empty(&data).iter().all(|name| of_dual(name) || name.starts_with("efc_J_")), "{:?}", empty(&data));
    assert_eq!(data.efc_J().len(), data.nefc() * data.model().nv());
    edit(&mut data, |_| {});
    assert_eq!(empty(&data).len(), total);
}

/// In newer engines a full buffer is a warning, and a handler of warnings that does not return
/// would leave the thread without errors.
#[test]
#[cfg_attr(not(engine_since = "2.3.0"), ignore = "the engine has buffers of fixed numbers")]
fn errors_are_still_found_after_constraints_without_room_for_an_adhesive_body() {
    let balls: Vec<String> = (0..30)
        .map(|i| {
            format!(
                "<body name='b{i}' pos='{} {} 1.09'><freejoint/><geom size='.1'/></body>",
                0.3 * f64::from(i % 6),
                0.3 * f64::from(i / 6)
            )
        })
        .collect();
    let balls = balls.concat();
    let model = |memory: &str| {
        Model::from_xml_str(&format!(
            "<mujoco><size {memory}/><option jacobian='dense'/><worldbody><geom type='plane' size='9 9 .1'/>{balls}</worldbody>
               <actuator><adhesion body='b0' ctrlrange='0 1' gain='10'/></actuator></mujoco>"
        ))
    };
    // The compiler takes a step, which fails for lack of memory.
    let error = || model("memory='1K'").unwrap_err().to_string();
    let expected = error();
    let mut messages = Vec::new();
    for memory in (60..600).step_by(20) {
        let Ok(model) = model(&format!("memory='{memory}K'")) else { continue };
        let mut data = Data::new(model).unwrap();
        for _ in 0..2 {
            // The compiler takes a step, too, without contacts.
            data.qpos_mut().chunks_exact_mut(7).for_each(|pose| pose[2] = 0.09);
            if let Err(error) = data.step() {
                messages.push(error.to_string());
                assert_eq!(data.ncon(), 0);
                data.reset().unwrap();
            }
        }
        assert_eq!(error(), expected);
    }
    assert!(messages.iter().any(|message| message.contains("number of constraints")), "{messages:?}");
}

/// With too little memory, the engine removes the constraints, but not their numbers, with which it
/// and the visualiser would read them.
#[test]
fn constraints_without_room_leave_no_numbers() {
    let (mut lost, mut rejected) = (0, 0);
    for (memory, solver) in
        (1_000..40_000).step_by(cases(384, 96)).flat_map(|memory| [(memory, "PGS"), (memory, "Newton")])
    {
        let text = format!(
            r#"<mujoco><size memory="{memory}"/><option solver="{solver}" jacobian="dense"/><worldbody>
                 <body name="a" pos="0 0 1"><joint name="j" range="-1 -.5" limited="true" frictionloss="1"/><geom size=".1" pos=".2 0 0"/><site name="s"/></body>
                 <body name="b" pos="1 0 1"><freejoint/><geom size=".1"/></body>
               </worldbody>
               <equality><weld name="w" body1="a" body2="b" active="ACTIVE"/></equality>
               <sensor><accelerometer site="s"/><force site="s"/></sensor></mujoco>"#
        );
        // The compiler takes a step, too.
        if let Err(error) = Model::from_xml_str(&text.replace("ACTIVE", "true")) {
            rejected += usize::from(error.to_string().contains("too small for the constraints"));
        }
        let Ok(model) = Model::from_xml_str(&text.replace("ACTIVE", "false")) else { continue };
        for integrator in [Integrator::Euler, Integrator::Rk4] {
            let mut data = Data::new(model.clone()).unwrap();
            edit(&mut data, |options| options.integrator = integrator);
            data.edit_model(|model| model.equality_mut("w").unwrap().set_active(true)).unwrap();
            data.reset().unwrap();
            for _ in 0..3 {
                if data.step().is_err() {
                    break;
                }
                assert!(data.nefc() > 0 || [data.ne(), data.nf()] == [0, 0], "{memory}, {solver}");
                lost += data.warning(Warning::ConstraintFull).number;
                let mut scene = Scene::new(data.model(), 200).unwrap();
                let mut camera = Camera::free(data.model());
                let mut options = SceneOptions::default();
                options.flags = VisualFlags::all();
                scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
                data.rne_post_constraint().unwrap();
            }
        }
    }
    assert!((lost > cases(5, 20) && rejected > cases(1, 5)) || cfg!(not(engine_since = "2.3.0")), "{lost} {rejected}");
}

/// There is room in the initial state, but not in the compiler's simulation of a muscle, in which
/// joints reach their limits.
#[test]
#[cfg_attr(not(engine_since = "2.3.0"), ignore = "the engine has buffers of fixed numbers")]
#[cfg_attr(
    all(engine_since = "3.11.0", not(engine_since = "3.14.0")),
    ignore = "3.11.0 crashed in a step with too little memory; 3.12 and 3.13 were not tried"
)]
fn constraints_without_room_in_the_simulation_of_a_muscle_are_an_error() {
    let repeat = |text: &str| (0..20).map(|number| text.replace('N', &number.to_string())).collect::<String>();
    let bodies = repeat("<body><joint name='jN' range='-1 1' limited='true'/><geom size='.1' pos='.2 0 0'/></body>");
    let joints = repeat("<joint joint='jN' coef='1'/>");
    let messages: Vec<String> = (1_000..40_000)
        .step_by(cases(1_500, 500))
        .filter_map(|memory| {
            let text = format!(
                "<mujoco><size memory='{memory}'/><option solver='PGS' jacobian='dense'/><worldbody>{bodies}
                   <body name='b' pos='1 0 1'><joint/><geom size='.1' pos='.2 0 0'/><site name='s'/></body></worldbody>
                   <equality><connect body1='b' body2='world' anchor='.5 0 0'/></equality><tendon><fixed name='t'>{joints}</fixed></tendon>
                   <actuator><muscle tendon='t'/></actuator><sensor><accelerometer site='s'/></sensor></mujoco>"
            );
            Model::from_xml_str(&text).err().map(|error| error.to_string())
        })
        .collect();
    let mut places = vec!["constraints in the simulation for a lengthrange"];
    if cfg!(tested_in_full) {
        // In other engines the functions before need more memory than the constraints.
        places.push("constraints of the initial state");
    }
    for place in places {
        assert!(messages.iter().any(|message| message.contains(place)), "{place}: {messages:#?}");
    }
}
