//! Compiles the programs of the documentation as a user's crate would: `cargo xtask doc-programs`.
//!
//! The tests of the documentation can use the crates of `[dev-dependencies]`, which users do not
//! have. Here each program is a module of a generated crate, which depends on this library and on
//! the crates that the program's page names in a command `cargo add`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::lint;

/// The features that documentation is built with, and `ndarray`.
const FEATURES: &str = "viewer,mjz,npz,mcap,live,gltf,serde,ndarray";

/// Attributes of a fence whose text is a program that compiles.
const PROGRAM: [&str; 5] = ["", "rust", "no_run", "should_panic", "standalone_crate"];

/// A program of the documentation.
#[derive(Debug, PartialEq)]
struct Program {
    /// Line of its fence, from 1.
    line: usize,
    text: String,
    /// The dependencies that its page names, as lines of a manifest.
    dependencies: BTreeSet<String>,
}

/// Compiles all programs. The error names the module of each that fails: path and line of its page.
pub fn check(root: &Path) -> Result<(), String> {
    let root = &root.canonicalize().map_err(|error| format!("{}: {error}", root.display()))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |target| root.join(target));
    let folder = target.join("doc-programs");
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(failed)?;
    }

    // One crate for each set of dependencies.
    let mut crates: BTreeMap<BTreeSet<String>, Vec<(String, String)>> = BTreeMap::new();
    let mut count = 0;
    for path in lint::sources(&root.join("src")).iter().chain(&[root.join("README.md"), root.join("docs/registry.md")])
    {
        let page = path.strip_prefix(root).expect("a path in the repository").to_string_lossy();
        let page: String = page.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        for program in programs(&lint::read(path), path.extension().is_some_and(|extension| extension == "md")) {
            let module = (format!("{}_{}", page.to_lowercase(), program.line), wrapped(&program.text));
            crates.entry(program.dependencies).or_default().push(module);
            count += 1;
        }
    }
    assert!(count > 200, "only {count} programs: the documentation has another form");
    let mut members = String::new();
    for (number, (dependencies, modules)) in crates.into_iter().enumerate() {
        let sources = folder.join(format!("{number}/src"));
        fs::create_dir_all(&sources).map_err(failed)?;
        let mut library = "#![allow(warnings)]\n".to_owned();
        for (name, text) in modules {
            writeln!(library, "mod {name};").expect("a string");
            fs::write(sources.join(format!("{name}.rs")), text).map_err(failed)?;
        }
        fs::write(sources.join("lib.rs"), library).map_err(failed)?;
        fs::write(folder.join(format!("{number}/Cargo.toml")), manifest(root, number, &dependencies))
            .map_err(failed)?;
        write!(members, "\"{number}\", ").expect("a string");
    }
    // The settings of the repository's profile, so that Cargo compiles no dependency again.
    let workspace = format!("[workspace]\nresolver = \"3\"\nmembers = [{members}]\n[profile.dev]\ndebug = false\n");
    fs::write(folder.join("Cargo.toml"), workspace).map_err(failed)?;
    fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).map_err(failed)?;

    let status = Command::new("cargo")
        .args(["check", "--quiet", "--workspace", "--target-dir"])
        .arg(&target)
        .current_dir(&folder)
        .status()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if !status.success() {
        return Err("a program of the documentation does not compile in a new crate: the name of its module has its \
                    page and line. A crate that a program needs must be in a command `cargo add` of its page"
            .to_owned());
    }
    println!("{count} programs of the documentation compile in a new crate");
    Ok(())
}

fn manifest(root: &Path, number: usize, dependencies: &BTreeSet<String>) -> String {
    let features = FEATURES.replace(',', "\", \"");
    let mut manifest = format!(
        "[package]\nname = \"doc-programs-{number}\"\nedition = \"2024\"\n\n[dependencies]\n\
         mujoco-safe = {{ path = \"{}\", features = [\"{features}\"] }}\n",
        root.display()
    );
    for line in dependencies {
        writeln!(manifest, "{line}").expect("a string");
    }
    manifest
}

/// Returns the programs of a source file or of a page in Markdown.
fn programs(text: &str, markdown: bool) -> Vec<Program> {
    let mut found = Vec::new();
    let mut page = Vec::new();
    for (index, line) in text.lines().chain(["\0"]).enumerate() {
        match if markdown && line != "\0" { Some(line) } else { doc_line(line) } {
            Some(line) => page.push((index + 1, line)),
            None => found.extend(programs_of_page(&std::mem::take(&mut page), markdown)),
        }
    }
    found
}

/// Returns the text of a line of a doc comment. Of the two fences of a program that needs a
/// feature, it returns the one that compiles the program.
fn doc_line(line: &str) -> Option<&str> {
    let line = line.trim_start();
    if line.starts_with("#![cfg_attr(") || line.starts_with("#[cfg_attr(") {
        let (_, text) = line.split_once("doc = ")?;
        let literal = text.strip_prefix('"').and_then(|rest| rest.split('"').next());
        return Some(literal.filter(|text| *text != "```ignore").unwrap_or(""));
    }
    let text = line.strip_prefix("//!").or_else(|| line.strip_prefix("///").filter(|rest| !rest.starts_with('/')))?;
    Some(text.strip_prefix(' ').unwrap_or(text))
}

fn programs_of_page(page: &[(usize, &str)], markdown: bool) -> Vec<Program> {
    let dependencies = dependencies(page);
    let mut found = Vec::new();
    let mut lines = page.iter();
    while let Some((line, fence)) = lines.next() {
        let Some(attributes) = fence.trim_start().strip_prefix("```") else { continue };
        let block: Vec<&str> = lines.by_ref().map(|(_, line)| *line).take_while(|line| line.trim() != "```").collect();
        let is_program = if markdown {
            attributes.split(',').next() == Some("rust")
        } else {
            attributes.split(',').all(|attribute| PROGRAM.contains(&attribute))
        };
        if is_program {
            let text = block.iter().map(|line| unhidden(line)).collect::<Vec<_>>().join("\n");
            found.push(Program { line: *line, text, dependencies: dependencies.clone() });
        }
    }
    found
}

/// Returns a line without the mark by which rustdoc hides it.
fn unhidden(line: &str) -> &str {
    match line.trim_start() {
        "#" => "",
        text => text
            .strip_prefix("# ")
            .or_else(|| text.strip_prefix('#').filter(|rest| rest.starts_with('#')))
            .unwrap_or(line),
    }
}

/// Returns the dependencies that the commands `cargo add` of a page add, as lines of a manifest. A
/// command ends with its line in a program, and with its quote in prose.
fn dependencies(page: &[(usize, &str)]) -> BTreeSet<String> {
    let (mut text, mut inside) = (String::new(), false);
    for (_, line) in page {
        inside ^= line.trim_start().starts_with("```");
        text.push_str(line);
        text.push(if inside { '\n' } else { ' ' });
    }
    text.split("cargo add ").skip(1).flat_map(added).collect()
}

/// Returns the dependencies that the command at the start of a text adds.
fn added(text: &str) -> Vec<String> {
    let command = text.split(['`', '\n', '#']).next().unwrap_or(text);
    let mut words = command.split_whitespace();
    let (mut names, mut settings) = (Vec::new(), String::new());
    while let Some(word) = words.next() {
        match word {
            "--no-default-features" => settings.push_str(", default-features = false"),
            "--features" => {
                let features = words.next().expect("a list of features").replace(',', "\", \"");
                write!(settings, ", features = [\"{features}\"]").expect("a string");
            }
            "--path" | "--git" => _ = words.next(),
            name => names.push(name),
        }
    }
    // The features of this library are those of all programs.
    names.retain(|name| *name != "mujoco-safe");
    names.iter().map(|name| format!("{name} = {{ version = \"*\"{settings} }}")).collect()
}

/// Wraps statements in a function, as rustdoc does.
fn wrapped(text: &str) -> String {
    if text.lines().any(|line| line.starts_with("fn main(")) {
        text.to_owned()
    } else if text.trim_end().ends_with("(())") {
        format!("fn program() -> Result<(), impl core::fmt::Debug> {{\n{text}\n}}\n")
    } else if text.contains("?;") {
        format!("fn program() -> Result<(), Box<dyn std::error::Error>> {{\n{text}\nOk(())\n}}\n")
    } else {
        format!("fn program() {{\n{text}\n}}\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_found_with_the_crates_that_their_page_names() {
        let lines = [
            "//! Needs `cargo add rand plotters --no-default-features",
            "//! --features a,b`.",
            "//!",
            "#![cfg_attr(x, doc = \"```no_run\")]",
            "#![cfg_attr(not(x), doc = \"```ignore\")]",
            "//! # let a = 1;",
            "//! #[derive(Debug)]",
            "//! ```",
            "//!",
            "//! ```text",
            "//! no program",
            "//! ```",
            "",
            "/// ```",
            "/// f()?;",
            "/// ```",
        ];
        let settings = ", default-features = false, features = [\"a\", \"b\"]";
        let dependencies = ["rand", "plotters"].map(|name| format!("{name} = {{ version = \"*\"{settings} }}"));
        let expected = [
            Program { line: 4, text: "\nlet a = 1;\n#[derive(Debug)]".into(), dependencies: dependencies.into() },
            Program { line: 14, text: "f()?;".into(), dependencies: BTreeSet::new() },
        ];
        assert_eq!(programs(&lines.join("\n"), false), expected);
    }
}
