//! Meshes with their convex hulls, skins, height fields, textures and materials.

use std::ops::Range;

use mujoco_sys::{mjTEXTURE_2D, mjTEXTURE_SKYBOX};

use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{
    all_bytes, all_ids, all_ids_or_none, all_in, is, is_in, optional_partition, partition, piece, size_is,
};
use super::view::View;

/// Limit on the coordinates of vertices. The engine searches for the vertex that is farthest in a
/// direction, and takes -1 for its id if no product compares greater than -1e10.
const LARGEST_COORDINATE: f32 = 1e9;

/// Largest visualisation group of a skin. The visualiser of 2.2.2 uses the group of a skin as an
/// index without clamping it, unlike the groups of other elements.
const LAST_GROUP: i64 = mujoco_sys::mjNGROUP as i64 - 1;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    meshes(view)?;
    hulls(view)?;
    skins(view)?;
    height_fields(view)?;
    textures(view)?;
    #[cfg(engine_since = "3.5.0")]
    super::newer::check_bounding_volumes(view)?;
    all_ids_or_none(view, field::mat_texid, view.size(size::ntex))?;
    all_bytes(view, field::mat_texuniform, 1)
}

/// Checks vertices, texture coordinates and faces.
fn meshes(view: &View<'_>) -> Result<(), Invalid> {
    surfaces(view)?;
    for (i, value) in view.values(field::mesh_vert).enumerate() {
        if value.is_nan() || value.abs() > LARGEST_COORDINATE {
            let expected = format!("it must be within {LARGEST_COORDINATE} of zero");
            return Err(Invalid::element(field::mesh_vert.name(), i, value, expected));
        }
    }
    Ok(())
}

#[cfg(engine_since = "3.5.0")]
use super::newer::check_meshes as surfaces;

#[cfg(not(engine_since = "3.5.0"))]
fn surfaces(view: &View<'_>) -> Result<(), Invalid> {
    partition(view, field::mesh_vertadr, field::mesh_vertnum, 1, size::nmeshvert)?;
    optional_partition(view, field::mesh_texcoordadr, field::mesh_vertnum, size::nmeshtexvert)?;
    partition(view, field::mesh_faceadr, field::mesh_facenum, 0, size::nmeshface)?;
    for mesh in 0..view.size(size::nmesh) {
        let vertices = view.get(field::mesh_vertnum, mesh);
        faces(view, field::mesh_face, piece(view, field::mesh_faceadr, field::mesh_facenum, mesh), vertices)?;
    }
    Ok(())
}

/// Checks that the indices of the given faces refer to existing vertices.
fn faces(view: &View<'_>, index: Field<i32>, faces: Range<usize>, vertices: i32) -> Result<(), Invalid> {
    (3 * faces.start..3 * faces.end).try_for_each(|i| is_in(view, index, i, 0..=i64::from(vertices) - 1))
}

/// Checks the convex hulls of meshes, which the collision code traverses from vertex to
/// neighbouring vertex.
///
/// A hull is a run of ints in `mesh_graph`:
///
/// 1. the numbers of vertices *V* and faces *F*,
/// 2. for each vertex the start of its list of neighbours,
/// 3. for each vertex its id in the mesh,
/// 4. the lists, each terminated by -1: *V* + 3 *F* ints, because a closed triangulated surface has
///    3 *F* / 2 edges,
/// 5. the three vertices of each face.
fn hulls(view: &View<'_>) -> Result<(), Invalid> {
    let end = view.size(size::nmeshgraph);
    let mut next = 0;
    for mesh in 0..view.size(size::nmesh) {
        if view.get(field::mesh_graphadr, mesh) == -1 {
            continue;
        }
        is(view, field::mesh_graphadr, mesh, next as i64, "the end of the previous hull, or -1 for none")?;
        next = hull(view, mesh, next, end)?;
    }
    size_is(view, size::nmeshgraph, next as u64, "the sum over the hulls")
}

/// Checks the hull of a mesh and returns its end.
fn hull(view: &View<'_>, mesh: usize, start: usize, end: usize) -> Result<usize, Invalid> {
    let too_short = |length: i64| {
        let expected = format!("the hull of mesh {mesh} needs {length} from {start} on");
        Invalid::scalar(size::nmeshgraph.name(), end, expected)
    };
    if end - start < 2 {
        return Err(too_short(2));
    }
    let mesh_vertices = i64::from(view.get(field::mesh_vertnum, mesh));
    is_in(view, field::mesh_graph, start, 1..=mesh_vertices)?;
    is_in(view, field::mesh_graph, start + 1, 0..=i32::MAX.into())?;
    let vertices = i64::from(view.get(field::mesh_graph, start));
    let faces = i64::from(view.get(field::mesh_graph, start + 1));
    let lists = vertices + 3 * faces;
    let total = 2 + 2 * vertices + lists + 3 * faces;
    if total > (end - start) as i64 {
        return Err(too_short(total));
    }

    let mut at = start + 2;
    let mut check_run = |length: i64, range: std::ops::RangeInclusive<i64>| {
        let from = at;
        at += length as usize;
        (from..at).try_for_each(|i| is_in(view, field::mesh_graph, i, range.clone()))
    };
    check_run(vertices, 0..=lists - 1)?;
    check_run(vertices, 0..=mesh_vertices - 1)?;
    check_run(lists, -1..=vertices - 1)?;
    check_run(3 * faces, 0..=mesh_vertices - 1)?;
    // A terminator in the last place ends the last list inside the array.
    is(
        view,
        field::mesh_graph,
        start + (2 + 2 * vertices + lists - 1) as usize,
        -1,
        "the end of the last list of neighbours",
    )?;
    Ok(at)
}

/// Checks the surfaces of skins, and the bones that move their vertices.
fn skins(view: &View<'_>) -> Result<(), Invalid> {
    all_ids_or_none(view, field::skin_matid, view.size(size::nmat))?;
    if cfg!(not(engine_since = "3.5.0")) {
        all_in(view, field::skin_group, 0..=LAST_GROUP)?;
    }
    partition(view, field::skin_vertadr, field::skin_vertnum, 1, size::nskinvert)?;
    optional_partition(view, field::skin_texcoordadr, field::skin_vertnum, size::nskintexvert)?;
    partition(view, field::skin_faceadr, field::skin_facenum, 1, size::nskinface)?;
    partition(view, field::skin_boneadr, field::skin_bonenum, 1, size::nskinbone)?;
    partition(view, field::skin_bonevertadr, field::skin_bonevertnum, 1, size::nskinbonevert)?;
    all_ids(view, field::skin_bonebodyid, view.size(size::nbody))?;
    for skin in 0..view.size(size::nskin) {
        let vertices = view.get(field::skin_vertnum, skin);
        faces(view, field::skin_face, piece(view, field::skin_faceadr, field::skin_facenum, skin), vertices)?;
        for bone in piece(view, field::skin_boneadr, field::skin_bonenum, skin) {
            for i in piece(view, field::skin_bonevertadr, field::skin_bonevertnum, bone) {
                is_in(view, field::skin_bonevertid, i, 0..=i64::from(vertices) - 1)?;
            }
        }
    }
    Ok(())
}

fn height_fields(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::hfield_nrow, 1..=i32::MAX.into())?;
    all_in(view, field::hfield_ncol, 1..=i32::MAX.into())?;
    let mut next = 0_u64;
    for i in 0..view.size(size::nhfield) {
        is(view, field::hfield_adr, i, next as i64, "the end of the previous one")?;
        // Below 2^62. The address of the next height field is compared with the sum before anything
        // else is added to it.
        next += u64::from(view.get(field::hfield_nrow, i) as u32) * u64::from(view.get(field::hfield_ncol, i) as u32);
    }
    size_is(view, size::nhfielddata, next, "the sum of rows times columns")?;
    // The collision code divides positions by these sizes to get rows and columns.
    for (i, value) in view.values(field::hfield_size).enumerate() {
        if !(value.is_finite() && value > 0.0) {
            return Err(Invalid::element(field::hfield_size.name(), i, value, "it must be finite and positive"));
        }
    }
    Ok(())
}

fn textures(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::tex_type, 0..=mjTEXTURE_SKYBOX.into())?;
    all_in(view, field::tex_width, 1..=i32::MAX.into())?;
    all_in(view, field::tex_height, 1..=i32::MAX.into())?;
    #[cfg(engine_since = "3.5.0")]
    {
        all_in(view, field::tex_nchannel, 1..=4)?;
        all_in(view, field::tex_colorspace, 0..=mujoco_sys::mjCOLORSPACE_SRGB.into())?;
    }
    let mut next = 0_u128;
    for i in 0..view.size(size::ntex) {
        let (width, height) = (view.get(field::tex_width, i), view.get(field::tex_height, i));
        let is_flat = view.get(field::tex_type, i) as u32 == mjTEXTURE_2D;
        if !is_flat && height != width && i64::from(height) != 6 * i64::from(width) {
            let expected = format!("a cube of width {width} has one square image or six");
            return Err(Invalid::element(field::tex_height.name(), i, height, expected));
        }
        if i128::from(view.get(field::tex_adr, i)) != next as i128 {
            let adr = view.get(field::tex_adr, i);
            let expected = format!("it must be {next}, the end of the previous one");
            return Err(Invalid::element(field::tex_adr.name(), i, adr, expected));
        }
        // The sum is below 2^97: each summand has 66 bits, and a file has less than 2^31 textures.
        next += channels(view, i) * width as u128 * height as u128;
    }
    let why = "the bytes of all pixels";
    size_is(view, size::ntexdata, u64::try_from(next).unwrap_or(u64::MAX), why)
}

/// Returns the number of bytes of a pixel.
#[cfg(not(engine_since = "3.5.0"))]
fn channels(_: &View<'_>, _: usize) -> u128 {
    3
}

/// Returns the number of bytes of a pixel: 1 for grey, 3 for colours, 4 with opacity.
#[cfg(engine_since = "3.5.0")]
fn channels(view: &View<'_>, i: usize) -> u128 {
    view.get(field::tex_nchannel, i) as u128
}
