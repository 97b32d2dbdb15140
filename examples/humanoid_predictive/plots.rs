//! Plots of the height and the drift of the robot, and of the predicted cost.

use std::error::Error;
use std::path::Path;

use crate::attempt::Attempt;
use crate::common::chart::{self, Event, Line, PALETTE, Panel};
use crate::robot::PUSH_DURATION;
use crate::simulate::{PUSH_AT, Run};

pub fn draw(out: &Path, attempts: &[Attempt]) -> Result<(), Box<dyn Error>> {
    let color = |attempt: &Attempt| PALETTE[(attempt.seed as usize + PALETTE.len() - 1) % PALETTE.len()];
    let line = |attempt: &Attempt, run: &Run, dashed: bool, value: &dyn Fn([f64; 3]) -> f64| Line {
        label: format!("push {}, {}", attempt.seed, if dashed { "LQR alone" } else { "planner" }),
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
        let points = attempt.decisions.iter().map(|&(time, cost)| (time, cost.max(1e-6)));
        Line::new(&format!("push {}", attempt.seed), color(attempt), points)
    });
    let push = Event::new("push", PUSH_AT, PUSH_AT + PUSH_DURATION);
    let panels = [
        Panel::new("Height of the centre of mass", ["time (s)", "height (m)"], both(&|com| com[2]))
            .events([push.clone()]),
        Panel::new(
            "Horizontal distance of the centre of mass from the start",
            ["time (s)", "distance (m)"],
            both(&|com| com[0].hypot(com[1])),
        )
        .events([push.clone()]),
        Panel::new("Predicted cost of the next half second", ["time (s)", "cost (no unit)"], expected.collect())
            .logarithmic([false, true])
            .events([push]),
    ];
    chart::save(out, "humanoid_predictive.svg", 280, &panels)
}
