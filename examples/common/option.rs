//! The command line: options, and their values.

use std::process::exit;

use lexopt::Arg::{Long, Short, Value};

/// Hands each option's name to `take`, which takes its value from the parser, or returns false if there is no such option.
/// `--help` prints the help and ends the program.
pub fn each(help: &str, mut take: impl FnMut(&str, &mut lexopt::Parser) -> Result<bool, String>) -> Result<(), String> {
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next().map_err(|error| error.to_string())? {
        let name = match argument {
            Short('h') | Long("help") => {
                println!("{help}");
                exit(0);
            }
            Long(name) => format!("--{name}"),
            Short(_) | Value(_) => return Err(format!("{}; --help lists the options", argument.unexpected())),
        };
        if !take(&name, &mut parser)? {
            return Err(format!("there is no option {name}; --help lists the options"));
        }
    }
    Ok(())
}

/// The value of an option as a number; the error names the option.
pub fn number<T: std::str::FromStr>(parser: &mut lexopt::Parser, option: &str) -> Result<T, String>
where
    T::Err: std::fmt::Display,
{
    let value = text(parser, option)?;
    value.parse().map_err(|error| format!("{option} {value}: {error}"))
}

/// The value of an option as text.
pub fn text(parser: &mut lexopt::Parser, option: &str) -> Result<String, String> {
    let value = parser.value().map_err(|error| error.to_string())?;
    value.into_string().map_err(|value| format!("{option} {}: not valid Unicode", value.to_string_lossy()))
}

/// The value of an option as width and height, such as `640x480`.
pub fn size(parser: &mut lexopt::Parser, option: &str) -> Result<[u32; 2], String> {
    let value = text(parser, option)?;
    let wrong = || format!("{option} {value}: give width and height, as in {option} 640x480");
    let (width, height) = value.split_once('x').ok_or_else(wrong)?;
    Ok([width.parse().map_err(|_| wrong())?, height.parse().map_err(|_| wrong())?])
}
