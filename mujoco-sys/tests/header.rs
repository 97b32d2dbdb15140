//! Compares the bindings with the headers of the installed engine, using only a C compiler.
//!
//! The test translates all declarations of the bindings into C that compiles only if the headers
//! declare the same: sizes, alignments, offsets and types of fields, values of constants, types of
//! functions and of global variables. Further tests compare the list of functions and the field
//! table in both directions.

#[path = "../build/c_checks.rs"]
mod c_checks;
#[path = "header/compiler.rs"]
mod compiler;
#[path = "../build/fields.rs"]
mod fields;
#[path = "../build/rust_items.rs"]
mod rust_items;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use compiler::{INCLUDE, compiler};
use rust_items::{Item, Type};

/// The bindings of this build: the committed ones, or with the feature `bindgen` the generated
/// ones.
const BINDINGS: &str = include_str!(concat!(env!("OUT_DIR"), "/bindings.rs"));
/// Name of the committed files of this engine, which may not exist.
const NAME: &str = env!("MUJOCO_SYS_NAME");

/// Compiles C text, and returns the compiler's errors.
fn compile(name: &str, text: &str) -> Result<(), String> {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).with_extension("c");
    fs::write(&file, text).expect("the test directory is writable");
    let output = compiler()
        .include(INCLUDE)
        .get_compiler()
        .to_command()
        .args(c_checks::FLAGS)
        .arg(&file)
        .output()
        .expect("the C compiler runs");
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

#[test]
fn every_declaration_of_the_bindings_matches_the_headers() {
    let (text, checked) = c_checks::checks(&rust_items::items(BINDINGS));
    // Counts the declarations of each kind independently, so that the translation cannot lose a
    // check.
    let lines = |start: &str| BINDINGS.lines().filter(|line| line.trim_start().starts_with(start)).count();
    let expected = c_checks::Checked {
        constants: lines("pub const "),
        aliases: lines("pub type ") + lines("pub use "),
        records: lines("pub struct ") + lines("pub union "),
        fields: BINDINGS.matches("Offset of field: ").count(),
        functions: lines("pub fn "),
        statics: lines("pub static mut "),
        layouts: BINDINGS.matches("[\"").count(),
    };
    assert_eq!(checked, expected);
    assert!(checked.functions > 200 && checked.fields > 800, "{checked:?}");
    if let Err(errors) = compile("bindings", &text) {
        panic!("the bindings differ from the headers in {INCLUDE}:\n{errors}");
    }
}

/// Changes the text of the bindings in each possible way and expects an error that names the
/// difference.
#[test]
fn a_difference_of_any_kind_between_bindings_and_headers_is_detected() {
    let joint = if BINDINGS.contains("mjtJoint_") { "mjtJoint_" } else { "mjtJoint" };
    let hinge = format!("mjJNT_HINGE: {joint} = ");
    let changes = [
        ("constant", "mjMAXCONPAIR: u32 = ", "mjMAXCONPAIR: u32 = 1", "mjMAXCONPAIR"),
        ("real_constant", "mjMINVAL: f64 = 0.0", "mjMINVAL: f64 = 0.1", "mjMINVAL"),
        ("enum_constant", &hinge, &format!("{hinge}1"), "mjJNT_HINGE"),
        ("enum_type", &format!("{joint} = ::core::ffi::c_uint"), &format!("{joint} = ::core::ffi::c_int"), joint),
        ("alias", "mjtNum = f64", "mjtNum = f32", "mjtNum"),
        ("size", "size_of::<mjModel_>() - ", "size_of::<mjModel_>() - 1", "size of mjModel_"),
        ("alignment", "align_of::<mjModel_>() - ", "align_of::<mjModel_>() - 1", "alignment of mjModel_"),
        ("offset", "offset_of!(mjContact_, dist) - ", "offset_of!(mjContact_, dist) - 1", "mjContact_.dist"),
        ("field", "pub mu: mjtNum", "pub mu: i64", "mjContact_.mu"),
        ("parameter", "fn mju_zero3(res: *mut mjtNum)", "fn mju_zero3(res: *mut f32)", "mju_zero3"),
        ("constness", "fn mju_dot3(vec1: *const mjtNum", "fn mju_dot3(vec1: *mut mjtNum", "mju_dot3"),
        ("arity", "fn mj_version()", "fn mj_version(more: f64)", "mj_version"),
        ("result", "fn mj_version() -> ::core::ffi::c_int", "fn mj_version() -> f64", "mj_version"),
        ("global", "static mut mjcb_time: mjfTime", "static mut mjcb_time: mjfAct", "mjcb_time"),
        ("function", "fn mj_version()", "fn mj_version_2()", ""),
    ];
    for (name, from, to, named) in changes {
        assert!(BINDINGS.contains(from), "{name}: the bindings have no {from:?}");
        let changed = BINDINGS.replacen(from, to, 1);
        let (text, _) = c_checks::checks(&rust_items::items(&changed));
        let outcome = compile(name, &text);
        if name == "function" {
            // C accepts a declaration that the headers lack; the comparison of the lists detects
            // it.
            assert_eq!(outcome, Ok(()));
            assert_ne!(bound_functions(&changed), declared_functions());
            continue;
        }
        let errors = outcome.expect_err(name);
        assert!(errors.contains(named), "{name}: {errors}");
    }
}

#[test]
fn the_bindings_have_exactly_the_functions_of_the_headers() {
    let (bound, declared) = (bound_functions(BINDINGS), declared_functions());
    let missing: Vec<_> = declared.difference(&bound).collect();
    let unknown: Vec<_> = bound.difference(&declared).collect();
    // Bindings of another version may lack functions that are new.
    let is_complete = missing.is_empty() || committed_bindings().is_none() && cfg!(not(feature = "bindgen"));
    assert!(is_complete && unknown.is_empty(), "not bound: {missing:?}; not in the headers: {unknown:?}");
}

fn bound_functions(bindings: &str) -> BTreeSet<String> {
    rust_items::items(bindings)
        .into_iter()
        .filter_map(|item| if let Item::Function { name, .. } = item { Some(name) } else { None })
        .collect()
}

/// Returns the texts of `mujoco.h` and of the headers that it includes.
fn headers() -> Vec<String> {
    let (mut names, mut texts) = (vec!["mujoco.h".to_owned()], Vec::new());
    while let Some(name) = names.get(texts.len()) {
        let path = Path::new(INCLUDE).join("mujoco").join(name);
        // Some of Debian's headers contain Latin-1.
        let text = String::from_utf8_lossy(&fs::read(&path).expect("a header can be read")).into_owned();
        for line in text.lines() {
            let name =
                line.strip_prefix("#include <mujoco/").and_then(|rest| rest.split_once('>')).map(|(name, _)| name);
            if let Some(name) = name.filter(|name| !names.iter().any(|known| known == name)) {
                names.push(name.to_owned());
            }
        }
        texts.push(text);
    }
    texts
}

/// Returns the names of all functions that the headers export: the names between `MJAPI` and a
/// parenthesis.
fn declared_functions() -> BTreeSet<String> {
    let mut functions = BTreeSet::new();
    for text in headers() {
        let code: String = text
            .lines()
            .filter(|line| !line.trim_start().starts_with('#'))
            .map(|line| line.split_once("//").map_or(line, |(code, _)| code).to_owned() + "\n")
            .collect();
        for declaration in code.split("MJAPI").skip(1) {
            let declaration = declaration.split(';').next().unwrap_or_default().trim_start();
            // A global variable is `extern`.
            if let Some((head, _)) = declaration.split_once('(').filter(|(head, _)| !head.starts_with("extern")) {
                let name = head.trim_end().rsplit([' ', '\n', '*']).next().unwrap_or_default();
                // Functions with two underscores exist only in builds with AddressSanitizer.
                if !name.contains("__") {
                    functions.insert(name.to_owned());
                }
            }
        }
    }
    functions
}

#[test]
fn the_committed_field_table_is_that_of_the_headers() {
    // For another engine the build script generates the table from the same headers.
    if let Some(committed) = committed(&format!("fields/{NAME}.tsv")) {
        let fields_h = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/build/fields.h"));
        let made = fields::table(Path::new(INCLUDE), fields_h, compiler().get_compiler().to_command())
            .expect("the headers can be expanded");
        assert_eq!(first_difference(&committed, &made), None);
    }
}

/// Members that the table omits, with the reason.
const NOT_IN_THE_TABLE: [(&str, &str, &str); 6] = [
    ("Data", SCRATCH, "the engine's scratch memory"),
    ("Model", "opt", "its members are those of Option"),
    ("Model", "vis", "its members are those of Visual"),
    ("Model", "stat", "its members are those of Statistic"),
    ("Model", "buffer", "the memory of all arrays of the model"),
    ("Data", "buffer", "the memory of all arrays of the data"),
];

/// Members without a macro in `mjxmacro.h`: flags and checks for the engine's own use, and sizes
/// that 2.3.0 to 2.3.3 omit.
const INTERNAL: [&str; 9] = [
    "signature",
    "threadlock",
    "flg_gravcomp",
    "flg_surfacevel",
    "flg_adhesion",
    "parena",
    "maxuse_arena",
    "nplugin",
    "nnzJ",
];

/// The engine's scratch memory. Since 2.3 it also contains the arrays of contacts and constraints.
const SCRATCH: &str = if mujoco_sys::mjVERSION_HEADER < 230 { "stack" } else { "arena" };

#[test]
fn the_table_has_every_member_of_the_structs_with_its_type_and_length() {
    let items = rust_items::items(BINDINGS);
    let mut declared = BTreeSet::new();
    for owner in ["Model", "Data", "Option", "Visual", "Statistic"] {
        add_members(&items, owner, &format!("mj{owner}_"), "", &mut declared);
    }
    for (owner, name, why) in NOT_IN_THE_TABLE {
        let count = declared.len();
        declared.retain(|member| !member.starts_with(&format!("{owner} {name} ")));
        assert_eq!(declared.len() + 1, count, "{owner}.{name} ({why}) is not a member of the struct");
    }
    let lines: Vec<Vec<&str>> = mujoco_sys::FIELDS.lines().skip(1).map(|line| line.split('\t').collect()).collect();
    let table: BTreeSet<String> = lines
        .iter()
        // The bindings have one type for both.
        .map(|line| line.iter().map(|&cell| if cell == "uintptr_t" { "size_t" } else { cell }).collect::<Vec<_>>())
        .map(|line| match line[..] {
            [owner, "array" | "arena", ctype, name, _, _, _] => format!("{owner} {name} pointer to {ctype}"),
            [owner, "vector", ctype, name, rows, columns, _] => {
                format!("{owner} {name} {} of {ctype}", length(&items, rows) * length(&items, columns))
            }
            [owner, "size" | "scalar", ctype, name, "1", "1", _] => format!("{owner} {name} {ctype}"),
            _ => panic!("not a line of the table: {line:?}"),
        })
        .collect();
    assert_eq!(table.len(), lines.len(), "no line occurs twice");
    let is_internal = |member: &str| INTERNAL.iter().any(|name| member.split(' ').nth(1) == Some(name));
    let missing: Vec<_> = declared.difference(&table).filter(|member| !is_internal(member)).collect();
    let unknown: Vec<_> = table.difference(&declared).collect();
    assert!(missing.is_empty() && unknown.is_empty(), "not in the table: {missing:?}; not in the structs: {unknown:?}");
    let uncommented: Vec<_> = lines.iter().filter(|line| line[6].is_empty()).map(|line| line[3]).collect();
    assert!(uncommented.iter().all(|&name| name == "threadpool"), "without a comment: {uncommented:?}");
}

/// Adds the members of the record `of` in the table's format: `Visual global.fovy float`.
fn add_members(items: &[Item], owner: &str, of: &str, before: &str, to: &mut BTreeSet<String>) {
    let fields = items.iter().find_map(|item| match item {
        Item::Record { name, fields, .. } if name == of => Some(fields),
        _ => None,
    });
    for (name, of) in fields.unwrap_or_else(|| panic!("the bindings have no {of}")) {
        let what = match of {
            Type::Named(inner) if inner.contains("__bindgen_ty_") => {
                add_members(items, owner, inner, &format!("{before}{name}."), to);
                continue;
            }
            Type::Named(of) => c_name(of).to_owned(),
            Type::Pointer { to, .. } => match &**to {
                Type::Named(of) => format!("pointer to {}", c_name(of)),
                other => panic!("a pointer to {other:?}"),
            },
            Type::Array(of, length) => match &**of {
                Type::Named(of) => format!("{length} of {}", c_name(of)),
                other => panic!("an array of {other:?}"),
            },
            Type::Function(_) => panic!("a function in a struct of numbers"),
        };
        to.insert(format!("{owner} {before}{name} {what}"));
    }
}

fn c_name(rust: &str) -> &str {
    match rust {
        "f32" => "float",
        "c_int" => "int",
        "c_char" => "char",
        "usize" => "size_t",
        "u64" => "uint64_t",
        other => other,
    }
}

/// Returns the value of a number or of a named constant.
fn length(items: &[Item], length: &str) -> usize {
    let value = items.iter().find_map(|item| match item {
        Item::Constant { name, value } if name == length => Some(value.as_str()),
        _ => None,
    });
    value.unwrap_or(length).parse().unwrap_or_else(|_| panic!("{length} is no length"))
}

#[test]
fn without_bindgen_the_bindings_are_the_committed_ones() {
    if let Some(committed) = committed_bindings().filter(|_| cfg!(not(feature = "bindgen"))) {
        assert_eq!(first_difference(&committed, BINDINGS), None);
    }
}

#[cfg(feature = "bindgen")]
#[test]
fn bindgen_generates_the_committed_bindings_from_the_headers_of_their_version() {
    if let Some(committed) = committed_bindings() {
        // The first line contains the version of bindgen.
        let body = |text: &str| text.split_once('\n').expect("more than a line").1.to_owned();
        assert_eq!(first_difference(&body(&committed), &body(BINDINGS)), None);
    }
}

/// Returns the text of a committed file, if this engine has it.
fn committed(path: &str) -> Option<String> {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).ok()
}

fn committed_bindings() -> Option<String> {
    committed(&format!("src/bindings/{NAME}.rs"))
}

/// Returns the number of the first line that differs, and the line of each text.
fn first_difference<'a>(a: &'a str, b: &'a str) -> Option<(usize, Option<&'a str>, Option<&'a str>)> {
    let (mut left, mut right) = (a.lines(), b.lines());
    let count = a.lines().count().max(b.lines().count());
    (1..=count).map(|number| (number, left.next(), right.next())).find(|(_, left, right)| left != right)
}
