//! Every function of the engine's header, against `functions.tsv`: its equivalent in the library,
//! or the reason why it has none.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::{is_committed, root, sources};

const TABLE: &str = include_str!("functions.tsv");

/// Families of functions without equivalents, and the reasons.
const FAMILIES: [(&str, &str); 2] =
    [("mjr_", "drawing with OpenGL"), ("mjui_", "the user interface of the engine's own viewer")];

/// The part of the table for functions that 2.2.2 lacks.
const NEWER: &str = "Of newer engines";

pub struct Row {
    section: &'static str,
    pub name: &'static str,
    pub here: Vec<&'static str>,
    remark: &'static str,
}

impl Row {
    /// Returns `true` for a function that 2.2.2 lacks.
    pub fn is_newer(&self) -> bool {
        self.section.starts_with(NEWER)
    }
}

pub fn rows() -> Vec<Row> {
    let mut section = "";
    let mut rows = Vec::new();
    for line in TABLE.lines() {
        if let Some(title) = line.strip_prefix("# ") {
            section = title;
            continue;
        }
        let mut cells = line.split('\t');
        let mut cell = || cells.next().unwrap_or_default();
        let (name, here, remark) = (cell(), cell(), cell());
        rows.push(Row { section, name, here: here.split(", ").filter(|path| !path.is_empty()).collect(), remark });
    }
    rows
}

/// Returns the functions that the bindings declare.
fn declared() -> BTreeSet<String> {
    let bindings = std::fs::read_to_string(root().join("mujoco-sys/src/bindings/v2_2_2.rs")).unwrap();
    let names = bindings.lines().filter_map(|line| line.trim().strip_prefix("pub fn "));
    names.filter_map(|rest| rest.split('(').next()).filter(|name| name.starts_with("mj")).map(str::to_owned).collect()
}

pub fn family(name: &str) -> Option<&'static str> {
    FAMILIES.iter().find(|(prefix, _)| name.starts_with(prefix)).map(|(prefix, _)| *prefix)
}

#[test]
fn every_function_of_the_header_is_wrapped_or_has_a_reason() {
    let rows = rows();
    let listed: BTreeSet<String> = rows.iter().filter(|row| !row.is_newer()).map(|row| row.name.to_owned()).collect();
    assert_eq!(listed.len() + rows.iter().filter(|row| row.is_newer()).count(), rows.len(), "duplicate rows");
    let declared: BTreeSet<String> = declared().into_iter().filter(|name| family(name).is_none()).collect();
    assert_eq!(listed, declared);
    for row in &rows {
        assert!(!row.here.is_empty() || !row.remark.is_empty(), "{} has neither an equivalent nor a reason", row.name);
    }
}

#[test]
fn every_wrapper_has_the_c_name_as_an_alias() {
    let sources = sources("src");
    let missing: Vec<&str> = rows()
        .into_iter()
        // A value, such as a model, has no function that could carry the alias.
        .filter(|row| {
            row.here
                .iter()
                .any(|path| path.rsplit("::").next().is_some_and(|last| last.starts_with(char::is_lowercase)))
        })
        .filter(|row| !sources.iter().any(|(_, text)| text.contains(&format!("\"{}\"", row.name))))
        .map(|row| row.name)
        .collect();
    assert!(missing.is_empty(), "without #[doc(alias)]: {missing:?}");
}

#[test]
fn the_page_of_functions_is_up_to_date() {
    let rows = rows();
    let (wrapped, left): (Vec<&Row>, Vec<&Row>) =
        rows.iter().filter(|row| !row.is_newer()).partition(|row| !row.here.is_empty());
    let mut page = format!(
        "Every function of `mujoco.h` 2.2.2: {} have an equivalent here, and {} have none, with the reason.\n\n",
        wrapped.len(),
        left.len()
    );
    page.push_str("Two families have no equivalents:\n\n");
    for (prefix, why) in FAMILIES {
        let count = declared().iter().filter(|name| name.starts_with(prefix)).count();
        let _ = writeln!(page, "- `{prefix}*` ({count} functions): {why}.");
    }
    page.push_str("\nThe engine's plugins (`mjp_*`) begin with 2.3; 2.2.2 has none.\n");
    let mut section = "";
    for row in &rows {
        if row.section != section {
            section = row.section;
            let _ = write!(page, "\n# {section}\n\n| in C | here | |\n|---|---|---|\n");
        }
        let here: Vec<String> = row.here.iter().map(|path| format!("[`{path}`](crate::{path})")).collect();
        let here = if here.is_empty() { "—".to_owned() } else { here.join(", ") };
        let _ = writeln!(page, "| `{}` | {here} | {} |", row.name, row.remark);
    }
    is_committed("functions.md", &page);
}
