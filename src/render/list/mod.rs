//! What is drawn: the geoms of a scene as shapes in places, in the order in which they are drawn.
//!
//! | file | what is in it |
//! |---|---|
//! | `instance.rs` | a shape in its place; instances that are drawn at once |
//! | `primitive/` | the shapes of each primitive |
//! | `look.rs` | colour, material and picture of a geom |
//! | `mirror.rs` | the one geom that mirrors the others |
//! | `caster.rs` | what casts shadows, and what part of a shadow map it is drawn to |
//! | `ids.rs` | colours for geoms by their numbers |
//!
//! Everything in a scene can be any number, for users add geoms and models are not checked: a geom with a number that nothing can
//! be drawn with is left out.

mod caster;
mod ids;
mod instance;
mod look;
mod mirror;
mod primitive;

use self::caster::Casters;
pub(crate) use self::instance::{Batch, Instance, Kind, Place, Side};
pub(crate) use self::mirror::Mirror;
use self::primitive::Part;
use super::bound::{Bounds, Reach, height, sorting_radius};
use super::content::{FINE, LEVELS, Level, Shapes, Textures};
use super::frame::{Eye, Lights};
use super::settings::is_drawable;
use super::shape::Detail;
use crate::scene::{RenderFlags, Scene, SceneGeom, SceneGeomType};

/// What is drawn of a scene. Kept from picture to picture for its memory.
#[derive(Debug, Default)]
pub(crate) struct List {
    /// All instances: of the mirror itself, of what is solid, and of what is transparent, front to back and then back to front.
    pub(crate) instances: Vec<Instance>,
    pub(crate) reflector: Vec<Batch>,
    pub(crate) solid: Vec<Batch>,
    pub(crate) clear: Vec<Batch>,
    /// How many of the batches of what is transparent are front to back.
    pub(crate) clear_once: usize,
    pub(crate) mirror: Option<Mirror>,
    /// The first plane without end: where its middle is, and its axes.
    pub(crate) horizon: Option<Horizon>,
    /// What of each shadow map is drawn to, in the coordinates of the cube that the light sees.
    pub(crate) casters: Vec<Option<[[f64; 2]; 2]>>,
    drafts: Vec<Draft>,
    order: Vec<(u64, u32)>,
    parts: Vec<Part>,
    transparent: Vec<(f32, u32, u32)>,
}

/// A plane without end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Horizon {
    pub(crate) pos: [f32; 3],
    pub(crate) mat: [f32; 9],
    /// Whether nothing is seen through it.
    pub(crate) is_opaque: bool,
}

/// An instance whose place in the order is not known yet.
#[derive(Debug, Clone, Copy)]
struct Draft {
    kind: Kind,
    place: Place,
    instance: Instance,
}

/// From where and with what a list is made.
pub(crate) struct Scenery<'a> {
    pub(crate) eye: &'a Eye,
    pub(crate) lights: &'a Lights,
    pub(crate) shapes: &'a Shapes,
    pub(crate) textures: &'a Textures,
    pub(crate) bounds: &'a Bounds,
    /// What is asked for is a picture of numbers, to which nothing is transparent and nothing mirrors.
    pub(crate) numbers: Option<Numbers>,
}

/// What a picture of numbers shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Numbers {
    /// Geoms, in their own colours that have nothing to do with them.
    Colors,
    /// Geoms, in the colours of their numbers.
    IdColors,
    /// Numbers of geoms.
    Ids,
    /// Depths. What is transparent has none.
    Depths,
}

impl List {
    /// Makes the list of a scene.
    pub(crate) fn update(&mut self, scene: &Scene, scenery: &Scenery<'_>) {
        self.clear();
        let (eye, flags) = (scenery.eye, scene.render_flags());
        let head = eye.head.map(|coordinate| coordinate as f32);
        let culls = flags.contains(RenderFlags::CULL_FACE);
        let reflector = self.find_mirror(scene, scenery, head);
        let planes = eye.planes();
        let mirror_planes = self.mirror.as_ref().map(|mirror| eye.mirrored(&mirror.matrix).planes());
        let mut casters = Casters::new(scenery.lights, culls, planes);
        let mut reflectors = 0;
        for (index, geom) in scene.geoms().enumerate() {
            if !is_there(geom) {
                continue;
            }
            let (is_behind, is_clear) = transparency(geom, head);
            let is_clear = match scenery.numbers {
                None => is_clear,
                Some(Numbers::Depths) if is_clear => continue,
                Some(_) => false,
            };
            let reach = scenery.bounds.reach(geom);
            if reach == Reach::Nowhere {
                continue;
            }
            if self.horizon.is_none() && is_endless(geom) {
                self.horizon = Some(Horizon { pos: geom.pos(), mat: geom.mat(), is_opaque: !is_clear });
            }
            let is_line = geom.geom_type() == SceneGeomType::Line;
            let mut place = self.place(&reach, &planes, mirror_planes.as_ref());
            if !is_line {
                place.casts = casters.add(geom, &reach, place.seen);
            }
            self.parts.clear();
            let level = level(geom, &reach, eye, scenery.numbers);
            primitive::parts(geom, scenery.shapes, level, &mut self.parts);
            let look = look::look(index, geom, scenery, is_behind);
            let first = self.drafts.len() as u32;
            for part in &self.parts {
                let (kind, instance) =
                    look.of(geom, part, is_line, is_behind && geom.geom_type() == SceneGeomType::Plane);
                self.drafts.push(Draft { kind, place, instance });
            }
            let last = self.drafts.len() as u32;
            if is_clear {
                let distance = [0, 1, 2].map(|axis| geom.pos()[axis] - head[axis]);
                let distance = distance.iter().map(|part| part * part).sum::<f32>().sqrt() - sorting_radius(geom);
                let distance = if geom.geom_type() == SceneGeomType::Plane { 1e10 } else { distance };
                self.transparent.push((distance, first, last));
            } else if reflector == Some(index) {
                reflectors = last - first;
                for draft in first..last {
                    self.order.push((0, draft));
                }
            } else {
                for draft in first..last {
                    self.order.push((key(&self.drafts[draft as usize]), draft));
                }
            }
        }
        self.casters = casters.finish();
        self.arrange(reflectors);
    }

    fn clear(&mut self) {
        self.instances.clear();
        self.drafts.clear();
        self.order.clear();
        self.transparent.clear();
        self.reflector.clear();
        self.solid.clear();
        self.clear.clear();
        (self.mirror, self.horizon, self.clear_once) = (None, None, 0);
    }

    /// Finds the first geom that mirrors. It is drawn apart from the others even where its mirror images are not.
    fn find_mirror(&mut self, scene: &Scene, scenery: &Scenery<'_>, head: [f32; 3]) -> Option<usize> {
        if scenery.numbers.is_some() {
            return None;
        }
        let (index, geom) = scene.geoms().enumerate().find(|&(_, geom)| {
            matches!(geom.geom_type(), SceneGeomType::Plane | SceneGeomType::Box)
                && geom.reflectance() > 0.0
                && is_there(geom)
                && !transparency(geom, head).1
        })?;
        if scene.render_flags().contains(RenderFlags::REFLECTION) {
            self.mirror = Mirror::new(geom, head, scenery.shapes);
        }
        Some(index)
    }

    /// Where a geom is seen, if at all.
    fn place(&self, reach: &Reach, planes: &[[f32; 4]; 6], mirror_planes: Option<&[[f32; 4]; 6]>) -> Place {
        let Reach::Within(sphere) = reach else { return Place { seen: true, side: Side::Across, casts: 0 } };
        // A height that is no number hides nothing.
        let is_within =
            |planes: &[[f32; 4]; 6]| !planes.iter().any(|plane| height(sphere.centre, plane) < -sphere.radius);
        let side = match (&self.mirror, mirror_planes) {
            (Some(mirror), Some(planes)) if is_within(planes) => {
                let height = height(sphere.centre, &mirror.plane);
                if height > sphere.radius {
                    Side::Before
                } else if height < -sphere.radius {
                    Side::Behind
                } else {
                    Side::Across
                }
            }
            _ => Side::Behind,
        };
        Place { seen: is_within(planes), side, casts: 0 }
    }

    /// Puts the drafts in order: the mirror, what is solid by kinds, what is transparent by distance.
    fn arrange(&mut self, reflectors: u32) {
        let Self { instances, drafts, order, .. } = self;
        order.sort_unstable();
        for (number, &(_, draft)) in order.iter().enumerate() {
            let batches = if number < reflectors as usize { &mut self.reflector } else { &mut self.solid };
            push(batches, instances, &drafts[draft as usize]);
        }
        self.transparent.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(_, first, last) in &self.transparent {
            for draft in first..last {
                push(&mut self.clear, instances, &drafts[draft as usize]);
            }
        }
        self.clear_once = self.clear.len();
        let mut again = Vec::new();
        for &(_, first, last) in self.transparent.iter().rev() {
            for draft in first..last {
                push(&mut again, instances, &drafts[draft as usize]);
            }
        }
        self.clear.append(&mut again);
    }
}

/// Adds an instance, to the last batch if it is of its kind.
fn push(batches: &mut Vec<Batch>, instances: &mut Vec<Instance>, draft: &Draft) {
    let index = instances.len() as u32;
    instances.push(draft.instance);
    match batches.last_mut() {
        Some(batch) if batch.kind == draft.kind && batch.place == draft.place => batch.instances.end = index + 1,
        _ => batches.push(Batch { kind: draft.kind, place: draft.place, instances: index..index + 1 }),
    }
}

/// Instances with the same key are drawn at once. That of a mirror is 0.
fn key(draft: &Draft) -> u64 {
    let Kind { shape, coat, texture, line, back } = draft.kind;
    let Place { seen, side, casts } = draft.place;
    let flags = [line, back, !seen].iter().fold(side as u64, |flags, &flag| flags << 1 | u64::from(flag));
    let coated = (coat as u64) << 32 | u64::from(texture & 0xFFFF) << 16;
    1 << 63
        | u64::from(casts) << 54
        | u64::from(shape >> 16 & 0xFF) << 46
        | flags << 40
        | coated
        | u64::from(shape & 0xFFFF)
}

/// Whether a geom has a place, a shape, and numbers that can be drawn with.
fn is_there(geom: SceneGeom<'_>) -> bool {
    let (pos, mat, size) = (geom.pos(), geom.mat(), geom.size());
    pos.iter().chain(&mat).chain(&size).all(|&number| is_drawable(number)) && geom.rgba()[3] >= 0.0
}

/// Whether the eye is behind a geom, and whether it is transparent: a plane is from behind.
fn transparency(geom: SceneGeom<'_>, head: [f32; 3]) -> (bool, bool) {
    let (pos, mat) = (geom.pos(), geom.mat());
    let height: f32 = (0..3).map(|axis| (head[axis] - pos[axis]) * mat[3 * axis + 2]).sum();
    let is_behind = height < 0.0;
    (is_behind, geom.rgba()[3] < 0.995 || geom.geom_type() == SceneGeomType::Plane && is_behind)
}

/// Whether a geom is a plane without end in both directions.
fn is_endless(geom: SceneGeom<'_>) -> bool {
    geom.geom_type() == SceneGeomType::Plane && geom.size()[0] == 0.0 && geom.size()[1] == 0.0
}

/// How round a geom is to be: the fewer pixels it has, the fewer corners nobody misses, and the farther away it is, the fewer are
/// needed to measure it.
fn level(geom: SceneGeom<'_>, reach: &Reach, eye: &Eye, numbers: Option<Numbers>) -> Level {
    /// With radii of so many pixels the edges of the next level are within a fifth of a pixel of those of this one.
    const ENOUGH: [f64; LEVELS - 1] = [6.0, 2.5];
    /// How far from a geom its drawn surface may be, as a share of the distance. Under an angle of 15° this is 1/5000 of the depth.
    const PRECISION: f64 = 5e-5;
    let (Reach::Within(sphere), None | Some(Numbers::Depths | Numbers::Ids)) = (reach, numbers) else {
        return Level::Seen(0);
    };
    let [x, y, z] = geom.size();
    let radius = match geom.geom_type() {
        SceneGeomType::Sphere | SceneGeomType::Ellipsoid => x.max(y).max(z),
        _ => x.max(y),
    };
    let nearest = (eye.depth_of(sphere.centre) - f64::from(sphere.radius)).max(eye.range[0]);
    let share = eye.scale * f64::from(radius) / nearest;
    if numbers.is_some() {
        // Bent in two directions, at most.
        let is_enough = |&slices: &u32| 2.0 * Detail::chord_error(slices) * share <= PRECISION;
        return Level::Measured(FINE.iter().position(is_enough).unwrap_or(FINE.len() - 1));
    }
    Level::Seen(ENOUGH.iter().take_while(|&&enough| eye.pixels * share < enough).count())
}
