//! Completeness of the views: every array with a row per element, or per part of an element, is read by a view.

use std::collections::BTreeSet;
use std::path::Path;

/// The engine's list of its arrays.
const TABLE: &str = include_str!("../../mujoco-sys/fields/v2_2_2.tsv");

/// Sizes whose arrays belong to no element: sparse matrices, current constraints and contacts, user data and names.
const OF_NO_ELEMENT: [&str; 6] = ["nM", "nD", "njmax", "nconmax", "nuserdata", "nnames"];

/// Arrays that no view reads, and the reasons.
const EXCEPTIONS: [(&str, &str); 7] = [
    ("dof_bodyid", "the body of the degree of freedom's joint: `Joint::body`"),
    ("dof_jntid", "the inverse of `Joint::dofs`"),
    (
        "efc_JT_rownnz",
        "a row of the transposed constraint Jacobian, whose columns are the current constraints: `Data::efc_JT`",
    ),
    ("efc_JT_rowadr", "idem"),
    ("efc_JT_rowsuper", "idem"),
    ("efc_JT_colind", "idem"),
    ("efc_JT", "idem"),
];

/// Returns the words in the code of the views, without comments.
fn words() -> BTreeSet<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/element");
    let mut words = BTreeSet::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
            let line = line.split("#[doc").next().unwrap_or_default();
            words.extend(line.split(|letter: char| !letter.is_alphanumeric() && letter != '_').map(str::to_owned));
        }
    }
    words
}

#[test]
fn every_array_of_an_element_is_read_by_a_view() {
    let words = words();
    let mut seen = 0;
    for line in TABLE.lines().skip(1) {
        let cells: Vec<&str> = line.split('\t').collect();
        let [owner, kind, _, name, rows, ..] = cells[..] else { panic!("not a line of the table: {line}") };
        let names = name.starts_with("name_") && name.ends_with("adr");
        if kind != "array" || OF_NO_ELEMENT.contains(&rows) || names {
            continue;
        }
        let excepted = EXCEPTIONS.iter().any(|(exception, _)| *exception == name);
        assert_ne!(words.contains(name), excepted, "mj{owner}.{name} ({rows} rows)");
        seen += 1;
    }
    assert!(seen > 280, "only {seen} arrays");
}

#[test]
fn every_exception_is_an_array() {
    for (name, _) in EXCEPTIONS {
        assert!(
            TABLE.contains(&format!("\tarray\tint\t{name}\t")) || TABLE.contains(&format!("\tarray\tmjtNum\t{name}\t"))
        );
    }
}
