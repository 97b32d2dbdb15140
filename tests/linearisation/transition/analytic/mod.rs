//! The analytic method, one term at a time: A and B against extrapolated differences of the engine's `mj_step`.

mod constraints;
mod contacts;
mod random_models;
mod smooth;

use mujoco_safe::derivative::{DifferencedTerms, LinearisationReport, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model, StateSpace};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::oracle;

/// Steps of the differences. The larger ones suit stiff constraints, whose forces are the noisier ones. The smaller ones avoid the
/// kinks of a step, such as a contact about to be made.
const WIDTHS: [f64; 6] = [2e-5, 2e-6, 2e-4, 2e-7, 2e-3, 2e-8];

/// Ratio of the steps of controls, which a step depends on linearly between its kinks, to those of the state.
const CONTROL_FACTOR: f64 = 1e3;

/// Largest deviation of a column, relative to the largest entry of A or B.
const TOLERANCE: f64 = 1e-7;

/// Largest deviation that the noise of the differences excuses.
const MAX_NOISE: f64 = 1e-5;

/// Options: cones, and formats of the Jacobian.
const OPTIONS: [&str; 4] =
    ["", r#"jacobian="sparse""#, r#"cone="elliptic" impratio="3""#, r#"cone="elliptic" jacobian="sparse""#];

fn analytic(data: &mut Data) -> (StateSpace, LinearisationReport) {
    let options = TransitionOptions::default().with_method(TransitionMethod::Analytic);
    Lineariser::new(data.model().clone(), options).unwrap().linear_system(data).unwrap()
}

/// Compares A and B with the differences, and checks that the method did not fall back to another. Returns the differenced terms.
#[track_caller]
fn check(what: &str, data: &mut Data) -> DifferencedTerms {
    compare(data).unwrap_or_else(|failure| panic!("{what}: {failure}"))
}

/// Does the same as [`check`], and returns a failure as text.
fn compare(data: &mut Data) -> Result<DifferencedTerms, String> {
    let (system, report) = analytic(data);
    if report.method != TransitionMethod::Analytic {
        return Err(format!("{report:?}"));
    }
    let mut errors = vec![f64::INFINITY; system.a.ncols() + system.b.ncols()];
    // The least deviation of the differences by two steps from each other.
    let mut noise = errors.clone();
    let mut truths: Vec<StateSpace> = Vec::new();
    for width in WIDTHS {
        let truth = oracle::linear_system_by(data, width, CONTROL_FACTOR * width);
        errors.iter_mut().zip(column_errors(&system, &truth)).for_each(|(least, error)| *least = least.min(error));
        for earlier in &truths {
            noise.iter_mut().zip(column_errors(earlier, &truth)).for_each(|(least, error)| *least = least.min(error));
        }
        truths.push(truth);
        if errors.iter().all(|&error| error <= TOLERANCE) {
            return Ok(report.differenced);
        }
    }
    let is_noise = |(&error, &noise): (&f64, &f64)| error <= (10.0 * noise).clamp(TOLERANCE, MAX_NOISE);
    if errors.iter().zip(&noise).all(is_noise) {
        return Ok(report.differenced);
    }
    let (column, worst) = errors.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).expect("there are columns");
    let (count, noise) = (errors.len(), noise[column]);
    Err(format!(
        "column {column} of {count} deviates by {worst:e}, the differences by {noise:e}, with {:?}",
        report.differenced
    ))
}

/// Largest number of a matrix below which the rounding of the differences is not small any more: of a B whose controls are clamped.
const SMALL: f64 = 1e-6;

/// Returns the largest deviation of each column of A and B, relative to the largest numbers of the second system.
fn column_errors(ours: &StateSpace, theirs: &StateSpace) -> impl Iterator<Item = f64> {
    [(&ours.a, &theirs.a), (&ours.b, &theirs.b)].into_iter().flat_map(|(ours, theirs)| {
        let largest = theirs.as_slice().iter().fold(SMALL, |largest: f64, value| largest.max(value.abs()));
        (0..ours.ncols()).map(move |column| {
            let rows = 0..ours.nrows();
            let worst = rows.map(|row| (ours[(row, column)] - theirs[(row, column)]).abs()).max_by(f64::total_cmp);
            worst.map_or(0.0, |worst| worst / largest)
        })
    })
}

fn model(xml: &str) -> Data {
    Data::new(Model::from_xml_str(xml).unwrap_or_else(|error| panic!("{error}: {xml}"))).unwrap()
}

/// Moves to a random state, with random controls and activations.
fn randomise(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    let mut value = || random.random_range(-1.0..1.0);
    data.reset().unwrap();
    let model = data.model().clone();
    let shift: Vec<f64> = (0..model.nv()).map(|_| value()).collect();
    model.integrate_pos(data.qpos_mut(), &shift, 1.0).unwrap();
    data.qvel_mut().iter_mut().for_each(|qvel| *qvel = 3.0 * value());
    data.ctrl_mut().iter_mut().for_each(|ctrl| *ctrl = value());
    data.act_mut().iter_mut().for_each(|act| *act = value());
}
