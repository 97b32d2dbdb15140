//! Which lines of a text are used: those between `//#if NAME` and `//#end` where the name holds. A line `//#name` is replaced.

use std::fmt::Write;

/// The lines that are used.
pub(super) fn chosen(files: &[&str], flags: &[(&str, bool)], inserts: &[(&str, &str)]) -> String {
    let mut text = String::new();
    // Whether the lines within each `if` that is open are used.
    let mut open = Vec::new();
    for line in files.iter().flat_map(|file| file.lines()) {
        let is_used = open.iter().all(|&holds| holds);
        let Some(word) = line.trim_start().strip_prefix("//#") else {
            if is_used && !line.trim_start().starts_with("//") {
                let _ = writeln!(text, "{line}");
            }
            continue;
        };
        if let Some(name) = word.strip_prefix("if ") {
            let flag = flags.iter().find(|(flag, _)| *flag == name);
            open.push(flag.unwrap_or_else(|| panic!("Bug: the shader's flag {name} is unknown")).1);
        } else if word == "end" {
            open.pop();
        } else if is_used {
            let insert = inserts.iter().find(|(insert, _)| *insert == word);
            text.push_str(insert.unwrap_or_else(|| panic!("Bug: the shader's insert {word} is unknown")).1);
        }
    }
    assert!(open.is_empty(), "Bug: an if of a shader has no end");
    text
}

#[cfg(test)]
mod tests {
    use super::chosen;

    #[test]
    fn only_what_holds_is_used() {
        let file = "a\n//#if X\nb\n//#if Y\nc\n//#end\nd\n//#end\n// a comment\n//#here\ne";
        let inserts = [("here", "new\n")];
        assert_eq!(chosen(&[file], &[("X", true), ("Y", false)], &inserts), "a\nb\nd\nnew\ne\n");
        assert_eq!(chosen(&[file], &[("X", false), ("Y", true)], &inserts), "a\nnew\ne\n");
    }
}
