//! Models with features that change what single parts read, or that the engine computes in whole
//! stages only: the parts equal forward dynamics in every order that they accept.

use mujoco_safe::data::SensorUpdate;
use mujoco_safe::{Data, Error, Model, Stage, StateSpec};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::order::{IN_ORDER, assert_within};

/// Number of parts of the position stage, and of both first stages, at the start of `IN_ORDER`.
const POSITION_PARTS: usize = 10;
const VELOCITY_PARTS: usize = 16;

/// Parts that no single call computes with the integrator `discrete`.
const NOT_DISCRETE: [&str; 8] = [
    "collision",
    "make_constraint",
    "project_constraint",
    "passive",
    "reference_constraint",
    "compute_qfrc_bias",
    "fwd_acceleration",
    "fwd_constraint",
];

/// Elastic sides of a cloth.
const SOFT: &str =
    r#"<edge equality="false" damping="1"/><elasticity young="3e3" poisson=".1" thickness=".02" elastic2d="both"/>"#;

struct Subject {
    name: &'static str,
    text: String,
    /// Parts that are not supported.
    rejected: &'static [&'static str],
}

/// Returns a model with an arm of two links above a floor.
fn arm(option: &str, joint: &str, geom: &str, sections: &str) -> String {
    format!(
        r#"<mujoco>
             <option>{option}</option>
             <worldbody>
               <geom type="plane" size="5 5 .1"/><site name="wall" pos="0 .2 1"/>
               <body name="upper" pos="0 0 .3" {gravcomp}>
                 <joint name="a" axis="0 1 0" damping=".1" {joint}/><joint name="b" axis="0 0 1"/>
                 <geom name="stick" type="capsule" size=".05" fromto="0 0 0 .5 0 0"/>
                 <body name="lower" pos=".5 0 0">
                   <joint name="c" axis="0 1 0" stiffness="2"/>
                   <geom name="tip" type="capsule" size=".05" fromto="0 0 0 .5 0 0" {geom}/><site name="hand" pos=".5 0 0"/>
                 </body>
               </body>
               <body name="ball" pos="1.1 0 .14"><freejoint/><geom name="ball" size=".1" {geom}/></body>
             </worldbody>
             {sections}
           </mujoco>"#,
        gravcomp = if joint.contains("gravcomp") { r#"gravcomp="0.7""# } else { "" },
    )
}

fn cloth(dim: usize, inside: &str) -> String {
    let count = ["4 1 1", "3 3 1", "3 3 3"][dim - 1];
    format!(
        r#"<mujoco>
             <worldbody>
               <geom type="plane" size="5 5 .1"/>
               <flexcomp name="f" type="grid" dim="{dim}" count="{count}" spacing=".1 .1 .1" pos="0 0 {height}" radius=".02" mass="1">
                 {inside}<contact selfcollide="none"/>
               </flexcomp>
             </worldbody>
           </mujoco>"#,
        height = if dim == 3 { "0.15" } else { "0.04" },
    )
}

fn subjects() -> Vec<Subject> {
    let tendons = |inside: &str| {
        format!(
            r#"<tendon>
                 <spatial name="s" {inside}><site site="wall"/><site site="hand"/></spatial>
                 <fixed name="f" {inside} stiffness="3" damping="1"><joint joint="a" coef="1"/><joint joint="c" coef="-1"/></fixed>
               </tendon>"#
        )
    };
    let motors = r#"<actuator><motor joint="a" gear="2"/><position joint="c" kp="5"/><motor tendon="s"/></actuator>
        <sensor><actuatorvel actuator="m"/></sensor>"#
        .replacen("<motor", r#"<motor name="m""#, 1);
    let plain = tendons("") + &motors;
    let equalities = r#"<equality><connect body1="lower" body2="ball" anchor=".6 0 0"/><weld body1="ball" body2="upper" solref=".1 1"/>
        <joint joint1="a" joint2="c" polycoef="0 1 .5 0 0"/><tendon tendon1="s" tendon2="f"/></equality>"#;
    let mut all = Vec::new();
    let mut add = |name, text, rejected| all.push(Subject { name, text, rejected });
    add("plain", arm("", "", "", &plain), &[][..]);
    add("equalities", arm("", "", "", &format!("{plain}{equalities}")), &[]);
    let adhesion =
        r#"<actuator><adhesion body="lower" ctrlrange="0 1" gain="5"/></actuator><size njmax="500" nconmax="100"/>"#;
    add("adhesion actuator", arm("", "", "", adhesion), &[]);
    if cfg!(engine_since = "3.5.0") {
        add("armature of tendons", arm("", "", "", &(tendons(r#"armature="3""#) + &motors)), &["compute_qfrc_bias"]);
        add("gravity by actuators", arm("", r#"actuatorgravcomp="true""#, "", &plain), &[]);
        add("without actuation", arm(r#"<flag actuation="disable"/>"#, "", "", &plain), &[]);
        add("energies", arm("", "", "", &format!("{plain}<sensor><e_kinetic/><e_potential/></sensor>")), &[]);
        add("cable", cloth(1, r#"<edge equality="true"/>"#), &["passive"]);
        add("cloth", cloth(2, SOFT), &["passive"]);
        add(
            "solid",
            cloth(3, r#"<edge equality="false" damping="1"/><elasticity young="1e4" poisson=".1"/>"#),
            &["passive"],
        );
    }
    if cfg!(engine_since = "3.17.0") {
        let armature = motors.replace(r#"tendon="s""#, r#"tendon="s" armature="3" damping="1""#);
        add("armature of an actuator", arm("", "", "", &(tendons("") + &armature)), &["compute_qfrc_bias"]);
        let damped = motors.replace(r#"joint="a""#, r#"joint="a" armature="3" damping="1""#);
        add("armature on a joint", arm("", "", "", &(tendons("") + &damped)), &[]);
        add("adhesion of geoms", arm("", "", r#"adhesion="5" margin=".05" gap=".03""#, &plain), &[]);
        let pair = r#"<contact><pair geom1="ball" geom2="tip" adhesion="5" margin=".1"/></contact>"#;
        add("adhesion of a pair", arm("", "", "", &format!("{plain}{pair}")), &[]);
        add("moving surfaces", arm("", "", r#"surfacevel="1 0 0 0 0 2""#, &plain), &[]);
        let discrete = |text: String| text.replacen("<option>", r#"<option integrator="discrete" solver="Newton">"#, 1);
        add("discrete", discrete(arm("", "", "", &format!("{plain}{equalities}"))), &NOT_DISCRETE);
        add(
            "discrete cloth",
            {
                let text = cloth(2, &SOFT.replace(r#" damping="1""#, ""));
                text.replacen("<mujoco>", r#"<mujoco><option integrator="discrete" solver="CG"/>"#, 1)
            },
            &NOT_DISCRETE,
        );
    }
    all
}

/// Moves a simulation: random velocities and controls, and 60 steps.
fn random_state(start: &Data, random: &mut Xoshiro256PlusPlus) -> Data {
    let mut data = start.clone();
    data.qvel_mut().iter_mut().for_each(|value| *value = random.random_range(-0.5..0.5));
    data.ctrl_mut().iter_mut().for_each(|value| *value = random.random_range(0.0..1.0));
    data.step_n(60).unwrap();
    data
}

/// Computes all parts behind `IN_ORDER[..done]` in a random order. Replaces a part that is not
/// supported by its stage. Returns the order.
fn compute_in_random_order(
    what: &str,
    data: &mut Data,
    done: usize,
    random: &mut Xoshiro256PlusPlus,
) -> Vec<&'static str> {
    let mut left: Vec<usize> = (done..IN_ORDER.len()).collect();
    let mut order = Vec::new();
    let (mut rejected, mut in_order) = (0, false);
    for _ in 0..20_000 {
        let is_complete = left.is_empty() && data.stage() == Stage::Acceleration;
        if is_complete {
            return order;
        }
        // A part has made the results of an earlier one invalid: the documented order remains.
        if !in_order && (rejected > 300 || left.is_empty()) {
            in_order = true;
            left = (done..IN_ORDER.len()).collect();
        }
        assert!(!left.is_empty(), "{what}: {order:?} leaves {:?}", data.stage());
        let index = if in_order { left[0] } else { left[random.random_range(0..left.len())] };
        let (name, part) = IN_ORDER[index];
        let (computed, called) = match (part(data), index) {
            (Err(Error::Unsupported(_)), ..POSITION_PARTS) => {
                (data.fwd_position(), ("fwd_position", 0..POSITION_PARTS))
            }
            (Err(Error::Unsupported(_)), POSITION_PARTS..VELOCITY_PARTS) => {
                (data.fwd_velocity(), ("fwd_velocity", POSITION_PARTS..VELOCITY_PARTS))
            }
            (Err(Error::Unsupported(_)), _) => {
                let result = data.forward_skip(Stage::Velocity, SensorUpdate::Skip);
                (result, ("forward_skip", VELOCITY_PARTS..IN_ORDER.len()))
            }
            (result, _) => (result, (name, index..index + 1)),
        };
        match computed {
            Ok(()) => {
                let (name, parts) = called;
                // A stage makes the results of later parts invalid.
                if parts.len() > 1 {
                    left.retain(|&index| index < parts.start);
                    left.extend(parts.end..IN_ORDER.len());
                } else {
                    left.retain(|&other| other != index);
                }
                order.push(name);
                rejected = 0;
            }
            Err(Error::NotComputed { .. }) => rejected += 1,
            Err(error) => panic!("{what}: {name}: {error}"),
        }
    }
    panic!("{what}: after {order:?}, {:?} remain", left.iter().map(|&index| IN_ORDER[index].0).collect::<Vec<_>>());
}

/// Runs 20 orders of each model, or as many as `ROUNDS` says.
#[test]
fn every_accepted_order_equals_forward_dynamics() {
    let rounds = std::env::var("ROUNDS").map_or(20, |text| text.parse().expect("ROUNDS is a number"));
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    for Subject { name, text, rejected } in subjects() {
        let start = Data::new(Model::from_xml_str(&text).unwrap_or_else(|error| panic!("{name}: {error}"))).unwrap();
        let mut met_constraints = false;
        for round in 0..rounds {
            let mut parts = random_state(&start, &mut random);
            let mut whole = random_state(&start, &mut random);
            parts.forward().unwrap();
            let only_velocities = round % 2 == 1;
            if only_velocities {
                parts.qvel_mut().copy_from_slice(whole.qvel());
            } else {
                parts.set_state(StateSpec::INTEGRATION, &whole.state(StateSpec::INTEGRATION)).unwrap();
            }
            whole.set_state(StateSpec::INTEGRATION, &parts.state(StateSpec::INTEGRATION)).unwrap();
            whole.forward().unwrap();
            met_constraints |= whole.nefc() > 0;
            let done = if !only_velocities {
                parts.kinematics().unwrap();
                1
            } else if rejected.is_empty() {
                parts.compute_ten_velocity().unwrap();
                parts.compute_actuator_velocity().unwrap();
                parts.com_vel().unwrap();
                POSITION_PARTS + 3
            } else {
                parts.fwd_velocity().unwrap();
                VELOCITY_PARTS
            };
            let what = format!("{name}, {round}");
            let order = compute_in_random_order(&what, &mut parts, done, &mut random);
            parts.sensor_pos().unwrap();
            parts.sensor_vel().unwrap();
            parts.sensor_acc().unwrap();
            // 2.2.2 normalises quaternions in each computation, which changes their last bits.
            assert_within(&format!("{what}, {order:?}"), &parts, &whole, 1e-9);
        }
        assert!(met_constraints, "{name} must have constraints");
    }
}

#[test]
fn parts_that_the_engine_computes_in_stages_only_are_not_supported() {
    for Subject { name, text, rejected } in subjects() {
        let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
        data.forward().unwrap();
        let mut found = Vec::new();
        for (part, compute) in IN_ORDER {
            match compute(&mut data.clone()) {
                Ok(()) => {}
                Err(Error::Unsupported(text)) => {
                    assert!(text.starts_with(part) && text.contains("fwd_velocity"), "{text}");
                    found.push(part);
                }
                Err(error) => panic!("{name}: {part}: {error}"),
            }
        }
        assert_eq!(found, rejected, "{name}");
        data.fwd_position().unwrap();
        data.fwd_velocity().unwrap();
        data.step2().unwrap();
    }
}
