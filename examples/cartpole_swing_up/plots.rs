//! Plots of the swing-ups and of the convergence of the optimiser.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use mujoco_safe::Model;

use crate::common::chart::{self, Event, Line, PALETTE, Panel};
use crate::swing_up::{Attempt, SIMULATION_DURATION};

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
    let mut ends = Vec::new();
    // Add the plan of the first seed, which has another initial state.
    if let Some(attempt) = attempts.first() {
        let states = &attempt.plan.states;
        let points = (0..states.nrows()).map(|row| (row as f64 * model.timestep(), states[(row, 1)])).collect();
        angles.push(Line { label: "plan of seed 1".to_owned(), points, color: chart::INK, dashed: true });
        ends.push(Event::moment("plan ends, LQR starts", (states.nrows() - 1) as f64 * model.timestep()));
    }
    // The pole is upright at each multiple of a turn.
    let all = || angles.iter().flat_map(|line| &line.points).map(|point| (point.1 / TAU).round() as i64);
    let turns = all().min().unwrap_or(0)..=all().max().unwrap_or(0);
    for (index, angle) in turns.map(|turn| TAU * turn as f64).enumerate() {
        let label = if index == 0 { "upright (0, ±2π, …)" } else { "" };
        angles.push(Line::dashed(label, PALETTE[6], [(0.0, angle), (SIMULATION_DURATION, angle)]));
    }
    let positions = over_time(&|attempt, record| attempt.trajectory.qpos(record)[0]);
    // The engine clamps the control to its range.
    let controls = over_time(&|attempt, record| attempt.trajectory.ctrl(record)[0].clamp(-1.0, 1.0));
    let costs = attempts.iter().enumerate().map(|(index, attempt)| {
        let points = attempt.plan.costs.iter().enumerate().map(|(iteration, cost)| (iteration as f64, *cost));
        Line::new(&format!("seed {}", index + 1), color(index), points)
    });
    let panels = [
        Panel::new("Angle of the pole", ["time (s)", "angle (rad)"], angles).events(ends.clone()),
        Panel::new("Position of the cart", ["time (s)", "position (m)"], positions).events(ends.clone()),
        Panel::new("Control of the motor", ["time (s)", "control (part of range)"], controls)
            .at_least(-1.0, 1.0)
            .events(ends),
        Panel::new(
            "Cost of the plan during the optimisation",
            ["iterations (number)", "cost (no unit)"],
            costs.collect(),
        )
        .logarithmic([false, true]),
    ];
    chart::save(out, "cartpole_swing_up.svg", 260, &panels)
}
