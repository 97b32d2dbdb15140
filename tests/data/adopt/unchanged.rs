//! An edit that changes nothing, or nothing that a step reads, leaves all later steps as they are.

use mujoco_safe::data::MissingResults;
use mujoco_safe::model::Adoption;
use mujoco_safe::spec::Spec;
use mujoco_safe::{Data, Model, StateSpec, sample};

use super::mixed_text;

/// A flex that falls on a sphere and a plane.
const CLOTH: &str =
    "<mujoco><option timestep='.003'/><worldbody><geom type='plane' size='1 1 .1'/><geom size='.1' pos='0 0 .1'/>
    <flexcomp name='cloth' type='grid' dim='2' count='4 4 1' spacing='.05 .05 .05' radius='.01' mass='.2' pos='0 0 .25'>
      <edge equality='true' damping='.01'/><contact selfcollide='none'/></flexcomp></worldbody></mujoco>";

/// Steps two simulations, and compares the states bit for bit.
#[track_caller]
fn same_steps(mut a: Data, mut b: Data, steps: usize) {
    for step in 0..steps {
        for data in [&mut a, &mut b] {
            // The mocap body and the controls move.
            let phase = 0.01 * step as f64;
            data.ctrl_mut().iter_mut().for_each(|control| *control = 0.3 * phase.sin());
            data.mocap_pos_mut().iter_mut().for_each(|pos| pos[2] += 0.001 * phase.cos());
            data.step().unwrap();
        }
        let [left, right] = [&a, &b].map(|data| data.state(StateSpec::all()));
        let same = left.iter().zip(&right).all(|(left, right)| left.to_bits() == right.to_bits());
        assert!(same && left.len() == right.len(), "step {step}");
    }
}

fn models() -> Vec<Spec> {
    let path = |name: &str| format!("{}/models/{name}.xml", env!("CARGO_MANIFEST_DIR"));
    let files = ["humanoid", "cartpole"].map(|name| Spec::from_xml_path(path(name)).unwrap());
    let texts: &[&str] = if cfg!(engine_since = "3.5.0") { &[CLOTH] } else { &[] };
    let texts = texts.iter().map(|text| Spec::from_xml_str(text).unwrap());
    files.into_iter().chain([Spec::from_xml_str(&mixed_text()).unwrap()]).chain(texts).collect()
}

/// Starts a simulation that moves, with equality constraints that are not as in the model.
fn started(model: Model) -> Data {
    let mut data = Data::new(model).unwrap();
    data.qvel_mut().iter_mut().enumerate().for_each(|(dof, speed)| *speed = 0.1 * (dof as f64).sin());
    data.userdata_mut().fill(7.0);
    for index in 0..data.model().neq() {
        data.set_equality_active(index, index % 2 == 0).unwrap();
    }
    data.qfrc_applied_mut().fill(0.01);
    data.xfrc_applied_mut().as_flattened_mut().fill(0.02);
    data.step_n(50).unwrap();
    data
}

#[test]
fn an_edit_that_changes_nothing_leaves_a_thousand_steps_bit_for_bit() {
    for spec in models() {
        let a = started(spec.compile().unwrap());
        let mut b = a.clone();
        // A constraint that was switched is an edit of the model.
        let has_equal_model = a.model().neq() < 2;
        let adoption = b.adopt(spec.compile().unwrap()).unwrap();
        assert_eq!(adoption, Adoption::default());
        assert_eq!(b.require(MissingResults::SENSORS).is_ok(), has_equal_model);
        same_steps(a, b, 1000);
    }
}

#[test]
fn the_same_file_leaves_a_thousand_steps_bit_for_bit() {
    for spec in models() {
        let text = spec.to_xml();
        let a = started(Model::from_xml_str(&text).unwrap());
        let mut b = a.clone();
        b.adopt(Model::from_xml_str(&text).unwrap()).unwrap();
        same_steps(a, b, 1000);
    }
}

#[test]
fn an_edit_of_what_no_step_reads_leaves_a_thousand_steps_bit_for_bit() {
    for mut spec in models() {
        let a = started(spec.compile().unwrap());
        let mut b = a.clone();
        let world = spec.world();
        spec.add_site(world).set_pos([1.0, 2.0, 3.0]);
        spec.add_camera(world);
        let adoption = b.adopt(spec.compile().unwrap()).unwrap();
        assert_eq!(adoption, Adoption::default());
        assert!(b.require(MissingResults::SENSORS).is_err(), "results of another model");
        same_steps(a, b, 1000);
    }
}

#[test]
fn sleeping_bodies_sleep_on_if_nothing_changes() {
    let mut spec = Spec::from_xml_str(
        "<mujoco><worldbody><geom type='plane' size='1 1 .1'/>
           <body pos='0 0 .1'><freejoint/><geom type='box' size='.1 .1 .1'/></body></worldbody></mujoco>",
    )
    .unwrap();
    #[cfg(engine_since = "3.5.0")]
    spec.section_mut("option").unwrap().child_mut("flag").unwrap().set("sleep", "enable").unwrap();
    spec.section_mut("option").unwrap().set("timestep", 0.005).unwrap();
    let mut a = Data::new(spec.compile().unwrap()).unwrap();
    a.step_n(2000).unwrap();
    assert_eq!(a.qvel()[2] == 0.0, cfg!(engine_since = "3.5.0"), "sleeps");
    let mut b = a.clone();
    b.adopt(spec.compile().unwrap()).unwrap();
    same_steps(a, b, 1000);
}

#[test]
fn an_edited_copy_of_the_model_keeps_the_state() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.step_n(10).unwrap();
    let state = data.state(StateSpec::INTEGRATION);
    let mut model = (**data.model()).clone();
    model.edit().edit_options(|options| options.gravity = [0.0; 3]).unwrap();
    let adoption = data.adopt(model).unwrap();
    assert_eq!(adoption, Adoption::default());
    assert_eq!(data.state(StateSpec::INTEGRATION), state);
    assert_eq!(data.model().options().gravity, [0.0; 3]);
    data.step().unwrap();
}
