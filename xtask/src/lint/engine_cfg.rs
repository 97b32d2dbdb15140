//! Tests that are left out with an engine, read from their `cfg` and `cfg_attr(…, ignore)`
//! attributes.

use std::collections::BTreeMap;
use std::path::Path;

/// A version of the engine.
pub type Version = [u32; 3];

pub fn version(text: &str) -> Version {
    let mut parts = text.split('.').map(|part| part.parse().unwrap_or_else(|error| panic!("{text}: {error}")));
    [(); 3].map(|()| parts.next().expect("three parts"))
}

/// Evaluates the predicate of a `cfg` for an engine. Predicates that do not concern the engine are
/// true.
fn holds(predicate: &str, engine: Version) -> bool {
    let predicate = predicate.trim();
    let inside = |name: &str| predicate.strip_prefix(name).and_then(|rest| rest.strip_prefix('(')?.strip_suffix(')'));
    if let Some(inner) = inside("not") {
        return !holds(inner, engine);
    }
    if let Some(inner) = inside("all") {
        return arguments(inner).iter().all(|part| holds(part, engine));
    }
    if let Some(inner) = inside("any") {
        return arguments(inner).iter().any(|part| holds(part, engine));
    }
    match predicate.split_once('=') {
        Some((name, value)) if name.trim() == "engine_since" => engine >= version(value.trim().trim_matches('"')),
        // The build script sets it for the engines whose binary models are validated.
        None if predicate == "validates_binaries" => [[2, 2, 2], [3, 5, 0]].contains(&engine),
        _ => true,
    }
}

/// Splits a list at the commas outside of parentheses and quotes.
fn arguments(list: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut is_quoted, mut start) = (Vec::new(), 0, false, 0);
    for (at, character) in list.char_indices() {
        match character {
            '"' => is_quoted = !is_quoted,
            '(' if !is_quoted => depth += 1,
            ')' if !is_quoted => depth -= 1,
            ',' if !is_quoted && depth == 0 => {
                parts.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&list[start..]);
    parts
}

/// Returns `true` if an attribute leaves its item out with an engine.
fn leaves_out(attribute: &str, engine: Version) -> bool {
    let inner = |name: &str| attribute.strip_prefix(name).and_then(|rest| rest.strip_suffix(")]"));
    if let Some(predicate) = inner("#[cfg(") {
        return !holds(predicate, engine);
    }
    inner("#[cfg_attr(").is_some_and(|inner| {
        let parts = arguments(inner);
        parts[1..].iter().any(|part| part.trim().starts_with("ignore")) && holds(parts[0], engine)
    })
}

/// Returns the tests and modules of a text, each with `true` if some item of this name is compiled,
/// not ignored, and does not return at its start.
fn items(text: &str, engine: Version) -> BTreeMap<String, bool> {
    let mut items = BTreeMap::new();
    let mut attributes: Vec<String> = Vec::new();
    let mut lines = text.lines().map(str::trim);
    while let Some(line) = lines.next() {
        if line.starts_with("#[") {
            // An attribute ends with the line that closes it. It is put into one line, as
            // `leaves_out` expects.
            let mut attribute = line.to_owned();
            while !attribute.ends_with(']') {
                attribute += lines.next().expect("the end of an attribute");
            }
            attributes.push(attribute);
            continue;
        }
        let words = line.trim_start_matches("pub(crate) ").trim_start_matches("pub ");
        let name = words.strip_prefix("fn ").filter(|_| attributes.iter().any(|attribute| attribute == "#[test]"));
        if let Some(name) = name.or_else(|| words.strip_prefix("mod ")) {
            let returns = name.ends_with('{') && returns_at_once(lines.clone(), engine);
            let name = name.split(['(', ';', ' ']).next().unwrap_or_default().to_owned();
            let is_kept = !returns && !attributes.iter().any(|attribute| leaves_out(attribute, engine));
            *items.entry(name).or_insert(false) |= is_kept;
        }
        if !line.starts_with("//") {
            attributes.clear();
        }
    }
    items
}

/// Returns `true` if the first statement of a function is `if cfg!(…) { return; }` with a predicate
/// that holds.
fn returns_at_once<'t>(body: impl Iterator<Item = &'t str>, engine: Version) -> bool {
    let start: Vec<&str> = body.filter(|line| !line.starts_with("//")).take(2).collect();
    let condition = start.concat();
    let predicate = condition.strip_prefix("if cfg!(").and_then(|rest| rest.split_once(") {return;"));
    predicate.is_some_and(|(predicate, _)| holds(predicate, engine))
}

/// Returns the tests and modules of a file that one engine runs and the other does not.
pub fn left_out(file: &Path, with: Version, without: Version) -> Vec<String> {
    let text = super::read(file);
    let other = items(&text, without);
    items(&text, with).into_iter().filter(|(name, is_kept)| *is_kept && !other[name]).map(|(name, _)| name).collect()
}

#[test]
fn predicates_are_evaluated() {
    let leaves_out = |attribute, engine| leaves_out(attribute, version(engine));
    assert!(leaves_out(r#"#[cfg(engine_since = "3.5.0")]"#, "2.2.2"));
    assert!(!leaves_out(r#"#[cfg(engine_since = "3.5.0")]"#, "3.17.0"));
    assert!(leaves_out(r#"#[cfg_attr(engine_since = "2.3.0", ignore = "a, reason")]"#, "4.0.0"));
    assert!(!leaves_out(r#"#[cfg_attr(engine_since = "2.3.0", allow(dead_code))]"#, "4.0.0"));
    assert!(leaves_out(r#"#[cfg(any(not(engine_since = "2.3.0"), all(unix, engine_since = "3.5.0")))]"#, "3.3.7"));
    assert!(!leaves_out("#[cfg(unix)]", "2.2.2"));
    assert!(leaves_out("#[cfg(validates_binaries)]", "4.0.0"));
}

#[test]
fn tests_that_an_engine_leaves_out_are_found() {
    let text = r#"
        #[test]
        #[cfg_attr(
            engine_since = "2.3.0",
            ignore = "in several lines"
        )]
        fn ignored() {}
        #[test]
        fn returns() {
            // A reason.
            if cfg!(engine_since = "2.3.0") {
                return;
            }
            check();
        }
        #[test]
        fn goes_on() {
            if cfg!(engine_since = "2.3.0") {
                check();
            }
        }
    "#;
    let kept = |engine| items(text, version(engine)).into_values().collect::<Vec<_>>();
    assert_eq!(kept("2.2.2"), [true; 3]);
    assert_eq!(kept("4.0.0"), [true, false, false], "in the order of their names");
}
