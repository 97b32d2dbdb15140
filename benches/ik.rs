//! A tick of the inverse kinematics of the humanoid: 27 degrees of freedom and six tasks (poses of
//! both feet, positions of both hands, the centre of mass and a posture), with limits of positions
//! and velocities, while the hands follow moving targets. Also the quadratic program of a tick
//! alone.
//!
//! If the environment variable `MUJOCO_PYTHON` names a Python with mink, both run the same ticks
//! alternately, and the ratio of their times and the errors of both are printed.
//!
//! ```text
//! cargo bench --bench ik
//! MUJOCO_PYTHON=python3 cargo bench --bench ik     after: pip install mink==1.3.0 daqp
//! ```

mod common;

use std::env;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use common::peer::{Comparison, Peer};
use mujoco_safe::control::residual::{Frame, FramePose, JointPosition, Subtree};
use mujoco_safe::ik::{Ik, Task, TaskId};
use mujoco_safe::math::{Qp, QpProblem};
use mujoco_safe::{Data, Matrix, Result, sample};

const DT: f64 = 0.01;
/// Ticks of a run.
const TICKS: usize = 200;
/// Number of runs by each program.
const PAIRS: usize = 60;
/// Program that runs the ticks with mink.
const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/perf/ik.py");
const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/models/humanoid.xml");

struct Tracking {
    data: Data,
    ik: Ik,
    tasks: [TaskId; 6],
    start: Vec<f64>,
    /// Targets of both hands in each tick.
    targets: Vec<[[f64; 7]; 2]>,
}

impl Tracking {
    fn new() -> Result<Self> {
        let model = Arc::new(sample::humanoid());
        let mut data = Data::new(&model)?;
        data.reset_to_key("stand")?;
        data.forward()?;
        let mut ik = Ik::new(&model);
        ik.set_velocity_limits(4.0)?;
        let pose = |name: &str| Frame::body(&model, name).map(|frame| Task::new(FramePose::new(frame)));
        let full = [1.0, 1.0, 1.0, 0.25, 0.25, 0.25];
        let position = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        let tasks = [
            ik.add_task(pose("foot_left")?.with_weights(full)),
            ik.add_task(pose("foot_right")?.with_weights(full)),
            ik.add_task(pose("hand_left")?.with_weights(position)),
            ik.add_task(pose("hand_right")?.with_weights(position)),
            ik.add_task(Task::new(Subtree::com(&model, "torso")?)),
            ik.add_task(Task::new(JointPosition::all(&model)).with_weight(1e-4)),
        ];
        for (task, body) in tasks.into_iter().zip(["foot_left", "foot_right"]) {
            let body = data.body(body)?;
            ik.set_target(task, &[body.xpos().as_slice(), body.xquat()].concat())?;
        }
        ik.set_target(tasks[4], data.body("torso")?.subtree_com())?;
        ik.set_target(tasks[5], data.qpos())?;
        let origins = [*data.body("hand_left")?.xpos(), *data.body("hand_right")?.xpos()];
        let targets = (0..TICKS).map(|tick| {
            let phase = std::f64::consts::TAU * (tick + 1) as f64 * DT;
            let (sideways, up) = (0.1 * (1.0 - phase.cos()), 0.15 * (1.0 - phase.cos()));
            let target =
                |[x, y, z]: [f64; 3], side| [x + 0.15 * phase.sin(), y + side * sideways, z + up, 1.0, 0.0, 0.0, 0.0];
            [target(origins[0], 1.0), target(origins[1], -1.0)]
        });
        let (targets, start) = (targets.collect(), data.qpos().to_vec());
        Ok(Self { data, ik, tasks, start, targets })
    }

    /// Returns to the start, and runs all ticks.
    fn run(&mut self) {
        self.data.qpos_mut().copy_from_slice(&self.start);
        self.ik.reset();
        for targets in &self.targets {
            for (task, target) in self.tasks[2..4].iter().zip(targets) {
                self.ik.set_target(*task, target).expect("a pose");
            }
            let tick = self.ik.step(&mut self.data, DT).expect("valid tasks");
            assert!(black_box(tick).is_solved());
        }
    }

    /// Runs all ticks, and returns the mean errors of the tasks with targets.
    fn errors(&mut self) -> Result<[f64; 5]> {
        self.data.qpos_mut().copy_from_slice(&self.start);
        self.ik.reset();
        let mut sums = [0.0; 5];
        for targets in &self.targets {
            for (task, target) in self.tasks[2..4].iter().zip(targets) {
                self.ik.set_target(*task, target)?;
            }
            self.ik.step(&mut self.data, DT)?;
            self.ik.solve(&mut self.data, DT)?;
            for (index, sum) in sums.iter_mut().enumerate() {
                let error = self.ik.error(self.tasks[index])?;
                let counted = if matches!(index, 2 | 3) { &error[..3] } else { error };
                *sum += counted.iter().map(|value| value * value).sum::<f64>().sqrt() / TICKS as f64;
            }
        }
        Ok(sums)
    }
}

fn text(errors: &[f64]) -> String {
    errors.iter().map(|error| format!("{error:.3e}")).collect::<Vec<_>>().join(" ")
}

/// Runs the ticks alternately with mink.
fn beside_mink(python: &str, tracking: &mut Tracking) -> std::io::Result<()> {
    let mut peer = Peer::start(python, &[PEER, MODEL, "daqp"], &[])?;
    let Comparison { ours, theirs, ratio, rest } = peer.compare(PAIRS, "", || {
        let begin = Instant::now();
        tracking.run();
        begin.elapsed().as_secs_f64() / TICKS as f64
    })?;
    println!("ik/step {:.1} µs, mink {:.1} µs, ratio {:.4}", 1e6 * ours, 1e6 * theirs, ratio[1]);
    println!("ik/errors of mink {}", text(&rest));
    Ok(())
}

fn main() -> Result<()> {
    let mut tracking = Tracking::new()?;
    println!("ik/errors {}", text(&tracking.errors()?));
    common::bench("ik/step", TICKS as u32, &mut || tracking.run());

    // The matrix of a tick has a similar spectrum: a few large eigenvalues, and the posture.
    let n = 27;
    let mut h = Matrix::identity(n);
    let mut number = 1_u32;
    for _ in 0..21 {
        let row: Vec<f64> = (0..n)
            .map(|_| {
                number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(number >> 8) / f64::from(1 << 24) - 0.5
            })
            .collect();
        for i in 0..n {
            for j in 0..n {
                h[(i, j)] += 1e2 * row[i] * row[j];
            }
        }
    }
    let g: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let (lower, upper) = (vec![-0.01; n], vec![0.01; n]);
    let mut x = vec![0.0; n];
    let problem = QpProblem::new(&h, &g).with_bounds(&lower, &upper);
    let mut solver = Qp::new(n, 0);
    let iterations = solver.solve(&mut x, &problem)?.iterations;
    println!("ik/Qp {iterations} iterations from the unconstrained minimum");
    common::bench("ik/Qp from the solution", 1, &mut || _ = black_box(solver.solve(&mut x, &problem)));
    let mut solver = Qp::new(n, 0);
    common::bench("ik/Qp from the unconstrained minimum", 1, &mut || {
        solver.forget();
        _ = black_box(solver.solve(&mut x, &problem));
    });

    if let Ok(python) = env::var("MUJOCO_PYTHON") {
        beside_mink(&python, &mut tracking).unwrap_or_else(|error| println!("ik: {error}"));
    }
    Ok(())
}
