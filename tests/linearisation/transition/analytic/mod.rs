//! The analytic method, one term at a time: A and B against extrapolated differences of the engine's `mj_step`.

mod constraints;
mod smooth;

use mujoco_safe::derivative::{DifferencedTerms, LinearisationReport, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Matrix, Model, StateSpace};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::oracle;

/// Steps of the differences. The larger ones suit stiff constraints, whose forces are the noisier ones. The smaller ones avoid the
/// kinks of a step, such as a contact about to be made.
const WIDTHS: [f64; 5] = [2e-5, 2e-6, 2e-4, 2e-7, 2e-8];

/// Largest deviation of a column, relative to the largest entry of A or B.
const TOLERANCE: f64 = 1e-7;

fn analytic(data: &mut Data) -> (StateSpace, LinearisationReport) {
    let options = TransitionOptions::default().with_method(TransitionMethod::Analytic);
    Lineariser::new(data.model().clone(), options).unwrap().linear_system(data).unwrap()
}

/// Compares A and B with the differences, and checks that the method did not fall back to another. Returns the differenced terms.
#[track_caller]
fn check(what: &str, data: &mut Data) -> DifferencedTerms {
    let (system, report) = analytic(data);
    assert_eq!((report.method, report.fallback), (TransitionMethod::Analytic, None), "{what}");
    let mut errors = vec![f64::INFINITY; system.a.ncols() + system.b.ncols()];
    for width in WIDTHS {
        let truth = oracle::linear_system_by(data, width);
        let columns = column_errors(&system.a, &truth.a).chain(column_errors(&system.b, &truth.b));
        errors.iter_mut().zip(columns).for_each(|(least, error)| *least = least.min(error));
        if errors.iter().all(|&error| error <= TOLERANCE) {
            return report.differenced;
        }
    }
    panic!("{what}: the columns of A and B deviate by {errors:?}, with {:?}", report.differenced)
}

/// Returns the largest deviation of each column, relative to the largest number of the second matrix.
fn column_errors(ours: &Matrix, theirs: &Matrix) -> impl Iterator<Item = f64> {
    let largest = theirs.as_slice().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    (0..ours.ncols()).map(move |column| {
        let rows = 0..ours.nrows();
        let worst = rows.map(|row| (ours[(row, column)] - theirs[(row, column)]).abs()).max_by(f64::total_cmp);
        worst.map_or(0.0, |worst| if worst == 0.0 { 0.0 } else { worst / largest })
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
