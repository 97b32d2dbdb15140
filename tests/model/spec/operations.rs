//! Operations of a spec, compared with the engine: `mjSpec` where it has one (since 3.2), else the
//! same elements compiled alone. All arrays of the compiled models are compared.

#![allow(clippy::disallowed_methods, reason = "the engine's arrays are read without the library")]

use mujoco_safe::spec::{Mount, Spec};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::counts::Counts;
use super::elements;
use super::engine_spec::{self as raw, RawModel, Source};
use super::{alone, removal};

/// Specs to which others are attached, without elements in the world: the attached elements are
/// those of the model alone.
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
   <worldbody><geom name='own geom'/><site name='own site'/><body name='own body'><joint name='own joint'/><geom/>
   <site name='own mount' pos='.1 .2 .3' euler='.4 .5 .6'/></body></worldbody>
   <actuator><motor name='own motor' joint='own joint'/></actuator></mujoco>";

/// Values that this library corrects (`clear_wrong_simple_bodies`, `reserve_moments`).
pub(super) const CORRECTED: [&str; 3] = ["body_simple", "dof_simplenum", "nJmom"];

pub(super) const KEYS: [&str; 8] =
    ["nkey", "key_time", "key_qpos", "key_qvel", "key_act", "key_ctrl", "key_mpos", "key_mquat"];

/// Performs all operations on a model.
pub(super) fn check(source: &Source, rng: &mut Xoshiro256PlusPlus, counts: &mut Counts) {
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
    counts.compare(&format!("read {name}"), spec.compile(), &reference, 0.0, &CORRECTED);
    let text = spec.to_xml();
    counts.operations += 1;
    match Spec::from_xml_str(&text) {
        Ok(again) if again.to_xml() == text => counts.same += 1,
        result => counts.differ.push(format!("text of {name}: {result:?}")),
    }

    rename(&name, &spec, &reference, counts);
    attach_to_empty(&name, &spec, &reference, counts);
    #[cfg(engine_since = "3.2.0")]
    attach_as_the_engine(source, &spec, counts);
    if let Ok(model) = read {
        alone::check(&name, &spec, model, rng, counts);
    }
    removal::check(source, &spec, rng, counts);
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
        copy_settings(spec, &mut outer);
        let mount = Mount::body(outer.world());
        let prefix = ["", "p_", "left ", ""][number];
        let has_list = elements(spec).into_iter().any(|id| matches!(spec.element(id).tag(), "flex" | "tuple"));
        let prefix = if has_list { prefix.trim() } else { prefix };
        let attached = outer.attach(spec, mount, prefix).and_then(|_| outer.compile());
        if let Ok(model) = &attached {
            let expected = |name: &str| if name == "world" { name.to_owned() } else { format!("{prefix}{name}") };
            counts.differ.extend(
                reference.different_name(model, expected).map(|name| format!("{name}, attach {number} {name}")),
            );
        }
        let except = [&KEYS[..], &CORRECTED].concat();
        counts.compare(&format!("attach {number} {name}"), attached, reference, 1e-9, &except);
    }
}

/// Copies the sizes and settings of a model as a whole, which attachments do not copy: `mjs_attach`
/// uses those of the outer spec too.
fn copy_settings(spec: &Spec, outer: &mut Spec) {
    for id in elements(spec) {
        let element = spec.element(id);
        let is_copied = |attribute| match element.tag() {
            // The compiler computes ranges of lengths, and stores the near plane for cameras
            // without intrinsics.
            "size" | "lengthrange" | "map" => true,
            "compiler" => ["discardvisual", "fusestatic"].contains(&attribute),
            _ => false,
        };
        let section = match element.tag() {
            "lengthrange" => "compiler",
            "map" => "visual",
            tag => tag,
        };
        for (attribute, value) in element.attributes().filter(|(attribute, _)| is_copied(*attribute)) {
            let mut copy = outer.section_mut(section).unwrap();
            if element.tag() == section {
                copy.set(attribute, value).unwrap();
            } else {
                copy.child_mut(element.tag()).unwrap().set(attribute, value).unwrap();
            }
        }
    }
}

/// Way to attach a spec to [`PARENT`].
#[cfg(engine_since = "3.2.0")]
#[derive(Clone, Copy, Debug)]
enum Way {
    World,
    Turned,
    /// To a site in a body.
    Site,
    /// To another spec, which is attached in turn.
    Nested,
}

#[cfg(engine_since = "3.2.0")]
impl Way {
    const TURNED: ([f64; 3], [f64; 4]) = ([0.3, -0.2, 0.5], [0.8, 0.0, 0.36, -0.48]);

    /// Attaches with the engine. Returns the outer spec and whether all attachments succeeded.
    fn raw(self, child: &raw::RawSpec) -> (raw::RawSpec, bool) {
        let parent = || raw::RawSpec::parse(&Source::Text(PARENT.to_owned())).unwrap();
        let outer = parent();
        let is_attached = match self {
            Self::World => outer.attach(child, "p_", ([0.0; 3], [1.0, 0.0, 0.0, 0.0])),
            Self::Turned => outer.attach(child, "p_", Self::TURNED),
            Self::Site => outer.attach_to_site(child, "p_", c"own mount"),
            Self::Nested => {
                let middle = parent();
                middle.attach(child, "p_", Self::TURNED) && outer.attach(&middle, "q_", Self::TURNED)
            }
        };
        (outer, is_attached)
    }

    fn ours(self, child: &Spec) -> mujoco_safe::Result<Spec> {
        let mut outer = Spec::from_xml_str(PARENT).unwrap();
        let turned = |spec: &Spec| Mount::body(spec.world()).with_pos(Self::TURNED.0).with_quat(Self::TURNED.1);
        match self {
            Self::World => outer.attach(child, Mount::body(outer.world()), "p_")?,
            Self::Turned => outer.attach(child, turned(&outer), "p_")?,
            Self::Site => outer.attach(child, Mount::site(outer.site("own mount")?.id()), "p_")?,
            Self::Nested => {
                let mut middle = outer.clone();
                middle.attach(child, turned(&middle), "p_")?;
                outer.attach(&middle, turned(&outer), "q_")?
            }
        };
        Ok(outer)
    }
}

#[cfg(engine_since = "3.2.0")]
fn attach_as_the_engine(source: &Source, spec: &Spec, counts: &mut Counts) {
    if writes_beyond_an_array(spec) {
        return;
    }
    for way in [Way::World, Way::Turned, Way::Site, Way::Nested] {
        let Some(child) = raw::RawSpec::parse(source) else { continue };
        let (outer, is_attached) = way.raw(&child.without_keyframes());
        // In a body, the world of the attached spec becomes the body. The engine keeps it. At a
        // pose, the engine does not move anchors in the world. `moved` tests those of this library.
        let world: &[&str] = match way {
            Way::Site => &["eq_obj1id", "eq_obj2id", "eq_data", "exclude_signature"],
            Way::Turned | Way::Nested if has_anchor_in_world(spec) => &["eq_data"],
            _ => &[],
        };
        if let Some(expected) = outer.compile().filter(|_| is_attached) {
            let ours = way.ours(spec).and_then(|spec| spec.compile());
            let name = ours.as_ref().ok().and_then(|ours| expected.different_name(ours, str::to_owned));
            counts.differ.extend(name.map(|name| format!("{name}, mjs_attach {way:?} {}", source.name())));
            counts.compare(
                &format!("mjs_attach {way:?} {}", source.name()),
                ours,
                &expected,
                1e-9,
                &[&KEYS[..], &CORRECTED, world].concat(),
            );
        } else {
            counts.operations += 1;
            *counts.only_ours.entry(outer.error().chars().take(60).collect()).or_default() += 1;
        }
    }
}

/// Returns `true` if a class has joints with more positions than others. `mjs_attach` and
/// `mjs_delete` of engines from 3.2 to 3.12 write the positions of a joint as if it had the type of
/// its class, beyond the end of an array if its own type has fewer.
#[cfg(engine_since = "3.2.0")]
pub(super) fn writes_beyond_an_array(spec: &Spec) -> bool {
    elements(spec).into_iter().map(|id| spec.element(id)).any(|element| {
        let is_default = element.parent().is_some_and(|parent| spec.element(parent).tag() == "default");
        let is_wide = element.tag() == "joint" && matches!(element.attribute("type"), Some("ball" | "free"));
        cfg!(not(engine_since = "3.17.0")) && is_default && is_wide
    })
}

#[cfg(engine_since = "3.2.0")]
fn has_anchor_in_world(spec: &Spec) -> bool {
    elements(spec).into_iter().map(|id| spec.element(id)).any(|element| {
        let is_world = |name| element.attribute(name).is_none_or(|body| body == "world");
        match element.tag() {
            "weld" => element.attribute("body1").is_some() && is_world("body2"),
            "connect" => element.attribute("body1") == Some("world"),
            _ => false,
        }
    })
}
