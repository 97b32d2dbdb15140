//! A mesh, or its convex hull.

use super::Part;
use crate::render::content::Shapes;
use crate::scene::SceneGeom;

pub(super) fn part(geom: SceneGeom<'_>, shapes: &Shapes) -> Option<Part> {
    let (mesh, is_hull) = geom.mesh()?;
    Some(Part::new(shapes.mesh(mesh.index(), is_hull)?, [1.0; 3]))
}
