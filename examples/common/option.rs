//! Values of command-line options.

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
