//! The analytic method, one term at a time: A and B against extrapolated differences of the
//! engine's `mj_step`.

pub(crate) mod constraints;
pub(crate) mod contacts;
mod integrator;
pub(crate) mod random_models;
pub(crate) mod sensors;
pub(crate) mod smooth;
pub(crate) mod tendons;

use mujoco_safe::derivative::{DifferencedTerms, LinearisationReport, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model, StateSpace};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::oracle::Oracle;

/// Steps of the differences. The larger ones suit stiff constraints, whose forces are the noisier
/// ones. The smaller ones avoid the kinks of a step, such as a contact about to be made.
const WIDTHS: [f64; 6] = [2e-5, 2e-6, 2e-4, 2e-7, 2e-3, 2e-8];

/// Ratios of steps that measure the noise of the differences.
const NEAR: [f64; 2] = [0.6, 1.7];

/// Ratio of the steps of controls, which a step depends on linearly between its kinks, to those of
/// the state.
const CONTROL_FACTOR: f64 = 1e3;

/// Largest deviation of a column, relative to the largest entry of A or B.
const TOLERANCE: f64 = 1e-7;

/// Largest deviation where differences of steps are noisy, from these or from differences of
/// inverse dynamics, which need no solver.
const NOISY_TOLERANCE: f64 = 1e-5;

/// Steps of differences of inverse dynamics.
const IMPLICIT_STEPS: [f64; 4] = [1e-7, 1e-6, 1e-5, 1e-8];

/// Options: cones, and formats of the Jacobian.
pub(crate) const OPTIONS: [&str; 4] =
    ["", r#"jacobian="sparse""#, r#"cone="elliptic" impratio="3""#, r#"cone="elliptic" jacobian="sparse""#];

/// Returns the flag that disables springs and dampers, which are two flags since 3.3.6.
fn without_passive_forces() -> &'static str {
    if cfg!(engine_since = "3.3.6") {
        r#"<flag spring="disable" damper="disable"/>"#
    } else {
        r#"<flag passive="disable"/>"#
    }
}

fn analytic(data: &mut Data) -> (StateSpace, LinearisationReport) {
    let options = TransitionOptions::default().with_method(TransitionMethod::Analytic);
    Lineariser::new(data.model().clone(), options).unwrap().linear_system(data).unwrap()
}

/// Returns the linear system by differences of inverse dynamics.
fn implicitly(data: &mut Data, eps: f64) -> StateSpace {
    let options = TransitionOptions::default().with_method(TransitionMethod::Implicit).with_eps(eps);
    Lineariser::new(data.model().clone(), options).unwrap().linear_system(data).unwrap().0
}

/// Compares A and B with the differences, and checks that the method did not fall back to another.
/// Returns the differenced terms.
#[track_caller]
fn check(what: &str, data: &mut Data) -> DifferencedTerms {
    compare(data).unwrap_or_else(|failure| panic!("{what}: {failure}")).differenced
}

/// Agreement of a linear system with the differences.
struct Agreement {
    differenced: DifferencedTerms,
    /// Description of the columns, if there are any, whose differences of a step are noisy, and
    /// which agree with those of inverse dynamics.
    noisy: Vec<String>,
}

/// Does the same as [`check`], and returns a failure as text.
fn compare(data: &mut Data) -> Result<Agreement, String> {
    let (system, report) = analytic(data);
    if report.method != TransitionMethod::Analytic {
        return Err(format!("{report:?}"));
    }
    let nx = system.a.ncols();
    let mut oracle = Oracle::new(data);
    let width = |index: usize, width: f64| if index < nx { width } else { CONTROL_FACTOR * width };
    let first: Vec<Vec<f64>> =
        (0..nx + system.b.ncols()).map(|index| oracle.column(index, width(index, WIDTHS[0]))).collect();
    let largest = |columns: &[Vec<f64>]| {
        columns.iter().flat_map(|column| &column[..nx]).fold(SMALL, |largest: f64, value| largest.max(value.abs()))
    };
    let scales = [largest(&first[..nx]), largest(&first[nx..])];
    let mut noisy = Vec::new();
    let mut implicit = None;
    for (index, first) in first.into_iter().enumerate() {
        let (ours, column_index) = if index < nx { (&system.a, index) } else { (&system.b, index - nx) };
        let ours: Vec<f64> = (0..nx).map(|row| ours[(row, column_index)]).collect();
        let scale = scales[usize::from(index >= nx)];
        let mut next = |step: f64| oracle.column(index, width(index, step));
        let column = |text: String| format!("column {index}, {:?}: {text}", report.differenced);
        if let Some((by_steps, noise)) = compare_column(&ours, &first, &mut next, scale).map_err(column)? {
            let implicit = implicit.get_or_insert_with(|| IMPLICIT_STEPS.map(|eps| implicitly(data, eps)));
            let by_inverse_dynamics = implicit.iter().map(|system| {
                let theirs = if index < nx { &system.a } else { &system.b };
                let theirs: Vec<f64> = (0..nx).map(|row| theirs[(row, column_index)]).collect();
                deviation(&ours, &theirs) / scale
            });
            let by_inverse_dynamics = by_inverse_dynamics.fold(f64::INFINITY, f64::min);
            let text = format!("{noise}, those of inverse dynamics by {by_inverse_dynamics:.1e}");
            if by_steps.min(by_inverse_dynamics) > NOISY_TOLERANCE {
                return Err(column(text));
            }
            noisy.push(column(text));
        }
    }
    Ok(Agreement { differenced: report.differenced, noisy })
}

/// Compares a column with the differences by one step after another, until they agree. If none
/// does, the step with the least deviation and two others near it show the noise of the
/// differences: their largest disagreement. Differences that disagree with each other by half as
/// much as with the column are described.
fn compare_column(
    ours: &[f64],
    first: &[f64],
    difference: &mut dyn FnMut(f64) -> Vec<f64>,
    scale: f64,
) -> Result<Option<(f64, String)>, String> {
    let (mut least, mut best, mut list) = (f64::INFINITY, (WIDTHS[0], first.to_vec()), Vec::new());
    for width in WIDTHS {
        let truth = if width == WIDTHS[0] { first.to_vec() } else { difference(width) };
        let error = deviation(ours, &truth) / scale;
        if error <= TOLERANCE {
            return Ok(None);
        }
        list.push(format!("{error:.1e}"));
        if error < least {
            (least, best) = (error, (width, truth));
        }
    }
    let (width, truth) = best;
    let near = NEAR.map(|factor| difference(factor * width));
    if near.iter().any(|near| deviation(ours, near) <= TOLERANCE * scale) {
        return Ok(None);
    }
    let noise = near.iter().map(|near| deviation(&truth, near)).fold(deviation(&near[0], &near[1]), f64::max) / scale;
    let text =
        format!("deviates by {list:?}, the differences near a step of {width:.0e} by {noise:.1e} from each other");
    if least <= 2.0 * noise { Ok(Some((least, text))) } else { Err(text) }
}

/// Returns the largest difference of two columns.
fn deviation(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).max_by(f64::total_cmp).unwrap_or(0.0)
}

/// Largest number of a matrix below which the rounding of the differences is not small any more: of
/// a B whose controls are clamped.
const SMALL: f64 = 1e-6;

pub(crate) fn model(xml: &str) -> Data {
    Data::new(Model::from_xml_str(xml).unwrap_or_else(|error| panic!("{error}: {xml}"))).unwrap()
}

/// Moves to a random state, with random controls and activations.
pub(crate) fn randomise(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    let mut value = || random.random_range(-1.0..1.0);
    data.reset().unwrap();
    let model = data.model().clone();
    let shift: Vec<f64> = (0..model.nv()).map(|_| value()).collect();
    model.integrate_pos(data.qpos_mut(), &shift, 1.0).unwrap();
    data.qvel_mut().iter_mut().for_each(|qvel| *qvel = 3.0 * value());
    data.ctrl_mut().iter_mut().for_each(|ctrl| *ctrl = value());
    data.act_mut().iter_mut().for_each(|act| *act = value());
}
