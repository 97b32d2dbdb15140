//! Plots of the force against height, and of the balancing robot.

use std::error::Error;
use std::path::Path;

use mujoco_safe::Model;

use crate::common::chart::{self, Event, Line, PALETTE, Panel};
use crate::set_point::{SetPoint, Sweep};
use crate::simulate::{Push, Run};

/// Plots the vertical force of inverse dynamics against the height.
pub fn force_against_height(
    path: &Path,
    sweep: &Sweep,
    set_point: &SetPoint,
    weight: f64,
) -> Result<(), Box<dyn Error>> {
    let millimetres: Vec<f64> = sweep.heights.iter().map(|height| height * 1e3).collect();
    let (first, last) = (millimetres[0], millimetres[millimetres.len() - 1]);
    let lowest = sweep.forces.iter().copied().fold(f64::INFINITY, f64::min);
    let best = set_point.offset * 1e3;
    let lines = vec![
        Line::new("force", PALETTE[0], millimetres.iter().copied().zip(sweep.forces.iter().copied())),
        Line::dashed("weight", PALETTE[6], [(first, weight), (last, weight)]),
        Line::dashed(&format!("best: {best:.3} mm"), PALETTE[1], [(best, lowest), (best, weight)]),
    ];
    let panel = Panel::new("External vertical force at the keyframe", ["vertical offset (mm)", "force (N)"], lines);
    chart::draw(path, 340, &[panel])
}

/// Plots the centre of mass and the controls over time.
pub fn balance(
    path: &Path,
    model: &Model,
    run: &Run,
    open_loop: &Run,
    push: Option<Push>,
) -> Result<(), Box<dyn Error>> {
    const SHOWN: usize = 6;
    let times = run.trajectory.times();
    let drift = |axis: usize, label: &str, color: usize| {
        let start = run.com[0][axis];
        Line::new(
            label,
            PALETTE[color],
            times.iter().zip(&run.com).map(move |(&time, com)| (time, (com[axis] - start) * 1e3)),
        )
    };
    let height = |run: &Run| -> Vec<(f64, f64)> {
        run.trajectory.times().iter().zip(&run.com).map(|(&time, com)| (time, com[2])).collect()
    };
    // Select the actuators with the largest effort.
    let effort =
        |index: usize| (0..run.trajectory.len()).map(|record| run.trajectory.ctrl(record)[index].powi(2)).sum::<f64>();
    let mut busiest: Vec<usize> = (0..model.nu()).collect();
    busiest.sort_by(|&a, &b| effort(b).total_cmp(&effort(a)));
    let controls = busiest
        .iter()
        .take(SHOWN)
        .enumerate()
        .map(|(color, &index)| {
            let name = model.actuators().nth(index).and_then(|actuator| actuator.name()).unwrap_or("?");
            Line::new(
                name,
                PALETTE[color],
                (0..run.trajectory.len()).map(|record| (times[record], run.trajectory.ctrl(record)[index])),
            )
        })
        .collect();

    let pushed = push.map(|Push { force: [x, y], start, duration }| {
        Event::new(&format!("push with {:.0} N", x.hypot(y)), start, start + duration)
    });
    let fall = |label: &str, run: &Run| run.fell_at.map(|time| Event::moment(label, time));
    let falls = [fall("fall under LQR", run), fall("fall without LQR", open_loop)];
    let title = format!("Largest {SHOWN} controls");
    let panels = [
        Panel::new(
            "Centre of mass, relative to the start",
            ["time (s)", "drift (mm)"],
            vec![drift(0, "forward (x)", 0), drift(1, "left (y)", 1)],
        )
        .at_least(-5.0, 5.0)
        .events(pushed.clone()),
        Panel::new(
            "Height of the centre of mass",
            ["time (s)", "height (m)"],
            vec![
                Line::new("LQR", PALETTE[0], height(run)),
                Line::dashed("constant controls", PALETTE[1], height(open_loop)),
            ],
        )
        .at_least(0.6, 1.0)
        .events(pushed.clone().into_iter().chain(falls.into_iter().flatten())),
        Panel::new(&title, ["time (s)", "control (actuator's unit)"], controls).at_least(-1.0, 1.0).events(pushed),
    ];
    chart::draw(path, 280, &panels)
}
