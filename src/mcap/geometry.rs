//! The shapes of a model as a `foxglove.SceneUpdate`: one entity for each body, in its frame.

use super::protobuf::Message;
use crate::element::{Geom, HeightField};
use crate::enums::GeomType;
use crate::math::rot_vec_quat;
use crate::model::Model;

/// Fields of a `SceneEntity`.
const CUBE: u32 = 8;
const SPHERE: u32 = 9;
const CYLINDER: u32 = 10;
const TRIANGLES: u32 = 12;

/// Groups of geoms that the engine shows by default.
const GROUPS: std::ops::Range<i32> = 0..3;

/// Default colour of the engine's geoms. A geom with it has the colour of its material.
const DEFAULT_RGBA: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

/// Returns the `SceneUpdate` of a model. `frames` are the names of its bodies.
pub(super) fn scene(model: &Model, frames: &[String]) -> Message {
    let mut scene = Message::default();
    for body in model.bodies() {
        let geoms = body.geoms().map(|geom| model.geom(geom));
        let shown: Vec<_> = geoms.filter(|geom| GROUPS.contains(&geom.group()) && rgba(model, geom)[3] > 0.0).collect();
        if shown.is_empty() {
            continue;
        }
        let frame = &frames[body.index()];
        put_entity(&mut scene, frame, frame, |entity| shown.iter().for_each(|geom| put_geom(entity, model, geom)));
    }
    scene
}

/// Appends a `SceneEntity` to a `SceneUpdate`.
pub(super) fn put_entity(scene: &mut Message, frame: &str, id: &str, shapes: impl FnOnce(&mut Message)) {
    scene.put_message(2, |entity| {
        entity.put_stamp(1);
        entity.put_text(2, frame);
        entity.put_text(3, id);
        entity.put_number(5, 1); // locked to the frame
        shapes(entity);
    });
}

/// Appends a `TriangleListPrimitive` to an entity.
pub(super) fn put_triangles(
    entity: &mut Message,
    (pos, quat): (&[f64; 3], &[f64; 4]),
    points: impl Iterator<Item = [f64; 3]>,
    indices: impl Iterator<Item = u32>,
    color: &[f64; 4],
) {
    entity.put_message(TRIANGLES, |primitive| {
        put_pose(primitive, pos, quat);
        points.for_each(|point| primitive.put_tuple(2, &point));
        primitive.put_tuple(3, color);
        primitive.put_fixed32(5, indices);
    });
}

pub(super) fn put_pose(primitive: &mut Message, pos: &[f64; 3], &[w, x, y, z]: &[f64; 4]) {
    primitive.put_message(1, |pose| {
        pose.put_tuple(1, pos);
        pose.put_tuple(2, &[x, y, z, w]);
    });
}

fn rgba(model: &Model, geom: &Geom<'_>) -> [f32; 4] {
    match geom.material() {
        Some(material) if *geom.rgba() == DEFAULT_RGBA => *model.material(material).rgba(),
        _ => *geom.rgba(),
    }
}

fn put_geom(entity: &mut Message, model: &Model, geom: &Geom<'_>) {
    let [x, y, z] = *geom.size();
    let color = rgba(model, geom).map(f64::from);
    let mut sized = |kind: u32, pos: &[f64; 3], size: [f64; 3]| {
        entity.put_message(kind, |primitive| {
            put_pose(primitive, pos, geom.quat());
            primitive.put_tuple(2, &size);
            if kind == CYLINDER {
                primitive.put_double(3, 1.0);
                primitive.put_double(4, 1.0);
            }
            primitive.put_tuple(if kind == CYLINDER { 5 } else { 3 }, &color);
        });
    };
    let (diameter, pos) = (2.0 * x, geom.pos());
    match geom.geom_type() {
        GeomType::Box => sized(CUBE, pos, [2.0 * x, 2.0 * y, 2.0 * z]),
        GeomType::Sphere => sized(SPHERE, pos, [diameter; 3]),
        GeomType::Ellipsoid => sized(SPHERE, pos, [2.0 * x, 2.0 * y, 2.0 * z]),
        GeomType::Cylinder => sized(CYLINDER, pos, [diameter, diameter, 2.0 * y]),
        GeomType::Capsule => {
            sized(CYLINDER, pos, [diameter, diameter, 2.0 * y]);
            let half = rot_vec_quat(&[0.0, 0.0, y], geom.quat());
            for sign in [-1.0, 1.0] {
                let end = std::array::from_fn(|axis| pos[axis] + sign * half[axis]);
                sized(SPHERE, &end, [diameter; 3]);
            }
        }
        GeomType::Plane | GeomType::Mesh | GeomType::Sdf | GeomType::HeightField => {
            let Some((points, indices)) = triangles(model, geom) else { return };
            let indices = indices.into_iter().flatten().map(|index| index as u32);
            put_triangles(entity, (pos, geom.quat()), points.into_iter(), indices, &color);
        }
    }
}

/// Vertices, and triangles between them.
type Triangles = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// Returns the triangles of a geom. `None` for a signed distance field without a mesh.
fn triangles(model: &Model, geom: &Geom<'_>) -> Option<Triangles> {
    if let Some(mesh) = geom.mesh() {
        let mesh = model.mesh(mesh);
        let points = mesh.vert().iter().map(|vertex| vertex.map(f64::from)).collect();
        let indices = mesh.face().iter().map(|face| face.map(|index| index as usize)).collect();
        return Some((points, indices));
    }
    if let Some(field) = geom.height_field() {
        let field = model.height_field(field);
        return Some((elevations(&field), grid(field.nrow(), field.ncol())));
    }
    // A size of zero is infinite.
    let infinite = 5.0 * model.statistics().extent;
    let [x, y, _] = geom.size().map(|half| if half > 0.0 { half } else { infinite });
    let points = vec![[-x, -y, 0.0], [x, -y, 0.0], [-x, y, 0.0], [x, y, 0.0]];
    (geom.geom_type() == GeomType::Plane).then(|| (points, grid(2, 2)))
}

/// Returns the vertices of a height field, row by row.
fn elevations(field: &HeightField<'_>) -> Vec<[f64; 3]> {
    let ([x, y, height, _], ncol) = (*field.size(), field.ncol());
    let along = |half: f64, index: usize, count: usize| half * (2.0 * index as f64 / (count - 1).max(1) as f64 - 1.0);
    let vertex = |(index, &elevation): (usize, &f32)| {
        let (row, column) = (index / ncol, index % ncol);
        [along(x, column, ncol), along(y, row, field.nrow()), height * f64::from(elevation)]
    };
    field.data().iter().enumerate().map(vertex).collect()
}

/// Returns the triangles between the vertices of a grid, which are counter-clockwise from above.
fn grid(nrow: usize, ncol: usize) -> Vec<[usize; 3]> {
    let cells = (0..nrow - 1).flat_map(|row| (0..ncol - 1).map(move |column| row * ncol + column));
    cells.flat_map(|first| [[first, first + 1, first + ncol], [first + 1, first + ncol + 1, first + ncol]]).collect()
}
