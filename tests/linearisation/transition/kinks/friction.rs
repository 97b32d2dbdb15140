//! Friction loss at its limit: the derivative has one side, or the report names the kink.

use mujoco_safe::derivative::{Kinks, TransitionMethod};

use super::{WITH_SIDES, linearise, slide};
use crate::transition::analytic::model;
use crate::transition::oracle::Oracle;

#[test]
fn forces_near_friction_loss_have_the_derivative_of_both_sides_or_are_reported() {
    // With the impedance 0.9, the friction of a body at rest is at its limit if the force is 0.5 /
    // 0.9.
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

#[test]
fn friction_loss_at_its_limit_is_reported() {
    // D of the row is m d / (1 − d) = 18, with the impedance d = 0.9, so that the friction of a
    // body at rest is at its limit if the force is 0.9 / d.
    let of_joint = slide("", r#"frictionloss="0.9""#, r#"<motor joint="j"/>"#);
    let of_tendon = model(
        r#"<mujoco><option timestep="0.01" gravity="0 0 0"/>
             <worldbody><body><joint name="j" type="slide" axis="1 0 0"/><geom size="0.1" mass="2"/></body></worldbody>
             <tendon><fixed name="t" frictionloss="0.9"><joint joint="j" coef="1"/></fixed></tendon>
             <actuator><motor joint="j"/></actuator></mujoco>"#,
    );
    for mut data in [of_joint, of_tendon] {
        for (ctrl, inertia) in [(1.0, None), (-1.0, None), (0.999, Some(2.0 + 18.0)), (-1.001, Some(2.0))] {
            data.ctrl_mut()[0] = ctrl;
            for method in WITH_SIDES {
                let (system, report) = linearise(&mut data, method);
                let kink = if method == TransitionMethod::Analytic { Kinks::CONSTRAINTS } else { Kinks::DIFFERENCES };
                let expected = if inertia.is_none() { kink } else { Kinks::empty() };
                assert_eq!((report.fallback, report.kinks), (None, expected), "{ctrl} {method:?}");
                let Some(inertia) = inertia else { continue };
                assert!((system.b[(1, 0)] - 0.01 / inertia).abs() < 1e-7, "{ctrl} {method:?}: {system:?}");
            }
        }
    }
}
