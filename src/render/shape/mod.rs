//! What the graphics card keeps of each shape: its corners, in the shape's own frame.
//!
//! | file | what is in it |
//! |---|---|
//! | `detail.rs` | into how many parts a shape is cut |
//! | `lathe.rs` | a profile turned about the z-axis: what the round shapes are made with |
//! | `plane.rs`, `cuboid.rs` | flat ones |
//! | `sphere.rs`, `cylinder.rs`, `disk.rs`, `cone.rs` | round ones |
//! | `mesh.rs` | a mesh of the model, and its convex hull |
//! | `height_field.rs` | a height field of the model, with its sides and its bottom |
//! | `skin.rs` | what of a skin stays as it is while it bends |
//!
//! Every number in [`Triangles`] is finite, whatever the model contains: a triangle of which a corner is nowhere is left out.

mod cone;
mod cuboid;
mod cylinder;
mod detail;
mod disk;
mod height_field;
mod lathe;
mod mesh;
mod plane;
mod skin;
mod sphere;

pub(crate) use self::cone::cone;
pub(crate) use self::cuboid::cuboid;
pub(crate) use self::cylinder::cylinder;
pub(crate) use self::detail::Detail;
pub(crate) use self::disk::disk;
pub(crate) use self::height_field::height_field;
pub(crate) use self::mesh::{hull, mesh};
pub(crate) use self::plane::plane;
pub(crate) use self::skin::{SkinSurface, skin};
pub(crate) use self::sphere::{hemisphere, sphere};
use crate::error::{Error, Result};

/// A corner of a triangle.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Vertex {
    pub(crate) position: [f32; 3],
    /// Of length one.
    pub(crate) normal: [f32; 3],
    /// Where a picture is glued to the shape by its author; zero where it is generated.
    pub(crate) texcoord: [f32; 2],
}

/// Triangles, each three indices of corners, counterclockwise from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Triangles {
    pub(crate) vertices: Vec<Vertex>,
    pub(crate) indices: Vec<u32>,
}

impl Triangles {
    /// Adds a corner without a glued picture, and returns its index.
    fn vertex(&mut self, position: [f32; 3], normal: [f32; 3]) -> u32 {
        self.vertices.push(Vertex { position, normal, texcoord: [0.0; 2] });
        self.vertices.len() as u32 - 1
    }

    /// Adds the rectangle of four corners, counterclockwise from outside, cut from the second to the fourth: where light
    /// is computed at corners, the cut is seen, and there OpenGL has it.
    fn rectangle(&mut self, [a, b, c, d]: [u32; 4]) {
        self.indices.extend([a, b, d, b, c, d]);
    }

    /// Adds a triangle that shares no corner with others, so that it is flat, unless it has no place.
    fn flat(&mut self, corners: [[f32; 3]; 3], texcoords: [[f32; 2]; 3]) {
        let Some(normal) = face_normal(corners) else { return };
        for (position, texcoord) in corners.into_iter().zip(texcoords) {
            self.indices.push(self.vertices.len() as u32);
            self.vertices.push(Vertex { position, normal, texcoord: texcoord.map(finite_or_zero) });
        }
    }

    /// An error if so many corners, of `what`, are more than the graphics card can hold.
    fn check_room(what: impl FnOnce() -> String, vertices: usize, most: usize) -> Result<()> {
        if vertices <= most.min(u32::MAX as usize) {
            return Ok(());
        }
        Err(Error::Unsupported(format!(
            "{} has {vertices} corners of triangles to draw, and there is room for {most}",
            what()
        )))
    }
}

/// The unit normal of a triangle; that of the z-axis if it is a line or a point; none unless its corners are finite.
fn face_normal(corners: [[f32; 3]; 3]) -> Option<[f32; 3]> {
    if !corners.as_flattened().iter().all(|coordinate| coordinate.is_finite()) {
        return None;
    }
    // In double precision, in which the products of large and of small edges are numbers still.
    let edge = |to: usize| [0, 1, 2].map(|axis| f64::from(corners[to][axis]) - f64::from(corners[0][axis]));
    let (u, v) = (edge(1), edge(2));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    Some(unit(normal))
}

/// A vector of length one along another; along z if that has no direction.
fn unit(vector: [f64; 3]) -> [f32; 3] {
    let length = vector.iter().map(|component| component * component).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        vector.map(|component| (component / length) as f32)
    } else {
        [0.0, 0.0, 1.0]
    }
}

fn finite_or_zero(number: f32) -> f32 {
    if number.is_finite() { number } else { 0.0 }
}

#[cfg(test)]
mod check;
