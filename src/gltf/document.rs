//! A glTF document and its binary buffer, in which equal data are stored once.

use std::collections::{BTreeSet, HashMap};
use std::io;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Index, Material, Mesh, Node, Root, Texture};

use crate::model::Model;

/// Makes an object of glTF without extensions.
macro_rules! object {
    ($($type:ident)::+ { $($fields:tt)* }) => {
        $($type)::+ { extensions: None, extras: gltf_json::Extras::default(), $($fields)* }
    };
}
pub(super) use object;

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
    /// Accessors by the text of their type and target, and their contents.
    known: HashMap<(String, Vec<u8>), Index<Accessor>>,
}

/// Target of the attributes of vertices.
pub(super) const VERTICES: Option<Target> = Some(Target::ArrayBuffer);

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

    /// Stores vectors of numbers, which `to_bytes` converts.
    pub(super) fn vectors<T: Copy, const N: usize, const BYTES: usize>(
        &mut self,
        values: &[[T; N]],
        component: ComponentType,
        to_bytes: fn(T) -> [u8; BYTES],
        target: Option<Target>,
    ) -> Index<Accessor> {
        let bytes: Vec<u8> = values.as_flattened().iter().copied().flat_map(to_bytes).collect();
        let key = (format!("{:?}", (component, N, target)), bytes);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let of_size = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4].get(N - 1).copied().unwrap_or(Type::Mat4);
        let view = self.view(&key.1, target);
        let index = self.root.push(object!(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: values.len().into(),
            component_type: Valid(GenericComponentType(component)),
            type_: Valid(of_size),
            min: None,
            max: None,
            name: None,
            normalized: component == ComponentType::I16,
            sparse: None,
        }));
        self.known.insert(key, index);
        index
    }

    pub(super) fn floats<const N: usize>(&mut self, values: &[[f32; N]], target: Option<Target>) -> Index<Accessor> {
        self.vectors(values, ComponentType::F32, f32::to_le_bytes, target)
    }

    /// Stores positions or times, of which glTF asks for the exact bounds.
    pub(super) fn bounded<const N: usize>(&mut self, values: &[[f32; N]], target: Option<Target>) -> Index<Accessor> {
        let index = self.floats(values, target);
        let bound = |nearer: fn(f32, f32) -> f32| {
            let axis = |axis: usize| values.iter().map(|value| value[axis]).fold(f32::NAN, nearer);
            Some((0..N).map(axis).collect())
        };
        let accessor = &mut self.root.accessors[index.value()];
        (accessor.min, accessor.max) = (bound(f32::min), bound(f32::max));
        index
    }

    /// Stores bytes. Each view starts at a multiple of four bytes.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<Target>) -> Index<View> {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root.push(object!(View {
            buffer: Index::new(0),
            byte_length: bytes.len().into(),
            byte_offset: Some(start.into()),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
        }))
    }

    /// Returns the file: a header, the description as JSON, and the binary buffer.
    ///
    /// # Errors
    ///
    /// A file of 4 GiB or more.
    pub(super) fn file(mut self) -> io::Result<Vec<u8>> {
        if !self.bytes.is_empty() {
            self.root.push(object!(Buffer { byte_length: self.bytes.len().into(), name: None, uri: None }));
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
