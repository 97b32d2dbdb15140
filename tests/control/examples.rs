//! The control examples reach their goals. Their modules are included here; the programs are run at
//! the end.
//!
//! Tests that take minutes are ignored by default: `scripts/test --slow`.

use std::process::{Command, Output};
use std::sync::Arc;

use mujoco_safe::{Data, Model, Trajectory, sample};

use crate::cases::cases;
use crate::robot::{NEWTONS, Robot};
use crate::simulate::Push;
use crate::{attempt, example, planner, robot, swing_up};

/// Swings a pole up, and checks the plan and the trajectory.
fn swing_up(model: &Arc<Model>, seed: u64) {
    let attempt = swing_up::attempt(model, seed, 2).unwrap();
    let plan = &attempt.plan;
    assert!(attempt.up_at.is_some_and(|time| time < 4.5), "seed {seed}: up from {:?} s on", attempt.up_at);
    assert!(plan.costs.windows(2).all(|pair| pair[1] < pair[0]), "seed {seed}: {:?}", plan.costs);
    assert!(plan.controls.as_slice().iter().all(|ctrl| ctrl.abs() <= 1.0), "seed {seed}");
    assert!(plan.controls.as_slice().iter().any(|ctrl| ctrl.abs() == 1.0), "seed {seed} never presses against a limit");
    // The pole hangs at first, and the cart stays on the rail.
    let trajectory = &attempt.trajectory;
    assert!(trajectory.qpos(0)[1].cos() < -0.9);
    assert!((0..trajectory.len()).all(|record| trajectory.qpos(record)[0].abs() < 1.0), "seed {seed} leaves the rail");
    // Without disturbance, the motion is the planned motion.
    let mut data = Data::new(model.clone()).unwrap();
    data.set_physics_state(plan.states.row(0)).unwrap();
    for controls in plan.controls.rows() {
        data.ctrl_mut().copy_from_slice(controls);
        data.step().unwrap();
    }
    assert_eq!(data.physics_state(), plan.states.row(plan.states.nrows() - 1), "seed {seed}");
    assert!(swing_up::lean(data.qpos()[1]).abs() < 0.1, "seed {seed} plans to be at {}", data.qpos()[1]);
}

#[test]
fn the_pole_is_swung_up_and_held() {
    // The other runs have the swing-up in predictive.
    if cases(false, true) {
        swing_up(&Arc::new(sample::cartpole()), 1);
    }
}

#[test]
#[ignore = "takes a minute"]
fn the_pole_is_swung_up_and_held_for_every_seed() {
    let model = Arc::new(sample::cartpole());
    (1..=5).for_each(|seed| swing_up(&model, seed));
}

#[test]
fn pushes_cover_all_directions() {
    let mut angles: Vec<f64> = (1..=5)
        .map(|seed| {
            let [x, y] = robot::push(100.0, seed).force;
            assert!((x.hypot(y) - 100.0).abs() < 1e-9);
            y.atan2(x).to_degrees()
        })
        .collect();
    angles.sort_by(f64::total_cmp);
    let first = angles[0] + 360.0;
    angles.push(first);
    assert!(angles.windows(2).all(|pair| pair[1] - pair[0] < 100.0), "{angles:?}");
}

#[test]
#[ignore = "takes ten seconds"]
fn the_planner_survives_a_push_that_the_regulator_does_not() {
    let robot = Robot::new().unwrap();
    // The regulator falls soon after this push.
    let push = Push { start: 0.2, ..robot::push(NEWTONS, 5) };
    let attempt = attempt::attempt(&robot, push, 5, 1.25).unwrap();
    assert!(attempt.regulated.fell_at.is_some(), "the regulator withstands this push");
    assert!(attempt.planned.upright(), "the humanoid fell at {:?} s", attempt.planned.fell_at);
    assert_eq!(attempt.decisions.len(), attempt.planned.trajectory.len().div_ceil(planner::STEPS));
    // Before the push, the humanoid moves as little as under the regulator.
    let moved = |com: &[[f64; 3]]| (com[39][0] - com[0][0]).hypot(com[39][1] - com[0][1]);
    assert!(moved(&attempt.planned.com) < moved(&attempt.regulated.com) + 0.01);
}

#[test]
#[ignore = "takes minutes"]
fn the_planner_survives_every_push() {
    let robot = Robot::new().unwrap();
    for seed in 1..=3 {
        let attempt = attempt::attempt(&robot, robot::push(NEWTONS, seed), seed, 6.0).unwrap();
        let fates = (attempt.regulated.fell_at, attempt.planned.fell_at);
        assert!(
            attempt.succeeded(),
            "push {seed}: the regulator fell at {:?} s, the planner at {:?}",
            fates.0,
            fates.1
        );
    }
}

/// Runs an example in the profile of this test.
pub(crate) fn program(name: &str, arguments: &[&str]) -> Output {
    Command::new(example::build(name)).args(arguments).output().unwrap()
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn examples_write_their_plots_to_the_given_directory() {
    // The other runs have the plots of humanoid_lqr, in humanoid_balance.
    if !cases(false, true) {
        return;
    }
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("made/on/demand");
    let to = out.to_str().unwrap();
    let is_svg = |plot: &str| {
        let svg = std::fs::read_to_string(out.join(plot)).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{plot} is no SVG");
        svg
    };
    let output = program("cartpole_swing_up", &["--seeds", "1", "--out", to]);
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
    is_svg("cartpole_swing_up.svg");
    // These runs end before the push, so neither falls.
    let output = program("humanoid_predictive", &["--seeds", "1", "--seconds", "0.1", "--threads", "2", "--out", to]);
    assert!(!output.status.success(), "{}", text(&output.stdout));
    assert!(text(&output.stdout).contains("LQR stands, planner stands"), "{}", text(&output.stdout));
    is_svg("humanoid_predictive.svg");
    let trajectory = Trajectory::load_csv(&sample::humanoid(), out.join("humanoid_predictive.csv"));
    assert_eq!(trajectory.unwrap().len(), 20);
    // A series of pushes.
    let output = program("humanoid_predictive", &["--pushes", "3", "--seconds", "0.02", "--threads", "2", "--out", to]);
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{printed}{}", text(&output.stderr));
    assert!(printed.contains("all                   3          0              0"), "{printed}");
    let csv = std::fs::read_to_string(out.join("humanoid_pushes.csv")).unwrap();
    let seeds: Vec<&str> = csv.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(seeds.len(), 3, "{csv}");
    assert!(csv.lines().skip(1).all(|line| line.ends_with(",,")), "{csv}");
    assert!(is_svg("humanoid_pushes.svg").contains("planner: 0 falls in 3 pushes"));
}

#[test]
fn examples_report_invalid_arguments() {
    let some = [
        ("humanoid_lqr", ["--speed", "1"], "unexpected argument '--speed'"),
        ("humanoid_lqr", ["--seconds", "-1"], "'-1' for '--seconds"),
        ("humanoid_lqr", ["--push", "-20,north"], "'-20,north' for '--push"),
    ];
    let others = [
        ("cartpole_swing_up", ["--seeds", "many"], "'many' for '--seeds"),
        ("humanoid_predictive", ["--newtons", "hard"], "'hard' for '--newtons"),
        ("humanoid_predictive", ["--threads", "-1"], "unexpected argument '-1'"),
        ("humanoid_predictive", ["--first-seed", "7"], "--pushes <N>"),
        ("cartpole_lqr", ["--angle", "steep"], "'steep' for '--angle"),
        ("rollouts", ["--rollouts", "-1"], "unexpected argument '-1'"),
        ("rollouts", ["many", "pushes"], "unexpected argument 'many'"),
        ("humanoid_stand_up", ["--seconds", "-1"], "unexpected argument '-1'"),
        ("arm_tracking", ["--seconds", "long"], "'long' for '--seconds"),
        ("learn_gait", ["--iterations", "all"], "'all' for '--iterations"),
    ];
    for (name, arguments, expected) in some.iter().chain(cases(&[][..], &others)) {
        let output = program(name, arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name} {arguments:?}: {message}");
        assert!(message.contains(*expected), "{name} {arguments:?}: {message}");
    }
}

#[test]
fn examples_list_their_options() {
    for name in cases(&["humanoid_lqr"][..], &["contacts", "humanoid_lqr"]) {
        let output = program(name, &["--help"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("--out <DIR>"), "{}", text(&output.stdout));
    }
}
