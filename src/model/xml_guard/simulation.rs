//! Checks of the simulations that the compiler runs. In its test step, rangefinders may read beyond
//! a height field. Its simulation of muscles, which determines their length ranges, may not
//! terminate (see `data/length_range.rs`).

use super::tags::{Tag, Tags};
use crate::data::length_range::{LengthRangeMode as Mode, MuscleSimulation};
use crate::error::{Error, Result};
use crate::model::engine_limits::rays_overrun_grid;

/// Simulations by the compiler whose safety the text does not reveal.
pub(in crate::model) struct Simulations {
    /// Simulation of muscles, which may not terminate.
    pub(in crate::model) muscles: Option<MuscleSimulation>,
    /// `true` if there may be too little memory for constraints that the test step needs.
    pub(in crate::model) may_lack_room: bool,
}

/// Settings of muscles and of their simulation, collected tag by tag.
#[derive(Default)]
pub(super) struct Muscles {
    settings: MuscleSimulation,
    /// `true` if the text has an actuator that may be simulated.
    found: bool,
}

impl Muscles {
    /// Records a tag. `is_asset` is `true` in a model that is an asset of another one, whose
    /// settings the compiler uses.
    pub(super) fn record(&mut self, tag: &Tag<'_>, is_asset: bool) {
        let value = |name: &[u8]| tag.attribute(name).map(|value| value.trim_ascii().to_vec());
        match tag.name {
            b"muscle" => self.found = true,
            b"general" => {
                let is = |value: Option<Vec<u8>>| value.is_some_and(|value| value == b"muscle" || value == b"user");
                self.found |= is(value(b"gaintype")) || is(value(b"biastype"));
            }
            b"lengthrange" if !is_asset => {
                self.settings.options.mode = match value(b"mode").as_deref() {
                    None => self.settings.options.mode,
                    Some(b"none") => Mode::None,
                    Some(b"muscle") => Mode::Muscle,
                    Some(b"muscleuser") => Mode::MuscleUser,
                    _ => Mode::All,
                };
                self.found |= self.settings.options.mode == Mode::All;
                for (name, flag) in [
                    (&b"useexisting"[..], &mut self.settings.options.useexisting),
                    (b"uselimit", &mut self.settings.options.uselimit),
                ] {
                    *flag = value(name).map_or(*flag, |value| value == b"true");
                }
                for (name, number) in [
                    (&b"accel"[..], &mut self.settings.options.accel),
                    (b"maxforce", &mut self.settings.options.maxforce),
                    (b"timeconst", &mut self.settings.options.timeconst),
                    (b"timestep", &mut self.settings.timestep),
                    (b"inttotal", &mut self.settings.options.inttotal),
                ] {
                    // The compiler rejects values that are not numbers.
                    if let Some(value) = value(name).and_then(|value| String::from_utf8(value).ok()?.parse().ok()) {
                        *number = value;
                    }
                }
            }
            _ => {}
        }
    }

    /// Returns the settings if the compiler may run the simulation.
    pub(super) fn simulation(self) -> Option<MuscleSimulation> {
        (self.found && self.settings.options.mode != Mode::None).then_some(self.settings)
    }
}

/// Constraints that the engine reads in the compiler's test step without checking that there was
/// room for them, collected tag by tag: the constraints of adhesive actuators, and since 2.3
/// equality constraints.
#[derive(Default)]
pub(super) struct Constraints {
    are_needed: bool,
    /// `true` if the text limits the memory.
    has_size: bool,
    /// `true` if the text may select a dual solver, which needs memory quadratic in their number.
    is_dual: bool,
}

impl Constraints {
    pub(super) fn record(&mut self, tag: &Tag<'_>) {
        let has = |name: &&[u8]| tag.attribute(name).is_some();
        match tag.name {
            b"equality" | b"adhesion" | b"composite" | b"flexcomp" | b"flex" => self.are_needed = true,
            b"general" => self.are_needed |= has(&&b"body"[..]),
            b"size" => self.has_size |= [&b"memory"[..], b"njmax", b"nconmax", b"nstack"].iter().any(has),
            b"option" => {
                let is_pgs = tag.attribute(b"solver").is_some_and(|solver| solver.trim_ascii() == b"PGS");
                self.is_dual |= is_pgs || has(&&b"noslip_iterations"[..]);
            }
            _ => {}
        }
    }

    /// Returns `true` if the room for the constraints must be checked.
    pub(super) fn may_lack_room(&self) -> bool {
        cfg!(engine_since = "2.3.0") && self.are_needed && (self.has_size || self.is_dual)
    }
}

/// Returns the text with the simulation of muscles disabled, or `None` if the text is not MJCF.
pub(in crate::model) fn without_simulation(text: &[u8]) -> Option<Vec<u8>> {
    appended(text, b"<compiler><lengthrange mode=\"none\"/></compiler>")
}

/// Returns the text with constraints and the simulation of muscles disabled, or `None` if the text
/// is not MJCF.
pub(in crate::model) fn without_constraints(text: &[u8]) -> Option<Vec<u8>> {
    let settings = b"<compiler><lengthrange mode=\"none\"/></compiler><option><flag constraint=\"disable\"/></option>";
    appended(text, settings)
}

/// Returns the text with settings, which take effect because the compiler uses the last ones.
fn appended(text: &[u8], settings: &[u8]) -> Option<Vec<u8>> {
    let mut depth = 0_usize;
    for tag in Tags::new(text) {
        match (tag.closes, depth) {
            (false, 0) if tag.empty || tag.name != b"mujoco" => return None,
            (false, _) => depth += usize::from(!tag.empty),
            (true, 1) => {
                return Some([&text[..tag.position], settings, &text[tag.position..]].concat());
            }
            (true, _) => depth = depth.checked_sub(1)?,
        }
    }
    None
}

/// Rangefinders, and height fields beyond which their rays would read, collected tag by tag.
#[derive(Default)]
pub(super) struct Rangefinders {
    /// `true` if the text has a rangefinder.
    found: bool,
    /// `true` if the text has a geom with a height field, or a default of such a geom.
    has_height_field_geom: bool,
    /// Size of the first unsafe height field, in words, and the name of the text that contains or
    /// names it.
    unsafe_field: Option<(String, String)>,
}

impl Rangefinders {
    pub(super) fn record(&mut self, tag: &Tag<'_>, source_name: &str) {
        match tag.name {
            b"rangefinder" => self.found = true,
            b"geom" => self.has_height_field_geom |= tag.attribute(b"hfield").is_some(),
            // Numbers that do not fit into a C int have already been rejected.
            b"hfield" => {
                // If a size is missing or zero, the compiler uses the size in the file.
                let size = |name| tag.integer(name).and_then(|size| u64::try_from(size).ok()).filter(|&size| size > 0);
                let size = [size(b"nrow"), size(b"ncol")];
                self.record_field(size[0].zip(size[1]).map(<[u64; 2]>::from), source_name);
            }
            _ => {}
        }
    }

    /// Records the rows and columns of a height field.
    pub(super) fn record_field(&mut self, size: Option<[u64; 2]>, source_name: &str) {
        let Some([rows, columns]) = size else { return };
        if self.unsafe_field.is_none() && rays_overrun_grid(rows, columns) {
            self.unsafe_field = Some((format!("{rows} rows and {columns} columns"), source_name.to_owned()));
        }
    }

    /// Returns an error if the ray of a rangefinder may hit an unsafe height field.
    pub(super) fn check(self) -> Result<()> {
        let Some((size, source_name)) = self.unsafe_field.filter(|_| self.found && self.has_height_field_geom) else {
            return Ok(());
        };
        let message = format!(
            "a rangefinder would read beyond a height field of {size}; it needs two or more of each and no more rows than \
             columns, so rotate it by 90°"
        );
        Err(Error::Load { source_name, message })
    }
}

#[cfg(test)]
mod tests {
    use super::without_simulation;

    #[test]
    fn the_simulation_is_disabled_at_the_end_of_the_first_element() {
        let off = "<compiler><lengthrange mode=\"none\"/></compiler>";
        for (before, after) in [
            ("<!-- <a> --><mujoco><body/><a></a>", "</mujoco><mujoco></mujoco>"),
            ("<mujoco><mujoco></mujoco>", "</mujoco>"),
        ] {
            let text = without_simulation([before, after].concat().as_bytes()).unwrap();
            assert_eq!(String::from_utf8(text).unwrap(), [before, off, after].concat());
        }
        for text in ["<robot></robot>", "<mujoco/>", "", "<mujoco>", "</mujoco>"] {
            assert_eq!(without_simulation(text.as_bytes()), None);
        }
    }
}
