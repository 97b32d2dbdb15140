//! Repeats a file of the flight recorder, and searches it.
//!
//! ```text
//! cargo run --release --example replay -- repeat failure.flight
//! cargo run --release --example replay -- find failure.flight 'qpos[2] < 1'
//! cargo run --release --features viewer --example replay -- show failure.flight
//! ```
//!
//! The program fails if a call does not have its recorded results, bit for bit.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use clap::{Parser, Subcommand};
use common::command_line;
use mujoco_safe::Data;
use mujoco_safe::flight::Recording;

/// Repeats a file of the flight recorder.
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Print the contents of a file, without a repetition
    Info { file: PathBuf },
    /// Repeat all calls, and compare their results with the recorded ones
    Repeat { file: PathBuf },
    /// Find the first call after which a condition holds
    Find {
        file: PathBuf,
        /// `qpos[i]`, `qvel[i]`, `qacc[i]`, `ctrl[i]`, `ncon` or `time`, then `<` or `>`, then a
        /// number
        condition: String,
    },
    /// Play the states in the viewer (requires `--features viewer`)
    Show { file: PathBuf },
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse().command))
}

fn run(command: &Command) -> Result<(), Box<dyn Error>> {
    match command {
        Command::Info { file } => info(&Recording::read(file)?),
        Command::Repeat { file } => {
            let repeat = Recording::read(file)?.repeat()?;
            println!("{} calls repeated bit for bit", repeat.calls);
            if let Some(difference) = repeat.difference {
                return Err(difference.to_string().into());
            }
        }
        Command::Find { file, condition } => {
            let condition = Condition::parse(condition)?;
            let recording = Recording::read(file)?;
            match recording.first(|data| condition.holds(data))? {
                Some(call) => println!("call {call}: {:?}", recording.data_after(call)?),
                None => println!("the condition never holds"),
            }
        }
        Command::Show { file } => show(&Recording::read(file)?)?,
    }
    Ok(())
}

fn info(recording: &Recording) {
    let origin = recording.origin();
    println!("calls      {:?}", recording.calls());
    println!("written    {}", recording.reason());
    println!("note       {}", recording.note());
    println!("library    {}", origin.library);
    println!("engine     {}", origin.engine);
    println!("target     {}", origin.target);
    println!("processor  {}", origin.processor);
    for difference in origin.differences() {
        println!("differs    {difference}");
    }
}

/// Comparison of a quantity with a number.
struct Condition {
    field: String,
    index: usize,
    is_less: bool,
    number: f64,
}

impl Condition {
    fn parse(text: &str) -> Result<Self, Box<dyn Error>> {
        let place = text.find(['<', '>']).ok_or("a condition has the form 'qpos[2] < 1'")?;
        let (quantity, number) = (text[..place].trim(), text[place + 1..].trim());
        let (field, index) = match quantity.split_once('[') {
            Some((field, index)) => (field, index.strip_suffix(']').ok_or("']' is missing")?.parse()?),
            None => (quantity, 0),
        };
        if !["qpos", "qvel", "qacc", "ctrl", "ncon", "time"].contains(&field) {
            return Err(format!("'{field}' is none of qpos, qvel, qacc, ctrl, ncon, time").into());
        }
        Ok(Self { field: field.to_owned(), index, is_less: text[place..].starts_with('<'), number: number.parse()? })
    }

    /// Returns `false` for an index that the model does not have.
    fn holds(&self, data: &Data) -> bool {
        let value = match &*self.field {
            "qpos" => data.qpos().get(self.index).copied(),
            "qvel" => data.qvel().get(self.index).copied(),
            "qacc" => data.qacc().get(self.index).copied(),
            "ctrl" => data.ctrl().get(self.index).copied(),
            "ncon" => Some(data.ncon() as f64),
            _ => Some(data.time()),
        };
        value.is_some_and(|value| if self.is_less { value < self.number } else { value > self.number })
    }
}

#[cfg(feature = "viewer")]
fn show(recording: &Recording) -> Result<(), Box<dyn Error>> {
    if recording.calls().is_empty() {
        return Err("the recording has no calls".into());
    }
    let data = recording.data_before(recording.calls().start)?;
    let mut trajectory = mujoco_safe::Trajectory::new(data.model());
    let mut result = Ok(());
    recording.first(|data| {
        result = trajectory.push(data);
        result.is_err()
    })?;
    result?;
    mujoco_safe::viewer::Viewer::new().with_trajectories([trajectory]).run(data)?;
    Ok(())
}

#[cfg(not(feature = "viewer"))]
fn show(_: &Recording) -> Result<(), Box<dyn Error>> {
    Err("build with --features viewer to show a recording".into())
}
