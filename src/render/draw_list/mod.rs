//! Draw list: the geoms of a scene as batches of instances, in the order of their draw calls.
//!
//! A scene may contain arbitrary values, because users add geoms and models are not validated.
//! Geoms with values that cannot be rendered are skipped.

mod instance;
mod level_of_detail;
mod merge;
mod mirror;
mod nearest_depth;
mod primitive;
mod shadow_caster;
mod texture_map;

use std::collections::HashMap;

use self::instance::Appearance;
pub(crate) use self::instance::{Batch, BatchKey, Instance, MirrorSide, Visibility};
use self::level_of_detail::Detail;
pub(crate) use self::merge::merge;
pub(crate) use self::mirror::Mirror;
use self::nearest_depth::nearest_depth;
use self::primitive::Part;
use self::shadow_caster::ShadowCasters;
use super::assets::{Shapes, Textures};
use super::bounding_volume::{AssetBounds, BoundingVolume, is_rotation, signed_distance, sorting_radius};
use super::settings::{ALL_FACES_CAST_SHADOWS, is_drawable};
use super::view::{Lights, ViewFrustum};
use crate::scene::{RenderFlags, Scene, SceneGeom, SceneGeomType};

/// Instances, and the batches of them that are drawn, of one image or of several.
#[derive(Debug, Default)]
pub(crate) struct DrawCalls {
    pub(crate) instances: Vec<Instance>,
    /// Batches of the reflective geom.
    pub(crate) reflector: Vec<Batch>,
    pub(crate) opaque: Vec<Batch>,
    pub(crate) transparent: Vec<Batch>,
    /// Number of the transparent batches in front-to-back order, which come first. The others are
    /// back to front.
    pub(crate) front_to_back: usize,
    /// Batches that mark the mirror in the stencil buffer.
    pub(crate) marks: Vec<Batch>,
}

/// Draw list of a scene. The memory is reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct DrawList {
    pub(crate) calls: DrawCalls,
    pub(crate) mirror: Option<Mirror>,
    /// First infinite plane.
    pub(crate) horizon: Option<Horizon>,
    /// Bounds of the casters in each shadow map, in the clip space of the light; `None` if it has
    /// no casters.
    pub(crate) shadow_bounds: Vec<Option<[[f64; 2]; 2]>>,
    /// Lower bound of the depths of visible surfaces, m.
    pub(crate) nearest_depth: f64,
    pending: Vec<PendingInstance>,
    /// Sort keys and indices of pending opaque instances.
    opaque_order: Vec<(u64, u32)>,
    /// Distances and index ranges of pending transparent instances.
    transparent_order: Vec<(f32, u32, u32)>,
    parts: Vec<Part>,
    /// Number of opaque geoms with a pose, by a hash of the pose.
    poses: HashMap<u64, u64>,
}

/// Infinite plane, which forms the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Horizon {
    pub(crate) pos: [f32; 3],
    pub(crate) mat: [f32; 9],
    pub(crate) is_opaque: bool,
}

/// Instance before sorting.
#[derive(Debug, Clone, Copy)]
struct PendingInstance {
    key: BatchKey,
    visibility: Visibility,
    instance: Instance,
}

/// Inputs of [`DrawList::update`].
pub(crate) struct DrawListInputs<'a> {
    pub(crate) frustum: &'a ViewFrustum,
    pub(crate) lights: &'a Lights,
    pub(crate) shapes: &'a Shapes,
    pub(crate) textures: &'a Textures,
    pub(crate) bounds: &'a AssetBounds,
    /// Auxiliary output instead of a lit colour image. It has no transparency and no mirror.
    pub(crate) aux: Option<AuxOutput>,
}

/// Auxiliary output of the renderer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AuxOutput {
    /// Segmentation with a distinct colour for each geom.
    SegmentColors,
    /// Segmentation with the geom's id encoded as a colour.
    IdColors,
    /// Segmentation with geom ids.
    Ids,
    /// Depth. Transparent geoms are skipped.
    Depth,
    /// Depth of the opaque geoms, and then ids of all geoms: the list keeps transparent geoms
    /// apart.
    DepthAndIds,
}

impl AuxOutput {
    /// Returns `true` if the depth must be precise.
    pub(crate) fn has_depth(self) -> bool {
        // The edges of geoms are the same in depth and segmentation images.
        matches!(self, Self::Ids | Self::Depth | Self::DepthAndIds)
    }
}

impl DrawList {
    /// Rebuilds the draw list for a scene.
    pub(crate) fn update(&mut self, scene: &Scene, inputs: &DrawListInputs<'_>) {
        self.clear();
        let (frustum, flags) = (inputs.frustum, scene.render_flags());
        let camera = frustum.position.map(|coordinate| coordinate as f32);
        let reflector = self.find_reflector(scene, inputs, camera);
        let planes = frustum.planes();
        let mirror_planes = self.mirror.as_ref().map(|mirror| frustum.mirrored(&mirror.reflection).planes());
        let culls_front_faces = !ALL_FACES_CAST_SHADOWS && flags.contains(RenderFlags::CULL_FACE);
        let mut casters = ShadowCasters::new(inputs.lights, culls_front_faces, planes);
        let mut reflector_instances = 0;
        let mut is_before_materials = true;
        for (index, geom) in scene.geoms().enumerate() {
            if !is_valid(geom) {
                continue;
            }
            let is_behind = is_camera_behind(geom, camera);
            let is_transparent = match inputs.aux {
                None | Some(AuxOutput::DepthAndIds) => is_transparent(geom, is_behind),
                Some(AuxOutput::Depth) if is_transparent(geom, is_behind) => continue,
                Some(_) => false,
            };
            let volume = inputs.bounds.volume(scene, geom);
            if volume == BoundingVolume::Empty {
                continue;
            }
            if self.horizon.is_none() && is_infinite_plane(geom) {
                let is_opaque = !is_transparent && !flags.contains(RenderFlags::WIREFRAME);
                self.horizon = Some(Horizon { pos: geom.pos(), mat: geom.mat(), is_opaque });
            }
            let is_line = matches!(geom.geom_type(), SceneGeomType::Line | SceneGeomType::LineBox);
            let is_plane = geom.geom_type() == SceneGeomType::Plane;
            let mut visibility = self.visibility(&volume, &planes, mirror_planes.as_ref());
            if visibility.in_frustum {
                self.nearest_depth = self.nearest_depth.min(nearest_depth(geom, &volume, frustum));
            }
            if !is_line && geom.casts_shadow() {
                let hides_back = || !is_transparent && hides_back(geom, scene, inputs);
                visibility.shadow_mask = casters.add(geom, &volume, visibility.in_frustum, hides_back);
            }
            self.parts.clear();
            let detail = if inputs.aux.is_none() && flags.contains(RenderFlags::WIREFRAME) {
                Detail::FULL
            } else {
                Detail::new(geom, &volume, frustum, inputs.aux)
            };
            is_before_materials &= is_transparent || geom.material().is_none();
            primitive::parts(geom, inputs.shapes, detail, is_before_materials, &mut self.parts);
            let appearance = Appearance::new(index, geom, inputs, is_behind);
            let first = self.pending.len() as u32;
            let is_two_sided = geom.geom_type() == SceneGeomType::Triangle && flags.contains(RenderFlags::CULL_FACE);
            for part in &self.parts {
                let (key, instance) = appearance.instance(geom, part, is_line, is_behind && is_plane);
                self.pending.push(PendingInstance { key, visibility, instance });
                if is_two_sided {
                    let (key, instance) = appearance.instance(geom, part, is_line, true);
                    self.pending.push(PendingInstance { key, visibility, instance });
                }
            }
            let last = self.pending.len() as u32;
            if is_transparent {
                let distance = [0, 1, 2].map(|axis| geom.pos()[axis] - camera[axis]);
                let distance = distance.iter().map(|part| part * part).sum::<f32>().sqrt() - sorting_radius(geom);
                let distance = if is_plane { 1e10 } else { distance };
                self.transparent_order.push((distance, first, last));
            } else if reflector == Some(index) {
                reflector_instances = last - first;
                self.opaque_order.extend((first..last).map(|pending| (REFLECTOR_SORT_KEY, pending)));
            } else {
                let rank = self.rank(geom);
                let key = |pending: u32| sort_key(&self.pending[pending as usize], is_plane, rank);
                self.opaque_order.extend((first..last).map(|pending| (key(pending), pending)));
            }
        }
        self.shadow_bounds = casters.into_bounds();
        self.sort(reflector_instances);
    }

    fn clear(&mut self) {
        self.calls.clear();
        self.pending.clear();
        self.opaque_order.clear();
        self.transparent_order.clear();
        self.poses.clear();
        (self.mirror, self.horizon) = (None, None);
        self.nearest_depth = f64::INFINITY;
    }

    /// Finds the reflector: the first opaque plane or box with reflectance. It is drawn separately
    /// even if mirror images are disabled.
    fn find_reflector(&mut self, scene: &Scene, inputs: &DrawListInputs<'_>, camera: [f32; 3]) -> Option<usize> {
        if inputs.aux.is_some() {
            return None;
        }
        let (index, geom) = scene.geoms().enumerate().find(|&(_, geom)| {
            matches!(geom.geom_type(), SceneGeomType::Plane | SceneGeomType::Box)
                && geom.reflectance() > 0.0
                && is_valid(geom)
                && !is_transparent(geom, is_camera_behind(geom, camera))
        })?;
        if scene.render_flags().contains(RenderFlags::REFLECTION) {
            self.mirror = Mirror::new(geom, camera, inputs.shapes);
        }
        Some(index)
    }

    /// Counts the opaque geoms with the pose of a geom so far. Their surfaces may coincide, and the
    /// last one is visible, as in the engine's images. Another pose with the same hash only makes
    /// the order stricter.
    fn rank(&mut self, geom: SceneGeom<'_>) -> u64 {
        let hash = |hash: u64, number: f32| {
            // Zeros of both signs are one pose.
            let bits = u64::from((number + 0.0).to_bits());
            (hash.rotate_left(5) ^ bits).wrapping_mul(0x9E37_79B9_7F4A_7C15) // 2⁶⁴ by the golden ratio
        };
        let pose = geom.mat().into_iter().fold(geom.pos().into_iter().fold(0, hash), hash);
        let count = self.poses.entry(pose).or_insert(0);
        *count += 1;
        *count - 1
    }

    /// Computes the visibility of a bounding volume in the frustum and in the mirror.
    fn visibility(
        &self,
        volume: &BoundingVolume,
        planes: &[[f32; 4]; 6],
        mirror_planes: Option<&[[f32; 4]; 6]>,
    ) -> Visibility {
        let BoundingVolume::Sphere(sphere) = volume else {
            return Visibility { in_frustum: true, mirror_side: MirrorSide::Across, shadow_mask: 0 };
        };
        // NaN distances cull nothing.
        let is_inside =
            |planes: &[[f32; 4]; 6]| !planes.iter().any(|plane| signed_distance(sphere.centre, plane) < -sphere.radius);
        let mirror_side = match (&self.mirror, mirror_planes) {
            (Some(mirror), Some(planes)) if is_inside(planes) => {
                let distance = signed_distance(sphere.centre, &mirror.plane);
                if distance > sphere.radius {
                    MirrorSide::InFront
                } else if distance < -sphere.radius {
                    MirrorSide::Behind
                } else {
                    MirrorSide::Across
                }
            }
            _ => MirrorSide::Behind,
        };
        Visibility { in_frustum: is_inside(planes), mirror_side, shadow_mask: 0 }
    }

    /// Sorts the pending instances and forms batches: the reflector, opaque geoms by batch key,
    /// transparent geoms by distance.
    fn sort(&mut self, reflector_instances: u32) {
        let Self { calls, pending, opaque_order, transparent_order, .. } = self;
        opaque_order.sort_unstable();
        for (number, &(order, index)) in opaque_order.iter().enumerate() {
            let DrawCalls { instances, reflector, opaque, .. } = calls;
            let batches = if number < reflector_instances as usize { reflector } else { opaque };
            let PendingInstance { key, visibility, instance } = pending[index as usize];
            push(batches, instances, (key, visibility, order), instance);
        }
        transparent_order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut add = |batches: &mut Vec<Batch>, &(_, first, last): &(f32, u32, u32)| {
            for &PendingInstance { key, visibility, instance } in &pending[first as usize..last as usize] {
                push(batches, &mut calls.instances, (key, visibility, 0), instance);
            }
        };
        let mut back_to_front = Vec::new();
        for range in &*transparent_order {
            add(&mut calls.transparent, range);
        }
        for range in transparent_order.iter().rev() {
            add(&mut back_to_front, range);
        }
        calls.front_to_back = calls.transparent.len();
        calls.transparent.append(&mut back_to_front);
        if let Some((shape, instance)) = self.mirror.as_ref().and_then(|mirror| mirror.stencil_mark) {
            push(&mut calls.marks, &mut calls.instances, (BatchKey::untextured(shape), Visibility::MARK, 0), instance);
        }
    }
}

impl DrawCalls {
    fn clear(&mut self) {
        self.instances.clear();
        for batches in [&mut self.reflector, &mut self.opaque, &mut self.transparent, &mut self.marks] {
            batches.clear();
        }
        self.front_to_back = 0;
    }
}

/// Appends an instance, to the last batch if its key, visibility and order are equal.
fn push(
    batches: &mut Vec<Batch>,
    instances: &mut Vec<Instance>,
    (key, visibility, order): (BatchKey, Visibility, u64),
    instance: Instance,
) {
    let index = instances.len() as u32;
    instances.push(instance);
    match batches.last_mut() {
        Some(batch) if (batch.key, batch.visibility, batch.order) == (key, visibility, order) => {
            batch.instances.end = index + 1;
        }
        _ => batches.push(Batch { key, visibility, order, instances: index..index + 1 }),
    }
}

/// Sort key of the reflector, less than all others.
const REFLECTOR_SORT_KEY: u64 = 0;

/// Computes the sort key of an opaque instance. Instances with equal keys become one batch. Planes
/// are last, because much of them is hidden. Up to eight geoms with the same pose have the order of
/// the scene.
fn sort_key(pending: &PendingInstance, is_plane: bool, rank: u64) -> u64 {
    let BatchKey { shape, texture_kind, texture, line, back_faces, unshadowed } = pending.key;
    let Visibility { in_frustum, mirror_side, shadow_mask } = pending.visibility;
    let flags = [line, back_faces, !in_frustum, unshadowed]
        .iter()
        .fold(mirror_side as u64, |flags, &flag| flags << 1 | u64::from(flag));
    let texture = (texture_kind as u64) << 32 | u64::from(texture & 0xFFFF) << 16;
    1 << 63
        | u64::from(is_plane) << 62
        | rank.min(7) << 59
        | u64::from(shadow_mask) << 51
        | u64::from(shape >> 16 & 0xFF) << 43
        | flags << 37
        | texture
        | u64::from(shape & 0xFFFF)
}

/// Returns `true` if the pose, the size and the opacity of a geom can be rendered.
fn is_valid(geom: SceneGeom<'_>) -> bool {
    let (pos, mat, size) = (geom.pos(), geom.mat(), geom.size());
    pos.iter().chain(&mat).chain(&size).all(|&number| is_drawable(number)) && !geom.rgba()[3].is_nan()
}

/// Returns `true` if the camera is at negative z in the local frame of a geom.
fn is_camera_behind(geom: SceneGeom<'_>, camera: [f32; 3]) -> bool {
    let (pos, mat) = (geom.pos(), geom.mat());
    let height: f32 = (0..3).map(|axis| (camera[axis] - pos[axis]) * mat[3 * axis + 2]).sum();
    height < 0.0
}

/// Returns `true` if a geom is transparent, as is a plane seen from behind.
fn is_transparent(geom: SceneGeom<'_>, is_camera_behind: bool) -> bool {
    geom.rgba()[3] < 0.995 || geom.geom_type() == SceneGeomType::Plane && is_camera_behind
}

/// Returns `true` if an opaque geom hides every part of the scene that is on its -z side: a plane
/// with the camera on its +z side, which the near plane does not cut, and beside whose drawn
/// rectangle nothing on the -z side is seen. Mirrors may show it, but images in mirrors have no
/// shadows.
fn hides_back(geom: SceneGeom<'_>, scene: &Scene, inputs: &DrawListInputs<'_>) -> bool {
    let frustum = inputs.frustum;
    let is_plane = |geom: SceneGeom<'_>| geom.geom_type() == SceneGeomType::Plane;
    let sees_through = frustum.orthographic || scene.render_flags().contains(RenderFlags::WIREFRAME);
    // Users can give a geom a matrix that is no rotation.
    if sees_through || !is_plane(geom) || !is_rotation(&geom.mat()) {
        return false;
    }
    let (pos, mat) = (geom.pos().map(f64::from), geom.mat().map(f64::from));
    // Coordinates of a point in the frame of the plane.
    let local = |point: [f64; 3]| {
        let offset = [0, 1, 2].map(|axis| point[axis] - pos[axis]);
        [0, 1, 2].map(|axis| (0..3).map(|row| mat[3 * row + axis] * offset[row]).sum::<f64>())
    };
    let is_cut = frustum.nearest_depth_of_plane(pos, [mat[2], mat[5], mat[8]]) <= frustum.range[0];
    let camera = local(frustum.position);
    if is_cut || camera[2] <= 0.0 {
        return false;
    }
    let half = primitive::half_lengths(geom, inputs.shapes).map(f64::from);
    let covers = |[x, y]: [f64; 2], radius: f64| x.abs() + radius <= half[0] && y.abs() + radius <= half[1];
    let is_hidden = |other: SceneGeom<'_>| match inputs.bounds.volume(scene, other) {
        BoundingVolume::Sphere(sphere) => {
            let ([x, y, z], radius) = (local(sphere.centre.map(f64::from)), f64::from(sphere.radius));
            let depth = radius - z;
            // The line of sight to a point behind the plane crosses the plane between the foot of
            // the point and that of the camera, at most this part of the way.
            let part = depth / (depth + camera[2]);
            let crossed = [x + part * (camera[0] - x), y + part * (camera[1] - y)];
            depth <= 0.0 || covers([x, y], radius) && covers(crossed, (1.0 - part) * radius)
        }
        BoundingVolume::Unbounded => false,
        BoundingVolume::Empty => true,
    };
    // A plane with the same pose is not behind this one.
    let is_coplanar = |other: SceneGeom<'_>| is_plane(other) && other.pos() == geom.pos() && other.mat() == geom.mat();
    scene.geoms().all(|other| is_coplanar(other) || is_hidden(other))
}

/// Returns `true` if a geom is a plane that is infinite in both directions.
fn is_infinite_plane(geom: SceneGeom<'_>) -> bool {
    geom.geom_type() == SceneGeomType::Plane && geom.size()[0] == 0.0 && geom.size()[1] == 0.0
}

#[cfg(test)]
mod tests {
    use super::{DrawListInputs, hides_back};
    use crate::render::assets::{Shapes, Textures};
    use crate::render::bounding_volume::AssetBounds;
    use crate::render::settings::VisualSettings;
    use crate::render::view::{Lights, ViewFrustum};
    use crate::render::{Gpu, Lighting};
    use crate::scene::{Camera, CameraView, Categories, NewGeom, RenderFlags, Scene, SceneGeomType, SceneOptions};
    use crate::{Data, Model};

    /// Returns whether a plane hides its back from a camera at this elevation, degrees, 2 m from
    /// the origin, with other geoms and the flags. A plane of the size "scaled 0.5" is one of the
    /// user, with half of the unit matrix.
    fn hides(gpu: &Gpu, [size, near, others]: [&str; 3], elevation: f64, flags: RenderFlags) -> bool {
        let scale = size.strip_prefix("scaled ").map(|scale| scale.parse::<f64>().unwrap());
        let plane = if scale.is_some() { String::new() } else { format!("<geom type='plane' size='{size}'/>") };
        let xml = format!(
            "<mujoco><statistic extent='1'/><visual><map znear='{near}' zfar='20'/></visual>
             <worldbody>{plane}{others}</worldbody></mujoco>"
        );
        let mut data = Data::new(Model::from_xml_str(&xml).unwrap()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 10).unwrap();
        let view = CameraView::Free;
        let mut camera = Camera { view, lookat: [0.0; 3], distance: 2.0, azimuth: 10.0, elevation };
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        scene.set_render_flags(flags);
        if let Some(s) = scale {
            let plane = NewGeom::plane([5.0; 2]).with_mat([s, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, s]);
            scene.add_geom(&plane).unwrap();
        }
        let model = data.model();
        let settings = VisualSettings::new(model);
        let inputs = DrawListInputs {
            frustum: &ViewFrustum::new(&scene, &scene.viewpoint(), [64; 2]).unwrap(),
            lights: &Lights::default(),
            shapes: &Shapes::new(gpu, model, &settings, Lighting::PerVertex).unwrap(),
            textures: &Textures::new(gpu, model),
            bounds: &AssetBounds::new(model),
            aux: None,
        };
        let plane = scene.geoms().find(|geom| geom.geom_type() == SceneGeomType::Plane).unwrap();
        hides_back(plane, &scene, &inputs)
    }

    #[test]
    fn a_plane_hides_its_back_only_if_nothing_there_can_be_seen() {
        let gpu = Gpu::new().unwrap();
        let infinite = ["0 0 .1", ".01", "<geom size='.1' pos='3 0 -1'/>"];
        let none = RenderFlags::empty();
        assert!(hides(&gpu, infinite, -30.0, none));
        assert!(!hides(&gpu, infinite, 0.0, none), "the camera is in the plane");
        assert!(!hides(&gpu, infinite, 30.0, none), "the camera is behind it");
        assert!(!hides(&gpu, infinite, -30.0, RenderFlags::WIREFRAME), "seen between lines");
        let changed = |index: usize, text| {
            let mut changed = infinite;
            changed[index] = text;
            hides(&gpu, changed, -30.0, none)
        };
        // The camera is at (-1.7, -0.3, 1) m. The sphere ends at x = 3.1 m, 1.1 m below the plane,
        // and the line of sight to its lowest point crosses the plane at x = 0.5 m.
        assert!(changed(0, "5 0 .1") && changed(0, "3.2 2 .1"));
        assert!(!changed(0, "3 2 .1") && !changed(0, "3 0 .1"), "the foot of the ball is beside it");
        assert!(!changed(0, "1 1 .1"), "so is the camera");
        assert!(changed(0, "scaled 1") && !changed(0, "scaled 0.5"), "drawn with half of its size");
        assert!(changed(2, "<geom size='.1' pos='-.5 0 -1'/>"));
        let small = ["1 1 .1", ".01", "<geom size='.1' pos='-.5 0 -1'/>"];
        assert!(!hides(&gpu, small, -30.0, none), "seen before its edge");
        assert!(!changed(1, "1.5"), "seen where the near plane cuts it");
        assert!(!changed(2, "<geom size='.1' pos='40 0 -1'/>"), "beside the square that is drawn");
        assert!(!changed(2, "<geom type='plane' size='0 0 .1' pos='0 0 -1'/>"), "another infinite plane");
        assert!(changed(2, "<geom size='.1' pos='40 0 1'/>"));
    }
}
