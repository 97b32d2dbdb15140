//! Every kind of element and every field of MuJoCo.jl's named access, against `kinds.tsv`, which
//! has the names of this library.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use mujoco_safe::kind::Kind;

use crate::{is_committed, sources};

const TABLE: &str = include_str!("kinds.tsv");

/// Returns the fields of each kind, on a model or on a simulation, as declared in the sources.
fn declared() -> BTreeMap<(String, String), Vec<String>> {
    let mut declared: BTreeMap<(String, String), Vec<String>> = BTreeMap::new();
    for (_, text) in sources("src/element") {
        for block in text.split("\nfields!(").skip(1) {
            let (head, body) = block.split_once('{').unwrap();
            let (kind, owner) = head.trim().split_once(" on ").unwrap();
            let body = body.split("\n});").next().unwrap();
            let names =
                body.lines().filter_map(|line| line.strip_prefix("    ")).filter_map(|line| line.split_once(": "));
            let names = names
                .map(|(name, _)| name)
                .filter(|name| name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_'));
            declared.entry((kind.to_owned(), owner.to_owned())).or_default().extend(names.map(str::to_owned));
        }
    }
    declared
}

/// Returns the rows of the table: kind, owner, field in MuJoCo.jl, fields of this library.
fn rows() -> impl Iterator<Item = [&'static str; 4]> {
    TABLE.lines().map(|line| {
        let cells: Vec<&str> = line.split('\t').collect();
        cells.try_into().unwrap_or_else(|_| panic!("not four cells: {line}"))
    })
}

#[test]
fn every_field_of_the_reference_has_an_equivalent() {
    let declared = declared();
    for [kind, owner, field, here] in rows() {
        let fields = declared.get(&(kind.to_owned(), owner.to_owned()));
        // Sensors have no fields in a simulation.
        for name in here.split(", ").filter(|name| !name.is_empty()) {
            assert!(
                fields.is_some_and(|fields| fields.iter().any(|field| field == name)),
                "{kind} on {owner}: {field} → {name}"
            );
        }
        assert_eq!(field.is_empty(), here.is_empty());
    }
}

#[test]
fn every_kind_has_a_view() {
    let kinds: BTreeSet<String> = declared().into_keys().map(|(kind, _)| kind).collect();
    assert_eq!(kinds.len(), 23);
    for kind in Kind::ALL {
        assert!(kinds.contains(&format!("{kind:?}")), "{kind:?}");
    }
    assert_eq!(Kind::ALL.len(), kinds.len());
}

#[test]
fn the_page_of_kinds_is_up_to_date() {
    let mut page = "Every kind of element and its fields: the name in MuJoCo.jl's named access, the name here, and the additional fields\n\
         here. An address with a count is a range here, and an id is typed. With a newer engine, each view also\n\
         has the [fields that 2.2.2 lacks](crate::element#fields-of-newer-engines), such as those of flexes and plugins.\n"
        .to_owned();
    for ((kind, owner), fields) in declared() {
        let view = if owner == "Data" { format!("{kind}Data") } else { kind.clone() };
        let _ = write!(
            page,
            "\n# {kind}, in a {}\n\n[`{view}`](crate::element::{view})\n\n",
            if owner == "Data" { "simulation" } else { "model" }
        );
        let reference: Vec<[&str; 4]> =
            rows().filter(|row| row[0] == kind && row[1] == owner && !row[2].is_empty()).collect();
        if !reference.is_empty() {
            page.push_str("| MuJoCo.jl | here |\n|---|---|\n");
            for [_, _, field, here] in &reference {
                let here: Vec<String> = here.split(", ").map(|name| format!("`{name}`")).collect();
                let _ = writeln!(page, "| `{field}` | {} |", here.join(", "));
            }
        }
        let known: BTreeSet<&str> = reference.iter().flat_map(|row| row[3].split(", ")).collect();
        let beyond: Vec<String> =
            fields.iter().filter(|field| !known.contains(field.as_str())).map(|field| format!("`{field}`")).collect();
        if !beyond.is_empty() {
            let _ =
                writeln!(page, "{}Additional: {}.", if reference.is_empty() { "" } else { "\n" }, beyond.join(", "));
        }
    }
    is_committed("kinds.md", &page);
}
