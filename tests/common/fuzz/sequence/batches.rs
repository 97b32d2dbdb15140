//! Batches against a new simulation for each call: neither other rows nor earlier calls in the same
//! thread change a result.

use std::sync::Arc;

use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
use mujoco_safe::{Batch, Data, Model, Result, StateSpec};

use super::{Call, expected};

const SPEC: StateSpec = StateSpec::INTEGRATION;

/// Expected row of a batch.
struct Alone {
    model: Arc<Model>,
    state: Vec<f64>,
    failed: bool,
    /// Gravity and damping.
    values: [f64; 2],
}

impl Alone {
    fn new(model: &Arc<Model>, values: [f64; 2]) -> Result<Self> {
        Ok(Self { model: model.clone(), state: Data::new(model)?.state(SPEC), failed: false, values })
    }

    /// Makes a call on a new simulation, after a reset or in the present state.
    fn call(&mut self, reset: bool, call: impl FnOnce(&mut Data) -> Result<()>) -> Result<()> {
        let mut data = Data::new(&self.model)?;
        if reset {
            self.failed = false;
        } else if self.failed {
            return Ok(());
        } else {
            data.set_state(SPEC, &self.state)?;
        }
        let result = call(&mut data);
        self.failed = result.is_err();
        if !self.failed {
            self.state = data.state(SPEC);
        }
        self.model = data.model().clone();
        Ok(())
    }

    fn step(&mut self, control: f64, substeps: usize) -> Result<()> {
        if !self.failed {
            let controls = self.model.state_range(SPEC, StateSpec::CTRL);
            self.state[controls].fill(control);
        }
        self.call(false, |data| data.step_n(substeps))
    }

    /// Writes the values that change to the model.
    fn set_parameters(&mut self, values: [f64; 2]) -> Result<()> {
        let mut data = Data::new(&self.model)?;
        let before = std::mem::replace(&mut self.values, values);
        let changes = [0, 1].map(|at| before[at].to_bits() != values[at].to_bits());
        data.edit_model(|model| {
            if changes[1] {
                model.dof_damping_mut()[0] = values[1];
            }
            if changes[0] { model.edit_options(|options| options.gravity[2] = values[0]) } else { Ok(()) }
        })?;
        self.model = data.model().clone();
        Ok(())
    }
}

/// Changes a simulation in a closure of a batch.
fn change(data: &mut Data, kind: usize, number: f64) -> Result<()> {
    match kind {
        0 => data.qpos_mut().iter_mut().for_each(|position| *position += 1e-3 * number),
        1 => data.qvel_mut().fill(number),
        2 => data.qfrc_applied_mut().fill(number),
        3 => data.edit_model(|model| model.body_mass_mut().iter_mut().for_each(|mass| *mass *= 1.5))?,
        4 => data.edit_model(|model| model.edit_options(|options| options.gravity[0] = number))?,
        5 => data.step()?,
        6 => {
            data.forward()?;
            data.sensordata_mut().fill(number);
        }
        _ => return data.reset_to_key(1_000_000),
    }
    Ok(())
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

pub(super) const CALLS: &[(&str, Call)] = &[("Batch against simulations", |scene, bytes| {
    // A batch finds the edits of a model in the engine's buffer, in which the arrays are not with
    // guard pages.
    if std::env::var_os("GUARD_PAGES").is_some() {
        return Ok(());
    }
    let model = scene.data.model().clone();
    let joint = (0..model.njnt()).find(|&joint| model.joint(joint).is_ok_and(|joint| joint.dofs() == (0..1)));
    let Some(joint) = joint.filter(|_| model.nv() < 30) else { return Ok(()) };
    let damping = Parameter::JointDamping(model.joint(joint)?.id());
    let parameters = Parameters::new().with(&model, Parameter::Gravity(2), Distribution::Unchanged)?.with(
        &model,
        damping,
        Distribution::Unchanged,
    )?;
    let (count, substeps) = (1 + bytes.below(3), bytes.below(3));
    let mut batch = Batch::new(&model, count)?
        .with_substeps(substeps)
        .with_chunk(1 + bytes.below(3))
        .with_parameters(parameters)?;
    let mut all = Vec::new();
    for row in batch.parameters().rows() {
        all.push(Alone::new(&model, [row[0], row[1]])?);
    }
    for _ in 0..=bytes.below(8) {
        let (number, which, kind, reset) = (bytes.number(), bytes.below(4), bytes.below(8), bytes.once_in(2));
        let selected = |index: usize| index != which;
        let call = bytes.below(4);
        (scene.log)(&format!("  {call}: kind {kind} with {number:e}, reset {reset}, all but {which}"));
        match call {
            0 => {
                let set = |_: usize, values: &mut [f64]| values[kind % 2] = number;
                let result = batch.set_parameters(selected, set);
                for (index, alone) in all.iter_mut().enumerate().filter(|(index, _)| result.is_ok() && selected(*index))
                {
                    alone.set_parameters([batch.parameters()[(index, 0)], batch.parameters()[(index, 1)]])?;
                }
            }
            1 => {
                let result = if reset {
                    batch.reset_where(selected, |_, _, data| change(data, kind, number))
                } else {
                    batch.edit_where(selected, |_, data| change(data, kind, number))
                };
                expected(&result);
                for (_, alone) in all.iter_mut().enumerate().filter(|(index, _)| selected(*index)) {
                    alone.call(reset, |data| change(data, kind, number))?;
                }
            }
            _ => {
                batch.step(|_, controls| controls.as_mut_slice().fill(number))?;
                all.iter_mut().try_for_each(|alone| alone.step(number, substeps))?;
            }
        }
        for (index, alone) in all.iter().enumerate() {
            assert_eq!(batch.failure(index).is_some(), alone.failed, "failure of {index}: {:?}", batch.failure(index));
            assert!(bits(batch.states().row(index)) == bits(&alone.state), "the states of {index} differ");
            let observation = batch.observations();
            assert!(
                !alone.failed || observation.row(index).iter().all(|value| value.is_nan()),
                "observation of {index}"
            );
        }
    }
    Ok(())
})];
