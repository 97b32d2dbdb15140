//! What the graphics card keeps of each shape: its corners, in the shape's own frame.

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
