//! States where a step has a kink: each method takes the documented side, or the report names the
//! kink.

mod constraints;
mod convergence;
mod friction;
mod muscles;

use mujoco_safe::derivative::{
    Fallback, InverseForce, Kinks, LinearisationReport, TransitionMethod, TransitionOptions,
};
use mujoco_safe::{Data, Lineariser, StateSpace};

use super::analytic::model;
use super::{assert_near, deviation};

const METHODS: [TransitionMethod; 4] =
    [TransitionMethod::Engine, TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic];

/// Methods that take the side of the documentation.
const WITH_SIDES: [TransitionMethod; 3] =
    [TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic];

fn linearise(data: &mut Data, method: TransitionMethod) -> (StateSpace, LinearisationReport) {
    linearise_with(data, TransitionOptions::default().with_method(method))
}

fn linearise_with(data: &mut Data, options: TransitionOptions) -> (StateSpace, LinearisationReport) {
    Lineariser::new(data.model().clone(), options).unwrap().linear_system(data).unwrap()
}

/// Returns a slide with an actuator, without gravity, and with additions to the options and to the
/// joint.
fn slide(options: &str, joint: &str, actuator: &str) -> Data {
    model(&format!(
        r#"<mujoco><option timestep="0.01" gravity="0 0 0">{options}</option>
             <worldbody><body><joint name="j" type="slide" axis="1 0 0" {joint}/><geom size="0.1" mass="2"/></body></worldbody>
             <actuator>{actuator}</actuator></mujoco>"#
    ))
}

#[test]
fn a_control_at_the_end_of_its_range_has_the_derivative_inside() {
    let mut data = slide("", "", r#"<motor joint="j" gear="3" ctrllimited="true" ctrlrange="-0.3 0.7"/>"#);
    for ctrl in [-0.3, 0.7] {
        data.ctrl_mut()[0] = ctrl;
        for method in METHODS {
            let (system, report) = linearise(&mut data, method);
            assert!((system.b[(1, 0)] - 0.015).abs() < 1e-8, "{ctrl} {method:?}");
            assert_eq!(report.kinks, Kinks::CONTROLS, "{ctrl} {method:?}");
        }
    }
    for (ctrl, expected) in [(-0.31, 0.0), (0.71, 0.0), (0.1, 0.015)] {
        data.ctrl_mut()[0] = ctrl;
        for method in METHODS {
            let (system, report) = linearise(&mut data, method);
            assert!((system.b[(1, 0)] - expected).abs() < 1e-8, "{ctrl} {method:?}");
            assert_eq!(report.kinks, Kinks::empty(), "{ctrl} {method:?}");
        }
    }
}

#[test]
fn controls_that_are_not_clamped_have_an_effect_beyond_their_range() {
    let motor = r#"<motor joint="j" gear="3" ctrllimited="true" ctrlrange="-0.3 0.7"/>"#;
    let mut data = slide(r#"<flag clampctrl="disable"/>"#, "", motor);
    for ctrl in [-2.0, -0.3, 0.7, 1.0] {
        data.ctrl_mut()[0] = ctrl;
        for method in WITH_SIDES {
            let (system, report) = linearise(&mut data, method);
            assert!((system.b[(1, 0)] - 0.015).abs() < 1e-8, "{ctrl} {method:?}");
            assert_eq!(report.kinks, Kinks::empty(), "{ctrl} {method:?}");
        }
    }
}

#[test]
fn an_activation_at_the_end_of_its_range_has_the_derivative_inside() {
    for dynamics in
        [r#"dyntype="integrator""#, r#"dyntype="filter" dynprm="0.05""#, r#"dyntype="filterexact" dynprm="0.05""#]
    {
        // 2.2.2 lacks these dynamics.
        if dynamics.contains("exact") && cfg!(not(engine_since = "3.5.0")) {
            continue;
        }
        let actuator = format!(r#"<general joint="j" {dynamics} actlimited="true" actrange="-0.2 0.4" gainprm="3"/>"#);
        let mut data = slide("", "", &actuator);
        let mut reference = slide("", "", &actuator.replace(r#"actlimited="true""#, r#"actlimited="false""#));
        for act in [-0.2, 0.4] {
            for data in [&mut data, &mut reference] {
                data.act_mut()[0] = act;
                // The rate is zero.
                data.ctrl_mut()[0] = if dynamics.contains("integrator") { 0.0 } else { act };
            }
            let inside = linearise(&mut reference, TransitionMethod::Columns).0;
            for method in WITH_SIDES {
                let (system, report) = linearise(&mut data, method);
                assert_near(&format!("{dynamics} {act} {method:?}"), &system, &inside, 1e-7);
                assert_eq!(report.kinks, Kinks::ACTIVATIONS, "{dynamics} {act} {method:?}");
            }
            // Beyond the end, the next activation is constant.
            data.ctrl_mut()[0] = 5.0 * act;
            for method in METHODS {
                let (system, report) = linearise(&mut data, method);
                assert!(
                    system.b[(2, 0)].abs() + system.a[(2, 2)].abs() < 1e-12,
                    "{dynamics} {act} {method:?}: {system:?}"
                );
                assert_eq!(report.kinks, Kinks::empty(), "{dynamics} {act} {method:?}");
            }
        }
    }
}

#[test]
fn a_force_at_the_end_of_its_range_is_reported() {
    let position = r#"<position joint="j" kp="8" forcelimited="true" forcerange="-1 2"/>"#;
    let mut data = slide("", "", position);
    for (ctrl, qpos) in [(0.25, 0.0), (-0.125, 0.0), (0.0, -0.25)] {
        data.ctrl_mut()[0] = ctrl;
        data.qpos_mut()[0] = qpos;
        let (system, report) = linearise(&mut data, TransitionMethod::Analytic);
        assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, Kinks::FORCES));
        assert!((system.b[(1, 0)] - 0.04).abs() < 1e-12 && (system.a[(1, 0)] + 0.04).abs() < 1e-12);
        for method in [TransitionMethod::Columns, TransitionMethod::Implicit] {
            let (system, report) = linearise(&mut data, method);
            assert!(report.kinks.contains(Kinks::DIFFERENCES), "{ctrl} {qpos} {method:?} {report:?} {system:?}");
        }
    }
}

#[test]
fn a_force_at_the_end_of_its_range_is_reported_for_the_control_alone() {
    // The force does not depend on the state, or on the activation alone.
    let limits = r#"forcelimited="true" forcerange="-1 2""#;
    let motor = format!(r#"<motor joint="j" gear="3" {limits}/>"#);
    let filter = format!(r#"<general joint="j" dyntype="filter" dynprm="0.1" gear="3" {limits}/>"#);
    for (actuator, end) in [(&motor, -1.0), (&motor, 2.0), (&filter, -1.0), (&filter, 2.0)] {
        let mut data = slide("", "", actuator);
        data.ctrl_mut()[0] = end;
        data.act_mut().fill(end);
        let (system, report) = linearise(&mut data, TransitionMethod::Analytic);
        assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, Kinks::FORCES), "{actuator} {end}");
        // Inside the range: the time step times the gear over the mass.
        let slope = if data.model().na() > 0 { system.a[(1, 2)] } else { system.b[(1, 0)] };
        assert!((slope - 0.01 * 3.0 / 2.0).abs() < 1e-12, "{actuator} {end}: {slope}");
        for method in [TransitionMethod::Columns, TransitionMethod::Implicit] {
            assert_eq!(linearise(&mut data, method).1.kinks, Kinks::DIFFERENCES, "{actuator} {end} {method:?}");
        }
        data.ctrl_mut()[0] *= 0.99;
        data.act_mut().iter_mut().for_each(|act| *act *= 0.99);
        for method in METHODS {
            assert_eq!(linearise(&mut data, method).1.kinks, Kinks::empty(), "{actuator} {end} {method:?}");
        }
    }
}

#[test]
fn a_spring_of_a_tendon_that_becomes_slack_is_reported() {
    // 2.2.2 has one length at rest.
    if cfg!(not(engine_since = "3.5.0")) {
        return;
    }
    let mut data = model(
        r#"<mujoco><option timestep="0.01" gravity="0 0 0"/>
             <worldbody><body><joint name="j" type="slide" axis="1 0 0"/><geom size="0.1" mass="2"/></body></worldbody>
             <tendon><fixed stiffness="30" springlength="0.25 0.5"><joint joint="j" coef="1"/></fixed></tendon></mujoco>"#,
    );
    let inverse = |data: &mut Data, method| {
        let options = TransitionOptions::default().with_method(method);
        let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
        lineariser.inverse_jacobians(data, InverseForce::Total).unwrap()
    };
    for (qpos, stiffness) in [(0.2, 30.0), (0.25, 0.0), (0.4, 0.0), (0.5, 0.0), (0.6, 30.0)] {
        data.qpos_mut()[0] = qpos;
        let is_kink = [0.25, 0.5].contains(&qpos);
        let kinks = |kind: Kinks| if is_kink { kind } else { Kinks::empty() };
        let (system, report) = linearise(&mut data, TransitionMethod::Analytic);
        assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, kinks(Kinks::SPRINGS)), "{qpos}");
        assert!((system.a[(1, 0)] + 0.01 * stiffness / 2.0).abs() < 1e-12, "{qpos}: {system:?}");
        for method in [TransitionMethod::Columns, TransitionMethod::Implicit] {
            assert_eq!(linearise(&mut data, method).1.kinks, kinks(Kinks::DIFFERENCES), "{qpos} {method:?}");
        }
        let (jacobians, report) = inverse(&mut data, TransitionMethod::Analytic);
        assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, kinks(Kinks::SPRINGS)), "{qpos}");
        assert!((jacobians.df_dq[(0, 0)] - stiffness).abs() < 1e-12, "{qpos}: {jacobians:?}");
        // Differences to the right.
        let right = if qpos == 0.5 { 30.0 } else { stiffness };
        let (jacobians, report) = inverse(&mut data, TransitionMethod::Engine);
        assert_eq!((report.method, report.kinks), (TransitionMethod::Engine, kinks(Kinks::SPRINGS)), "{qpos}");
        assert!((jacobians.df_dq[(0, 0)] - right).abs() < 1e-4, "{qpos}: {jacobians:?}");
    }
}

/// Features of newer engines, of which differences are the only method.
#[test]
fn kinks_of_newer_engines_are_reported() {
    if cfg!(not(engine_since = "3.5.0")) {
        return;
    }
    let of_joint =
        slide("", r#"actuatorfrcrange="-0.9 0.6" actuatorfrclimited="true""#, r#"<motor joint="j" gear="3"/>"#);
    let of_early = r#"<general joint="j" dyntype="integrator" actearly="true" gear="3" forcelimited="true" forcerange="-0.3 0.2"/>"#;
    // The force of the next activation is at the end of its range.
    for (mut data, ctrl) in [(of_joint, 0.2), (slide("", "", of_early), 20.0)] {
        data.ctrl_mut()[0] = ctrl;
        for method in WITH_SIDES {
            assert_eq!(linearise(&mut data, method).1.kinks, Kinks::DIFFERENCES, "{ctrl} {method:?}");
        }
        data.ctrl_mut()[0] = 0.9 * ctrl;
        for method in WITH_SIDES {
            let (system, report) = linearise(&mut data, method);
            let by_control = if data.model().na() == 0 { 0.01 * 3.0 / 2.0 } else { 0.01 * 0.01 * 3.0 / 2.0 };
            assert_eq!(report.kinks, Kinks::empty(), "{ctrl} {method:?}");
            assert!((system.b[(1, 0)] - by_control).abs() < 1e-7, "{ctrl} {method:?}: {system:?}");
        }
    }
    // Damping of higher order is smooth at rest, where it vanishes.
    if let Ok(model) = mujoco_safe::Model::from_xml_str(
        r#"<mujoco><option timestep="0.01" gravity="0 0 0"/><worldbody><body><joint type="slide" damping="0 3 2"/><geom size="0.1" mass="2"/></body></worldbody></mujoco>"#,
    ) {
        let mut data = Data::new(model).unwrap();
        for method in WITH_SIDES {
            let (system, report) = linearise(&mut data, method);
            assert_eq!(report.kinks, Kinks::empty(), "{method:?}");
            assert!((system.a[(1, 1)] - 1.0).abs() < 1e-5, "{method:?}: {system:?}");
        }
    }
}

#[test]
fn limits_and_contacts_that_begin_are_reported() {
    let limited = slide("", r#"limited="true" range="-0.5 0.25""#, "");
    let with_margin = slide("", r#"limited="true" range="-0.5 0.5" margin="0.25""#, "");
    let mut cases = Vec::new();
    for (mut data, qpos) in [(limited.clone(), 0.25), (limited.clone(), -0.5), (with_margin, 0.25)] {
        data.qpos_mut()[0] = qpos;
        cases.push((format!("limit at {qpos}"), data));
    }
    let tendon = r#"<mujoco><option gravity="0 0 0"/>
        <worldbody><body><joint name="j" type="slide" axis="1 0 0"/><geom size="0.1" mass="2"/></body></worldbody>
        <tendon><fixed limited="true" range="-1 0.5"><joint joint="j" coef="2"/></fixed></tendon></mujoco>"#;
    let mut data = model(tendon);
    data.qpos_mut()[0] = 0.25;
    cases.push(("limit of a tendon".to_owned(), data));
    let ball = r#"<mujoco><option gravity="0 0 0"/>
        <worldbody><body><joint type="ball" limited="true" range="0 90"/><geom size="0.1" pos="0.2 0 0" mass="2"/></body></worldbody></mujoco>"#;
    let mut data = model(ball);
    let half = 0.5_f64.sqrt();
    data.qpos_mut().copy_from_slice(&[half, half, 0.0, 0.0]);
    cases.push(("limit of a ball".to_owned(), data));
    for margin in ["0", "0.25"] {
        let contact = format!(
            r#"<mujoco><option gravity="0 0 0"/>
                 <worldbody><geom type="plane" size="1 1 1" margin="{margin}"/>
                   <body pos="0 0 0.5"><joint type="slide" axis="0 0 1"/><geom size="0.5" mass="2"/></body></worldbody></mujoco>"#
        );
        let mut data = model(&contact);
        data.qpos_mut()[0] = margin.parse::<f64>().unwrap();
        cases.push((format!("contact with margin {margin}"), data));
    }
    for (what, mut data) in cases {
        let (system, report) = linearise(&mut data, TransitionMethod::Analytic);
        assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, Kinks::CONSTRAINTS), "{what}");
        // The present side is that without a force.
        let nv = data.model().nv();
        assert!((0..nv).all(|dof| (system.a[(nv + dof, dof)]).abs() < 1e-12), "{what}: {system:?}");
        for method in [TransitionMethod::Columns, TransitionMethod::Implicit] {
            let report = linearise(&mut data, method).1;
            assert!(report.kinks.contains(Kinks::DIFFERENCES), "{what} {method:?}");
        }
        for method in [TransitionMethod::Engine, TransitionMethod::Analytic] {
            let options = TransitionOptions::default().with_method(method);
            let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
            let (_, report) = lineariser.inverse_jacobians(&mut data, InverseForce::Total).unwrap();
            assert_eq!((report.method, report.kinks), (method, Kinks::CONSTRAINTS), "inverse dynamics, {what}");
        }
    }
    // Near them there is no kink.
    let mut data = limited;
    for qpos in [0.249, 0.251] {
        data.qpos_mut()[0] = qpos;
        for method in METHODS {
            assert_eq!(linearise(&mut data, method).1.kinks, Kinks::empty(), "{qpos} {method:?}");
        }
    }
}

#[test]
fn a_reading_at_its_cutoff_is_reported() {
    // The acceleration depends on the control alone.
    let mut data = model(
        r#"<mujoco><option timestep="0.01" gravity="0 0 0"/>
             <worldbody><body><joint name="j" type="slide" axis="1 0 0"/><geom size="0.1" mass="2"/><site name="s"/></body></worldbody>
             <actuator><motor joint="j"/></actuator>
             <sensor><accelerometer site="s" cutoff="1"/></sensor></mujoco>"#,
    );
    for (ctrl, slope) in [(1.9, Some(0.5)), (2.0, None), (2.1, Some(0.0)), (-2.0, None)] {
        data.ctrl_mut()[0] = ctrl;
        for method in WITH_SIDES {
            let (system, report) = linearise(&mut data, method);
            let kinks = if slope.is_none() { Kinks::DIFFERENCES } else { Kinks::empty() };
            assert_eq!((report.fallback, report.kinks), (None, kinks), "{ctrl} {method:?}: {system:?}");
            let Some(slope) = slope else { continue };
            assert!((system.d[(0, 0)] - slope).abs() < 1e-7, "{ctrl} {method:?}: {system:?}");
        }
    }
}

/// Springs yield at the end of a step, so that its velocities have no kink.
#[test]
fn a_step_of_a_spring_that_yields_has_no_kink() {
    // Older engines lack these springs.
    if cfg!(not(engine_since = "4.0.0")) {
        return;
    }
    for (joint, tendon) in [(r#"stiffness="30" springyield="0.25""#, ""), ("", r#"stiffness="30" springyield="0.25""#)]
    {
        let mut data = model(&format!(
            r#"<mujoco><option timestep="0.01" gravity="0 0 0"/><worldbody>
                 <body><joint name="j" type="slide" axis="1 0 0" {joint}/><geom size="0.1" mass="2"/></body>
                 <body><joint name="k" type="slide" axis="0 1 0" {joint}/><geom pos="0 0 9" size="0.1" mass="2"/></body></worldbody>
               <tendon><fixed {tendon}><joint joint="j" coef="1"/></fixed><fixed {tendon}><joint joint="k" coef="1"/></fixed></tendon>
             </mujoco>"#
        ));
        for qpos in [0.2, 0.25, 0.251, 0.5] {
            data.qpos_mut().copy_from_slice(&[qpos, -qpos]);
            for method in WITH_SIDES {
                let (system, report) = linearise(&mut data, method);
                let fallback = Some(Fallback::NotUnderstood { field: "nplastic", element: 0 });
                assert_eq!(
                    (report.fallback, report.kinks),
                    (fallback.filter(|_| method != TransitionMethod::Columns), Kinks::empty())
                );
                for dof in 0..2 {
                    let slope = system.a[(2 + dof, dof)];
                    assert!((slope + 0.01 * 30.0 / 2.0).abs() < 1e-7, "{qpos} {method:?}: {slope}");
                }
            }
        }
    }
}

#[test]
fn a_state_at_rest_without_kinks_has_none() {
    let friction = slide("", r#"frictionloss="0.5" damping="0.3""#, r#"<motor joint="j"/>"#);
    let medium = slide("", "", "").model().clone();
    let mut medium = Data::new(medium).unwrap();
    medium
        .edit_model(|model| model.edit_options(|options| (options.density, options.viscosity) = (900.0, 0.0)))
        .unwrap();
    let equality = model(
        r#"<mujoco><worldbody><body><joint name="a"/><geom size="0.1" pos="0.2 0 0"/></body><body pos="1 0 0"><joint name="b"/><geom size="0.1" pos="0.2 0 0"/></body></worldbody>
             <equality><joint joint1="a" joint2="b"/></equality></mujoco>"#,
    );
    for (what, mut data) in [("friction loss", friction), ("a medium", medium), ("an equality", equality)] {
        for method in METHODS {
            assert_eq!(linearise(&mut data, method).1.kinks, Kinks::empty(), "{what} {method:?}");
        }
    }
}

#[test]
fn wrong_differences_of_the_samples_are_reported() {
    // The trajectory is another one on aarch64, with 6e-6 in one of its states.
    let bound = if cfg!(target_arch = "aarch64") { 1e-5 } else { 1e-6 };
    for model in [mujoco_safe::sample::humanoid(), mujoco_safe::sample::cartpole()] {
        let mut data = Data::new(model).unwrap();
        data.ctrl_mut().iter_mut().enumerate().for_each(|(i, ctrl)| *ctrl = 0.05 * (i as f64).sin());
        for _ in 0..30 {
            (0..10).for_each(|_| data.step().unwrap());
            let (closed, report) = linearise(&mut data, TransitionMethod::Analytic);
            assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, Kinks::empty()), "{}", data.time());
            for method in METHODS {
                let (system, report) = linearise(&mut data, method);
                let deviation = deviation(&system.a, &closed.a);
                let is_reported = report.kinks.contains(Kinks::DIFFERENCES);
                // The engine's differences are not checked. Both depend on the noise of the solver.
                match method {
                    TransitionMethod::Engine => {}
                    TransitionMethod::Columns => {
                        assert!(deviation < 1e-3 || is_reported, "{}: {deviation:e}", data.time());
                    }
                    _ => assert!(deviation < bound && !is_reported, "{method:?} at {}: {deviation:e}", data.time()),
                }
            }
        }
    }
}
