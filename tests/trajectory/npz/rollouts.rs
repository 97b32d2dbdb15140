//! Archives of the results of rollouts.

use std::path::Path;

use mujoco_safe::rollout::{Rollout, RolloutResult};
use mujoco_safe::{Data, Model, RandomController, StateSpec, sample};

use crate::numpy;

/// Asserts the header and the bits of an array of doubles.
fn assert_array(path: &Path, name: &str, shape: &str, values: &[f64]) {
    let (header, bytes) = numpy::array(path, name);
    assert_eq!(header, format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"), "{name}");
    assert!(bytes == values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>(), "{name}");
}

/// Returns four rollouts of ten steps, of which number 2 fails in step 3.
fn with_a_failure() -> RolloutResult {
    Rollout::new(sample::cartpole(), 4, 10)
        .with_controllers(|index| {
            move |data: &mut Data| {
                let fails = index == 2 && data.time() > 0.025;
                data.ctrl_mut()[0] = if fails { f64::NAN } else { 0.1 * index as f64 };
            }
        })
        .with_outputs(1, |data, row| row[0] = data.time())
        .run()
        .unwrap()
}

#[test]
fn all_results_of_rollouts_are_saved_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rollouts.npz");
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
    let model = Model::from_xml_path(model).unwrap();
    let (nstate, nsensordata) = (model.state_size(StateSpec::INTEGRATION), model.nsensordata());
    let result = Rollout::new(model, 3, 7)
        .with_controllers(|index| RandomController::new(index as u64))
        .with_recorded_states(StateSpec::INTEGRATION)
        .with_outputs(2, |data, row| row.copy_from_slice(&[data.time(), data.energy()[0]]))
        .run()
        .unwrap();
    result.save_npz(&path).unwrap();
    assert!(nsensordata > 0);
    assert_array(&path, "states", &format!("(3, 8, {nstate})"), result.states());
    assert_array(&path, "sensordata", &format!("(3, 7, {nsensordata})"), result.sensordata());
    assert_array(&path, "outputs", "(3, 7, 2)", result.outputs());
    assert_eq!(numpy::array(&path, "completed").1, [1, 1, 1]);
}

#[test]
fn a_failed_rollout_is_marked_with_the_number_of_its_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rollouts.npz");
    let result = with_a_failure();
    assert_eq!(result.outcomes()[2].as_ref().unwrap_err().step(), 3);
    result.save_npz(&path).unwrap();
    let (header, completed) = numpy::array(&path, "completed");
    assert_eq!(header, "{'descr': '|b1', 'fortran_order': False, 'shape': (4,), }");
    assert_eq!(completed, [1, 1, 0, 1]);
    let (header, steps) = numpy::array(&path, "steps");
    assert_eq!(header, "{'descr': '<i8', 'fortran_order': False, 'shape': (4,), }");
    let steps: Vec<_> = steps.as_chunks().0.iter().map(|&bytes| i64::from_le_bytes(bytes)).collect();
    assert_eq!(steps, [10, 10, 3, 10]);
}

#[test]
fn numpy_selects_the_completed_rollouts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rollouts.npz");
    let result = with_a_failure();
    result.save_npz(&path).unwrap();
    let script = "import sys, numpy
r = numpy.load(sys.argv[1])
print(r['states'].shape, r['sensordata'].shape, r['outputs'].shape)
for state in r['states'][r['completed']][:, -1]:
    print(*map(repr, map(float, state)))
print(numpy.isnan(r['states'][2, r['steps'][2] + 1:]).all(), numpy.isnan(r['states'][2, :r['steps'][2] + 1]).any())";
    let Some(output) = numpy::python(script, &path) else { return };
    let lines: Vec<&str> = output.lines().collect();
    assert_eq!(lines[0], "(4, 11, 4) (4, 10, 7) (4, 10, 1)");
    for (line, index) in lines[1..4].iter().zip([0, 1, 3]) {
        let state: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        assert_eq!(state, result.state(index, 10));
    }
    assert_eq!(lines[4..], ["True False"]);
}

#[test]
fn no_rollouts_are_saved_as_empty_arrays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rollouts.npz");
    Rollout::new(sample::cartpole(), 0, 5).run().unwrap().save_npz(&path).unwrap();
    assert_array(&path, "states", "(0, 6, 4)", &[]);
    assert!(numpy::array(&path, "completed").1.is_empty());
}
