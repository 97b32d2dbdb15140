//! Suggestions for misspelt elements and attributes of MJCF.

use crate::error::nearest_name;
use crate::model::schema;

/// Returns the element or the attribute that the text of a failed compilation may mean, of those
/// that the engine accepts. The lock of the compiler must be free.
pub(super) fn suggestion(message: &str) -> Option<String> {
    let (_, rest) = message.split_once("Schema violation: unrecognized ")?;
    let quoted = |before: &str| Some(rest.split_once(before)?.1.split_once('\'')?.0);
    let element = quoted("Element '");
    let (name, of) = match quoted("attribute: '") {
        Some(attribute) => (attribute, element),
        None => (quoted("element: '").or(element)?, None),
    };
    let schema = schema().ok()?;
    // A line of the schema has an element with the number of times that it may occur, and
    // attributes, which continue in the next lines.
    let (mut candidates, mut current) = (Vec::new(), "");
    for line in schema.lines() {
        let mut words: Vec<&str> = line.split_whitespace().collect();
        if words.get(1).is_some_and(|word| word.starts_with('(')) {
            current = words[0].trim_start_matches("(world)");
            words.drain(..2);
            if of.is_none() {
                candidates.push(current);
            }
        }
        if of == Some(current) {
            candidates.extend(words);
        }
    }
    nearest_name(name, candidates.into_iter()).map(str::to_owned)
}
