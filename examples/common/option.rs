//! The command line: options, and their values.

use std::ffi::OsString;
use std::fmt::Display;
use std::path::PathBuf;
use std::process::exit;
use std::str::FromStr;

use lexopt::Arg::{Long, Short, Value};

/// An option that was given, or a value without one, and what comes after it.
pub struct Given<'p> {
    name: String,
    value: Option<OsString>,
    parser: &'p mut lexopt::Parser,
}

/// Hands each option to `take`, which writes what it says to `arguments` and refuses options that there are not with
/// [`Given::unknown`]. `--help` prints the help and ends the program.
pub fn read<A>(
    help: &str,
    mut arguments: A,
    mut take: impl FnMut(&mut A, &mut Given<'_>) -> Result<(), String>,
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
        take(&mut arguments, &mut Given { name, value, parser: &mut parser })?;
    }
    Ok(arguments)
}

impl Given<'_> {
    /// What it is called, such as `--seconds`; empty for a value without an option.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its value as a number; the error names the option.
    pub fn number<T: FromStr<Err: Display>>(&mut self) -> Result<T, String> {
        let value = self.text()?;
        value.parse().map_err(|error| format!("{} {value}: {error}", self.name))
    }

    /// Its value as text.
    pub fn text(&mut self) -> Result<String, String> {
        let value = self.value()?;
        value.into_string().map_err(|value| format!("{} {}: not valid Unicode", self.name, value.to_string_lossy()))
    }

    /// Its value as a path.
    pub fn path(&mut self) -> Result<PathBuf, String> {
        self.value().map(PathBuf::from)
    }

    /// Its value as width and height in pixels, such as `640x480`.
    pub fn size(&mut self) -> Result<[u32; 2], String> {
        let value = self.text()?;
        let size = value.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
        size.filter(|size| !size.contains(&0))
            .ok_or_else(|| format!("{0} {value}: give width and height, as in {0} 640x480", self.name))
    }

    /// The error of an option that there is not.
    pub fn unknown(&self) -> Result<(), String> {
        Err(match &self.value {
            Some(value) => format!("unexpected argument {}; --help lists the options", value.display()),
            None => format!("there is no option {}; --help lists the options", self.name),
        })
    }

    fn value(&mut self) -> Result<OsString, String> {
        match self.value.take() {
            Some(value) => Ok(value),
            None => self.parser.value().map_err(|error| error.to_string()),
        }
    }
}
