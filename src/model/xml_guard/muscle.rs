//! Whether the compiler will simulate muscles to find the range of their lengths, and how: see `length_range.rs`.

use super::tag::{Tag, Tags};
use crate::model::length_range::{LengthRangeMode as Mode, Simulation};

/// What the tags that were seen say about it.
#[derive(Default)]
pub(super) struct Muscles {
    settings: Simulation,
    /// Whether there is something that may be simulated.
    found: bool,
}

impl Muscles {
    pub(super) fn note(&mut self, tag: &Tag<'_>) {
        let value = |name: &[u8]| tag.attribute(name).map(|value| value.trim_ascii().to_vec());
        match tag.name {
            b"muscle" => self.found = true,
            b"general" => {
                let is = |value: Option<Vec<u8>>| value.is_some_and(|value| value == b"muscle" || value == b"user");
                self.found |= is(value(b"gaintype")) || is(value(b"biastype"));
            }
            b"lengthrange" => {
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
                    // What is not a number the compiler refuses.
                    if let Some(value) = value(name).and_then(|value| String::from_utf8(value).ok()?.parse().ok()) {
                        *number = value;
                    }
                }
            }
            _ => {}
        }
    }

    pub(super) fn simulation(self) -> Option<Simulation> {
        (self.found && self.settings.options.mode != Mode::None).then_some(self.settings)
    }
}

/// The text with the simulation switched off: the last of several settings counts. `None` if it is not MJCF.
pub(in crate::model) fn without_simulation(text: &[u8]) -> Option<Vec<u8>> {
    let mut depth = 0_usize;
    for tag in Tags::new(text) {
        match (tag.closes, depth) {
            (false, 0) if tag.empty || tag.name != b"mujoco" => return None,
            (false, _) => depth += usize::from(!tag.empty),
            (true, 1) => {
                let off = b"<compiler><lengthrange mode=\"none\"/></compiler>";
                return Some([&text[..tag.position], off, &text[tag.position..]].concat());
            }
            (true, _) => depth = depth.checked_sub(1)?,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::without_simulation;

    #[test]
    fn the_simulation_is_switched_off_at_the_end_of_the_first_element() {
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
