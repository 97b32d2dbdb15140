//! The argument of a contact filter is the decision of the engine's own rule.

#![forbid(unsafe_code)]

use mujoco_safe::callback::Callbacks;
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Data, Model, Result, sample};

use crate::cases::cases;
use crate::child;

/// The geoms and the distance of each contact.
type Contacts = Vec<([usize; 2], f64)>;

fn contacts(data: &Data) -> Contacts {
    data.contacts().map(|contact| (contact.geoms().unwrap().map(|geom| geom.index()), contact.dist())).collect()
}

/// Returns models with contacts between bodies, with the world, and within chains of bodies. Newer
/// engines lack some of their elements.
fn models() -> Vec<Model> {
    let samples = [sample::humanoid(), sample::half_cheetah(), sample::hopper()];
    let files = ["every_element", "colliders", "composites", "zoo"];
    let load = |name| Model::from_xml_path(format!("{}/tests/models/{name}.xml", env!("CARGO_MANIFEST_DIR")));
    let models: Vec<Model> = samples.into_iter().chain(files.into_iter().filter_map(|name| load(name).ok())).collect();
    assert!(models.len() == 7 || cfg!(engine_since = "2.3.0") && models.len() >= 4);
    models
}

/// Detects the contacts, without the constraint forces of [`Data::forward`].
fn collide(data: &mut Data) -> Result<()> {
    data.kinematics()?;
    data.com_pos()?;
    data.collision()
}

/// Returns a simulation at the first keyframe, or else at the reference: the state with more
/// contacts.
fn dense(model: &Model) -> Data {
    let mut data = Data::new(model.clone()).unwrap();
    if model.nkey() > 0 {
        data.reset_to_key(0).unwrap();
    }
    data
}

#[test]
fn a_filter_that_returns_its_argument_changes_nothing() {
    // The engine applies its own rule only in a process that never had a filter.
    if !child::is_child() {
        return child::passes("contact_filter::a_filter_that_returns_its_argument_changes_nothing");
    }
    // Models, because a simulation can take a gigabyte.
    let mut models_and_contacts: Vec<(Model, Contacts)> = Vec::new();
    for mut model in models().into_iter().filter(|model| model.nv() <= cases(60, usize::MAX)) {
        for disable in [DisableFlags::empty(), DisableFlags::FILTERPARENT] {
            model.edit().edit_options(|options| options.disable = disable).unwrap();
            let mut data = dense(&model);
            if collide(&mut data).is_ok() {
                models_and_contacts.push((model.clone(), contacts(&data)));
            }
        }
    }
    assert!(models_and_contacts.iter().map(|(_, contacts)| contacts.len()).sum::<usize>() > 30);
    for (model, expected) in models_and_contacts {
        let mut data = dense(&model);
        let callbacks = Callbacks::new().with_contact_filter(|_, _, collide| collide);
        data.with_callbacks(callbacks, collide).unwrap();
        assert_eq!(contacts(&data), expected, "{model:?}");
        // A simulation without a filter, in a process that has used one, behaves the same.
        let mut without = dense(&model);
        collide(&mut without).unwrap();
        assert_eq!(contacts(&without), expected, "{model:?}");
    }
}
