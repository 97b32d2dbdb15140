//! Edits of the model for single rollouts.

use std::sync::Arc;

use mujoco_safe::enums::Cone;
use mujoco_safe::rollout::{Rollout, RolloutError, Workers};
use mujoco_safe::{Data, Error, Model, ModelMut, Result, sample};

use super::{bits, pool};

/// Applies a different edit for each rollout.
fn edit(index: usize, model: &mut ModelMut<'_>) -> Result<()> {
    match index % 4 {
        0 => Ok(()),
        1 => model.edit_options(|options| {
            options.cone = Cone::Elliptic;
            options.gravity[0] = 1.0;
        }),
        2 => {
            model.set_total_mass(60.0 + index as f64)?;
            model.update_constants()
        }
        _ => {
            model.qpos0_mut()[2] = 2.0;
            model.geom_friction_mut().fill([0.1, 0.0, 0.0]);
            model.joint_mut("left_knee")?.set_limited(false);
            Ok(())
        }
    }
}

#[test]
fn each_rollout_uses_only_its_own_edit() {
    let (count, steps) = (9, 40);
    let model = Arc::new(sample::humanoid());
    let before = model.to_binary().unwrap();
    let mut expected = Vec::new();
    for index in 0..count {
        let mut edited = (*model).clone();
        edit(index, &mut edited.edit()).unwrap();
        let mut data = Data::new(edited).unwrap();
        expected.extend(data.physics_state());
        for _ in 0..steps {
            data.step().unwrap();
            expected.extend(data.physics_state());
        }
    }
    let width = model.nq() + model.nv();
    let last = |index: usize| &expected[(index * (steps + 1) + steps) * width..][..width];
    assert!(last(0) != last(1) && last(0) != last(2) && last(0) != last(3), "each edit changes the result");
    for threads in [1, 2, 3] {
        for chunk in [1, 2, 4, 9] {
            let rollout = Rollout::new(model.clone(), count, steps).with_model_edits(edit).with_chunk(chunk);
            let result = pool(threads).install(|| rollout.run()).unwrap();
            assert!(result.outcomes().iter().all(Result::is_ok));
            assert!(bits(result.states()) == bits(&expected), "{threads} threads, chunks of {chunk}");
        }
    }
    assert!(model.to_binary().unwrap() == before, "the model itself was changed");
}

/// Changes every writable array.
fn change_everything(model: &mut ModelMut<'_>) {
    macro_rules! change {
        ($($writer:ident($field:ident))*) => { $( change(&mut model.$writer()); )* };
    }
    model_writers! { change }
    for geom in 0..model.ngeom() {
        let mut geom = model.geom_mut(geom).unwrap();
        geom.set_contype(7);
        geom.set_conaffinity(7);
        geom.set_group(1);
    }
    for joint in 0..model.njnt() {
        let limited = model.joint(joint).unwrap().limited();
        model.joint_mut(joint).unwrap().set_limited(!limited);
    }
    for texture in 0..model.ntex() {
        model.texture_mut(texture).unwrap().rgb_mut().fill(1);
    }
    model.edit_options(|options| options.timestep *= 0.5).unwrap();
    model.edit_visual(|visual| visual.global.azimuth += 1.0).unwrap();
    model.edit_statistics(|statistics| statistics.center[0] += 1.0).unwrap();
}

/// Writable arrays of any type and row length.
trait Change {
    fn change(&mut self);
}

impl Change for f64 {
    fn change(&mut self) {
        *self += 0.125;
    }
}

impl Change for f32 {
    fn change(&mut self) {
        *self += 0.125;
    }
}

impl<T: Change, const N: usize> Change for [T; N] {
    fn change(&mut self) {
        self.iter_mut().for_each(Change::change);
    }
}

impl<T: Change> Change for &mut [T] {
    fn change(&mut self) {
        self.iter_mut().for_each(Change::change);
    }
}

impl Change for mujoco_safe::MatrixViewMut<'_> {
    fn change(&mut self) {
        self.as_mut_slice().iter_mut().for_each(Change::change);
    }
}

fn change(values: &mut impl Change) {
    values.change();
}

#[test]
fn every_change_is_undone_after_the_rollout() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
    let model = Arc::new(Model::from_xml_path(path).unwrap());
    let pristine = model.to_binary().unwrap();
    let mut changed = (*model).clone();
    change_everything(&mut changed.edit());
    let differing = changed.to_binary().unwrap().iter().zip(&pristine).filter(|(new, old)| new != old).count();
    assert!(differing > 1000, "{differing} bytes");

    // All rollouts run in one worker. The odd rollouts change everything and fail.
    let result = Rollout::new(model.clone(), 6, 1)
        .with_model_edits(|index, model| {
            assert!(model.to_binary().unwrap() == pristine, "rollout {index} has the change of another rollout");
            if index % 2 == 1 {
                change_everything(model);
                return Err(Error::Unsupported("given up".to_owned()));
            }
            Ok(())
        })
        .with_chunk(6)
        .run()
        .unwrap();
    for (index, outcome) in result.outcomes().iter().enumerate() {
        match outcome {
            Ok(()) => assert_eq!(index % 2, 0),
            Err(RolloutError::Failed { step: 0, error: Error::Unsupported(_) }) => {
                assert_eq!(index % 2, 1);
                assert!(result.states_of(index).as_slice().iter().all(|value| value.is_nan()));
            }
            Err(error) => panic!("rollout {index}: {error}"),
        }
    }
    assert!(model.to_binary().unwrap() == pristine);
}

#[test]
fn a_run_without_edits_uses_the_unedited_model() {
    let workers = Workers::new(sample::cartpole());
    let plain = || bits(Rollout::on(&workers, 4, 20).with_initial_state(SPEC, &LEANING).run().unwrap().states());
    let before = plain();
    let heavy = Rollout::on(&workers, 4, 20).with_initial_state(SPEC, &LEANING).with_model_edits(|_, model| {
        model.body_mass_mut()[2] *= 10.0;
    });
    assert!(bits(heavy.run().unwrap().states()) != before);
    assert_eq!(plain(), before);
}

const SPEC: mujoco_safe::StateSpec = mujoco_safe::StateSpec::QPOS;
const LEANING: [f64; 2] = [0.0, 0.3];
