//! Text of a view: its fields and their values.

use std::fmt::{self, Write as _};

/// How much of a long field is printed: a texture has millions of bytes.
const LONGEST: usize = 4000;

/// Writes the kind, the index, the name and then a field a line, their values in one column.
pub(super) fn listing(
    f: &mut fmt::Formatter<'_>,
    kind: &str,
    index: usize,
    name: Option<&str>,
    fields: &[(&str, &dyn fmt::Debug)],
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
        write!(f, "\n{:width$} {}", format!("{field}:"), shortened(&beginning(value)))?;
    }
    Ok(())
}

/// Text of a value, cut after [`LONGEST`] characters. A field that has to be computed first is a `Result`.
fn beginning(value: &dyn fmt::Debug) -> String {
    let mut text = Cut(String::new());
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

/// Text up to a length, where writing ends with an error.
struct Cut(String);

impl fmt::Write for Cut {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.push_str(text);
        if self.0.len() > LONGEST { Err(fmt::Error) } else { Ok(()) }
    }
}

/// The numbers in a text with four significant digits at most.
fn shortened(text: &str) -> String {
    let mut short = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|letter: char| letter.is_ascii_digit()) {
        let end = rest[start..]
            .find(|letter: char| !(letter.is_ascii_digit() || matches!(letter, '.' | 'e' | '-')))
            .map_or(rest.len(), |end| start + end);
        short.push_str(&rest[..start]);
        // A range such as 7..8 is not one number, and a word may have a digit in it.
        let word = rest[..start].ends_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_');
        match rest[start..end].parse::<f64>() {
            Ok(number) if !word && rest[start..end].contains(['.', 'e']) => short.push_str(&four_digits(number)),
            _ => short.push_str(&rest[start..end]),
        }
        rest = &rest[end..];
    }
    short + rest
}

fn four_digits(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    format!("{rounded:?}")
}

#[cfg(test)]
mod tests {
    use super::{LONGEST, beginning, shortened};

    #[test]
    fn a_long_field_is_cut_between_two_values() {
        let text = beginning(&vec![1.5; 10_000]);
        assert!(text.len() < LONGEST + 10 && text.starts_with("[1.5, 1.5, "), "{text}");
        assert!(text.ends_with(", 1.5, …"), "{text}");
        assert_eq!(beginning(&[1, 2]), "[1, 2]");
    }

    #[test]
    fn a_result_is_its_value_or_not_computed() {
        assert_eq!(beginning(&Ok::<_, ()>([1.5, 2.0])), "[1.5, 2.0]");
        assert_eq!(beginning(&Err::<(), _>("why")), "(not computed)");
    }

    #[test]
    fn numbers_keep_four_significant_digits_and_everything_else_its_form() {
        assert_eq!(shortened("[0.015685595769818515, -1.0, 1e-20]"), "[0.01569, -1.0, 1e-20]");
        assert_eq!(shortened("7..13"), "7..13");
        assert_eq!(shortened("body 3 'link2.5'"), "body 3 'link2.5'");
    }
}
