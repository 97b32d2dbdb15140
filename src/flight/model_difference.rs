//! Differences of the compiled model of a trace from the model of this engine.

use super::divergence::Divergence;
use super::trace::TracedModel;
use crate::error::Result;
use crate::model::save::{Arrays, decode, settings, sizes};
use crate::model::{Model, ModelMut};

/// Sizes that enter a simulation.
const SIZES: [&str; 17] = [
    "nq",
    "nv",
    "nu",
    "na",
    "nbody",
    "njnt",
    "ngeom",
    "nsite",
    "ncam",
    "ntendon",
    "nwrap",
    "nsensor",
    "nsensordata",
    "neq",
    "nmocap",
    "npair",
    "nexclude",
];

/// Beginnings and ends of names of arrays that do not enter a simulation: names, pictures, user
/// data, addresses, bounding volumes, and flags that let the engine leave out computations. The
/// inertia of a mesh is that of its geoms.
const OTHERS: [&str; 9] = ["tex_", "mat_", "light_", "skin_", "name", "paths", "mesh_", "bvh_", "oct_"];
const OTHER_ENDS: [&str; 10] =
    ["_rgba", "_user", "_group", "_matid", "adr", "_sameframe", "_simple", "_simplenum", "_aabb", "_rbound"];
/// Codes that versions of the engine number differently.
const CODES: [&str; 4] = ["sensor_type", "exclude_signature", "opt.disableflags", "opt.enableflags"];

/// Largest relative difference of two constants that counts as rounding: the compiler solves linear
/// systems and decomposes inertias.
const ROUNDING: f64 = 1e-10;
/// Largest absolute difference of two constants near zero that counts as rounding.
const NEAR_ZERO: f64 = 1e-15;

#[derive(Default)]
pub(super) struct ModelDifferences {
    pub(super) divergences: Vec<Divergence>,
    pub(super) other_fields: Vec<String>,
    /// Largest relative difference that counts as rounding.
    pub(super) rounding: f64,
}

/// Compares all sizes, options and arrays that both engines have. Engines of the same version have
/// the same codes.
pub(super) fn compare(there: &TracedModel, here: &Model, call: u64, is_same_version: bool) -> Result<ModelDifferences> {
    let mut differences = ModelDifferences::default();
    let mut add = |field: &str, is_other: bool, worst: Worst, element: String| {
        if is_other {
            return differences.other_fields.push(field.to_owned());
        }
        let Worst { there, here, .. } = worst;
        let (field, stage) = (field.to_owned(), "model");
        differences.divergences.push(Divergence { call, time: 0.0, stage, field, element, there, here, rounding: 0.0 });
    };
    let is_code = |name| !is_same_version && CODES.contains(&name);
    let own = sizes(here).map(|(name, size)| (name, vec![size as f64]));
    for (name, own) in own.chain(settings(here)) {
        let Some(traced) = there.settings.iter().find(|traced| traced.name == name) else { continue };
        let enters = name.starts_with("opt.") || name == "stat.meaninertia" || SIZES.contains(&name);
        let is_other = !enters || is_code(name);
        if let Some(worst) = worst(&traced.values, &own, own.len().max(1), &mut 0.0) {
            let element = if own.len() > 1 { format!("the model[{}]", worst.index) } else { "the model".to_owned() };
            add(name, is_other, worst, element);
        }
    }
    let arrays = Arrays::of(here)?;
    let mut rounding = 0.0;
    for field in Model::fields().filter(|field| field.is_array) {
        let Some((_, ctype, traced)) = there.arrays.iter().find(|(name, ..)| *name == field.name) else { continue };
        let own = arrays.bytes(field.name);
        if own == traced {
            continue;
        }
        let (mut traced, mut own) = (decode(ctype, traced), decode(field.ctype, own));
        let mut columns = arrays.columns(&field).max(1);
        // Another version can have further columns.
        let rows = own.len() / columns;
        if traced.len() != own.len() && rows > 0 && !traced.is_empty() && traced.len().is_multiple_of(rows) {
            let common = columns.min(traced.len() / rows);
            let cut =
                |values: &[f64]| values.chunks(values.len() / rows).flat_map(|row| &row[..common]).copied().collect();
            (traced, own, columns) = (cut(&traced), cut(&own), common.max(1));
        }
        let is_other = OTHERS.iter().any(|beginning| field.name.starts_with(beginning))
            || OTHER_ENDS.iter().any(|end| field.name.ends_with(end))
            || is_code(field.name);
        let mut unused = 0.0;
        let rounding = if is_other { &mut unused } else { &mut rounding };
        if let Some(worst) = worst(&traced, &own, columns, rounding) {
            let element = match worst.index {
                usize::MAX => "the number of values".to_owned(),
                index if columns == 1 => arrays.described(&field, index),
                index => format!("{}[{}]", arrays.described(&field, index / columns), index % columns),
            };
            add(field.name, is_other, worst, element);
        }
    }
    differences.rounding = rounding;
    Ok(differences)
}

/// Value that differs most.
struct Worst {
    /// Index of the value, or `usize::MAX` for a difference of the numbers of values.
    index: usize,
    there: f64,
    here: f64,
}

/// Returns the value with the largest difference relative to its row. Updates the largest relative
/// difference that counts as rounding.
fn worst(there: &[f64], here: &[f64], columns: usize, rounding: &mut f64) -> Option<Worst> {
    if there.len() != here.len() {
        return Some(Worst { index: usize::MAX, there: there.len() as f64, here: here.len() as f64 });
    }
    let (mut worst, mut most) = (None, 0.0);
    for (row, (a, b)) in there.chunks(columns).zip(here.chunks(columns)).enumerate() {
        let scale = a.iter().chain(b).fold(0.0, |scale: f64, value| scale.max(value.abs()));
        for (column, (&there, &here)) in a.iter().zip(b).enumerate() {
            let difference = (there - here).abs();
            if there == here || (there.is_nan() && here.is_nan()) || difference <= NEAR_ZERO {
                continue;
            }
            let relative = if difference.is_finite() { difference / scale } else { f64::INFINITY };
            if relative <= ROUNDING {
                *rounding = rounding.max(relative);
            } else if relative > most {
                most = relative;
                worst = Some(Worst { index: row * columns + column, there, here });
            }
        }
    }
    worst
}

/// Makes the edits of a model that distinguish it from an earlier one, as far as programs can set
/// the values.
pub(super) fn follow(model: &mut ModelMut<'_>, first: &TracedModel, edited: &TracedModel) {
    for ((name, ctype, before), (other, _, after)) in first.arrays.iter().zip(&edited.arrays) {
        let Some(array) = model.number_array(name).filter(|_| name == other && before != after) else { continue };
        let (before, after) = (decode(ctype, before), decode(ctype, after));
        if before.len() != array.rows * array.columns || after.len() != before.len() {
            continue;
        }
        let changed = before.iter().zip(&after).enumerate().filter(|(_, (before, after))| before != after);
        for (index, (_, &value)) in changed {
            let (row, column) = (index / array.columns, index % array.columns);
            if model.find_number(array.name, row, column).is_ok() {
                model.set_number(array.name, row, column, value);
            }
        }
    }
}
