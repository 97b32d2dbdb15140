//! Scenes created through the C API, and their comparison with those of the library.

use std::mem::MaybeUninit;
use std::sync::Arc;

use mujoco_safe::Model;
use mujoco_safe::id::BodyId;
use mujoco_safe::scene::{LabelMode, Perturbation, Scene, SceneOptions, VisualFlags};
use mujoco_safe::sys::{self, mjvCamera, mjvGeom, mjvOption, mjvPerturb, mjvScene};

use crate::cases::cases;
use crate::twins::{Raw, Subject, c, differing, read, usual_subjects};

const EVERY_ELEMENT: &str = include_str!("../models/every_element.xml");

/// Swinging panel with a skin, which covers most of the picture.
const PANEL: &str = r#"
<mujoco>
  <asset>
    <skin name="cover" vertex="-1 0 -1  1 0 -1  -1 0 1  1 0 1" face="0 1 2  1 3 2  0 2 1  1 2 3">
      <bone body="panel" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2 3" vertweight="1 1 1 1"/>
    </skin>
  </asset>
  <worldbody>
    <body name="panel" pos="0 0 1"><joint axis="0 0 1"/><geom type="box" size="0.5 0.01 0.5"/></body>
  </worldbody>
</mujoco>"#;

/// Returns the model with every element, a panel with a skin, and all other models except the
/// largest.
pub(crate) fn scene_subjects() -> Vec<Subject> {
    let every = Model::from_xml_str(EVERY_ELEMENT).unwrap();
    let others = usual_subjects()
        .step_by(cases(2, 1))
        .map(|subject| Subject { name: subject.name.clone(), model: subject.model.clone() });
    let panel = Model::from_xml_str(PANEL).unwrap();
    let own = [("every element", every), ("panel", panel)];
    let own = own.map(|(name, model)| Subject { name: name.to_owned(), model: Arc::new(model) });
    own.into_iter().chain(others).collect()
}

/// Returns a structure that an engine function fills in.
pub(crate) fn filled<T>(fill: impl FnOnce(*mut T)) -> T {
    let mut value = MaybeUninit::zeroed();
    fill(value.as_mut_ptr());
    // SAFETY: used only for structures of numbers, for which all zeros are valid.
    unsafe { value.assume_init() }
}

fn raw_label(label: LabelMode) -> i32 {
    let constant = match label {
        LabelMode::None => sys::mjLABEL_NONE,
        LabelMode::Body => sys::mjLABEL_BODY,
        LabelMode::Joint => sys::mjLABEL_JOINT,
        LabelMode::Geom => sys::mjLABEL_GEOM,
        LabelMode::Site => sys::mjLABEL_SITE,
        LabelMode::Camera => sys::mjLABEL_CAMERA,
        LabelMode::Light => sys::mjLABEL_LIGHT,
        LabelMode::Tendon => sys::mjLABEL_TENDON,
        LabelMode::Actuator => sys::mjLABEL_ACTUATOR,
        LabelMode::Constraint => sys::mjLABEL_CONSTRAINT,
        LabelMode::Flex => sys::mjLABEL_FLEX,
        LabelMode::Skin => sys::mjLABEL_SKIN,
        LabelMode::Selection => sys::mjLABEL_SELECTION,
        LabelMode::SelectionPoint => sys::mjLABEL_SELPNT,
        LabelMode::ContactPoint => sys::mjLABEL_CONTACTPOINT,
        LabelMode::ContactForce => sys::mjLABEL_CONTACTFORCE,
        LabelMode::Island => sys::mjLABEL_ISLAND,
        _ => panic!("no constant for {label:?}"),
    };
    constant as i32
}

pub(crate) fn raw_options(options: &SceneOptions) -> mjvOption {
    let mut raw = filled(|raw| c!(mjv_defaultOption(raw)));
    raw.label = raw_label(options.label);
    raw.frame = options.frame as i32;
    raw.geomgroup = options.geomgroup.map(u8::from);
    raw.sitegroup = options.sitegroup.map(u8::from);
    raw.jointgroup = options.jointgroup.map(u8::from);
    raw.tendongroup = options.tendongroup.map(u8::from);
    raw.actuatorgroup = options.actuatorgroup.map(u8::from);
    raw.skingroup = options.skingroup.map(u8::from);
    for (bit, flag) in raw.flags.iter_mut().enumerate() {
        *flag = options.flags.contains(VisualFlags::from_bits_retain(1 << bit)).into();
    }
    raw
}

pub(crate) fn raw_perturbation(ours: &Perturbation) -> mjvPerturb {
    let mut raw: mjvPerturb = filled(|raw| c!(mjv_defaultPerturb(raw)));
    raw.select = ours.select.map_or(0, |body: BodyId| body.index() as i32);
    raw.skinselect = ours.skinselect.map_or(-1, |skin| skin.index() as i32);
    (raw.active, raw.active2) = (ours.active.bits() as i32, ours.active2.bits() as i32);
    (raw.refpos, raw.refquat) = (ours.refpos, ours.refquat);
    (raw.localpos, raw.scale) = (ours.localpos, ours.scale);
    differing::target_selected_point(&mut raw);
    raw
}

pub(crate) struct RawScene(pub(crate) Box<mjvScene>);

impl RawScene {
    pub(crate) fn new(raw: &Raw, maxgeom: i32) -> Self {
        let mut scene: Box<mjvScene> = Box::new(filled(|scene| c!(mjv_defaultScene(scene))));
        c!(mjv_makeScene(raw.m(), &raw mut *scene, maxgeom));
        Self(scene)
    }

    pub(crate) fn update(
        &mut self,
        raw: &Raw,
        options: &SceneOptions,
        pert: Option<&Perturbation>,
        cam: &mut mjvCamera,
    ) {
        let options = raw_options(options);
        let pert = pert.map(raw_perturbation);
        let pert = pert.as_ref().map_or(std::ptr::null(), std::ptr::from_ref);
        c!(mjv_updateScene(raw.m(), raw.d, &raw const options, pert, cam, sys::mjCAT_ALL as i32, &raw mut *self.0));
    }

    pub(crate) fn geoms(&self) -> Vec<mjvGeom> {
        // SAFETY: the engine's array has this length.
        unsafe { read(self.0.geoms, 0, self.0.ngeom as usize) }
    }
}

impl Drop for RawScene {
    fn drop(&mut self) {
        c!(mjv_freeScene(&raw mut *self.0));
    }
}

/// Returns the label up to its terminating NUL.
fn label(geom: &mjvGeom) -> Vec<u8> {
    geom.label[..99].iter().take_while(|&&byte| byte != 0).map(|&byte| byte as u8).collect()
}

/// Returns every value that an update sets.
fn numbers(geom: &mjvGeom) -> (Vec<i32>, Vec<u32>, Vec<u8>) {
    #[cfg(any(not(engine_since = "3.2.1"), engine_since = "3.17.0"))]
    let (material, repeat) = ([geom.texid, geom.texuniform], geom.texrepeat);
    #[cfg(all(engine_since = "3.2.1", not(engine_since = "3.17.0")))]
    let (material, repeat) = ([geom.matid, 0], [0.0; 2]);
    let others = [geom.type_, geom.dataid, geom.objtype, geom.objid, geom.category, geom.texcoord, geom.segid];
    let integers = [&others[..], &material].concat();
    let surface = [geom.emission, geom.specular, geom.shininess, geom.reflectance, geom.modelrbound];
    let reals = repeat.iter().chain(&geom.size).chain(&geom.pos).chain(&geom.mat).chain(&geom.rgba);
    (integers, reals.chain(&surface).map(|number| number.to_bits()).collect(), label(geom))
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Asserts that two scenes are equal.
#[track_caller]
pub(crate) fn assert_same_scene(what: &str, ours: &Scene, theirs: &RawScene, with_skins: bool) {
    // SAFETY: the scene is alive, and nothing writes to it during this call.
    let our_raw = unsafe { &*ours.as_ptr() };
    // SAFETY: the length is the engine's count.
    let our_geoms = unsafe { read(our_raw.geoms, 0, ours.ngeom()) };
    let their_geoms = theirs.geoms();
    assert_eq!(our_geoms.len(), their_geoms.len(), "{what}: geoms");
    for (index, (ours, theirs)) in our_geoms.iter().zip(&their_geoms).enumerate() {
        assert_eq!(numbers(ours), numbers(theirs), "{what}: geom {index}");
    }
    assert_eq!(our_raw.nlight, theirs.0.nlight, "{what}: lights");
    for (ours, theirs) in our_raw.lights.iter().zip(&theirs.0.lights).take(our_raw.nlight as usize) {
        assert_eq!(format!("{ours:?}"), format!("{theirs:?}"), "{what}: a light");
    }
    assert_eq!(format!("{:?}", our_raw.camera), format!("{:?}", theirs.0.camera), "{what}: eyes");
    let vertices: usize = ours.skins().map(|skin| skin.vertices.len()).sum();
    if with_skins {
        let flat = |pick: fn(&mujoco_safe::scene::SceneSkin<'_>) -> Vec<f32>| -> Vec<f32> {
            ours.skins().flat_map(|skin| pick(&skin)).collect()
        };
        // SAFETY: three numbers for each vertex of the skins.
        let (their_vertices, their_normals) =
            unsafe { (read(theirs.0.skinvert, 0, 3 * vertices), read(theirs.0.skinnormal, 0, 3 * vertices)) };
        assert_eq!(
            bits(&flat(|skin| skin.vertices.as_flattened().to_vec())),
            bits(&their_vertices),
            "{what}: vertices"
        );
        assert_eq!(bits(&flat(|skin| skin.normals.as_flattened().to_vec())), bits(&their_normals), "{what}: normals");
    }
}
