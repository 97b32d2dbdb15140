//! What casts shadows that are seen, and what part of a shadow map it is drawn to. Only that part is kept: a whole map has millions of
//! texels.

use crate::render::bound::{Reach, Sphere, height};
use crate::render::frame::matrix::{Matrix4, row};
use crate::render::frame::{Lamp, Lights};
use crate::scene::{SceneGeom, SceneGeomType};

/// The rectangle of each light's map, in the coordinates of the cube that it sees, from -1 to 1.
pub(super) struct Casters<'a> {
    lights: Vec<Caster<'a>>,
    culls: bool,
    /// The sides of what the eye sees.
    planes: [[f32; 4]; 6],
}

struct Caster<'a> {
    lamp: &'a Lamp,
    /// The first, the second and the last row of its matrix.
    rows: [[f64; 4]; 3],
    lengths: [f64; 3],
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> Casters<'a> {
    /// Nothing yet. `culls` says that only backs are drawn to the maps, and `planes` what the eye sees.
    pub(super) fn new(lights: &'a Lights, culls: bool, planes: [[f32; 4]; 6]) -> Self {
        let lights = lights.lamps.iter().filter_map(|lamp| Some(Caster::new(lamp, lamp.shadow.as_ref()?))).collect();
        Self { lights, culls, planes }
    }

    /// Adds a geom that casts shadows, and is in sight itself or not. The lights that it casts them in are returned: a bit for each.
    pub(super) fn add(&mut self, geom: SceneGeom<'_>, reach: &Reach, in_sight: bool) -> u8 {
        let mut casts = 0;
        for (index, light) in self.lights.iter_mut().enumerate() {
            // The front of a plane is left out, as all fronts are: then nothing of it is drawn.
            let is_left_out = self.culls && geom.geom_type() == SceneGeomType::Plane && light.sees_front(geom);
            let is_seen = match reach {
                _ if is_left_out => false,
                Reach::Within(sphere) => (in_sight || !light.throws_past(sphere, &self.planes)) && light.add(sphere),
                Reach::Everywhere => light.add_all(),
                Reach::Nowhere => false,
            };
            casts |= u8::from(is_seen) << index;
        }
        casts
    }

    /// The rectangles, from the lowest to the highest corner; none where nothing is drawn.
    pub(super) fn finish(self) -> Vec<Option<[[f64; 2]; 2]>> {
        let within = |corner: [f64; 2]| corner.map(|coordinate| coordinate.clamp(-1.0, 1.0));
        let rectangle = |light: Caster<'_>| {
            let (low, high) = (within(light.low), within(light.high));
            (low[0] < high[0] && low[1] < high[1]).then_some([low, high])
        };
        self.lights.into_iter().map(rectangle).collect()
    }
}

impl<'a> Caster<'a> {
    fn new(lamp: &'a Lamp, matrix: &Matrix4) -> Self {
        let rows = [row(matrix, 0), row(matrix, 1), row(matrix, 3)];
        let lengths = rows.map(|[x, y, z, _]| (x * x + y * y + z * z).sqrt());
        Self { lamp, rows, lengths, low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] }
    }

    fn sees_front(&self, geom: SceneGeom<'_>) -> bool {
        let (pos, mat, light) = (geom.pos(), geom.mat(), &self.lamp.light);
        let normal = [mat[2], mat[5], mat[8]];
        let toward =
            [0, 1, 2].map(|axis| if light.directional { -light.dir[axis] } else { light.pos[axis] - pos[axis] });
        normal.iter().zip(toward).map(|(a, b)| a * b).sum::<f32>() > 0.0
    }

    /// Whether the whole shadow of a sphere is out of sight: the sphere is beyond a side of what is seen, and the light shines on it from
    /// within, or along.
    fn throws_past(&self, sphere: &Sphere, planes: &[[f32; 4]; 6]) -> bool {
        let light = &self.lamp.light;
        let along = |plane: &[f32; 4]| (0..3).map(|axis| plane[axis] * light.dir[axis]).sum::<f32>();
        planes.iter().any(|plane| {
            let nearest = height(sphere.centre, plane) + sphere.radius;
            let leads_away = if light.directional { along(plane) <= 0.0 } else { nearest <= height(light.pos, plane) };
            nearest < 0.0 && leads_away
        })
    }

    /// Adds the box around the picture of a sphere, and tells whether any of it is seen.
    fn add(&mut self, sphere: &Sphere) -> bool {
        let [x, y, z] = sphere.centre.map(f64::from);
        let radius = f64::from(sphere.radius);
        let [across, up, deep] = self.rows.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3]);
        let around = self.lengths.map(|length| length * radius);
        let (near, far) = (deep - around[2], deep + around[2]);
        if far <= 0.0 {
            return false;
        }
        // It reaches behind the light, or almost: it may be anywhere.
        if near.is_nan() || near <= 1e-6 * far {
            return self.add_all();
        }
        let sides = [(across, around[0]), (up, around[1])].map(|(center, around)| {
            let (low, high) = (center - around, center + around);
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

    fn add_all(&mut self) -> bool {
        (self.low, self.high) = ([-1.0; 2], [1.0; 2]);
        true
    }
}
