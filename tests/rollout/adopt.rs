//! Batches that adopt another model, against simulations that do.

use mujoco_safe::callback::Callbacks;
use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
use mujoco_safe::spec::Spec;
use mujoco_safe::{Data, Error, StateSpec};

/// Two pendulums, with a constraint between them.
const TEXT: &str = "<mujoco><option timestep='.01'/><worldbody>
    <body name='a'><joint name='a' axis='0 1 0' damping='.1'/><geom size='.1' pos='.3 0 0'/></body>
    <body name='b' pos='0 1 0'><joint name='b' axis='0 1 0'/><geom size='.1' pos='.3 0 0'/></body></worldbody>
    <equality><joint name='e' joint1='a' joint2='b'/></equality>
    <actuator><general name='m' joint='a' dyntype='filter' dynprm='.1'/></actuator></mujoco>";

fn spec() -> Spec {
    Spec::from_xml_str(TEXT).unwrap()
}

/// Puts a body before all others.
fn with_body(spec: &mut Spec) {
    let first =
        "<mujoco><worldbody><body name='c' pos='0 2 0'><joint name='c'/><geom size='.1'/></body></worldbody></mujoco>";
    let pendulum = spec.body("a").unwrap().id();
    let inner = mujoco_safe::spec::Mount::body(pendulum).with_pos([0.1, 0.0, 0.0]);
    spec.attach(&Spec::from_xml_str(first).unwrap(), inner, "").unwrap();
}

fn started(count: usize) -> Batch<'static> {
    let mut batch = Batch::new(spec().compile().unwrap(), count).unwrap();
    batch
        .reset_where(
            |_| true,
            |index, _, data| {
                data.qpos_mut()[0] = 0.1 * index as f64;
                data.set_equality_active("e", index % 2 == 0)
            },
        )
        .unwrap();
    for _ in 0..20 {
        batch
            .step(|_, controls| {
                controls.as_mut_slice().iter_mut().enumerate().for_each(|(index, control)| *control = index as f64);
            })
            .unwrap();
    }
    batch
}

#[test]
fn the_simulations_of_a_batch_continue_like_single_ones_bit_for_bit() {
    let mut spec = spec();
    let mut batch = started(5);
    // The model of the batch is that of another spec of the same text: by names.
    let mut simulations: Vec<Data> = (0..5).map(|index| batch.data(index).unwrap()).collect();
    with_body(&mut spec);
    let model = std::sync::Arc::new(spec.compile().unwrap());
    let adoption = batch.adopt(&model).unwrap();
    assert_eq!((adoption.lost.len(), adoption.new.len()), (0, 2));
    assert_eq!(batch.observations().shape(), (5, 3 + 3 + 1));
    for (index, data) in simulations.iter_mut().enumerate() {
        assert_eq!(data.adopt(&model).unwrap(), adoption);
        assert_eq!(batch.states().row(index), data.state(StateSpec::INTEGRATION));
        assert_eq!(batch.controls().row(index), data.ctrl());
        assert_eq!(batch.episode(index), 1);
    }
    for _ in 0..100 {
        batch.step(|_, _| ()).unwrap();
    }
    for (index, data) in simulations.iter_mut().enumerate() {
        data.step_n(100).unwrap();
        assert_eq!(batch.states().row(index), data.state(StateSpec::INTEGRATION), "simulation {index}");
        assert_eq!(data.equality("e").unwrap().active(), index % 2 == 0);
    }
}

#[test]
fn failures_and_callbacks_stay_with_their_simulations() {
    let mut batch = started(3);
    batch
        .edit_where(
            |index| index == 2,
            |_, data| {
                data.set_callbacks(Callbacks::new().with_passive(|passive| passive.qfrc_passive_mut()[1] = 5.0));
            },
        )
        .unwrap();
    batch.step(|_, controls| controls.as_mut_slice()[1] = f64::NAN).unwrap();
    assert!(batch.failure(1).is_some());
    let before = batch.states().to_matrix();
    batch.adopt(spec().compile().unwrap()).unwrap();
    assert!(matches!(batch.failure(1), Some(Error::Unstable(_))));
    assert!(batch.observations().row(1)[0].is_nan() && batch.observations().row(0)[0].is_finite());
    let same = batch.states().as_slice().iter().zip(before.as_slice()).all(|(a, b)| a.to_bits() == b.to_bits());
    assert!(same);
    let mut expected = Batch::new(batch.model().clone(), 3).unwrap();
    expected.edit_where(|_| true, |index, data| data.set_state(StateSpec::INTEGRATION, before.row(index))).unwrap();
    expected.edit_where(|index| index == 1, |_, data| data.set_equality_active("e", false)).unwrap();
    for batch in [&mut batch, &mut expected] {
        batch.step(|_, controls| controls.as_mut_slice().fill(0.0)).unwrap();
    }
    assert_eq!(batch.observations().row(0), expected.observations().row(0));
    assert_ne!(batch.observations().row(2), expected.observations().row(2), "the callback acts");
    batch.reset(1).unwrap();
    assert!(batch.failure(1).is_none());
}

#[test]
fn parameters_and_observations_are_those_of_a_new_batch() {
    let spec = spec();
    let model = std::sync::Arc::new(spec.compile().unwrap());
    let parameters = Parameters::new().with(&model, Parameter::Gravity(2), Distribution::Unchanged).unwrap();
    let id = model.joint("a").unwrap().id();
    let batch = Batch::new(&model, 2).unwrap().with_parameters(parameters).unwrap();
    let mut batch = batch.with_observations(1, move |data, row| row[0] = data.joint(id).qpos()[0]);
    batch.adopt(spec.compile().unwrap()).unwrap();
    assert_eq!(batch.parameters().shape(), (2, 0));
    assert_eq!(batch.observations().shape(), (2, 5));
    batch.step(|_, _| ()).unwrap();
}

#[cfg(engine_since = "3.5.0")]
#[test]
fn a_model_with_sleep_leaves_the_batch_unchanged() {
    let mut batch = started(2);
    let before = batch.states().to_matrix();
    let mut spec = spec();
    spec.section_mut("option").unwrap().child_mut("flag").unwrap().set("sleep", "enable").unwrap();
    assert!(matches!(batch.adopt(spec.compile().unwrap()), Err(Error::Unsupported(_))));
    assert_eq!(batch.states().to_matrix(), before);
    batch.step(|_, _| ()).unwrap();
}
