//! The default method, the implicit method and the derivatives of inverse dynamics against
//! differences of the engine's `mj_step` and of inverse dynamics, with every entry of A, B, C and
//! D: on models with the features of newer engines, and with each array of the model changed.
//!
//! An entry counts as compared if two steps of the differences agree on it. At a kink, or where the
//! noise of the solver is too large, none do.

mod arrays;
mod features;
mod schema;

use std::fmt::Debug;

use mujoco_safe::derivative::{
    InverseForce, InverseJacobians, LinearisationReport, TransitionMethod, TransitionOptions,
};
use mujoco_safe::{Data, Error, Lineariser, Matrix, Model, StateSpace};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::transition::oracle::linear_system_by;

/// Steps of the differences.
const WIDTHS: [f64; 4] = [2e-5, 2e-4, 2e-6, 2e-3];

/// Steps of differences for entries that differ.
const FINER_WIDTHS: [f64; 2] = [1e-6, 4e-7];

/// Steps of the differences of inverse dynamics.
const INVERSE_WIDTHS: [f64; 3] = [1e-6, 1e-5, 1e-7];

/// Name of a matrix, and the function that returns it.
type Block<T> = (&'static str, fn(&T) -> &Matrix);

/// Results of comparisons.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) compared: usize,
    pub(crate) noisy: usize,
    /// Entries that differ from central differences, of systems whose report names kinks.
    pub(crate) reported: usize,
    pub(crate) failures: Vec<String>,
    pub(crate) reports: Vec<LinearisationReport>,
}

impl Tally {
    /// Compares a matrix with its estimates by differences. `finer` returns estimates by smaller
    /// steps, for entries that differ.
    fn compare(
        &mut self,
        (name, subject, report): (&str, &dyn Debug, LinearisationReport),
        ours: &Matrix,
        estimates: &[&Matrix],
        finer: &mut dyn FnMut() -> Vec<Matrix>,
        relative: f64,
    ) {
        let mut worst: Option<(f64, String)> = None;
        let largest =
            |matrix: &Matrix| matrix.as_slice().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let scale = estimates.iter().map(|matrix| largest(matrix)).fold(f64::INFINITY, f64::min).max(1e-3);
        for row in 0..ours.nrows() {
            for column in 0..ours.ncols() {
                let values: Vec<f64> = estimates.iter().map(|matrix| matrix[(row, column)]).collect();
                // The pair of estimates that agrees best.
                let pairs = (0..values.len()).flat_map(|first| (0..first).map(move |second| (first, second)));
                let spread = |&(first, second): &(usize, usize)| (values[first] - values[second]).abs();
                let (first, second) = pairs.min_by(|one, other| spread(one).total_cmp(&spread(other))).unwrap();
                let noise = spread(&(first, second));
                if noise > 1e-3 * scale {
                    self.noisy += 1;
                    continue;
                }
                self.compared += 1;
                let value = ours[(row, column)];
                let deviation = (value - values[first]).abs().min((value - values[second]).abs());
                let deviation = if deviation.is_nan() { f64::INFINITY } else { deviation };
                if deviation <= relative * scale + 10.0 * noise {
                    continue;
                }
                // Beside a kink, larger steps agree on the slope behind it.
                let finer = finer();
                let agrees = |finer: &Matrix| (finer[(row, column)] - value).abs() <= 1e-3 * scale;
                if !finer.is_empty() && finer.iter().all(agrees) {
                    continue;
                }
                // At a kink, central differences are means of two sides, or do not converge.
                if !report.kinks.is_empty() {
                    self.reported += 1;
                    continue;
                }
                if worst.as_ref().is_none_or(|(worst, _)| deviation > *worst) {
                    let text = format!(
                        "{name} {subject:?} {report:?}[{row}, {column}] is {value:e} instead of {values:?}, scale {scale:.1e}"
                    );
                    worst = Some((deviation, text));
                }
            }
        }
        self.failures.extend(worst.map(|(_, text)| text));
    }
}

/// Sets a random state near the present one, with controls and activations.
pub(crate) fn randomise(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    let model = data.model().clone();
    let direction: Vec<f64> = (0..model.nv()).map(|_| random.random_range(-0.3..0.3)).collect();
    model.integrate_pos(data.qpos_mut(), &direction, 1.0).unwrap();
    data.qvel_mut().iter_mut().for_each(|value| *value = random.random_range(-0.6..0.6));
    data.ctrl_mut().iter_mut().for_each(|value| *value = random.random_range(-1.0..1.0));
    data.act_mut().iter_mut().for_each(|value| *value = random.random_range(0.1..0.6));
}

/// Compares the default method and the implicit method with differences of steps at the present
/// state.
pub(crate) fn compare_steps(data: &mut Data, tally: &mut Tally) {
    let (mut estimates, mut finer) = (None, None);
    for method in [TransitionMethod::Analytic, TransitionMethod::Implicit] {
        let options = TransitionOptions::default().with_method(method);
        let (ours, report) = match Lineariser::new(data.model(), options).unwrap().linear_system(data) {
            // A model with delays, or a state that is unstable.
            Err(Error::Unsupported(_) | Error::Unstable(_)) => return,
            result => result.unwrap(),
        };
        tally.reports.push(report);
        let blocks: [Block<StateSpace>; 4] = [("A", |s| &s.a), ("B", |s| &s.b), ("C", |s| &s.c), ("D", |s| &s.d)];
        for (name, block) in blocks {
            let estimates = estimates.get_or_insert_with(|| WIDTHS.map(|width| linear_system_by(data, width, width)));
            let estimates = [0, 1, 2, 3].map(|at| block(&estimates[at]));
            let relative = if report.method == TransitionMethod::Columns { 1e-3 } else { 1e-4 };
            let mut finer = || {
                let finer = finer.get_or_insert_with(|| FINER_WIDTHS.map(|width| linear_system_by(data, width, width)));
                finer.iter().map(|system| block(system).clone()).collect()
            };
            tally.compare((name, &method, report), block(&ours), &estimates, &mut finer, relative);
        }
    }
}

/// Compares the derivatives of inverse dynamics with its differences at the present state and
/// random accelerations.
pub(crate) fn compare_inverse(data: &mut Data, random: &mut Xoshiro256PlusPlus, tally: &mut Tally) {
    if data.forward().is_err() {
        return;
    }
    let qacc: Vec<f64> = (0..data.model().nv()).map(|_| random.random_range(-2.0..2.0)).collect();
    for force in [InverseForce::Total, InverseForce::WithoutActuators] {
        data.qacc_mut().copy_from_slice(&qacc);
        let mut lineariser = Lineariser::new(data.model(), TransitionOptions::default()).unwrap();
        let (ours, report) = match lineariser.inverse_jacobians(data, force) {
            // A model with the option `sleep`, or inverse dynamics in discrete time with the
            // integrator RK4.
            Err(Error::Unsupported(_) | Error::Engine { .. }) => return,
            result => result.unwrap(),
        };
        tally.reports.push(report);
        let estimates = INVERSE_WIDTHS.map(|eps| {
            data.qacc_mut().copy_from_slice(&qacc);
            data.inverse_fd(eps, force).unwrap()
        });
        let blocks: [Block<InverseJacobians>; 7] = [
            ("df_dq", |s| &s.df_dq),
            ("df_dv", |s| &s.df_dv),
            ("df_da", |s| &s.df_da),
            ("ds_dq", |s| &s.ds_dq),
            ("ds_dv", |s| &s.ds_dv),
            ("ds_da", |s| &s.ds_da),
            ("dm_dq", |s| &s.dm_dq),
        ];
        for (name, block) in blocks {
            let estimates = [0, 1, 2].map(|at| block(&estimates[at]));
            tally.compare((name, &force, report), block(&ours), &estimates, &mut Vec::new, 1e-3);
        }
    }
}

/// Compares a model at several random states.
pub(crate) fn compare_model(model: Model, seed: u64, states: usize, tally: &mut Tally) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut data = Data::new(model).unwrap();
    for state in 0..states {
        data.reset().unwrap();
        randomise(&mut data, &mut random);
        if (0..3 * state).any(|_| data.step().is_err()) {
            continue;
        }
        compare_steps(&mut data, tally);
        compare_inverse(&mut data, &mut random, tally);
    }
}

/// Compares each model file of a directory.
///
/// `MODELS=dir STATES=5 cargo test --release --test linearisation -- --ignored --nocapture
/// model_files_are_linearised`
#[test]
#[ignore = "a campaign on the files of a directory"]
fn model_files_are_linearised() {
    let directory = std::env::var("MODELS").expect("MODELS is a directory");
    let states = std::env::var("STATES").map_or(5, |text| text.parse().expect("STATES is a number"));
    let mut files: Vec<_> = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut total = Tally::default();
    for file in files.iter().filter(|file| file.extension().is_some_and(|extension| extension == "xml")) {
        let model = match Model::from_xml_path(file) {
            Ok(model) => model,
            Err(error) => {
                println!("{}: {}", file.display(), error.to_string().replace('\n', " "));
                continue;
            }
        };
        let mut tally = Tally::default();
        compare_model(model, 1, states, &mut tally);
        let report = tally.reports.first();
        println!(
            "{}: {} compared, {} noisy, {} wrong, {:?}",
            file.display(),
            tally.compared,
            tally.noisy,
            tally.failures.len(),
            report.map(|report| (report.method, report.fallback))
        );
        for failure in tally.failures.iter().take(4) {
            println!("    {failure}");
        }
        total.compared += tally.compared;
        total.failures.extend(tally.failures);
    }
    assert!(total.failures.is_empty(), "{} wrong blocks, {} entries compared", total.failures.len(), total.compared);
}
