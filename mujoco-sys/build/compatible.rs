//! Bindings of one version for an engine of another, if the headers of both declare the same: those
//! of a patch release, for example. Used by the build script and by its tests.

use std::path::Path;
use std::process::Command;

use super::rust_items::{self, Item};
use super::{c_checks, fields};

/// Committed files of a version.
pub(crate) struct Committed {
    pub(crate) bindings: String,
    pub(crate) fields: String,
}

/// Headers, and a C compiler with a place for a file.
pub(crate) struct Headers<'a> {
    pub(crate) include: &'a Path,
    /// `mjVERSION_HEADER`.
    pub(crate) version: u32,
    /// Returns a command that runs the C compiler.
    pub(crate) compiler: &'a dyn Fn() -> Command,
    pub(crate) fields_h: &'a Path,
    pub(crate) scratch: &'a Path,
}

/// Returns the bindings for an engine with these headers: the committed ones with its version and
/// without functions that it lacks.
///
/// # Errors
///
/// Returns the first difference between the headers and the committed files: the value of a
/// constant, the type of a function, the size of a struct, the offset, type or length of a field.
pub(crate) fn bindings(headers: &Headers<'_>, committed: &Committed) -> Result<String, String> {
    let made = fields::table(headers.include, headers.fields_h, (headers.compiler)())?;
    same_tables(&committed.fields, &made)?;
    let text = with_version(&without_absent(&committed.bindings, &declarations(headers.include)?), headers.version);
    let (c, _) = c_checks::checks(&rust_items::items(&text));
    std::fs::write(headers.scratch, c).map_err(|error| format!("{}: {error}", headers.scratch.display()))?;
    let output = (headers.compiler)()
        .arg("-I")
        .arg(headers.include)
        .args(["-std=gnu11", "-fsyntax-only", "-Werror=incompatible-pointer-types", "-w"])
        .arg(headers.scratch)
        .output()
        .map_err(|error| format!("the C compiler does not start: {error}"))?;
    if output.status.success() {
        return Ok(text);
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    let messages = || errors.lines().filter_map(|line| line.split_once("error: ")).map(|(_, message)| message);
    // A member that moves changes the size of its struct too.
    let first = messages().find(|message| message.contains("offset of")).or_else(|| messages().next());
    Err(first.unwrap_or(&errors).replace("static assertion failed: ", "").replace('"', ""))
}

/// Compares two field tables except for the comments of the headers.
fn same_tables(committed: &str, made: &str) -> Result<(), String> {
    let rows = |table: &str| -> Vec<String> {
        table.lines().map(|line| line.rsplit_once('\t').map_or(line, |(cells, _)| cells).to_owned()).collect()
    };
    let (committed, made) = (rows(committed), rows(made));
    let shown = |row: &String| row.replace('\t', " ");
    if let Some(row) = made.iter().find(|row| !committed.contains(row)) {
        return Err(format!("mjxmacro.h has: {}", shown(row)));
    }
    if let Some(row) = committed.iter().find(|row| !made.contains(row)) {
        return Err(format!("mjxmacro.h lacks: {}", shown(row)));
    }
    if committed == made { Ok(()) } else { Err("mjxmacro.h has another order of fields".to_owned()) }
}

/// Returns the texts of all headers without comments.
fn declarations(include: &Path) -> Result<String, String> {
    let folder = include.join("mujoco");
    let unreadable = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut text = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|extension| extension == "h") {
            text.extend(std::fs::read(&path).map_err(unreadable)?);
        }
    }
    // Some of Debian's headers contain Latin-1.
    let text = String::from_utf8_lossy(&text);
    Ok(text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n"))
}

/// Removes the functions whose names the headers do not contain.
fn without_absent(bindings: &str, headers: &str) -> String {
    let mut text = bindings.to_owned();
    for item in rust_items::items(bindings) {
        let Item::Function { name, .. } = item else { continue };
        if headers.contains(&format!("{name}(")) {
            continue;
        }
        // bindgen writes a block for each function.
        let (start, end) = ("unsafe extern \"C\" {", "\n}\n");
        let at = text.find(&format!("pub fn {name}(")).expect("the parser has found it");
        let first = text[..at].rfind(start).expect("a function is in a block");
        let last = at + text[at..].find(end).expect("a block ends") + end.len();
        text.replace_range(first..last, "");
    }
    text
}

fn with_version(bindings: &str, version: u32) -> String {
    let line = "pub const mjVERSION_HEADER: u32 = ";
    let (before, after) = bindings.split_once(line).expect("the bindings have the version");
    let (_, rest) = after.split_once(';').expect("a constant ends");
    format!("{before}{line}{version};{rest}")
}
