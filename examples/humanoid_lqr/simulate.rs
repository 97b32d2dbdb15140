//! A simulation with pushes and noise, and what is kept of it.

use mujoco_safe::element::Body;
use mujoco_safe::{Controller, Data, Result, Trajectory};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::set_point::SetPoint;

/// When the push begins, s.
const PUSH_AT: f64 = 1.0;
/// The robot has fallen when the centre of mass is below this part of its height at the set-point.
const FALLEN: f64 = 0.8;

/// A push against the torso.
#[derive(Clone, Copy, Debug)]
pub struct Push {
    /// N, world frame.
    pub force: [f64; 2],
    /// s.
    pub duration: f64,
}

/// What disturbs the robot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disturbance {
    pub push: Option<Push>,
    /// Standard deviation of the noise on each control.
    pub noise: f64,
    pub seed: u64,
}

/// How a simulation went.
#[derive(Clone, Debug)]
pub struct Run {
    pub trajectory: Trajectory,
    /// The centre of mass of the torso's subtree at each record, m.
    pub com: Vec<[f64; 3]>,
    /// When it fell, s.
    pub fell_at: Option<f64>,
}

impl Run {
    pub fn upright(&self) -> bool {
        self.fell_at.is_none()
    }

    /// The height of the centre of mass at the end, m.
    pub fn final_height(&self) -> f64 {
        self.com.last().map_or(0.0, |com| com[2])
    }
}

/// Simulates from the set-point, for so long or until the robot has fallen.
pub fn simulate(
    data: &mut Data,
    controller: &mut dyn Controller,
    set_point: &SetPoint,
    torso: Body<'_>,
    seconds: f64,
    disturbance: Disturbance,
) -> Result<Run> {
    set_point.apply(data)?;
    let fallen = FALLEN * data.body(torso).subtree_com()[2];
    let steps = (seconds / data.model().timestep()).round() as usize;
    let mut random = Xoshiro256PlusPlus::seed_from_u64(disturbance.seed);
    let noise = Normal::new(0.0, disturbance.noise).expect("the deviation was checked");
    let mut run = Run {
        trajectory: Trajectory::with_capacity(data.model(), steps),
        com: Vec::with_capacity(steps),
        fell_at: None,
    };
    for _ in 0..steps {
        controller.control(data)?;
        if disturbance.noise > 0.0 {
            for ctrl in data.ctrl_mut() {
                *ctrl += noise.sample(&mut random);
            }
        }
        if let Some(push) = disturbance.push {
            let pushing = (PUSH_AT..PUSH_AT + push.duration).contains(&data.time());
            let [x, y] = if pushing { push.force } else { [0.0, 0.0] };
            *data.body_mut(torso).xfrc_applied_mut() = [x, y, 0.0, 0.0, 0.0, 0.0];
        }
        run.trajectory.push(data)?;
        data.step()?;
        let com = *data.body(torso).subtree_com();
        run.com.push(com);
        if com[2] < fallen {
            run.fell_at = Some(data.time());
            break;
        }
    }
    Ok(run)
}
