//! The guide links to sections that exist. rustdoc checks the item of a link, but not its fragment.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::{root, sources};

/// Returns rustdoc's fragment for a heading.
fn fragment(heading: &str) -> String {
    let heading = heading.trim().to_lowercase().replace(' ', "-");
    heading.chars().filter(|&c| c == '-' || c == '_' || c.is_alphanumeric()).collect()
}

/// Returns the fragments of all headings in the documentation of a module.
fn headings(text: &str) -> HashSet<String> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("//! #"));
    lines.filter(|line| line.starts_with(['#', ' '])).map(|line| fragment(line.trim_start_matches('#'))).collect()
}

/// Returns the name of the module in a file.
fn module(path: &Path) -> String {
    let path = if path.ends_with("mod.rs") { path.parent().unwrap() } else { path };
    path.file_stem().unwrap().to_string_lossy().into_owned()
}

#[test]
fn every_section_that_the_guide_links_to_exists() {
    let modules: HashMap<String, HashSet<String>> = sources("src")
        .into_iter()
        .filter(|(path, _)| {
            ["src", "src/guide", "src/guide/cookbook"].iter().any(|folder| path.parent().unwrap().ends_with(folder))
        })
        .map(|(path, text)| (module(&path), headings(&text)))
        .collect();
    let mut links = 0;
    for (path, text) in sources("src/guide") {
        let page = module(&path);
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for (module, section) in targets.filter_map(|target| target.split_once('#')) {
            let module = match module.rsplit("::").next() {
                Some("") | None => &page,
                Some("crate") => "lib",
                Some(name) => name,
            };
            let exists = modules.get(module).is_some_and(|sections| sections.contains(section));
            assert!(exists, "{page} links to {module}#{section}");
            links += 1;
        }
    }
    assert!(links >= 10, "{links}");
}

#[test]
fn the_programs_of_the_cookbook_fit_into_the_page() {
    let mut programs = 0;
    for (path, text) in sources("src/guide/cookbook") {
        let mut inside = false;
        for line in text.lines() {
            let fence = line.contains("```");
            if fence && !line.contains("```ignore") {
                inside = !inside;
                programs += usize::from(inside);
            }
            let line = line.strip_prefix("//! ").unwrap_or(line);
            let fits = fence || !inside || line.chars().count() <= 90;
            assert!(fits, "{}: rustdoc's page has about 90 columns: {line}", path.display());
        }
    }
    assert!(programs > 20, "{programs}");
}

#[test]
fn the_first_page_of_the_guide_lists_all_recipes() {
    let index = std::fs::read_to_string(root().join("src/guide/mod.rs")).unwrap();
    for (path, _) in sources("src/guide/cookbook") {
        let page = module(&path);
        assert!(page == "cookbook" || index.contains(&format!("](cookbook::{page})")), "{page}");
    }
}
