//! Makes `model.rs`, `model_mut.rs`, `restore.rs` and `data.rs` of this folder from the engine's field table, and the lists by which the tests
//! call every accessor. Part of no build: the test `generated` includes this file, compares its output with what is committed,
//! and writes it when it is told to.

use std::fmt::Write as _;

#[path = "computed_by.rs"]
mod computed_by;

/// A line of the field table.
#[derive(Clone, Copy)]
struct Field<'t> {
    owner: &'t str,
    kind: &'t str,
    ctype: &'t str,
    name: &'t str,
    rows: &'t str,
    columns: &'t str,
    comment: &'t str,
}

/// Arrays that have an accessor of their own, written by hand: `Model::name`, `Model::text_data`, `Data::contacts`,
/// `Data::warning`, `Data::timer`, `Data::solver`, `Data::solver_fwdinv`, `Data::energy`.
const BY_HAND: [&str; 8] = ["names", "text_data", "contact", "warning", "timer", "solver", "solver_fwdinv", "energy"];

/// Reals that decide where the engine reads: `wrap_prm` holds the id of a site, as a double; `hfield_size` divides positions to
/// give rows and columns; the convex hull of a mesh was computed from its vertices, and collision with vertices that it does
/// not fit need not end.
const READ_ONLY: [&str; 3] = ["wrap_prm", "hfield_size", "mesh_vert"];

/// Reals about which the compiler has noted what lets the engine take a shortcut, and the method that takes the note back before
/// they are lent to be written to.
const NOTED: [(&str, &str); 11] = [
    ("geom_pos", "clear_geom_frame_flags"),
    ("geom_quat", "clear_geom_frame_flags"),
    ("site_pos", "clear_site_frame_flags"),
    ("site_quat", "clear_site_frame_flags"),
    ("body_ipos", "clear_inertial_frame_flags"),
    ("body_iquat", "clear_inertial_frame_flags"),
    ("body_mass", "clear_simple_body_flags"),
    ("body_inertia", "clear_simple_body_flags"),
    ("jnt_pos", "clear_simple_body_flags"),
    ("jnt_axis", "clear_simple_body_flags"),
    ("dof_armature", "clear_simple_body_flags"),
];

/// Arrays of any length that nothing can change in a compiled model. All others are put back where a model is, the short ones
/// that are constant too: they cost less than a list that has to be kept.
const CONSTANT: [&str; 5] = ["mesh_vert", "mesh_face", "mesh_graph", "skin_face", "skin_bonevertid"];

/// What the header's one-line comment leaves open, for the fields that a program uses most.
const NOTES: [(&str, &str); 22] = [
    (
        "qpos",
        "Metres for slides, radians for hinges; a ball joint has a unit quaternion `[w, x, y, z]`, a free joint a position in the world frame and then such a quaternion. `nq` is `nv` only if there is neither ball nor free joint.",
    ),
    (
        "qvel",
        "In `m/s` and `rad/s`. A free joint's linear velocity is in the world frame, its angular velocity, like a ball joint's, in the frame of the body.",
    ),
    ("qacc", "In `m/s²` and `rad/s²`, in the frames of `qvel`. The result of `forward`, the input of `inverse`."),
    ("act", "The state of the actuators that have one: the last `na` of them."),
    (
        "ctrl",
        "In the units of each actuator: for a motor, torque or force divided by its gear. Clamped to `actuator_ctrlrange` where that is limited.",
    ),
    ("qfrc_applied", "In N and N·m, one for each degree of freedom. Stays until it is changed."),
    (
        "xfrc_applied",
        "For each body a force in N and then a torque in N·m, in the world frame, at the body's centre of mass. Stays until it is changed.",
    ),
    ("mocap_pos", "In metres, in the world frame."),
    ("mocap_quat", "Unit quaternions `[w, x, y, z]`."),
    ("xpos", "In metres, in the world frame."),
    ("xquat", "Unit quaternions `[w, x, y, z]`, from the body frame to the world."),
    ("xmat", "Row-major 3 × 3 rotations from the body frame to the world."),
    ("xipos", "In metres, in the world frame."),
    ("subtree_com", "In metres, in the world frame."),
    ("geom_xpos", "In metres, in the world frame."),
    ("site_xpos", "In metres, in the world frame."),
    ("sensordata", "The readings of all sensors, each at its own address."),
    ("qfrc_inverse", "In N and N·m. The result of `inverse`."),
    (
        "actuator_moment",
        "Row `i` is the derivative of the length of actuator `i` by each degree of freedom, its gear included: `moment' · force` is `qfrc_actuator`.",
    ),
    ("qfrc_actuator", "In N and N·m."),
    ("body_mass", "In kilograms."),
    ("body_inertia", "In kg·m², about the centre of mass, along the axes of the inertial frame."),
];

/// The generated files, by their paths in the repository.
pub(crate) fn generate(table: &str) -> [(&'static str, String); 5] {
    let fields: Vec<Field<'_>> = table.lines().skip(1).map(parse).collect();
    let of = |owner: &'static str| {
        fields.iter().copied().filter(move |field| field.owner == owner && !BY_HAND.contains(&field.name))
    };
    let is_written = |field: &Field<'_>| match field.owner {
        "Model" => {
            field.kind == "array" && matches!(field.ctype, "mjtNum" | "float") && !READ_ONLY.contains(&field.name)
        }
        _ => field.kind == "array" && field.ctype == "mjtNum",
    };

    let mut model = head("Model", "use crate::ffi;\nuse crate::matrix::MatrixView;\nuse crate::model::Model;\n");
    let mut model_mut =
        head("ModelMut", "use crate::ffi;\nuse crate::matrix::MatrixViewMut;\nuse crate::model::ModelMut;\n");
    let mut data =
        head("Data", "use crate::data::Data;\nuse crate::ffi;\nuse crate::matrix::{MatrixView, MatrixViewMut};\n");
    let mut restore =
        head("ModelMut", "use crate::data::Data;\nuse crate::ffi;\nuse crate::model::{Model, ModelMut};\n");
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
    for owner in ["Option", "Visual", "Statistic"] {
        list(&mut lists, &format!("{}_fields", owner.to_lowercase()), of(owner).map(|field| field.name.to_owned()));
    }
    [
        ("src/generated/model.rs", model),
        ("src/generated/model_mut.rs", model_mut),
        ("src/generated/restore.rs", restore),
        ("src/generated/data.rs", data),
        ("tests/common/fields.rs", lists),
    ]
}

const RESTORE_HEAD: &str = "    /// Takes over every array of the other model that an edit can have changed; what none can, such as the vertices and faces
    /// of meshes, is not copied. The two have the same structure.
    #[allow(clippy::too_many_lines, reason = \"a line for each array\")]
    pub(crate) fn restore_arrays(&mut self, pristine: &Model) {
        assert!(self.is_same_structure(pristine), \"Bug: a model restored from another one\");
        macro_rules! restore {
            ($($array:ident: $length:expr;)*) => { $(
                let (length, from, to) = ($length, pristine.raw().$array, self.raw_mut().$array);
                // SAFETY: both models have the array in this shape; the one is borrowed, the other borrowed exclusively.
                unsafe { ffi::array_mut(to, length).copy_from_slice(ffi::array(from, length)) };
            )* };
        }
        restore! {
";

const CLEAR_HEAD: &str = "impl Data {
    /// Sets every array to zero, save those of constraints and contacts, of which only the rows in use are ever read. They are most
    /// of a simulation's memory.
    #[allow(clippy::too_many_lines, reason = \"a line for each array\")]
    pub(crate) fn clear_arrays(&mut self) {
        macro_rules! clear {
            ($($array:ident: $length:expr;)*) => { $(
                let (length, array) = ($length, self.raw_mut().$array);
                // SAFETY: the engine allocated the array with this shape, and `self` is borrowed exclusively. Zero is a value.
                unsafe { ffi::array_mut(array, length).fill(Default::default()) };
            )* };
        }
        clear! {
";

const LISTS_HEAD: &str = "// Generated by src/generated/generator.rs from the engine's field table: not edited by hand.

//! The accessors that are made from the table of fields, and the fields of the smaller structs: lists that are handed to a
//! macro. `model_readers! { then this }` is `then! { this nq nv … }`. A writer comes with its field: `qpos_mut(qpos)`.

#![allow(unused_macros, reason = \"each test has its own use for some of them\")]
";

/// A macro that hands a list on to another.
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

fn parse(line: &str) -> Field<'_> {
    let cells: Vec<&str> = line.split('\t').collect();
    let [owner, kind, ctype, name, rows, columns, comment] = cells[..] else {
        panic!("not a line of the table: {line}")
    };
    Field { owner, kind, ctype, name, rows, columns, comment }
}

fn head(owner: &str, imports: &str) -> String {
    format!(
        "// Generated by generator.rs from the engine's field table: not edited by hand.\n\n{imports}\nimpl {owner}{} {{\n",
        if owner == "ModelMut" { "<'_>" } else { "" }
    )
}

/// How an array is handed out.
enum Form {
    /// One number a row.
    Slice,
    /// A fixed number of columns.
    Rows(usize),
    /// As many columns as the model says.
    Matrix,
    /// An array of several rows whose layout depends on whether the constraint Jacobian is sparse.
    Packed,
}

fn form(field: Field<'_>) -> Form {
    let fixed = match field.columns {
        "mjNREF" => Some(2),
        "mjNIMP" => Some(5),
        "mjNEQDATA" => Some(11),
        "mjNDYN" | "mjNGAIN" | "mjNBIAS" => Some(10),
        "mjNFLUID" => Some(12),
        columns => columns.parse().ok(),
    };
    match fixed {
        Some(1) => Form::Slice,
        Some(columns) => Form::Rows(columns),
        None if field.name.starts_with("efc_") || field.ctype != "mjtNum" => Form::Packed,
        None => Form::Matrix,
    }
}

/// A size as a Rust expression: `nq`, `nuser_body`, `nwrap*2`. Of the constraint arrays only the rows in use are handed out.
fn size(field: Field<'_>, expression: &str) -> String {
    let model = if field.owner == "Model" { "self" } else { "self.model()" };
    expression
        .split('*')
        .map(|factor| match factor.trim() {
            "njmax" if field.owner == "Data" => "self.nefc()".to_owned(),
            number if number.parse::<usize>().is_ok() => number.to_owned(),
            name => format!("{model}.{name}()"),
        })
        .collect::<Vec<_>>()
        .join(" * ")
}

fn documentation(text: &mut String, field: Field<'_>) {
    let (meaning, shape) =
        field.comment.rsplit_once('(').filter(|(_, shape)| shape.contains('x')).unwrap_or((field.comment, ""));
    let meaning = meaning.trim().trim_end_matches(':');
    let shape = shape.split(')').next().unwrap_or_default().trim();
    let mut letters = meaning.chars();
    let meaning: String = letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default();
    let meaning = meaning.replace('<', "\\<").replace('[', "\\[").replace(']', "\\]");
    let _ = write!(text, "    /// {meaning}.");
    if !shape.is_empty() {
        let _ = write!(text, " `({})`", shape.replace(" x ", ", "));
    }
    text.push('\n');
    if let Some((_, note)) = NOTES.iter().find(|(name, _)| *name == field.name) {
        let _ = writeln!(text, "    ///\n    /// {note}");
    }
    if matches!(form(field), Form::Packed) {
        let _ = writeln!(
            text,
            "    ///\n    /// Flat: dense rows, or packed by `*_rownnz`, `*_rowadr` and `*_colind` where the constraint Jacobian is sparse."
        );
    }
    if field.owner == "Data" {
        text.push_str(&computed_by::guarantee(field.name, field.kind));
    }
    let _ = writeln!(text, "    ///\n    /// Engine field `mj{}.{}`.", field.owner, field.name);
}

fn element(field: Field<'_>) -> &'static str {
    match field.ctype {
        "mjtNum" => "f64",
        "float" => "f32",
        "int" => "i32",
        "mjtByte" => "u8",
        other => panic!("no Rust type for {other}"),
    }
}

fn reader(text: &mut String, field: Field<'_>) {
    documentation(text, field);
    let name = field.name;
    if field.kind != "array" {
        let (rust, value) = match field.ctype {
            "mjtNum" => ("f64", format!("self.raw().{name}")),
            _ => ("usize", format!("ffi::size(self.raw().{name})")),
        };
        let _ = writeln!(text, "    #[inline]\n    pub fn {name}(&self) -> {rust} {{\n        {value}\n    }}\n");
        return;
    }
    let rust = element(field);
    let rows = size(field, field.rows);
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

fn restorer(text: &mut String, field: Field<'_>) {
    let name = field.name;
    let mut length = size(field, field.rows);
    if field.columns != "1" {
        let columns = match form(field) {
            Form::Rows(columns) => columns.to_string(),
            _ => size(field, field.columns),
        };
        let _ = write!(length, " * {columns}");
    }
    let _ = writeln!(text, "            {name}: {length};");
}

fn writer(text: &mut String, field: Field<'_>) {
    let name = field.name;
    let rust = element(field);
    let rows = size(field, field.rows);
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
    let noted = NOTED.iter().find(|(noted, _)| field.owner == "Model" && *noted == name);
    let forget = noted.map(|(_, forget)| format!("        self.{forget}();\n")).unwrap_or_default();
    let _ = writeln!(
        text,
        "    /// [`{name}`](crate::{}::{name}), to be written to.\n    #[inline]\n    pub fn {name}_mut(&mut self) -> {result} {{\n{forget}        let rows = {rows};{columns}\n        let array = self.raw_mut().{name};\n        // SAFETY: the engine allocated the array with this shape, and `self` is borrowed exclusively.\n        unsafe {{ {call} }}\n    }}\n",
        field.owner,
    );
}
