//! Valid ranges of the visualiser settings, within which a renderer can show the model and allocate
//! its resources. The engine's renderer does not check the settings. It sizes textures and meshes
//! by the counts, divides by `stiffnessrot`, by the number of slices and by the width of the fog,
//! and terminates the process if the near plane is at zero.

use std::ops::RangeInclusive;

use super::fields::Checks;
use super::visual::{Visual, VisualGlobal, VisualHeadlight, VisualMap, VisualQuality, VisualRgba, VisualScale};
use crate::error::Result;

/// Limit on image sizes: twice the largest texture size of graphics cards.
const LARGEST_IMAGE: usize = 32_768;

/// Limit on samples per pixel, above the limit of graphics cards.
const MOST_SAMPLES: usize = 64;

/// Limit on the subdivision of the built-in geoms, far finer than visible on a sphere. The number
/// of vertices is its square.
const MOST_SLICES: usize = 1_000;

/// Smallest near plane whose product with the smallest extent the engine distinguishes from zero.
const NEAREST: f32 = 1e-6;

/// Largest far plane: the engine's limit for valid numbers.
const FARTHEST: f32 = 1e10;

const VISUAL: Checks = Checks("visual.");

impl Visual {
    pub(super) fn check(&self) -> Result<()> {
        self.global.check()?;
        self.quality.check()?;
        self.headlight.check()?;
        self.map.check()?;
        self.scale.check()?;
        self.rgba.check()
    }
}

fn count(name: &str, value: usize, range: &RangeInclusive<usize>) -> Result<()> {
    let (first, last) = (range.start(), range.end());
    VISUAL.require(range.contains(&value), name, value, format_args!("from {first} to {last}"))
}

fn fraction(name: &str, value: f32) -> Result<()> {
    VISUAL.require((0.0..=1.0).contains(&value), name, value, "from 0 to 1")
}

impl VisualGlobal {
    fn check(&self) -> Result<()> {
        VISUAL.require(self.fovy > 0.0 && self.fovy < 180.0, "global.fovy", self.fovy, "between 0 and 180")?;
        VISUAL.finite("global.ipd", &[self.ipd])?;
        VISUAL.finite("global.azimuth", &[self.azimuth])?;
        VISUAL.finite("global.elevation", &[self.elevation])?;
        VISUAL.positive("global.linewidth", self.linewidth)?;
        VISUAL.not_negative("global.glow", self.glow)?;
        count("global.offwidth", self.offwidth, &(1..=LARGEST_IMAGE))?;
        count("global.offheight", self.offheight, &(1..=LARGEST_IMAGE))
    }
}

impl VisualQuality {
    fn check(&self) -> Result<()> {
        count("quality.shadowsize", self.shadowsize, &(0..=LARGEST_IMAGE))?;
        count("quality.offsamples", self.offsamples, &(0..=MOST_SAMPLES))?;
        count("quality.numslices", self.numslices, &(1..=MOST_SLICES))?;
        count("quality.numstacks", self.numstacks, &(1..=MOST_SLICES))?;
        count("quality.numquads", self.numquads, &(1..=MOST_SLICES))
    }
}

impl VisualHeadlight {
    fn check(&self) -> Result<()> {
        for (name, rgb) in [
            ("headlight.ambient", self.ambient),
            ("headlight.diffuse", self.diffuse),
            ("headlight.specular", self.specular),
        ] {
            let holds = rgb.iter().all(|value| value.is_finite() && *value >= 0.0);
            VISUAL.require(holds, name, format_args!("{rgb:?}"), "finite and not negative")?;
        }
        Ok(())
    }
}

impl VisualMap {
    fn check(&self) -> Result<()> {
        for (name, value) in [
            ("map.stiffness", self.stiffness),
            ("map.force", self.force),
            ("map.torque", self.torque),
            ("map.fogstart", self.fogstart),
            ("map.actuatortendon", self.actuatortendon),
        ] {
            VISUAL.not_negative(name, value)?;
        }
        for (name, value) in [
            ("map.stiffnessrot", self.stiffnessrot),
            ("map.shadowclip", self.shadowclip),
            ("map.shadowscale", self.shadowscale),
        ] {
            VISUAL.positive(name, value)?;
        }
        fraction("map.alpha", self.alpha)?;
        fraction("map.haze", self.haze)?;
        let beyond = self.fogend.is_finite() && self.fogend > self.fogstart;
        VISUAL.require(beyond, "map.fogend", self.fogend, "finite and greater than fogstart")?;
        VISUAL.require(self.zfar > 0.0 && self.zfar <= FARTHEST, "map.zfar", self.zfar, "positive and at most 1e10")?;
        let between = self.znear >= NEAREST && self.znear < self.zfar;
        VISUAL.require(between, "map.znear", self.znear, "at least 1e-6 and less than zfar")
    }
}

/// Applies a check to each of the given fields and its name.
macro_rules! each {
    ($group:ident.[$($field:ident)*]: $check:expr) => {
        for (name, value) in [$((stringify!($field), $group.$field)),*] {
            $check(name, value)?;
        }
    };
}

impl VisualScale {
    fn check(&self) -> Result<()> {
        each!(self.[
            forcewidth contactwidth contactheight connect com camera light selectpoint jointlength jointwidth
            actuatorlength actuatorwidth framelength framewidth constraint slidercrank
        ]: |name, value| Checks("visual.scale.").not_negative(name, value));
        Ok(())
    }
}

impl VisualRgba {
    fn check(&self) -> Result<()> {
        each!(self.[
            fog haze force inertia joint actuator actuatornegative actuatorpositive com camera light selectpoint connect
            contactpoint contactforce contactfriction contacttorque contactgap rangefinder constraint slidercrank crankbroken
        ]: |name, rgba: [f32; 4]| {
            let holds = rgba.iter().all(|value| (0.0..=1.0).contains(value));
            Checks("visual.rgba.").require(holds, name, format_args!("{rgba:?}"), "from 0 to 1 each")
        });
        Ok(())
    }
}
