//! Edits of the model and its options.

use std::hint::black_box;

use mujoco_safe::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use mujoco_safe::model::{DisableFlags, EnableFlags, LengthRangeMode, LengthRangeOptions, Statistics, Visual};
use mujoco_safe::{Data, Options, Result};

use super::{Bytes, Call, touch_all};

/// Changes options in one edit.
fn options(data: &mut Data, change: impl FnOnce(&mut Options)) -> Result<()> {
    data.edit_model(|model| model.edit_options(change))
}

/// A field that can be set to a number.
trait Put {
    fn put(&mut self, number: f64);
}

macro_rules! put {
    ($($type:ty)*) => {$(
        impl Put for $type {
            fn put(&mut self, number: f64) {
                *self = number as Self;
            }
        }
    )*};
}
put!(f32 f64 usize);

impl Put for bool {
    fn put(&mut self, number: f64) {
        *self = number > 0.0;
    }
}

impl<T: Put, const N: usize> Put for [T; N] {
    fn put(&mut self, number: f64) {
        for value in self {
            value.put(number);
        }
    }
}

/// Generates the number of fields of a structure, and a function that sets the field at an index.
macro_rules! fields_of {
    ($count:ident $put:ident $type:ident $($($field:ident).+)*) => {
        const $count: usize = [$(stringify!($($field).+)),*].len();

        fn $put(structure: &mut $type, which: usize, number: f64) {
            let fields: [&mut dyn Put; $count] = [$(&mut structure.$($field).+),*];
            fields.into_iter().skip(which).take(1).for_each(|field| field.put(number));
        }
    };
}
visual_fields! { fields_of VISUAL put_visual Visual }
statistic_fields! { fields_of STATISTIC put_statistic Statistics }

/// Returns options whose valid values take only a few steps.
fn length_range(timestep: f64, bytes: &mut Bytes<'_>) -> LengthRangeOptions {
    const MODES: [LengthRangeMode; 4] =
        [LengthRangeMode::None, LengthRangeMode::Muscle, LengthRangeMode::MuscleUser, LengthRangeMode::All];
    let inttotal = match bytes.below(16) {
        0 => [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300][bytes.below(5)],
        _ => timestep * bytes.below(12) as f64,
    };
    let mut options = LengthRangeOptions::default()
        .with_mode(MODES[bytes.below(4)])
        .with_useexisting(bytes.once_in(4))
        .with_uselimit(bytes.once_in(4))
        .with_inttotal(inttotal)
        .with_inteval(if bytes.once_in(8) { bytes.number() } else { inttotal / 2.0 });
    let number = bytes.number();
    match bytes.below(8) {
        0 => options.accel = number,
        1 => options.maxforce = number,
        2 => options.timeconst = number,
        3 => options.tolrange = number,
        _ => {}
    }
    options
}

/// Returns a number of iterations: small, rarely large, and rarely beyond the limit.
fn iterations(bytes: &mut Bytes<'_>) -> usize {
    match bytes.below(200) {
        0 => 10_000_000,
        1..8 => 300,
        _ => bytes.below(12),
    }
}

/// Bits of the flags that the engine has; those of other engines are above.
const PRESENT: u32 = (1 << 22) - 1;

pub(super) const CALLS: &[(&str, Call)] = &[
    ("options: solver", |scene, bytes| {
        let solver = [Solver::Pgs, Solver::Cg, Solver::Newton][bytes.below(3)];
        options(&mut scene.data, |options| options.solver = solver)
    }),
    ("options: integrator", |scene, bytes| {
        const INTEGRATORS: [Integrator; 5] =
            [Integrator::Euler, Integrator::Rk4, Integrator::Implicit, Integrator::ImplicitFast, Integrator::Discrete];
        let integrator = INTEGRATORS[bytes.below(5)];
        options(&mut scene.data, |options| options.integrator = integrator)
    }),
    ("options: cone, jacobian, collision", |scene, bytes| {
        let cone = [Cone::Elliptic, Cone::Pyramidal][bytes.below(2)];
        let jacobian = [JacobianStorage::Dense, JacobianStorage::Sparse, JacobianStorage::Auto][bytes.below(3)];
        // Newer engines have only one of these, and reject an edit with another.
        let collision = [Collision::All, Collision::Pair, Collision::Dynamic][bytes.below(3)];
        let collision = if cfg!(engine_since = "3.0.0") && bytes.once_in(2) { Collision::All } else { collision };
        options(&mut scene.data, |options| {
            (options.cone, options.jacobian, options.collision) = (cone, jacobian, collision);
        })
    }),
    ("options: flags", |scene, bytes| {
        // A few flags at a time, sometimes unknown flags and flags of other engines.
        let is_any = bytes.once_in(16);
        let mask = |known: u32| if is_any { u32::MAX } else { known & PRESENT };
        let (disable, enable) = (bytes.word() & bytes.word() & bytes.word(), bytes.word() & bytes.word());
        options(&mut scene.data, |options| {
            options.disable = DisableFlags::from_bits_retain(disable as u32 & mask(DisableFlags::all().bits()));
            options.enable = EnableFlags::from_bits_retain(enable as u32 & mask(EnableFlags::all().bits()));
        })
    }),
    ("options: iterations", |scene, bytes| {
        let (main, noslip, mpr) = (iterations(bytes), iterations(bytes), iterations(bytes));
        options(&mut scene.data, |options| {
            (options.iterations, options.noslip_iterations, options.mpr_iterations) = (main, noslip, mpr);
        })
    }),
    ("options of engines since 3.0", |scene, bytes| {
        let (which, value, count, bits) = (bytes.below(6), bytes.number(), iterations(bytes), bytes.word());
        options(&mut scene.data, |options| match which {
            0 => options.ls_tolerance = value,
            1 => options.ls_iterations = count,
            2 => options.sdf_iterations = count,
            3 => options.sdf_initpoints = count,
            4 => options.o_friction.fill(value),
            _ => options.disableactuator = bits as u32,
        })
    }),
    ("options: a number", |scene, bytes| {
        let (which, value) = (bytes.below(11), bytes.number());
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
            9 => options.apirate = value,
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
        scene.data.edit_model(|model| model.set_timestep(timestep))
    }),
    ("an array of the model", |scene, bytes| {
        let which = bytes.below(touch_all::MODEL_MUT.len());
        let (all, value, stride) = (bytes.once_in(2), bytes.number(), 1 + bytes.below(7));
        scene.data.edit_model(|model| {
            if all {
                touch_all::write_model(model, which, &mut || value);
            } else {
                // The other fields have arbitrary values.
                let mut at = 0;
                touch_all::write_model(model, which, &mut || {
                    at += 1;
                    if at % stride == 0 { value } else { 0.5 }
                });
            }
        })
    }),
    ("visual", |scene, bytes| {
        let (which, number) = (bytes.below(VISUAL), bytes.number());
        scene.data.edit_model(|model| model.edit_visual(|visual| put_visual(visual, which, number)))
    }),
    ("statistics", |scene, bytes| {
        let (which, number) = (bytes.below(STATISTIC), bytes.number());
        scene.data.edit_model(|model| model.edit_statistics(|statistics| put_statistic(statistics, which, number)))
    }),
    ("set_total_mass", |scene, bytes| {
        let mass = bytes.number();
        scene.data.edit_model(|model| {
            let result = model.set_total_mass(mass);
            black_box(model.total_mass());
            result
        })
    }),
    ("scale_mass", |scene, bytes| {
        let factor = bytes.number();
        let body = scene.data.model().body(bytes.index(scene.data.model().nbody()))?.id();
        scene.data.edit_model(|model| model.body_mut(body).scale_mass(factor))
    }),
    ("set_length_range", |scene, bytes| {
        if !bytes.once_in(if scene.data.model().nv() > 20 { 16 } else { 2 }) {
            return Ok(());
        }
        let actuator = scene.data.model().actuator(bytes.index(scene.data.model().nactuator()))?.id();
        let options = length_range(scene.data.model().timestep(), bytes);
        scene.data.edit_model(|model| model.set_length_range(actuator, &options)).map(drop)
    }),
    ("update_constants", |scene, _| scene.data.edit_model(|model| model.update_constants())),
    ("no edit", |scene, _| scene.data.edit_model(|_| ())),
    ("the original model", |scene, _| {
        scene.data = Data::new(scene.model.clone())?;
        Ok(())
    }),
];
