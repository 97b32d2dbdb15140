//! An independent reader of glTF files, and models for the tests.

use std::collections::{HashMap, HashSet};

use gltf::animation::util::ReadOutputs;
use gltf::{Gltf, Node};
use mujoco_safe::gltf::GltfOptions;
use mujoco_safe::nalgebra::{Isometry3, Matrix4, Point3, Quaternion, Translation3, UnitQuaternion};
use mujoco_safe::{Data, Model, RandomController, Trajectory};

/// A file that was read.
pub struct File {
    pub gltf: Gltf,
    pub bytes: Vec<u8>,
    pub left_out: Vec<String>,
}

/// Saves trajectories and reads the file.
pub fn saved(model: &Model, trajectories: &[(&str, &Trajectory)], options: &GltfOptions) -> File {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.glb");
    let left_out = mujoco_safe::gltf::save(&path, model.clone(), trajectories.iter().copied(), options).unwrap();
    File::read(std::fs::read(path).unwrap(), left_out)
}

/// Returns the file of the initial state.
pub fn still(model: &Model) -> File {
    let mut trajectory = Trajectory::new(model);
    trajectory.push(&Data::new(model.clone()).unwrap()).unwrap();
    saved(model, &[("", &trajectory)], &GltfOptions::default())
}

pub fn recorded(model: &Model, seed: u64, steps: usize) -> Trajectory {
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(model);
    trajectory.record(&mut data, &mut RandomController::new(seed), steps).unwrap();
    trajectory
}

/// Triangles of a node in its frame.
pub struct Triangles {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub texcoords: Vec<[f32; 2]>,
    pub indices: Vec<[usize; 3]>,
}

impl File {
    pub fn read(bytes: Vec<u8>, left_out: Vec<String>) -> Self {
        Self { gltf: Gltf::from_slice(&bytes).unwrap(), bytes, left_out }
    }

    fn blob(&self) -> &[u8] {
        self.gltf.blob.as_deref().unwrap()
    }

    /// Returns the node with a mesh that has this name.
    pub fn shown(&self, name: &str) -> Node<'_> {
        let named = |node: &Node<'_>| node.mesh().is_some() && node.name() == Some(name);
        self.gltf.nodes().find(named).unwrap_or_else(|| panic!("no node {name}"))
    }

    pub fn view(&self, view: &gltf::buffer::View<'_>) -> &[u8] {
        &self.blob()[view.offset()..][..view.length()]
    }

    pub fn triangles(&self, node: &Node<'_>) -> Triangles {
        let mesh = node.mesh().unwrap();
        assert_eq!(mesh.primitives().count(), 1);
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(self.blob()));
        let indices: Vec<usize> = reader.read_indices().unwrap().into_u32().map(|index| index as usize).collect();
        Triangles {
            positions: reader.read_positions().unwrap().collect(),
            normals: reader.read_normals().unwrap().collect(),
            texcoords: reader.read_tex_coords(0).map(|found| found.into_f32().collect()).unwrap_or_default(),
            indices: indices.as_chunks::<3>().0.to_vec(),
        }
    }

    /// Returns the times of an animation, s.
    pub fn times(&self, animation: usize) -> Vec<f32> {
        let animation = self.gltf.animations().nth(animation).unwrap();
        let channel = animation.channels().next().unwrap();
        channel.reader(|_| Some(self.blob())).read_inputs().unwrap().collect()
    }

    /// Returns the pose of each node in the world at a key of an animation, or at rest.
    pub fn world(&self, key: Option<(usize, usize)>) -> HashMap<usize, Isometry3<f64>> {
        let unit = |[x, y, z, w]: [f32; 4]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z).cast::<f64>());
        let mut local: Vec<Isometry3<f64>> = Vec::new();
        for node in self.gltf.nodes() {
            let (translation, rotation, scale) = node.transform().decomposed();
            assert_eq!(scale, [1.0; 3]);
            local.push(Isometry3::from_parts(Translation3::from(translation.map(f64::from)), unit(rotation)));
        }
        if let Some((animation, key)) = key {
            for channel in self.gltf.animations().nth(animation).unwrap().channels() {
                let pose = &mut local[channel.target().node().index()];
                match channel.reader(|_| Some(self.blob())).read_outputs().unwrap() {
                    ReadOutputs::Translations(mut found) => {
                        pose.translation = Translation3::from(found.nth(key).unwrap().map(f64::from));
                    }
                    ReadOutputs::Rotations(found) => pose.rotation = unit(found.into_f32().nth(key).unwrap()),
                    _ => panic!("an animation of another property"),
                }
            }
        }
        let mut world = HashMap::new();
        let mut rest: Vec<(Isometry3<f64>, Node<'_>)> =
            self.gltf.default_scene().unwrap().nodes().map(|node| (Isometry3::identity(), node)).collect();
        while let Some((parent, node)) = rest.pop() {
            let pose = parent * local[node.index()];
            assert!(world.insert(node.index(), pose).is_none(), "a node has one parent");
            rest.extend(node.children().map(|child| (pose, child)));
        }
        assert_eq!(world.len(), self.gltf.nodes().len(), "all nodes are in the scene");
        world
    }
}

impl File {
    /// Returns the vertices of a node with a skin in the world, by the equation of the
    /// specification: the sum of the weights times the pose of the joint times its inverse bind
    /// matrix. Axes are the engine's.
    pub fn skinned(&self, name: &str, key: Option<(usize, usize)>) -> Vec<Point3<f64>> {
        let node = self.shown(name);
        let is_at_root = |root: Node<'_>| root.index() == node.index();
        assert!(self.gltf.default_scene().unwrap().nodes().any(is_at_root), "programs ignore its pose");
        let skin = node.skin().unwrap();
        let (world, reader) = (self.world(key), skin.reader(|_| Some(self.blob())));
        let inverse = reader.read_inverse_bind_matrices().unwrap();
        let inverse: Vec<Matrix4<f64>> = inverse.map(|columns| Matrix4::from(columns).cast()).collect();
        let joints: Vec<usize> = skin.joints().map(|joint| joint.index()).collect();
        assert_eq!(joints.iter().collect::<HashSet<_>>().len(), inverse.len(), "joints are different nodes");
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(self.blob()));
        let mut result = vec![Matrix4::zeros(); reader.read_positions().unwrap().count()];
        let mut sums = vec![0.0; result.len()];
        for set in 0.. {
            let Some(bones) = reader.read_joints(set) else { break };
            let weights = reader.read_weights(set).unwrap().into_f32();
            for ((bones, weights), (result, sum)) in bones.into_u16().zip(weights).zip(result.iter_mut().zip(&mut sums))
            {
                for (bone, weight) in bones.map(usize::from).into_iter().zip(weights.map(f64::from)) {
                    *result += weight * world[&joints[bone]].to_homogeneous() * inverse[bone];
                    *sum += weight;
                }
            }
        }
        assert!(sums.iter().all(|sum| (sum - 1.0_f64).abs() < 1e-6), "{sums:?}");
        let positions = reader.read_positions().unwrap().map(|position| Point3::from(position.map(f64::from)));
        positions.zip(result).map(|(position, matrix)| z_up(matrix.transform_point(&position))).collect()
    }
}

/// Converts a point of glTF, whose y-axis is up, to the engine's axes.
pub fn z_up(point: Point3<f64>) -> Point3<f64> {
    Point3::new(point.x, -point.z, point.y)
}

/// Geoms of all shapes, with textures, in a tree with all kinds of joints.
pub const SHAPES: &str = "<mujoco>
  <visual><quality numslices='64' numstacks='64'/></visual>
  <asset>
    <mesh name='prism' vertex='0 0 0  .4 0 0  0 .3 0  0 0 .2' face='0 2 1  0 1 3  0 3 2  1 2 3'
      texcoord='0 0  1 0  0 1  .25 .75'/>
    <hfield name='hill' nrow='3' ncol='4' size='1 2 .5 .1'/>
    <texture name='checker' type='2d' builtin='checker' rgb1='1 0 0' rgb2='0 0 1' width='16' height='8'/>
    <texture name='cube' type='cube' builtin='flat' rgb1='1 .5 0' rgb2='1 .5 0' width='4' height='24'/>
    <texture name='sky' type='skybox' builtin='gradient' rgb1='0 0 1' rgb2='1 1 1' width='4' height='24'/>
    <material name='checked' texture='checker' texrepeat='2 3' specular='.25' shininess='.75' emission='.1'
      rgba='.5 1 1 1'/>
    <material name='cubed' texture='cube' specular='0' rgba='.5 1 1 1'/>
  </asset>
  <worldbody>
    <light name='spot' pos='2 -4 6' dir='0 .5 -1' cutoff='30' diffuse='.5 .5 1'/>
    <light name='sun' directional='true' dir='0 1 -1' diffuse='1 1 1'/>
    <camera name='watch' mode='targetbody' target='slider' pos='0 -3 1'/>
    <geom name='plane' type='plane' size='0 0 1' material='checked' pos='0 0 -5'/>
    <geom name='hill' type='hfield' hfield='hill' pos='0 0 -4'/>
    <body name='all' pos='0 0 1' euler='10 20 30'>
      <freejoint/>
      <geom name='sphere' size='.1'/>
      <geom name='box' type='box' size='.1 .2 .3' pos='1 0 0' euler='0 0 90' material='cubed'/>
      <geom name='capsule' type='capsule' size='.1 .2' pos='2 0 0'/>
      <geom name='cylinder' type='cylinder' size='.1 .2' pos='3 0 0'/>
      <body name='ball' pos='0 0 .5'>
        <joint type='ball' pos='.1 0 .2'/>
        <geom name='ellipsoid' type='ellipsoid' size='.1 .2 .3' pos='4 0 0' rgba='.1 .2 .3 .4'/>
        <body name='fixed' euler='40 0 0'>
          <geom name='prism' type='mesh' mesh='prism' pos='5 0 0' euler='0 0 30' material='checked'/>
          <body name='slider' pos='.2 .1 0'>
            <joint name='slide' type='slide' axis='1 1 0'/>
            <joint name='hinge' axis='0 1 1' pos='0 0 .1'/>
            <geom name='tip' type='box' size='.1 .1 .1'/>
            <site name='site' size='.05' pos='.1 0 0'/>
            <camera name='front' pos='2.5 -7 2' xyaxes='1 0 0 0 .25 1' fovy='40'/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint='slide' gear='30'/><motor joint='hinge' gear='20'/></actuator></mujoco>";
