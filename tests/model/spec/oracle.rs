//! Operations of specs, compared with the engine: `mjSpec` where it has one (since 3.2), else the same elements compiled alone. All arrays
//! of the compiled models are compared.

#![allow(clippy::disallowed_methods, reason = "the engine's arrays are read without the library")]

use std::collections::BTreeMap;
use std::path::Path;

use mujoco_safe::spec::{Any, ElementId, Mount, Spec};
#[cfg(engine_since = "3.2.0")]
use mujoco_safe::sys;
use mujoco_safe::{Error, Model, Result};
#[cfg(engine_since = "3.2.0")]
use rand::RngExt;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::engine_spec::{self as raw, RawModel, Source};
use super::generated;
use super::reading::files;

/// Specs to which others are attached, without elements in the world: the attached elements are those of the model alone.
const EMPTY_PARENTS: [&str; 4] = [
    "<mujoco model='m'/>",
    "<mujoco model='m'><compiler angle='radian' autolimits='true'/></mujoco>",
    "<mujoco model='m'><compiler angle='degree' eulerseq='zyx' autolimits='false'/></mujoco>",
    "<mujoco model='m'><compiler angle='radian' autolimits='true'/>
       <default><geom size='.77 .5 .3' friction='3 2 1' euler='.1 .2 .3'/><joint type='slide' range='-.1 .1' ref='.2'/><motor gear='77' ctrlrange='-.5 .5'/>
         <tendon width='.1'/><site size='.3'/><equality solref='.5 1'/><material shininess='.1'/><mesh scale='7 7 7'/><camera fovy='11'/></default></mujoco>",
];

/// A spec with elements.
#[cfg(engine_since = "3.2.0")]
const PARENT: &str = "<mujoco model='m'><compiler angle='radian' eulerseq='ZYX' autolimits='true'/>
   <default><geom size='.77 .5 .3' margin='.01' euler='.1 .2 .3'/><joint damping='9' range='-.1 .1'/><default class='c'><site size='.3'/></default></default>
   <worldbody><geom name='own geom'/><site name='own site'/><body name='own body'><joint name='own joint'/><geom/></body></worldbody>
   <actuator><motor name='own motor' joint='own joint'/></actuator></mujoco>";

/// Results of operations.
#[derive(Default)]
struct Counts {
    operations: usize,
    /// Operations that both libraries perform with equal results.
    same: usize,
    /// Messages of operations that only the engine performs.
    refused: BTreeMap<String, usize>,
    /// Messages of operations that only this library performs.
    only_ours: BTreeMap<String, usize>,
    differ: Vec<String>,
}

impl Counts {
    fn compare(&mut self, what: &str, ours: Result<Model>, theirs: &RawModel, tolerance: f64, except: &[&str]) {
        self.operations += 1;
        let ours = match ours {
            Ok(model) => model,
            Err(error) => return self.refuse(what, &error),
        };
        let mut found = theirs.differences(&ours, tolerance, except);
        if tolerance > 0.0 {
            // The principal axes of equal inertias, and the inverse of a singular inertia, are those of rounding errors.
            let is_singular = ours.dof_invweight0().iter().any(|weight| *weight > 1e8);
            let arbitrary: &[&str] = if is_singular { &ROUNDED } else { &ROUNDED[..2] };
            found.retain(|field| !arbitrary.iter().any(|name| field.starts_with(&format!("{name}["))));
        }
        if found.is_empty() {
            self.same += 1;
        } else {
            let found: Vec<String> = found.into_iter().take(6).collect();
            self.differ.push(format!("{found:?} {what}"));
        }
    }

    /// Counts an error by the words of its message that are not names.
    fn refuse(&mut self, what: &str, error: &Error) {
        let message: String = error.to_string().split('\'').step_by(2).collect::<Vec<_>>().join("…");
        let message: String = message.chars().filter(|character| !character.is_ascii_digit()).take(150).collect();
        let known = self.refused.entry(message).or_default();
        *known += 1;
        if *known == 1 {
            println!("refused: {error} ({})", what.chars().take(100).collect::<String>());
        }
    }
}

const ROUNDED: [&str; 5] = ["body_iquat", "body_sameframe", "dof_invweight0", "body_invweight0", "actuator_acc0"];

/// Flags that this library corrects (`clear_wrong_simple_bodies`).
const CORRECTED: [&str; 2] = ["body_simple", "dof_simplenum"];

const KEYS: [&str; 8] = ["nkey", "key_time", "key_qpos", "key_qvel", "key_act", "key_ctrl", "key_mpos", "key_mquat"];

#[cfg(engine_since = "3.2.0")]
fn without_keyframes(spec: &Spec) -> Spec {
    let mut spec = spec.clone();
    for key in spec.ids::<mujoco_safe::kind::Keyframe>() {
        spec.remove(key).unwrap();
    }
    spec
}

fn elements(spec: &Spec) -> Vec<ElementId<Any>> {
    let mut found = Vec::new();
    let mut open = vec![spec.element(spec.world()).parent().unwrap()];
    while let Some(id) = open.pop() {
        found.push(id);
        open.extend(spec.element(id).children());
    }
    found
}

/// Performs all operations on a model.
fn check(source: &Source, rng: &mut Xoshiro256PlusPlus, counts: &mut Counts) {
    let name = source.name();
    let Some(reference) = raw::compile(source) else { return };
    let spec = match source.spec() {
        Ok(spec) => spec,
        Err(error) => {
            counts.operations += 1;
            return counts.refuse(&format!("read {name}"), &error);
        }
    };

    let read = spec.compile();
    if let Ok(model) = &read {
        // SAFETY: a valid model, whose names have this length.
        let names = unsafe {
            let raw = &*model.as_ptr();
            std::slice::from_raw_parts(raw.names.cast::<u8>(), raw.nnames as usize)
        };
        if names != reference.names() {
            counts.differ.push(format!("names of {name}"));
        }
    } else {
        return counts.compare(&format!("read {name}"), read, &reference, 0.0, &CORRECTED);
    }
    counts.compare(&format!("read {name}"), read, &reference, 0.0, &CORRECTED);
    let text = spec.to_xml();
    counts.operations += 1;
    match Spec::from_xml_str(&text) {
        Ok(again) if again.to_xml() == text => counts.same += 1,
        result => counts.differ.push(format!("text of {name}: {result:?}")),
    }

    rename(&name, &spec, &reference, counts);
    attach_to_empty(&name, &spec, &reference, counts);
    #[cfg(engine_since = "3.2.0")]
    {
        attach_as_the_engine(source, &spec, counts);
        remove_as_the_engine(source, &spec, rng, counts);
    }
    #[cfg(not(engine_since = "3.2.0"))]
    let _ = rng;
}

/// All names are replaced, so no array changes.
fn rename(name: &str, spec: &Spec, reference: &RawModel, counts: &mut Counts) {
    let all = elements(spec);
    // Names that these elements create start with those of others.
    let creates = |tag: &str| matches!(tag, "replicate" | "attach" | "composite" | "flexcomp" | "model" | "plugin");
    if all.iter().any(|&id| creates(spec.element(id).tag())) {
        return;
    }
    // The engine splits the names of flexes, and newer engines also those of tuples, at spaces.
    let has_list = all.iter().any(|&id| matches!(spec.element(id).tag(), "flex" | "tuple"));
    let space = if has_list { "_" } else { " " };
    let mut renamed = spec.clone();
    for (number, id) in all.into_iter().enumerate() {
        let element = renamed.element(id);
        let is_outer_class = element.tag() == "default"
            && element.parent().is_some_and(|parent| renamed.element(parent).parent().is_none());
        if element.name().is_some() && element.tag() != "worldbody" && !is_outer_class {
            renamed.edit(id).set_name(&format!("new{space}name {number}").replace(' ', space));
        }
    }
    counts.compare(&format!("rename {name}"), renamed.compile(), reference, 0.0, &CORRECTED);
}

/// The attached model is the model alone.
fn attach_to_empty(name: &str, spec: &Spec, reference: &RawModel, counts: &mut Counts) {
    for (number, parent) in EMPTY_PARENTS.iter().enumerate() {
        let mut outer = Spec::from_xml_str(parent).unwrap();
        // Attachments do not copy sizes.
        for id in elements(spec) {
            let section = spec.element(id);
            for (attribute, value) in section.attributes().filter(|_| section.tag() == "size") {
                outer.section_mut("size").unwrap().set(attribute, value).unwrap();
            }
        }
        let mount = Mount::body(outer.world());
        let prefix = ["", "p_", "left ", ""][number];
        let has_list = elements(spec).into_iter().any(|id| matches!(spec.element(id).tag(), "flex" | "tuple"));
        let prefix = if has_list { prefix.trim() } else { prefix };
        let attached = outer.attach(spec, mount, prefix).and_then(|_| outer.compile());
        let except = [&KEYS[..], &CORRECTED].concat();
        counts.compare(&format!("attach {number} {name}"), attached, reference, 1e-9, &except);
    }
}

#[cfg(engine_since = "3.2.0")]
fn attach_as_the_engine(source: &Source, spec: &Spec, counts: &mut Counts) {
    let name = source.name();
    let identity = ([0.0; 3], [1.0, 0.0, 0.0, 0.0]);
    let turned = ([0.3, -0.2, 0.5], [0.8, 0.0, 0.36, -0.48]);
    for (number, pose) in [(0, identity), (1, turned)] {
        let parent = Source::Text(PARENT.to_owned());
        let (Some(outer), Some(child)) = (raw::RawSpec::parse(&parent), raw::RawSpec::parse(source)) else { continue };
        let is_attached = outer.attach(&child.without_keyframes(), "p_", pose);
        let expected = outer.compile().filter(|_| is_attached);
        let mut ours = parent.spec().unwrap();
        let mount = Mount::body(ours.world()).with_pos(pose.0).with_quat(pose.1);
        let attached = ours.attach(spec, mount, "p_").and_then(|_| ours.compile());
        match expected {
            Some(expected) => counts.compare(
                &format!("mjs_attach {number} {name}"),
                attached,
                &expected,
                1e-9,
                &[&KEYS[..], &CORRECTED].concat(),
            ),
            None => {
                counts.operations += 1;
                *counts.only_ours.entry(outer.error().chars().take(60).collect()).or_default() += 1;
            }
        }
    }
}

#[cfg(engine_since = "3.2.0")]
fn remove_as_the_engine(source: &Source, spec: &Spec, rng: &mut Xoshiro256PlusPlus, counts: &mut Counts) {
    let name = source.name();
    let spec = without_keyframes(spec);
    let named: Vec<(ElementId<Any>, u32, String)> = (elements(&spec).into_iter())
        .filter_map(|id| {
            let element = spec.element(id);
            let kind = match element.tag() {
                "body" => sys::mjOBJ_BODY,
                "joint" | "freejoint" => sys::mjOBJ_JOINT,
                "geom" => sys::mjOBJ_GEOM,
                "site" => sys::mjOBJ_SITE,
                "camera" => sys::mjOBJ_CAMERA,
                "light" => sys::mjOBJ_LIGHT,
                "motor" | "position" | "general" | "muscle" => sys::mjOBJ_ACTUATOR,
                "spatial" | "fixed" => sys::mjOBJ_TENDON,
                "weld" | "connect" => sys::mjOBJ_EQUALITY,
                _ => return None,
            };
            Some((id, kind as u32, element.attribute("name")?.to_owned()))
        })
        .collect();
    for _ in 0..named.len().min(6) {
        let (id, kind, element) = &named[rng.random_range(0..named.len())];
        let Some(raw) = raw::RawSpec::parse(source).map(raw::RawSpec::without_keyframes) else { return };
        let mut ours = spec.clone();
        let removed = ours.remove_with_references(*id).and_then(|()| ours.compile());
        let expected = raw.remove(*kind, element).then(|| raw.compile()).flatten();
        match (expected, removed) {
            (Some(expected), removed) => {
                counts.compare(
                    &format!("remove '{element}' ({kind}) {name}"),
                    removed,
                    &expected,
                    1e-12,
                    &[&KEYS[..], &CORRECTED].concat(),
                );
            }
            (None, Ok(_)) => {
                counts.operations += 1;
                *counts.only_ours.entry(raw.error().chars().take(60).collect()).or_default() += 1;
            }
            (None, Err(_)) => counts.operations += 1,
        }
    }
}

fn is_verbose() -> bool {
    std::env::var_os("VERBOSE").is_some()
}

fn finish(counts: &Counts, models: usize) {
    println!(
        "{models} models, {} operations: {} equal, {} differ, {} refused, {} performed here only",
        counts.operations,
        counts.same,
        counts.differ.len(),
        counts.refused.values().sum::<usize>(),
        counts.only_ours.values().sum::<usize>()
    );
    println!("refused: {:#?}\nonly here: {:#?}", counts.refused, counts.only_ours);
    for difference in &counts.differ {
        println!("DIFFERS {}", difference.chars().take(if is_verbose() { 5000 } else { 300 }).collect::<String>());
    }
    assert!(counts.differ.is_empty(), "{} differences", counts.differ.len());
}

/// Generated models: joints, orientations, limits and references with all combinations of classes.
#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "a campaign")]
fn operations_on_generated_models_agree_with_the_engine() {
    let count = std::env::var("SPECS").ok().and_then(|number| number.parse().ok()).unwrap_or(25);
    let mut counts = Counts::default();
    for seed in 0..count {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        // The compiler rejects some combinations.
        let texts = std::iter::repeat_with(|| Source::Text(generated::text(&mut rng))).take(20);
        let Some(source) = texts.into_iter().find(|source| raw::compile(source).is_some()) else { continue };
        check(&source, &mut rng, &mut counts);
    }
    assert!(counts.operations as u64 > 4 * count, "{} operations", counts.operations);
    finish(&counts, count as usize);
}

/// A model for each attribute of the engine's schema, in which the attribute has another value than by default.
#[test]
#[ignore = "a campaign"]
fn operations_on_models_of_the_schema_agree_with_the_engine() {
    use super::super::schema_models::{Effect, attributes, case, files};

    load_plugins();
    let part = |name: &str, default: usize| std::env::var(name).map_or(default, |number| number.parse().unwrap());
    let (skip, take) = (part("SKIP", 0), part("SPECS", usize::MAX));
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files() {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    let mut counts = Counts::default();
    let mut models = 0;
    for attribute in attributes().into_iter().skip(skip).take(take) {
        let Ok(found) = case(&attribute, Effect::Stored) else { continue };
        let path = folder.path().join(format!("{}_{}.xml", attribute.element, attribute.name).replace('/', "-"));
        std::fs::write(&path, &found.text).unwrap();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(models);
        let before = counts.operations;
        check(&Source::File(path), &mut rng, &mut counts);
        models += u64::from(counts.operations > before);
    }
    finish(&counts, models as usize);
}

fn load_plugins() {
    #[cfg(engine_since = "2.3.0")]
    if let Some(plugins) = std::env::var_os("MUJOCO_SAFE_PLUGINS") {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(Path::new(&plugins)) }.unwrap();
    }
}

/// Models in a directory.
#[test]
#[ignore = "needs a directory of models"]
fn real_specs_agree_with_the_engine() {
    let path = std::env::var_os("MUJOCO_SAFE_MODELS").expect("MUJOCO_SAFE_MODELS is a directory");
    load_plugins();
    let mut counts = Counts::default();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut models = 0;
    for path in files(Path::new(&path)) {
        let before = counts.operations;
        check(&Source::File(path), &mut rng, &mut counts);
        models += usize::from(counts.operations > before);
    }
    assert!(models > 0);
    finish(&counts, models);
}
