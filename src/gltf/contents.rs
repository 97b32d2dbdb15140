//! Contents of a file: the tree of nodes, with what they show.

use std::io::Write;
use std::path::Path;

use gltf_json::{Index, Node, Scene};

use super::document::{Document, object};
use super::motion::Clip;
use super::{GltfOptions, node};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::file;
use crate::kind::Kind;
use crate::math::{Pose, norm};
use crate::model::Model;
use crate::replay::{self, CameraLook, Frame, Look, label};
use crate::scene::SceneOptions;

/// Writes a file, and returns what is left out. `data` has the positions of the first record.
pub(super) fn write(path: &Path, data: &mut Data, options: &GltfOptions, clips: &[Clip<'_>]) -> Result<Vec<String>> {
    let error = options.rotation_error;
    Error::check_range(error >= 1e-6, "GltfOptions::rotation_error", error, "at least 1e-6")?;
    let groups = SceneOptions::default().with_geomgroup(options.geomgroup).with_sitegroup(options.sitegroup);
    let (mut look, scene) = Look::new(data, &groups)?;
    let (model, frames) = (data.model(), replay::all(data.model()));
    let parents = parents(model, &frames);
    let poses: Vec<Vec<Vec<Pose>>> = clips.iter().map(|clip| clip.in_parents(&parents)).collect();
    let rest: Vec<Pose> = poses[0].iter().map(|poses| poses[0]).collect();

    let mut document = Document::new(model, std::mem::take(&mut look.left_out));
    document.add_frames(&frames, &rest, &parents)?;
    document.add_geoms(&look, farthest(model.nbody(), clips))?;
    document.add_deformables(data, &scene, &groups, &mut look);
    document.left_out.append(&mut look.left_out);
    let free = document.add_cameras(&look)?;
    document.add_lights(data, &look, free)?;
    for (clip, poses) in clips.iter().zip(&poses) {
        document.animate(clip, poses, &rest, options.rotation_error)?;
    }
    let left_out = replay::report(std::mem::take(&mut document.left_out), "a glTF file does not contain");
    file::replace(path, |out| out.write_all(&document.file()?))?;
    Ok(left_out)
}

/// Returns the frame that contains each frame: the parent of a body, and the world for cameras and
/// lights that move by themselves.
fn parents(model: &Model, frames: &[Frame]) -> Vec<Option<usize>> {
    let parent = |frame: &Frame| match *frame {
        Frame::Body(0) => None,
        Frame::Body(index) => Some(model.body_parentid()[index] as usize),
        Frame::Camera(_) | Frame::Light(_) => Some(0),
    };
    frames.iter().map(parent).collect()
}

/// Returns the largest distance of the first frames, which are the bodies, from the origin, m.
fn farthest(bodies: usize, clips: &[Clip<'_>]) -> f64 {
    let poses = clips.iter().flat_map(|clip| &clip.poses[..bodies]).flatten();
    poses.map(|pose| norm(&pose.pos)).fold(0.0, f64::max)
}

impl Document<'_> {
    /// Adds the scene, its root and the nodes of the frames.
    fn add_frames(&mut self, frames: &[Frame], rest: &[Pose], parents: &[Option<usize>]) -> Result<()> {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let upright = Pose { pos: [0.0; 3], quat: [half, -half, 0.0, 0.0] };
        let top = self.root.push(node::node("z-axis up".to_owned(), upright)?);
        let scene = object!(Scene { nodes: vec![top], name: Some("scene".to_owned()) });
        self.root.scene = Some(self.root.push(scene));
        for ((frame, pose), parent) in frames.iter().zip(rest).zip(parents) {
            let name = match *frame {
                Frame::Body(index) => label(self.model, Kind::Body, index),
                Frame::Camera(index) => format!("frame of {}", label(self.model, Kind::Camera, index)),
                Frame::Light(index) => format!("frame of {}", label(self.model, Kind::Light, index)),
            };
            // The engine orders parents before their children.
            let parent = parent.map_or(top, |parent| self.nodes[parent]);
            self.nodes.push(node::add_child(&mut self.root, parent, node::node(name, *pose)?));
        }
        Ok(())
    }

    /// Adds the geoms. `farthest` is the largest distance of a body from the origin, m.
    fn add_geoms(&mut self, look: &Look, farthest: f64) -> Result<()> {
        if look.sky.is_some() {
            self.left_out.insert("the sky".to_owned());
        }
        let far = (5.0 * self.model.statistics().extent + farthest) as f32;
        for geom in &look.geoms {
            let texture = geom.texture.and_then(|index| Some((index, look.textures[&index].as_ref()?)));
            let of_body = || format!("{} of {}", geom.element, label(self.model, Kind::Body, geom.frame));
            let name = geom.name.clone().unwrap_or_else(of_body);
            let material = self.material(&geom.surface, geom.material, texture, false);
            let map = texture.filter(|(_, texture)| !texture.is_cube).map(|_| geom.map);
            match self.mesh(geom, far, material, map) {
                Ok(mesh) => {
                    let node = node::node(name, Pose { pos: geom.pos, quat: geom.quat })?;
                    node::add_child(&mut self.root, self.nodes[geom.frame], Node { mesh, ..node });
                }
                Err(error) => _ = self.left_out.insert(format!("{} {name}: {error}", geom.element)),
            }
        }
        Ok(())
    }

    /// Adds the cameras, and returns the node of the free one.
    fn add_cameras(&mut self, look: &Look) -> Result<Index<Node>> {
        for (index, camera) in look.cameras.iter().enumerate() {
            self.add_camera(label(self.model, Kind::Camera, index), camera)?;
        }
        self.add_camera("free camera".to_owned(), &look.free)
    }

    fn add_camera(&mut self, name: String, look: &CameraLook) -> Result<Index<Node>> {
        let camera = node::camera(name.clone(), &look.view).map(|camera| self.root.push(camera));
        if camera.is_none() {
            self.left_out.insert(format!("camera {name}"));
        } else if !node::is_symmetric(&look.view) {
            self.left_out.insert(format!("camera {name}: the shift of its frustum"));
        }
        let node = node::node(name, Pose { pos: look.pos, quat: look.quat })?;
        Ok(node::add_child(&mut self.root, self.nodes[look.frame], Node { camera, ..node }))
    }

    /// Adds the lights, of which the headlight is at the node of the free camera.
    fn add_lights(&mut self, data: &Data, look: &Look, free: Index<Node>) -> Result<()> {
        for light in &look.lights {
            let parent = light.frame.map_or(free, |frame| self.nodes[frame]);
            let node = node::light(&mut self.root, data, light)?;
            node::add_child(&mut self.root, parent, node);
        }
        Ok(())
    }
}
