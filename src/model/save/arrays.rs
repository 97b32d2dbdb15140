//! Arrays of a model by name, read from the model's binary form in the order of the engine's table
//! of fields.

use std::collections::HashMap;
use std::ops::Range;

use crate::error::{Error, Result};
use crate::field_docs::FieldDoc;
use crate::generated::model_sizes;
use crate::kind::Kind;
use crate::model::Model;

/// Array of the first control of each actuator. Older engines have one control per actuator.
const CONTROLS: &[&str] = if cfg!(engine_since = "3.17.0") { &["actuator_ctrladr"] } else { &[] };

/// Owners of the rows of arrays: the size that counts the rows, and the kind of element. If an
/// element has several rows, the last entry names the arrays with the first row of each element,
/// from the rows to the elements.
const OWNERS: [(&str, Kind, &[&str]); 42] = [
    ("nbody", Kind::Body, &[]),
    ("njnt", Kind::Joint, &[]),
    ("nq", Kind::Joint, &["jnt_qposadr"]),
    ("nv", Kind::Joint, &["jnt_dofadr"]),
    ("ngeom", Kind::Geom, &[]),
    ("nsite", Kind::Site, &[]),
    ("ncam", Kind::Camera, &[]),
    ("nlight", Kind::Light, &[]),
    ("nmesh", Kind::Mesh, &[]),
    ("nmeshvert", Kind::Mesh, &["mesh_vertadr"]),
    ("nmeshnormal", Kind::Mesh, &["mesh_normaladr"]),
    ("nmeshtexvert", Kind::Mesh, &["mesh_texcoordadr"]),
    ("nmeshtexcoord", Kind::Mesh, &["mesh_texcoordadr"]),
    ("nmeshface", Kind::Mesh, &["mesh_faceadr"]),
    ("nmeshgraph", Kind::Mesh, &["mesh_graphadr"]),
    ("nskin", Kind::Skin, &[]),
    ("nskinvert", Kind::Skin, &["skin_vertadr"]),
    ("nskintexvert", Kind::Skin, &["skin_texcoordadr"]),
    ("nskinface", Kind::Skin, &["skin_faceadr"]),
    ("nskinbone", Kind::Skin, &["skin_boneadr"]),
    ("nskinbonevert", Kind::Skin, &["skin_bonevertadr", "skin_boneadr"]),
    ("nhfield", Kind::HeightField, &[]),
    ("nhfielddata", Kind::HeightField, &["hfield_adr"]),
    ("ntex", Kind::Texture, &[]),
    ("ntexdata", Kind::Texture, &["tex_adr"]),
    ("nmat", Kind::Material, &[]),
    ("npair", Kind::Pair, &[]),
    ("nexclude", Kind::Exclude, &[]),
    ("neq", Kind::Equality, &[]),
    ("ntendon", Kind::Tendon, &[]),
    ("nwrap", Kind::Tendon, &["tendon_adr"]),
    ("nu", Kind::Actuator, CONTROLS),
    ("nactuator", Kind::Actuator, &[]),
    ("nout", Kind::Actuator, &["actuator_outadr"]),
    ("nsensor", Kind::Sensor, &[]),
    ("nnumeric", Kind::Numeric, &[]),
    ("nnumericdata", Kind::Numeric, &["numeric_adr"]),
    ("ntext", Kind::Text, &[]),
    ("ntextdata", Kind::Text, &["text_adr"]),
    ("ntuple", Kind::Tuple, &[]),
    ("ntupledata", Kind::Tuple, &["tuple_adr"]),
    ("nkey", Kind::Keyframe, &[]),
];

/// Arrays of a model.
pub(crate) struct Arrays<'m> {
    model: &'m Model,
    /// The binary form from the first array.
    bytes: Vec<u8>,
    places: HashMap<&'static str, (FieldDoc, Range<usize>)>,
    sizes: HashMap<&'static str, usize>,
}

impl<'m> Arrays<'m> {
    /// Reads the arrays of a model.
    pub(crate) fn of(model: &'m Model) -> Result<Self> {
        let constant = ("mjNTEXROLE", mujoco_sys::mjNTEXROLE as usize);
        let sizes = sizes(model).map(|(name, size)| (name, size.try_into().unwrap_or(0))).chain([constant]).collect();
        let mut arrays = Self { model, bytes: model.to_binary()?, places: HashMap::new(), sizes };
        let mut end = 0;
        for field in Model::fields().filter(|field| field.is_array) {
            let start = end;
            end += arrays.extent(field.rows) * arrays.row_length(&field);
            arrays.places.insert(field.name, (field, start..end));
        }
        // The arrays are the end of the binary form.
        let start = arrays.bytes.len().checked_sub(end);
        let start =
            start.ok_or_else(|| Error::Unsupported("Bug: a binary model is shorter than its arrays".to_owned()))?;
        arrays.bytes.drain(..start);
        Ok(arrays)
    }

    /// Returns the product of sizes and numbers such as `nbody`, `nmocap*3` or `1`.
    fn extent(&self, text: &str) -> usize {
        text.split('*').map(|factor| factor.parse().unwrap_or_else(|_| self.sizes[factor])).product()
    }

    /// Returns the length of a row in bytes.
    pub(crate) fn row_length(&self, field: &FieldDoc) -> usize {
        self.columns(field) * element_size(field.ctype)
    }

    /// Returns the number of columns of an array.
    pub(crate) fn columns(&self, field: &FieldDoc) -> usize {
        self.extent(field.columns)
    }

    /// Returns the bytes of an array.
    pub(crate) fn bytes(&self, name: &str) -> &[u8] {
        &self.bytes[self.places[name].1.clone()]
    }

    /// Returns the name or index of the element to which a row of an array belongs.
    pub(crate) fn owner(&self, field: &FieldDoc, row: usize) -> String {
        let Some((kind, index)) = self.element(field, row) else { return row.to_string() };
        self.model.name_at(kind, index).map_or_else(|| index.to_string(), str::to_owned)
    }

    /// Returns the kind and the name or index of this element.
    pub(crate) fn described(&self, field: &FieldDoc, row: usize) -> String {
        self.element(field, row).map_or_else(|| format!("row {row}"), |(kind, index)| self.model.described(kind, index))
    }

    fn element(&self, field: &FieldDoc, row: usize) -> Option<(Kind, usize)> {
        let (_, kind, starts) = OWNERS.into_iter().find(|(rows, ..)| *rows == field.rows)?;
        Some((kind, starts.iter().fold(row, |row, starts| self.last_start(starts, row))))
    }

    /// Returns the element whose data contain a row: the last element that starts at or before it.
    /// The start of an element without data is -1.
    fn last_start(&self, starts: &str, row: usize) -> usize {
        let (field, _) = &self.places[starts];
        let starts = decode(field.ctype, self.bytes(starts));
        starts.iter().rposition(|&start| (0.0..=row as f64).contains(&start)).unwrap_or(0)
    }
}

/// Returns the names and values of the model's sizes.
#[allow(clippy::cast_lossless, reason = "sizes have several types, and some engines have only one of them")]
pub(crate) fn sizes(model: &Model) -> impl Iterator<Item = (&'static str, i128)> {
    macro_rules! list {
        ($($name:ident)*) => { [$((stringify!($name), model.raw().$name as i128)),*] };
    }
    model_sizes! { list }.into_iter()
}

/// Returns the size of one element in bytes.
pub(crate) fn element_size(ctype: &str) -> usize {
    match ctype {
        "mjtNum" | "mjtSize" => 8,
        "float" | "int" => 4,
        _ => 1,
    }
}

/// Decodes numbers.
pub(crate) fn decode(ctype: &str, bytes: &[u8]) -> Vec<f64> {
    let ((doubles, _), (words, _)) = (bytes.as_chunks::<8>(), bytes.as_chunks::<4>());
    match ctype {
        "mjtNum" => doubles.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect(),
        "mjtSize" => doubles.iter().map(|bytes| i64::from_ne_bytes(*bytes) as f64).collect(),
        "float" => words.iter().map(|bytes| f32::from_ne_bytes(*bytes).into()).collect(),
        "int" => words.iter().map(|bytes| i32::from_ne_bytes(*bytes).into()).collect(),
        _ => bytes.iter().map(|&byte| byte.into()).collect(),
    }
}
