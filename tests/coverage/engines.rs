//! The table and the lists of supported engines are those of the build script.

#[allow(dead_code, reason = "the build script uses all of it")]
#[path = "../../mujoco-sys/build/engines.rs"]
pub mod list;

use std::fs;

use list::{ENGINES, Tests};

use crate::root;

fn newest() -> &'static str {
    ENGINES[ENGINES.len() - 1].version
}

/// Returns the table of the engines in Markdown.
fn table() -> String {
    let mut most = Vec::new();
    for engine in &ENGINES[1..] {
        assert!(matches!(engine.tests, Tests::Most), "{}", engine.version);
        most.push(engine.version);
    }
    assert!(matches!(ENGINES[0].tests, Tests::All));
    [
        "| MuJoCo | bindings | tests |",
        "|---|---|---|",
        &format!("| {} | committed | all |", ENGINES[0].version),
        &format!(
            "| {} | committed | all except the program `coverage`: `scripts/test --engine VERSION` |",
            most.join(", ")
        ),
        &format!(
            "| other releases up to {} | those of the nearest, or generated | `mujoco-sys`, `smoke`: `scripts/releases` |",
            newest()
        ),
        "| newer ones | those of the nearest, or generated | none |\n",
    ]
    .join("\n")
}

/// Returns the text of a file without line breaks and the marks of comments.
fn words(path: &str) -> String {
    let text = fs::read_to_string(root().join(path)).unwrap();
    let lines = text.lines().map(|line| line.trim_start_matches("//!"));
    lines.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ")
}

#[test]
fn the_table_of_engines_is_that_of_the_build_script() {
    let path = "src/guide/engines.rs";
    let text = fs::read_to_string(root().join(path)).unwrap().replace("//! ", "");
    assert!(text.contains(&table()), "{path} does not have the table\n{}", table());
}

#[test]
fn every_list_of_engines_is_that_of_the_build_script() {
    let versions = ENGINES.map(|engine| engine.version);
    let list = |versions: &[&str]| {
        let (last, others) = versions.split_last().unwrap();
        format!("{} and {last}", others.join(", "))
    };
    for path in ["README.md", "mujoco-sys/README.md", "mujoco-sys/src/lib.rs"] {
        assert!(words(path).contains(&list(&versions)), "{path} does not list {}", list(&versions));
    }
    // Without the default engine.
    for path in ["CHANGELOG.md", "mujoco-sys/CHANGELOG.md", "CONTRIBUTING.md", "docs/promises.md"] {
        assert!(words(path).contains(&list(&versions[1..])), "{path} does not list {}", list(&versions[1..]));
    }
}

#[test]
fn every_listed_engine_has_its_files() {
    for engine in ENGINES {
        let name = engine.version.replace('.', "_");
        for path in [format!("src/bindings/v{name}.rs"), format!("fields/v{name}.tsv")] {
            assert!(root().join("mujoco-sys").join(&path).exists(), "{path}");
        }
        assert_eq!(list::version(engine.number), engine.version);
    }
}
