//! Plot of the pushes: direction, and time until the fall, for each controller.

use std::error::Error;
use std::path::Path;

use plotters::prelude::*;

use super::Outcome;
use crate::common::chart::{Area, INK, PALETTE, canvas, font, scaled};
use crate::simulate::Run;

/// Height of the image, and the radius of the circle of pushes that the humanoid withstands.
const HEIGHT: u32 = 420;
const RADIUS: f64 = 138.0;

pub fn draw(path: &Path, outcomes: &[Outcome]) -> Result<(), Box<dyn Error>> {
    canvas(path, HEIGHT, |root| {
        let halves = root.split_evenly((1, 2));
        circle(&halves[0], "LQR", outcomes, |outcome| &outcome.regulated)?;
        circle(&halves[1], "planner", outcomes, |outcome| &outcome.planned)
    })
}

/// Draws a dot for each push, in the direction of the force: the front of the humanoid is at the
/// top. The distance of a fall from the middle is the time until the fall.
fn circle(
    area: &Area<'_>,
    name: &str,
    outcomes: &[Outcome],
    run: impl Fn(&Outcome) -> &Run,
) -> Result<(), Box<dyn Error>> {
    let (width, height) = area.dim_in_pixel();
    let at = |angle: f64, radius: f64| {
        let pixels = radius * f64::from(scaled(1));
        let (x, y) = (f64::from(width) / 2.0 - pixels * angle.sin(), f64::from(height) / 2.0 - pixels * angle.cos());
        (x as i32, y as i32 + scaled(14) as i32)
    };
    for fraction in [0.5, 1.0] {
        let ring = Circle::new(at(0.0, 0.0), f64::from(scaled(1)) * RADIUS * fraction, RGBColor(226, 228, 232));
        area.draw(&ring)?;
    }
    let falls = outcomes.iter().filter(|outcome| !run(outcome).upright()).count();
    let longest = outcomes.iter().flat_map(|outcome| [&outcome.regulated, &outcome.planned]);
    let longest = longest.filter_map(|run| run.trajectory.times().last().copied()).fold(1e-9, f64::max);
    for outcome in outcomes {
        let (color, radius) = match run(outcome).fell_at {
            None => (PALETTE[0], RADIUS),
            Some(time) => (PALETTE[1], RADIUS * (time / longest).min(1.0)),
        };
        area.draw(&Circle::new(at(outcome.angle, radius), scaled(4) as i32, color.mix(0.7).filled()))?;
    }
    let title = format!("{name}: {falls} falls in {} pushes", outcomes.len());
    area.draw(&Text::new(title, (scaled(20) as i32, scaled(8) as i32), font(15)))?;
    for (label, angle) in [("forward", 0.0_f64), ("left", 90.0), ("backward", 180.0), ("right", 270.0)] {
        let (x, y) = at(angle.to_radians(), RADIUS + 24.0);
        let place = (x - scaled(4 * label.len() as u32) as i32, y - scaled(8) as i32);
        area.draw(&Text::new(label, place, font(12).color(&INK)))?;
    }
    let legend = [
        (PALETTE[0], 20, "stands".to_owned()),
        (PALETTE[1], 90, format!("falls, after 0 s (middle) to {longest:.0} s (rim)")),
    ];
    for (color, left, label) in legend {
        let (x, y) = (scaled(left) as i32, (height - scaled(20)) as i32);
        area.draw(&Circle::new((x, y), scaled(4) as i32, color.filled()))?;
        area.draw(&Text::new(label, (x + scaled(10) as i32, y - scaled(6) as i32), font(11)))?;
    }
    Ok(())
}
