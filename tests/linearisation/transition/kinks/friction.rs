//! Friction loss at its limit: the derivative has one side, or the report names the kink.

use mujoco_safe::derivative::{Kinks, TransitionMethod};

use super::{WITH_SIDES, linearise, slide};
use crate::transition::oracle::Oracle;

#[test]
fn forces_near_friction_loss_have_the_derivative_of_both_sides_or_are_reported() {
    // With the impedance 0.9, the friction of a body at rest is at its limit if the force is 0.5 / 0.9.
    let end = 0.5 / 0.9;
    let mut data = slide("", r#"frictionloss="0.5""#, r#"<motor joint="j"/>"#);
    let mut kinks = 0;
    for ctrl in [0.0, 0.5, -0.5, 0.99 * end, end, -end, 1.01 * end] {
        data.ctrl_mut()[0] = ctrl;
        let mut oracle = Oracle::new(&data);
        let base = oracle.base();
        let [right, left] = [1.0, -1.0].map(|side| oracle.one_sided(2, side, &base)[1].0);
        let is_kink = (right - left).abs() > 1e-3 * right.abs().max(left.abs());
        kinks += usize::from(is_kink);
        for method in WITH_SIDES {
            let (system, report) = linearise(&mut data, method);
            let expected = match method {
                _ if !is_kink => Kinks::empty(),
                TransitionMethod::Analytic => Kinks::CONSTRAINTS,
                _ => Kinks::DIFFERENCES,
            };
            assert_eq!(report.kinks, expected, "{ctrl} {method:?}: {right} and {left}");
            let (low, high) = (right.min(left), right.max(left));
            let slope = system.b[(1, 0)];
            assert!((low - 1e-6..=high + 1e-6).contains(&slope), "{ctrl} {method:?}: {slope}, {low} to {high}");
        }
    }
    assert_eq!(kinks, 2);
}
