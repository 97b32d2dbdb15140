//! A humanoid balances on one leg. The modules of the example `humanoid_lqr` are included here; the
//! program itself is run at the end.

use std::path::Path;
use std::sync::LazyLock;

use mujoco_safe::{Controller, Data, Differences, Lqr, sample};

use crate::cases::cases;
use crate::examples::{program, text};
use crate::installed::has;
use crate::set_point::{SetPoint, Sweep};
use crate::simulate::{Disturbance, PUSH_AT, Push, Run, simulate};
use crate::weights::{Dofs, weights};

/// A robot and its regulator.
struct Balance {
    data: Data,
    set_point: SetPoint,
    sweep: Sweep,
    dofs: Dofs,
    lqr: Lqr,
    residual: f64,
    spectral_radius: f64,
}

/// The bundled humanoid on its left leg. The height of the set-point takes thousands of inverse
/// dynamics.
static BALANCE: LazyLock<Balance> = LazyLock::new(|| {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let model = data.model().clone();
    let (torso, foot) = (model.body("torso").unwrap(), model.body("foot_left").unwrap());
    let dofs = Dofs::of(&model, torso, foot);
    let keyframe = model.keyframe("stand_on_left_leg").unwrap().id();
    let (set_point, sweep) = SetPoint::near(&mut data, keyframe).unwrap();
    set_point.apply(&mut data).unwrap();
    let weights = weights(&mut data, torso, foot, &dofs).unwrap();
    let system = data.transition_fd(Lqr::EPS, Differences::Central).unwrap();
    let solution = Lqr::solve(&system, &weights).unwrap();
    let lqr = Lqr::with_gain(&data, solution.k).unwrap();
    let (residual, spectral_radius) = (solution.relative_residual, solution.spectral_radius);
    Balance { data, set_point, sweep, dofs, lqr, residual, spectral_radius }
});

impl Balance {
    fn simulate_with(&self, controller: &mut dyn Controller, seconds: f64, disturbance: Disturbance) -> Run {
        let torso = self.data.model().body("torso").unwrap();
        simulate(&mut self.data.clone(), controller, &self.set_point, torso, seconds, disturbance).unwrap()
    }

    fn simulate(&self, seconds: f64, disturbance: Disturbance) -> Run {
        self.simulate_with(&mut self.lqr.clone(), seconds, disturbance)
    }

    fn pushed(&self, force: [f64; 2]) -> Run {
        let push = Push { force, start: PUSH_AT, duration: 0.1 };
        self.simulate(10.0, Disturbance { push: Some(push), ..Disturbance::default() })
    }
}

#[test]
fn the_equilibrium_height_is_within_a_millimetre_of_the_keyframe() {
    let balance = &*BALANCE;
    let offset = balance.set_point.offset;
    assert!(offset.abs() < 0.9e-3, "the best offset is {offset} m");
    assert_eq!((balance.sweep.heights.first(), balance.sweep.heights.last()), (Some(&-1e-3), Some(&1e-3)));
    // The force decreases as the pose is lowered, and equals the weight in the air.
    let weight = balance.data.model().body_mass().iter().sum::<f64>() * 9.81;
    assert!(balance.sweep.forces.windows(2).all(|pair| pair[0] <= pair[1] + 1e-9));
    assert!((balance.sweep.forces.last().unwrap() - weight).abs() < 1e-6 * weight);
    // At the keyframe itself, the pose would need an unphysical force of more than half the weight:
    // the point of the tutorial.
    assert!(balance.set_point.at_keyframe[2] > 0.5 * weight);
}

#[test]
fn the_motors_can_hold_the_set_point() {
    let balance = &*BALANCE;
    let model = balance.data.model();
    for (ctrl, range) in balance.set_point.ctrl.iter().zip(model.actuator_ctrlrange()) {
        assert!((range[0]..=range[1]).contains(ctrl), "{ctrl} is outside of {range:?}");
    }
    let error = balance.set_point.force_error(balance.dofs.free.end..model.nv());
    assert!(error < 1e-9, "the joint forces are off by {error} N·m");
}

#[test]
fn dofs_of_the_standing_leg_and_the_trunk_are_classified() {
    let balance = &*BALANCE;
    let model = balance.data.model();
    let mut by_name: Vec<usize> = model
        .joints()
        .filter(|joint| {
            let name = joint.name().expect("all joints have names");
            name.contains("abdomen")
                || name.contains("left") && ["hip", "knee", "ankle"].iter().any(|part| name.contains(part))
        })
        .flat_map(|joint| joint.dofs())
        .collect();
    by_name.sort_unstable();
    assert_eq!(balance.dofs.balance, by_name);
    assert_eq!(balance.dofs.free, 0..6);
    assert_eq!(balance.dofs.balance.len() + balance.dofs.other.len() + 6, model.nv());
}

#[test]
fn the_riccati_equation_is_solved_and_the_closed_loop_is_stable() {
    let balance = &*BALANCE;
    assert!(balance.residual < 1e-10, "the relative residual is {}", balance.residual);
    assert!(balance.spectral_radius < 1.0, "the spectral radius is {}", balance.spectral_radius);
}

#[test]
fn the_humanoid_stands_for_thirty_seconds() {
    let run = BALANCE.simulate(30.0, Disturbance::default());
    assert!(run.upright(), "the humanoid fell at {:?} s", run.fell_at);
    assert_eq!(run.trajectory.len(), 6000);
    assert!((run.final_height() - run.com[0][2]).abs() < 0.01, "final height {} m", run.final_height());
}

#[test]
fn the_humanoid_stands_with_noise_for_every_seed() {
    let balance = &*BALANCE;
    for seed in 1..=cases(2, 5) {
        let run = balance.simulate(10.0, Disturbance { noise: 0.05, seed, ..Disturbance::default() });
        assert!(run.upright(), "with seed {seed} the humanoid fell at {:?} s", run.fell_at);
    }
}

#[test]
fn the_humanoid_recovers_from_pushes_in_every_direction() {
    let balance = &*BALANCE;
    let calm = balance.simulate(10.0, Disturbance::default());
    let forces = [[20.0, 0.0], [0.0, -20.0], [-20.0, 0.0], [0.0, 20.0]];
    for &force in &forces[..cases(2, 4)] {
        let run = balance.pushed(force);
        assert!(run.upright(), "pushed with {force:?} N the humanoid fell at {:?} s", run.fell_at);
        assert_ne!(run.trajectory, calm.trajectory, "the push has no effect");
    }
}

#[test]
fn the_humanoid_falls_with_constant_controls() {
    let balance = &*BALANCE;
    let ctrl = balance.set_point.ctrl.clone();
    let mut constant = move |data: &mut Data| data.ctrl_mut().copy_from_slice(&ctrl);
    let run = balance.simulate_with(&mut constant, 10.0, Disturbance::default());
    let fell_at = run.fell_at.expect("the humanoid must fall");
    assert!(fell_at < 3.0, "the humanoid fell only after {fell_at} s");
}

#[test]
fn the_example_prints_one_json_object_and_writes_no_files() {
    let output = program("humanoid_lqr", &["--json", "--seconds", "2"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let figures: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a single JSON object");
    assert_eq!(figures["upright"], true);
    assert_eq!(figures["A"].as_array().unwrap().len(), 54);
    assert_eq!(figures["K"][0].as_array().unwrap().len(), 54);
    assert!(figures["offset"].as_f64().unwrap().abs() < 1e-3);
    assert!(figures["residual"].as_f64().unwrap() < 1e-10);
    assert!(figures["open_loop_fell_at"].is_number());
}

#[test]
fn the_example_writes_its_plots_and_trajectory_to_the_given_directory() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("made/on/demand");
    let output = program("humanoid_lqr", &["--seconds", "1", "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for plot in ["humanoid_force.svg", "humanoid_balance.svg"] {
        let svg = std::fs::read_to_string(out.join(plot)).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{plot} is no SVG");
    }
    let trajectory = mujoco_safe::Trajectory::load_csv(&sample::humanoid(), out.join("humanoid.csv")).unwrap();
    assert_eq!(trajectory.len(), 200);
}

#[test]
fn the_example_accepts_other_humanoids() {
    // The bundled humanoid under other names, with a head 10 % heavier, on a harder floor.
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("other.xml");
    let other = sample::HUMANOID_XML
        .replace("name=\"torso\"", "name=\"chest_of_other\"")
        .replace("body=\"torso\"", "body=\"chest_of_other\"")
        .replace("name=\"foot_left\"", "name=\"left_sole\"")
        .replace("name=\"stand_on_left_leg\"", "name=\"crane\"")
        .replace("mass=\"2.8\"", "mass=\"3.08\"")
        .replace("solref=\".015 1\"", "solref=\".012 1\"");
    std::fs::write(&path, other).unwrap();
    let path = path.to_str().unwrap();
    let output = program(
        "humanoid_lqr",
        &["--model", path, "--keyframe", "crane", "--torso", "chest_of_other", "--foot", "left_sole"],
    );
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
}

/// A pose on the left leg, found for this test: the engine's sample humanoid has other joints and
/// no keyframe.
const SAMPLE_ON_ONE_LEG: &str = "0 0 1.25785 0.98186988 -0.18944998 -0.00623 -0.0012 0 0 0.34907 -0.03491 0 -0.7854 -1.309 0 0 \
                                 0.06108 0 -0.09266 -0.13963 -0.0364 0.10425 0 0 0 0 0 0";

#[test]
fn the_example_balances_the_engines_sample_humanoid() {
    let sample = Path::new(sample::SYSTEM_MODELS).join("humanoid/humanoid.xml");
    if !has("libmujoco-samples", sample.exists()) {
        return;
    }
    let xml = std::fs::read_to_string(&sample).unwrap();
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("one_leg.xml");
    let keyframe = format!("<keyframe><key name=\"one_leg\" qpos=\"{SAMPLE_ON_ONE_LEG}\"/></keyframe></mujoco>");
    std::fs::write(&path, xml.replace("</mujoco>", &keyframe)).unwrap();
    let path = path.to_str().unwrap();
    for push in cases(&["0,20"][..], &["20,0", "0,20"]) {
        let output =
            program("humanoid_lqr", &["--model", path, "--keyframe", "one_leg", "--foot", "left_foot", "--push", push]);
        assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
        assert!(text(&output.stdout).contains("with constant controls it falls"));
    }
}

#[test]
fn the_example_reports_invalid_arguments() {
    for (arguments, expected) in [
        (&["--foot", "foot_lft"][..], "did you mean 'foot_left'"),
        (&["--keyframe", "crane"], "known names: squat, stand_on_left_leg, stand"),
        (&["--model", "no/such/model.xml"], "no/such/model.xml: No such file"),
        (&["--seconds", "long"], "invalid value 'long' for '--seconds <S>'"),
        (&["--push", "1"], "expected FX,FY or FX,FY,SECONDS, such as 20,0"),
        (&["--speed"], "unexpected argument '--speed' found"),
    ] {
        let output = program("humanoid_lqr", arguments);
        let message = text(&output.stderr);
        assert!(!output.status.success(), "{arguments:?} was accepted");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
}
