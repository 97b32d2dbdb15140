//! Shaders that draw several images at once, each to its own part of a texture. They are made from
//! the shaders of one image.

use crate::render::view::UniformData;

/// Returns the number of vectors in an element of an array of views that the shader does not
/// declare otherwise.
pub(super) fn unread_vectors(vectors: Option<u32>, lights: usize, shadows: usize) -> usize {
    let [view, light, shadow] = UniformData::VECTORS;
    vectors.map_or(0, |vectors| vectors as usize - view - lights * light - shadows * shadow)
}

/// Makes a shader of one view read the views of all images: instances and fragments have the index
/// of their image. Nothing is drawn outside of the part of an image, because vertices have the
/// distances from its edges.
pub(super) fn of_single_view(source: &str) -> String {
    let (head, tail) = source.split_once("struct Varyings {\n").expect("Bug: a shader without varyings");
    let (varyings, tail) = tail.split_once("\n}\n").expect("Bug: varyings without an end");
    let varyings = format!("{varyings}\n    @location(15) @interpolate(flat) view: u32,");
    let index = if tail.contains("instance: Instance") { "instance.view" } else { "image" };
    let tail = tail
        .replace(
            ") -> Varyings {\n    var out: Varyings;\n",
            &format!(") -> Placed {{\n    var out: Placed;\n    view_index = {index};\n    out.view = view_index;\n"),
        )
        .replace(
            "    return out;\n",
            "    out.edges = edge_distances(out.position);\n    out.position = placed(out.position);\n    return out;\n",
        );
    // Fragments do not receive the distances.
    let source = format!(
        "enable clip_distances;\n{head}struct Varyings {{\n{varyings}\n}}\n\
         struct Placed {{\n    @builtin(clip_distances) edges: array<f32, 4>,\n{varyings}\n}}\n{tail}"
    );
    let fragment = "fn fs_main(in: Varyings)";
    let source = match source.split_once(fragment) {
        Some((before, after)) => {
            let (signature, body) = after.split_once("{\n").expect("Bug: a function without a body");
            format!("{before}{fragment}{signature}{{\n    view_index = in.view;\n{body}")
        }
        None => source,
    };
    source.replace("view.", "views[view_index].")
}
