//! A humanoid balances on one leg.
//!
//! ```text
//! cargo run --release --example humanoid_lqr -- --push 20,0 --out out
//! ```
//!
//! The steps: find a set-point near the keyframe at which the floor carries the weight ([`set_point`]), decide what a
//! deviation costs ([`weights`]), linearise a step of the simulation there, solve the Riccati equation for the gain, and
//! simulate ([`simulate`]). `--help` lists the options.
//!
//! The method is that of the LQR tutorial of MuJoCo's Python bindings.

mod arguments;
#[path = "../common/mod.rs"]
mod common;
mod film;
mod plots;
mod simulate;

use std::error::Error;
use std::sync::Arc;

use arguments::Arguments;
use common::balance::{set_point, weights};
use mujoco_safe::{Data, Differences, Lqr, Matrix, Model, sample};
use set_point::SetPoint;
use simulate::{Disturbance, simulate};
use weights::{Dofs, weights};

fn main() -> std::process::ExitCode {
    common::finish(balance())
}

fn balance() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse()?;
    // `--json` leaves the output to the program that reads it.
    let say = |text: String| {
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
    say(format!("{model:?}"));

    // 1. Where to balance.
    let dofs = Dofs::of(&model, torso, foot);
    let (set_point, sweep) = SetPoint::near(&mut data, keyframe.id())?;
    let weight =
        model.body_mass().iter().sum::<f64>() * model.options().gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let ctrl_max = set_point.ctrl.iter().fold(0.0_f64, |most, ctrl| most.max(ctrl.abs()));
    let force_error = set_point.force_error(dofs.free.end..model.nv());
    say(format!(
        "keyframe '{}': at rest it would need {:.1} N from outside, of {weight:.1} N",
        arguments.keyframe, set_point.at_keyframe[2]
    ));
    say(format!(
        "moved by {:+.3} mm the floor carries it; the largest control is {ctrl_max:.3}",
        set_point.offset * 1e3
    ));
    say(format!("the motors give the wanted joint forces to {force_error:.1e} N·m"));

    // 2. What happens with constant controls.
    let mut constant = |data: &mut Data| data.ctrl_mut().copy_from_slice(&set_point.ctrl);
    let open_loop = simulate(&mut data, &mut constant, &set_point, torso, arguments.seconds, Disturbance::default())?;
    say(match open_loop.fell_at {
        Some(time) => format!("with constant controls it falls after {time:.2} s"),
        None => "with constant controls it stays up".to_owned(),
    });

    // 3. What a deviation costs, and how the robot moves about the set-point.
    set_point.apply(&mut data)?;
    let weights = weights(&mut data, torso, foot, &dofs)?;
    let system = data.transition_fd(Lqr::EPS, Differences::Central)?;

    // 4. The gain.
    let solution = Lqr::solve(&system, &weights)?;
    let mut lqr = Lqr::with_gain(&data, Matrix::from(&solution.k))?;
    say(format!(
        "Riccati: {} doublings, relative residual {:.1e}, 1 − spectral radius {:.1e}",
        solution.iterations,
        solution.relative_residual,
        1.0 - solution.spectral_radius
    ));

    // 5. Under control.
    let disturbance = Disturbance { push: arguments.push, noise: arguments.noise, seed: arguments.seed };
    let run = simulate(&mut data, &mut lqr, &set_point, torso, arguments.seconds, disturbance)?;
    say(match run.fell_at {
        Some(time) => format!("under control it falls after {time:.2} s"),
        None => format!(
            "under control it stands after {:.1} s, its centre of mass at {:.3} m",
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
        let names = ["humanoid_force.svg", "humanoid_balance.svg", "humanoid_film.svg", "humanoid.csv"];
        let [force, balance, film, csv] = names.map(|name| out.join(name));
        plots::force_against_height(&force, &sweep, &set_point, weight)?;
        plots::balance(&balance, &model, &run, &open_loop)?;
        let moments = [0.0, 1.0, 1.3, 1.8, arguments.seconds].map(|time| (time / model.timestep()) as usize);
        film::draw(&film, &mut data, &run, &moments.map(|record| record.min(run.trajectory.len() - 1)))?;
        run.trajectory.save_csv(&csv)?;
        for path in [&force, &balance, &film, &csv] {
            say(format!("wrote {}", path.display()));
        }
    }
    let upright = run.upright();
    if arguments.view {
        set_point.apply(&mut data)?;
        common::window::show("A humanoid on one leg", data, lqr, vec![run.trajectory, open_loop.trajectory])?;
    }
    if upright { Ok(()) } else { Err("the humanoid has fallen".into()) }
}
