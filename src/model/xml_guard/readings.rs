//! Number of values that the sensors and delays of a text have. The compiler multiplies them in C
//! ints, allocates memory for them, and in its test step casts a ray for each pixel of a camera
//! with a rangefinder.

use super::limits::{product, size};
use super::tags::Tag;

/// Largest number of rays of all rangefinders: two seconds.
const MOST_RAYS: u64 = 4_000_000;
/// Largest number of values of all sensors, with their samples.
const MOST_VALUES: u64 = 20_000_000;
/// Upper bound of the vertices of a mesh, each of which is three values of a tactile sensor.
const MOST_VERTICES: u64 = 100_000;

/// Most frequent elements that are neither sensors nor actuators.
const NEITHER: [&[u8]; 12] = [
    b"body",
    b"geom",
    b"joint",
    b"freejoint",
    b"site",
    b"inertial",
    b"frame",
    b"mesh",
    b"material",
    b"texture",
    b"light",
    b"element",
];

/// Numbers of values, collected tag by tag.
#[derive(Default)]
pub(super) struct Readings {
    /// Largest number of pixels of a camera or of a default of cameras.
    pixels: u64,
    /// Number of rangefinders of cameras, and of their values for each pixel.
    cameras: u64,
    values_of_pixel: u64,
    /// Number of values of other large sensors, with their samples.
    values: u64,
    /// Number of actuators and other sensors, and largest number of samples of one or of a default.
    actuators: u64,
    samples: u64,
    /// Number of user values of an element, of all kinds together.
    users: u64,
    /// Largest number of copies of an element by `replicate`. The compiler also copies the sensors
    /// of a copied element.
    copies: u64,
    /// Number of `attach` elements that copy a part of this model, and of those that copy another
    /// one.
    attached: u64,
    models: u64,
    /// Largest numbers of rays and values of a model that is an asset of this one.
    child: [u64; 2],
}

impl Readings {
    /// Records a start tag, of which the compiler makes `copies`.
    pub(super) fn record(&mut self, tag: &Tag<'_>, copies: u64) {
        self.copies = self.copies.max(copies);
        let has = |name: &[u8]| tag.attribute(name).is_some();
        let samples = size(tag, b"nsample", 0).saturating_add(1);
        let words = |name: &[u8]| {
            let data = tag.attribute(name).unwrap_or_default();
            data.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count() as u64
        };
        // Each quantity is at most a vector.
        let width = words(b"data").max(1).saturating_mul(3);
        let values = match tag.name {
            b"camera" => {
                self.pixels = self.pixels.max(product(tag, b"resolution", 0));
                return;
            }
            b"rangefinder" if has(b"camera") => {
                self.cameras += 1;
                self.values_of_pixel = self.values_of_pixel.saturating_add(width.saturating_mul(samples));
                return;
            }
            b"size" => {
                let kinds = ["body", "jnt", "geom", "site", "cam", "tendon", "actuator", "sensor"];
                let users = kinds.iter().map(|kind| size(tag, format!("nuser_{kind}").as_bytes(), 0));
                self.users = users.fold(self.users, |sum, count| sum.saturating_add(count));
                return;
            }
            b"attach" if has(b"model") => {
                self.models = self.models.saturating_add(copies);
                return;
            }
            b"attach" => {
                self.attached += 1;
                return;
            }
            b"contact" if has(b"num") || has(b"nsample") => size(tag, b"num", 1).max(1).saturating_mul(width),
            b"user" => size(tag, b"dim", 1),
            b"tactile" => 3 * MOST_VERTICES,
            _ if NEITHER.contains(&tag.name) => return,
            // A sensor, an actuator or a default of actuators.
            _ => {
                self.actuators += 1;
                self.samples = self.samples.max(samples);
                size(tag, b"actdim", 0)
            }
        };
        self.values = self.values.saturating_add(values.saturating_mul(samples));
    }

    /// Records a model that is an asset of this one.
    pub(super) fn record_model(&mut self, child: &Self) {
        let [rays, values] = child.totals();
        self.child = [self.child[0].max(rays), self.child[1].max(values)];
        self.pixels = self.pixels.max(child.pixels);
        self.samples = self.samples.max(child.samples);
        self.users = self.users.max(child.users);
    }

    /// Returns the numbers of rays and values, including copies and attached models.
    fn totals(&self) -> [u64; 2] {
        let rays = self.pixels.saturating_mul(self.cameras);
        let samples = if self.samples > 1 { 4 * self.samples.saturating_mul(self.actuators) } else { 0 };
        let values =
            (self.pixels.saturating_mul(self.values_of_pixel)).saturating_add(self.values).saturating_add(samples);
        let copies = self.copies.saturating_mul(self.attached + 1);
        let total = |own: u64, child: u64| own.saturating_mul(copies).saturating_add(child.saturating_mul(self.models));
        [total(rays, self.child[0]), total(values, self.child[1])]
    }

    /// Returns the reason to reject the model, which has this number of elements.
    pub(super) fn check(&self, elements: u64) -> Result<(), String> {
        let [rays, values] = self.totals();
        if rays > MOST_RAYS {
            return Err(format!(
                "the rangefinders of cameras cast more than {MOST_RAYS} rays: reduce the resolution of the camera"
            ));
        }
        if values > MOST_VALUES {
            return Err(format!("the sensors and delays have more than {MOST_VALUES} values, with their samples"));
        }
        if self.users.saturating_mul(elements) > MOST_VALUES {
            return Err(format!("the elements have more than {MOST_VALUES} user values (nuser_body, …)"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::model::xml_guard::{Files, check};

    fn message(text: &str) -> String {
        check("the text", text.as_bytes(), &Files::default()).map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn texts_with_too_many_values_are_rejected() {
        for (text, expected) in [
            ("<camera resolution='65537 65537'/><rangefinder camera='c'/>", "more than 4000000 rays"),
            (
                "<default><camera resolution='30000 30000'/></default><rangefinder camera='c'/>",
                "more than 4000000 rays",
            ),
            (
                "<camera resolution='1000 1000'/><replicate count='5'><site/></replicate><rangefinder camera='c'/>",
                "rays",
            ),
            ("<camera resolution='4294967296 1'/><rangefinder camera='c'/>", "more than 4000000 rays"),
            ("<camera resolution='1000 1000'/><rangefinder camera='c' data='dist' nsample='10'/>", "20000000 values"),
            ("<sensor><contact num='9000' nsample='9000'/></sensor>", "20000000 values"),
            ("<user dim='2000000000'/>", "20000000 values"),
            ("<tactile mesh='m' geom='g' nsample='1000'/>", "20000000 values"),
            ("<motor nsample='10000'/>".repeat(600).as_str(), "20000000 values"),
            (format!("<size nuser_body='9000'/>{}", "<body/>".repeat(3000)).as_str(), "user values"),
            ("<general actdim='2000000000'/>", "actdim must be an integer of at most 10000"),
            ("<gadget cells='100 101 102'/>", "product of more than 1000000"),
            ("<gadget cells='9999999999999999999999'/>", "product of more than 1000000"),
            ("<gadget cells='&#49;00 101 102'/>", "product of more than 1000000"),
        ] {
            let message = message(text);
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn texts_within_the_limits_are_accepted() {
        for text in [
            "<camera resolution='2000 2000'/><rangefinder camera='c'/>",
            "<camera resolution='30000 30000'/><rangefinder site='s'/>",
            "<geom mass='100000000' gadget='1000 1000'/>",
            "<replicate count='100000'><geom/></replicate><contact/><sensor><clock/><touch nsample='3'/></sensor>",
        ] {
            assert_eq!(message(text), "");
        }
    }
}
