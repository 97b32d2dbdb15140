//! Many simulations at once, of the edited model.

use std::hint::black_box;
use std::ops::ControlFlow;

use mujoco_safe::rollout::{RolloutBuffers, Workers};
use mujoco_safe::{Batch, Data, Result, Rollout, StateSpec};

use super::{Bytes, Call, Scene, expected};

/// More than the available memory.
const TOO_MANY: usize = usize::MAX / 4;

fn spec(bytes: &mut Bytes<'_>) -> StateSpec {
    StateSpec::from_bits_retain(bytes.word() as u32) & StateSpec::all()
}

/// Returns `true` if a few simulations are fast and small, and for one in 32 other models.
fn small(scene: &Scene<'_>, bytes: &mut Bytes<'_>) -> bool {
    scene.data.model().nv() < 30 || bytes.once_in(32)
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("Rollout", |scene, bytes| {
        if !small(scene, bytes) {
            return Ok(());
        }
        let model = scene.data.model().clone();
        let (nroll, nstep, nu) = (bytes.below(4), bytes.below(6), model.nu());
        let (specs, number, edited) = ([spec(bytes), spec(bytes)], bytes.number(), bytes.number());
        let each = bytes.once_in(2);
        let initial = bytes.vector(model.state_size(specs[0]) * if each { nroll } else { 1 });
        let controls = bytes.vector(nstep * nu * if each { nroll } else { 1 });
        let (seldom, last) = (bytes.below(4), bytes.below(6));

        let workers = Workers::new(model);
        let mut rollout = Rollout::on(&workers, nroll, nstep).with_recorded_states(specs[1]).with_chunk(bytes.below(5));
        if bytes.once_in(2) {
            rollout = if each {
                rollout.with_initial_states(specs[0], &initial)
            } else {
                rollout.with_initial_state(specs[0], &initial)
            };
        }
        rollout = match bytes.below(4) {
            0 => rollout,
            1 if each => rollout.with_controls(&controls),
            1 => rollout.with_shared_controls(&controls),
            2 => rollout.with_controllers(|index| {
                move |data: &mut Data| {
                    data.ctrl_mut().fill(number);
                    // Other calls that a controller may make.
                    if index == seldom { data.reset() } else { Ok(()) }
                }
            }),
            _ => rollout.with_controllers(|index| {
                move |data: &mut Data| {
                    if index != seldom {
                        return data.forward();
                    }
                    data.edit_model(|model| model.set_timestep(edited))
                }
            }),
        };
        if bytes.once_in(3) {
            rollout = rollout.with_model_edits(|index, model| {
                if index == seldom {
                    model.body_mass_mut().fill(edited);
                    return model.update_constants();
                }
                model.geom_size_mut().as_flattened_mut().fill(edited);
                model.edit_options(|options| options.gravity = [number; 3])
            });
        }
        if bytes.once_in(2) {
            rollout = rollout.with_outputs(bytes.below(3), |data, row| row.fill(data.time()));
        }
        if bytes.once_in(4) {
            rollout = rollout.with_forward_after_step();
        }
        if bytes.once_in(4) {
            rollout = rollout
                .with_progress(|done| if done < last { ControlFlow::Continue(()) } else { ControlFlow::Break(()) });
        }
        let result = rollout.run()?;
        for outcome in result.outcomes() {
            black_box(outcome.as_ref().err().map(ToString::to_string));
        }
        for index in 0..result.len() {
            black_box((result.states_of(index).shape(), result.outputs_of(index).shape()));
            black_box((result.sensordata_of(index).shape(), result.state(index, result.steps()).len()));
        }
        // The workers of the previous run.
        let mut states = bytes.vector(result.states().len());
        let mut sensordata = vec![0.0; result.sensordata().len()];
        let buffers = RolloutBuffers {
            states: bytes.once_in(2).then_some(&mut states),
            sensordata: Some(&mut sensordata),
            ..Default::default()
        };
        rollout.run_into(buffers).map(drop)
    }),
    ("a Rollout larger than memory", |scene, bytes| {
        let model = scene.data.model().clone();
        let (nroll, nstep) = [(TOO_MANY, 1), (1, TOO_MANY), (usize::MAX, usize::MAX)][bytes.below(3)];
        let rollout =
            Rollout::new(model, nroll, nstep).with_recorded_states(StateSpec::TIME).with_outputs(TOO_MANY, |_, _| ());
        assert!(rollout.run().is_err(), "memory suffices for {nroll} × {nstep}");
        // Without buffers, a single rollout of many steps would only be slow.
        assert!(nroll == 1 || rollout.run_into(RolloutBuffers::default()).is_err(), "memory suffices for {nroll}");
        Ok(())
    }),
    ("Batch", |scene, bytes| {
        if !small(scene, bytes) {
            return Ok(());
        }
        let (count, nobs) = (bytes.below(4), bytes.below(4));
        let mut batch =
            Batch::new(scene.data.model().clone(), count)?.with_substeps(bytes.below(4)).with_chunk(bytes.below(4));
        if bytes.once_in(2) {
            batch = batch.with_observations(nobs, |data, row| row.fill(data.qpos().first().copied().unwrap_or(0.0)));
        }
        if bytes.once_in(4) {
            batch = batch.with_forward_after_step();
        }
        for _ in 0..=bytes.below(4) {
            let (number, which) = (bytes.number(), bytes.below(4));
            let result = match bytes.below(7) {
                0 => batch.reset_where(|index| index != which, |_, _, data| data.qvel_mut().fill(number)),
                1 => batch.reset_where(
                    |index| index != which,
                    |index, _, data| -> Result<()> {
                        data.edit_model(|model| model.edit_options(|options| options.gravity[index % 3] = number))?;
                        data.step()
                    },
                ),
                2 if which < batch.len() => batch.reset(which),
                3 => batch.edit_where(
                    |index| index != which,
                    |_, data| data.xfrc_applied_mut().as_flattened_mut().fill(number),
                ),
                4 if which < batch.len() => batch.load(which, &mut scene.data),
                _ => batch.step(|observations, controls| {
                    black_box(observations.shape());
                    controls.as_mut_slice().fill(number);
                }),
            };
            expected(&result);
        }
        black_box((batch.failures().count(), batch.observations().shape(), batch.controls().shape()));
        for index in 0..batch.len() {
            black_box((batch.failure(index).map(ToString::to_string), format!("{:?}", batch.data(index)?)));
            assert_eq!(batch.states().row(index).len(), batch.model().state_size(StateSpec::INTEGRATION));
        }
        Ok(())
    }),
];
