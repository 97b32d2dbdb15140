//! `Display` of a view: its fields and their values.

use std::fmt::{self, Write as _};

/// Longest text of a field, in bytes: a texture has millions of values.
const MAX_LENGTH: usize = 4000;

/// Writes the kind, the index, the name and one line per field, with aligned values.
pub(super) fn listing(
    f: &mut fmt::Formatter<'_>,
    kind: &str,
    index: usize,
    name: Option<&str>,
    fields: &[(&str, Box<dyn fmt::Debug + '_>)],
) -> fmt::Result {
    let width = fields.iter().map(|(field, _)| field.len()).max().unwrap_or(0).max("index".len()) + 1;
    write!(
        f,
        "{kind}:\n{:width$} {index}\n{:width$} {}",
        "index:",
        "name:",
        name.map_or("(none)".to_owned(), |name| format!("\"{name}\""))
    )?;
    for (field, value) in fields {
        write!(f, "\n{:width$} {}", format!("{field}:"), rounded(&truncated(&**value)))?;
    }
    Ok(())
}

/// Formats a value and truncates it after [`MAX_LENGTH`] bytes. A field with a precondition is a
/// `Result`.
fn truncated(value: &dyn fmt::Debug) -> String {
    let mut text = Truncating(String::new());
    if write!(text, "{value:?}").is_ok() {
        if text.0.starts_with("Err(") {
            return "(not computed)".to_owned();
        }
        let inner = text.0.strip_prefix("Ok(").and_then(|rest| rest.strip_suffix(')')).map(str::to_owned);
        return inner.unwrap_or(text.0);
    }
    let end = text.0.rfind(", ").unwrap_or(text.0.len());
    text.0.truncate(end);
    text.0 + ", …"
}

/// Buffer whose writes fail beyond [`MAX_LENGTH`], which stops the formatting of a long value.
struct Truncating(String);

impl fmt::Write for Truncating {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.push_str(text);
        if self.0.len() > MAX_LENGTH { Err(fmt::Error) } else { Ok(()) }
    }
}

/// Rounds the numbers in a text to four significant digits.
fn rounded(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|letter: char| letter.is_ascii_digit()) {
        let end = rest[start..]
            .find(|letter: char| !(letter.is_ascii_digit() || matches!(letter, '.' | 'e' | '-')))
            .map_or(rest.len(), |end| start + end);
        result.push_str(&rest[..start]);
        // A range such as 7..8 is not a number, and a digit can be part of a word.
        let in_word = rest[..start].ends_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_');
        match rest[start..end].parse::<f64>() {
            Ok(number) if !in_word && rest[start..end].contains(['.', 'e']) => result.push_str(&four_digits(number)),
            _ => result.push_str(&rest[start..end]),
        }
        rest = &rest[end..];
    }
    result + rest
}

/// Formats a number with four significant digits.
fn four_digits(number: f64) -> String {
    let short: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    format!("{short:?}")
}

#[cfg(test)]
mod tests {
    use super::{MAX_LENGTH, rounded, truncated};

    #[test]
    fn a_long_field_is_truncated_between_two_values() {
        let text = truncated(&vec![1.5; 10_000]);
        assert!(text.len() < MAX_LENGTH + 10 && text.starts_with("[1.5, 1.5, "), "{text}");
        assert!(text.ends_with(", 1.5, …"), "{text}");
        assert_eq!(truncated(&[1, 2]), "[1, 2]");
    }

    #[test]
    fn a_result_is_printed_as_its_value_or_as_not_computed() {
        assert_eq!(truncated(&Ok::<_, ()>([1.5, 2.0])), "[1.5, 2.0]");
        assert_eq!(truncated(&Err::<(), _>("why")), "(not computed)");
    }

    #[test]
    fn numbers_are_rounded_to_four_significant_digits_and_other_text_is_unchanged() {
        assert_eq!(rounded("[0.015685595769818515, -1.0, 1e-20]"), "[0.01569, -1.0, 1e-20]");
        assert_eq!(rounded("7..13"), "7..13");
        assert_eq!(rounded("body 3 'link2.5'"), "body 3 'link2.5'");
    }
}
