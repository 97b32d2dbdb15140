//! Changes of the model and its options.

use mujoco_safe::{
    Collision, Cone, Data, DisableFlags, EnableFlags, Integrator, JacobianStorage, Options, Result, Solver,
};

use super::{Bytes, Call, touch_all};

/// Changes options in one edit.
fn options(data: &mut Data, change: impl FnOnce(&mut Options)) -> Result<()> {
    data.edit_model(|model| model.options(change))?
}

/// How many iterations: few, seldom more, and seldom more than are allowed.
fn iterations(bytes: &mut Bytes<'_>) -> usize {
    match bytes.below(200) {
        0 => 10_000_000,
        1..8 => 300,
        _ => bytes.below(12),
    }
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("options: solver", |scene, bytes| {
        let solver = [Solver::Pgs, Solver::Cg, Solver::Newton][bytes.below(3)];
        options(&mut scene.data, |options| options.solver = solver)
    }),
    ("options: integrator", |scene, bytes| {
        let integrator = [Integrator::Euler, Integrator::Rk4, Integrator::Implicit][bytes.below(3)];
        options(&mut scene.data, |options| options.integrator = integrator)
    }),
    ("options: cone, jacobian, collision", |scene, bytes| {
        let cone = [Cone::Elliptic, Cone::Pyramidal][bytes.below(2)];
        let jacobian = [JacobianStorage::Dense, JacobianStorage::Sparse, JacobianStorage::Auto][bytes.below(3)];
        let collision = [Collision::All, Collision::Pair, Collision::Dynamic][bytes.below(3)];
        options(&mut scene.data, |options| {
            (options.cone, options.jacobian, options.collision) = (cone, jacobian, collision);
        })
    }),
    ("options: flags", |scene, bytes| {
        // Few at a time, and sometimes some that do not exist.
        let mask = if bytes.once_in(16) { u32::MAX } else { 0x1fff };
        let (disable, enable) = (bytes.word() & bytes.word() & bytes.word(), bytes.word() & bytes.word());
        options(&mut scene.data, |options| {
            options.disable = DisableFlags::from_bits_retain(disable as u32 & mask);
            options.enable =
                EnableFlags::from_bits_retain(enable as u32 & mask & if mask == u32::MAX { mask } else { 0x1f });
        })
    }),
    ("options: iterations", |scene, bytes| {
        let (main, noslip, mpr) = (iterations(bytes), iterations(bytes), iterations(bytes));
        options(&mut scene.data, |options| {
            (options.iterations, options.noslip_iterations, options.mpr_iterations) = (main, noslip, mpr);
        })
    }),
    ("options: a number", |scene, bytes| {
        let (which, value) = (bytes.below(10), bytes.number());
        options(&mut scene.data, |options| match which {
            0 => options.timestep = value,
            1 => options.impratio = value,
            2 => options.tolerance = value,
            3 => options.noslip_tolerance = value,
            4 => options.mpr_tolerance = value,
            5 => options.density = value,
            6 => options.viscosity = value,
            7 => options.o_margin = value,
            8 => options.timestep = value.abs() * 0.01,
            _ => options.impratio = value.abs(),
        })
    }),
    ("options: vectors", |scene, bytes| {
        let (which, vector, other) = (bytes.below(5), bytes.numbers(), bytes.numbers());
        options(&mut scene.data, |options| match which {
            0 => options.gravity = vector,
            1 => options.wind = vector,
            2 => options.magnetic = vector,
            3 => options.o_solref = [vector[0], vector[1]],
            _ => options.o_solimp = other,
        })
    }),
    ("set_timestep", |scene, bytes| {
        let timestep = bytes.number();
        scene.data.edit_model(|model| model.set_timestep(timestep))?
    }),
    ("an array of the model", |scene, bytes| {
        let which = bytes.below(touch_all::MODEL_MUT.len());
        let (all, value, stride) = (bytes.once_in(2), bytes.number(), 1 + bytes.below(7));
        scene.data.edit_model(|model| {
            if all {
                touch_all::write_model(model, which, &mut || value);
            } else {
                // The others get what they may get from a program.
                let mut at = 0;
                touch_all::write_model(model, which, &mut || {
                    at += 1;
                    if at % stride == 0 { value } else { 0.5 }
                });
            }
        })
    }),
    ("an element of the model", |scene, bytes| {
        let (which, value) = (bytes.below(9), bytes.number());
        let index = bytes.index(scene.data.model().nbody());
        scene.data.edit_model(|model| -> Result<()> {
            match which {
                0 => model.joint_mut(index)?.set_stiffness(value),
                1 => model.joint_mut(index)?.range_mut()[0] = value,
                2 => model.joint_mut(index)?.armature_mut().fill(value),
                3 => model.actuator_mut(index)?.gear_mut().fill(value),
                4 => model.actuator_mut(index)?.set_cranklength(value),
                5 => model.joint_mut(index)?.qpos0_mut().fill(value),
                6 => model.joint_mut(index)?.damping_mut().fill(value),
                7 => model.actuator_mut(index)?.dynprm_mut().fill(value),
                _ => model.joint_mut(index)?.pos_mut().fill(value),
            }
            Ok(())
        })?
    }),
    ("update_constants", |scene, _| scene.data.edit_model(|model| model.update_constants())?),
    ("no edit", |scene, _| scene.data.edit_model(|_| ())),
    ("the model as it was", |scene, _| {
        scene.data = Data::new(scene.model.clone())?;
        Ok(())
    }),
];
