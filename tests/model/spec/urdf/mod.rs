//! Specs of URDF, compared with the models that the engine's own reader makes.

mod engine;
mod errors;
mod files;
mod random;
mod saved;
mod scene;
mod warnings;

use std::path::Path;

use mujoco_safe::Model;
use mujoco_safe::spec::{Spec, UrdfWarning};

use super::super::same_models::differences;

/// Rounding of quaternions, and of what the compiler computes from them.
const TOLERANCE: f64 = 1e-12;

fn robot(content: &str) -> String {
    format!("<robot name='robot'>{content}</robot>")
}

/// Returns a link with an inertia and other content.
fn link(name: &str, content: &str) -> String {
    format!(
        "<link name='{name}'>
           <inertial><origin xyz='.1 .2 .3'/><mass value='1.5'/>
             <inertia ixx='.3' iyy='.2' izz='.25' ixy='.01' ixz='-.02' iyz='.03'/></inertial>
           {content}
         </link>"
    )
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, content: &str) -> String {
    format!("<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{content}</joint>")
}

fn read(urdf: &str) -> Spec {
    Spec::from_xml_str(urdf).unwrap_or_else(|error| panic!("{error}\n{urdf}"))
}

fn compiled(urdf: &str) -> Model {
    let spec = read(urdf);
    spec.compile().unwrap_or_else(|error| panic!("{error}\n{urdf}\n{}", spec.to_xml()))
}

/// Checks that a URDF compiles to the same model as by the engine's reader.
#[track_caller]
fn same(urdf: &str) -> Model {
    let model = compiled(urdf);
    check(&model, &Model::from_xml_str(urdf).unwrap_or_else(|error| panic!("{error}\n{urdf}")), urdf);
    model
}

#[track_caller]
fn check(ours: &Model, theirs: &Model, urdf: &str) {
    // SAFETY: a valid model.
    let found = unsafe { differences(ours, theirs.as_ptr(), TOLERANCE, &[]) };
    assert!(found.is_empty(), "{found:#?}\n{urdf}");
    assert_eq!(ours.options(), theirs.options(), "{urdf}");
}

fn mesh(role: &str, file: &str) -> String {
    format!("<{role}><geometry><mesh filename='{file}'/></geometry></{role}>")
}

fn put(path: impl AsRef<Path>, content: &str) {
    std::fs::create_dir_all(path.as_ref().parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

/// Returns the lengths of the meshes' longest edges, in the order of the geoms.
fn sizes(model: &Model) -> Vec<f64> {
    let longest = |geom: usize| {
        let mesh = model.geom_dataid()[geom] as usize;
        let (start, count) = (model.mesh_vertadr()[mesh] as usize, model.mesh_vertnum()[mesh] as usize);
        let vertices = &model.mesh_vert()[start..start + count];
        let distance = |a: &[f32; 3], b: &[f32; 3]| (0..3).map(|i| f64::from(a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        vertices.iter().flat_map(|a| vertices.iter().map(move |b| distance(a, b))).fold(0.0, f64::max)
    };
    (0..model.ngeom()).map(|geom| (longest(geom) / 2.0_f64.sqrt() * 1e3).round() / 1e3).collect()
}

/// Text of a mesh, a corner with edges of this length.
fn corner(length: f64) -> String {
    format!("v 0 0 0\nv {length} 0 0\nv 0 {length} 0\nv 0 0 {length}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
}

fn warnings(urdf: &str) -> Vec<String> {
    Spec::from_xml_str(urdf).unwrap().urdf_warnings().iter().map(UrdfWarning::to_string).collect()
}
