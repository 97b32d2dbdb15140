//! Shows a running simulation in a browser, also on another machine.
//!
//! ```text
//! cargo run --release --features live --example live -- --address 127.0.0.1:8000
//! cargo run --release --features live --example live -- --model robot.xml
//! cargo run --release --features live --example live -- --simulations 64
//! ```
//!
//! The humanoid balances on one leg. Pull it in the page: drag a body with Ctrl. Without a model of
//! its own, the program computes the regulator of the example `humanoid_lqr`.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Parser;
use common::{balance, command_line};
use mujoco_safe::html::HtmlOptions;
use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::rollout::Random;
use mujoco_safe::{Batch, Controller, Data, MatrixView, MatrixViewMut, Model, sample};

/// Serves a page of a running simulation.
#[derive(Parser)]
struct Arguments {
    /// A model without a controller; without it, a balancing humanoid
    #[arg(long)]
    model: Option<PathBuf>,
    /// Number of simulations, under random control if there are several
    #[arg(long, default_value_t = 1)]
    simulations: usize,
    /// Address and port of the server; port 0 is a free one
    #[arg(long, default_value = "127.0.0.1:0")]
    address: String,
    /// Time after which the program ends; without it, Ctrl-C does
    #[arg(long, value_name = "S", value_parser = command_line::not_negative)]
    seconds: Option<f64>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let duration = arguments.seconds.map_or(Ok(Duration::MAX), Duration::try_from_secs_f64)?;
    let sample = if arguments.simulations > 1 { "Humanoids" } else { "Humanoid on one leg" };
    let name = arguments.model.as_ref().and_then(|path| path.file_stem());
    let title = name.map_or(sample.into(), |name| name.to_string_lossy());
    let options =
        LiveOptions::default().with_address(&arguments.address).with_page(HtmlOptions::default().with_title(title));
    if arguments.simulations > 1 {
        return run_batch(arguments, &options, duration);
    }
    let (mut data, mut controller): (Data, Box<dyn Controller>) = if let Some(path) = &arguments.model {
        // The controls remain as the page sets them.
        (Data::new(Model::from_xml_path(path)?)?, Box::new(|_: &mut Data| ()))
    } else {
        let (data, _, lqr) = balance::humanoid()?;
        (data, Box::new(lqr))
    };
    let mut page = LivePage::bind(data.model(), &options)?;
    println!("open {}", page.url());
    page.run_for(duration, &mut data, &mut controller)?;
    println!("{:.1} s of simulation", data.time());
    Ok(())
}

/// Runs simulations together, at most in real time.
fn run_batch(arguments: &Arguments, options: &LiveOptions, duration: Duration) -> Result<(), Box<dyn Error>> {
    let model = match &arguments.model {
        Some(path) => Model::from_xml_path(path)?,
        None => sample::humanoid(),
    };
    let mut batch = Batch::new(model, arguments.simulations)?;
    let mut page = LivePage::bind(batch.model(), options)?;
    println!("open {}", page.url());
    let tick = Duration::from_secs_f64(batch.model().timestep());
    let mut random = Random::new(0, 0, 0);
    let start = Instant::now();
    while start.elapsed() < duration {
        let before = Instant::now();
        if page.exchange_batch(&mut batch)?.advance {
            let policy = |_: MatrixView<'_>, controls: &mut MatrixViewMut<'_>| {
                controls.as_mut_slice().fill_with(|| random.uniform(-1.0, 1.0));
            };
            batch.step(policy)?;
        }
        page.wait(tick.saturating_sub(before.elapsed()));
    }
    Ok(())
}
