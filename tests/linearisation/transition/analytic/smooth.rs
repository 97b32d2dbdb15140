//! Terms without constraints, and fallbacks.

use mujoco_safe::derivative::{Fallback, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, StateSpace, sample};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{analytic, check, model, randomise, without_passive_forces};
use crate::transition::features::{chain, moving};

/// Free, ball, slide and hinge joints in one tree, two of them in one body, and a second tree.
const JOINTS: &str = r#"<mujoco>
    <option timestep="0.004" gravity="1 -2 -9"/>
    <worldbody>
      <body pos="0 0 3">
        <freejoint/><geom type="capsule" size="0.1" fromto="-0.15 0 0 0.2 0.05 0.03"/>
        <body pos="0.25 0 0.05">
          <joint type="ball" pos="-0.03 0.02 0.01"/><geom type="capsule" size="0.05" fromto="0 0 0 0.3 0.02 -0.05"/>
          <body pos="0.32 0 -0.05">
            <joint type="slide" axis="1 0.2 -0.1"/><joint name="h" axis="0 1 0.3" pos="0.01 0 0.02" armature="0.03"/>
            <geom type="box" size="0.08 0.05 0.03" pos="0.05 0 0.01"/>
            <body pos="0 0.1 0"><geom size="0.05"/></body>
          </body>
          <body pos="0.1 0.1 0"><joint name="i" axis="0.2 0 1"/><geom size="0.04" pos="0.1 0 0"/></body>
        </body>
      </body>
      <body pos="2 0 0"><body pos="0 0 0.3"><joint type="ball"/><geom size="0.1" pos="0.2 0.1 0"/></body></body>
    </worldbody>
    REST
  </mujoco>"#;

pub(crate) fn joints(rest: &str) -> String {
    JOINTS
        .replace("REST", rest)
        .replace("<worldbody>", r#"<default><geom contype="0" conaffinity="0"/></default><worldbody>"#)
}

#[test]
fn inertia_velocity_and_gravity_terms_agree_with_differences_for_every_joint() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut data = model(&joints(""));
    for state in 0..20 {
        randomise(&mut data, &mut random);
        check(&format!("state {state}"), &mut data);
    }
    let mut weightless =
        model(&joints("").replace("<worldbody>", r#"<option><flag gravity="disable"/></option><worldbody>"#));
    randomise(&mut weightless, &mut random);
    check("without gravity", &mut weightless);
}

#[test]
fn implicit_damping_of_the_integrator_agrees_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
    for damping in [r#"damping="0.3""#, r#"damping="20" stiffness="2""#] {
        let joint = format!("<default><joint {damping}/></default><worldbody>");
        let mut data = model(&joints("").replace("<worldbody>", &joint));
        for state in 0..10 {
            randomise(&mut data, &mut random);
            check(&format!("{damping}, state {state}"), &mut data);
        }
    }
    // A free joint with damping and a spring.
    let xml = joints("").replace("<freejoint/>", r#"<joint type="free" damping="0.5" stiffness="3"/>"#);
    let mut data = model(&xml);
    randomise(&mut data, &mut random);
    check("a free joint", &mut data);
}

#[test]
fn passive_forces_agree_with_differences() {
    let tendon = r#"<tendon><fixed name="t" stiffness="3" damping="0.2"><joint joint="a" coef="1"/><joint joint="c" coef="-0.5"/></fixed></tendon>"#;
    for (what, option, links) in [
        ("springs", "", r#"stiffness="4" springref="20""#),
        ("a fixed tendon", "", ""),
        ("a sparse tendon", r#"jacobian="sparse""#, r#"damping="0.1""#),
    ] {
        check(what, &mut moving(&chain(option, "", links, tendon), 7));
    }
    let without = chain("", "", r#"stiffness="4" damping="0.3""#, tendon)
        .replace("<option ", &format!("<option>{}</option><option ", without_passive_forces()));
    check("no passive forces", &mut moving(&without, 7));
}

#[test]
fn forces_of_a_medium_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(6);
    for option in [
        r#"viscosity="0.7""#,
        r#"density="900""#,
        r#"density="900" viscosity="0.7" wind="1 -0.5 0.3""#,
        r#"density="1.2" viscosity="0.00002" wind="10 0 0""#,
    ] {
        let xml = joints("").replace("<worldbody>", &format!("<option {option}/><worldbody>"));
        let mut data = model(&xml);
        for state in 0..5 {
            randomise(&mut data, &mut random);
            check(&format!("{option}, state {state}"), &mut data);
        }
        let xml = xml.replace("<worldbody>", &format!("<option>{}</option><worldbody>", without_passive_forces()));
        let mut data = model(&xml);
        randomise(&mut data, &mut random);
        check(&format!("{option}, without passive forces"), &mut data);
    }
}

#[test]
fn affine_actuators_agree_with_differences() {
    let tendon =
        r#"<tendon><fixed name="t"><joint joint="a" coef="1"/><joint joint="c" coef="-0.5"/></fixed></tendon>"#;
    for actuator in [
        r#"<motor joint="a" gear="2"/><motor joint="c"/>"#,
        r#"<position joint="a" kp="20"/><velocity joint="b" kv="3"/>"#,
        r#"<position tendon="t" kp="20" gear="3"/>"#,
        r#"<position joint="a" kp="20" forcelimited="true" forcerange="-0.1 0.1"/>"#,
        r#"<motor joint="a" ctrllimited="true" ctrlrange="-1 0.1"/><motor joint="b" ctrllimited="true" ctrlrange="-1 0.5"/>"#,
        r#"<general joint="a" gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/>"#,
        r#"<general joint="a" gaintype="affine" gainprm="2 0.5 0.3" ctrllimited="true" ctrlrange="-1 0.1"/>"#,
        r#"<general joint="c" dyntype="integrator" gainprm="4" biastype="affine" biasprm="0 -4 -0.3"/>"#,
        r#"<general joint="c" dyntype="integrator" gainprm="4" actlimited="true" actrange="0 0.4"/>"#,
        r#"<motor joint="a"/><general joint="c" dyntype="filter" dynprm="0.05" gainprm="3"/>"#,
    ] {
        let rest = format!("{tendon}<actuator>{actuator}</actuator>");
        check(actuator, &mut moving(&chain("", "", r#"damping="0.2""#, &rest), 5));
    }
    for flag in [r#"clampctrl="disable""#, r#"actuation="disable""#] {
        let limited = r#"<actuator><motor joint="a" ctrllimited="true" ctrlrange="-1 0.1"/></actuator>"#;
        let xml = chain("", "", "", limited).replace("<option ", &format!("<option><flag {flag}/></option><option "));
        check(flag, &mut moving(&xml, 5));
    }
    // Motors on a free and a ball joint have constant moment arms.
    let xml = joints(
        r#"<actuator><motor joint="free" gear="1 2 3 0.1 0.2 0.3"/><motor joint="ball" gear="1 2 3"/></actuator>"#,
    )
    .replace("<freejoint/>", r#"<freejoint name="free"/>"#)
    .replacen(r#"type="ball""#, r#"type="ball" name="ball""#, 1);
    let mut data = model(&xml);
    randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(3));
    check("motors on a free and a ball joint", &mut data);
}

#[test]
fn actuators_on_sites_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    for actuator in [
        r#"<motor site="s" gear="1 2 3 0.1 0.2 0.3"/><motor site="t" gear="0 0 1 0 0 0.2"/>"#,
        r#"<velocity site="s" kv="0.7" gear="1 2 3 0.1 0.2 0.3"/>"#,
        r#"<general site="s" gear="0 2 0 0.1 0 0" gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/>"#,
        r#"<motor site="t" gear="0 2 0" forcelimited="true" forcerange="-0.1 0.1"/>"#,
        r#"<general site="t" gear="0 2 0 0.1" dyntype="filter" dynprm="0.1" gainprm="3"/>"#,
    ] {
        // A site at the end of a chain with all kinds of joints, and another on a body with a ball
        // joint.
        let xml = joints(&format!("<actuator>{actuator}</actuator>"))
            .replace(r#"<geom size="0.05"/>"#, r#"<geom size="0.05"/><site name="s" pos="0.1 0 0" euler="10 50 20"/>"#)
            .replace(r#"<geom size="0.1""#, r#"<site name="t" pos="0 0.1 0" euler="30 0 20"/><geom size="0.1""#);
        let mut data = model(&xml);
        for state in 0..2 {
            randomise(&mut data, &mut random);
            check(&format!("{actuator}, state {state}"), &mut data);
        }
    }
}

#[test]
fn muscles_agree_with_differences_on_each_piece_of_their_curves() {
    let tendon =
        r#"<tendon><fixed name="t"><joint joint="a" coef="1"/><joint joint="c" coef="-0.5"/></fixed></tendon>"#;
    // The range of lengths moves the present length to other pieces of the curves, and `vmax` the
    // velocity.
    for range in ["-0.2 0.3", "-0.9 0.1", "-0.1 0.9", "-0.5 0.12", "-2 -0.5", "0.5 2"] {
        for more in [r#"vmax="1.5""#, r#"vmax="0.2""#, r#"vmax="0.05" fvmax="3""#, r#"force="50" vmax="4""#] {
            let muscle = format!(r#"<muscle tendon="t" lengthrange="{range}" {more}/>"#);
            let joint = format!(r#"<muscle joint="b" lengthrange="{range}" {more} timeconst="0.02 0.05"/>"#);
            let rest = format!("{tendon}<actuator>{muscle}{joint}</actuator>");
            let mut data = moving(&chain("", "", r#"damping="0.2""#, &rest), 5);
            for (ctrl, act) in [([0.3, 0.8], [0.5, 0.2]), ([1.5, -0.4], [0.9, 0.1]), ([0.6, 0.6], [-0.1, 1.2])] {
                data.ctrl_mut().copy_from_slice(&ctrl);
                data.act_mut().copy_from_slice(&act);
                check(&format!("{range}, {more}, {ctrl:?}"), &mut data);
            }
        }
    }
}

#[test]
fn forces_on_bodies_agree_with_differences() {
    let mut data = model(&joints(""));
    randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(4));
    for body in 1..data.model().nbody() {
        data.xfrc_applied_mut()[body] = [3.0, -2.0, body as f64, 0.3, 0.2, -0.5];
    }
    data.qfrc_applied_mut().fill(0.4);
    check("forces on bodies and joints", &mut data);
}

#[test]
fn the_cartpole_agrees_with_differences_in_random_states() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut data = Data::new(sample::cartpole()).unwrap();
    for state in 0..20 {
        randomise(&mut data, &mut random);
        check(&format!("state {state}"), &mut data);
    }
}

#[test]
fn terms_without_a_formula_fall_back_with_the_reason() {
    // The tendon winds around the cylinder.
    let wound = r#"<tendon><spatial name="s" stiffness="8">
        <site site="anchor"/><geom geom="drum"/><site site="tip"/>
      </spatial></tendon>"#;
    let drum = r#"<geom name="drum" type="cylinder" size="0.1 0.5" pos="0.4 0.2 0.2" euler="90 0 0" contype="0" conaffinity="0"/>"#;
    let ellipsoid = chain(r#"density="900""#, "", "", "")
        .replace("<geom type=\"capsule\"", "<geom fluidshape=\"ellipsoid\" type=\"capsule\"");
    for (fallback, xml) in [
        (Fallback::Fluid, ellipsoid),
        (Fallback::SpatialTendon, chain("", drum, "", wound)),
        (Fallback::Actuator, chain("", "", "", r#"<actuator><adhesion body="lower" ctrlrange="0 1"/></actuator>"#)),
        (
            Fallback::Actuator,
            joints(r#"<actuator><position joint="h" kp="1"/><position joint="ball" kp="1"/></actuator>"#).replacen(
                r#"type="ball""#,
                r#"type="ball" name="ball""#,
                1,
            ),
        ),
    ] {
        let mut data = moving(&xml, 3);
        let (system, report) = analytic(&mut data);
        assert_eq!((report.method, report.fallback), (TransitionMethod::Implicit, Some(fallback)));
        let options = TransitionOptions::default().with_method(TransitionMethod::Implicit);
        let mut implicit = Lineariser::new(data.model().clone(), options).unwrap();
        assert_eq!(system, implicit.linear_system(&mut data).unwrap().0);
    }
}

#[test]
fn a_state_without_a_closed_form_has_all_outputs_of_the_implicit_method() {
    let sensors = r#"<sensor><ballangvel joint="ball"/><clock/></sensor>"#;
    let ball = r#"<joint name="ball" type="ball" limited="true" range="0 1" margin="2" damping="0.1"/>"#;
    let singular = model(&format!(
        r#"<mujoco><compiler angle="radian"/><worldbody><body>{ball}<geom size="0.1" pos="0.1 0 0"/></body></worldbody>
             <actuator><motor joint="ball" gear="1 2 3"/></actuator>{sensors}</mujoco>"#
    ));
    let touching = model(&format!(
        r#"<mujoco><worldbody>
             <geom type="sphere" size="0.1"/>
             <body pos="0 0 0.19"><joint name="ball" type="ball"/><geom type="cylinder" size="0.1 0.1"/></body>
           </worldbody><actuator><motor joint="ball" gear="1 2 3"/></actuator>{sensors}</mujoco>"#
    ));
    for (fallback, mut data) in [(Fallback::Singular, singular), (Fallback::Constraint, touching)] {
        data.qvel_mut().copy_from_slice(&[0.1, 0.2, -0.3]);
        let linearise = |method, data: &mut Data| {
            let options = TransitionOptions::default().with_method(method);
            // Outputs that a method omits stay as they are.
            let mut system = StateSpace::zeros(data.model());
            for matrix in [&mut system.a, &mut system.b, &mut system.c, &mut system.d] {
                matrix.as_mut_slice().fill(7.0);
            }
            let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
            let report = lineariser.linear_system_into(data, &mut system).unwrap();
            (system, report)
        };
        let (system, report) = linearise(TransitionMethod::Analytic, &mut data);
        assert_eq!((report.method, report.fallback), (TransitionMethod::Implicit, Some(fallback)));
        assert_eq!(system, linearise(TransitionMethod::Implicit, &mut data).0);
        assert!((0..3).all(|axis| (system.c[(axis, 3 + axis)] - 1.0).abs() < 1e-9), "{fallback:?}");
    }
}
