//! Muscles whose control equals their activation, and the slopes of their forces.

use mujoco_safe::derivative::{Kinks, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Differences, math};

use super::{METHODS, WITH_SIDES, linearise, linearise_with, model};
use crate::transition::assert_near;

/// Returns a simulation of a muscle at a joint or a tendon, with additions to the actuator.
fn muscle(transmission: &str, actuator: &str) -> Data {
    model(&format!(
        r#"<mujoco>
             <option timestep="0.005"/>
             <worldbody><body><joint name="j" axis="0 1 0" damping="0.1"/><geom size="0.05" pos="0.2 0 0"/></body></worldbody>
             <tendon><fixed name="t"><joint joint="j" coef="0.7"/></fixed></tendon>
             <actuator><muscle {transmission} lengthrange="-1 1" {actuator}/></actuator>
           </mujoco>"#
    ))
}

#[test]
fn a_steady_muscle_contracts() {
    const H: f64 = 0.005;
    const RISE: f64 = 0.01;
    const FALL: f64 = 0.04;
    for transmission in [r#"joint="j""#, r#"tendon="t""#] {
        for limits in ["", r#"ctrllimited="true" ctrlrange="0 1""#] {
            let mut data = muscle(transmission, limits);
            for level in [0.0, 0.3, 0.5, 1.0] {
                data.ctrl_mut()[0] = level;
                data.act_mut()[0] = level;
                let scale = 0.5 + 1.5 * level;
                let rising = H / (RISE * scale);
                // A control at the upper end of its range cannot grow.
                let by_control = if level == 1.0 { H * scale / FALL } else { rising };
                for method in WITH_SIDES {
                    for differences in [Differences::Central, Differences::Forward] {
                        let options = TransitionOptions::default().with_method(method).with_differences(differences);
                        let (system, report) = linearise_with(&mut data, options);
                        let what = format!("{transmission} {limits} {level} {method:?} {differences:?}: {system:?}");
                        assert!((system.b[(2, 0)] - by_control).abs() < 1e-4 * by_control, "{what}");
                        assert!((system.a[(2, 2)] - (1.0 - rising)).abs() < 1e-4, "{what}");
                        assert!(report.kinks.contains(Kinks::MUSCLES), "{what}");
                        assert!(!report.kinks.contains(Kinks::DIFFERENCES), "{what}");
                    }
                }
                assert!(linearise(&mut data, TransitionMethod::Engine).1.kinks.contains(Kinks::MUSCLES));
            }
        }
    }
}

#[test]
fn the_control_of_a_steady_muscle_has_the_effect_of_a_step() {
    let mut data = muscle(r#"joint="j""#, r#"ctrllimited="true" ctrlrange="0 1""#);
    for level in [0.0, 0.2, 0.8] {
        let mut after = [0.0, 1e-3].map(|by| {
            data.reset().unwrap();
            data.act_mut()[0] = level;
            data.ctrl_mut()[0] = level + by;
            data.step().unwrap();
            data.act()[0]
        });
        after[1] -= after[0];
        data.reset().unwrap();
        data.act_mut()[0] = level;
        data.ctrl_mut()[0] = level;
        for method in WITH_SIDES {
            let system = linearise(&mut data, method).0;
            assert!((system.b[(2, 0)] * 1e-3 - after[1]).abs() < 1e-8, "{level} {method:?}");
        }
    }
}

#[test]
fn a_muscle_that_settled_by_simulation_is_at_its_kink() {
    let mut data = muscle(r#"joint="j""#, "");
    for (level, start) in [(0.37, 0.9), (0.37, 0.0), (0.0, 1.0)] {
        data.reset().unwrap();
        data.act_mut()[0] = start;
        data.ctrl_mut()[0] = level;
        (0..4000).for_each(|_| data.step().unwrap());
        let rising = 0.005 / (0.01 * (0.5 + 1.5 * level));
        for method in WITH_SIDES {
            let (system, report) = linearise(&mut data, method);
            assert!((system.b[(2, 0)] - rising).abs() < 1e-4, "{level} {start} {method:?}: {system:?}");
            assert!(report.kinks.contains(Kinks::MUSCLES), "{level} {start} {method:?}");
        }
    }
}

#[test]
fn a_muscle_in_motion_or_with_a_smooth_time_constant_has_no_kink() {
    let mut data = muscle(r#"joint="j""#, "");
    // Nearer to the kink than the step of the differences.
    for (ctrl, act) in [(0.5, 0.2), (0.2, 0.5), (0.5, 0.5 - 1e-8), (0.5, 0.5 + 1e-8), (0.5, 1e-8), (0.5, -1e-8)] {
        data.ctrl_mut()[0] = ctrl;
        data.act_mut()[0] = act;
        let (closed, report) = linearise(&mut data, TransitionMethod::Analytic);
        assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, Kinks::empty()));
        for method in WITH_SIDES {
            let (system, report) = linearise(&mut data, method);
            assert_near(&format!("{ctrl} {act} {method:?}"), &system, &closed, 2e-5);
            assert!(!report.kinks.contains(Kinks::MUSCLES));
        }
    }
    if cfg!(engine_since = "3.5.0") {
        for width in [0.1, 1.0] {
            let mut data = muscle(r#"joint="j""#, &format!(r#"tausmooth="{width}""#));
            for (ctrl, act) in [(0.5, 0.5), (0.5, 0.48), (0.5, 0.52), (0.9, 0.2), (0.2, 0.9), (1.5, 0.3), (0.4, 1.2)] {
                data.ctrl_mut()[0] = ctrl;
                data.act_mut()[0] = act;
                let (closed, report) = linearise(&mut data, TransitionMethod::Analytic);
                assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, Kinks::empty()));
                for method in METHODS {
                    let system = linearise(&mut data, method).0;
                    assert_near(&format!("{width} {ctrl} {act} {method:?}"), &system, &closed, 1e-6);
                }
            }
        }
    }
}

#[test]
fn the_force_of_a_muscle_has_the_slopes_of_the_engines_curves() {
    const H: f64 = 1e-3;
    const STEP: f64 = 1e-6;
    // An ordinary muscle, and one whose range of lengths exceeds that of its active force.
    for parameters in [r#"range="0.75 1.05""#, r#"range="0.3 1.8" lmin="0.6" lmax="1.4" fpmax="0.9" fvmax="1.3""#] {
        let mut data = model(&format!(
            r#"<mujoco><option timestep="{H}" gravity="0 0 0"/>
                 <worldbody><body><joint name="j" type="slide" axis="1 0 0"/><geom size="0.1" mass="1"/></body></worldbody>
                 <actuator><muscle joint="j" lengthrange="-1 1" force="30" {parameters}/></actuator></mujoco>"#
        ));
        let gain: [f64; 9] = *data.model().actuator_gainprm()[0].first_chunk().unwrap();
        let bias: [f64; 9] = *data.model().actuator_biasprm()[0].first_chunk().unwrap();
        let range = data.model().actuator_lengthrange()[0];
        let activation = 0.6;
        let force = |length: f64, velocity: f64| {
            activation * math::muscle_gain(length, velocity, &range, 1.0, &gain)
                + math::muscle_bias(length, &range, 1.0, &bias)
        };
        // Irrational numbers, which are not at the joints of the pieces of the curves.
        for length in (0..60).map(|i| -3.0 + 0.1 * f64::from(i) + 0.0141) {
            for velocity in [-3.0, -0.7, 0.01, 0.3, 1.9] {
                data.reset().unwrap();
                data.qpos_mut()[0] = length;
                data.qvel_mut()[0] = velocity;
                data.act_mut()[0] = activation;
                let slopes = [
                    (force(length + STEP, velocity) - force(length - STEP, velocity)) / (2.0 * STEP),
                    (force(length, velocity + STEP) - force(length, velocity - STEP)) / (2.0 * STEP),
                ];
                for method in METHODS {
                    let system = linearise(&mut data, method).0;
                    let found = [system.a[(1, 0)] / H, (system.a[(1, 1)] - 1.0) / H];
                    for (found, expected) in found.into_iter().zip(slopes) {
                        let error = (found - expected).abs();
                        assert!(
                            error < 1e-4 * (1.0 + expected.abs()),
                            "{length} {velocity} {method:?}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }
}
