//! Searches on robots of the user's choice: set `MUJOCO_SAFE_MODELS` to a directory, and run
//! `cargo test --release --test ik robots -- --ignored --nocapture`. `POSES` is the number of poses
//! of each robot, 2000 by default.

use std::env;
use std::path::{Path, PathBuf};
use std::time::Instant;

use mujoco_safe::control::residual::{Frame, FramePose};
use mujoco_safe::ik::{Ik, SearchOptions, Task};
use mujoco_safe::{Data, Model};

use crate::{random, randomise};

/// Returns the models below a directory, in order.
fn models(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = folder.read_dir() else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let is_model = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "xml" || ending == "urdf");
    paths.into_iter().flat_map(|path| if is_model(&path) { vec![path] } else { models(&path) }).collect()
}

/// Returns the body with the most joints between it and the world.
fn hand(model: &Model) -> usize {
    let mut depths = vec![0; model.nbody()];
    for body in 1..model.nbody() {
        depths[body] = depths[model.body_parentid()[body] as usize] + model.body_jntnum()[body];
    }
    let most = depths.iter().copied().max().unwrap_or(0);
    depths.iter().position(|depth| *depth == most).unwrap_or(0)
}

#[test]
#[ignore = "needs models"]
fn random_reachable_poses_of_robots_are_found() {
    let folder = env::var_os("MUJOCO_SAFE_MODELS").expect("MUJOCO_SAFE_MODELS is a directory");
    let poses: usize = env::var("POSES").map_or(2000, |text| text.parse().expect("POSES is a number"));
    for path in models(Path::new(&folder)) {
        let model = match Model::from_xml_path(&path) {
            Ok(model) => std::sync::Arc::new(model),
            Err(error) => {
                println!("{}: {error}", path.display());
                continue;
            }
        };
        let hand = hand(&model);
        let mut data = Data::new(&model).unwrap();
        let mut ik = Ik::new(&model);
        let task = ik.add_task(Task::new(FramePose::new(Frame::body(&model, hand).unwrap())));
        let mut random = random(1);
        let (mut found, mut starts, mut iterations) = (0, 0, 0);
        let mut times = Vec::new();
        for seed in 0..poses {
            randomise(&mut data, &mut random);
            data.kinematics().unwrap();
            let target = [data.xpos()[hand].as_slice(), &data.xquat()[hand]].concat();
            data.qpos_mut().copy_from_slice(model.qpos0());
            ik.set_target(task, &target).unwrap();
            let start = Instant::now();
            let options = SearchOptions { seed: seed as u64, ..SearchOptions::default() };
            let outcome = ik.search(&mut data, &options).unwrap();
            times.push(start.elapsed().as_secs_f64());
            if let Some(result) = outcome.found() {
                found += 1;
                starts += result.starts;
                iterations += result.iterations;
            }
        }
        times.sort_by(f64::total_cmp);
        println!(
            "{}: {} joints, {found} of {poses} found, median {:.0} µs, 99 % {:.0} µs, mean {:.0} µs, {:.2} starts and {:.1} iterations",
            path.display(),
            model.njnt(),
            1e6 * times[poses / 2],
            1e6 * times[poses * 99 / 100],
            1e6 * times.iter().sum::<f64>() / poses as f64,
            f64::from(starts) / f64::from(found.max(1)),
            f64::from(iterations) / f64::from(found.max(1)),
        );
        assert!(f64::from(found) >= 0.99 * poses as f64, "{}", path.display());
    }
}
