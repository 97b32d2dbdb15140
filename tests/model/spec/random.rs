//! Random changes of specs: no panic, and the text reads as the same spec.

use mujoco_safe::kind::{Body, Joint, Site};
use mujoco_safe::spec::{ActuatorElement, Mount, Spec};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use super::elements;

const TAGS: [&str; 14] = [
    "body", "joint", "geom", "site", "camera", "default", "mesh", "motor", "fixed", "framepos", "weld", "exclude",
    "key", "inertial",
];
const SECTIONS: [&str; 8] = ["default", "asset", "actuator", "tendon", "sensor", "equality", "contact", "keyframe"];
const ATTRIBUTES: [&str; 16] = [
    "pos",
    "quat",
    "euler",
    "fromto",
    "range",
    "class",
    "childclass",
    "joint",
    "body1",
    "objname",
    "objtype",
    "type",
    "size",
    "file",
    "mesh",
    "axisangle",
];
const VALUES: [&str; 12] =
    ["a", "b", "world", "main", "", "1 2 3", "1 0 0 0", "0 0 0 1 1 1", "nan", "body", "hinge", "1 2 x"];

/// Choices of one operation.
type Choices = (u8, u8, u8, u8);

fn pick<T: Copy>(items: &[T], choice: u8) -> Option<T> {
    items.get(usize::from(choice) % items.len().max(1)).copied()
}

fn apply(spec: &mut Spec, other: &Spec, (operation, a, b, c): Choices) {
    let all = elements(spec);
    let Some(id) = pick(&all, a) else { return };
    let (Some(value), Some(attribute)) = (pick(&VALUES, b), pick(&ATTRIBUTES, c)) else { return };
    match operation % 10 {
        0 | 1 => drop(spec.edit(id).add(pick(&TAGS, b).unwrap()).map(|element| element.id())),
        2 => drop(
            spec.section_mut(pick(&SECTIONS, b).unwrap())
                .unwrap()
                .add(pick(&TAGS, c).unwrap())
                .map(|element| element.id()),
        ),
        3 => drop(spec.edit(id).set_name(value)),
        4 | 5 => drop(spec.edit(id).set(attribute, value).map(|element| element.id())),
        6 => drop(spec.remove(id)),
        7 => drop(spec.remove_with_references(id)),
        8 => {
            let body = pick(&spec.ids::<Body>(), a).unwrap();
            let site = pick(&spec.ids::<Site>(), b).filter(|_| c % 2 == 0);
            let mount = site.map_or_else(|| Mount::body(body), Mount::site);
            let mount =
                if a % 2 == 0 { mount } else { mount.with_pos([1.0, 0.0, 0.0]).with_quat([1.0, 1.0, 0.0, 0.0]) };
            drop(spec.attach(other, mount, value));
        }
        _ => {
            if let Some(joint) = pick(&spec.ids::<Joint>(), a) {
                spec.add_actuator(ActuatorElement::Motor).set_joint(joint);
            }
        }
    }
}

#[test]
fn random_changes_do_not_panic_and_survive_as_text() {
    let choices = proptest::collection::vec(any::<Choices>(), 0..60);
    let config = ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let result = runner.run(&(choices.clone(), choices), |(first, second)| {
        let mut other = Spec::new("other");
        for choice in first {
            apply(&mut other, &Spec::new("empty"), choice);
        }
        let mut spec = Spec::new("spec");
        for choice in second {
            // Attachment can double the size.
            if elements(&spec).len() < 2000 {
                apply(&mut spec, &other, choice);
            }
        }
        let text = spec.to_xml();
        prop_assert_eq!(Spec::from_xml_str(&text).unwrap().to_xml(), text);
        Ok(())
    });
    result.unwrap();
}
