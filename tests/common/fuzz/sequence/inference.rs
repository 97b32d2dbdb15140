//! Inverse kinematics, estimation, identification, and their solvers.

use std::hint::black_box;

use mujoco_safe::control::residual::{Frame, FramePose, JointPosition, Subtree};
use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise};
use mujoco_safe::identification::{self, Experiment, Identification, Signal, Unknown};
use mujoco_safe::ik::{Avoidance, Ik, SearchOptions, Task};
use mujoco_safe::least_squares::{Function, LeastSquares, LeastSquaresOptions};
use mujoco_safe::math::{Qp, QpProblem};
use mujoco_safe::{Data, Matrix, Result};

use super::linearise::{is_small, parameters};
use super::{Bytes, Call, Scene};

/// Returns inverse kinematics with random tasks and limits.
fn inverse_kinematics(scene: &Scene<'_>, bytes: &mut Bytes<'_>) -> Result<Ik> {
    let model = scene.data.model().clone();
    let mut ik = Ik::new(&model);
    for _ in 0..bytes.below(4) {
        let body = model.bodies().nth(bytes.below(model.nbody())).expect("there is a world");
        let joint = model.joints().nth(bytes.below(model.njnt()));
        let task = match (bytes.below(3), joint) {
            (0, Some(joint)) => Task::new(JointPosition::new(&model, joint.id())?),
            (1, _) => Task::new(Subtree::com(&model, body.id())?),
            _ => Task::new(FramePose::new(Frame::body(&model, body.id())?)),
        };
        let task = match bytes.below(4) {
            0 => task.with_weight(bytes.number()),
            1 => task.with_gain(bytes.number()).with_priority(bytes.below(3) as u32),
            2 => task.with_damping(bytes.number()),
            _ => task,
        };
        let size = task.size();
        let id = ik.add_task(task);
        if bytes.once_in(2) {
            let target = bytes.vector(size);
            // A target of a wrong length or a pose without a direction is an error.
            let _ = ik.set_target(id, &target);
        }
    }
    match bytes.below(6) {
        0 => ik.set_velocity_limits(bytes.number())?,
        1 => ik.set_position_margin(bytes.number())?,
        2 => ik.set_regularisation(bytes.number())?,
        3 => {
            let mut geoms = model.geoms();
            if let (Some(first), Some(last)) = (geoms.next(), geoms.next_back()) {
                let minimum = bytes.number();
                ik.avoid(first.id(), last.id(), Avoidance { minimum, ..Avoidance::default() })?;
            }
        }
        _ => {}
    }
    Ok(ik)
}

/// Returns a filter with noise of all kinds. `None` for models of which a step is slow to
/// linearise.
fn filter(data: &Data, bytes: &mut Bytes<'_>) -> Result<Option<ExtendedKalmanFilter>> {
    let model = data.model().clone();
    if !is_small(&model, bytes) {
        return Ok(None);
    }
    let nx = 2 * model.nv() + model.na();
    let mut noise = ProcessNoise::new(&model);
    match bytes.below(5) {
        0 => noise = noise.with_controls(&bytes.vector(model.nu()))?,
        1 => noise = noise.with_forces(&bytes.vector(model.nv()))?,
        2 => noise = noise.with_contact_forces(bytes.number(), bytes.number())?,
        3 => noise = noise.with_covariance(&Matrix::from_diagonal(&bytes.vector(nx)))?,
        _ => {}
    }
    let mut measurement = Measurement::new(&model);
    for sensor in model.sensors().take(bytes.below(4)) {
        let deviation = if bytes.once_in(4) { bytes.number() } else { 0.1 };
        measurement = measurement.with_sensor(sensor.id(), deviation)?;
    }
    let diagonal = if bytes.once_in(4) { bytes.vector(nx) } else { vec![0.01; nx] };
    let filter = ExtendedKalmanFilter::new(data.clone(), &Matrix::from_diagonal(&diagonal), noise, measurement)?;
    if bytes.once_in(3) { filter.with_gate(bytes.number()).map(Some) } else { Ok(Some(filter)) }
}

/// Returns a delay that is not so negative that a simulation takes long.
fn lag(timestep: f64, bytes: &mut Bytes<'_>) -> f64 {
    let lag = bytes.number();
    if lag.abs() < 100.0 { lag * timestep } else { lag.max(-10.0 * timestep) }
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("Ik::step", |scene, bytes| {
        let mut ik = inverse_kinematics(scene, bytes)?;
        let dt = if bytes.once_in(3) { bytes.number() } else { 0.01 };
        for _ in 0..=bytes.below(3) {
            let tick = ik.step(&mut scene.data, dt)?;
            black_box((tick.is_solved(), tick.velocity().len(), tick.conflicts().len(), tick.equality_violation()));
        }
        Ok(())
    }),
    ("Ik::search", |scene, bytes| {
        let mut ik = inverse_kinematics(scene, bytes)?;
        if !is_small(scene.data.model(), bytes) {
            return Ok(());
        }
        let mut options = SearchOptions::default();
        (options.starts, options.iterations) = (bytes.below(4) as u32, bytes.below(5) as u32);
        if bytes.once_in(4) {
            (options.tolerance, options.step) = (bytes.number(), bytes.number());
        }
        ik.search(&mut scene.data, &options).map(|outcome| _ = black_box(outcome))
    }),
    ("ExtendedKalmanFilter", |scene, bytes| {
        let Some(mut filter) = filter(&scene.data, bytes)? else { return Ok(()) };
        for _ in 0..=bytes.below(3) {
            let (controls, readings) =
                (bytes.vector(scene.data.model().nu()), bytes.vector(filter.measurement().len()));
            black_box(filter.update(&controls, &readings)?);
            black_box(filter.predict(&controls)?);
            let components = bytes.below(3)..bytes.below(8);
            black_box(filter.nees(&scene.data, components)?);
        }
        black_box((filter.covariance().nrows(), filter.innovations().len(), filter.control_noise().len()));
        Ok(())
    }),
    ("FixedLagSmoother", |scene, bytes| {
        let Some(filter) = filter(&scene.data, bytes)? else { return Ok(()) };
        let width = filter.measurement().len();
        let mut smoother = FixedLagSmoother::new(filter, bytes.below(4))?.with_iterations(2, 1e-9)?;
        for _ in 0..=bytes.below(3) {
            let (controls, readings) = (bytes.vector(scene.data.model().nu()), bytes.vector(width));
            black_box(smoother.update(&controls, &readings)?);
            black_box(smoother.predict(&controls)?);
        }
        black_box(smoother.smooth()?);
        black_box((smoother.state(0).len(), smoother.covariance(0).nrows()));
        Ok(())
    }),
    ("Identification", |scene, bytes| {
        let model = scene.data.model().clone();
        let Some(sensor) = model.sensors().nth(bytes.below(model.nsensor())).filter(|_| is_small(&model, bytes)) else {
            return Ok(());
        };
        let mut unknowns = Vec::new();
        for parameter in parameters(&model, bytes) {
            let unknown = Unknown::parameter(&model, parameter)?;
            unknowns.push(match bytes.below(6) {
                0 => unknown.starting_at(bytes.number()),
                1 => unknown.between(bytes.number(), bytes.number()),
                2 => unknown.with_prior(bytes.number(), bytes.number()),
                3 => unknown.with_scale(bytes.number()).logarithmic(),
                _ => unknown,
            });
        }
        let h = model.timestep();
        let times: Vec<f64> = (0..4).map(|step| scene.data.time() + h * f64::from(step)).collect();
        let values = Matrix::from_row_major(4, sensor.dim(), vec![bytes.number(); 4 * sensor.dim()]);
        let mut measurement = identification::Measurement::of_sensor(&model, sensor.id(), Signal::new(times, values)?)?;
        match bytes.below(6) {
            0 => measurement = measurement.with_deviation(bytes.number()),
            1 => measurement = measurement.with_delay(lag(h, bytes)),
            2 => unknowns.push(Unknown::gain(measurement.name())),
            3 => unknowns.push(Unknown::delay(measurement.name()).between(0.0, lag(h, bytes))),
            _ => {}
        }
        let mut experiment = Experiment::new("random", &scene.data).with_measurement(measurement);
        if bytes.once_in(3) {
            let nx = 2 * model.nv() + model.na();
            experiment = experiment.with_uncertain_start(&bytes.vector(nx));
        }
        let mut options = identification::Options::default();
        options.iterations = bytes.below(4);
        let fit = Identification::new(unknowns)?.with_experiment(experiment)?.solve(options)?;
        black_box((fit.status(), fit.to_string(), fit.undetermined().len()));
        fit.model(&model).map(drop)
    }),
    ("Qp::solve", |_, bytes| {
        let (n, m) = (bytes.below(6), bytes.below(4));
        let mut matrix = |rows, columns| {
            let values = (0..rows * columns).map(|_| if bytes.once_in(4) { bytes.number() } else { bytes.fraction() });
            Matrix::from_row_major(rows, columns, values.collect::<Vec<_>>())
        };
        let (half, constraints) = (matrix(n, n), matrix(m, n));
        let mut h = Matrix::identity(n);
        for row in 0..n {
            for column in 0..n {
                h[(row, column)] += (0..n).map(|at| half[(row, at)] * half[(column, at)]).sum::<f64>();
            }
        }
        let (g, mut x) = (bytes.vector(n), bytes.vector(n));
        let (lower, upper) = (bytes.vector(n), bytes.vector(n));
        let (least, most) = (bytes.vector(m), bytes.vector(m));
        let problem = QpProblem::new(&h, &g).with_constraints(&constraints, &least, &most);
        let problem = if bytes.once_in(2) { problem.with_bounds(&lower, &upper) } else { problem };
        Qp::new(n, m).solve(&mut x, &problem).map(|solution| _ = black_box(solution.iterations))
    }),
    ("LeastSquares::minimise", |_, bytes| {
        let n = bytes.below(4);
        let mut x = bytes.vector(n);
        let (slope, shift) = (bytes.number(), bytes.number());
        let residuals = |x: &[f64], residuals: &mut [f64]| {
            for (at, residual) in residuals.iter_mut().enumerate() {
                *residual = x.iter().map(|value| (slope * value).sin() + value * at as f64).sum::<f64>() - shift;
            }
            Ok(())
        };
        let mut options = LeastSquaresOptions::default();
        options.iterations = bytes.below(20);
        options.tolerance = if bytes.once_in(3) { bytes.number() } else { 1e-10 };
        let (lower, upper) = (bytes.vector(x.len()), bytes.vector(x.len()));
        let n = x.len();
        let mut problem = Function::new(&mut x, bytes.below(6), residuals)?;
        if bytes.once_in(2) {
            problem = problem.with_bounds(&lower, &upper)?;
        }
        LeastSquares::new(n, options)?.minimise(&mut problem).map(|outcome| _ = black_box(outcome))
    }),
];
