//! Contents of a file: the tree of nodes, with what they show.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use gltf_json::{Extras, Index, Node, Scene};

use super::document::Document;
use super::geometry::Geometry;
use super::material::Materials;
use super::motion::Clip;
use super::options::GltfOptions;
use super::{light, node};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::file;
use crate::math::rot_vec_quat;
use crate::model::Model;
use crate::replay::{self, Frame, Groups, Look, Pose};

/// Returns the frame that contains each frame: the parent of a body, and the world for cameras and
/// lights that move by themselves.
pub(super) fn parents(model: &Model, frames: &[Frame]) -> Vec<Option<usize>> {
    let parent = |frame: &Frame| match *frame {
        Frame::Body(0) => None,
        Frame::Body(index) => Some(model.body_parentid()[index] as usize),
        Frame::Camera(_) | Frame::Light(_) => Some(0),
    };
    frames.iter().map(parent).collect()
}

/// Returns the largest distance of a body from the origin, m.
pub(super) fn distance(data: &Data) -> f64 {
    data.xpos().iter().map(|pos| pos.iter().map(|part| part * part).sum::<f64>().sqrt()).fold(0.0, f64::max)
}

/// Contents of a file.
pub(super) struct Contents {
    frames: Vec<Frame>,
    look: Look,
    left_out: BTreeSet<String>,
    /// Distances of the lights from the centre of the model, m.
    distances: Vec<f64>,
}

impl Contents {
    /// Collects the looks. `data` has the positions of the first record.
    pub(super) fn new(data: &mut Data, frames: Vec<Frame>, options: &GltfOptions) -> Result<Self> {
        if options.rotation_error.is_nan() || options.rotation_error < 1e-6 {
            let value = options.rotation_error;
            return Err(Error::out_of_range("GltfOptions::rotation_error", value, "at least 1e-6"));
        }
        let mut look = Look::new(data, &frames, Groups { geom: options.geomgroup, site: options.sitegroup })?;
        let mut left_out = std::mem::take(&mut look.left_out);
        if look.sky.is_some() {
            left_out.insert("the sky".to_owned());
        }
        let center = data.model().statistics().center;
        let distance = |light: &replay::Light| {
            let Some(frame) = light.frame else { return 0.0 };
            let Pose { pos, quat } = replay::pose(data, frames[frame]);
            let place = rot_vec_quat(&light.pos, &quat);
            (0..3).map(|axis| (pos[axis] + place[axis] - center[axis]).powi(2)).sum::<f64>().sqrt()
        };
        let distances = look.lights.iter().map(distance).collect();
        Ok(Self { frames, look, left_out, distances })
    }

    /// Writes the file, and returns what is left out. `farthest` is the largest distance of a body
    /// from the origin, m.
    pub(super) fn write(
        mut self,
        path: &Path,
        model: &Model,
        clips: &[Clip],
        farthest: f64,
        options: &GltfOptions,
    ) -> Result<Vec<String>> {
        let mut document = Document::default();
        document.root.asset.generator = Some(concat!("mujoco-safe ", env!("CARGO_PKG_VERSION")).to_owned());
        let extent = model.statistics().extent;
        let rest = clips[0].start();
        let nodes = self.add_frames(&mut document, model, &rest)?;
        self.add_geoms(&mut document, model, &nodes, (5.0 * extent + farthest) as f32)?;
        self.add_cameras(&mut document, model, &nodes)?;
        for clip in clips {
            clip.animate(&mut document, &nodes, &rest, extent, options.rotation_error)?;
        }
        let left_out = replay::report(self.left_out, "a glTF file does not contain");
        let bytes = document.file().map_err(Error::file(path))?;
        file::replace(path, |out| out.write_all(&bytes))?;
        Ok(left_out)
    }

    /// Adds the scene, its root and the nodes of the frames.
    fn add_frames(&self, document: &mut Document, model: &Model, rest: &[Pose]) -> Result<Vec<Index<Node>>> {
        let root = &mut document.root;
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let upright = Pose { pos: [0.0; 3], quat: [half, -half, 0.0, 0.0] };
        let top = root.push(node::node("z-axis up".to_owned(), upright)?);
        let scene =
            Scene { nodes: vec![top], extensions: None, extras: Extras::default(), name: Some("scene".to_owned()) };
        root.scene = Some(root.push(scene));
        let parents = parents(model, &self.frames);
        let mut nodes: Vec<Index<Node>> = Vec::with_capacity(self.frames.len());
        for ((frame, pose), parent) in self.frames.iter().zip(rest).zip(parents) {
            let name = match *frame {
                Frame::Body(index) => body_name(model, index),
                Frame::Camera(index) => format!("frame of {}", camera_name(model, index)),
                Frame::Light(index) => format!("frame of {}", light::name(model, index)),
            };
            // The engine orders parents before their children.
            let parent = parent.map_or(top, |parent| nodes[parent]);
            nodes.push(node::add_child(root, parent, node::node(name, *pose)?));
        }
        Ok(nodes)
    }

    fn add_geoms(&mut self, document: &mut Document, model: &Model, nodes: &[Index<Node>], far: f32) -> Result<()> {
        let (mut geometry, mut materials) = (Geometry::new(far), Materials::default());
        for geom in &self.look.geoms {
            let texture = geom.texture.and_then(|index| self.look.textures[&index].as_ref());
            if let Some(index) = geom.texture.filter(|_| texture.is_some_and(|texture| texture.is_cube)) {
                let name = model.textures().nth(index).and_then(|texture| texture.name());
                self.left_out.insert(format!("the pattern of the cube texture {}", name.unwrap_or("without a name")));
            }
            let name =
                geom.name.clone().unwrap_or_else(|| format!("{} of {}", geom.element, body_name(model, geom.frame)));
            let material = materials.add(document, model, geom, texture);
            let map = texture.filter(|texture| !texture.is_cube).map(|_| geom.map);
            match geometry.mesh(document, model, &self.look, geom, material, map) {
                Ok(mesh) => {
                    let node = node::node(name, Pose { pos: geom.pos, quat: geom.quat })?;
                    node::add_child(&mut document.root, nodes[geom.frame], Node { mesh, ..node });
                }
                Err(error) => {
                    self.left_out.insert(format!("{} {name}: {error}", geom.element));
                }
            }
        }
        Ok(())
    }

    /// Adds the cameras, and the lights, of which the headlight is at the free camera.
    fn add_cameras(&mut self, document: &mut Document, model: &Model, nodes: &[Index<Node>]) -> Result<()> {
        let root = &mut document.root;
        let free = node::node("free camera".to_owned(), node::free_pose(&self.look.free))?;
        let free = node::add_child(root, nodes[0], free);
        if let Some((camera, _)) = node::camera(Some("free camera".to_owned()), &self.look.free.frustum) {
            root.nodes[free.value()].camera = Some(root.push(camera));
        }
        for (index, camera) in self.look.cameras.iter().enumerate() {
            let name = camera_name(model, index);
            let Some((converted, is_symmetric)) = node::camera(Some(name.clone()), &camera.frustum) else {
                self.left_out.insert(format!("camera {name}"));
                continue;
            };
            if !is_symmetric {
                self.left_out.insert(format!("camera {name}: the shift of its frustum"));
            }
            let node = node::node(name, Pose { pos: camera.pos, quat: camera.quat })?;
            let camera = Some(root.push(converted));
            node::add_child(root, nodes[self.look.cameras[index].frame], Node { camera, ..node });
        }
        for (light, distance) in self.look.lights.iter().zip(&self.distances) {
            let node = light::light(root, model, light, *distance)?;
            node::add_child(root, light.frame.map_or(free, |frame| nodes[frame]), node);
        }
        Ok(())
    }
}

fn body_name(model: &Model, index: usize) -> String {
    let name = model.bodies().nth(index).and_then(|body| body.name());
    name.map_or_else(|| format!("body {index}"), str::to_owned)
}

fn camera_name(model: &Model, index: usize) -> String {
    let name = model.cameras().nth(index).and_then(|camera| camera.name());
    name.map_or_else(|| format!("camera {index}"), str::to_owned)
}
