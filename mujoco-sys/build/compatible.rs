//! Bindings of one version for an engine of another, if the headers of both declare the same: those
//! of a patch release, for example. Used by the build script and by its tests.

use std::path::Path;
use std::process::Command;

use super::c_checks;
use super::rust_items::{self, Item};

/// Committed files of a version.
pub(crate) struct Committed {
    pub(crate) bindings: String,
    pub(crate) fields: String,
}

/// Headers, their field table, and a C compiler with a place for a file.
pub(crate) struct Headers<'a> {
    pub(crate) include: &'a Path,
    /// `mjVERSION_HEADER`.
    pub(crate) version: u32,
    /// Returns a command that runs the C compiler.
    pub(crate) compiler: &'a dyn Fn() -> Command,
    /// The field table of the headers.
    pub(crate) fields: &'a str,
    pub(crate) scratch: &'a Path,
}

/// Why the bindings of a version are not used.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// The first difference: the value of a constant, the type of a function, the size of a struct,
    /// the offset, type or length of a field.
    Different(String),
    /// The C compiler has failed.
    Unchecked(String),
}

/// Bindings for an engine, and the functions of the committed ones that it lacks.
pub(crate) struct Bindings {
    pub(crate) text: String,
    pub(crate) absent: Vec<String>,
}

/// Returns the bindings for an engine with these headers: the committed ones with its version and
/// without functions that it lacks.
pub(crate) fn bindings(headers: &Headers<'_>, committed: &Committed) -> Result<Bindings, Refusal> {
    same_tables(&committed.fields, headers.fields).map_err(Refusal::Different)?;
    let items = rust_items::items(&committed.bindings);
    let absent = undeclared(headers, &items)?;
    let text = with_version(&without(&committed.bindings, &absent), headers.version);
    let (c, _) = c_checks::checks(&rust_items::items(&text));
    let errors = errors(headers, &c)?;
    // A member that moves changes the size of its struct too.
    match errors.iter().find(|error| error.contains("offset of")).or(errors.first()) {
        Some(error) => Err(Refusal::Different(error.replace("static assertion failed: ", "").replace('"', ""))),
        None => Ok(Bindings { text, absent }),
    }
}

/// Compiles C text, and returns the compiler's errors.
fn errors(headers: &Headers<'_>, c: &str) -> Result<Vec<String>, Refusal> {
    let unchecked = |error: std::io::Error| Refusal::Unchecked(format!("the C compiler does not start: {error}"));
    std::fs::write(headers.scratch, c).map_err(unchecked)?;
    let mut compiler = (headers.compiler)();
    compiler.args(c_checks::FLAGS).arg("-I").arg(headers.include).arg(headers.scratch).env("LC_ALL", "C");
    let output = compiler.output().map_err(unchecked)?;
    let text = String::from_utf8_lossy(&output.stderr);
    let errors: Vec<String> =
        text.lines().filter_map(|line| line.split_once(" error: ")).map(|(_, error)| error.to_owned()).collect();
    if errors.is_empty() && !output.status.success() {
        return Err(Refusal::Unchecked(format!("the C compiler has failed: {text}")));
    }
    Ok(errors)
}

/// Returns the functions that the headers do not declare.
fn undeclared(headers: &Headers<'_>, items: &[Item]) -> Result<Vec<String>, Refusal> {
    let mut c = String::from("#include <mujoco/mujoco.h>\n");
    for item in items {
        if let Item::Function { name, .. } | Item::Static { name, .. } = item {
            c.extend(["typedef __typeof__(&", name, ") address_of_", name, ";\n"]);
        }
    }
    let errors = errors(headers, &c)?;
    // A suggestion names a function that is declared.
    let causes: Vec<&str> = errors.iter().filter_map(|error| error.split("did you mean").next()).collect();
    let is_undeclared = |name: &str| causes.iter().any(|cause| cause.contains(&format!("'{name}'")));
    let mut absent = Vec::new();
    for item in items {
        match item {
            Item::Function { name, .. } if is_undeclared(name) => absent.push(name.clone()),
            Item::Static { name, .. } if is_undeclared(name) => {
                return Err(Refusal::Different(format!("no declaration of {name}")));
            }
            _ => {}
        }
    }
    if absent.is_empty() && !errors.is_empty() {
        return Err(Refusal::Unchecked(format!("the C compiler has failed: {}", errors[0])));
    }
    Ok(absent)
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

/// Removes functions.
fn without(bindings: &str, functions: &[String]) -> String {
    let mut text = bindings.to_owned();
    for name in functions {
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
