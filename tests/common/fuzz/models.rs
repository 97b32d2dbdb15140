//! The corpus: models for sequences of calls and for binary models.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use mujoco_safe::{Model, sample};

use super::Bytes;
use super::newer_models::{NEWER, Newer};
use super::schema_models::{self, Attribute, Effect};

/// A model of the corpus.
pub(super) struct Source {
    pub(super) name: String,
    /// Relative number of cases with this model.
    share: usize,
    text: Text,
    /// `true` if the present engine loads the model. Otherwise it may reject it.
    must_load: bool,
}

enum Text {
    Here(String),
    File(PathBuf),
    /// A model with this attribute of the engine's schema.
    Attribute(Attribute),
}

pub(super) const ZOO: &str = include_str!("../../models/zoo.xml");
pub(super) const EVERY_ELEMENT: &str = include_str!("../../models/every_element.xml");

/// A small model that uses every callback.
pub(super) const ASSEMBLY: &str = include_str!("../../models/assembly.xml");

pub(super) const COLLIDERS: &str = include_str!("../../models/colliders.xml");

pub(super) const ADHESION: &str = r#"<mujoco>
  <size njmax="120" nconmax="12" nstack="30000"/>
  <worldbody>
    <geom type="plane" size="2 2 .1" margin=".02" gap=".02"/>
    <body name="pad" pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1" margin=".02" gap=".02" condim="4"/></body>
    <body name="ball" pos="0 0 .35"><freejoint/><geom size=".1" condim="6"/></body>
  </worldbody>
  <actuator>
    <adhesion body="pad" ctrlrange="0 1" gain="20"/>
    <adhesion body="ball" ctrlrange="0 1"/>
  </actuator>
</mujoco>"#;

/// Elements that the compiler creates and that older compilers do not know.
pub(super) const COPIES: &str = if cfg!(engine_since = "3.5.0") {
    r#"<mujoco>
  <worldbody>
    <replicate count="3" offset="0 1 0" sep="_"><body name="post"><joint name="hinge"/><geom size=".1"/><site name="tip"/></body></replicate>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" pos="0 0 1" radius=".01" mass=".1"/>
    <body name="free" pos="1 0 1"><freejoint/><geom size=".1"/></body>
  </worldbody>
  <actuator><motor name="motor" joint="hinge"/><adhesion name="pad" body="free" ctrlrange="0 1"/></actuator>
  <keyframe><key name="home" time="1" ctrl="1 2 3 4"/></keyframe>
</mujoco>"#
} else {
    r#"<mujoco>
  <worldbody>
    <body name="rB2" pos="0 0 1"><freejoint/><composite type="rope" count="5 1 1" spacing=".1" prefix="r">
      <joint kind="main" damping=".1"/><geom type="capsule" size=".01 .02"/></composite><geom size=".01"/></body>
  </worldbody>
  <keyframe><key name="home" time="1"/></keyframe>
</mujoco>"#
};

/// Name of the model whose simulations are created fastest.
pub(super) const SMALLEST: &str = "no joints";

/// Small models close to the engine's limits.
const TINY: [(&str, &str); 4] = [
    (
        "little room for contacts",
        r#"<mujoco><size njmax="7" nconmax="2"/><worldbody><geom type="plane" size="1 1 1"/>
        <body pos="0 0 .05"><freejoint/><geom type="box" size=".1 .1 .1"/></body><body pos="0 0 .2"><freejoint/><geom
        type="capsule" size=".1 .1"/></body></worldbody></mujoco>"#,
    ),
    (
        "little stack",
        r#"<mujoco><size njmax="60" nconmax="10" nstack="1200"/><worldbody><geom type="plane" size="1 1 1"/>
        <body pos="0 0 .05"><freejoint/><geom name="g" type="box" size=".1 .1 .1"/><site name="s"/></body></worldbody>
        <actuator><motor site="s" gear="0 0 1 0 0 0"/></actuator><sensor><accelerometer site="s"/></sensor></mujoco>"#,
    ),
    (
        SMALLEST,
        r#"<mujoco><size njmax="5" nconmax="5" nstack="1500"/><worldbody><geom type="plane" size="1 1 1"/><body mocap="true"><geom size=".1"/></body></worldbody>
        <keyframe><key mpos="0 0 1"/></keyframe></mujoco>"#,
    ),
    (
        "no constraints",
        r#"<mujoco><size njmax="0" nconmax="0" nstack="2000"/><option integrator="implicit"/><worldbody><geom type="plane"
        size="1 1 1"/><body><joint name="j"/><geom size=".1"/></body></worldbody><actuator><intvelocity joint="j"
        actrange="-1 1"/></actuator><sensor><jointpos joint="j"/></sensor></mujoco>"#,
    ),
];

/// Returns the corpus, which is the same on every machine that has the engine's samples.
pub(super) fn all() -> &'static [Source] {
    static ALL: OnceLock<Vec<Source>> = OnceLock::new();
    ALL.get_or_init(|| {
        let version = mujoco_safe::built_against();
        // Compilers of newer engines reject some models.
        let must_load = version.to_string() == "2.2.2";
        let here = |name: &str, share, text: &str| Source {
            name: name.to_owned(),
            share,
            text: Text::Here(text.to_owned()),
            must_load,
        };
        let file = |path: &Path, share| Source {
            name: path.file_name().expect("a file").display().to_string(),
            share,
            text: Text::File(path.to_owned()),
            must_load,
        };
        let mut all = vec![
            here("cartpole", 800, &smaller(sample::CARTPOLE_XML, 20, 5, 8000)),
            here("colliders", 800, &smaller(COLLIDERS, 90, 20, 24000)),
            here("adhesion", 600, ADHESION),
            here("assembly", 1000, ASSEMBLY),
            here("zoo", 400, &smaller(ZOO, 120, 24, 40000)),
            here("humanoid", 20, sample::HUMANOID_XML),
            here("every element", 20, EVERY_ELEMENT),
        ];
        all.extend(TINY.map(|(name, text)| here(name, 320, text)));
        for (name, share) in
            [("slider_crank/slider_crank.xml", 8), ("tendon_arm/arm26.xml", 4), ("adhesion/active_adhesion.xml", 1)]
        {
            let path = Path::new(sample::SYSTEM_MODELS).join(name);
            if path.exists() {
                all.push(file(&path, share));
            }
        }
        if cfg!(engine_since = "3.0.0") {
            all.extend(NEWER.map(|Newer { name, share, since, text }| {
                let must_load = since.is_some_and(|since| version >= since);
                Source { must_load, ..here(name, share, text) }
            }));
        }
        all.extend(schema_models::attributes().into_iter().map(|attribute| Source {
            name: attribute.to_string(),
            share: 1,
            text: Text::Attribute(attribute),
            must_load: false,
        }));
        all
    })
}

/// Reduces the arrays of constraints and the stack, whose allocation dominates the time to create a
/// simulation, and the iterations of the solver.
fn smaller(text: &str, njmax: usize, nconmax: usize, nstack: usize) -> String {
    let size =
        format!(r#"<size njmax="{njmax}" nconmax="{nconmax}" nstack="{nstack}"/><option iterations="20"/><worldbody>"#);
    text.replacen("<worldbody>", &size, 1)
}

/// Returns the index of the model of a case. The smallest model takes the place of a model that the
/// engine rejects.
pub(super) fn choose(bytes: &mut Bytes<'_>) -> usize {
    let mut ticket = bytes.below(all().iter().map(|source| source.share).sum());
    let index = all().iter().position(|source| {
        let found = ticket < source.share;
        ticket = ticket.saturating_sub(source.share);
        found
    });
    index.filter(|&index| loaded(index).is_some()).unwrap_or_else(|| index_of(SMALLEST))
}

/// Returns the index of the model of this name.
pub(super) fn index_of(name: &str) -> usize {
    all().iter().position(|source| source.name == name).expect("no model of this name")
}

/// Returns a model, loaded once per process.
pub(super) fn model(which: usize) -> &'static Arc<Model> {
    loaded(which).expect("the model does not load")
}

/// Returns the attribute of the engine's schema that a model is for.
pub(super) fn attribute(which: usize) -> Option<&'static Attribute> {
    match &all()[which].text {
        Text::Attribute(attribute) => Some(attribute),
        Text::Here(_) | Text::File(_) => None,
    }
}

/// Returns a model, or `None` if the engine rejects it.
pub(super) fn loaded(which: usize) -> Option<&'static Arc<Model>> {
    static LOADED: OnceLock<Vec<OnceLock<Option<Arc<Model>>>>> = OnceLock::new();
    let loaded = LOADED.get_or_init(|| all().iter().map(|_| OnceLock::new()).collect())[which].get_or_init(|| {
        let source = &all()[which];
        let model = match &source.text {
            Text::Here(text) => Model::from_xml_str(text),
            Text::File(path) => Model::from_xml_path(path),
            Text::Attribute(attribute) => {
                let case = schema_models::case(attribute, Effect::None);
                return case.and_then(|case| schema_models::load(&case.text)).ok().map(Arc::new);
            }
        };
        if let (Err(error), true) = (&model, source.must_load) {
            panic!("{} does not load: {error}", source.name);
        }
        model.ok().map(Arc::new)
    });
    loaded.as_ref()
}
