//! The chapter of promises names tests and files that exist.

use std::path::PathBuf;

use crate::root;

/// Returns `true` if a test program has this module or test: `program::module::test`.
fn is_test(path: &str) -> bool {
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
            return false;
        }
    }
    source.exists()
}

#[test]
fn every_test_that_is_named_exists() {
    let chapter = std::fs::read_to_string(root().join("docs/promises.md")).unwrap();
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
