//! Random models: trees of all joints, with contacts, limits, friction loss, equalities, tendons
//! and actuators.

use std::fmt::Write as _;

use mujoco_safe::derivative::Fallback;
use mujoco_safe::{Data, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{analytic, compare, randomise};

use crate::cases::cases;

/// Generator of a model, with the names of its scalar joints and its bodies so far.
struct Generator {
    random: Xoshiro256PlusPlus,
    joints: usize,
    bodies: usize,
}

impl Generator {
    fn one_of<'a>(&mut self, values: &[&'a str]) -> &'a str {
        values[self.random.random_range(0..values.len())]
    }

    fn number(&mut self, low: f64, high: f64) -> f64 {
        self.random.random_range(low..high)
    }

    fn vector(&mut self, size: f64) -> String {
        let [x, y, z] = [0; 3].map(|_| self.number(-size, size));
        format!("{x:.3} {y:.3} {z:.3}")
    }

    fn geom(&mut self) -> String {
        let shape = self.one_of(&[
            r#"type="sphere" size="0.08""#,
            r#"type="capsule" size="0.05 0.1""#,
            r#"type="box" size="0.06 0.08 0.1""#,
        ]);
        let (dim, pos, euler) = (self.one_of(&["1", "3", "4", "6"]), self.vector(0.05), self.vector(90.0));
        format!(r#"<geom {shape} condim="{dim}" pos="{pos}" euler="{euler}"/>"#)
    }

    fn joint(&mut self) -> String {
        let (axis, pos) = (self.vector(1.0), self.vector(0.1));
        let kind = self.one_of(&["hinge", "slide"]);
        let range = if kind == "slide" { "-0.2 0.3" } else { "-30 50" };
        let damping = self.one_of(&["", r#"damping="0.3""#, r#"damping="4""#]);
        let more =
            self.one_of(&["", r#"stiffness="5" springref="0.2""#, r#"frictionloss="0.2""#, r#"armature="0.02""#]);
        let limit = self.one_of(&["false", "true"]);
        self.joints += 1;
        format!(
            r#"<joint name="j{}" type="{kind}" axis="{axis}" pos="{pos}" range="{range}" limited="{limit}" {damping} {more}/>"#,
            self.joints
        )
    }

    fn body(&mut self, depth: usize) -> String {
        let (pos, euler) = (self.vector(0.2), self.vector(60.0));
        self.bodies += 1;
        let mut xml = format!(r#"<body name="b{}" pos="{pos}" euler="{euler}">"#, self.bodies);
        match self.random.random_range(0..if depth == 0 { 6 } else { 5 }) {
            0 => {
                let more = self.one_of(&["", r#"damping="0.2""#, r#"stiffness="2""#, r#"limited="true" range="0 40""#]);
                let pos = self.vector(0.1);
                write!(xml, r#"<joint type="ball" pos="{pos}" {more}/>"#).unwrap();
            }
            // A body without joints.
            1 if depth > 0 => {}
            5 => xml += self.one_of(&["<freejoint/>", r#"<joint type="free" damping="0.2" armature="0.01"/>"#]),
            _ => {
                for _ in 0..self.random.random_range(1..3) {
                    xml += &self.joint();
                }
            }
        }
        xml += &self.geom();
        if depth < 3 {
            for _ in 0..self.random.random_range(0..3) {
                xml += &self.body(depth + 1);
            }
        }
        xml + "</body>"
    }

    fn actuator(&mut self, transmission: &str) -> String {
        let actuator = self.one_of(&[
            r#"<motor TR gear="2"/>"#,
            r#"<position TR kp="5"/>"#,
            r#"<velocity TR kv="0.5"/>"#,
            r#"<motor TR ctrllimited="true" ctrlrange="-0.5 0.5"/>"#,
            r#"<general TR gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4" forcelimited="true" forcerange="-3 3"/>"#,
        ]);
        actuator.replace("TR", transmission)
    }

    fn model(&mut self) -> String {
        let (mut world, mut rest) = (String::new(), String::new());
        for _ in 0..self.random.random_range(1..4) {
            world += &self.body(0);
        }
        let mut stateful = String::new();
        let mut actuators = String::new();
        let mut equalities = String::new();
        if self.joints > 0 {
            let (first, second) =
                (self.random.random_range(1..=self.joints), self.random.random_range(1..=self.joints));
            actuators += &self.actuator(&format!(r#"joint="j{first}""#));
            stateful += self.one_of(&["", r#"<general joint="j1" dyntype="filter" dynprm="0.1" gainprm="3"/>"#]);
            if first != second {
                let limits = self.one_of(&["", r#"limited="true" range="-0.1 0.1""#, r#"frictionloss="0.2""#]);
                write!(rest, r#"<tendon><fixed name="t" stiffness="2" damping="0.1" {limits}><joint joint="j{first}" coef="1"/><joint joint="j{second}" coef="-0.6"/></fixed></tendon>"#).unwrap();
                actuators += &self.actuator(r#"tendon="t""#);
                if self.random.random_bool(0.3) {
                    write!(equalities, r#"<joint joint1="j{first}" joint2="j{second}" polycoef="0.1 0.7 0.2 0 0"/>"#)
                        .unwrap();
                }
            }
        }
        // These constraints have no formula since 3.7.
        if cfg!(not(engine_since = "3.7.0")) && self.bodies > 1 && self.random.random_bool(0.4) {
            let (body, anchor) = (self.random.random_range(2..=self.bodies), self.vector(0.1));
            let equality = match self.one_of(&["connect", "weld"]) {
                "connect" => format!(r#"<connect body1="b1" body2="b{body}" anchor="{anchor}"/>"#),
                _ => format!(r#"<weld body1="b{body}" body2="b1" torquescale="0.5"/>"#),
            };
            equalities += &equality;
        }
        let option = self.one_of(&[
            "",
            r#"cone="elliptic""#,
            r#"cone="elliptic" impratio="2" jacobian="sparse""#,
            r#"jacobian="sparse""#,
        ]);
        let solimp = self.one_of(&["0.9 0.95 0.001", "0.8 0.97 0.05 0.4 3", "0.7 0.9 0.1 0.5 2"]);
        let timestep = self.number(0.001, 0.005);
        format!(
            r#"<mujoco><option timestep="{timestep:.4}" {option}/>
                 <default><geom density="500" friction="0.8 0.02 0.01" solimp="{solimp}"/></default>
                 <worldbody><geom type="plane" size="5 5 1" pos="0 0 -0.2" euler="2 3 0"/>{world}</worldbody>
                 {rest}<equality>{equalities}</equality><actuator>{actuators}{stateful}</actuator></mujoco>"#
        )
    }
}

/// Returns a random model.
pub(crate) fn xml(seed: u64) -> String {
    Generator { random: Xoshiro256PlusPlus::seed_from_u64(seed), joints: 0, bodies: 0 }.model()
}

/// Compares `states` states of each of `models` random models.
fn compare_models(seed: u64, models: usize, states: usize) {
    let (mut compared, mut noisy, mut without_formula, mut failures) = (0, 0, 0, Vec::new());
    for number in 0..models {
        let seed = seed + number as u64;
        let mut generator = Generator { random: Xoshiro256PlusPlus::seed_from_u64(seed), joints: 0, bodies: 0 };
        let xml = generator.model();
        let model = Model::from_xml_str(&xml).unwrap_or_else(|error| panic!("{error}: {xml}"));
        let mut data = Data::new(model).unwrap();
        println!("model {seed}: {compared} states compared, {} failures", failures.len());
        for state in 0..states {
            randomise(&mut data, &mut generator.random);
            // Some steps lead to states with smaller velocities, most of them in contact.
            if state % 2 == 1 && (0..20 * state).any(|_| data.step().is_err()) {
                continue;
            }
            match analytic(&mut data).1.fallback {
                None => compared += 1,
                // The differences of a collision function have found another contact.
                Some(Fallback::Constraint) => {
                    without_formula += 1;
                    continue;
                }
                Some(reason) => {
                    assert_eq!(reason, Fallback::NotConverged, "model {seed}, state {state}");
                    continue;
                }
            }
            let what = format!("model {seed}, state {state}");
            match compare(&mut data) {
                Ok(agreement) if agreement.noisy.is_empty() => {}
                Ok(agreement) => {
                    noisy += 1;
                    println!("{what}: {}", agreement.noisy.join("; "));
                }
                Err(failure) => {
                    println!("{what}: {failure}");
                    failures.push(format!("{what}: {failure}"));
                }
            }
        }
    }
    println!(
        "{compared} states of {models} models, {noisy} with noisy columns, {without_formula} others without a formula"
    );
    assert!(failures.is_empty(), "{} of {compared} states:\n{}", failures.len(), failures.join("\n"));
    assert!(100 * without_formula <= compared, "{without_formula} of {compared} states have no formula");
    assert!(compared > models * states / 2, "{compared} states of {models} models converged");
}

#[test]
fn random_models_agree_with_differences() {
    compare_models(1000, cases(4, 12), 4);
}

#[test]
#[ignore = "takes minutes in a release build"]
fn many_states_of_many_random_models_agree_with_differences() {
    compare_models(5000, 510, 20);
}
