//! Getting started: load a model, inspect it, simulate, reset and record.
//!
//! ```text
//! cargo run --release --example getting_started
//! ```
//!
//! The program prints properties of a humanoid, the contacts of its feet, and the results of two
//! falls.

use std::sync::Arc;

use mujoco_safe::{Controller, Data, RandomController, Trajectory, ZeroController, engine_version, sample};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("MuJoCo {}", engine_version());

    // A `Model` is the constant description, a `Data` is one simulation of it. Load your own with
    // `Model::from_xml_path("humanoid.xml")?`.
    let model = Arc::new(sample::humanoid());
    let mut data = Data::new(model.clone())?;
    println!("{model:?}");
    println!("timestep {} s, {} positions, {} degrees of freedom", model.timestep(), model.nq(), model.nv());

    // Access elements by name. A wrong name gives an error that lists the valid names.
    let torso = model.body("torso")?;
    let knee = model.joint("left_knee")?;
    println!("left knee: index {} in qvel, range {:?} rad", knee.dofs().start, knee.range());
    let left: Vec<_> = model.joints().filter_map(|joint| joint.name()).filter(|name| name.contains("left")).collect();
    println!("joints on the left: {}", left.join(", "));
    if let Err(error) = model.joint("left_kne") {
        println!("error for a misspelt name: {error}");
    }

    // A controller sets `ctrl` before every step. Any closure is a controller.
    let mut random = RandomController::new(1);
    for _ in 0..100 {
        random.control(&mut data)?;
        data.step()?;
    }
    println!("after {:.2} s of random controls:\n{}", data.time(), data.body(torso));

    // Inspect contacts and their forces.
    data.reset_to_key("stand")?;
    for _ in 0..20 {
        data.step()?;
    }
    for contact in data.contacts() {
        let Some([first, second]) = contact.geoms() else { continue };
        println!(
            "contact of {} with {}: normal force {:.1} N",
            data.geom(second).name().unwrap_or("?"),
            data.geom(first).name().unwrap_or("?"),
            contact.force()?.force[0]
        );
    }

    // Record a fall from 2 m, once without control and once with random controls.
    let mut trajectories = Vec::new();
    let controllers: [(&str, &mut dyn Controller); 2] = [("passive", &mut ZeroController), ("random", &mut random)];
    for (name, controller) in controllers {
        data.reset()?;
        data.qpos_mut()[2] = 2.0;
        let mut trajectory = Trajectory::with_capacity(&model, 400);
        trajectory.record(&mut data, controller, 400)?;
        println!("{name}: {} records, final torso height {:.3} m", trajectory.len(), data.qpos()[2]);
        trajectories.push(trajectory);
    }

    // A saved trajectory is restored bit for bit.
    let path = std::env::temp_dir().join(format!("getting_started_{}.csv", std::process::id()));
    trajectories[0].save_csv(&path)?;
    let again = Trajectory::load_csv(&model, &path)?;
    std::fs::remove_file(&path)?;
    assert_eq!(again, trajectories[0]);
    Ok(())
}
