//! Derivatives of sensors by parameters.

use std::fmt::Write as _;

use mujoco_safe::derivative::{DifferencedTerms, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{compare_all, vary_friction, with_formulas, without_formulas};
use crate::cases::cases;
use crate::transition::analytic::random_models::xml;
use crate::transition::analytic::randomise;

/// Returns a random model with sensors of all kinds on its bodies, joints and actuators.
fn with_sensors(seed: u64) -> String {
    let mut xml = xml(seed);
    let mut sensors = String::new();
    for body in 1.. {
        let Some(at) = xml.find(&format!(r#"<body name="b{body}""#)) else { break };
        let end = at + xml[at..].find('>').unwrap() + 1;
        xml.insert_str(end, &format!(r#"<site name="s{body}" pos="0.02 0.03 -0.01" euler="20 30 40"/>"#));
        for kind in ["accelerometer", "gyro", "velocimeter", "force", "torque", "touch"] {
            write!(sensors, r#"<{kind} site="s{body}"/>"#).unwrap();
        }
        for kind in ["framepos", "framequat", "framelinvel", "framelinacc", "frameangacc"] {
            write!(sensors, r#"<{kind} objtype="xbody" objname="b{body}"/>"#).unwrap();
        }
        // The axes of an inertial frame are not differentiable where moments of inertia are equal.
        write!(sensors, r#"<framepos objtype="body" objname="b{body}"/>"#).unwrap();
        for kind in ["subtreecom", "subtreelinvel", "subtreeangmom"] {
            write!(sensors, r#"<{kind} body="b{body}"/>"#).unwrap();
        }
    }
    for joint in 1.. {
        let name = format!(r#"<joint name="j{joint}""#);
        if !xml.contains(&name) {
            break;
        }
        write!(sensors, r#"<jointpos joint="j{joint}"/>"#).unwrap();
    }
    let (head, tail) = xml.split_once("<actuator>").unwrap();
    let mut named = format!("{head}<actuator>");
    for (number, element) in tail.split('<').enumerate().skip(1) {
        let kind = ["motor ", "position ", "velocity ", "general "].into_iter().find(|kind| element.starts_with(kind));
        match kind {
            Some(kind) => {
                write!(named, r#"<{kind}name="a{number}" {}"#, &element[kind.len()..]).unwrap();
                for kind in ["actuatorpos", "actuatorvel", "actuatorfrc"] {
                    write!(sensors, r#"<{kind} actuator="a{number}"/>"#).unwrap();
                }
            }
            None => write!(named, "<{element}").unwrap(),
        }
    }
    named.replace("</mujoco>", &format!("<sensor>{sensors}</sensor></mujoco>"))
}

#[test]
fn sensors_agree_with_differences() {
    let (mut close, mut noisy, mut failures) = (0, 0, Vec::new());
    for seed in 6000..6000 + cases(6, 15) {
        let text = with_sensors(seed);
        let mut data = Data::new(Model::from_xml_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))).unwrap();
        randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(seed));
        vary_friction(&mut data);
        let model = data.model().clone();
        let (formulas, others) = (with_formulas(&model), without_formulas(&model));
        let start = seed as usize % 7;
        let parameters: Vec<_> =
            formulas.iter().skip(start).step_by(13).chain(others.iter().skip(start).step_by(37)).copied().collect();
        let mut lineariser = Lineariser::new(model, TransitionOptions::default()).unwrap();
        let (_, report) = lineariser.parameter_jacobian(&mut data, &parameters).unwrap();
        if report.fallback.is_some() {
            continue;
        }
        assert!(report.differenced.contains(DifferencedTerms::SENSORS));
        match compare_all(&mut data, &parameters) {
            Ok([more, some]) => (close, noisy) = (close + more, noisy + some),
            Err(failure) => failures.push(format!("model {seed}, {failure}")),
        }
    }
    println!("{close} columns, {noisy} noisy ones");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(close > 50 && 10 * noisy <= close, "{noisy} of {close} columns are noisy");
}
