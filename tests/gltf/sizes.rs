//! Sizes of files.

use mujoco_safe::gltf::GltfOptions;
use mujoco_safe::sample;

use crate::file::{recorded, saved};

#[test]
fn ten_seconds_of_the_humanoid_need_at_most_350_kb() {
    let model = sample::humanoid();
    let steps = (10.0 / model.options().timestep).round() as usize;
    let size = saved(&model, &[("", &recorded(&model, 0, steps))], &GltfOptions::default()).bytes.len();
    println!("10 s of the humanoid: {} kB", size / 1000);
    assert!(size <= 350_000, "{size}");
}
