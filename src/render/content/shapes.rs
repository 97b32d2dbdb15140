//! The shapes that a picture is made of.

use super::Surface;
use crate::id::{HeightFieldId, MeshId};
use crate::model::Model;
use crate::render::settings::{Settings, is_drawable};
use crate::render::shape::{self, Detail, SkinSurface, Triangles, Vertex};
use crate::render::{Gpu, Lighting, RenderError};
use crate::scene::Scene;

/// The round shapes, each in several levels of detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Round {
    Sphere,
    Hemisphere,
    /// Of a cylinder.
    Side,
    /// Of a cylinder that is much longer than wide.
    LongSide,
    Disk,
    Cone,
}

const ROUND: [Round; 6] = [Round::Sphere, Round::Hemisphere, Round::Side, Round::LongSide, Round::Disk, Round::Cone];

/// How round a shape is to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    /// For colours: the first is what the model asks for, the others have fewer corners.
    Seen(usize),
    /// For depths and numbers, whatever the model asks for: one of [`FINE`].
    Measured(usize),
}

/// How many levels of detail there are for colours.
pub(crate) const LEVELS: usize = 3;

/// At most into how many slices the shapes of each of these levels are cut.
const SLICES: [u32; LEVELS] = [Detail::MOST, 14, 8];

/// Into how many slices shapes are cut that are measured.
pub(crate) const FINE: [u32; 4] = [32, 64, 128, Detail::MOST];

/// The engine cuts an infinite plane into so many cells in each direction, and no plane into more.
const MOST_CELLS: u32 = 200;

/// So many are enough for the precision of depth, where light is not computed at their corners.
const ENOUGH_CELLS: u32 = 64;

/// A plane of the model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) shape: u32,
    /// Half its length and width, m; how far it is drawn where it has no end.
    pub(crate) half: [f32; 2],
}

/// All shapes.
#[derive(Debug)]
pub(crate) struct Shapes {
    surfaces: Vec<Surface>,
    planes: Vec<Plane>,
    /// How far a plane without end is drawn that is none of the model's.
    endless: Plane,
    /// The first of the round shapes that are measured, once something was.
    fine: Option<u32>,
    plane: u32,
    cuboid: u32,
    line: u32,
    meshes: u32,
    nmesh: u32,
    fields: u32,
    nfield: u32,
    skins: u32,
    skin_surfaces: Vec<SkinSurface>,
    corners: Vec<Vertex>,
    most: usize,
}

impl Shapes {
    pub(crate) fn new(gpu: &Gpu, model: &Model, settings: &Settings, lighting: Lighting) -> Result<Self, RenderError> {
        let most = (gpu.limits().max_buffer_size / size_of::<Vertex>() as u64) as usize;
        let detail = Detail::of_model(model);
        let mut shapes = Self {
            surfaces: Vec::new(),
            planes: Vec::new(),
            endless: Plane { shape: 0, half: [0.0; 2] },
            fine: None,
            plane: 0,
            cuboid: 0,
            line: 0,
            meshes: 0,
            nmesh: model.nmesh() as u32,
            fields: 0,
            nfield: model.nhfield() as u32,
            skins: 0,
            skin_surfaces: Vec::new(),
            corners: Vec::new(),
            most,
        };
        for shape in ROUND {
            for slices in SLICES {
                shapes.push(gpu, &round(shape, detail.with_slices(slices), lighting))?;
            }
        }
        shapes.plane = shapes.push(gpu, &shape::plane(detail.quads))?;
        shapes.cuboid = shapes.push(gpu, &shape::cuboid(detail.quads))?;
        shapes.line = shapes.push(gpu, &line())?;
        shapes.add_planes(gpu, model, settings, lighting)?;
        shapes.meshes = shapes.surfaces.len() as u32;
        for mesh in model.meshes() {
            shapes.push(gpu, &shape::mesh(model, mesh.id(), most)?)?;
            shapes.push(gpu, &shape::hull(model, mesh.id(), most)?)?;
        }
        shapes.fields = shapes.surfaces.len() as u32;
        for field in model.height_fields() {
            shapes.push(gpu, &shape::height_field(model, field.id(), most)?)?;
        }
        shapes.skins = shapes.surfaces.len() as u32;
        for skin in model.skins() {
            let surface = shape::skin(model, skin.id(), most)?;
            shapes.surfaces.push(Surface::moving(gpu, surface.vertices, &surface.indices)?);
            shapes.skin_surfaces.push(surface);
        }
        Ok(shapes)
    }

    /// Makes the round shapes that are measured, unless they are there.
    pub(crate) fn refine(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        if self.fine.is_some() {
            return Ok(());
        }
        let first = self.surfaces.len();
        for shape in ROUND {
            for slices in FINE {
                if let Err(error) = self.push(gpu, &measured(shape, slices)) {
                    self.surfaces.truncate(first);
                    return Err(error);
                }
            }
        }
        self.fine = Some(first as u32);
        Ok(())
    }

    fn push(&mut self, gpu: &Gpu, triangles: &Triangles) -> Result<u32, RenderError> {
        self.surfaces.push(Surface::new(gpu, triangles)?);
        Ok(self.surfaces.len() as u32 - 1)
    }

    fn add_planes(
        &mut self,
        gpu: &Gpu,
        model: &Model,
        settings: &Settings,
        lighting: Lighting,
    ) -> Result<(), RenderError> {
        let cells = |cells: u32| if lighting == Lighting::PerVertex { cells } else { cells.min(ENOUGH_CELLS) };
        let mut made: Vec<(u32, u32)> = Vec::new();
        let mut shape = |shapes: &mut Self, count: u32| {
            if let Some(&(_, shape)) = made.iter().find(|(cells, _)| *cells == count) {
                return Ok(shape);
            }
            shapes.surfaces.push(Surface::tiled(gpu, count)?);
            let shape = shapes.surfaces.len() as u32 - 1;
            made.push((count, shape));
            Ok::<u32, RenderError>(shape)
        };
        self.endless = Plane { shape: shape(self, cells(MOST_CELLS))?, half: [endless(settings, 0.0); 2] };
        for geom in model.geoms().filter(|geom| geom.geom_type() == crate::GeomType::Plane) {
            let [x, y, spacing] = geom.size().map(|length| length as f32);
            let repeat = geom.material().map_or([0.0; 2], |material| *model.material(material).texrepeat());
            let lengths = [x, y];
            let mut most = 1;
            let half = [0, 1].map(|axis| {
                if lengths[axis] > 0.0 {
                    let spacing = spacing.max(lengths[axis] / (MOST_CELLS as f32 - 2.0));
                    most = most.max(((lengths[axis] / spacing) as u32).saturating_add(2).min(MOST_CELLS));
                    lengths[axis]
                } else {
                    most = MOST_CELLS;
                    endless(settings, repeat[axis])
                }
            });
            let shape = shape(self, cells(most))?;
            self.planes.push(Plane { shape, half });
        }
        Ok(())
    }

    /// Makes the shapes of a mesh anew.
    pub(crate) fn update_mesh(&mut self, gpu: &Gpu, model: &Model, id: MeshId) -> Result<(), RenderError> {
        let index = self.meshes as usize + 2 * id.index();
        let mesh = Surface::new(gpu, &shape::mesh(model, id, self.most)?)?;
        let hull = Surface::new(gpu, &shape::hull(model, id, self.most)?)?;
        (self.surfaces[index], self.surfaces[index + 1]) = (mesh, hull);
        Ok(())
    }

    /// Makes the shape of a height field anew.
    pub(crate) fn update_height_field(
        &mut self,
        gpu: &Gpu,
        model: &Model,
        id: HeightFieldId,
    ) -> Result<(), RenderError> {
        let surface = Surface::new(gpu, &shape::height_field(model, id, self.most)?)?;
        self.surfaces[self.fields as usize + id.index()] = surface;
        Ok(())
    }

    /// Writes where the skins of a scene are.
    pub(crate) fn update_skins(&mut self, gpu: &Gpu, scene: &Scene) {
        for (index, skin) in scene.skins().enumerate() {
            let Some(surface) = self.skin_surfaces.get(index) else { break };
            let drawable = |vector: [f32; 3]| vector.map(|number| if is_drawable(number) { number } else { 0.0 });
            self.corners.clear();
            self.corners.extend(skin.vertices.iter().zip(skin.normals).zip(&surface.texcoords).map(
                |((&position, &normal), &texcoord)| Vertex {
                    position: drawable(position),
                    normal: drawable(normal),
                    texcoord,
                },
            ));
            let buffer = &self.surfaces[self.skins as usize + index].vertices;
            let bytes: &[u8] = bytemuck::cast_slice(&self.corners);
            if bytes.len() as u64 <= buffer.size() {
                gpu.queue().write_buffer(buffer, 0, bytes);
            }
        }
    }

    pub(crate) fn surface(&self, shape: u32) -> &Surface {
        &self.surfaces[shape as usize]
    }

    /// A round shape. Until those that are measured [were made](Self::refine), what the model asks for stands for them.
    pub(crate) fn round(&self, shape: Round, level: Level) -> u32 {
        let of =
            |first: u32, levels: usize, level: usize| first + (shape as usize * levels + level.min(levels - 1)) as u32;
        match (level, self.fine) {
            (Level::Seen(level), _) => of(0, LEVELS, level),
            (Level::Measured(level), Some(fine)) => of(fine, FINE.len(), level),
            (Level::Measured(_), None) => of(0, LEVELS, 0),
        }
    }

    /// The plane of the model of a number; a square if there is none.
    pub(crate) fn plane(&self, number: Option<usize>) -> Option<Plane> {
        self.planes.get(number?).copied()
    }

    /// A plane without end that is none of the model's.
    pub(crate) fn endless(&self) -> Plane {
        self.endless
    }

    pub(crate) fn square(&self) -> u32 {
        self.plane
    }

    pub(crate) fn cuboid(&self) -> u32 {
        self.cuboid
    }

    pub(crate) fn line(&self) -> u32 {
        self.line
    }

    pub(crate) fn mesh(&self, mesh: usize, is_hull: bool) -> Option<u32> {
        (mesh < self.nmesh as usize).then(|| self.meshes + 2 * mesh as u32 + u32::from(is_hull))
    }

    pub(crate) fn height_field(&self, field: usize) -> Option<u32> {
        (field < self.nfield as usize).then(|| self.fields + field as u32)
    }

    pub(crate) fn skin(&self, skin: usize) -> Option<u32> {
        (skin < self.skin_surfaces.len()).then(|| self.skins + skin as u32)
    }
}

/// Half the length of a plane without end: beyond the sky, and by two patterns more.
fn endless(settings: &Settings, repeat: f32) -> f32 {
    let sky = 2.1 * settings.far;
    let pattern =
        if repeat > 0.0 && repeat.is_finite() { 2.0 / f64::from(repeat) } else { sky / (f64::from(MOST_CELLS) - 2.0) };
    let half = 0.5 * (sky + 2.0 * pattern);
    if is_drawable(half as f32) { half as f32 } else { 0.0 }
}

fn round(shape: Round, detail: Detail, lighting: Lighting) -> Triangles {
    let Detail { slices, stacks, .. } = detail;
    let few = if lighting == Lighting::PerVertex { stacks } else { 2 };
    match shape {
        Round::Sphere => shape::sphere(detail),
        Round::Hemisphere => shape::hemisphere(detail),
        Round::Side => shape::cylinder(slices, few),
        Round::LongSide => shape::cylinder(slices, stacks),
        Round::Disk => shape::disk(slices, (few / 2).max(1)),
        Round::Cone => shape::cone(slices, stacks),
    }
}

/// A round shape for measurements. Its pieces are as high as wide where it is bent in two directions; elsewhere they may be long, for no
/// light is computed at their corners.
fn measured(shape: Round, slices: u32) -> Triangles {
    match shape {
        Round::Sphere => shape::sphere(Detail { slices, stacks: slices / 2, quads: 1 }),
        Round::Hemisphere => shape::hemisphere(Detail { slices, stacks: slices / 2, quads: 1 }),
        Round::Side => shape::cylinder(slices, 2),
        Round::LongSide => shape::cylinder(slices, 16),
        Round::Disk => shape::disk(slices, 1),
        Round::Cone => shape::cone(slices, 1),
    }
}

/// The rectangle that a line is made of.
fn line() -> Triangles {
    let corner = |along: f32, across: f32| Vertex {
        position: [along, across, 0.0],
        normal: [0.0, 0.0, 1.0],
        texcoord: [0.0; 2],
    };
    Triangles {
        vertices: vec![corner(0.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(0.0, 1.0)],
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}
