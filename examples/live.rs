//! Shows a running simulation in a browser, also on another machine.
//!
//! ```text
//! cargo run --release --features live --example live -- --address 127.0.0.1:8000
//! cargo run --release --features live --example live -- --model robot.xml
//! ```
//!
//! The humanoid balances on one leg. Pull it in the page: drag a body with Ctrl. Without a model of
//! its own, the program computes the regulator of the example `humanoid_lqr`.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;
use std::time::Duration;

use clap::Parser;
use common::{balance, command_line};
use mujoco_safe::html::HtmlOptions;
use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Controller, Data, Model};

/// Serves a page of a running simulation.
#[derive(Parser)]
struct Arguments {
    /// A model without a controller; without it, a balancing humanoid
    #[arg(long)]
    model: Option<PathBuf>,
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
    let (mut data, mut controller): (Data, Box<dyn Controller>) = if let Some(path) = &arguments.model {
        // The controls remain as the page sets them.
        (Data::new(Model::from_xml_path(path)?)?, Box::new(|_: &mut Data| ()))
    } else {
        let (data, _, lqr) = balance::humanoid()?;
        (data, Box::new(lqr))
    };
    let title = arguments.model.as_ref().map_or("Humanoid on one leg".into(), |path| path.display().to_string());
    let options =
        LiveOptions::default().with_address(&arguments.address).with_page(HtmlOptions::default().with_title(title));
    let mut page = LivePage::bind(data.model(), &options)?;
    println!("open {}", page.url());
    let duration = arguments.seconds.map_or(Ok(Duration::MAX), Duration::try_from_secs_f64)?;
    page.run_for(duration, &mut data, &mut controller)?;
    println!("{:.1} s of simulation", data.time());
    Ok(())
}
