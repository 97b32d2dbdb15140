//! The chapter of promises names tests and files that exist, and its table of engines names what
//! differs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::engine_cfg::{left_out, version};
use super::{read, sources};
use crate::engines::ENGINES;

/// Number of tests and files that the chapter names at least.
const LEAST_NAMED: usize = 30;

pub fn check(root: &Path, tests: &[String]) -> Vec<String> {
    let chapter = read(&root.join("docs/promises.md"));
    [names(root, &chapter, tests), engines(root, &chapter)].concat()
}

/// Returns the source file of a module or a test of a test program, `program::module::test`, or the
/// folder of a module with files of its own.
fn source_of(root: &Path, path: &str) -> Option<PathBuf> {
    let mut names = path.split("::");
    let mut folder = root.join("tests").join(names.next().unwrap_or_default());
    let mut source = folder.join("main.rs");
    for name in names {
        let found: Option<PathBuf> =
            [folder.join(name), folder.join(format!("{name}.rs"))].into_iter().find(|file| file.exists());
        // Otherwise an inline module, or a test.
        if let Some(found) = found {
            (folder, source) = (folder.join(name), found);
        }
    }
    source.exists().then_some(source)
}

/// Returns what is wrong with the name of a test or of a module of tests.
fn wrong_test(root: &Path, name: &str, tests: &[String]) -> Option<String> {
    let is_in = |test: &String| test.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with("::"));
    if !tests.iter().any(is_in) {
        return Some(format!("docs/promises.md: no test program lists {name}"));
    }
    let files = source_of(root, name).map(|source| sources(&source)).unwrap_or_default();
    let text: String = files.iter().map(|file| read(file)).collect();
    let function = name.rsplit("::").next().unwrap_or_default();
    let body = text.split(&format!("fn {function}() {{")).nth(1)?;
    body.trim_start().starts_with('}').then(|| format!("docs/promises.md: the test {name} is empty"))
}

/// Checks that every test and file that is named exists.
fn names(root: &Path, chapter: &str, tests: &[String]) -> Vec<String> {
    let (mut found, mut named) = (Vec::new(), 0);
    let file = |name: &str, found: &mut Vec<String>| {
        if !root.join(name).exists() {
            found.push(format!("docs/promises.md: there is no file {name}"));
        }
    };
    for name in chapter.split('`').skip(1).step_by(2) {
        let is_path = name.contains('/') && !name.contains([' ', '<']) && !name.starts_with("scripts/fuzz ");
        if is_path {
            file(name, &mut found);
            named += 1;
        } else if name.contains("::") && !name.starts_with("mujoco_safe::") && !name.starts_with(char::is_uppercase) {
            found.extend(wrong_test(root, name, tests));
            named += 1;
        }
    }
    // The last column of the table names tests, test modules and files.
    for line in chapter.lines().filter(|line| line.starts_with("| ") && line.matches('|').count() == 4) {
        let cell = line.split('|').nth(3).unwrap_or_default().trim();
        for name in cell.split('`').skip(1).step_by(2).filter(|_| cell.starts_with('`')) {
            if name.contains('/') {
                file(name, &mut found);
            } else {
                found.extend(wrong_test(root, name, tests));
            }
            named += 1;
        }
    }
    assert!(named > LEAST_NAMED, "the names in docs/promises.md are not read: {named}");
    found
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

/// Checks that the table of engines links to a difference wherever a test is left out.
fn engines(root: &Path, chapter: &str) -> Vec<String> {
    let engines = ENGINES.map(|engine| engine.version);
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
    let promises = promises(chapter);
    assert_eq!(table.len(), promises.len(), "rows of the table");
    let mut wrong = Vec::new();
    for ((number, text), row) in promises.iter().zip(&table) {
        assert!(row[0].starts_with(&format!("{number}. ")), "{:?} is not promise {number}", row[0]);
        let shown_by = &text[text.find("*Shown by*").unwrap_or_else(|| panic!("promise {number} names no test"))..];
        let files: Vec<PathBuf> = shown_by
            .split('`')
            .skip(1)
            .step_by(2)
            .filter_map(|name| source_of(root, name).or_else(|| Some(root.join(name)).filter(|path| path.exists())))
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
                wrong.push(format!(
                    "docs/promises.md: promise {number} has no difference with {engine}, which leaves out {tests:?}"
                ));
            }
        }
    }
    let unlinked = headings.into_iter().filter(|(_, is_linked)| !is_linked);
    wrong.extend(
        unlinked.map(|(name, _)| format!("docs/promises.md: no cell of the table links to the section {name}")),
    );
    wrong
}
