//! Writing to a simulation.

use mujoco_safe::StateSpec;

use super::{Bytes, Call, touch_all};

/// Returns some parts of a state, sometimes unknown parts.
fn spec(bytes: &mut Bytes<'_>) -> StateSpec {
    let spec = StateSpec::from_bits_retain(bytes.word() as u32);
    if bytes.once_in(2) { spec } else { spec & StateSpec::all() }
}

/// Number of the first calls, which also write to arrays of results.
pub(super) const ARRAYS: usize = 2;

pub(super) const CALLS: &[(&str, Call)] = &[
    ("an array", |scene, bytes| {
        let (which, value) = (bytes.below(touch_all::DATA_MUT.len()), bytes.number());
        touch_all::write_data(&mut scene.data, which, &mut || value);
        Ok(())
    }),
    ("some of an array", |scene, bytes| {
        let (which, value, stride) = (bytes.below(touch_all::DATA_MUT.len()), bytes.number(), 2 + bytes.below(9));
        let mut at = 0;
        touch_all::write_data(&mut scene.data, which, &mut || {
            at += 1;
            if at % stride == 0 { value } else { 0.25 }
        });
        Ok(())
    }),
    ("a position or a velocity", |scene, bytes| {
        let (which, index, value) = (bytes.below(3), bytes.word() as usize, bytes.number());
        let array = match which {
            0 => scene.data.qpos_mut(),
            1 => scene.data.qvel_mut(),
            _ => scene.data.act_mut(),
        };
        let length = array.len();
        if length > 0 {
            array[index % length] = value;
        }
        Ok(())
    }),
    ("controls and forces", |scene, bytes| {
        let (ctrl, force) = (bytes.number(), bytes.number());
        scene.data.ctrl_mut().fill(ctrl);
        scene.data.qfrc_applied_mut().fill(force);
        if bytes.once_in(2) {
            scene.data.xfrc_applied_mut().as_flattened_mut().fill(force);
        }
        Ok(())
    }),
    ("mocap", |scene, bytes| {
        let (position, rotation) = (bytes.numbers(), bytes.numbers());
        scene.data.mocap_pos_mut().fill(position);
        scene.data.mocap_quat_mut().fill(rotation);
        Ok(())
    }),
    ("set_state", |scene, bytes| {
        let spec = spec(bytes);
        let state = bytes.vector(scene.data.model().state_size(spec));
        scene.data.set_state(spec, &state)
    }),
    ("set_physics_state", |scene, bytes| {
        let state = bytes.vector(scene.data.model().state_size(StateSpec::PHYSICS));
        scene.data.set_physics_state(&state)
    }),
    ("set_state to an earlier one", |scene, bytes| {
        if bytes.once_in(2) {
            scene.state = scene.data.state(StateSpec::INTEGRATION);
            return Ok(());
        }
        scene.data.set_state(StateSpec::INTEGRATION, &scene.state)
    }),
    ("set_keyframe", |scene, bytes| {
        let key = bytes.index(scene.data.model().nkey());
        if bytes.once_in(2) {
            scene.data.step()?;
        }
        scene.data.set_keyframe(key)
    }),
];
