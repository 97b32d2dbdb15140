//! Plots of the height and the drift of the robot, and of the predicted cost.

use std::error::Error;
use std::path::Path;

use crate::attempt::Attempt;
use crate::common::chart::{self, Line, PALETTE, Panel};
use crate::simulate::Run;

pub fn draw(out: &Path, attempts: &[Attempt]) -> Result<(), Box<dyn Error>> {
    let color = |attempt: &Attempt| PALETTE[(attempt.seed as usize + PALETTE.len() - 1) % PALETTE.len()];
    let line = |attempt: &Attempt, run: &Run, dashed: bool, value: &dyn Fn([f64; 3]) -> f64| Line {
        label: if dashed { String::new() } else { format!("push {}", attempt.seed) },
        points: run.trajectory.times().iter().zip(&run.com).map(|(&time, &com)| (time, value(com))).collect(),
        color: color(attempt),
        dashed,
    };
    let both = |value: &dyn Fn([f64; 3]) -> f64| -> Vec<Line> {
        let planned = attempts.iter().map(|attempt| line(attempt, &attempt.planned, false, value));
        let regulated = attempts.iter().map(|attempt| line(attempt, &attempt.regulated, true, value));
        planned.chain(regulated).collect()
    };
    let expected = attempts.iter().map(|attempt| {
        let points = attempt.decisions.iter().map(|&(time, cost)| (time, cost.max(1e-6).log10()));
        Line::new(&format!("push {}", attempt.seed), color(attempt), points)
    });
    let panels = [
        Panel::new(
            "Height of the centre of mass with the planner and (dashed) under LQR alone",
            ["time (s)", "height (m)"],
            both(&|com| com[2]),
        ),
        Panel::new(
            "Horizontal distance of the centre of mass from the start",
            ["time (s)", "distance (m)"],
            both(&|com| com[0].hypot(com[1])),
        ),
        Panel::new("Predicted cost of the next half second", ["time (s)", "logarithm (base 10)"], expected.collect()),
    ];
    chart::save(out, "humanoid_predictive.svg", 280, &panels)
}
