//! Quantities that `update_constants` changes, and quantities that it keeps.

use std::collections::BTreeMap;

use mujoco_safe::{Data, Model};

use super::outcome::{FLAGS, HIERARCHY, is_close};
use super::{Numbers, SetNumbers, all_fields, generator};

const TABLE: &str = include_str!("../../../build/knowledge/derived.tsv");

/// Tendons around geoms, with a spring, an actuator and an equality constraint.
const WRAPPED: &str = r#"<mujoco>
  <worldbody>
    <geom name="ball" size=".2" pos="0 .1 1" contype="0" conaffinity="0"/>
    <geom name="drum" type="cylinder" size=".2 .5" pos="2 .1 1" contype="0" conaffinity="0"/>
    <site name="fixed" pos="-.5 0 1"/><site name="side" pos="0 -.5 1"/><site name="end" pos="2.5 0 1"/>
    <body pos=".5 0 1"><joint type="slide" axis="1 0 0"/><joint axis="0 1 .1" pos=".1 0 0"/>
      <geom size=".1"/><site name="moving"/></body>
  </worldbody>
  <tendon>
    <spatial name="around_ball" stiffness="3"><site site="fixed"/><geom geom="ball" sidesite="side"/><site site="moving"/></spatial>
    <spatial name="around_drum"><site site="end"/><geom geom="drum"/><site site="moving"/></spatial>
  </tendon>
  <actuator><motor tendon="around_ball"/><motor tendon="around_drum"/></actuator>
</mujoco>"#;

/// Edits each array of a model, and adds the fields that `update_constants` changes then and the
/// table does not list.
fn add_unlisted(model: &Model, unlisted: &mut BTreeMap<&'static str, Vec<String>>) {
    let mut reference = model.clone();
    if reference.edit().update_constants().is_err() {
        return;
    }
    let before = all_fields(&reference);
    let is_internal = |field: &str| FLAGS.contains(&field) || HIERARCHY.contains(&field);
    macro_rules! edit {
        ($($writer:ident($field:ident))*) => { $(
            let mut edited = model.clone();
            let mut edit = edited.edit();
            let mut values = edit.$field().numbers();
            values.iter_mut().enumerate().for_each(|(index, value)| *value = 1.01 * *value + 0.003 * ((index % 3) as f64));
            edit.$writer().set_numbers(&values);
            if edit.update_constants().is_ok() {
                let row = TABLE.lines().map(|line| line.split('\t').collect::<Vec<_>>());
                let row = row.into_iter().find(|row| row[0] == stringify!($field)).unwrap();
                let listed: Vec<&str> = row[2].split([' ', ';']).collect();
                for (field, values) in all_fields(&edited) {
                    let is_equal = values.iter().zip(&before[field]).all(|(left, right)| is_close(*left, *right, 1e-9));
                    if !is_equal && field != stringify!($field) && !listed.contains(&field) && !is_internal(field) {
                        unlisted.entry(field).or_default().push(stringify!($field).to_owned());
                    }
                }
            }
        )* };
    }
    model_writers! { edit }
}

#[test]
fn the_table_of_derived_quantities_lists_what_update_constants_changes() {
    let mut unlisted = BTreeMap::new();
    let mut texts: Vec<String> = (0..3).map(generator::xml).collect();
    texts.extend([WRAPPED.to_owned(), include_str!("../../models/every_element.xml").to_owned()]);
    for model in texts.iter().filter_map(|text| Model::from_xml_str(text).ok()) {
        add_unlisted(&model, &mut unlisted);
    }
    for edited in unlisted.values_mut() {
        edited.sort();
        edited.dedup();
    }
    assert!(unlisted.is_empty(), "{unlisted:#?}");
}

#[test]
fn a_tendon_around_an_edited_geom_has_the_compiled_constants() {
    for (name, old, new) in [("ball", "size=\".2\"", 0.6), ("drum", "size=\".2 .5\"", 0.6)] {
        let text = WRAPPED.replace(old, &old.replace(".2", &new.to_string()));
        let compiled = Model::from_xml_str(&text).unwrap();
        let mut edited = Model::from_xml_str(WRAPPED).unwrap();
        edited.edit().geom_mut(name).unwrap().size_mut()[0] = new;
        assert_ne!(edited.tendon_length0(), compiled.tendon_length0());
        edited.edit().update_constants().unwrap();
        let constants = |model: &Model| {
            [model.tendon_length0(), model.tendon_invweight0(), model.actuator_length0(), model.actuator_acc0()]
                .concat()
        };
        let (edited, compiled) = (constants(&edited), constants(&compiled));
        assert!(
            edited.iter().zip(&compiled).all(|(left, right)| (left - right).abs() < 1e-9),
            "{edited:?} {compiled:?}"
        );
    }
}

#[test]
fn update_constants_keeps_the_relative_poses_of_welds() {
    let text = |attributes: &str| {
        format!(
            "<mujoco><worldbody>
               <body name='one' pos='0 0 1' euler='10 20 30'><freejoint/><geom size='.1'/></body>
               <body name='two' pos='1 0 1' euler='-40 50 0'><freejoint/><geom size='.1'/></body>
             </worldbody><equality><weld name='grasp' body1='one' body2='two' {attributes}/></equality></mujoco>"
        )
    };
    let compiled = |attributes: &str| Model::from_xml_str(&text(attributes)).unwrap();
    let data = |model: &Model| *model.equality("grasp").unwrap().data();
    // Older engines normalise the quaternion, which rounds.
    let is_close =
        |left: &[f64], right: &[f64]| left.iter().zip(right).all(|(left, right)| (left - right).abs() < 1e-12);
    let mut edited = compiled("");
    edited.edit().update_constants().unwrap();
    assert!(is_close(&data(&edited), &data(&compiled(""))), "an edit of nothing");
    edited.edit().equality_mut("grasp").unwrap().data_mut()[3..10]
        .copy_from_slice(&[0.0, 0.0, 0.5, 0.6, 0.8, 0.0, 0.0]);
    for shift in [0.0, 0.3] {
        edited.edit().qpos0_mut()[0] += shift;
        edited.edit().update_constants().unwrap();
        assert!(is_close(&data(&edited), &data(&compiled("relpose='0 0 .5 .6 .8 0 0'"))), "{shift}");
    }
    let mut moved = compiled("");
    moved.edit().qpos0_mut()[0] += 0.3;
    moved.edit().update_constants().unwrap();
    assert!(is_close(&data(&moved)[..11], &data(&compiled(""))[..11]));
}

#[test]
fn update_constants_keeps_a_positive_bias_of_the_velocity() {
    let text = "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody>
        <actuator><position joint='j' kp='100'/></actuator></mujoco>";
    let mut model = Model::from_xml_str(text).unwrap();
    model.edit().actuator_biasprm_mut()[0][2] = 2.0;
    model.edit().update_constants().unwrap();
    assert_eq!(model.actuator_biasprm()[0][..3], [0.0, -100.0, 2.0]);
}

#[test]
fn geoms_and_sites_keep_their_places_when_the_inertial_frame_turns() {
    let compiled = |quat: &str| {
        Model::from_xml_str(&format!(
            "<mujoco><worldbody><geom type='plane' size='5 5 .1'/>
               <body name='b' pos='0 0 .5'><joint type='slide' axis='0 0 1'/>
                 <inertial pos='0 0 0' mass='1' diaginertia='1 2 2.5' quat='{quat}'/>
                 <geom type='box' size='.4 .1 .1' pos='.3 0 0' quat='.7071 0 .7071 0'/><site pos='.3 0 0' quat='.7071 0 .7071 0'/>
               </body></worldbody></mujoco>"
        ))
        .unwrap()
    };
    let rest = |model: Model| {
        let mut data = Data::new(model).unwrap();
        data.step_n(500).unwrap();
        (data.qpos()[0], [data.geom_xmat().as_flattened(), data.site_xmat().as_flattened()].concat())
    };
    let mut edited = compiled(".7071 0 .7071 0");
    *edited.edit().body_mut("b").unwrap().iquat_mut() = [1.0, 0.0, 0.0, 0.0];
    let (edited, expected) = (rest(edited), rest(compiled("1 0 0 0")));
    assert!(
        edited.1.iter().zip(&expected.1).all(|(left, right)| (left - right).abs() < 1e-12),
        "{edited:?} {expected:?}"
    );
    // The box stands on its end. The contacts of the two models differ by inverse weights, which an
    // edit does not update.
    assert!([edited.0, expected.0].iter().all(|height| (height - (0.4 - 0.5)).abs() < 1e-3), "{edited:?} {expected:?}");
}

#[test]
#[cfg_attr(not(engine_since = "3.17.0"), ignore = "mj_setConst of older engines computes the statistics")]
fn an_edit_of_nothing_keeps_the_mean_inertia_of_a_model_with_armature_of_tendons() {
    for (tendon, actuator) in [("armature='3'", ""), ("", "armature='3'")] {
        let text = format!(
            "<mujoco><worldbody><site name='a' pos='0 .5 0'/><body><joint/><geom size='.1' pos='.5 0 0'/><site name='b' pos='.5 0 0'/></body>
             </worldbody><tendon><spatial name='t' {tendon}><site site='a'/><site site='b'/></spatial></tendon>
             <actuator><motor tendon='t' {actuator}/></actuator></mujoco>"
        );
        let mut model = Model::from_xml_str(&text).unwrap();
        let compiled = model.statistics().meaninertia;
        model.edit().update_constants().unwrap();
        assert_eq!(model.statistics().meaninertia, compiled);
    }
}
