//! Plots of the swing-ups and of the convergence of the optimiser.

use std::error::Error;
use std::path::Path;

use mujoco_safe::Model;

use crate::common::chart::{self, Line, PALETTE, Panel};
use crate::swing_up::Attempt;

/// Plots angle, position and controls over time, and the cost over the iterations.
pub fn draw(out: &Path, model: &Model, attempts: &[Attempt]) -> Result<(), Box<dyn Error>> {
    let color = |index: usize| PALETTE[index % PALETTE.len()];
    let over_time = |value: &dyn Fn(&Attempt, usize) -> f64| -> Vec<Line> {
        let line = |(index, attempt): (usize, &Attempt)| {
            let times = attempt.trajectory.times();
            let points = (0..times.len()).map(|record| (times[record], value(attempt, record)));
            Line::new(&format!("seed {}", index + 1), color(index), points)
        };
        attempts.iter().enumerate().map(line).collect()
    };
    let mut angles = over_time(&|attempt, record| attempt.trajectory.qpos(record)[1]);
    // Add the plan of the first seed, which has another initial state.
    if let Some(attempt) = attempts.first() {
        let states = &attempt.plan.states;
        let points = (0..states.nrows()).map(|row| (row as f64 * model.timestep(), states[(row, 1)])).collect();
        angles.push(Line { label: "plan of seed 1".to_owned(), points, color: chart::INK, dashed: true });
    }
    let positions = over_time(&|attempt, record| attempt.trajectory.qpos(record)[0]);
    // The engine clamps the control to its range.
    let controls = over_time(&|attempt, record| attempt.trajectory.ctrl(record)[0].clamp(-1.0, 1.0));
    let costs = attempts.iter().enumerate().map(|(index, attempt)| {
        let points = attempt.plan.costs.iter().enumerate().map(|(iteration, cost)| (iteration as f64, cost.log10()));
        Line::new(&format!("seed {}", index + 1), color(index), points)
    });
    let panels = [
        Panel::new("Pole angle", ["time (s)", "angle (rad)"], angles),
        Panel::new("Cart position", ["time (s)", "position (m)"], positions),
        Panel::new("Control", ["time (s)", "fraction of the motor's range"], controls).at_least(-1.0, 1.0),
        Panel::new("Cost of the plan", ["iteration", "logarithm of the cost (base 10)"], costs.collect()),
    ];
    chart::save(out, "cartpole_swing_up.svg", 260, &panels)
}
