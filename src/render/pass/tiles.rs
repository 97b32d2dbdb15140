//! Visibility and level of detail of the tiles of a large plane.
//!
//! Lighting is computed at the vertices of a plane, as in the engine, so that the cells of a plane
//! must be small where lighting varies. Far from the lights and the camera it is almost linear in
//! each block of cells, and a tile is drawn with fewer triangles.

use std::ops::Range;

use crate::numerics::spatial::dot;
use crate::render::assets::Tile;
use crate::render::draw_list::{DrawCalls, Instance};
use crate::render::view::matrix::unit;
use crate::render::view::{ActiveLight, Lights};

/// Largest error of a colour by the interpolation of one light over a block of cells: one of 255
/// levels.
const TOLERANCE: f64 = 1.0 / 255.0;

/// View in which tiles are visible.
pub(crate) struct TileView<'a> {
    /// Planes of the view frustum.
    pub(crate) planes: [[f32; 4]; 6],
    pub(crate) detail: TileDetail<'a>,
}

/// Level of detail of tiles.
#[derive(Clone, Copy)]
pub(crate) enum TileDetail<'a> {
    /// All cells, which are visible in wireframe mode.
    Cells,
    /// Blocks of cells.
    Blocks,
    /// Cells where per-vertex lighting varies, otherwise blocks: the lights and the position of the
    /// camera.
    Lighting(&'a Lights, [f64; 3]),
}

/// Returns the index ranges of the tiles to draw, for consecutive instances of a plane of which the
/// same tiles are drawn.
pub(super) fn draws(
    views: &[TileView<'_>],
    tiles: &[Tile],
    calls: &DrawCalls,
    instances: Range<u32>,
) -> Vec<(Vec<Range<u32>>, Range<u32>)> {
    let mut draws: Vec<(Vec<Range<u32>>, Range<u32>)> = Vec::new();
    for index in instances {
        let instance = &calls.instances[index as usize];
        let ranges = views[instance.view as usize].ranges(tiles, instance);
        match draws.last_mut() {
            Some((last, instances)) if *last == ranges => instances.end += 1,
            _ => draws.push((ranges, index..index + 1)),
        }
    }
    draws
}

impl TileView<'_> {
    /// Returns the index ranges of the tiles inside the frustum, with adjacent ranges merged.
    fn ranges(&self, tiles: &[Tile], instance: &Instance) -> Vec<Range<u32>> {
        let mut ranges: Vec<Range<u32>> = Vec::new();
        let mut push = |next: &Range<u32>| match ranges.last_mut() {
            Some(last) if last.end == next.start => last.end = next.end,
            _ => ranges.push(next.clone()),
        };
        // The planes of the frustum, in the plane's own coordinates x and y.
        let edges = self.planes.map(|plane| {
            let along = |axis: usize| (0..3).map(|row| plane[row] * instance.rows[row][axis]).sum::<f32>();
            [along(0), along(1), along(3) + plane[3]]
        });
        let plane = PlacedPlane::new(instance);
        let visible: Vec<(&Tile, bool)> = tiles
            .iter()
            .filter(|tile| !is_outside(tile, &edges))
            .map(|tile| (tile, self.needs_cells(&plane.tile(tile), instance)))
            .collect();
        // The ranges of each level of detail are adjacent.
        visible.iter().filter(|(_, needs_cells)| *needs_cells).for_each(|(tile, _)| push(&tile.cells));
        visible.iter().filter(|(_, needs_cells)| !needs_cells).for_each(|(tile, _)| push(&tile.blocks));
        ranges
    }

    fn needs_cells(&self, tile: &PlacedTile, instance: &Instance) -> bool {
        match self.detail {
            TileDetail::Cells => true,
            TileDetail::Blocks => false,
            TileDetail::Lighting(lights, camera) => {
                lights.active.iter().any(|light| !tile.is_evenly_lit(light, camera, instance))
            }
        }
    }
}

/// Returns `true` if all corners of a tile are on the outer side of one of these lines: a line is
/// given by its factors of x and y, and a constant.
fn is_outside(tile: &Tile, lines: &[[f32; 3]; 6]) -> bool {
    let [low, high] = tile.bounds;
    let largest = |factor: f32, axis: usize| (factor * low[axis]).max(factor * high[axis]);
    lines.iter().any(|&[x, y, constant]| largest(x, 0) + largest(y, 1) + constant < 0.0)
}

/// Plane in world space.
struct PlacedPlane {
    /// Axes x and y, which are orthogonal, and the origin.
    axes: [[f64; 3]; 3],
    /// Squared lengths of the axes.
    squared: [f64; 2],
    normal: [f64; 3],
}

/// Tile in world space.
struct PlacedTile {
    centre: [f64; 3],
    radius: f64,
    normal: [f64; 3],
    /// Largest squared diagonal of a block.
    block: f64,
}

impl PlacedPlane {
    fn new(instance: &Instance) -> Self {
        let axes = [0, 1, 3].map(|column| instance.rows.map(|row| f64::from(row[column])));
        let normal = unit(instance.rows.map(|row| f64::from(row[2])));
        Self { axes, squared: [dot(&axes[0], &axes[0]), dot(&axes[1], &axes[1])], normal }
    }

    fn tile(&self, tile: &Tile) -> PlacedTile {
        let Self { axes: [x, y, origin], squared, normal } = self;
        let [low, high] = tile.bounds.map(|corner| corner.map(f64::from));
        let middle = [0, 1].map(|axis| low[axis].midpoint(high[axis]));
        let diagonal = |sides: [f64; 2]| squared[0] * sides[0] * sides[0] + squared[1] * sides[1] * sides[1];
        PlacedTile {
            centre: [0, 1, 2].map(|k| x[k] * middle[0] + y[k] * middle[1] + origin[k]),
            radius: 0.5 * diagonal([high[0] - low[0], high[1] - low[1]]).sqrt(),
            normal: *normal,
            block: diagonal(tile.block.map(f64::from)),
        }
    }
}

impl PlacedTile {
    /// Returns `true` if the light on each block of the tile is linear up to [`TOLERANCE`].
    ///
    /// The diffuse light of a source at the height h above the plane and at the distance s is h /
    /// s, whose second derivatives are at most 2 h / s³ in magnitude. A function with second
    /// derivatives up to m differs from its linear interpolation over a triangle by at most m r² /
    /// 2, where r is the radius of a circle that contains the triangle: half the diagonal of the
    /// block.
    fn is_evenly_lit(&self, active: &ActiveLight, camera: [f64; 3], instance: &Instance) -> bool {
        let (features, light) = (active.features, &active.light);
        let position = light.pos.map(f64::from);
        let offset = difference(position, self.centre);
        let nearest = dot(&offset, &offset).sqrt() - self.radius;
        let direction = unit(light.dir.map(f64::from));
        if !features.directional && nearest <= 0.0 {
            return false;
        }
        if features.spot && self.is_outside_cone(offset, direction, f64::from(light.cutoff).to_radians()) {
            return true;
        }
        if features.spot || features.attenuated {
            return false;
        }
        let height = dot(&offset, &self.normal);
        let brightest = |rgb: [f32; 3]| f64::from(rgb.into_iter().fold(0.0, f32::max));
        let [red, green, blue, _] = instance.rgba;
        let diffuse = brightest(light.diffuse) * brightest([red, green, blue]);
        let curvature = if features.directional { 0.0 } else { 2.0 * height.max(0.0) / nearest.powi(3) };
        if diffuse * curvature * self.block / 8.0 > TOLERANCE {
            return false;
        }
        let specular = brightest(light.specular) * f64::from(instance.material[1]);
        if specular <= TOLERANCE {
            return true;
        }
        // A highlight is visible where the angle between the normal and the half vector is at most
        // `widest`: where the light and the mirror image of the direction to the camera are at most
        // twice as far apart.
        let widest = (TOLERANCE / specular).powf(1.0 / f64::from(instance.material[2])).clamp(0.0, 1.0).acos();
        let to_camera = difference(camera, self.centre);
        let distance = dot(&to_camera, &to_camera).sqrt();
        let to_camera = unit(to_camera);
        let along = 2.0 * dot(&self.normal, &to_camera);
        let mirrored = [0, 1, 2].map(|axis| along * self.normal[axis] - to_camera[axis]);
        let to_light = if features.directional { direction.map(|part| -part) } else { unit(offset) };
        let angle = dot(&mirrored, &to_light).clamp(-1.0, 1.0).acos();
        // Half the angle under which a sphere of the radius of the tile appears.
        let seen_from = |distance: f64| (self.radius / distance).min(1.0).asin();
        let of_light = if features.directional { 0.0 } else { seen_from(nearest + self.radius) };
        angle - seen_from(distance) - of_light > 2.0 * widest
    }

    /// Returns `true` if a sphere around the tile is outside of the cone of a spotlight. `offset`
    /// is the position of the light relative to the centre of the tile.
    fn is_outside_cone(&self, offset: [f64; 3], direction: [f64; 3], half_angle: f64) -> bool {
        let along = -dot(&offset, &direction);
        let across = (dot(&offset, &offset) - along * along).max(0.0).sqrt();
        across * half_angle.cos() - along * half_angle.sin() > self.radius
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

#[cfg(test)]
mod tests {
    use super::{ActiveLight, PlacedPlane, PlacedTile, TOLERANCE, difference, dot, unit};
    use crate::render::assets::Tile;
    use crate::render::draw_list::Instance;
    use crate::render::view::LightFeatures;
    use crate::scene::SceneLight;

    const CELLS: usize = 10;

    /// Returns the tile of a plane with this position and a width of 4 m, as one block.
    fn tile([x, y]: [f32; 2]) -> (PlacedTile, Instance) {
        let rows = [[2.0, 0.0, 0.0, x], [0.0, 2.0, 0.0, y], [0.0, 0.0, 1.0, 0.5]];
        let instance = Instance {
            rows,
            rgba: [0.9, 0.5, 0.2, 1.0],
            material: [0.0, 0.5, 64.0],
            normal_scale: [0.25, 0.25, 1.0],
            texgen: [0.0; 4],
            texture_offset: [0.0; 3],
            id: 1,
            view: 0,
        };
        let tile = Tile { cells: 0..0, blocks: 0..0, block: [2.0; 2], bounds: [[-1.0; 2], [1.0; 2]] };
        (PlacedPlane::new(&instance).tile(&tile), instance)
    }

    fn light(pos: [f32; 3], dir: [f32; 3], directional: bool, cutoff: f32) -> ActiveLight {
        let light = SceneLight {
            pos,
            dir,
            attenuation: [1.0, 0.0, 0.0],
            cutoff,
            exponent: 0.0,
            ambient: [0.1; 3],
            diffuse: [0.8; 3],
            specular: [0.3; 3],
            headlight: false,
            directional,
            castshadow: false,
            drawn: true,
            shines_along_view: false,
        };
        let features = LightFeatures { directional, spot: cutoff <= 90.0, specular: true, ..LightFeatures::default() };
        ActiveLight { features, light, shadow: None }
    }

    /// Computes OpenGL's light at a point of the tile, where the material is brightest.
    fn brightness(active: &ActiveLight, camera: [f64; 3], instance: &Instance, point: [f64; 3]) -> f64 {
        let light = &active.light;
        let dir = unit(light.dir.map(f64::from));
        let to_light =
            if light.directional { dir.map(|part| -part) } else { unit(difference(light.pos.map(f64::from), point)) };
        if active.features.spot && -dot(&to_light, &dir) < f64::from(light.cutoff).to_radians().cos() {
            return 0.0;
        }
        let to_camera = unit(difference(camera, point));
        let half = unit([0, 1, 2].map(|axis| to_light[axis] + to_camera[axis]));
        let diffuse = f64::from(light.diffuse[0]) * to_light[2].max(0.0) + f64::from(light.ambient[0]);
        let highlight = if to_light[2] > 0.0 { half[2].max(0.0).powf(f64::from(instance.material[2])) } else { 0.0 };
        f64::from(instance.rgba[0]) * diffuse
            + f64::from(instance.material[1]) * f64::from(light.specular[0]) * highlight
    }

    #[test]
    fn interpolation_over_an_evenly_lit_tile_is_accurate() {
        let camera = [0.0, -3.0, 2.0];
        let mut evenly_lit = 0;
        for seed in 0..400_u32 {
            let number = |index: u32| ((seed * 7919 + index * 104_729) % 1009) as f32 / 1009.0;
            let (placed, instance) = tile([40.0 * number(0) - 20.0, 40.0 * number(1) - 20.0]);
            let pos = [30.0 * number(2) - 15.0, 30.0 * number(3) - 15.0, 8.0 * number(4)];
            let dir = [number(5) - 0.5, number(6) - 0.5, -number(7)];
            let cutoff = if seed % 2 == 0 { 180.0 } else { 10.0 + 60.0 * number(8) };
            let active = light(pos, dir, seed % 3 == 0, if seed % 3 == 0 { 180.0 } else { cutoff });
            if !placed.is_evenly_lit(&active, camera, &instance) {
                continue;
            }
            evenly_lit += 1;
            let at = |x: f64, y: f64| {
                let [low, high] = [-2.0, 2.0].map(|side| [0, 1].map(|axis| placed.centre[axis] + side));
                let point = [low[0] + x * (high[0] - low[0]), low[1] + y * (high[1] - low[1]), placed.centre[2]];
                brightness(&active, camera, &instance, point)
            };
            for (column, row) in (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| (column, row))) {
                let [x, y] = [column, row].map(|index| index as f64 / CELLS as f64);
                // The triangle below the diagonal from (0, 0) to (1, 1), or the one above.
                let interpolated = if x > y {
                    at(0.0, 0.0) + x * (at(1.0, 0.0) - at(0.0, 0.0)) + y * (at(1.0, 1.0) - at(1.0, 0.0))
                } else {
                    at(0.0, 0.0) + y * (at(0.0, 1.0) - at(0.0, 0.0)) + x * (at(1.0, 1.0) - at(0.0, 1.0))
                };
                let error = (interpolated - at(x, y)).abs();
                // The diffuse light and the highlight have this tolerance each.
                assert!(error <= 2.0 * TOLERANCE, "seed {seed}: {error} at {x}, {y}");
            }
        }
        assert!((50..350).contains(&evenly_lit), "{evenly_lit} of 400 tiles");
    }
}
