//! Several simulations and models: copies and threads.

use std::sync::Arc;

use mujoco_safe::Data;
use mujoco_safe::enums::{Cone, JacobianStorage, Solver};

use super::Call;

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
    ("copy_from in the other direction", |scene, _| {
        scene.other.as_mut().map_or(Ok(()), |other| other.copy_from(&scene.data))
    }),
    ("copy_from a clone with other options", |scene, bytes| {
        let mut copy = scene.data.try_clone()?;
        let (solver, dense, elliptic) =
            ([Solver::Pgs, Solver::Newton][bytes.below(2)], bytes.once_in(2), bytes.once_in(2));
        copy.edit_model(|model| {
            model.edit_options(|options| {
                options.solver = solver;
                options.jacobian = if dense { JacobianStorage::Dense } else { JacobianStorage::Sparse };
                options.cone = if elliptic { Cone::Elliptic } else { Cone::Pyramidal };
            })
        })?;
        copy.forward()?;
        if bytes.once_in(2) {
            std::mem::swap(&mut copy, &mut scene.data);
        }
        let result = scene.data.copy_from(&copy);
        if bytes.once_in(4) {
            scene.data.clone_from(&copy);
        }
        scene.other = Some(copy);
        result
    }),
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
    ("a step of the other simulation", |scene, _| scene.other.as_mut().map_or(Ok(()), Data::step)),
    ("a step in another thread", |scene, bytes| {
        if !bytes.once_in(16) {
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
