//! Repeats a file of the flight recorder, searches it, and compares two engines.
//!
//! ```text
//! cargo run --release --example replay -- repeat failure.flight
//! cargo run --release --example replay -- find failure.flight 'qpos[2] < 1'
//! cargo run --release --features viewer --example replay -- show failure.flight
//! ```
//!
//! `repeat` fails if a call does not have its recorded results, bit for bit.
//!
//! Two engines, or two builds of one, need two builds of this program. The first one writes a
//! trace, and the other compares it with its own results. It fails if they differ by more than
//! rounding. The input is a recording, or a model, which is simulated with random controls:
//!
//! ```text
//! old/replay trace robot.xml --output robot.trace
//! new/replay compare robot.trace --model robot.xml
//! new/replay compare robot.xml --other old/replay      # both in one command
//! ```

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};

use clap::{Args, Parser, Subcommand};
use common::command_line;
use mujoco_safe::flight::{Comparison, Recording, Tracer};
use mujoco_safe::{Controller, Data, Model, RandomController};

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
        /// Repeat only a part of the calls: the condition must continue to hold
        #[arg(long)]
        bisect: bool,
    },
    /// Play the states in the viewer (requires `--features viewer`)
    Show { file: PathBuf },
    /// Write a trace of a recording, or of a model with random controls, for `compare`
    Trace {
        /// A recording, or a model as MJCF or URDF (.xml, .urdf)
        file: PathBuf,
        /// File of the trace; by default, the standard output
        #[arg(short, long)]
        output: Option<PathBuf>,
        #[command(flatten)]
        simulation: Simulation,
    },
    /// Compare a trace of another engine with this one
    Compare {
        /// A trace, `-` for the standard input; with `--other`, a recording or a model
        file: PathBuf,
        /// Model for this engine; by default, the one of the trace
        #[arg(long)]
        model: Option<PathBuf>,
        /// This program with the other engine, which writes the trace
        #[arg(long)]
        other: Option<PathBuf>,
        #[command(flatten)]
        simulation: Simulation,
    },
}

/// Simulation of a model. It starts from the first keyframe, if there is one.
#[derive(Args)]
struct Simulation {
    /// Number of steps
    #[arg(long, default_value_t = 100)]
    steps: u32,
    /// Seed of the random controls
    #[arg(long, default_value_t = 0)]
    seed: u64,
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
        Command::Find { file, condition, bisect } => {
            let condition = Condition::parse(condition)?;
            let recording = Recording::read(file)?;
            let holds = |data: &Data| condition.holds(data);
            let found = if *bisect { recording.first_by_bisection(holds) } else { recording.first(holds) };
            match found? {
                Some(call) => println!("call {call}: {:?}", recording.data_after(call)?),
                None => println!("the condition never holds"),
            }
        }
        Command::Show { file } => show(&Recording::read(file)?)?,
        Command::Trace { file, output: None, simulation } => trace(file, std::io::stdout().lock(), simulation)?,
        Command::Trace { file, output: Some(output), simulation } => trace(file, File::create(output)?, simulation)?,
        Command::Compare { file, model, other: Some(other), simulation } => {
            let Simulation { steps, seed } = simulation;
            let arguments = ["--steps", &steps.to_string(), "--seed", &seed.to_string()].map(str::to_owned);
            let mut writer =
                Process::new(other).arg("trace").arg(file).args(arguments).stdout(Stdio::piped()).spawn()?;
            let trace = writer.stdout.take().ok_or("the other program has no output")?;
            let model = model.as_ref().or(is_model(file).then_some(file));
            let result = compare(trace, model);
            let status = writer.wait()?;
            result?;
            if !status.success() {
                return Err(format!("the other program failed ({status})").into());
            }
        }
        Command::Compare { file, model, .. } if file.as_os_str() == "-" => {
            compare(std::io::stdin().lock(), model.as_ref())?;
        }
        Command::Compare { file, model, .. } => compare(File::open(file)?, model.as_ref())?,
    }
    Ok(())
}

fn is_model(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "xml" || extension == "urdf")
}

fn trace(file: &Path, out: impl Write, simulation: &Simulation) -> Result<(), Box<dyn Error>> {
    let out = BufWriter::new(out);
    if !is_model(file) {
        Recording::read(file)?.trace(out)?;
        return Ok(());
    }
    let mut data = Data::new(Model::from_xml_path(file)?)?;
    if data.model().nkey() > 0 {
        data.reset_to_key(0)?;
    }
    let mut tracer = Tracer::new(out, None)?;
    let mut random = RandomController::new(simulation.seed);
    for _ in 0..simulation.steps {
        random.control(&mut data)?;
        if let Err(error) = tracer.step(&mut data) {
            eprintln!("the simulation ends: {error}");
            break;
        }
    }
    tracer.finish()?;
    Ok(())
}

fn compare(trace: impl Read, model: Option<&PathBuf>) -> Result<(), Box<dyn Error>> {
    let model = model.map(Model::from_xml_path).transpose()?;
    let comparison = Comparison::new(BufReader::new(trace), model.as_ref())?;
    print!("{comparison}");
    match comparison.divergences.first() {
        Some(first) => Err(format!("first difference: {first}").into()),
        None => Ok(()),
    }
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
