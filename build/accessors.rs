//! Generates the accessors in `src/generated/` from the engine's field table, and the lists with
//! which the tests call every accessor. Used by `xtask` for the committed files, which are those of
//! 2.2.2, and by the build script for other versions of the engine.

use std::collections::HashSet;
use std::fmt::Write as _;

use crate::facts::{BY_HAND, CONSTANT, ENUMS, FLAGGED, LIMITS, WITHOUT_ACCESSOR};
use crate::notes::NOTES;
use crate::writable::{Access, access};
use crate::{arena, computed_by, derived};

/// Line of the field table.
#[derive(Clone, Copy)]
pub(crate) struct Field<'t> {
    owner: &'t str,
    kind: &'t str,
    pub(crate) ctype: &'t str,
    pub(crate) name: &'t str,
    pub(crate) rows: &'t str,
    pub(crate) columns: &'t str,
    comment: &'t str,
    table: &'t Table<'t>,
}

impl Field<'_> {
    /// Returns `true` for an array behind a pointer.
    fn is_array(self) -> bool {
        matches!(self.kind, "array" | "arena")
    }

    /// Returns the access of safe code to the values.
    fn access(self) -> Access {
        if self.is_array() { access(self.owner, self.name, self.ctype, self.table.version) } else { Access::ReadOnly }
    }

    /// Returns `true` if 2.2.2 has this array with the same type.
    fn is_in_default(self) -> bool {
        self.table.default.contains(&[self.owner, self.ctype, self.name])
    }
}

/// Facts about a field table.
struct Table<'t> {
    /// Owners, types and names of the fields of 2.2.2.
    default: HashSet<[&'t str; 3]>,
    /// `true` for the table of 2.2.2.
    is_default: bool,
    /// The engine's `mjVERSION_HEADER`.
    version: u32,
    /// Counts in `mjData`, which change with each state.
    counts: HashSet<&'t str>,
}

/// Returns `true` for a field with a mutable accessor. Of an array of the model, the derived
/// quantities must be known.
fn is_written(owner: &str, name: &str, access: Access) -> bool {
    access != Access::ReadOnly && (owner != "Model" || derived::is_known(name))
}

/// Returns the paths of the generated files in the repository, and their contents. `default` is the
/// table of 2.2.2, and `version` the `mjVERSION_HEADER` of the engine of `table`.
pub(crate) fn generate(table: &str, default: &str, version: u32) -> [(&'static str, String); 8] {
    let facts = Table {
        default: cells(default).map(|[owner, _, ctype, name, ..]| [owner, ctype, name]).collect(),
        is_default: table == default,
        version,
        counts: cells(table).filter(|line| line[..2] == ["Data", "scalar"]).map(|line| line[3]).collect(),
    };
    let fields: Vec<Field<'_>> = cells(table).map(|line| field(line, &facts)).collect();
    let of = |owner: &'static str| {
        fields.iter().copied().filter(move |field| {
            let is_vector = owner == "Data" && field.kind == "vector";
            let is_by_hand = BY_HAND.contains(&field.name) || WITHOUT_ACCESSOR.contains(&field.ctype);
            let is_workspace = field.kind == "arena" && arena::written_with(field.name).is_none();
            field.owner == owner && !is_vector && !is_by_hand && !is_workspace
        })
    };
    let is_written = |field: &Field<'_>| is_written(field.owner, field.name, field.access());

    let mut model = head(
        "use crate::ffi;\nuse crate::matrix::MatrixView;\nuse crate::model::Model;\n",
        "Sizes and arrays of the engine",
        "Model",
    );
    let mut model_mut = head(
        "use crate::ffi;\nuse crate::matrix::MatrixViewMut;\nuse crate::model::ModelMut;\n",
        "Writing to the engine's arrays",
        "ModelMut<'_>",
    );
    let flags = if facts.is_default { "" } else { "use crate::stage::PipelineFlags;\n" };
    let mut data = head(
        &format!("use crate::data::Data;\nuse crate::ffi;\nuse crate::matrix::{{MatrixView, MatrixViewMut}};\n{flags}"),
        "Sizes and arrays of the engine",
        "Data",
    );
    let mut restore =
        head("use crate::data::Data;\nuse crate::ffi;\nuse crate::model::{Model, ModelMut};\n", "", "ModelMut<'_>");
    restore.push_str(RESTORE_HEAD);
    for field in of("Model") {
        if field.kind == "array" && !CONSTANT.contains(&field.name) {
            restorer(&mut restore, field);
        }
    }
    restore.push_str("        }\n    }\n}\n\n");
    restore.push_str(CLEAR_HEAD);
    for field in of("Data") {
        let of_constraints = |size: &str| size.contains("njmax") || size.contains("nconmax");
        if field.kind == "array" && !of_constraints(field.rows) && !of_constraints(field.columns) {
            restorer(&mut restore, field);
        }
    }
    restore.push_str("        }\n    }\n");
    for field in of("Model") {
        reader(&mut model, field);
        if is_written(&field) {
            writer(&mut model_mut, field);
        }
    }
    for field in of("Data") {
        reader(&mut data, field);
        if is_written(&field) {
            writer(&mut data, field);
        }
    }
    for text in [&mut model, &mut model_mut, &mut restore, &mut data] {
        text.push_str("}\n");
    }
    let mut lists = String::from(LISTS_HEAD);
    for owner in ["Model", "Data"] {
        let lower = owner.to_lowercase();
        list(&mut lists, &format!("{lower}_readers"), of(owner).map(|field| field.name.to_owned()));
        let writers = of(owner).filter(is_written).map(|field| format!("{0}_mut({0})", field.name));
        list(&mut lists, &format!("{lower}_writers"), writers);
    }
    let mut settings = String::from(SETTINGS_HEAD);
    for owner in ["Option", "Visual", "Statistic"] {
        list(&mut settings, &format!("{}_fields", owner.to_lowercase()), of(owner).map(|field| field.name.to_owned()));
    }
    [
        ("src/generated/model.rs", model),
        ("src/generated/model_mut.rs", model_mut),
        ("src/generated/restore.rs", restore),
        ("src/generated/data.rs", data),
        ("src/generated/values.rs", values(&fields)),
        ("src/generated/numbers.rs", crate::numbers::generate(&of("Model").filter(is_written).collect::<Vec<_>>())),
        ("tests/common/accessors.rs", lists),
        ("tests/common/settings.rs", settings),
    ]
}

const RESTORE_HEAD: &str = "    /// Copies every array that an edit can change from another model of the same structure. Constant arrays, such as the
    /// vertices and faces of meshes, are not copied.
    #[allow(clippy::too_many_lines, reason = \"one line per array\")]
    pub(crate) fn restore_arrays(&mut self, pristine: &Model) {
        assert!(self.is_same_structure(pristine), \"Bug: a model restored from a model of another structure\");
        macro_rules! restore {
            ($($array:ident: $length:expr;)*) => { $(
                let (length, from, to) = ($length, pristine.raw().$array, self.raw_mut().$array);
                // SAFETY: both models have the array in this shape; `pristine` is borrowed, `self`
                // is borrowed exclusively.
                unsafe { ffi::array_mut(to, length).copy_from_slice(ffi::array(from, length)) };
            )* };
        }
        restore! {
";

const CLEAR_HEAD: &str = "impl Data {
    /// Sets every array to zero except those of constraints and contacts, which are most of a
    /// simulation's memory. Only their rows in use are ever read.
    #[allow(clippy::too_many_lines, reason = \"one line per array\")]
    pub(crate) fn clear_arrays(&mut self) {
        macro_rules! clear {
            ($($array:ident: $length:expr;)*) => { $(
                let (length, array) = ($length, self.raw_mut().$array);
                // SAFETY: the engine allocated the array with this shape, and `self` is borrowed
                // exclusively. Zero is valid for every element type.
                unsafe { ffi::array_mut(array, length).fill(Default::default()) };
            )* };
        }
        clear! {
";

const LISTS_HEAD: &str = "// Generated by `cargo xtask generate` from the engine's field table. Do not edit.

//! Lists of the generated accessors as callback macros: `model_readers! { then this }` expands to
//! `then! { this nq nv … }`. A writer is paired with its field: `qpos_mut(qpos)`.

#![allow(unused_macros, reason = \"each test uses only some of the lists\")]
";

const SETTINGS_HEAD: &str = "// Generated by `cargo xtask generate` from the engine's field table. Do not edit.

//! Lists of the fields of the settings as callback macros, as in `accessors.rs`.

#![allow(unused_macros, reason = \"each test uses only some of the lists\")]
";

const VALUES_HEAD: &str = "// Generated by `cargo xtask generate` from the engine's field table. Do not edit.

//! Lists of the values inside `mjModel` as callback macros: `model_sizes! { then }` expands to
//! `then! { nq nv … }`, and `model_settings! { then }` to
//! `then! { opt.timestep; … vis.global.fovy; … }`.
";

/// Returns the lists of the values inside `mjModel`.
fn values(fields: &[Field<'_>]) -> String {
    let mut text = String::from(VALUES_HEAD);
    let sizes = fields.iter().filter(|field| (field.owner, field.kind) == ("Model", "size"));
    list(&mut text, "model_sizes", sizes.map(|field| field.name.to_owned()));
    let member = |field: &Field<'_>| match field.owner {
        "Option" => Some(format!("opt.{};", field.name)),
        "Visual" => Some(format!("vis.{};", field.name)),
        "Statistic" => Some(format!("stat.{};", field.name)),
        _ => None,
    };
    list(&mut text, "model_settings", fields.iter().filter_map(member));
    text + "\npub(crate) use {model_settings, model_sizes};\n"
}

/// Writes a macro that passes a list to another macro.
fn list(text: &mut String, name: &str, entries: impl Iterator<Item = String>) {
    let _ = writeln!(text, "\nmacro_rules! {name} {{\n    ($then:ident $($before:tt)*) => {{ $then! {{ $($before)*");
    let mut line = String::from("       ");
    for entry in entries {
        if line.len() + entry.len() > 118 {
            let _ = writeln!(text, "{line}");
            line.truncate(7);
        }
        let _ = write!(line, " {entry}");
    }
    let _ = writeln!(text, "{line}\n    }} }};\n}}");
}

/// Splits the lines of a field table.
pub(crate) fn cells(table: &str) -> impl Iterator<Item = [&str; 7]> {
    table.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split('\t').collect();
        cells.try_into().unwrap_or_else(|_| panic!("not a line of the table: {line}"))
    })
}

fn field<'t>([owner, kind, ctype, name, rows, columns, comment]: [&'t str; 7], table: &'t Table<'t>) -> Field<'t> {
    Field { owner, kind, ctype, name, rows, columns, comment, table }
}

/// Returns the start of a generated file: imports, and the start of an `impl` block with a title in
/// the documentation.
pub(crate) fn head(imports: &str, title: &str, owner: &str) -> String {
    let title = if title.is_empty() { String::new() } else { format!("/// # {title}\n") };
    format!(
        "// Generated by `cargo xtask generate` from the engine's field table. Do not edit.\n\n{imports}\n{title}impl {owner} {{\n"
    )
}

/// Rust type of an array.
pub(crate) enum Form {
    /// One value per row.
    Slice,
    /// Fixed number of columns, as a Rust expression.
    Rows(String),
    /// Number of columns determined by the model.
    Matrix,
    /// Flat array whose layout depends on the storage of the constraint Jacobian, dense or sparse.
    Packed,
}

/// Returns the Rust type of an array.
pub(crate) fn form(field: Field<'_>) -> Form {
    let fixed = match field.columns {
        constant if constant.starts_with("mjN") && !field.table.is_default => {
            Some(format!("{{ mujoco_sys::{constant} as usize }}"))
        }
        "mjNREF" => Some("2".to_owned()),
        "mjNIMP" => Some("5".to_owned()),
        "mjNEQDATA" => Some("11".to_owned()),
        "mjNDYN" | "mjNGAIN" | "mjNBIAS" => Some("10".to_owned()),
        "mjNFLUID" => Some("12".to_owned()),
        columns => columns.parse().ok().map(|columns: usize| columns.to_string()),
    };
    match fixed {
        Some(columns) if columns == "1" => Form::Slice,
        Some(columns) => Form::Rows(columns),
        None if field.name.starts_with("efc_") || field.ctype != "mjtNum" => Form::Packed,
        None => Form::Matrix,
    }
}

/// Converts a size such as `nq`, `nuser_body` or `nwrap*2` to a Rust expression. Accessors of
/// constraint arrays return only the rows in use.
pub(crate) fn size(field: Field<'_>, expression: &str) -> String {
    let model = if field.owner == "Model" { "self" } else { "self.model()" };
    expression
        .split('*')
        .map(|factor| match factor.trim() {
            "njmax" if field.owner == "Data" => "self.nefc()".to_owned(),
            count if field.owner == "Data" && field.table.counts.contains(count) => format!("self.{count}()"),
            // 2.3.3 omits the count.
            "nnzJ" => "self.jacobian_len()".to_owned(),
            constant if constant.starts_with("mjN") => format!("mujoco_sys::{constant} as usize"),
            number if number.parse::<usize>().is_ok() => number.to_owned(),
            name => format!("{model}.{name}()"),
        })
        .collect::<Vec<_>>()
        .join(" * ")
}

/// Returns the number of rows of an array: that of its shape, or zero for an array in the arena
/// that the engine has not written.
fn rows(field: Field<'_>) -> String {
    // Before 2.3.3 the array has dense rows in any case.
    let rows = if field.kind == "arena" && field.name == "efc_J" && field.columns == "1" {
        "self.jacobian_len()".to_owned()
    } else {
        size(field, field.rows)
    };
    match arena::written_with(field.name).filter(|_| field.kind == "arena") {
        None => rows,
        Some(results) if arena::is_of_sparse_jacobian(field.name) => {
            format!("self.rows_of_sparse(PipelineFlags::{results}, {rows})")
        }
        Some(results) => format!("self.rows_after(PipelineFlags::{results}, {rows})"),
    }
}

/// Returns the comment of the header as a sentence, with its shape.
pub(crate) fn meaning(comment: &str) -> String {
    let (meaning, shape) = comment.rsplit_once('(').filter(|(_, shape)| shape.contains('x')).unwrap_or((comment, ""));
    let mut letters = meaning.trim().trim_end_matches(':').chars();
    let meaning: String = letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default();
    let meaning = meaning.replace('<', "\\<").replace('[', "\\[").replace(']', "\\]");
    let shape = shape.split(')').next().unwrap_or_default().trim();
    if shape.is_empty() { format!("{meaning}.") } else { format!("{meaning}. `({})`", shape.replace(" x ", ", ")) }
}

/// Writes the documentation of a reader.
fn documentation(text: &mut String, field: Field<'_>) {
    let _ = writeln!(text, "    /// {}", meaning(field.comment));
    // The assignment of activations to actuators differs between versions.
    let is_noted = field.table.is_default || field.name != "act";
    if let Some((_, note)) = NOTES.iter().find(|(name, _)| is_noted && *name == field.name) {
        let _ = writeln!(text, "    ///\n    /// {note}");
    }
    if matches!(form(field), Form::Packed) {
        let _ = writeln!(
            text,
            "    ///\n    /// Flat: dense rows, or sparse rows described by `*_rownnz`, `*_rowadr` and `*_colind` if the constraint Jacobian is sparse."
        );
    }
    if field.owner == "Data" {
        text.push_str(&computed_by::guarantee(field.name, field.kind, field.is_in_default()));
    }
    let _ = writeln!(text, "    ///\n    /// Engine field `mj{}.{}`.", field.owner, field.name);
    if let Some((_, alias)) = ENUMS.iter().find(|(name, _)| *name == field.name) {
        let _ = writeln!(text, "    #[doc(alias = \"{alias}\")]");
    }
}

/// Returns the Rust type of a C type.
pub(crate) fn rust_type(ctype: &str) -> &'static str {
    match ctype {
        "mjtNum" => "f64",
        "float" => "f32",
        "int" => "i32",
        "mjtByte" | "mjtBool" => "u8",
        "mjtSize" => "i64",
        other => panic!("no Rust type for {other}"),
    }
}

/// Writes the accessor of a field.
fn reader(text: &mut String, field: Field<'_>) {
    documentation(text, field);
    let name = field.name;
    if !field.is_array() {
        let (rust, value) = match field.ctype {
            "mjtNum" => ("f64", format!("self.raw().{name}")),
            "mjtBool" => ("bool", format!("self.raw().{name} != 0")),
            _ if LIMITS.contains(&name) && !field.table.is_default => {
                ("usize", format!("ffi::limit(self.raw().{name})"))
            }
            _ => ("usize", format!("ffi::size(self.raw().{name})")),
        };
        let _ = writeln!(text, "    #[inline]\n    pub fn {name}(&self) -> {rust} {{\n        {value}\n    }}\n");
        return;
    }
    let rust = rust_type(field.ctype);
    let rows = rows(field);
    let columns = size(field, field.columns);
    let (result, call) = match form(field) {
        Form::Slice => (format!("&[{rust}]"), format!("ffi::array(self.raw().{name}, {rows})")),
        Form::Rows(columns) => (format!("&[[{rust}; {columns}]]"), format!("ffi::rows(self.raw().{name}, {rows})")),
        Form::Matrix => {
            ("MatrixView<'_>".to_owned(), format!("MatrixView::from_raw(self.raw().{name}, {rows}, {columns})"))
        }
        Form::Packed => (format!("&[{rust}]"), format!("ffi::array(self.raw().{name}, {rows} * {columns})")),
    };
    let _ = writeln!(
        text,
        "    #[inline]\n    pub fn {name}(&self) -> {result} {{\n        // SAFETY: the engine allocated the array with this shape, and nothing writes to it while `self` is borrowed.\n        unsafe {{ {call} }}\n    }}\n"
    );
}

/// Writes the line of an array in the macro calls of `restore.rs`.
fn restorer(text: &mut String, field: Field<'_>) {
    let name = field.name;
    let mut length = size(field, field.rows);
    if field.columns != "1" {
        let columns = match form(field) {
            Form::Rows(columns) => columns,
            _ => size(field, field.columns),
        };
        let _ = write!(length, " * {columns}");
    }
    let _ = writeln!(text, "            {name}: {length};");
}

/// Writes the mutable accessor of an array.
fn writer(text: &mut String, field: Field<'_>) {
    let name = field.name;
    let rust = rust_type(field.ctype);
    let rows = rows(field);
    let columns = size(field, field.columns);
    let (result, call) = match form(field) {
        Form::Slice => (format!("&mut [{rust}]"), "ffi::array_mut(array, rows)"),
        Form::Rows(columns) => (format!("&mut [[{rust}; {columns}]]"), "ffi::rows_mut(array, rows)"),
        Form::Matrix => ("MatrixViewMut<'_>".to_owned(), "MatrixViewMut::from_raw(array, rows, columns)"),
        Form::Packed => (format!("&mut [{rust}]"), "ffi::array_mut(array, rows * columns)"),
    };
    let columns = if matches!(form(field), Form::Matrix | Form::Packed) {
        format!("\n        let columns = {columns};")
    } else {
        String::new()
    };
    let check = match field.access() {
        Access::Checked => {
            "\n    ///\n    /// Some of the values are addresses. An edit that would lead outside of the model's arrays is an error when it ends, or when\n    /// [`Data::new`](crate::Data::new) creates a simulation."
        }
        Access::Free | Access::ReadOnly => "",
    };
    let flagged = FLAGGED.iter().find(|(array, _)| field.owner == "Model" && *array == name);
    let clear_flags = flagged.map(|(_, method)| format!("        self.{method}();\n")).unwrap_or_default();
    let update = if field.owner == "Model" { derived::documentation(name) } else { String::new() };
    let _ = writeln!(
        text,
        "    /// Returns [`{name}`](crate::{}::{name}) for writing.{check}\n{update}    #[inline]\n    pub fn {name}_mut(&mut self) -> {result} {{\n{clear_flags}        let rows = {rows};{columns}\n        let array = self.raw_mut().{name};\n        // SAFETY: the engine allocated the array with this shape, and `self` is borrowed exclusively.\n        unsafe {{ {call} }}\n    }}\n",
        field.owner,
    );
}

#[cfg(test)]
mod tests {
    use super::{Access, is_written};

    #[test]
    fn a_writable_array_is_read_only_until_its_derived_quantities_are_known() {
        for (owner, name, access, expected) in [
            ("Model", "body_mass", Access::Free, true),
            ("Model", "body_mass", Access::ReadOnly, false),
            ("Model", "body_magic", Access::Free, false),
            ("Model", "body_magic", Access::Checked, false),
            ("Data", "magic", Access::Free, true),
        ] {
            assert_eq!(is_written(owner, name, access), expected, "{owner} {name} {access:?}");
        }
    }
}
