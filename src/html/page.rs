//! Contents of a page, and its text: a fixed document with two elements in base64, the program and
//! the data.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

use super::assets::{HeightField, Mesh, Texture};
use super::deformable::{Deformable, Sampler};
use super::options::{HtmlOptions, check_positive};
use super::stream::{Binary, Interval, Part};
use crate::data::Data;
use crate::error::Result;
use crate::replay::{self, Shape};
use crate::scene::SceneOptions;

/// Document with places for the program and the data. `html/build.mjs` generates it, with the
/// digests of the scripts in its content security policy.
const DOCUMENT: &str = include_str!("page.html");

/// Program of the page, compressed. `html/build.mjs` generates it.
const PROGRAM: &[u8] = include_bytes!("program.js.gz");

/// Contents of a page: the description, and the binary data that it refers to.
#[derive(Serialize)]
pub(super) struct Page<'o> {
    title: &'o str,
    /// Names of the bodies.
    bodies: Vec<Option<String>>,
    pub(super) look: Look,
    pub(super) steps: Steps,
    /// Number of moving frames, of which the bodies are the first.
    frames: usize,
    /// Extent of the model, m.
    extent: f64,
    pub(super) tracks: Vec<Track>,
    notes: &'o [(f64, String)],
    /// Index of the camera at the start; `None` for the free camera.
    camera: Option<usize>,
    /// Distance between tracks side by side, m; `None` if they are in one place at the start.
    spacing: Option<f64>,
    #[cfg(feature = "live")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) live: Option<super::Live<'o>>,
    #[serde(skip)]
    pub(super) options: &'o HtmlOptions,
    #[serde(skip)]
    pub(super) binary: Binary,
}

impl<'o> Page<'o> {
    /// Returns a page without tracks. `data` has the positions of the first record.
    pub(super) fn new(data: &mut Data, options: &'o HtmlOptions) -> Result<Self> {
        let model = data.model().clone();
        let extent = model.statistics().extent;
        let spacing = |spacing| check_positive("HtmlOptions::spacing", spacing, f64::MAX);
        let spacing = options.spacing.map(spacing).transpose()?;
        let camera = options.camera.as_ref().map(|name| model.camera(name)).transpose()?;
        let mut binary = Binary::default();
        let look = Look::new(&mut binary, data, options)?;
        Ok(Self {
            title: &options.title,
            bodies: model.bodies().map(|body| body.name().map(str::to_owned)).collect(),
            look,
            steps: Steps::new(options, extent)?,
            frames: replay::all(&model).len(),
            extent,
            tracks: Vec::new(),
            notes: &options.notes,
            camera: camera.map(|camera| camera.index()),
            spacing,
            #[cfg(feature = "live")]
            live: None,
            options,
            binary,
        })
    }

    /// Logs and returns descriptions of what the page does not draw.
    pub(super) fn left_out(&self) -> Vec<String> {
        replay::report(self.look.base.left_out.clone(), "an HTML page does not draw")
    }

    /// Returns the text. The data are the length of the description, four bytes little endian, the
    /// description as JSON, and the binary data, compressed.
    pub(super) fn text(&self) -> io::Result<String> {
        let json = serde_json::to_vec(self)?;
        let length = u32::try_from(json.len()).map_err(io::Error::other)?;
        let mut data = GzEncoder::new(Vec::new(), Compression::best());
        for part in [&length.to_le_bytes(), &json[..], &self.binary.0] {
            data.write_all(part)?;
        }
        // Base64 has no underscore.
        let page = DOCUMENT.replacen("PROGRAM_IN_BASE64", &STANDARD.encode(PROGRAM), 1);
        Ok(page.replacen("DATA_IN_BASE64", &STANDARD.encode(data.finish()?), 1))
    }
}

/// Steps of the numbers in streams.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Steps {
    /// Of times, s.
    pub(super) time: f64,
    /// Of coordinates of positions, m.
    pub(super) position: f64,
    /// Of components of quaternions.
    pub(super) rotation: f64,
}

impl Steps {
    fn new(options: &HtmlOptions, extent: f64) -> Result<Self> {
        let position = options.position_error.unwrap_or_else(|| HtmlOptions::default_error(extent));
        let position = check_positive("HtmlOptions::position_error", position, f64::MAX)?;
        let rotation = check_positive("HtmlOptions::rotation_error", options.rotation_error, 0.1)?;
        Ok(Self {
            time: 1e-6,
            // Half a step along each axis.
            position: position * 2.0 / 3.0_f64.sqrt(),
            // Half a step in each of four components moves a unit quaternion by at most one step
            // s, and turns it by an angle of at most asin(s). Its rotation turns by 2 asin(s).
            rotation: (0.5 * rotation).sin(),
        })
    }
}

/// A trajectory in the page.
#[derive(Debug, Serialize)]
pub(super) struct Track {
    pub(super) label: String,
    /// Number of records.
    pub(super) count: usize,
    /// Times, one channel.
    pub(super) times: Part,
    /// Poses: for each frame seven channels, the position and the quaternion.
    pub(super) poses: Part,
    pub(super) deformables: Vec<Moving>,
    /// Curves, empty for all but the first trajectory.
    pub(super) curves: Vec<Curve>,
}

/// Vertices of a deformable shape.
#[derive(Debug, Serialize)]
pub(super) struct Moving {
    /// Number of vertices.
    pub(super) vertices: usize,
    /// Three channels for each vertex.
    pub(super) values: Part,
}

/// A curve of a plot.
#[derive(Debug, Serialize)]
pub(super) struct Curve {
    pub(super) name: String,
    /// Empty for a number without a unit, or with one that the model does not state.
    pub(super) unit: &'static str,
    pub(super) interval: Interval,
    /// One channel, in which 0 is a value that is not finite, and 1 the number 0.
    pub(super) values: Part,
}

/// Contents of the picture, apart from its motion. Assets have the indices of the model.
#[derive(Debug, Serialize)]
pub(super) struct Look {
    #[serde(flatten)]
    base: replay::Look,
    meshes: BTreeMap<usize, Mesh>,
    height_fields: BTreeMap<usize, HeightField>,
    /// `None` for a texture that is drawn white.
    textures: BTreeMap<usize, Option<Texture>>,
    pub(super) deformables: Vec<Deformable>,
    /// Reader of the deformable shapes.
    #[serde(skip)]
    pub(super) sampler: Option<Sampler>,
}

impl Look {
    /// Collects the looks of a model. `data` has the positions of the first record.
    fn new(binary: &mut Binary, data: &mut Data, options: &HtmlOptions) -> Result<Self> {
        let groups = SceneOptions::default().with_geomgroup(options.geomgroup).with_sitegroup(options.sitegroup);
        let (mut base, scene) = replay::Look::new(data, &groups)?;
        let model = data.model();
        let error = options.largest_mesh_error(model)?;
        let assets = |shape: Shape| {
            let geoms = base.geoms.iter().filter(move |geom| geom.shape == shape);
            geoms.filter_map(|geom| Some((geom.asset?, geom.texture.is_some()))).collect::<BTreeSet<_>>()
        };
        // The last entry of a mesh has a texture if any has.
        let meshes = BTreeMap::from_iter(assets(Shape::Mesh)).into_iter();
        let mesh = |(index, textured)| Ok((index, Mesh::new(binary, &model.mesh(index)?, textured, error)));
        let meshes = meshes.map(mesh).collect::<Result<_>>()?;
        let field = |(index, _)| Ok((index, HeightField::new(binary, &model.height_field(index)?)));
        let height_fields = assets(Shape::HeightField).into_iter().map(field).collect::<Result<_>>()?;
        let mut texture = |texture: &replay::Texture| Texture::new(binary, texture);
        let textures =
            base.textures.iter().map(|(&index, stored)| (index, stored.as_ref().map(&mut texture))).collect();
        let (sampler, deformables) = Sampler::new(binary, model, scene, groups, &mut base.left_out);
        Ok(Self { base, meshes, height_fields, textures, deformables, sampler })
    }
}
