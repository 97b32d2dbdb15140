//! Every test that the chapter of promises names is there.

use crate::{root, sources};

#[test]
fn every_test_that_is_named_exists() {
    let chapter = std::fs::read_to_string(root().join("docs/promises.md")).expect("the chapter");
    let sources = sources("tests");
    let mut named = 0;
    for name in chapter.split('`').skip(1).step_by(2) {
        let is_path = name.contains('/') && !name.contains([' ', '<']) && !name.starts_with("scripts/fuzz ");
        if is_path {
            assert!(root().join(name).exists(), "{name}");
            named += 1;
        } else if let Some(test) = name.split("::").last().filter(|last| name.contains("::") && last.contains('_')) {
            // An item of the crate, and not a test.
            if name.starts_with("mujoco_safe::") || name.starts_with(char::is_uppercase) {
                continue;
            }
            assert!(sources.iter().any(|(_, text)| text.contains(&format!("fn {test}("))), "{name}");
            named += 1;
        }
    }
    // The last column of the table: files and folders by their names.
    for line in chapter.lines().filter(|line| line.starts_with("| ") && line.matches('|').count() == 4) {
        let Some(test) =
            line.split('|').nth(3).map(str::trim).and_then(|cell| cell.strip_prefix('`')?.strip_suffix('`'))
        else {
            continue;
        };
        let file = test.split("::").next().unwrap_or_default();
        let found =
            ["tests/{}.rs", "tests/{}/main.rs", "{}"].iter().any(|form| root().join(form.replace("{}", file)).exists());
        assert!(found, "{test}");
        named += 1;
    }
    assert!(named > 30, "{named}");
}
