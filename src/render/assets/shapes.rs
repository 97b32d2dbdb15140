//! The unit shapes, and the model's planes, meshes, height fields, skins and flexes.

use std::sync::Arc;

use super::level_of_detail::{COLOR_LEVELS, DEPTH_LEVELS, DetailLevel, RoundShape};
use super::plane::{Axis, Plane};
use super::shape_buffers::ShapeBuffers;
use super::skin::Skin;
use crate::id::{HeightFieldId, MeshId};
use crate::model::Model;
use crate::render::settings::VisualSettings;
use crate::render::{Gpu, Lighting, RenderError};
use crate::scene::{Scene, SceneGeom, SceneGeomType};
use crate::shape::{self, MESH_LEVELS, Tessellation, Triangles, Vertex};

/// First skin, above the other shapes of models at their full level of detail.
const FIRST_SKIN: u32 = 1 << 20;

/// First coarser level of a mesh, above the skins.
const FIRST_MESH_LEVEL: u32 = 1 << 21;

/// First of the round shapes for depth images, above the shapes of models.
const FIRST_DEPTH_LEVEL: u32 = 1 << 22;

/// Shape of the first geom with a flex, above all other shapes.
const FIRST_FLEX: u32 = 1 << 23;

/// GPU buffers of all shapes. A shape is identified by its index.
#[derive(Debug)]
pub(crate) struct Shapes {
    buffers: Vec<ShapeBuffers>,
    planes: Vec<Plane>,
    /// Infinite plane for geoms that are not from the model.
    infinite_plane: Plane,
    /// Round shapes for depth images, from the first depth image on.
    depth_levels: Option<Arc<[ShapeBuffers]>>,
    square: u32,
    cuboid: u32,
    line: u32,
    triangle: u32,
    /// Shapes with the same surface as the first shapes, and as few triangles as possible.
    unlit: Vec<u32>,
    /// First mesh; each mesh is followed by its convex hull.
    meshes: u32,
    /// Coarser levels of each mesh, from fine to coarse.
    mesh_levels: Vec<Vec<MeshLevel>>,
    height_fields: u32,
    nhfield: u32,
    skins: Vec<Skin>,
    /// Geoms with a flex in the last scene: the flex and the first of its faces that the geom
    /// shows, and the buffers of the faces and of the edges and vertices.
    flexes: Vec<([usize; 2], [ShapeBuffers; 2])>,
    tessellation: Tessellation,
    max_vertices: usize,
}

impl Shapes {
    pub(crate) fn new(
        gpu: &Gpu,
        model: &Model,
        settings: &VisualSettings,
        lighting: Lighting,
    ) -> Result<Self, RenderError> {
        let max_vertices = (gpu.limits().max_buffer_size / size_of::<Vertex>() as u64) as usize;
        let tessellation = Tessellation::of_model(model);
        let mut shapes = Self {
            buffers: Vec::new(),
            planes: Vec::new(),
            infinite_plane: Plane::default(),
            depth_levels: None,
            square: 0,
            cuboid: 0,
            line: 0,
            triangle: 0,
            unlit: Vec::new(),
            meshes: 0,
            mesh_levels: Vec::new(),
            height_fields: 0,
            nhfield: model.nhfield() as u32,
            tessellation,
            skins: Vec::new(),
            flexes: Vec::new(),
            max_vertices,
        };
        for shape in RoundShape::ALL {
            for triangles in shape.color_levels(tessellation, lighting) {
                shapes.push(gpu, &triangles)?;
            }
        }
        shapes.square = shapes.push(gpu, &shape::plane(tessellation.quads))?;
        shapes.cuboid = shapes.push(gpu, &shape::cuboid(tessellation.quads))?;
        shapes.line = shapes.push(gpu, &line())?;
        shapes.triangle = shapes.push(gpu, &shape::triangle())?;
        shapes.unlit = (0..=shapes.cuboid).collect();
        for shape in RoundShape::ALL {
            for (level, triangles) in shape.unlit_levels(tessellation).into_iter().flatten().enumerate() {
                let lit = shapes.round(shape, DetailLevel::Color(level));
                shapes.unlit[lit as usize] = shapes.push(gpu, &triangles)?;
            }
        }
        shapes.unlit[shapes.cuboid as usize] = shapes.push(gpu, &shape::cuboid(1))?;
        shapes.add_planes(gpu, model, settings, lighting)?;
        shapes.meshes = shapes.buffers.len() as u32;
        for mesh in model.meshes() {
            let triangles = shape::mesh(model, mesh.id(), max_vertices)?;
            shapes.push(gpu, &triangles)?;
            shapes.push(gpu, &shape::hull(model, mesh.id(), max_vertices)?)?;
            shapes.mesh_levels.push(MeshLevel::all(gpu, &triangles)?);
        }
        shapes.height_fields = shapes.buffers.len() as u32;
        for field in model.height_fields() {
            shapes.push(gpu, &shape::height_field(model, field.id(), max_vertices)?)?;
        }
        for skin in model.skins() {
            shapes.skins.push(Skin::new(gpu, model, skin.id(), max_vertices)?);
        }
        Ok(shapes)
    }

    /// Creates the round shapes for depth images, unless they exist.
    pub(crate) fn create_depth_levels(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        if self.depth_levels.is_none() {
            self.depth_levels = Some(gpu.depth_levels().get(gpu)?);
        }
        Ok(())
    }

    fn push(&mut self, gpu: &Gpu, triangles: &Triangles) -> Result<u32, RenderError> {
        self.buffers.push(ShapeBuffers::new(gpu, triangles)?);
        Ok(self.buffers.len() as u32 - 1)
    }

    fn add_planes(
        &mut self,
        gpu: &Gpu,
        model: &Model,
        settings: &VisualSettings,
        lighting: Lighting,
    ) -> Result<(), RenderError> {
        // Planes with the same grid share their buffers.
        let mut created: Vec<([Vec<f32>; 2], u32)> = Vec::new();
        let mut plane = |shapes: &mut Self, axes: [Axis; 2]| {
            let half = [axes[0].half, axes[1].half];
            let lines = axes.map(|axis| axis.limited(lighting).lines);
            let existing = created.iter().find(|(existing, _)| *existing == lines).map(|(_, shape)| *shape);
            let shape = if let Some(shape) = existing {
                shape
            } else {
                shapes.buffers.push(ShapeBuffers::tiled(gpu, [&lines[0], &lines[1]])?);
                let shape = shapes.buffers.len() as u32 - 1;
                created.push((lines, shape));
                shape
            };
            Ok::<Plane, RenderError>(Plane { shape, half })
        };
        self.infinite_plane = plane(self, [0, 1].map(|_| Axis::infinite(settings, 0.0)))?;
        for geom in model.geoms().filter(|geom| geom.geom_type() == crate::enums::GeomType::Plane) {
            let [x, y, spacing] = *geom.size();
            let repeat = geom.material().map_or([0.0; 2], |material| *model.material(material).texrepeat());
            let axis = |half: f64, repeat: f32| {
                if half > 0.0 { Axis::finite(half, spacing) } else { Axis::infinite(settings, repeat) }
            };
            let plane = plane(self, [axis(x, repeat[0]), axis(y, repeat[1])])?;
            self.planes.push(plane);
        }
        Ok(())
    }

    /// Replaces the buffers of a mesh and of its convex hull.
    pub(crate) fn update_mesh(&mut self, gpu: &Gpu, model: &Model, id: MeshId) -> Result<(), RenderError> {
        let index = self.meshes as usize + 2 * id.index();
        let triangles = shape::mesh(model, id, self.max_vertices)?;
        let mesh = ShapeBuffers::new(gpu, &triangles)?;
        let hull = ShapeBuffers::new(gpu, &shape::hull(model, id, self.max_vertices)?)?;
        let levels = MeshLevel::all(gpu, &triangles)?;
        (self.buffers[index], self.buffers[index + 1], self.mesh_levels[id.index()]) = (mesh, hull, levels);
        Ok(())
    }

    /// Replaces the buffers of a height field.
    pub(crate) fn update_height_field(
        &mut self,
        gpu: &Gpu,
        model: &Model,
        id: HeightFieldId,
    ) -> Result<(), RenderError> {
        let buffers = ShapeBuffers::new(gpu, &shape::height_field(model, id, self.max_vertices)?)?;
        self.buffers[self.height_fields as usize + id.index()] = buffers;
        Ok(())
    }

    /// Writes the skins of a scene as seen in the image with these
    /// [`ViewFrustum::pixel_rows`](crate::render::view::ViewFrustum::pixel_rows).
    pub(crate) fn update_skins(&mut self, gpu: &Gpu, scene: &Scene, pixel_rows: &[[f32; 4]; 3]) {
        for (skin, seen) in self.skins.iter_mut().zip(scene.skins()) {
            skin.update(gpu, seen.vertices, seen.normals, pixel_rows);
        }
    }

    /// Creates the buffers of the flexes of a scene. Their number of faces may change from scene to
    /// scene.
    pub(crate) fn update_flexes(&mut self, gpu: &Gpu, scene: &Scene) -> Result<(), RenderError> {
        self.flexes.clear();
        for geom in scene.geoms().filter(|geom| geom.geom_type() == SceneGeomType::Flex) {
            let Some(flex) = geom.flex().and_then(|flex| scene.flexes().nth(flex)) else { continue };
            let faces = geom.flex_faces().unwrap_or(0..flex.faces.len());
            let key = [flex.flex, faces.start];
            let faces = ShapeBuffers::new(gpu, &shape::flex_faces(&flex, faces))?;
            let skeleton = ShapeBuffers::new(gpu, &shape::flex_skeleton(&flex, geom.size()[0], self.tessellation))?;
            self.flexes.push((key, [faces, skeleton]));
        }
        Ok(())
    }

    pub(crate) fn buffers(&self, shape: u32) -> &ShapeBuffers {
        if let Some(flex) = shape.checked_sub(FIRST_FLEX) {
            return &self.flexes[flex as usize / 2].1[flex as usize % 2];
        }
        if let (Some(level), Some(levels)) = (shape.checked_sub(FIRST_DEPTH_LEVEL), &self.depth_levels) {
            return &levels[level as usize];
        }
        if let Some(level) = shape.checked_sub(FIRST_MESH_LEVEL) {
            let level = level as usize;
            return &self.mesh_levels[level / MESH_LEVELS][level % MESH_LEVELS].buffers;
        }
        if let Some(skin) = shape.checked_sub(FIRST_SKIN) {
            return &self.skins[skin as usize].buffers;
        }
        &self.buffers[shape as usize]
    }

    /// Returns the shapes of a geom with a flex: its faces, and its edges and vertices.
    pub(crate) fn flex(&self, geom: SceneGeom<'_>) -> [Option<u32>; 2] {
        let index = geom.flex().and_then(|flex| {
            let key = [flex, geom.flex_faces().map_or(0, |faces| faces.start)];
            self.flexes.iter().position(|(known, _)| *known == key)
        });
        [0, 1].map(|part| index.map(|index| FIRST_FLEX + 2 * index as u32 + part))
    }

    /// Returns a round shape. Before [`create_depth_levels`](Self::create_depth_levels), depth
    /// levels fall back to the model's tessellation.
    pub(crate) fn round(&self, shape: RoundShape, level: DetailLevel) -> u32 {
        let at =
            |first: u32, levels: usize, level: usize| first + (shape as usize * levels + level.min(levels - 1)) as u32;
        match (level, &self.depth_levels) {
            (DetailLevel::Color(level), _) => at(0, COLOR_LEVELS, level),
            (DetailLevel::Depth(level), Some(_)) => at(FIRST_DEPTH_LEVEL, DEPTH_LEVELS.len(), level),
            (DetailLevel::Depth(_), None) => at(0, COLOR_LEVELS, 0),
        }
    }

    /// Returns a shape with the same surface for a pass without lighting, which needs no vertices
    /// on straight surfaces.
    pub(crate) fn unlit(&self, shape: u32) -> u32 {
        self.unlit.get(shape as usize).copied().unwrap_or(shape)
    }

    /// Returns a plane of the model by its index among the model's planes.
    pub(crate) fn plane(&self, index: Option<usize>) -> Option<Plane> {
        self.planes.get(index?).copied()
    }

    /// Returns the infinite plane for geoms that are not from the model.
    pub(crate) fn infinite_plane(&self) -> Plane {
        self.infinite_plane
    }

    pub(crate) fn square(&self) -> u32 {
        self.square
    }

    pub(crate) fn cuboid(&self) -> u32 {
        self.cuboid
    }

    pub(crate) fn line(&self) -> u32 {
        self.line
    }

    /// Returns the triangle of the origin and the ends of the unit vectors along x and y.
    pub(crate) fn triangle(&self) -> u32 {
        self.triangle
    }

    /// Returns a mesh, which may merge vertices up to a distance along each axis, m.
    pub(crate) fn mesh(&self, mesh: usize, tolerance: f32) -> Option<u32> {
        let levels = self.mesh_levels.get(mesh)?;
        Some(match levels.iter().rposition(|level| level.cell <= tolerance) {
            Some(level) => FIRST_MESH_LEVEL + (MESH_LEVELS * mesh + level) as u32,
            None => self.meshes + 2 * mesh as u32,
        })
    }

    /// Returns the convex hull of a mesh.
    pub(crate) fn hull(&self, mesh: usize) -> Option<u32> {
        (mesh < self.mesh_levels.len()).then(|| self.meshes + 2 * mesh as u32 + 1)
    }

    pub(crate) fn height_field(&self, field: usize) -> Option<u32> {
        (field < self.nhfield as usize).then(|| self.height_fields + field as u32)
    }

    pub(crate) fn skin(&self, skin: usize) -> Option<u32> {
        (skin < self.skins.len()).then(|| FIRST_SKIN + skin as u32)
    }
}

/// Coarser level of a mesh.
#[derive(Debug)]
struct MeshLevel {
    /// Largest distance between vertices that are merged, along an axis, m.
    cell: f32,
    buffers: ShapeBuffers,
}

impl MeshLevel {
    /// Creates all coarser levels of a mesh.
    fn all(gpu: &Gpu, mesh: &Triangles) -> Result<Vec<Self>, RenderError> {
        let levels = shape::coarse_levels(mesh).into_iter();
        levels.map(|(cell, triangles)| Ok(Self { cell, buffers: ShapeBuffers::new(gpu, &triangles)? })).collect()
    }
}

/// Generates the rectangle of a line. x is the position along the line, y the position across it.
fn line() -> Triangles {
    let vertex = |along: f32, across: f32| Vertex {
        position: [along, across, 0.0],
        normal: [0.0, 0.0, 1.0],
        texcoord: [0.0; 2],
        parity: 0.0,
    };
    Triangles {
        vertices: vec![vertex(0.0, -1.0), vertex(1.0, -1.0), vertex(1.0, 1.0), vertex(0.0, 1.0)],
        indices: vec![0, 1, 2, 0, 2, 3],
        has_quads: false,
    }
}
