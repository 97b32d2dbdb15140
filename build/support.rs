//! Generates the checks of whether a computation of this crate understands a model, from the
//! statements in `build/knowledge` and the field table of the engine.
//!
//! A line of `derivative.tsv` states how parts of a computation treat some fields of the model: `-`
//! for fields without an effect, `any` if all values are understood, `default` if only the default
//! value is, or the name of a function in `src/derivative/support/predicates.rs` that examines the
//! values. The default is zero unless the line has another. `engines` is a range of versions such
//! as `3.1.2..3.11.0`, the end of which is not included; empty for all. A field that no line names
//! must have the default zero in every computation.

use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

/// Parts of the computations, in the order of their columns.
pub(crate) const PARTS: [&str; 5] = ["motion", "actuators", "integrator", "sensors", "implicit"];

/// Statement about a field for a range of engines.
#[derive(Clone, Debug)]
pub(crate) struct Statement<'t> {
    /// Field of `mjModel`, or `opt.…` and `stat.…` for those of its structs.
    pub(crate) field: &'t str,
    /// Treatment by each of the [`PARTS`].
    pub(crate) treatments: [&'t str; 5],
    /// -1 or 0.
    pub(crate) default: &'t str,
    engines: &'t str,
}

impl Statement<'_> {
    /// Returns `true` if the statement is about the engine with this `mjVERSION_HEADER`.
    pub(crate) fn is_about(&self, version: u32) -> bool {
        let Some((first, end)) = self.engines.split_once("..") else {
            assert!(self.engines.is_empty(), "not a range of versions: {}", self.engines);
            return true;
        };
        let version = parts(version);
        let is_after = |text: &str| version >= parse(text);
        (first.is_empty() || is_after(first)) && (end.is_empty() || !is_after(end))
    }
}

/// Returns the parts of the version with this `mjVERSION_HEADER`.
fn parts(version: u32) -> [u32; 3] {
    let base = if version < 1_000_000 { 10 } else { 1000 };
    [version / (base * base), version / base % base, version % base]
}

fn parse(version: &str) -> [u32; 3] {
    let parts: Vec<u32> =
        version.split('.').map(|part| part.parse().expect("a part of a version is a number")).collect();
    parts.try_into().expect("a version has three parts")
}

/// Returns the statements of the table.
pub(crate) fn statements(knowledge: &str) -> Vec<Statement<'_>> {
    let mut statements = Vec::new();
    for line in knowledge.lines().skip(1) {
        let cells: Vec<&str> = line.split('\t').collect();
        let [fields, engines, motion, actuators, integrator, sensors, implicit, default, _] = cells[..] else {
            panic!("not a line of the table: {line}");
        };
        let treatments = [motion, actuators, integrator, sensors, implicit];
        assert!(treatments.iter().all(|cell| !cell.is_empty()), "a treatment is missing: {line}");
        statements.extend(fields.split(' ').map(|field| Statement { field, treatments, default, engines }));
    }
    statements
}

/// Field of the linked engine's model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelField<'t> {
    owner: &'t str,
    is_array: bool,
    name: &'t str,
    rows: &'t str,
    columns: &'t str,
}

impl ModelField<'_> {
    /// Returns the name that statements have for the field.
    pub(crate) fn path(&self) -> String {
        match self.owner {
            "Option" => format!("opt.{}", self.name),
            "Statistic" => format!("stat.{}", self.name),
            _ => self.name.to_owned(),
        }
    }

    /// Writes the check that all values are the default.
    fn write_check(&self, text: &mut String, default: &str) {
        let path = self.path();
        if self.is_array {
            let kind = if default == "-1" { "ids" } else { "array" };
            let _ = writeln!(text, "    {kind} {path}: {}, {};", size(self.rows), size(self.columns));
        } else {
            assert!(default.is_empty(), "{path} is no array, so its default is zero");
            let _ = writeln!(text, "    value {path};");
        }
    }
}

/// Returns the fields of the model in a field table, except for those of `mjVisual`, which only the
/// visualiser reads.
pub(crate) fn model_fields(table: &str) -> impl Iterator<Item = ModelField<'_>> {
    table.lines().skip(1).filter_map(|line| {
        let cells: Vec<&str> = line.split('\t').collect();
        let [owner, kind, _, name, rows, columns, _] = cells[..] else { panic!("not a line of the table: {line}") };
        let is_array = kind == "array";
        matches!(owner, "Model" | "Option" | "Statistic").then_some(ModelField { owner, is_array, name, rows, columns })
    })
}

/// Converts a size such as `nq` or `nmocap*3` to a Rust expression.
fn size(expression: &str) -> String {
    let factors = expression.split('*').map(|factor| match factor.trim() {
        constant if constant.starts_with("mjN") => format!("mujoco_sys::{constant} as usize"),
        number if number.parse::<usize>().is_ok() => number.to_owned(),
        name => format!("model.{name}()"),
    });
    factors.collect::<Vec<_>>().join(" * ")
}

/// Returns calls of the macro `part!` in `src/derivative/support/mod.rs`: one for each part, and
/// one for the fields that no statement is about. `version` is the `mjVERSION_HEADER` of the engine
/// with this field table.
pub(crate) fn generate(table: &str, knowledge: &str, version: u32) -> String {
    let all = statements(knowledge);
    let mut by_field = HashMap::new();
    for statement in all.iter().filter(|statement| statement.is_about(version)) {
        let other = by_field.insert(statement.field, statement);
        assert!(other.is_none(), "two statements are about {}", statement.field);
    }
    let fields: Vec<(ModelField<'_>, Option<&Statement<'_>>)> =
        model_fields(table).map(|field| (field, by_field.get(field.path().as_str()).copied())).collect();
    let mut text = String::new();
    text.push_str("part! { unknown(model)\n");
    for (field, _) in fields.iter().filter(|(_, statement)| statement.is_none()) {
        field.write_check(&mut text, "");
    }
    text.push_str("}\n");
    for (index, part) in PARTS.iter().enumerate() {
        let _ = writeln!(text, "part! {{ {part}(model)");
        let mut predicates = HashSet::new();
        // In the order of the statements, so that the first failing one is the same for all
        // engines.
        let mut known: Vec<_> = fields.iter().filter_map(|(field, statement)| Some((field, (*statement)?))).collect();
        known.sort_by_key(|(_, statement)| all.iter().position(|other| other.field == statement.field));
        for (field, statement) in known {
            match statement.treatments[index] {
                "-" | "any" => {}
                "default" => field.write_check(&mut text, statement.default),
                predicate => {
                    if predicates.insert(predicate) {
                        let _ = writeln!(text, "    predicate {predicate};");
                    }
                }
            }
        }
        text.push_str("}\n");
    }
    text
}
