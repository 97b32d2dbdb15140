//! Film strip of a run: the capsules and spheres of the robot in parallel projection.

use std::error::Error;
use std::path::Path;

use mujoco_safe::Data;
use mujoco_safe::enums::GeomType;
use plotters::prelude::*;

use crate::common::chart::{canvas, font, scaled};
use crate::simulate::Run;

/// Height of the image.
const HEIGHT: u32 = 300;
/// Height of the visible part of the world, m.
const SHOWN: f64 = 2.0;

/// Unit vectors of the view, from the front left of the robot: right, up, and towards the viewer.
const RIGHT: [f64; 3] = [-0.574, 0.819, 0.0];
const UP: [f64; 3] = [-0.081, -0.057, 0.995];
const NEAR: [f64; 3] = [0.815, 0.571, 0.099];

/// Draws the robot at each of the given records.
pub fn draw(path: &Path, data: &mut Data, run: &Run, records: &[usize]) -> Result<(), Box<dyn Error>> {
    canvas(path, HEIGHT, |root| {
        for (area, &record) in root.split_evenly((1, records.len())).iter().zip(records) {
            run.trajectory.apply(record, data)?;
            data.forward()?;
            let (width, height) = area.dim_in_pixel();
            let pixels = f64::from(height - scaled(30)) / SHOWN;
            let root_at = data.qpos()[0..2].to_vec();
            let to_pixel = |point: [f64; 3]| {
                let from_root = [point[0] - root_at[0], point[1] - root_at[1], point[2]];
                let x = f64::from(width) / 2.0 + dot(from_root, RIGHT) * pixels;
                let y = f64::from(height - scaled(40)) - dot(from_root, UP) * pixels;
                (x as i32, y as i32)
            };
            for limb in limbs(data) {
                let ends = limb.ends.map(to_pixel);
                let radius = (limb.radius * pixels) as u32;
                area.draw(&PathElement::new(ends, limb.color.stroke_width(2 * radius)))?;
                for end in ends {
                    area.draw(&Circle::new(end, radius, limb.color.filled()))?;
                }
            }
            let label = format!("{:.1} s", run.trajectory.times()[record]);
            area.draw(&Text::new(
                label,
                (width as i32 / 2 - scaled(14) as i32, (height - scaled(24)) as i32),
                font(14),
            ))?;
        }
        Ok(())
    })
}

struct Limb {
    ends: [[f64; 3]; 2],
    radius: f64,
    color: RGBColor,
    depth: f64,
}

/// Returns the capsules and spheres of the robot, sorted from back to front.
fn limbs(data: &Data) -> Vec<Limb> {
    let model = data.model();
    let mut limbs: Vec<Limb> = model
        .geoms()
        .filter(|geom| matches!(geom.geom_type(), GeomType::Capsule | GeomType::Sphere))
        .map(|geom| {
            let placed = data.geom(geom);
            let [radius, half, _] = *geom.size();
            let half = if geom.geom_type() == GeomType::Capsule { half } else { 0.0 };
            let (at, turn) = (placed.xpos(), placed.xmat());
            // A capsule extends along its local z axis, the third column of its rotation matrix.
            let end = |sign: f64| std::array::from_fn(|axis| at[axis] + sign * half * turn[3 * axis + 2]);
            let depth = dot(*at, NEAR);
            let material = usize::try_from(model.geom_matid()[geom.index()]).ok();
            let rgba = material.map_or(*geom.rgba(), |material| model.mat_rgba()[material]);
            // Lighten parts that are further away.
            let shade = |part: f32| {
                (255.0 * (f64::from(part) + (1.0 - f64::from(part)) * (0.25 - 0.6 * depth).clamp(0.0, 0.45))) as u8
            };
            Limb {
                ends: [end(-1.0), end(1.0)],
                radius,
                color: RGBColor(shade(rgba[0]), shade(rgba[1]), shade(rgba[2])),
                depth,
            }
        })
        .collect();
    limbs.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    limbs
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
