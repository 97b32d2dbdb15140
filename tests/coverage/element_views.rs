//! Completeness of the views: every array with a row per element, or per part of an element, is
//! read by a view.

use std::collections::BTreeSet;
use std::path::Path;

/// The engine's list of its arrays.
const TABLE: &str = include_str!("../../mujoco-sys/fields/v2_2_2.tsv");

/// Sizes whose arrays belong to no element: sparse matrices, current constraints and contacts, user
/// data and names.
const OF_NO_ELEMENT: [&str; 6] = ["nM", "nD", "njmax", "nconmax", "nuserdata", "nnames"];

/// Arrays that no view reads by name, and the reasons.
const EXCEPTIONS: [(&str, &str); 21] = [
    ("light_directional", "another place in newer engines: `layout.rs`, for `Light::directional`"),
    ("tex_rgb", "idem, for `Texture::rgb`"),
    ("mat_texid", "idem, for `Material::texture`"),
    ("mesh_texcoordadr", "idem, for `Mesh::texcoord_range`"),
    ("eq_active", "idem, for `Equality::active`"),
    ("tendon_lengthspring", "idem, for `Tendon::lengthspring`"),
    ("actuator_moment", "idem, for `Actuator::moment`"),
    ("ten_J", "idem, for `Tendon::J`"),
    ("ten_J_rownnz", "idem"),
    ("ten_J_rowadr", "idem"),
    ("ten_J_colind", "idem"),
    ("qLDiagSqrtInv", "the square root of `Joint::qLDiagInv`, which newer engines do not have"),
    ("D_rownnz", "the rows of a sparse matrix, in the model of newer engines: `Data::D_rownnz`"),
    ("D_rowadr", "idem"),
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
            ["int", "mjtNum", "mjtByte"].iter().any(|ctype| TABLE.contains(&format!("\tarray\t{ctype}\t{name}\t")))
        );
    }
}
