//! Floating-point values from which newer engines compute addresses: the engine never leaves its
//! arrays, whatever a program writes. The independent source for the number of activations is the
//! engine's compiler.

use std::panic::{AssertUnwindSafe, catch_unwind};

use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
use mujoco_safe::{Batch, Data, Error, Model, ModelMut};

/// Two flexes with strain constraints, of 2 × 1 × 1 and 1 × 1 × 2 cells, and an equality constraint
/// of other numbers.
const STRAIN: &str = r#"<mujoco>
  <worldbody>
    <body name="a"><joint name="a"/><geom size=".1"/></body><body name="b"><joint name="b"/><geom size=".1"/></body>
    <flexcomp name="f" type="grid" count="5 3 3" spacing=".05 .05 .05" pos="0 0 .2" dim="3" radius=".005" mass=".5" dof="trilinear" cellcount="2 1 1">
      <edge equality="strain"/><contact selfcollide="none"/>
    </flexcomp>
    <flexcomp name="q" type="grid" count="3 3 3" spacing=".05 .05 .05" pos="1 0 .2" dim="3" radius=".005" mass=".5" dof="quadratic" cellcount="1 1 2">
      <edge equality="strain"/><contact selfcollide="none"/>
    </flexcomp>
  </worldbody>
  <equality><joint name="joint" joint1="a" joint2="b"/></equality>
</mujoco>"#;

/// Actuators with all combinations of states.
const ACTUATORS: &str = r#"<mujoco>
  <size nuserdata="8"/>
  <worldbody><body><joint name="j" axis="0 1 0"/><geom size=".1" pos=".1 0 0"/></body></worldbody>
  <actuator>
    <position name="plain" joint="j" kp="1"/><general name="filter" joint="j" dyntype="filter" dynprm=".1"/>
    <pid name="no state" joint="j" kp="5" kv=".5"/><pid name="integral" joint="j" kp="5" ki="2" input="pos"/>
    <pid name="slew" joint="j" kp="5" slewmax="1" input="pos"/><pid name="both" joint="j" kp="5" ki="2" slewmax="1" input="pos vel"/>
    <dcmotor name="resistance" joint="j" resistance="2" motorconst=".5 .5"/>
    <dcmotor name="inductance" joint="j" resistance="2" motorconst=".5 .5" inductance=".1"/>
    <dcmotor name="all" joint="j" resistance="2" motorconst=".5 .5" inductance=".1" thermal="1 1 .01 25 25 100" lugre="1 1 1 1 1"
             input="pos vel" controller="1 1 1 1 1 1"/>
  </actuator>
</mujoco>"#;

fn model(text: &str) -> Model {
    Model::from_xml_str(text).unwrap()
}

/// Checks that an edit of a simulation is rejected and undone, and that a simulation of a model
/// with this edit is an error.
fn is_rejected(text: &str, edit: impl Fn(&mut ModelMut<'_>), what: &str) {
    let mut data = Data::new(model(text)).unwrap();
    let values =
        |model: &Model| (model.eq_data().to_vec(), model.actuator_dynprm().to_vec(), model.actuator_gainprm().to_vec());
    let before = format!("{:?}", values(data.model()));
    let error = data.edit_model(|model| edit(model)).unwrap_err();
    assert!(matches!(&error, Error::Invalid { .. }) && error.to_string().contains(what), "{error}");
    assert_eq!(format!("{:?}", values(data.model())), before);
    data.step().unwrap();

    let unwound = catch_unwind(AssertUnwindSafe(|| {
        data.edit_model(|model| {
            edit(model);
            assert!(model.nq() == 0, "a panic of a closure");
        })
    }));
    assert!(unwound.is_err());
    assert_eq!(format!("{:?}", values(data.model())), before);
    data.step().unwrap();

    let mut edited = model(text);
    edit(&mut edited.edit());
    let error = edited.edit().update_constants().unwrap_err();
    assert!(error.to_string().contains(what), "{error}");
    let error = Data::new(edited).unwrap_err();
    assert!(error.to_string().contains(what), "{error}");
}

#[test]
fn the_cell_of_a_strain_constraint_stays_inside_its_flex() {
    let compiled = model(STRAIN);
    let (equalities, cells) = (compiled.neq(), [[2.0, 1.0, 1.0], [1.0, 1.0, 2.0]]);
    for equality in 0..equalities {
        if compiled.eq_obj2id()[equality] >= 0 && compiled.eq_data()[equality][1] == 1.0 {
            continue; // the joints
        }
        let cells = cells[compiled.eq_obj1id()[equality] as usize];
        for (axis, count) in cells.into_iter().enumerate() {
            for value in [-1.0, count, 0.5, 1e6, f64::NAN, f64::INFINITY, -1e300] {
                is_rejected(STRAIN, |model| model.eq_data_mut()[equality][axis] = value, "a whole number from 0 to");
            }
        }
    }
    // Other cells, and the numbers of other constraints, can be changed.
    let mut data = Data::new(compiled).unwrap();
    data.edit_model(|model| {
        for equality in 0..equalities {
            model.eq_data_mut()[equality][4] = 0.5;
        }
        model.equality_mut("joint").unwrap().data_mut()[0] = 1e6;
    })
    .unwrap();
    data.step().unwrap();
}

/// The strain constraints of a shell concern the faces of the grid of cells.
#[test]
fn strain_constraints_of_a_shell_have_the_indices_of_its_faces() {
    for (cells, dof) in [([2, 2, 2], "trilinear"), ([3, 1, 1], "quadratic")] {
        let [x, y, z] = cells;
        let text = format!(
            r#"<mujoco><worldbody><flexcomp name="f" type="grid" dim="3" count="3 3 3" spacing=".1 .1 .1" dof="{dof}" cellcount="{x} {y} {z}" mass="1" radius=".01">
                 <edge equality="strain"/><elasticity elastic2d="both" thickness=".01"/><contact selfcollide="none"/>
               </flexcomp></worldbody></mujoco>"#
        );
        let compiled = model(&text);
        let faces = 2 * (x * y + y * z + z * x);
        // The compiler makes a constraint for each face.
        assert_eq!(compiled.neq(), faces);
        Data::new(compiled).unwrap().step().unwrap();
        for value in [-1.0, faces as f64, 0.5, f64::NAN] {
            is_rejected(&text, |model| model.eq_data_mut()[0][0] = value, "a whole number from 0 to");
        }
    }
}

#[test]
fn a_model_whose_actuators_ask_for_other_activations_than_they_have_is_rejected() {
    let compiled = model(ACTUATORS);
    for actuator in compiled.actuators().map(|actuator| actuator.index()) {
        for at in 0..10 {
            for value in [0.0, 1.0, -1.0, f64::NAN, 1e300] {
                for gain in [false, true] {
                    let edit = |model: &mut ModelMut<'_>| {
                        let row = if gain { model.actuator_gainprm_mut() } else { model.actuator_dynprm_mut() };
                        row[actuator][at] = value;
                    };
                    let mut data = Data::new(compiled.clone()).unwrap();
                    data.userdata_mut().fill(7.0);
                    let before = data.model().clone();
                    let result = data.edit_model(|model| edit(model));
                    let values = |model: &Model| {
                        if gain {
                            model.actuator_gainprm()[actuator][at]
                        } else {
                            model.actuator_dynprm()[actuator][at]
                        }
                    };
                    let switches = (values(&before) > 0.0) != (value > 0.0);
                    if !switches {
                        result.unwrap();
                    } else if let Err(error) = result {
                        assert!(
                            error.to_string().contains("as many parameters as the actuator has activations"),
                            "{error}"
                        );
                    }
                    data.ctrl_mut().fill(3.0);
                    // An unstable simulation is reset.
                    let is_stable = data.step().is_ok();
                    assert!(!is_stable || data.userdata().iter().all(|&value| value == 7.0));
                }
            }
        }
    }
    let what = "as many parameters as the actuator has activations";
    let switch = |name: &'static str, gain: bool, at: usize, value: f64| {
        is_rejected(
            ACTUATORS,
            |model| {
                let mut actuator = model.actuator_mut(name).unwrap();
                if gain { actuator.gainprm_mut()[at] = value } else { actuator.dynprm_mut()[at] = value }
            },
            what,
        );
    };
    switch("no state", true, 0, 2.0);
    switch("integral", false, 1, 1.0);
    switch("slew", true, 0, 1.0);
    switch("both", true, 0, 0.0);
    switch("resistance", false, 0, 1.0);
    switch("inductance", false, 5, 1.0);
    switch("all", false, 2, 0.0);
}

#[test]
fn a_bias_of_a_dc_motor_without_its_states_is_rejected() {
    for parameters in ["0 0 0 0 0 1 0 1", "1", "0 0 1"] {
        let text = format!(
            r#"<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
               <actuator><general joint="j" biastype="dcmotor" dynprm="{parameters}"/></actuator></mujoco>"#
        );
        let error = Model::from_xml_str(&text).unwrap_err().to_string();
        assert!(error.contains("as many parameters as the actuator has activations, 0"), "{error}");
    }
}

#[test]
fn parameters_of_a_batch_do_not_add_activations() {
    let model = model(ACTUATORS);
    let slew = model.actuator("slew").unwrap().id();
    let parameters = Parameters::new()
        .with(&model, Parameter::ActuatorGain(slew, 0), Distribution::Uniform { low: 1.0, high: 2.0 })
        .unwrap();
    let mut batch = Batch::new(model, 4).unwrap().with_parameters(parameters).unwrap();
    let error = batch.sample_parameters(|_| true, 1).unwrap_err();
    assert!(error.to_string().contains("activations"), "{error}");
    batch.step(|_, _| ()).unwrap();
}

/// Transmissions whose moments depend on the pose, each as the last one.
const LAST: [&str; 4] = [
    r#"<general cranksite="tip" slidersite="world" cranklength=".5"/>"#,
    r#"<general site="tip" refsite="world" gear="1 0 0 0 1 0"/>"#,
    r#"<general site="tip" gear="1 0 0 0 1 0"/>"#,
    r#"<motor tendon="rope"/>"#,
];

#[test]
fn the_moments_of_a_pose_that_is_not_a_number_stay_in_their_array() {
    for last in LAST {
        let model = model(&format!(
            r#"<mujoco><worldbody><site name="world"/>
                 <body><joint type="slide"/><geom size=".1"/><site name="tip" pos=".1 0 0"/></body>
                 <body pos="1 0 0"><freejoint/><geom size=".1"/></body><body pos="2 0 0"><freejoint/><geom size=".1"/></body>
               </worldbody>
               <tendon><spatial name="rope"><site site="world"/><site site="tip"/></spatial></tendon>
               <actuator>{last}</actuator></mujoco>"#
        ));
        let mut data = Data::new(model).unwrap();
        data.qpos_mut()[0] = f64::NAN;
        let _ = data.forward();
        let (rows, counts) = (data.moment_rowadr(), data.moment_rownnz());
        let end = rows.iter().zip(counts).map(|(start, count)| start + count).max().unwrap();
        assert!(end as usize <= data.actuator_moment().len(), "{last}: {end} of {}", data.actuator_moment().len());
    }
}

#[test]
fn the_crank_behind_an_actuator_with_several_forces_has_its_length() {
    let text = r#"<mujoco><worldbody><site name="world"/>
        <body><joint name="ball" type="ball"/><geom size=".1"/><site name="tip" pos=".1 0 0"/></body></worldbody>
      <actuator><orientation joint="ball" kp="1"/><general cranksite="tip" slidersite="world" cranklength=".5"/></actuator></mujoco>"#;
    let loaded = Model::from_xml_str(text);
    if cfg!(not(engine_since = "4.0.0")) {
        let error = loaded.unwrap_err().to_string();
        assert!(error.contains("slider-crank behind an actuator with several forces"), "{error}");
        return;
    }
    let mut data = Data::new(loaded.unwrap()).unwrap();
    data.forward().unwrap();
    // The slide is along z, the crank's end 0.1 beside it.
    let expected = (0.5_f64.powi(2) - 0.1_f64.powi(2)).sqrt();
    assert!((data.actuator_length()[3].abs() - expected).abs() < 1e-12, "{:?}", data.actuator_length());
}
