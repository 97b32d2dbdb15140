//! What a look at a text can see before the engine's compiler does: what would lock it for ever, or crash it.

use crate::error::{Error, Result};

/// The longest name of a file. The engine's own limit is 999 bytes behind the last slash.
const LONGEST_NAME: usize = 900;

/// The least `njmax` that a text with an adhesion actuator may give.
const LEAST_NJMAX: i64 = 100;

/// Refuses a text that the engine's compiler is not safe with. Binary files may be passed too: they have none of this.
pub(super) fn check(source_name: &str, text: &[u8]) -> Result<()> {
    file_names(text)
        .and_then(|()| adhesion(text))
        .map_err(|message| Error::Load { source_name: source_name.to_owned(), message })
}

/// An empty name, or one that is too long for the engine's table, makes it raise a fatal error while its parser holds its
/// lock. Decoding an entity only makes a name shorter, so the text is enough to tell.
fn file_names(text: &[u8]) -> std::result::Result<(), String> {
    for name in attribute(text, b"file") {
        let why = match name.last() {
            None | Some(b'/' | b'\\') => "has nothing behind its last slash",
            _ if name.len() > LONGEST_NAME => "is longer than 900 bytes",
            _ if name.windows(2).any(|window| window == b"&#") => "has a numeric character reference",
            _ => continue,
        };
        let shown: String = String::from_utf8_lossy(name).chars().take(60).collect();
        return Err(format!("the file name '{shown}' {why}"));
    }
    Ok(())
}

/// The compiler takes a step of the simulation. With an adhesion actuator and more contacts than `njmax` has room for, that
/// writes out of bounds (see `hazard.rs`).
fn adhesion(text: &[u8]) -> std::result::Result<(), String> {
    let adhesive = contains(text, b"<adhesion") || attribute(actuators(text), b"body").next().is_some();
    if !adhesive {
        return Ok(());
    }
    let number = |value: &[u8]| std::str::from_utf8(value).ok()?.trim().parse::<i64>().ok();
    match attribute(text, b"njmax").filter_map(number).find(|njmax| (0..LEAST_NJMAX).contains(njmax)) {
        None => Ok(()),
        Some(njmax) => Err(format!(
            "njmax is {njmax}; with an actuator on a body, such as adhesion, it must be at least {LEAST_NJMAX}, or be left to the compiler"
        )),
    }
}

/// From the first tag of a section of actuators to the last, whatever is in between. Sensors have a `body` too. The engine's
/// parser takes `< actuator>` and `< /actuator>` as well, so only the word counts.
fn actuators(text: &[u8]) -> &[u8] {
    let word = b"actuator";
    let mut places = text.windows(word.len()).enumerate().filter(|(_, window)| window == word).map(|(at, _)| at);
    let Some(first) = places.next() else { return &[] };
    &text[first..places.next_back().unwrap_or(first)]
}

fn contains(text: &[u8], word: &[u8]) -> bool {
    text.windows(word.len()).any(|window| window == word)
}

/// The values of what looks like an attribute of this name.
fn attribute<'t>(text: &'t [u8], name: &'static [u8]) -> impl Iterator<Item = &'t [u8]> {
    let mut rest = text;
    std::iter::from_fn(move || {
        loop {
            let at = rest.windows(name.len()).position(|window| window == name)?;
            rest = &rest[at + name.len()..];
            let Some(value) = rest.trim_ascii_start().strip_prefix(b"=") else { continue };
            let Some((&quote, value)) = value.trim_ascii_start().split_first() else { continue };
            if let (b'"' | b'\'', Some(end)) = (quote, value.iter().position(|&byte| byte == quote)) {
                return Some(&value[..end]);
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::{attribute, check};

    #[test]
    fn attributes_are_found_however_they_are_spaced_and_quoted() {
        let text = br#"<a file="one"/><b file = 'two "2"' profile="three"/> file <c file=four file="#;
        let found: Vec<_> = attribute(text, b"file").collect();
        assert_eq!(found, [&b"one"[..], b"two \"2\"", b"three"]);
    }

    #[test]
    fn names_that_lock_the_parser_are_refused() {
        for name in ["", "dir/", "dir\\", &"x".repeat(1000), "a&#47;"] {
            let text = format!(r#"<mujoco><include file="{name}"/></mujoco>"#);
            assert!(check("text", text.as_bytes()).is_err(), "{name}");
        }
        assert!(check("text", br#"<mujoco><include file="dir/part.xml"/></mujoco>"#).is_ok());
    }

    #[test]
    fn little_room_for_constraints_is_refused_only_where_an_actuator_is_on_a_body() {
        let text = |actuator: &str| {
            format!(
                r#"<mujoco><size njmax="5"/><sensor><subtreecom body="a"/></sensor><actuator>{actuator}</actuator>
                   <sensor><subtreecom body="a"/></sensor></mujoco>"#
            )
        };
        assert!(check("text", text(r#"<motor joint="b"/>"#).as_bytes()).is_ok());
        assert!(check("text", text(r#"<general body="a"/>"#).as_bytes()).is_err());
        assert!(check("text", text(r#"<!-- </actuator> --><general body="a"/>"#).as_bytes()).is_err());
        let spaced = br#"<size njmax="5"/><!-- <actuator></actuator> -->< actuator><general body="a"/>< /actuator>"#;
        assert!(check("text", spaced).is_err());
        assert!(check("text", text(r#"</actuator><actuator><general body="a"/>"#).as_bytes()).is_err());
    }
}
