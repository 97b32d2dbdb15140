//! A field that XML does not carry.

use std::fmt;

use crate::field_docs::Field;
use crate::id::Kind;
use crate::model::Model;

/// A field of a model that the model's XML does not carry.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct LostEdit {
    /// The field in the engine's spelling, for example `body_mass`, `opt.timestep` or `nconmax`.
    pub field: String,
    /// The elements whose values differ: names, or the index of an element without a name. Empty for a size and for the fields
    /// of options, statistics and the visualiser.
    pub elements: Vec<String>,
}

impl LostEdit {
    /// A field that has one value for the whole model.
    pub(super) fn of_setting(field: String) -> Self {
        Self { field, elements: Vec::new() }
    }

    /// Rows of an array.
    pub(super) fn of_rows(model: &Model, field: &Field, rows: &[usize]) -> Self {
        let mut elements: Vec<String> = rows.iter().map(|&row| element(model, field.rows, row)).collect();
        elements.dedup();
        Self { field: field.name.to_owned(), elements }
    }
}

impl fmt::Display for LostEdit {
    /// Writes the field, and in parentheses the first elements.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 4;
        f.write_str(&self.field)?;
        if self.elements.is_empty() {
            return Ok(());
        }
        let shown: Vec<&str> = self.elements.iter().take(SHOWN).map(String::as_str).collect();
        write!(f, " ({}", shown.join(", "))?;
        match self.elements.len().saturating_sub(SHOWN) {
            0 => f.write_str(")"),
            more => write!(f, " and {more} more)"),
        }
    }
}

/// The name or index of the element that a row of an array belongs to. `rows` is the size that counts the rows.
fn element(model: &Model, rows: &str, row: usize) -> String {
    let (kind, index) = match rows {
        "nbody" => (Kind::Body, row),
        "njnt" => (Kind::Joint, row),
        "nq" => (Kind::Joint, owner(model.jnt_qposadr(), row)),
        "nv" => (Kind::Joint, owner(model.jnt_dofadr(), row)),
        "ngeom" => (Kind::Geom, row),
        "nsite" => (Kind::Site, row),
        "ncam" => (Kind::Camera, row),
        "nlight" => (Kind::Light, row),
        "nmesh" => (Kind::Mesh, row),
        "nmeshvert" => (Kind::Mesh, owner(model.mesh_vertadr(), row)),
        "nmeshtexvert" => (Kind::Mesh, owner(model.mesh_texcoordadr(), row)),
        "nmeshface" => (Kind::Mesh, owner(model.mesh_faceadr(), row)),
        "nmeshgraph" => (Kind::Mesh, owner(model.mesh_graphadr(), row)),
        "nskin" => (Kind::Skin, row),
        "nskinvert" => (Kind::Skin, owner(model.skin_vertadr(), row)),
        "nskintexvert" => (Kind::Skin, owner(model.skin_texcoordadr(), row)),
        "nskinface" => (Kind::Skin, owner(model.skin_faceadr(), row)),
        "nskinbone" => (Kind::Skin, owner(model.skin_boneadr(), row)),
        "nskinbonevert" => (Kind::Skin, owner(model.skin_boneadr(), owner(model.skin_bonevertadr(), row))),
        "nhfield" => (Kind::HeightField, row),
        "nhfielddata" => (Kind::HeightField, owner(model.hfield_adr(), row)),
        "ntex" => (Kind::Texture, row),
        "ntexdata" => (Kind::Texture, owner(model.tex_adr(), row)),
        "nmat" => (Kind::Material, row),
        "npair" => (Kind::Pair, row),
        "nexclude" => (Kind::Exclude, row),
        "neq" => (Kind::Equality, row),
        "ntendon" => (Kind::Tendon, row),
        "nwrap" => (Kind::Tendon, owner(model.tendon_adr(), row)),
        "nu" => (Kind::Actuator, row),
        "nsensor" => (Kind::Sensor, row),
        "nnumeric" => (Kind::Numeric, row),
        "nnumericdata" => (Kind::Numeric, owner(model.numeric_adr(), row)),
        "ntext" => (Kind::Text, row),
        "ntextdata" => (Kind::Text, owner(model.text_adr(), row)),
        "ntuple" => (Kind::Tuple, row),
        "ntupledata" => (Kind::Tuple, owner(model.tuple_adr(), row)),
        "nkey" => (Kind::Keyframe, row),
        _ => return row.to_string(),
    };
    model.name_at(kind, index).map_or_else(|| index.to_string(), str::to_owned)
}

/// The element whose data contain a row: the last one that starts at or before it. The start of an element without data is -1.
fn owner(starts: &[i32], row: usize) -> usize {
    starts.iter().rposition(|&start| usize::try_from(start).is_ok_and(|start| start <= row)).unwrap_or(0)
}
