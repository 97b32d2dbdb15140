//! Each feature of the engine that affects a step, alone: the implicit method against extrapolated
//! differences.

use mujoco_safe::derivative::{TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model, StateSpace};

use super::{assert_near, oracle};

/// Returns a chain of three links, with the feature's additions to the options, the world, the
/// links and the model.
pub(crate) fn chain(option: &str, world: &str, links: &str, rest: &str) -> String {
    format!(
        r#"<mujoco>
             <option timestep="0.003" {option}/>
             <worldbody>
               <geom name="floor" type="plane" size="5 5 0.1" pos="0 0 -0.42" friction="0.4 0.02 0.01"/>
               <site name="anchor" pos="0.3 0.2 0.3"/>
               {world}
               <body name="upper" pos="0 0 0.4">
                 <joint name="a" axis="0 1 0" {links}/>
                 <geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.03"/>
                 <body name="middle" pos="0.3 0 0.1">
                   <joint name="b" axis="1 0 0" {links}/>
                   <geom type="capsule" fromto="0 0 0 0.2 0.1 -0.1" size="0.03"/>
                   <body name="lower" pos="0.2 0.1 -0.1">
                     <joint name="c" axis="0 1 0.3" {links}/>
                     <geom type="capsule" fromto="0 0 0 0 0.1 -0.2" size="0.03"/>
                     <site name="tip" pos="0 0.1 -0.2"/>
                   </body>
                 </body>
               </body>
             </worldbody>
             {rest}
           </mujoco>"#
    )
}

/// Returns a body that may fall on the floor.
pub(super) fn ball(option: &str, joint: &str, geom: &str, rest: &str) -> String {
    format!(
        r#"<mujoco>
             <option timestep="0.002" {option}/>
             <worldbody>
               <geom name="floor" type="plane" size="5 5 0.1" friction="0.7 0.05 0.02"/>
               <body name="ball" pos="0 0 0.098">{joint}<geom {geom}/><site name="mark" pos="0.02 0 0"/></body>
             </worldbody>
             {rest}
           </mujoco>"#
    )
}

/// Returns a simulation in motion, with controls and activations.
pub(crate) fn moving(xml: &str, steps: usize) -> Data {
    let mut data = Data::new(Model::from_xml_str(xml).unwrap_or_else(|error| panic!("{error}: {xml}"))).unwrap();
    data.ctrl_mut().iter_mut().enumerate().for_each(|(i, ctrl)| *ctrl = 0.3 + 0.1 * i as f64);
    data.act_mut().iter_mut().enumerate().for_each(|(i, act)| *act = 0.4 + 0.1 * i as f64);
    for (i, qvel) in data.qvel_mut().iter_mut().enumerate() {
        *qvel = -0.4 * (1.0 + 0.4 * i as f64).sin();
    }
    (0..steps).for_each(|_| data.step().unwrap());
    data
}

fn inverse(data: &mut Data) -> StateSpace {
    let options = TransitionOptions::default().with_method(TransitionMethod::Implicit);
    let mut transition = Lineariser::new(data.model().clone(), options).unwrap();
    let (system, used) = transition.linear_system(data).unwrap();
    assert_eq!((used.method, used.fallback), (TransitionMethod::Implicit, None));
    system
}

#[track_caller]
fn check(what: &str, data: &mut Data) {
    assert_near(what, &inverse(data), &oracle::linear_system(data), 1e-5);
}

const MOTORS: &str = r#"<actuator><motor joint="a" gear="2"/><motor joint="c"/></actuator>"#;
const SENSORS: &str = r#"<sensor>
    <framepos objtype="site" objname="tip"/><framequat objtype="body" objname="lower"/>
    <gyro site="tip"/><velocimeter site="tip"/><accelerometer site="tip"/><force site="tip"/><torque site="tip"/>
    <jointpos joint="a"/><jointvel joint="b"/><subtreelinvel body="upper"/><frameangacc objtype="body" objname="lower"/>
    <actuatorfrc actuator="0"/><actuatorpos actuator="0"/>
  </sensor>"#;

#[test]
fn each_feature_of_a_chain_is_linearised() {
    let tendon = r#"<tendon><fixed name="t" stiffness="3" damping="0.2"><joint joint="a" coef="1"/><joint joint="c" coef="-0.5"/></fixed>
                    <spatial name="s" stiffness="8" damping="0.4" springlength="0.1"><site site="anchor"/><site site="tip"/></spatial></tendon>"#;
    for (what, xml) in [
        ("nothing", chain("", "", "", MOTORS)),
        ("damping", chain("", "", r#"damping="0.4""#, MOTORS)),
        ("damping of some", chain("", "", "", MOTORS).replacen(r#"name="b""#, r#"name="b" damping="2""#, 1)),
        ("springs and armature", chain("", "", r#"stiffness="4" springref="20" armature="0.02""#, MOTORS)),
        ("friction loss", chain("", "", r#"frictionloss="0.3" damping="0.1""#, MOTORS)),
        ("a medium", chain(r#"density="900" viscosity="0.7" wind="1 0 0.3""#, "", "", MOTORS)),
        ("tendons", chain("", "", r#"damping="0.1""#, tendon)),
        ("a sparse Jacobian", chain(r#"jacobian="sparse""#, "", r#"frictionloss="0.2" damping="0.1""#, tendon)),
        (
            "a joint equality",
            chain("", "", "", r#"<equality><joint joint1="a" joint2="c" polycoef="0.1 0.5 0.2 0 0"/></equality>"#),
        ),
        (
            "a connection",
            chain(
                "",
                "",
                r#"damping="0.1""#,
                r#"<equality><connect body1="lower" body2="world" anchor="0 0.1 -0.2"/></equality>"#,
            ),
        ),
        (
            "a weld to a mocap body",
            chain(
                "",
                r#"<body name="hand" mocap="true" pos="0.5 0.2 0.3"/>"#,
                "",
                r#"<equality><weld body1="lower" body2="hand"/></equality>"#,
            ),
        ),
        (
            "no clamping of controls",
            chain("", "", "", MOTORS).replace("<option ", r#"<option><flag clampctrl="disable"/></option><option "#),
        ),
    ] {
        check(what, &mut moving(&xml, 7));
    }
}

#[test]
fn each_kind_of_actuator_is_linearised() {
    for actuator in [
        r#"<position joint="a" kp="20"/>"#,
        r#"<velocity joint="b" kv="3"/>"#,
        r#"<position joint="a" kp="20" forcelimited="true" forcerange="-0.1 0.1"/>"#,
        r#"<motor joint="a" ctrllimited="true" ctrlrange="-1 0.5"/>"#,
        r#"<general joint="a" gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/>"#,
        r#"<general joint="c" dyntype="integrator" gainprm="4" biastype="affine" biasprm="0 -4 -0.3"/>"#,
        r#"<general joint="c" dyntype="integrator" gainprm="4" actlimited="true" actrange="0 0.4"/>"#,
        r#"<motor joint="a"/><general joint="c" dyntype="filter" dynprm="0.05" gainprm="3"/>"#,
        r#"<muscle tendon="s" lengthrange="0.1 1.2"/>"#,
        r#"<motor site="tip" refsite="anchor" gear="1 0 0 0 0.2 0"/>"#,
    ] {
        let rest = format!(
            r#"<tendon><spatial name="s"><site site="anchor"/><site site="tip"/></spatial></tendon><actuator>{actuator}</actuator>"#
        );
        // An engine without this transmission rejects it when loading.
        let xml = chain("", "", r#"damping="0.2""#, &rest);
        if actuator.contains("refsite") && Model::from_xml_str(&xml).is_err() {
            continue;
        }
        check(actuator, &mut moving(&xml, 5));
    }
}

#[test]
fn contacts_with_each_cone_and_dimension_are_linearised() {
    for cone in ["pyramidal", "elliptic"] {
        for dim in [1, 3, 4, 6] {
            for joint in ["<freejoint/>", r#"<joint type="free" damping="0.2" stiffness="1"/>"#] {
                let geom = format!(r#"type="sphere" size="0.1" condim="{dim}""#);
                let xml = ball(&format!(r#"cone="{cone}" impratio="2""#), joint, &geom, "");
                let mut data = moving(&xml, 4);
                assert!(data.nefc() > 0, "{xml}");
                check(&format!("{cone}, {dim}, {joint}"), &mut data);
            }
        }
    }
}

#[test]
fn rotations_of_ball_and_free_joints_are_linearised() {
    for joint in [r#"<joint type="ball" damping="0.3" stiffness="0.2"/>"#, r#"<joint type="free" damping="0.1"/>"#] {
        let xml = ball("", joint, r#"type="ellipsoid" size="0.05 0.03 0.02" pos="0.1 0 0.3""#, "");
        let mut data = moving(&xml, 0);
        let last = data.qvel().len();
        data.qvel_mut()[last - 3..].copy_from_slice(&[9.0, -7.0, 12.0]);
        data.step().unwrap();
        check(joint, &mut data);
    }
}

#[test]
fn forces_on_bodies_and_joints_are_linearised() {
    let mut data = moving(&chain("", "", r#"damping="0.1""#, MOTORS), 3);
    data.qfrc_applied_mut().fill(0.7);
    data.xfrc_applied_mut()[2] = [3.0, -2.0, 1.0, 0.3, 0.2, -0.5];
    check("applied forces", &mut data);
}

#[test]
fn every_converging_solver_is_linearised() {
    for option in [r#"solver="CG" tolerance="0" iterations="500""#, r#"solver="PGS" tolerance="0" iterations="2000""#] {
        let mut data = moving(&ball(option, "<freejoint/>", r#"type="sphere" size="0.1""#, ""), 4);
        check(option, &mut data);
    }
}

#[test]
fn sensors_of_each_stage_are_linearised() {
    let rest = format!("{}{SENSORS}", MOTORS.replace("<motor joint=\"a\"", "<motor name=\"0\" joint=\"a\""));
    check("sensors", &mut moving(&chain("", "", r#"damping="0.1""#, &rest), 6));
    let touch = r#"<sensor><touch site="mark"/><accelerometer site="mark"/><clock/></sensor>"#;
    let xml =
        ball("", "<freejoint/>", r#"type="sphere" size="0.1""#, touch).replace(r#"pos="0.02 0 0""#, r#"size="0.2""#);
    let mut data = moving(&xml, 4);
    assert!(data.nefc() > 0);
    check("sensors of contact", &mut data);
}
