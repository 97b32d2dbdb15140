//! Contacts of edited geoms: the engine skips pairs of geoms by bounding boxes, margins and masks
//! that its compiler derived.

#![forbid(unsafe_code)]

use std::sync::Arc;

use mujoco_safe::model::{DisableFlags, EnableFlags};
use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
use mujoco_safe::{Data, Error, Model, ModelMut};

/// Three boxes below a body of three spheres, far apart, with these attributes of the first sphere.
fn model(sphere: &str, others: &str) -> Model {
    Model::from_xml_str(&format!(
        r#"<mujoco><worldbody>
             <geom type="box" size=".1 .1 .1" pos="-1 0 0"/><geom type="box" size=".1 .1 .1"/>
             <geom type="box" size=".1 .1 .1" pos="1 0 0"/>
             <body name="body" pos="0 0 1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/>
               <geom name="sphere" {sphere}/><geom size=".05" {others}/><geom size=".05" pos="1 0 0" {others}/>
             </body>
           </worldbody></mujoco>"#
    ))
    .unwrap()
}

const PLAIN: &str = r#"size=".05" pos="-1 0 0""#;
const NO_CONTACT: &str = r#"contype="0" conaffinity="0""#;

fn contacts(mut data: Data) -> usize {
    data.forward().unwrap();
    data.contacts().count()
}

/// Checks that a simulation has one contact after an edit, with and without `update_constants`.
fn check(what: &str, model: &Model, edit: impl Fn(&mut ModelMut<'_>)) {
    assert_eq!(contacts(Data::new(model.clone()).unwrap()), 0, "{what}");
    for updates in [false, true] {
        let mut edited = model.clone();
        edit(&mut edited.edit());
        if updates {
            edited.edit().update_constants().unwrap();
        }
        assert_eq!(contacts(Data::new(Arc::new(edited.clone())).unwrap()), 1, "{what}, shared, {updates}");
        assert_eq!(contacts(Data::new(edited).unwrap()), 1, "{what}, {updates}");
        let mut data = Data::new(model.clone()).unwrap();
        data.edit_model(|model| {
            edit(model);
            if updates { model.update_constants() } else { Ok(()) }
        })
        .unwrap();
        assert_eq!(contacts(data), 1, "{what}, in a simulation, {updates}");
    }
}

/// The compiler of 3.5.0 leaves ids of an earlier hierarchy in the nodes of a body that contains
/// another.
#[test]
fn bodies_that_contain_fused_ones_keep_their_contacts() {
    for far in [-1, 1] {
        let text = format!(
            r#"<mujoco><compiler fusestatic="true"/><worldbody><geom type="box" size=".1 .1 .1" pos="{far} 0 0"/>
                 <body pos="0 0 .12"><freejoint/><geom size=".05" pos="1 0 0"/><body pos="-1 0 0"><geom size=".05"/></body></body>
               </worldbody></mujoco>"#
        );
        let mut model = Model::from_xml_str(&text).unwrap();
        assert_eq!(contacts(Data::new(model.clone()).unwrap()), 1, "{far}");
        model.edit().update_constants().unwrap();
        assert_eq!(contacts(Data::new(model).unwrap()), 1, "{far}, updated");
    }
}

#[test]
fn edited_sizes_positions_and_margins_find_their_contacts() {
    let plain = model(PLAIN, "");
    check("size", &plain, |model| model.geom_mut("sphere").unwrap().size_mut()[0] = 0.95);
    check("pos", &plain, |model| model.geom_mut("sphere").unwrap().pos_mut()[2] = -0.86);
    check("margin", &plain, |model| model.geom_mut("sphere").unwrap().set_margin(0.9));
    let capsule = model(r#"type="capsule" size=".05 .9" pos="-1 0 0" quat="1 1 0 0""#, "");
    check("quat", &capsule, |model| *model.geom_mut("sphere").unwrap().quat_mut() = [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn the_margin_of_the_override_option_finds_its_contacts() {
    let plain = model(PLAIN, NO_CONTACT);
    check("override", &plain, |model| {
        model
            .edit_options(|options| {
                options.enable |= EnableFlags::OVERRIDE;
                options.o_margin = 0.9;
            })
            .unwrap();
    });
}

#[test]
fn edited_masks_take_effect_at_once() {
    let near = r#"size=".95" pos="-1 0 0""#;
    for others in ["", NO_CONTACT] {
        let other_bit = model(&format!(r#"{near} contype="4" conaffinity="8""#), others);
        check("another bit", &other_bit, |model| model.geom_mut("sphere").unwrap().set_contype(1));
        let none = model(&format!("{near} {NO_CONTACT}"), others);
        check("no bit", &none, |model| model.geom_mut("sphere").unwrap().set_conaffinity(1));
    }
}

#[test]
#[cfg_attr(not(engine_since = "2.3.3"), ignore = "the engine has no middle phase")]
fn a_geom_outside_of_the_hierarchy_disables_the_middle_phase() {
    let disabled = |model: &Model| model.options().disable.contains(DisableFlags::MIDPHASE);
    let mut edited = model(&format!(r#"size=".95" pos="-1 0 0" {NO_CONTACT}"#), "");
    assert!(!disabled(&edited));
    edited.edit().geom_mut("sphere").unwrap().set_contype(1);
    assert!(disabled(&edited));
    edited.edit().edit_options(|options| options.disable -= DisableFlags::MIDPHASE).unwrap();
    assert!(disabled(&edited), "the geom would have no contacts");
    edited.edit().update_constants().unwrap();
    assert_eq!(edited.geom("sphere").unwrap().contype(), 1);
    assert!(disabled(&Model::from_binary(&edited.to_binary().unwrap()).map_or(edited, |model| model)));
}

#[test]
fn a_moved_centre_of_mass_moves_no_bounding_box() {
    let mut edited = model(r#"size=".95" pos="-1 0 0""#, "");
    edited.edit().geom_mut("sphere").unwrap().size_mut()[0] = 0.95;
    edited.edit().body_mut("body").unwrap().ipos_mut()[0] = 9.0;
    assert_eq!(contacts(Data::new(edited).unwrap()), 1);
}

#[test]
fn sizes_in_a_batch_find_their_contacts() {
    let plain = Arc::new(model(PLAIN, ""));
    let size = Parameter::GeomSize(plain.geom("sphere").unwrap().id(), 0);
    let parameters = Parameters::new().with(&plain, size, Distribution::Unchanged).unwrap();
    let mut batch = Batch::new(&plain, 3).unwrap().with_parameters(parameters).unwrap();
    let sizes = [0.05, 0.95, 0.6];
    batch.set_parameters(|_| true, |index, values| values[0] = sizes[index]).unwrap();
    for _ in 0..100 {
        batch.step(|_, _| ()).unwrap();
    }
    for (index, size) in sizes.into_iter().enumerate() {
        let compiled = model(&format!(r#"size="{size}" pos="-1 0 0""#), "");
        let mut single = Data::new(compiled).unwrap();
        single.step_n(100).unwrap();
        let state = single.qpos();
        let differences = batch.states().row(index)[1..].iter().zip(state).map(|(left, right)| (left - right).abs());
        let largest = differences.fold(0.0, f64::max);
        assert!(largest < 1e-9, "{size}: {largest}");
    }
}

#[test]
#[cfg_attr(not(engine_since = "2.3.0"), ignore = "the engine computes with any inertia matrix")]
fn a_diagonal_inertia_matrix_stays_diagonal_or_is_rejected() {
    let free = model(PLAIN, "");
    assert_ne!(free.body_simple()[1], 0);
    for edit in [
        |model: &mut ModelMut<'_>| model.body_mut("body").unwrap().ipos_mut()[0] = 0.1,
        |model: &mut ModelMut<'_>| *model.body_mut("body").unwrap().iquat_mut() = [0.6, 0.8, 0.0, 0.0],
        |model: &mut ModelMut<'_>| model.jnt_pos_mut()[0] = [0.0; 3],
    ] {
        let mut edited = free.clone();
        edit(&mut edited.edit());
        let is_identity = edited.body_ipos()[1] == [0.0; 3] && edited.body_iquat()[1] == [1.0, 0.0, 0.0, 0.0];
        match edited.edit().update_constants() {
            Ok(()) => assert!(is_identity),
            Err(Error::Unsupported(text)) => assert!(!is_identity && text.contains("body 'body'"), "{text}"),
            Err(error) => panic!("{error:?}"),
        }
    }
}
