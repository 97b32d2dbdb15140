//! How a view is printed: its fields and their values.

use std::fmt;

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
        write!(f, "\n{:width$} {}", format!("{field}:"), shortened(&format!("{value:?}")))?;
    }
    Ok(())
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
    use super::shortened;

    #[test]
    fn numbers_keep_four_significant_digits_and_everything_else_its_form() {
        assert_eq!(shortened("[0.015685595769818515, -1.0, 1e-20]"), "[0.01569, -1.0, 1e-20]");
        assert_eq!(shortened("7..13"), "7..13");
        assert_eq!(shortened("body 3 'link2.5'"), "body 3 'link2.5'");
    }
}
