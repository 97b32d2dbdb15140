//! Ticks that tests/oracle/ik.py has recorded with mink 1.3.0 and daqp 0.11.0.

use mujoco_safe::control::residual::{JointPosition, JointVelocity, Subtree};
use mujoco_safe::ik::{Ik, Task};
use mujoco_safe::{Data, sample};
use serde_json::Value;

use crate::humanoid;

fn recorded() -> Value {
    serde_json::from_str(include_str!("../oracle/ik.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn a_tick_equals_mink() {
    let recorded = &recorded()["tick"];
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.set_velocity_limits(1.0).unwrap();
    // mink's costs are square roots of the weights, and its tasks of joints exclude free ones.
    let com = ik.add_task(Task::new(Subtree::com(&model, "torso").unwrap()));
    let of_hinges: Vec<f64> = (0..model.nv()).map(|dof| f64::from(u8::from(dof >= 6))).collect();
    let posture = Task::new(JointPosition::all(&model)).with_weight(0.1 * 0.1).with_gain(0.5);
    let posture = ik.add_task(posture.with_weights(of_hinges.clone()));
    // mink's damping is of displacements, and ours of velocities.
    let factors: Vec<f64> = of_hinges.iter().map(|factor| 1e-3 + 0.05 * 0.05 * factor).collect();
    ik.add_task(Task::rate(JointVelocity::all(&model)).with_weight(0.01 * 0.01).with_weights(factors));
    ik.set_target(com, &numbers(&recorded["com"])).unwrap();
    ik.set_target(posture, &numbers(&recorded["posture"])).unwrap();
    ik.set_regularisation(0.0).unwrap();
    let expected = numbers(&recorded["velocity"]);
    let tick = ik.solve(&mut data, 0.01).unwrap();
    assert!(tick.is_solved() && !tick.active().is_empty());
    for (dof, (ours, theirs)) in tick.velocity().iter().zip(&expected).enumerate() {
        assert!((ours - theirs).abs() < 1e-6, "dof {dof}: {ours} and {theirs}");
    }
}

#[test]
fn the_errors_of_moving_targets_are_at_most_those_of_mink() {
    let expected = numbers(&recorded()["track"]["errors"]);
    let (mut data, mut ik, tasks) = humanoid();
    ik.set_velocity_limits(4.0).unwrap();
    let starts = ["hand_left", "hand_right"].map(|body| *data.body(body).unwrap().xpos());
    let mut sums = [0.0; 5];
    for step in 0..200 {
        let phase = std::f64::consts::TAU * f64::from(step + 1) * 0.01;
        let mut targets = [[0.0; 3]; 2];
        for (index, (start, side)) in starts.iter().zip([1.0, -1.0]).enumerate() {
            let moved = [0.15 * phase.sin(), side * 0.1 * (1.0 - phase.cos()), 0.15 * (1.0 - phase.cos())];
            targets[index] = std::array::from_fn(|axis| start[axis] + moved[axis]);
            let [x, y, z] = targets[index];
            ik.set_target(tasks[2 + index], &[x, y, z, 1.0, 0.0, 0.0, 0.0]).unwrap();
        }
        assert!(ik.step(&mut data, 0.01).unwrap().is_solved());
        // The errors after the tick.
        ik.solve(&mut data, 0.01).unwrap();
        for (sum, task) in sums.iter_mut().zip(tasks) {
            let error = ik.error(task).unwrap();
            let positions = if task == tasks[2] || task == tasks[3] { &error[..3] } else { error };
            *sum += positions.iter().map(|value| value * value).sum::<f64>().sqrt() / 200.0;
        }
    }
    for (task, (ours, theirs)) in sums.iter().zip(&expected).enumerate() {
        assert!(*ours <= 1.02 * theirs + 1e-6, "task {task}: {ours} and {theirs}");
    }
}
