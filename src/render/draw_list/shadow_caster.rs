//! Culling of shadow casters, and the bounds of the casters in each shadow map. Only the bounded
//! region of a shadow map is allocated, because a full map has millions of texels.

use std::cell::LazyCell;

use crate::render::bounding_volume::{BoundingVolume, Sphere, signed_distance};
use crate::render::view::matrix::{Matrix4, row};
use crate::render::view::{ActiveLight, Lights};
use crate::scene::{SceneGeom, SceneGeomType, SceneLight};

/// Casters of all shadow-casting lights.
pub(super) struct ShadowCasters<'a> {
    lights: Vec<CasterBounds<'a>>,
    culls_front_faces: bool,
    /// Planes of the view frustum.
    planes: [[f32; 4]; 6],
}

/// Bounds of the casters of one light, in its clip space.
struct CasterBounds<'a> {
    light: &'a SceneLight,
    /// First, second and last row of the shadow projection.
    rows: [[f64; 4]; 3],
    /// Lengths of the rows without their last elements.
    lengths: [f64; 3],
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> ShadowCasters<'a> {
    /// Creates empty bounds. `culls_front_faces` states that only back faces are rendered to the
    /// shadow maps.
    pub(super) fn new(lights: &'a Lights, culls_front_faces: bool, planes: [[f32; 4]; 6]) -> Self {
        let bounds = |light: &'a ActiveLight| Some(CasterBounds::new(&light.light, light.shadow.as_ref()?));
        Self { lights: lights.active.iter().filter_map(bounds).collect(), culls_front_faces, planes }
    }

    /// Adds a geom. Returns the lights in which it casts a visible shadow, one bit per light.
    /// `hides_back` returns `true` if the geom hides everything on its -z side.
    pub(super) fn add(
        &mut self,
        geom: SceneGeom<'_>,
        volume: &BoundingVolume,
        in_frustum: bool,
        hides_back: impl Fn() -> bool,
    ) -> u8 {
        let mut shadow_mask = 0;
        let hides_back = LazyCell::new(hides_back);
        for (index, light) in self.lights.iter_mut().enumerate() {
            // With front faces culled, a plane that faces the light casts no shadow. Otherwise its
            // shadow may be out of sight.
            let is_plane = geom.geom_type() == SceneGeomType::Plane;
            let is_culled =
                is_plane && light.sees_front(geom) && (self.culls_front_faces || light.is_limited() && *hides_back);
            let casts = match volume {
                _ if is_culled => false,
                BoundingVolume::Sphere(sphere) => {
                    (in_frustum || !light.is_shadow_outside(sphere, &self.planes)) && light.add(sphere)
                }
                BoundingVolume::Unbounded => light.add_all(),
                BoundingVolume::Empty => false,
            };
            shadow_mask |= u8::from(casts) << index;
        }
        shadow_mask
    }

    /// Returns the bounds of each light, minimum and maximum; `None` if they are empty.
    pub(super) fn into_bounds(self) -> Vec<Option<[[f64; 2]; 2]>> {
        let clamped = |corner: [f64; 2]| corner.map(|coordinate| coordinate.clamp(-1.0, 1.0));
        let bounds = |light: CasterBounds<'_>| {
            let (low, high) = (clamped(light.low), clamped(light.high));
            (low[0] < high[0] && low[1] < high[1]).then_some([low, high])
        };
        self.lights.into_iter().map(bounds).collect()
    }
}

impl<'a> CasterBounds<'a> {
    fn new(light: &'a SceneLight, matrix: &Matrix4) -> Self {
        let rows = [row(matrix, 0), row(matrix, 1), row(matrix, 3)];
        let lengths = rows.map(|[x, y, z, _]| (x * x + y * y + z * z).sqrt());
        Self { light, rows, lengths, low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] }
    }

    /// Returns `true` if the light lights nothing behind it, where its shadow map has mirror images
    /// of the shadows.
    fn is_limited(&self) -> bool {
        self.light.directional || (0.0..=90.0).contains(&self.light.cutoff)
    }

    /// Returns `true` if the light is on the +z side of a geom.
    fn sees_front(&self, geom: SceneGeom<'_>) -> bool {
        let (pos, mat, light) = (geom.pos(), geom.mat(), self.light);
        let normal = [mat[2], mat[5], mat[8]];
        let toward =
            [0, 1, 2].map(|axis| if light.directional { -light.dir[axis] } else { light.pos[axis] - pos[axis] });
        normal.iter().zip(toward).map(|(a, b)| a * b).sum::<f32>() > 0.0
    }

    /// Returns `true` if the whole shadow of a sphere is outside of the view frustum: the sphere is
    /// outside of a plane of the frustum, and the light does not shine from the sphere towards this
    /// plane.
    fn is_shadow_outside(&self, sphere: &Sphere, planes: &[[f32; 4]; 6]) -> bool {
        let light = self.light;
        let along = |plane: &[f32; 4]| (0..3).map(|axis| plane[axis] * light.dir[axis]).sum::<f32>();
        planes.iter().any(|plane| {
            let nearest = signed_distance(sphere.centre, plane) + sphere.radius;
            let leads_away =
                if light.directional { along(plane) <= 0.0 } else { nearest <= signed_distance(light.pos, plane) };
            nearest < 0.0 && leads_away
        })
    }

    /// Adds the bounding rectangle of a projected sphere. Returns `true` if it intersects the
    /// shadow map.
    fn add(&mut self, sphere: &Sphere) -> bool {
        let [x, y, z] = sphere.centre.map(f64::from);
        let radius = f64::from(sphere.radius);
        let [across, up, w] = self.rows.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3]);
        let extents = self.lengths.map(|length| length * radius);
        let (near, far) = (w - extents[2], w + extents[2]);
        if far <= 0.0 {
            return false;
        }
        // The sphere contains the light or is very close to it: its projection is unbounded.
        if near.is_nan() || near <= 1e-6 * far {
            return self.add_all();
        }
        let sides = [(across, extents[0]), (up, extents[1])].map(|(centre, extent)| {
            let (low, high) = (centre - extent, centre + extent);
            [low / if low < 0.0 { near } else { far }, high / if high > 0.0 { near } else { far }]
        });
        if sides.iter().any(|&[low, high]| low > 1.0 || high < -1.0) {
            return false;
        }
        for (axis, [low, high]) in sides.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(low);
            self.high[axis] = self.high[axis].max(high);
        }
        true
    }

    /// Extends the bounds to the full shadow map.
    fn add_all(&mut self) -> bool {
        (self.low, self.high) = ([-1.0; 2], [1.0; 2]);
        true
    }
}
