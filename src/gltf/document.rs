//! A glTF document and its binary buffer, in which equal data are stored once.

use std::collections::{BTreeSet, HashMap};
use std::io;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Extras, Index, Material, Mesh, Node, Root, Texture, Value};

use crate::model::Model;

/// Document under construction.
pub(super) struct Document<'m> {
    pub(super) model: &'m Model,
    pub(super) root: Root,
    /// Nodes of the frames.
    pub(super) nodes: Vec<Index<Node>>,
    /// Descriptions of what the file does not contain.
    pub(super) left_out: BTreeSet<String>,
    /// Meshes by the text of their shape, material and mapping.
    pub(super) meshes: HashMap<String, Index<Mesh>>,
    /// Materials by their text.
    pub(super) materials: HashMap<String, Index<Material>>,
    /// Textures by their index in the model.
    pub(super) textures: HashMap<usize, Index<Texture>>,
    bytes: Vec<u8>,
    /// Accessors by their contents.
    known: HashMap<(Kind, Vec<u8>), Index<Accessor>>,
}

/// Kind of the data of an accessor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Position,
    Normal,
    Texcoord,
    /// Four bones of a vertex.
    Bones,
    /// Their weights.
    Weights,
    /// Matrices from meshes at rest to the frames of bones.
    InverseBind,
    /// Times of an animation, s.
    Times,
    Translations,
    /// Quaternions in single precision.
    Rotations,
    /// Quaternions as integers of 16 bits, of which 32,767 is 1.
    ShortRotations,
    ShortIndices,
    LongIndices,
}

impl Kind {
    fn target(self) -> Option<Target> {
        match self {
            Self::Position | Self::Normal | Self::Texcoord | Self::Bones | Self::Weights => Some(Target::ArrayBuffer),
            Self::ShortIndices | Self::LongIndices => Some(Target::ElementArrayBuffer),
            _ => None,
        }
    }

    fn component(self) -> ComponentType {
        match self {
            Self::ShortIndices | Self::Bones => ComponentType::U16,
            Self::LongIndices => ComponentType::U32,
            Self::ShortRotations => ComponentType::I16,
            _ => ComponentType::F32,
        }
    }
}

impl<'m> Document<'m> {
    pub(super) fn new(model: &'m Model, left_out: BTreeSet<String>) -> Self {
        let mut root = Root::default();
        root.asset.generator = Some(concat!("mujoco-safe ", env!("CARGO_PKG_VERSION")).to_owned());
        Self {
            model,
            root,
            nodes: Vec::new(),
            left_out,
            meshes: HashMap::new(),
            materials: HashMap::new(),
            textures: HashMap::new(),
            bytes: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// Stores vectors of `N` numbers.
    pub(super) fn floats<const N: usize>(&mut self, kind: Kind, values: &[[f32; N]]) -> Index<Accessor> {
        let bytes = values.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
        let bound = |start: f32, nearer: fn(f32, f32) -> f32| {
            let axis = |axis: usize| values.iter().map(|value| value[axis]).fold(start, nearer);
            (0..N).map(|index| Value::from(f64::from(axis(index)))).collect()
        };
        // glTF asks for the bounds of these, exactly.
        let bounds = matches!(kind, Kind::Position | Kind::Times)
            .then(|| [bound(f32::INFINITY, f32::min), bound(f32::NEG_INFINITY, f32::max)]);
        let of_size = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4].get(N - 1).copied().unwrap_or(Type::Mat4);
        self.accessor(kind, of_size, values.len(), bytes, bounds)
    }

    /// Stores the indices of the vertices of triangles.
    pub(super) fn indices(&mut self, indices: &[u32], vertices: usize) -> Index<Accessor> {
        // The largest number of each type is no index.
        let (kind, bytes) = if u16::try_from(vertices).is_ok() {
            (Kind::ShortIndices, indices.iter().flat_map(|&index| (index as u16).to_le_bytes()).collect())
        } else {
            (Kind::LongIndices, indices.iter().flat_map(|index| index.to_le_bytes()).collect())
        };
        self.accessor(kind, Type::Scalar, indices.len(), bytes, None)
    }

    /// Stores unit quaternions with an error of half a 32,767th of each component.
    pub(super) fn short_rotations(&mut self, values: &[[f32; 4]]) -> Index<Accessor> {
        let short = |part: &f32| ((part * 32767.0).round() as i16).to_le_bytes();
        let bytes = values.as_flattened().iter().flat_map(short).collect();
        self.accessor(Kind::ShortRotations, Type::Vec4, values.len(), bytes, None)
    }

    /// Stores the bones of vertices.
    pub(super) fn bones(&mut self, values: &[[u16; 4]]) -> Index<Accessor> {
        let bytes = values.as_flattened().iter().flat_map(|bone| bone.to_le_bytes()).collect();
        self.accessor(Kind::Bones, Type::Vec4, values.len(), bytes, None)
    }

    fn accessor(
        &mut self,
        kind: Kind,
        type_: Type,
        count: usize,
        bytes: Vec<u8>,
        bounds: Option<[Value; 2]>,
    ) -> Index<Accessor> {
        let key = (kind, bytes);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let [min, max] = bounds.map_or([None, None], |bounds| bounds.map(Some));
        let view = self.view(&key.1, kind.target());
        let index = self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: count.into(),
            component_type: Valid(GenericComponentType(kind.component())),
            extensions: None,
            extras: Extras::default(),
            type_: Valid(type_),
            min,
            max,
            name: None,
            normalized: kind == Kind::ShortRotations,
            sparse: None,
        });
        self.known.insert(key, index);
        index
    }

    /// Stores bytes. Each view starts at a multiple of four bytes.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<Target>) -> Index<View> {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root.push(View {
            buffer: Index::new(0),
            byte_length: bytes.len().into(),
            byte_offset: Some(start.into()),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Extras::default(),
        })
    }

    /// Returns the file: a header, the description as JSON, and the binary buffer.
    ///
    /// # Errors
    ///
    /// A file of 4 GiB or more.
    pub(super) fn file(mut self) -> io::Result<Vec<u8>> {
        if !self.bytes.is_empty() {
            self.root.push(Buffer {
                byte_length: self.bytes.len().into(),
                name: None,
                uri: None,
                extensions: None,
                extras: Extras::default(),
            });
        }
        let mut json = self.root.to_vec()?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let word = |length: usize| u32::try_from(length).map(u32::to_le_bytes).map_err(io::Error::other);
        let mut chunks = Vec::with_capacity(16 + json.len() + self.bytes.len());
        for (name, bytes) in [(b"JSON", &json), (b"BIN\0", &self.bytes)] {
            if !bytes.is_empty() {
                chunks.extend(word(bytes.len())?);
                chunks.extend(name);
                chunks.extend(bytes);
            }
        }
        let header = [*b"glTF", 2_u32.to_le_bytes(), word(12 + chunks.len())?];
        Ok([header.as_flattened(), &chunks].concat())
    }
}
