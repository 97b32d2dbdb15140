//! Whatever goes wrong is an error with a text that helps, and the process goes on.

#![forbid(unsafe_code)]

use std::path::PathBuf;
use std::sync::{Arc, Barrier};

use mujoco_safe::{
    Controller, Data, Differences, Error, Integrator, Lqr, LqrWeights, Matrix, Model, PdController, Quantity, Result,
    Stage, StateSpace, StateSpec, Trajectory, TransitionOutputs, sample,
};
use nalgebra::DMatrix;

/// A file of this process and test, that is removed at the end.
struct File(PathBuf);

impl File {
    fn new(name: &str, content: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mujoco_safe_errors_{}_{name}", std::process::id()));
        std::fs::write(&path, content).unwrap();
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The text of the error, which must have all of these parts.
#[track_caller]
fn text_of<T>(result: Result<T>, parts: &[&str]) -> String {
    let text = result.err().expect("no error").to_string();
    for part in parts {
        assert!(text.contains(part), "'{part}' is not in: {text}");
    }
    text
}

/// A ball that falls on a floor, with so small a stack that the engine runs out of it when the two meet.
fn small_stack() -> Model {
    let model = |nstack: u32| {
        Model::from_xml_str(&format!(
            r#"<mujoco><size nstack="{nstack}"/><worldbody>
                 <geom type="plane" size="1 1 1"/><body pos="0 0 .2"><freejoint/><geom size=".1"/></body>
               </worldbody></mujoco>"#
        ))
    };
    text_of(model(10), &["cannot load the XML given", "Stack overflow"]);
    (10..5000)
        .step_by(10)
        .find_map(|nstack| {
            let model = model(nstack).ok()?;
            let mut data = Data::new(model.clone()).unwrap();
            (0..200).any(|_| data.step().is_err()).then_some(model)
        })
        .expect("a stack that is large enough to fall and too small to land")
}

/// Lets a simulation run out of stack.
fn overflow(data: &mut Data) -> Error {
    (0..200).find_map(|_| data.step().err()).expect("a stack overflow")
}

#[test]
fn a_missing_file_is_named_with_the_systems_reason() {
    text_of(Model::from_xml_path("no/such/model.xml"), &["no/such/model.xml", "No such file or directory"]);
    text_of(Model::from_binary_path("no/such/model.mjb"), &["no/such/model.mjb", "No such file or directory"]);
    text_of(Model::from_xml_path(""), &["No such file or directory"]);
    text_of(Model::from_xml_path("nul\0byte.xml"), &["nul"]);
    let model = sample::cartpole();
    text_of(Trajectory::load_csv(&model, "no/such.csv"), &["no/such.csv", "No such file or directory"]);
    text_of(
        Trajectory::new(&model).save_csv("no/such/folder.csv"),
        &["no/such/folder.csv", "No such file or directory"],
    );
    text_of(model.save_binary("no/such/folder.mjb"), &["no/such/folder.mjb", "No such file or directory"]);
}

#[test]
fn a_directory_is_not_a_model() {
    let directory = std::env::temp_dir();
    let shown = directory.display().to_string();
    text_of(Model::from_xml_path(&directory), &[&shown, "directory"]);
    text_of(Model::from_binary_path(&directory), &[&shown, "directory"]);
    text_of(Model::from_xml_path("/dev/null"), &["/dev/null", "not a regular file"]);
}

#[test]
fn broken_xml_is_told_with_its_line() {
    text_of(Model::from_xml_str("<mujoco>\n<worldbody>\n</mujoco>"), &["cannot load the XML given", "Line number=2"]);
    text_of(
        Model::from_xml_str("<mujoco>\n  <worldbod/>\n</mujoco>"),
        &["unrecognized element", "'worldbod'", "line 2"],
    );
    text_of(Model::from_xml_str("<mujoco>\n\n<option timestep='soon'/></mujoco>"), &["'timestep'", "line 3"]);
    text_of(Model::from_xml_str("<mujoco>\n<worldbody>\n<geom/></worldbody></mujoco>"), &["line = 3"]);
    text_of(Model::from_xml_str(""), &["cannot load the XML given"]);
    text_of(Model::from_xml_str("not XML at all"), &["cannot load the XML given"]);
    text_of(Model::from_xml_str("<html/>"), &["html"]);
    let file = File::new("broken.xml", "<mujoco>\n\n  <worldbod/></mujoco>");
    text_of(Model::from_xml_path(&file.0), &["broken.xml", "'worldbod'", "line 3"]);
    // The engine's own buffer for such a text has a hundred bytes in its examples.
    let long = "n".repeat(300);
    text_of(Model::from_xml_str(&format!("<mujoco><worldbody><body><{long}/></body></worldbody></mujoco>")), &[&long]);
}

#[test]
fn a_file_with_a_bad_name_or_twice_or_empty_is_told() {
    let load = |files: &[(&str, &[u8])]| Model::from_xml_str_with_files("<mujoco/>", files);
    text_of(load(&[("", b"x")]), &["named with 0 bytes"]);
    text_of(load(&[("a/", b"x")]), &["'a/'", "named with 0 bytes"]);
    text_of(load(&[(&"n".repeat(1000), b"x")]), &["named with 1000 bytes"]);
    text_of(load(&[("a.xml", b"")]), &["'a.xml'", "empty"]);
    text_of(load(&[("a.xml", b"x"), ("other/A.xml", b"x")]), &["given twice"]);
    text_of(load(&[("a\0.xml", b"x")]), &["NUL byte at position 1"]);
    let many: Vec<String> = (0..2100).map(|file| format!("{file}.xml")).collect();
    let many: Vec<(&str, &[u8])> = many.iter().map(|name| (name.as_str(), &b"x"[..])).collect();
    text_of(load(&many), &["one too many"]);
}

#[test]
fn a_name_that_does_not_exist_comes_with_those_that_do() {
    let model = sample::humanoid();
    let text =
        text_of(model.joint("left_kne"), &["no joint named 'left_kne'", "did you mean 'left_knee'", "right_knee"]);
    assert!(!text.contains("torso"), "only joints: {text}");
    text_of(model.body("left_knee"), &["no body named 'left_knee'"]);
    text_of(model.tendon("t"), &["no tendon named 't'"]);
    text_of(model.light("x\0y"), &["no light named"]);
    text_of(sample::cartpole().tendon("s"), &["none of this kind has a name"]);
    text_of(model.geom(1000), &["no geom 1000", "counted from 0"]);
    let data = Data::new(model).unwrap();
    text_of(data.site("site"), &["no site named 'site'"]);
}

#[test]
fn a_keyframe_that_does_not_exist_is_an_error_and_no_reset() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.set_time(1.0);
    text_of(data.reset_to_key("squatt"), &["no keyframe named 'squatt'", "did you mean 'squat'", "stand_on_left_leg"]);
    text_of(data.reset_to_key(99), &["no keyframe 99", "the model has 3"]);
    assert_eq!(data.time(), 1.0);
}

/// One good call, then each size of it wrong in turn.
#[test]
fn every_wrong_size_is_told_with_the_right_one() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let (nq, nv, nu) = (model.nq(), model.nv(), model.nu());
    let body = model.body("torso").unwrap().id();
    let (geom, site_model) = (model.geom(0).unwrap().id(), sample::humanoid());
    let numbers = |length: usize| vec![0.0; length];
    let vectors = |wanted: usize| [0, wanted - 1, wanted + 1];
    let shapes = |(rows, columns): (usize, usize)| [(rows, columns + 1), (rows + 1, columns), (columns, rows), (0, 0)];
    let told = |result: Result<()>, wanted: &str| {
        let error = result.unwrap_err();
        assert!(matches!(error, Error::Shape { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains(&format!("must have {wanted}")), "{text}");
    };
    drop(site_model);

    model.differentiate_pos(&mut numbers(nv), 1.0, &numbers(nq), &numbers(nq)).unwrap();
    model.integrate_pos(&mut numbers(nq), &numbers(nv), 1.0).unwrap();
    for wrong in vectors(nv) {
        told(model.differentiate_pos(&mut numbers(wrong), 1.0, &numbers(nq), &numbers(nq)), &format!("({nv})"));
        told(model.integrate_pos(&mut numbers(nq), &numbers(wrong), 1.0), &format!("({nv})"));
    }
    for wrong in vectors(nq) {
        told(model.differentiate_pos(&mut numbers(nv), 1.0, &numbers(wrong), &numbers(nq)), &format!("({nq})"));
        told(model.differentiate_pos(&mut numbers(nv), 1.0, &numbers(nq), &numbers(wrong)), &format!("({nq})"));
        told(model.integrate_pos(&mut numbers(wrong), &numbers(nv), 1.0), &format!("({nq})"));
    }
    for dt in [0.0, f64::NAN, f64::INFINITY] {
        text_of(
            model.differentiate_pos(&mut numbers(nv), dt, &numbers(nq), &numbers(nq)),
            &["dt is", "finite and not zero"],
        );
    }
    text_of(model.integrate_pos(&mut numbers(nq), &numbers(nv), f64::NAN), &["dt is NaN"]);

    let full = |shape: (usize, usize)| Matrix::zeros(shape.0, shape.1);
    data.full_m_into(&mut full((nv, nv))).unwrap();
    data.mul_m(&mut numbers(nv), &numbers(nv)).unwrap();
    data.solve_m(&mut numbers(nv), &numbers(nv)).unwrap();
    data.solve_m(&mut numbers(3 * nv), &numbers(3 * nv)).unwrap();
    for wrong in [(nv, nv + 1), (nv + 1, nv), (0, 0), (nv * nv, 1)] {
        told(data.full_m_into(&mut full(wrong)), &format!("({nv}, {nv})"));
    }
    for wrong in vectors(nv) {
        told(data.mul_m(&mut numbers(wrong), &numbers(nv)), &format!("({nv})"));
        told(data.mul_m(&mut numbers(nv), &numbers(wrong)), &format!("({nv})"));
        told(data.solve_m(&mut numbers(nv), &numbers(wrong)), "");
        told(data.solve_m(&mut numbers(wrong), &numbers(nv)), &format!("({nv})"));
    }
    told(data.solve_m(&mut numbers(2 * nv), &numbers(nv)), &format!("({nv})"));
    told(data.solve_m(&mut numbers(2 * nv), &numbers(2 * nv + 1)), "");

    let wanted = (3, nv);
    data.jac_into(body, [0.0; 3], Some(&mut full(wanted)), Some(&mut full(wanted))).unwrap();
    for wrong in shapes(wanted) {
        let text = format!("(3, {nv})");
        told(data.jac_into(body, [0.0; 3], Some(&mut full(wrong)), None), &text);
        told(data.jac_into(body, [0.0; 3], None, Some(&mut full(wrong))), &text);
        told(data.jac_body_into(body, Some(&mut full(wrong)), None), &text);
        told(data.jac_body_com_into(body, None, Some(&mut full(wrong))), &text);
        told(data.jac_geom_into(geom, Some(&mut full(wanted)), Some(&mut full(wrong))), &text);
        told(data.jac_subtree_com_into(body, &mut full(wrong)), &text);
    }

    for spec in [StateSpec::PHYSICS, StateSpec::INTEGRATION, StateSpec::empty()] {
        let size = model.state_size(spec);
        data.state_into(spec, &mut numbers(size)).unwrap();
        for wrong in [size + 1, size.saturating_sub(1)].into_iter().filter(|&wrong| wrong != size) {
            told(data.state_into(spec, &mut numbers(wrong)), &format!("({size})"));
            told(data.set_state(spec, &numbers(wrong)), &format!("({size})"));
        }
    }
    let size = nq + nv;
    for wrong in vectors(size) {
        told(data.physics_state_into(&mut numbers(wrong)), &format!("({size})"));
        told(data.set_physics_state(&numbers(wrong)), &format!("({size})"));
    }

    told(Lqr::with_gain(&data, full((nu, 2 * nv + 1))).map(drop), &format!("({nu}, {})", 2 * nv));
    told(Lqr::with_gain(&data, full((2 * nv, nu))).map(drop), &format!("({nu}, {})", 2 * nv));
    let mut other = Data::new(sample::cartpole()).unwrap();
    told(Lqr::with_gain(&data, full((nu, 2 * nv))).unwrap().control(&mut other), "");
    told(PdController::new(&model, 1.0, 1.0).control(&mut other), "");
    told(Trajectory::new(&model).push(&other), "");
}

#[test]
fn every_wrong_shape_of_a_linearisation_is_told() {
    let model = Model::from_xml_str(
        r#"<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
           <actuator><motor joint="j"/><general joint="j" dyntype="filter"/></actuator>
           <sensor><jointpos joint="j"/><jointvel joint="j"/><jointpos joint="j"/><jointpos joint="j"/></sensor></mujoco>"#,
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    let good = data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!([&good.a, &good.b, &good.c, &good.d].map(|matrix| matrix.shape()), [(3, 3), (3, 2), (4, 3), (4, 2)]);
    let fields: [fn(&mut StateSpace) -> &mut Matrix; 4] =
        [|it| &mut it.a, |it| &mut it.b, |it| &mut it.c, |it| &mut it.d];
    for (field, name) in fields.into_iter().zip(["A of", "B of", "C of", "D of"]) {
        let (rows, columns) = field(&mut good.clone()).shape();
        for wrong in [(rows + 1, columns), (rows, columns + 1), (0, 0), (rows * columns, 1)] {
            let mut system = good.clone();
            *field(&mut system) = Matrix::zeros(wrong.0, wrong.1);
            let result = data.transition_fd_into(1e-6, Differences::Central, &mut system);
            text_of(result, &[name, "transition_fd", &format!("must have ({rows}, {columns})")]);
        }
    }
    for eps in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        text_of(data.transition_fd(eps, Differences::Forward), &["eps", "between 1e-12 and 1"]);
    }
    data.transition_fd_into(1e-6, Differences::Forward, TransitionOutputs::default()).unwrap();
}

#[test]
fn weights_of_wrong_shapes_and_no_regulator_are_told() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let good = || LqrWeights { q: DMatrix::identity(4, 4), r: DMatrix::identity(1, 1), s: None };
    Lqr::at_present_state(&mut data, &good()).unwrap();
    for wrong in [
        LqrWeights { q: DMatrix::identity(3, 3), ..good() },
        LqrWeights { r: DMatrix::identity(2, 2), ..good() },
        LqrWeights { s: Some(DMatrix::zeros(1, 4)), ..good() },
        LqrWeights { r: -DMatrix::identity(1, 1), ..good() },
        LqrWeights { q: DMatrix::from_element(4, 4, f64::NAN), ..good() },
    ] {
        text_of(Lqr::at_present_state(&mut data, &wrong), &["there is no regulator"]);
    }
}

#[test]
fn a_control_that_is_no_number_is_told_and_nothing_has_changed() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.step().unwrap();
    for value in [f64::NAN, f64::INFINITY, -1e11] {
        data.ctrl_mut()[0] = value;
        let before = data.state(StateSpec::FULL_PHYSICS);
        for result in [
            data.step(),
            data.step1(),
            data.forward(),
            data.inverse(),
            data.transition_fd(1e-6, Differences::Forward).map(drop),
        ] {
            text_of(
                result,
                &["the controls are not usable at time 0.01 s", "ctrl[0] of actuator 'slide'", &format!("{value}")],
            );
        }
        assert_eq!(data.state(StateSpec::FULL_PHYSICS), before);
        assert!(data.ctrl()[0].to_bits() == value.to_bits());
    }
    data.ctrl_mut()[0] = 0.0;
    data.step().unwrap();
}

#[test]
fn a_position_or_velocity_that_is_no_number_is_told_and_nothing_has_changed() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    for value in [f64::NAN, f64::NEG_INFINITY, 1e11] {
        data.reset().unwrap();
        data.qpos_mut()[3] = value;
        text_of(
            data.step(),
            &["the simulation is unstable at time 0 s", "qpos[3] of joint 'root'", &value.to_string(), "1e10"],
        );
        let Err(Error::Unstable(found)) = data.step() else { panic!("still an error") };
        assert_eq!((found.quantity, found.index, found.time), (Quantity::Position, 3, 0.0));
        data.reset().unwrap();
        let knee = data.model().joint("left_knee").unwrap().dofs().start;
        data.qvel_mut()[knee] = value;
        text_of(data.step(), &[&format!("qvel[{knee}] of joint 'left_knee'")]);
        data.qvel_mut()[knee] = 0.0;
        data.step().unwrap();
    }
}

#[test]
fn an_explosion_in_the_middle_of_a_step_is_told_and_only_a_reset_helps() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    for _ in 0..10 {
        data.step().unwrap();
    }
    let time = data.time();
    data.qfrc_applied_mut()[7] = 1e300;
    let text = text_of(data.step(), &["the simulation is unstable", "qacc[", "of joint", "smaller timestep"]);
    assert!(text.contains(&format!("at time {time} s")), "the time of the step, not of the reset: {text}");
    text_of(data.step(), &["unusable since", "qacc[", "reset it first"]);
    data.reset().unwrap();
    data.step().unwrap();

    data.xfrc_applied_mut()[1] = [f64::NAN; 6];
    assert!(matches!(data.step(), Err(Error::Unstable(found)) if found.quantity == Quantity::Acceleration));
    data.reset().unwrap();
    assert_eq!(data.xfrc_applied()[1], [0.0; 6], "a reset clears what was applied");
    data.step().unwrap();
}

#[test]
fn a_stack_that_is_too_small_is_told_and_the_data_refuses_all_but_a_reset() {
    let mut data = Data::new(small_stack()).unwrap();
    let error = overflow(&mut data);
    assert!(matches!(&error, Error::Engine { function: "mj_step", message } if message == "Stack overflow"), "{error}");
    assert_eq!(error.to_string(), "the engine failed in mj_step: Stack overflow");

    let body = data.model().body(1).unwrap().id();
    let nv = data.model().nv();
    let (mut result, vector) = (vec![0.0; nv], vec![0.0; nv]);
    let refused: [Result<()>; 14] = [
        data.step(),
        data.step1(),
        data.step2(),
        data.forward(),
        data.inverse(),
        data.transition_fd(1e-6, Differences::Forward).map(drop),
        data.jac_body(body).map(drop),
        data.jac_body_com(body).map(drop),
        data.jac(body, [0.0; 3]).map(drop),
        data.jac_subtree_com(body).map(drop),
        data.full_m().map(drop),
        data.mul_m(&mut result, &vector),
        data.solve_m(&mut result, &vector),
        data.clone().step(),
    ];
    for result in refused {
        assert!(matches!(result, Err(Error::Poisoned { .. })));
        text_of(result, &["unusable since the engine failed in mj_step: Stack overflow", "reset it first"]);
    }
    assert!(data.contacts().all(|contact| matches!(contact.force(), Err(Error::Poisoned { .. }))));
    let mut copy = Data::new(data.model().clone()).unwrap();
    copy.copy_from(&data).unwrap();
    assert!(matches!(copy.step(), Err(Error::Poisoned { .. })));
    assert!(format!("{data:?}").contains("unusable since"));

    // The engine's stack is as it was, however often it overflows.
    for _ in 0..20 {
        data.reset().unwrap();
        data.step().unwrap();
        assert!(matches!(overflow(&mut data), Error::Engine { .. }));
    }
    copy.reset().unwrap();
    data.copy_from(&copy).unwrap();
    data.step().unwrap();
}

#[test]
fn what_was_not_computed_is_not_handed_out() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let body = data.model().body("torso").unwrap().id();
    let needs = ["position-dependent quantities", "call forward or step first"];
    text_of(data.jac_body(body), &["jac_body needs", needs[0], needs[1]]);
    text_of(data.jac_subtree_com(body), &["jac_subtree_com needs", needs[0]]);
    text_of(data.full_m(), &["full_m needs", needs[0]]);
    let nv = data.model().nv();
    text_of(data.mul_m(&mut vec![0.0; nv], &vec![0.0; nv]), &["mul_m needs", needs[0]]);
    text_of(data.solve_m(&mut vec![0.0; nv], &vec![0.0; nv]), &["solve_m needs", needs[0]]);
    text_of(data.step2(), &["step2 needs velocity-dependent quantities", "call step1 first"]);

    data.step().unwrap();
    data.step1().unwrap();
    assert_eq!(data.stage(), Stage::Velocity);
    assert!(data.contacts().len() > 0);
    for contact in data.contacts() {
        text_of(contact.force(), &["contact force needs forces and accelerations", "call forward or step first"]);
        text_of(contact.force_in_world(), &["contact force needs"]);
    }
    data.step2().unwrap();
    assert!(data.contacts().all(|contact| contact.force().is_ok()));
    data.edit_model(|model| model.options(|options| options.cone = mujoco_safe::Cone::Elliptic)).unwrap().unwrap();
    assert!(data.contacts().all(|contact| contact.force().is_err()));
}

#[test]
fn runge_kutta_is_not_linearised() {
    let mut model = sample::cartpole();
    model.edit().options(|options| options.integrator = Integrator::Rk4).unwrap();
    let mut data = Data::new(model).unwrap();
    text_of(data.transition_fd(1e-6, Differences::Central), &["transition_fd", "Euler", "Implicit", "Rk4"]);
    data.step().unwrap();
}

#[test]
fn an_option_out_of_range_is_told_and_nothing_has_changed() {
    type Change = fn(&mut mujoco_safe::Options);
    let mut model = sample::cartpole();
    let before = model.options();
    let changes: [(Change, &[&str]); 9] = [
        (|options| options.timestep = -1.0, &["the option timestep is -1", "positive and finite"]),
        (|options| options.timestep = f64::NAN, &["timestep is NaN"]),
        (|options| options.impratio = 0.0, &["impratio is 0"]),
        (|options| options.tolerance = -1.0, &["tolerance is -1", "not negative"]),
        (|options| options.gravity[1] = f64::INFINITY, &["gravity", "inf", "finite"]),
        (|options| options.iterations = usize::MAX, &["iterations", "a million"]),
        (|options| options.density = f64::NAN, &["density is NaN"]),
        (|options| options.o_solimp[4] = f64::NAN, &["o_solimp"]),
        (|options| options.mpr_iterations = 1 << 32, &["mpr_iterations is 4294967296"]),
    ];
    for (change, parts) in changes {
        text_of(model.edit().options(change), parts);
        assert_eq!(model.options(), before);
    }
    text_of(model.edit().set_timestep(0.0), &["timestep is 0"]);
}

#[test]
fn a_damaged_trajectory_file_is_told_with_its_line() {
    let model = sample::cartpole();
    let load = |content: &str| {
        let file = File::new("damaged.csv", content);
        Trajectory::load_csv(&model, &file.0)
    };
    let header = "time,qpos0,qpos1,qvel0,qvel1,ctrl0\n";
    assert_eq!(load(&format!("{header}0,1,2,3,4,5\n")).unwrap().len(), 1);
    text_of(load(""), &["damaged.csv", "line 1"]);
    text_of(load("time,x\n"), &["line 1 is not the header", "found 2"]);
    text_of(load(&format!("{header}0,1,2,3,4,5\n0,1,2,3,4\n")), &["line 3 has 5 columns, not 6"]);
    text_of(load(&format!("{header}0,1,two,3,4,5\n")), &["line 2: 'two' is not a number"]);
}

#[test]
fn saving_where_nothing_can_be_saved_is_told() {
    let model = sample::cartpole();
    // Other tests load models at the same time, so the XML may be replaced at any moment: then that is the error.
    let told = |path: &str, part: &str| {
        let text = model.save_xml(path).unwrap_err().to_string();
        assert!(text.contains(part) && text.contains(path) || text.contains("another one was loaded since"), "{text}");
    };
    told("no/such/folder/model.xml", "No such file or directory");
    told("/tmp", "directory");
    told("/dev/full", "No space left on device");
    told("/proc/version", ": ");
    sample::humanoid();
    text_of(model.save_xml("unused.xml"), &["another one was loaded since", "save before loading the next"]);
    assert!(!PathBuf::from("unused.xml").exists());
}

#[test]
fn two_threads_that_fail_at_once_each_get_their_own_message() {
    const ROUNDS: usize = 1000;
    let stack = Arc::new(small_stack());
    // Bodies without mass, whose inertia the implicit integrator cannot factorise.
    let mut massless = sample::cartpole();
    let mut edit = massless.edit();
    edit.options(|options| options.integrator = Integrator::Implicit).unwrap();
    edit.body_mass_mut().fill(0.0);
    edit.body_inertia_mut().as_flattened_mut().fill(0.0);
    edit.dof_armature_mut().fill(0.0);
    edit.dof_damping_mut().fill(0.0);
    let massless = Arc::new(massless);

    // A panic between the barriers would leave the other threads waiting, so what is wrong is told at the end.
    let barrier = Barrier::new(3);
    let rounds = |wanted: &(dyn Fn(usize) -> String + Sync), mut fail: Box<dyn FnMut(usize) -> String + '_>| {
        let mut wrong = Vec::new();
        for round in 0..ROUNDS {
            barrier.wait();
            let text = fail(round);
            if !text.contains(&wanted(round)) {
                wrong.push(text);
            }
        }
        wrong
    };
    let failing = |model: &Arc<Model>, steps: usize| {
        let mut data = Data::new(model.clone()).unwrap();
        move |_: usize| {
            data.reset().unwrap();
            (0..steps).find_map(|_| data.step().err()).map_or("no error".to_owned(), |error| error.to_string())
        }
    };
    let (stack, massless) = (failing(&stack, 200), failing(&massless, 1));
    let load = |round| {
        let result = Model::from_xml_str(&format!("<mujoco><e{round}/></mujoco>"));
        result.map_or_else(|error| error.to_string(), |_| "no error".to_owned())
    };
    let wrong: Vec<String> = std::thread::scope(|scope| {
        [
            scope.spawn(|| rounds(&|_| "the engine failed in mj_step: Stack overflow".to_owned(), Box::new(stack))),
            scope.spawn(|| {
                rounds(&|_| "the engine failed in mj_step: diagonal element too small".to_owned(), Box::new(massless))
            }),
            scope.spawn(|| rounds(&|round| format!("'e{round}'"), Box::new(load))),
        ]
        .into_iter()
        .flat_map(|thread| thread.join().unwrap())
        .collect()
    });
    assert_eq!(wrong.first(), None, "{} of them are wrong", wrong.len());
}
