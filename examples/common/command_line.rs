//! Command line of the examples: options, progress bar and exit code.

use std::error::Error;
use std::ffi::OsString;
use std::fmt::Display;
use std::path::PathBuf;
use std::process::{ExitCode, exit};
use std::str::FromStr;
use std::time::Duration;

use indicatif::style::TemplateError;
use indicatif::{ProgressBar, ProgressStyle};
use lexopt::Arg::{Long, Short, Value};

/// Option or positional argument of the command line.
pub struct Argument<'p> {
    name: String,
    value: Option<OsString>,
    parser: &'p mut lexopt::Parser,
}

/// Parses the command line. `take` stores each option in `arguments`, and returns [`Argument::unknown`] for an unknown option.
/// `--help` prints the help and exits.
pub fn read<A>(
    help: &str,
    mut arguments: A,
    mut take: impl FnMut(&mut A, &mut Argument<'_>) -> Result<(), String>,
) -> Result<A, String> {
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next().map_err(|error| error.to_string())? {
        let (name, value) = match argument {
            Short('h') | Long("help") => {
                println!("{help}");
                exit(0);
            }
            Long(name) => (format!("--{name}"), None),
            Short(letter) => (format!("-{letter}"), None),
            Value(value) => (String::new(), Some(value)),
        };
        take(&mut arguments, &mut Argument { name, value, parser: &mut parser })?;
    }
    Ok(arguments)
}

impl Argument<'_> {
    /// Returns the name of the option, such as `--seconds`; empty for a positional argument.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Parses the value as a number. The error contains the name of the option.
    pub fn number<T: FromStr<Err: Display>>(&mut self) -> Result<T, String> {
        let value = self.text()?;
        value.parse().map_err(|error| format!("{} {value}: {error}", self.name))
    }

    /// Returns the value as text.
    pub fn text(&mut self) -> Result<String, String> {
        let value = self.value()?;
        value.into_string().map_err(|value| format!("{} {}: not valid Unicode", self.name, value.to_string_lossy()))
    }

    /// Returns the value as a path.
    pub fn path(&mut self) -> Result<PathBuf, String> {
        self.value().map(PathBuf::from)
    }

    /// Parses the value as width and height in pixels, such as `640x480`.
    pub fn size(&mut self) -> Result<[u32; 2], String> {
        let value = self.text()?;
        let size = value.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
        size.filter(|size| !size.contains(&0))
            .ok_or_else(|| format!("{0} {value}: expected width and height, as in {0} 640x480", self.name))
    }

    /// Returns the error for an unknown option.
    pub fn unknown(&self) -> Result<(), String> {
        Err(match &self.value {
            Some(value) => format!("unexpected argument {}; --help lists the options", value.display()),
            None => format!("unknown option {}; --help lists the options", self.name),
        })
    }

    fn value(&mut self) -> Result<OsString, String> {
        match self.value.take() {
            Some(value) => Ok(value),
            None => self.parser.value().map_err(|error| error.to_string()),
        }
    }
}

/// Creates a progress bar for a simulation of this duration, s. Its position is in [`milliseconds`].
pub fn progress_bar(seconds: f64) -> Result<ProgressBar, TemplateError> {
    let bar = ProgressBar::new(milliseconds(seconds));
    bar.set_style(ProgressStyle::with_template("{bar:40} {percent} %, {elapsed}")?);
    bar.enable_steady_tick(Duration::from_secs(1));
    Ok(bar)
}

/// Converts a simulation time to a position of the progress bar.
pub fn milliseconds(seconds: f64) -> u64 {
    (1000.0 * seconds) as u64
}

/// Converts the result of an example to its exit code. Prints an error to standard error.
pub fn exit_code(result: Result<(), Box<dyn Error>>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
