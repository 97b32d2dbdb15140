//! More than one simulation, more than one model: copies, files, threads.

use std::sync::Arc;

use mujoco_safe::{Data, Error, Model};

use super::Call;

/// Whether a model is so small that it may be written and read often.
fn small(model: &Model) -> bool {
    model.nbuffer() < 200_000
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("clone", |scene, _| {
        scene.other = Some(scene.data.clone());
        Ok(())
    }),
    ("try_clone", |scene, _| {
        scene.other = Some(scene.data.try_clone()?);
        Ok(())
    }),
    ("swap", |scene, _| {
        if let Some(other) = &mut scene.other {
            std::mem::swap(&mut scene.data, other);
        }
        Ok(())
    }),
    ("copy_from", |scene, _| scene.other.as_ref().map_or(Ok(()), |other| scene.data.copy_from(other))),
    ("copy_from, the other way", |scene, _| scene.other.as_mut().map_or(Ok(()), |other| other.copy_from(&scene.data))),
    ("clone_from", |scene, _| {
        if let Some(other) = &scene.other {
            scene.data.clone_from(other);
        }
        Ok(())
    }),
    ("drop", |scene, _| {
        scene.other = None;
        Ok(())
    }),
    ("a step of the other", |scene, _| scene.other.as_mut().map_or(Ok(()), Data::step)),
    ("a step in another thread", |scene, bytes| {
        if !bytes.once_in(4) {
            return Ok(());
        }
        let Some(other) = &mut scene.other else { return Ok(()) };
        let data = &mut scene.data;
        std::thread::scope(|scope| {
            let other = scope.spawn(|| other.step());
            data.step().and(other.join().expect("a step panicked"))
        })
    }),
    ("a clone of the model", |scene, _| {
        let model = scene.data.model().try_clone()?;
        let same = model.is_same_structure(scene.data.model());
        assert!(same, "a clone has another structure");
        scene.other = Some(Data::new(model)?);
        Ok(())
    }),
    ("to_binary, from_binary", |scene, bytes| {
        if !small(scene.data.model()) && !bytes.once_in(8) {
            return Ok(());
        }
        let file = scene.data.model().to_binary()?;
        // Numbers that were written to may make a model that is refused.
        scene.other = Some(Data::new(Model::from_binary(&file)?)?);
        Ok(())
    }),
    ("save_xml", |scene, bytes| {
        if !bytes.once_in(8) {
            return Ok(());
        }
        match scene.data.model().save_xml("saved.xml") {
            Err(Error::XmlReplaced) => Ok(()),
            result => result,
        }
    }),
    ("is_same_structure", |scene, _| {
        if let Some(other) = &scene.other {
            let _ = scene.data.model().is_same_structure(other.model());
        }
        Ok(())
    }),
    ("a model edited before it is shared", |scene, bytes| {
        let mut model = scene.data.model().try_clone()?;
        let number = bytes.number();
        model.edit().body_mass_mut().fill(number);
        let result = model.edit().update_constants();
        scene.data = Data::new(Arc::new(model))?;
        result
    }),
];
