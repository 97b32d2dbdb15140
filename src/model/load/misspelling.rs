//! Suggestions for misspelt elements and attributes of MJCF.

use crate::error::nearest_name;
use crate::model::Schema;

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
    let tag = |path: &'static str| path.rsplit('/').next().unwrap_or(path).trim_start_matches("(world)");
    let elements = Schema::of_engine().ok()?.elements().map(|(path, attributes)| (tag(path), attributes));
    let candidates: Vec<&str> = match of {
        Some(of) => {
            elements.filter(|(tag, _)| *tag == of).flat_map(|(_, attributes)| attributes).map(String::as_str).collect()
        }
        None => elements.map(|(tag, _)| tag).collect(),
    };
    nearest_name(name, candidates.into_iter()).map(str::to_owned)
}
