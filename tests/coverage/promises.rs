//! The chapter of promises names tests and files that exist, and its table of engines names what
//! differs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::engine_cfg::{left_out, version};
use crate::engines::list::{ENGINES, Tests};
use crate::root;

fn chapter() -> String {
    std::fs::read_to_string(root().join("docs/promises.md")).unwrap()
}

/// Returns the source file of a module or a test of a test program: `program::module::test`.
fn source_of(path: &str) -> Option<PathBuf> {
    let mut names = path.split("::");
    let mut folder = root().join("tests").join(names.next().unwrap_or_default());
    let mut source = folder.join("main.rs");
    for name in names {
        let found: Option<PathBuf> = [folder.join(name).join("mod.rs"), folder.join(format!("{name}.rs"))]
            .into_iter()
            .find(|file| file.exists());
        if let Some(found) = found {
            (folder, source) = (folder.join(name), found);
            continue;
        }
        // An inline module, or a test.
        let text = std::fs::read_to_string(&source).unwrap_or_default();
        if !text.contains(&format!("fn {name}(")) && !text.contains(&format!("mod {name} {{")) {
            return None;
        }
    }
    source.exists().then_some(source)
}

fn is_test(path: &str) -> bool {
    source_of(path).is_some()
}

#[test]
fn every_test_that_is_named_exists() {
    let chapter = chapter();
    let mut named = 0;
    for name in chapter.split('`').skip(1).step_by(2) {
        let is_path = name.contains('/') && !name.contains([' ', '<']) && !name.starts_with("scripts/fuzz ");
        if is_path {
            assert!(root().join(name).exists(), "{name}");
            named += 1;
        } else if name.contains("::") && !name.starts_with("mujoco_safe::") && !name.starts_with(char::is_uppercase) {
            assert!(is_test(name), "{name}");
            named += 1;
        }
    }
    // The last column of the table names tests, test modules and files.
    for line in chapter.lines().filter(|line| line.starts_with("| ") && line.matches('|').count() == 4) {
        let cell = line.split('|').nth(3).unwrap_or_default().trim();
        for name in cell.split('`').skip(1).step_by(2).filter(|_| cell.starts_with('`')) {
            assert!(is_test(name) || root().join(name).exists(), "{name}");
            named += 1;
        }
    }
    assert!(named > 30, "{named}");
}

/// Returns the source files below a path.
fn sources(path: &Path) -> Vec<PathBuf> {
    if path.is_dir() {
        let entries = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path());
        return entries.flat_map(|path| sources(&path)).collect();
    }
    path.extension().is_some_and(|extension| extension == "rs").then(|| path.to_owned()).into_iter().collect()
}

/// Returns the paragraphs of each promise: its number, and the text until the next.
fn promises(chapter: &str) -> Vec<(usize, &str)> {
    let text = chapter.split("\n# ").find(|text| text.starts_with("The promises\n")).expect("the section");
    let starts: Vec<usize> = text.match_indices("\n**").map(|(at, _)| at + 3).collect();
    let ends = starts.iter().skip(1).copied().chain([text.len()]);
    let promise = |(start, end): (&usize, usize)| {
        let text = &text[*start..end];
        Some((text.split_once('.')?.0.parse().ok()?, text))
    };
    starts.iter().zip(ends).filter_map(promise).collect()
}

#[test]
fn the_table_of_engines_links_to_a_difference_wherever_a_test_is_left_out() {
    let chapter = chapter();
    let engines: Vec<&str> =
        ENGINES.iter().filter(|engine| engine.tests != Tests::Smoke).map(|engine| engine.version).collect();
    // The differences are the chapter's only sections of this level.
    let mut headings: BTreeMap<String, bool> = chapter
        .lines()
        .filter_map(|line| line.strip_prefix("## "))
        .map(|heading| (heading.to_lowercase().replace(' ', "-"), false))
        .collect();
    let table: Vec<Vec<&str>> = chapter
        .lines()
        .skip_while(|line| *line != format!("| promise | {} |", engines.join(" | ")))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    let promises = promises(&chapter);
    assert_eq!(table.len(), promises.len(), "rows of the table");
    let mut wrong = Vec::new();
    for ((number, text), row) in promises.iter().zip(&table) {
        assert!(row[0].starts_with(&format!("{number}. ")), "{:?} is not promise {number}", row[0]);
        let shown_by = &text[text.find("*Shown by*").unwrap_or_else(|| panic!("promise {number} names no test"))..];
        let files: Vec<PathBuf> = shown_by
            .split('`')
            .skip(1)
            .step_by(2)
            .filter_map(|name| source_of(name).or_else(|| Some(root().join(name)).filter(|path| path.exists())))
            .flat_map(|path| sources(&path))
            .collect();
        for (engine, cell) in engines.iter().zip(&row[1..]) {
            assert!(cell.starts_with("tested"), "promise {number} with {engine}: {cell}");
            let links: Vec<&str> =
                cell.split("](#").skip(1).map(|rest| rest.split(')').next().unwrap_or_default()).collect();
            for link in &links {
                *headings.get_mut(*link).unwrap_or_else(|| panic!("no section {link}")) = true;
            }
            let tests: Vec<String> =
                files.iter().flat_map(|file| left_out(file, version(engines[0]), version(engine))).collect();
            if links.is_empty() && !tests.is_empty() {
                wrong.push(format!("promise {number} with {engine}: {tests:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "cells without a link to a difference: {wrong:#?}");
    let unlinked: Vec<&String> = headings.iter().filter(|(_, is_linked)| !**is_linked).map(|(name, _)| name).collect();
    assert!(unlinked.is_empty(), "no cell links to these sections: {unlinked:?}");
}
