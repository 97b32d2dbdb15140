//! Steps, half steps and resets.

use super::{Call, models};

pub(super) const CALLS: &[(&str, Call)] = &[
    ("step", |scene, _| scene.data.step()),
    ("steps", |scene, bytes| (0..bytes.below(4)).try_for_each(|_| scene.data.step())),
    ("step1", |scene, _| scene.data.step1()),
    ("step2", |scene, _| scene.data.step2()),
    ("step1, step2", |scene, _| scene.data.step1().and_then(|()| scene.data.step2())),
    ("forward", |scene, _| scene.data.forward()),
    ("inverse", |scene, _| scene.data.inverse()),
    ("reset", |scene, _| scene.data.reset()),
    ("reset_to_key", |scene, bytes| {
        let key = bytes.index(scene.data.model().nkey());
        scene.data.reset_to_key(key)
    }),
    ("reset_to_key by its name", |scene, bytes| {
        let name = *bytes.choose(&[&"key", &"squat", &"hanging_down", &"", &"no such key"]);
        scene.data.reset_to_key(name)
    }),
    ("set_time", |scene, bytes| {
        scene.data.set_time(bytes.number());
        Ok(())
    }),
    // The loop of a controller.
    ("controls and steps", |scene, bytes| {
        for _ in 0..bytes.below(4) {
            let ctrl = bytes.fraction();
            scene.data.ctrl_mut().fill(ctrl);
            scene.data.step()?;
        }
        Ok(())
    }),
    ("enable_timers", |_, bytes| {
        if bytes.once_in(16) {
            mujoco_safe::data::enable_timers();
        }
        Ok(())
    }),
    ("another simulation", |scene, bytes| {
        if !bytes.once_in(4) {
            return Ok(());
        }
        let model = models::model(models::choose(bytes)).clone();
        scene.other = Some(mujoco_safe::Data::new(model)?);
        Ok(())
    }),
];
