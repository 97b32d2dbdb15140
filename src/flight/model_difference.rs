//! Differences of the compiled model of a trace from the model of this engine.

use super::divergence::{Divergence, Pair};
use super::quantities::{Series, find};
use crate::error::Result;
use crate::field_docs::FieldDoc;
use crate::model::save::{Arrays, decode, settings, sizes};
use crate::model::{Model, ModelMut};

/// Sizes that enter a simulation.
const SIZES: &str =
    "nq nv nu na nbody njnt ngeom nsite ncam ntendon nwrap nsensor nsensordata neq nmocap npair nexclude";

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

/// Differences of two models.
#[derive(Default)]
pub(super) struct ModelDifferences {
    pub(super) divergences: Vec<Divergence>,
    pub(super) other_fields: Vec<String>,
    /// Largest relative difference that counts as rounding.
    pub(super) rounding: f64,
}

/// Returns all sizes, options and arrays of a model.
pub(super) fn fields(model: &Model) -> Result<Vec<Series>> {
    let sizes = sizes(model).map(|(name, size)| (name, vec![size as f64]));
    let settings = sizes.chain(settings(model)).map(|(name, values)| (name, values.len(), values));
    let arrays = Arrays::of(model)?;
    let array = |field: FieldDoc| (field.name, arrays.columns(&field), decode(field.ctype, arrays.bytes(field.name)));
    let all = settings.chain(Model::fields().filter(|field| field.is_array).map(array));
    Ok(all.map(|(name, columns, values)| Series { name: name.to_owned(), columns: columns.max(1), values }).collect())
}

/// Compares all sizes, options and arrays that both engines have. Engines of the same version have
/// the same codes.
pub(super) fn compare(there: &[Series], here: &Model, call: u64, is_same_version: bool) -> Result<ModelDifferences> {
    let mut differences = ModelDifferences::default();
    let arrays = Arrays::of(here)?;
    for own in fields(here)? {
        let name = &*own.name;
        let Some(traced) = find(there, name) else { continue };
        let array = Model::fields().find(|field| field.is_array && field.name == name);
        let enters = match array {
            Some(_) => {
                !OTHERS.iter().any(|begin| name.starts_with(begin)) && !OTHER_ENDS.iter().any(|end| name.ends_with(end))
            }
            None => name.starts_with("opt.") || name == "stat.meaninertia" || SIZES.split(' ').any(|size| size == name),
        };
        let enters = enters && (is_same_version || !CODES.contains(&name));
        // Another version can have further columns.
        let has_same_rows = own.values.len() / own.columns == traced.values.len() / traced.columns;
        let common = if has_same_rows { own.columns.min(traced.columns) } else { usize::MAX };
        let (traced, own) = (traced.cut(common), own.cut(common));
        let Some(pair) = Pair::worst(&traced, &own, &[], NEAR_ZERO) else { continue };
        let relative = pair.ratio * f64::EPSILON;
        match enters {
            true if relative > ROUNDING => {
                let owner = |row| array.map_or_else(|| "the model".to_owned(), |field| arrays.described(&field, row));
                let element = pair.element(own.columns, owner);
                differences.divergences.push(pair.report(call, 0.0, "model", name, element));
            }
            true => differences.rounding = differences.rounding.max(relative),
            false if relative > ROUNDING => differences.other_fields.push(own.name),
            false => {}
        }
    }
    Ok(differences)
}

/// Makes the edits of a model that distinguish it from an earlier one, as far as programs can set
/// the values.
pub(super) fn follow(model: &mut ModelMut<'_>, first: &[Series], edited: &[Series]) {
    for (before, after) in first.iter().zip(edited) {
        let Some(array) = model.number_array(&before.name).filter(|_| before.name == after.name) else { continue };
        let length = array.rows * array.columns;
        if before.values.len() != length || after.values.len() != length {
            continue;
        }
        for (index, (before, &after)) in before.values.iter().zip(&after.values).enumerate() {
            let (row, column) = (index / array.columns, index % array.columns);
            if *before != after && model.find_number(array.name, row, column).is_ok() {
                model.set_number(array.name, row, column, after);
            }
        }
    }
}
