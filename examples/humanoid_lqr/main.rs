//! Humanoid balancing on one leg under LQR.
//!
//! ```text
//! cargo run --release --example humanoid_lqr -- --push 20,0 --out out
//! ```
//!
//! The program finds a set-point near the keyframe at which the floor supports the weight
//! ([`set_point`]), defines the cost of deviations ([`weights`]), linearises the simulation, solves
//! the Riccati equation for the gain, and simulates ([`simulate`]). It prints the result of each
//! part. `--help` lists the options.
//!
//! The method follows the LQR tutorial of MuJoCo's Python bindings.

mod arguments;
#[path = "../common/mod.rs"]
mod common;
mod plots;
mod simulate;

use std::error::Error;
use std::sync::Arc;

use arguments::Arguments;
use clap::Parser;
use common::balance::{set_point, weights};
use mujoco_safe::{Data, Differences, Lqr, Model, sample};
use set_point::SetPoint;
use simulate::{Disturbance, simulate};
use weights::{Dofs, weights};

fn main() -> std::process::ExitCode {
    common::command_line::exit_code(balance(&Arguments::parse()))
}

fn balance(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    // With `--json`, standard output contains nothing but the JSON object.
    let report = |text: String| {
        if !arguments.json {
            println!("{text}");
        }
    };

    let model = Arc::new(match &arguments.model {
        Some(path) => Model::from_xml_path(path)?,
        None => sample::humanoid(),
    });
    let mut data = Data::new(model.clone())?;
    let torso = model.body(&arguments.torso)?;
    let foot = model.body(&arguments.foot)?;
    let keyframe = model.keyframe(&arguments.keyframe)?;
    report(format!("{model:?}"));

    // 1. Find the set-point.
    let dofs = Dofs::of(&model, torso, foot);
    let (set_point, sweep) = SetPoint::near(&mut data, keyframe.id())?;
    let weight =
        model.body_mass().iter().sum::<f64>() * model.options().gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let ctrl_max = set_point.ctrl.iter().fold(0.0_f64, |most, ctrl| most.max(ctrl.abs()));
    let force_error = set_point.force_error(dofs.free.end..model.nv());
    report(format!(
        "keyframe '{}': at rest it requires an external vertical force of {:.1} N (weight {weight:.1} N)",
        arguments.keyframe, set_point.at_keyframe[2]
    ));
    report(format!(
        "at {:+.3} mm the floor supports the weight; the largest control is {ctrl_max:.3}",
        set_point.offset * 1e3
    ));
    report(format!("the motors reproduce the required joint forces within {force_error:.1e} N·m"));

    // 2. Simulate with constant controls.
    let mut constant = |data: &mut Data| data.ctrl_mut().copy_from_slice(&set_point.ctrl);
    let open_loop = simulate(&mut data, &mut constant, &set_point, torso, arguments.seconds, Disturbance::default())?;
    report(match open_loop.fell_at {
        Some(time) => format!("with constant controls it falls after {time:.2} s"),
        None => "with constant controls it stays up".to_owned(),
    });

    // 3. Define the cost, and linearise the simulation at the set-point.
    set_point.apply(&mut data)?;
    let weights = weights(&mut data, torso, foot, &dofs)?;
    let system = data.transition_fd(Lqr::EPS, Differences::Central)?;

    // 4. Compute the gain.
    let solution = Lqr::solve(&system, &weights)?;
    let mut lqr = Lqr::with_gain(&data, solution.k)?;
    report(format!(
        "Riccati: {} doublings, relative residual {:.1e}, 1 − spectral radius {:.1e}",
        solution.iterations,
        solution.relative_residual,
        1.0 - solution.spectral_radius
    ));

    // 5. Simulate under control.
    let disturbance = Disturbance { push: arguments.push, noise: arguments.noise, seed: arguments.seed };
    let run = simulate(&mut data, &mut lqr, &set_point, torso, arguments.seconds, disturbance)?;
    report(match run.fell_at {
        Some(time) => format!("under control it falls after {time:.2} s"),
        None => format!(
            "under control it stands after {:.1} s, with its centre of mass at {:.3} m",
            data.time(),
            run.final_height()
        ),
    });

    if arguments.json {
        println!(
            "{}",
            serde_json::json!({
                "A": system.a.rows().collect::<Vec<_>>(),
                "B": system.b.rows().collect::<Vec<_>>(),
                "K": lqr.gain().rows().collect::<Vec<_>>(),
                "force_at_keyframe": set_point.at_keyframe[2],
                "weight": weight,
                "offset": set_point.offset,
                "qpos0": set_point.qpos,
                "ctrl0": set_point.ctrl,
                "joint_force_error": force_error,
                "balance_dofs": dofs.balance,
                "residual": solution.relative_residual,
                "spectral_radius": solution.spectral_radius,
                "open_loop_fell_at": open_loop.fell_at,
                "fell_at": run.fell_at,
                "final_height": run.final_height(),
                "upright": run.upright(),
            })
        );
    }
    if let Some(out) = &arguments.out {
        std::fs::create_dir_all(out)?;
        let names = ["humanoid_force.svg", "humanoid_balance.svg", "humanoid.csv"];
        let [force, balance, csv] = names.map(|name| out.join(name));
        plots::force_against_height(&force, &sweep, &set_point, weight)?;
        plots::balance(&balance, &model, &run, &open_loop, arguments.push)?;
        run.trajectory.save_csv(&csv)?;
        for path in [&force, &balance, &csv] {
            report(format!("wrote {}", path.display()));
        }
    }
    let upright = run.upright();
    if arguments.view {
        set_point.apply(&mut data)?;
        common::window::show("Humanoid on one leg", data, lqr, vec![run.trajectory, open_loop.trajectory])?;
    }
    if upright { Ok(()) } else { Err("the humanoid fell".into()) }
}
