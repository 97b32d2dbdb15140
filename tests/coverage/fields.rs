//! Every field of the engine's structs, and its readers and writers in the library.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use mujoco_safe::model::{FieldDoc, Statistics, Visual};
use mujoco_safe::{Data, Model, Options};

use crate::{is_committed, root, sources};

/// Fields whose accessor has another name or form, and the accessor.
const BY_HAND: [(&str, &str, &str); 10] = [
    ("Model", "names", "Model::name"),
    ("Model", "text_data", "Model::text_data"),
    ("Data", "contact", "Data::contacts"),
    ("Data", "time", "Data::time"),
    ("Data", "energy", "Data::energy"),
    ("Data", "warning", "Data::warning"),
    ("Data", "timer", "Data::timer"),
    ("Data", "solver", "Data::solver"),
    ("Data", "solver_fwdinv", "Data::solver_fwdinv"),
    ("Data", "solver_nnz", "Data::solver_nnz"),
];

/// Fields that are not written by a `_mut` accessor, and their writers.
const WRITTEN: [(&str, &str, &str); 1] = [("Data", "time", "Data::set_time")];

/// Returns the names of the generated accessors.
fn accessors(file: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("src/generated").join(file)).unwrap();
    let starts = text.lines().filter_map(|line| line.trim().strip_prefix("pub fn "));
    starts.filter_map(|rest| rest.split('(').next()).map(str::to_owned).collect()
}

/// Returns the checked setters of single elements by the array that they write: `jnt_limited` →
/// `JointMut::set_limited`.
fn setters() -> BTreeMap<String, String> {
    // Arrays whose place differs between versions have setters without a declaration.
    let elsewhere = [("light_directional", "LightMut::set_directional"), ("eq_active", "EqualityMut::set_active")];
    let mut setters: BTreeMap<String, String> =
        elsewhere.map(|(array, setter)| (array.to_owned(), setter.to_owned())).into();
    for (_, text) in sources("src/element") {
        for block in text.split("\nfields!(").skip(1) {
            let kind = block.split(" on ").next().unwrap();
            let body = block.split("\n});").next().unwrap();
            for line in body.lines().map(str::trim) {
                let Some((_, rest)) = line.split_once(" = ") else { continue };
                let Some((array, setter)) = rest.trim_end_matches(';').split_once(", ") else { continue };
                let setter = setter.split(' ').next().unwrap_or_default();
                if setter.starts_with("set_") && !rest.contains(" in ") {
                    let array = array.split(' ').next().unwrap_or_default();
                    setters.insert(array.to_owned(), format!("{kind}Mut::{setter}"));
                }
            }
        }
    }
    setters
}

struct Struct {
    name: &'static str,
    fields: Vec<FieldDoc>,
    readers: Vec<String>,
    writers: Vec<String>,
}

/// Returns the reader and the writer of a field.
fn access(of: &Struct, field: &FieldDoc, setters: &BTreeMap<String, String>) -> (Option<String>, Option<String>) {
    let hand = |table: &[(&str, &str, &str)]| {
        table
            .iter()
            .find(|(owner, name, _)| (*owner, *name) == (of.name, field.name))
            .map(|(_, _, path)| link(path, path))
    };
    let read = hand(&BY_HAND).or_else(|| {
        let known = of.readers.iter().any(|reader| reader == field.name);
        known.then(|| link(&format!("{}::{}", of.name, field.name), &format!("{}::{}", of.name, field.name)))
    });
    let writer = format!("{}_mut", field.name);
    let owner = if of.name == "Model" { "ModelMut" } else { of.name };
    let write = hand(&WRITTEN)
        .or_else(|| {
            of.writers.contains(&writer).then(|| link(&format!("{owner}::{writer}"), &format!("{owner}::{writer}")))
        })
        .or_else(|| {
            let setter = setters.get(field.name)?;
            let view = setter.split("::").next()?;
            Some(format!("[`{setter}`](crate::element::{view})"))
        });
    (read, write)
}

fn link(text: &str, path: &str) -> String {
    format!("[`{text}`](crate::{path})")
}

fn structs() -> [Struct; 2] {
    let data = accessors("data.rs");
    let (writers, readers) = data.into_iter().partition(|name| name.ends_with("_mut"));
    [
        Struct {
            name: "Model",
            fields: Model::fields().collect(),
            readers: accessors("model.rs"),
            writers: accessors("model_mut.rs"),
        },
        Struct { name: "Data", fields: Data::fields().collect(), readers, writers },
    ]
}

#[test]
fn every_field_can_be_read() {
    let setters = setters();
    for of in structs() {
        for field in &of.fields {
            assert!(access(&of, field, &setters).0.is_some(), "{}.{}", of.name, field.name);
        }
    }
}

#[test]
fn every_setter_sets_a_field_of_the_engine() {
    let names: Vec<&str> = Model::fields().map(|field| field.name).collect();
    let setters = setters();
    assert!(setters.len() > 15, "{setters:?}");
    for array in setters.keys() {
        assert!(names.contains(&array.as_str()), "{array}");
    }
}

#[test]
fn the_page_of_fields_is_up_to_date() {
    let setters = setters();
    let mut page = "Every field of the engine's structs, with its reader and its writer in this library. Sizes, addresses and ids are\n\
         read-only, because the engine trusts them. So are the reals that decide where the engine reads, and the integers that\n\
         a simulation computes.\n"
        .to_owned();
    for of in structs() {
        let written = of.fields.iter().filter(|field| access(&of, field, &setters).1.is_some()).count();
        let _ = write!(
            page,
            "\n# mj{}: {} fields, {written} of them writable\n\n| field | shape | read by | written by |\n|---|---|---|---|\n",
            of.name,
            of.fields.len()
        );
        for field in &of.fields {
            let (read, write) = access(&of, field, &setters);
            let _ = writeln!(
                page,
                "| `{}` | {} | {} | {} |",
                field.name,
                field.shape(),
                read.unwrap_or_default(),
                write.unwrap_or_else(|| "—".to_owned())
            );
        }
    }
    let smaller = [
        ("Option", "Options", "ModelMut::edit_options", Options::fields().collect::<Vec<_>>()),
        ("Visual", "model::Visual", "ModelMut::edit_visual", Visual::fields().collect()),
        ("Statistic", "model::Statistics", "ModelMut::edit_statistics", Statistics::fields().collect()),
    ];
    for (engine, here, writer, fields) in smaller {
        let names: Vec<String> = fields.iter().map(|field| format!("`{}`", field.name)).collect();
        let _ = write!(
            page,
            "\n# mj{engine}: {} fields\n\nAll of them are fields of {}, written by {}: {}.\n",
            fields.len(),
            link(here, here),
            link(writer, writer),
            names.join(", ")
        );
    }
    is_committed("fields.md", &page);
}
