//! For each attribute of the linked engine, a model in which it has a value that differs from the
//! default.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher as _};
use std::sync::{Mutex, PoisonError};

use mujoco_safe::{Data, LoadOptions, Model};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::document::Node;
use super::schema::Attribute;
use super::specimens::{self, Specimen};
use super::{files, values};

/// Effect of an attribute, found by a comparison with the model without it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// The compiler accepts it, and the model is the same.
    None,
    /// The compiled model differs.
    Stored,
    /// States or sensors differ after some steps.
    Acts,
}

/// A model with an attribute.
#[derive(Clone, Debug)]
pub struct Case {
    pub attribute: Attribute,
    pub value: String,
    pub text: String,
    /// The model without the attribute, or without its element if the attribute is required.
    pub without: String,
    pub effect: Effect,
}

/// Elements whose attributes an element of `default` sets.
fn instances(default: &str) -> Vec<String> {
    let (head, rest) = default.split_once('/').map_or((default, ""), |(head, rest)| (head, rest));
    let parents: &[&str] = match head {
        "mesh" | "texture" | "material" => &["asset/"],
        "joint" | "geom" | "site" | "camera" | "light" => &["body/"],
        "pair" => &["contact/"],
        "equality" => &["equality/weld", "equality/joint", "equality/connect", "equality/tendon"],
        "tendon" => &["tendon/spatial", "tendon/fixed"],
        _ => &["actuator/"],
    };
    let path = |parent: &&str| {
        let path = if parent.ends_with('/') { format!("{parent}{head}") } else { (*parent).to_owned() };
        if rest.is_empty() { path } else { format!("{path}/{rest}") }
    };
    parents.iter().map(path).collect()
}

/// Returns a model for the attribute: the first with this effect among the values and places that
/// are tried, or that with the largest effect.
///
/// # Errors
///
/// The last message, if the compiler rejects all values.
pub fn case(attribute: &Attribute, enough: Effect) -> Result<Case, String> {
    search(attribute, enough, super::rig())
}

/// Draws eight of the attributes. Returns their names, and a model with those of them that the
/// compiler accepts together, in the order of their addition.
pub fn combination(attributes: &[Attribute], random: &mut Xoshiro256PlusPlus) -> (String, String) {
    let some = [(); 8].map(|()| &attributes[random.random_range(0..attributes.len())]);
    let text = some
        .into_iter()
        .fold(super::rig(), |model, attribute| {
            let case = search(attribute, Effect::Stored, model.clone());
            case.map_or(model, |case| Node::parse(&case.text))
        })
        .text();
    (some.map(ToString::to_string).join(", "), text)
}

/// Returns a case in a model.
fn search(attribute: &Attribute, enough: Effect, rig: Node) -> Result<Case, String> {
    let enough = if is_only_stored(attribute) { enough.min(Effect::Stored) } else { enough };
    let mut search = Search { attribute, enough, best: None, message: String::new(), rig };
    let paths = match attribute.element.strip_prefix("default/") {
        Some(default) => instances(default),
        None => vec![attribute.element.clone()],
    };
    let specimens: Vec<(String, Specimen)> = paths
        .iter()
        .flat_map(|path| specimens::of(path).into_iter().map(move |specimen| (path.clone(), specimen)))
        .collect();
    for source in [Source::Table, Source::Guesses, Source::Words] {
        if source == Source::Words && !values::needs_word(&search.message) {
            break;
        }
        if specimens.iter().any(|(path, specimen)| search.run(path, specimen, source)) || search.best.is_some() {
            break;
        }
    }
    search.best.ok_or(search.message)
}

/// Returns `true` for attributes that only change pictures, names and the data of users.
pub fn is_only_stored(attribute: &Attribute) -> bool {
    let Attribute { element, name } = attribute;
    let element = element.trim_start_matches("default/");
    [
        "visual",
        "statistic",
        "custom",
        "asset/texture",
        "asset/material",
        "texture",
        "material",
        "asset/skin",
        "body/light",
        "light",
        "deformable/skin",
    ]
    .iter()
    .any(|section| element.starts_with(section))
        || ["name", "user", "group", "rgba", "material", "class"].contains(&&name[..])
}

/// Origin of the values.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Source {
    Table,
    Guesses,
    Words,
}

struct Search<'a> {
    attribute: &'a Attribute,
    enough: Effect,
    best: Option<Case>,
    message: String,
    rig: Node,
}

impl Search<'_> {
    /// Tries a specimen with each value. Returns `true` if a value has the effect.
    fn run(&mut self, path: &str, specimen: &Specimen, source: Source) -> bool {
        let mut complete = self.rig.clone();
        specimen.insert(&mut complete);
        let own = specimen.find(&mut complete, path).get(&self.attribute.name).map(str::to_owned);
        let mut values = match source {
            Source::Table => values::candidates(self.attribute, &complete),
            Source::Guesses => values::guesses(),
            Source::Words => values::words(&complete),
        };
        values.retain(|value| own.as_ref() != Some(value));
        let mut without = complete.clone();
        specimen.find(&mut without, path).remove(&self.attribute.name);
        let without = without.text();
        if let Ok(before) = Fingerprint::of(&without) {
            let mut values = own.into_iter().chain(values);
            values.any(|value| self.compare(path, specimen, &complete, value, &before, &without))
        } else {
            // The attribute is required: the model with it is compared with another value, or with
            // the model without the element.
            let rig = self.rig.text();
            let absent = Fingerprint::of(&rig).expect("the engine compiles the rig");
            let (with, before) = match Fingerprint::of(&complete.text()) {
                Ok(before) => (complete.text(), before),
                Err(_) => (rig.clone(), absent),
            };
            values.into_iter().any(|value| self.compare(path, specimen, &complete, value, &before, &with))
                || own.is_some_and(|own| self.compare(path, specimen, &complete, own, &absent, &rig))
        }
    }

    /// Tries a value, and returns `true` if it has the effect.
    fn compare(
        &mut self,
        path: &str,
        specimen: &Specimen,
        complete: &Node,
        value: String,
        before: &Fingerprint,
        without: &str,
    ) -> bool {
        let text = self.text(path, specimen, complete, &value);
        let effect = match Fingerprint::of(&text) {
            Err(message) => {
                self.message = format!("{value:?}: {message}");
                return false;
            }
            Ok(after) if after.trace != before.trace => Effect::Acts,
            Ok(after) if after.binary != before.binary => Effect::Stored,
            Ok(_) => Effect::None,
        };
        if self.best.as_ref().is_none_or(|best| effect > best.effect) {
            let (attribute, without) = (self.attribute.clone(), without.to_owned());
            self.best = Some(Case { attribute, value, text, without, effect });
        }
        effect >= self.enough
    }

    /// Returns the document with the value, in the element or in the class `plain` that the element
    /// then has.
    fn text(&self, path: &str, specimen: &Specimen, complete: &Node, value: &str) -> String {
        let mut document = complete.clone();
        let name = &self.attribute.name;
        let node = specimen.find(&mut document, path);
        let Some(default) = self.attribute.element.strip_prefix("default/") else {
            // Newer compilers accept several transmissions and ignore all but the last one.
            if self.attribute.element.starts_with("actuator/") && TRANSMISSIONS.contains(&&name[..]) {
                for other in TRANSMISSIONS {
                    node.remove(other);
                }
            }
            node.set(name, value);
            return document.text();
        };
        // A layer inherits nothing.
        if default != "material/layer" {
            node.remove(name);
        }
        let required: Vec<_> = REQUIRED.iter().filter_map(|name| Some((*name, node.get(name)?.to_owned()))).collect();
        specimen.root(&mut document).set("class", "plain");
        let class = document.find_mut(&|node| node.name == "default" && node.get("class") == Some("plain"));
        let node = class.expect("the rig has this class").descend(default.split('/'));
        if matches!(default, "damper" | "adhesion" | "dcmotor" | "material/layer") {
            for (name, value) in &required {
                node.set(name, value);
            }
        }
        node.set(name, value);
        document.text()
    }
}

/// Attributes of the transmission of an actuator, which has one of them.
const TRANSMISSIONS: [&str; 6] = ["joint", "jointinparent", "tendon", "cranksite", "site", "body"];

/// Attributes without which the compiler rejects some elements of a class.
const REQUIRED: [&str; 5] = ["ctrlrange", "resistance", "motorconst", "role", "texture"];

/// Hashes of a compiled model and of its motion.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Fingerprint {
    binary: u64,
    trace: u64,
}

impl Fingerprint {
    /// Compiles and simulates a text. The results are kept, because many attributes are compared
    /// with the same model. The messages are not: thousands of strings between the blocks of the
    /// engine fragment gigabytes of the heap.
    fn of(text: &str) -> Result<Self, String> {
        static KNOWN: Mutex<BTreeMap<u64, Fingerprint>> = Mutex::new(BTreeMap::new());
        let key = hash(&text);
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let old = known().get(&key).copied();
        if let Some(old) = old {
            return Ok(old);
        }
        let new = Self::computed(text)?;
        known().insert(key, new);
        Ok(new)
    }

    fn computed(text: &str) -> Result<Self, String> {
        let model = load(text)?;
        let binary = hash(&model.to_binary().map_err(|error| error.to_string())?);
        let mut data = Data::new(model).map_err(|error| error.to_string())?;
        let mut trace: Vec<u64> = Vec::new();
        excite(&mut data);
        for _ in 0..STEPS {
            data.step().map_err(|error| error.to_string())?;
            let values = [data.qpos(), data.qvel(), data.act(), data.sensordata()].concat();
            trace.extend(values.iter().map(|value| value.to_bits()));
        }
        Ok(Self { binary, trace: hash(&trace) })
    }
}

fn hash(value: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// Number of steps in which an attribute must act.
const STEPS: usize = 20;

/// Sets velocities and controls that no element of the rig is at rest with.
pub fn excite(data: &mut Data) {
    for (at, velocity) in data.qvel_mut().iter_mut().enumerate() {
        *velocity = 0.3 - 0.1 * (at % 5) as f64;
    }
    for (at, control) in data.ctrl_mut().iter_mut().enumerate() {
        *control = 0.6 - 0.1 * (at % 3) as f64;
    }
}

/// Loads a text with the files that values name.
///
/// # Errors
///
/// The message of the library or the engine.
pub fn load(text: &str) -> Result<Model, String> {
    let files = files();
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (*name, &content[..])).collect();
    Model::from_xml_str_with(text, &LoadOptions::default().with_files(&files)).map_err(|error| error.to_string())
}
