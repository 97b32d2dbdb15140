//! Random edits of random models. Each element has a number in the model (`user`, or `solref` of an
//! equality constraint) by which the test finds it again, so elements need no names.

#![allow(clippy::format_push_string, reason = "texts in the order of their parts")]

use std::collections::HashMap;

use mujoco_safe::enums::JointType;
use mujoco_safe::kind::{Actuator, Body, Equality, Joint, Kind, Sensor};
use mujoco_safe::model::Adoption;
use mujoco_safe::spec::{ActuatorElement, ElementId, Mount, Spec};
use mujoco_safe::{Data, Model, StateSpec};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::cases::cases;
use super::super::random_text::RandomText;
use super::DELAY;

type Rng = Xoshiro256PlusPlus;
/// Kind of an element, the bits of its number, and the number of the copy that a `replicate` makes.
type Key = (Kind, u64, usize);

/// State of an element.
struct Element {
    /// Index in the model.
    index: usize,
    name: Option<String>,
    /// Type of a joint or a sensor.
    form: i32,
    values: HashMap<&'static str, Vec<f64>>,
}

/// Returns the state of all elements, read by the addresses in the model.
fn elements(data: &Data) -> HashMap<Key, Element> {
    let model = data.model();
    let mut found = HashMap::new();
    let mut copies: HashMap<(Kind, u64), usize> = HashMap::new();
    let mut put = |kind, index, number: f64, name: Option<&str>, form, values: &[(&'static str, &[f64])]| {
        let values = values.iter().map(|(vector, values)| (*vector, values.to_vec())).collect();
        let copy = copies.entry((kind, number.to_bits())).or_default();
        found.insert((kind, number.to_bits(), *copy), Element { index, name: name.map(str::to_owned), form, values });
        *copy += 1;
    };
    for body in 0..model.nbody() {
        let mut values = vec![("xfrc", &data.xfrc_applied()[body][..])];
        if let Ok(mocap) = usize::try_from(model.body_mocapid()[body]) {
            values.push(("pos", &data.mocap_pos()[mocap]));
            values.push(("quat", &data.mocap_quat()[mocap]));
        }
        put(Kind::Body, body, model.body_user().row(body)[0], model.name(model.id::<Body>(body).unwrap()), 0, &values);
    }
    for joint in 0..model.njnt() {
        let [positions, speeds] = [[7, 6], [4, 3], [1, 1], [1, 1]][model.jnt_type()[joint] as usize];
        let (position, speed) = (model.jnt_qposadr()[joint] as usize, model.jnt_dofadr()[joint] as usize);
        let values = [
            ("qpos", &data.qpos()[position..][..positions]),
            ("qvel", &data.qvel()[speed..][..speeds]),
            ("warmstart", &data.qacc_warmstart()[speed..][..speeds]),
            ("qfrc", &data.qfrc_applied()[speed..][..speeds]),
        ];
        let name = model.name(model.id::<Joint>(joint).unwrap());
        put(Kind::Joint, joint, model.jnt_user().row(joint)[0], name, model.jnt_type()[joint], &values);
    }
    let history = data.state(StateSpec::HISTORY);
    for actuator in 0..model.nu() {
        #[cfg(engine_since = "3.2.0")]
        let (first, count) = (model.actuator_actadr()[actuator], model.actuator_actnum()[actuator] as usize);
        #[cfg(not(engine_since = "3.2.0"))]
        let (first, count) = (
            (actuator + model.na()).saturating_sub(model.nu()) as i32,
            usize::from(model.actuator_dyntype()[actuator] != 0),
        );
        let mut values = vec![("ctrl", &data.ctrl()[actuator..=actuator])];
        if count > 0 {
            values.push(("act", &data.act()[first as usize..][..count]));
        }
        #[cfg(engine_since = "3.5.0")]
        if model.actuator_history()[actuator][0] > 0 {
            let samples = model.actuator_history()[actuator][0] as usize;
            values.push(("history", &history[model.actuator_historyadr()[actuator] as usize..][..2 + 2 * samples]));
        }
        let name = model.name(model.id::<Actuator>(actuator).unwrap());
        put(Kind::Actuator, actuator, model.actuator_user().row(actuator)[0], name, 0, &values);
    }
    for equality in 0..model.neq() {
        let id = model.id::<Equality>(equality).unwrap();
        let active = [f64::from(u8::from(data.equality(id).active()))];
        put(Kind::Equality, equality, model.eq_solref()[equality][0], model.name(id), 0, &[("active", &active)]);
    }
    for sensor in 0..model.nsensor() {
        let mut values = Vec::new();
        #[cfg(engine_since = "3.5.0")]
        if model.sensor_history()[sensor][0] > 0 {
            let length = 2 + model.sensor_history()[sensor][0] as usize * (1 + model.sensor_dim()[sensor] as usize);
            values.push(("history", &history[model.sensor_historyadr()[sensor] as usize..][..length]));
        }
        values.extend([("none", &history[..0])]);
        let name = model.name(model.id::<Sensor>(sensor).unwrap());
        put(Kind::Sensor, sensor, model.sensor_user().row(sensor)[0], name, model.sensor_type()[sensor], &values);
    }
    found
}

struct Generator {
    rng: Rng,
    number: u32,
    /// Probability of a name.
    named: f64,
    /// 2.2.2 needs actuators without an activation before the others, so each model has one kind.
    stateful: bool,
    /// Some bodies are copied.
    copies: bool,
}

impl Generator {
    fn number(&mut self) -> u32 {
        self.number += 1;
        self.number
    }

    /// Returns the attributes with the number and perhaps a name, and the name.
    fn mark(&mut self, kind: &str, named: bool) -> (String, Option<String>) {
        let number = self.number();
        let name = (named || self.rng.random_bool(self.named)).then(|| format!("{kind}{number}"));
        let attribute = name.as_ref().map(|name| format!(" name='{name}'")).unwrap_or_default();
        let number = if kind == "e" { format!(" solref='{} 1'", solref(number)) } else { format!(" user='{number}'") };
        (attribute + &number, name)
    }

    /// Returns the text of a body in the world, perhaps in a frame or copied, and appends the names
    /// of its hinges and sliders.
    fn placed_body(&mut self, names: &mut Vec<String>) -> String {
        let body = self.body(2, names);
        match self.rng.random_range(0..6) {
            0 if self.copies => format!("<replicate count='2' sep='_' offset='1 0 0'>{body}</replicate>"),
            1 if cfg!(engine_since = "3.2.0") => format!("<frame pos='0 1 0'>{body}</frame>"),
            _ => body,
        }
    }

    /// Returns the text of a body, and appends the names of its hinges and sliders.
    fn body(&mut self, depth: usize, names: &mut Vec<String>) -> String {
        let mut text = format!("<body{}>", self.mark("b", false).0);
        let nested = if depth > 0 && self.rng.random_bool(0.3) { self.body(depth - 1, names) } else { String::new() };
        match self.rng.random_range(0..5) {
            0 if depth == 2 => text += &format!("<joint type='free'{}/>", self.mark("j", false).0),
            1 => text += &format!("<joint type='ball'{}/>", self.mark("j", false).0),
            count => {
                for _ in 2..count {
                    let (mark, name) = self.mark("j", false);
                    let kind = self.rng.one_of(&["hinge", "slide"]);
                    text += &format!("<joint type='{kind}' axis='{}'{mark}/>", self.rng.numbers::<3>(0.1, 1.0));
                    names.extend(name);
                }
            }
        }
        text += &nested;
        text += "<geom size='.1'/>";
        while depth > 0 && self.rng.random_bool(0.4) {
            text += &self.body(depth - 1, names);
        }
        text + "</body>"
    }

    fn spec(&mut self) -> Spec {
        let (mut world, mut names) = (String::new(), Vec::new());
        for _ in 0..self.rng.random_range(1..5) {
            if self.rng.random_bool(0.2) {
                world += &format!("<body mocap='true'{}><geom size='.1'/></body>", self.mark("b", false).0);
            } else {
                world += &self.placed_body(&mut names);
            }
        }
        let [mut tendons, mut actuators, mut equalities, mut sensors] = [const { String::new() }; 4];
        for joint in &names {
            let tendon = self.rng.random_bool(0.2).then(|| format!("t{}", self.number()));
            if let Some(name) = &tendon {
                tendons += &format!("<fixed name='{name}'><joint joint='{joint}' coef='1'/></fixed>");
            }
            while self.rng.random_bool(0.4) {
                let (mark, _) = self.mark("a", false);
                let is_stateful = if cfg!(engine_since = "3.2.0") { self.rng.random_bool(0.5) } else { self.stateful };
                let delay = if self.rng.random_bool(0.3) { DELAY } else { "" };
                let element = if is_stateful { "general dyntype='filter'" } else { "motor" };
                let target = match &tendon {
                    Some(name) if self.rng.random_bool(0.5) => format!("tendon='{name}'"),
                    _ => format!("joint='{joint}'"),
                };
                actuators += &format!("<{element} {target}{mark}{delay}/>");
            }
            if self.rng.random_bool(0.4) {
                equalities += &format!("<joint joint1='{joint}'{}/>", self.mark("e", false).0);
            }
            if self.rng.random_bool(0.4) {
                let delay = if self.rng.random_bool(0.5) { DELAY } else { "" };
                sensors += &format!("<jointpos joint='{joint}'{}{delay}/>", self.mark("s", false).0);
            }
        }
        let text = format!(
            "<mujoco model='m'><compiler autolimits='true' settotalmass='-1'/>
             <size nuserdata='4' nuser_body='1' nuser_jnt='1' nuser_actuator='1' nuser_sensor='1' njmax='50' nconmax='10'/>
             <default><geom contype='0' conaffinity='0'/></default><worldbody>{world}</worldbody>
             <tendon>{tendons}</tendon><actuator>{actuators}</actuator><equality>{equalities}</equality><sensor>{sensors}</sensor></mujoco>"
        );
        Spec::from_xml_str(&text).unwrap()
    }

    fn pick<T: Copy>(&mut self, items: &[T]) -> Option<T> {
        (!items.is_empty()).then(|| items[self.rng.random_range(0..items.len())])
    }

    /// Marks an element of a spec.
    fn mark_element<K>(&mut self, spec: &mut Spec, id: ElementId<K>, kind: &str) {
        let number = self.number();
        let is_named = self.rng.random_bool(self.named);
        let mut element = spec.edit(id);
        element.set("user", number).unwrap();
        if is_named {
            element.set_name(&format!("{kind}{number}"));
        }
    }

    fn add_body(&mut self, spec: &mut Spec, parent: ElementId<Body>, joint: JointType) {
        let body = spec.add_body(parent).set_pos([1.0, 2.0, 3.0]).id();
        self.mark_element(spec, body, "b");
        let joint = spec.add_joint(body).set_type(joint).id();
        self.mark_element(spec, joint, "j");
        spec.add_geom(body).set_size(&[0.1]);
    }

    /// Performs an edit, which may be one that the compiler rejects, and returns its description.
    fn edit(&mut self, spec: &mut Spec) -> String {
        let bodies: Vec<_> = spec.ids::<Body>().into_iter().skip(1).collect();
        let (joints, actuators) = (spec.ids::<Joint>(), spec.ids::<Actuator>());
        let all: Vec<ElementId> = (bodies.iter().map(|id| id.any()))
            .chain(joints.iter().map(|id| id.any()))
            .chain(actuators.iter().map(|id| id.any()))
            .chain(spec.ids::<Equality>().into_iter().map(ElementId::any))
            .chain(spec.ids::<Sensor>().into_iter().map(ElementId::any))
            .collect();
        let types = [JointType::Hinge, JointType::Slide, JointType::Ball];
        match self.rng.random_range(0..12) {
            0 | 1 => {
                let Some(id) = self.pick(&all) else { return "nothing".to_owned() };
                let description = format!("remove {:?}", spec.element(id));
                spec.remove_with_references(id).unwrap();
                description
            }
            2 => {
                let parent = self.pick(&bodies).unwrap_or(spec.world());
                let kind = self.pick(&types).unwrap();
                self.add_body(spec, parent, kind);
                "add a body".to_owned()
            }
            3 => {
                let world = spec.world();
                self.add_body(spec, world, JointType::Free);
                "add a free body".to_owned()
            }
            4 => {
                let world = spec.world();
                let body = spec.add_body(world).set_mocap(true).set_pos([1.0, 2.0, 3.0]).id();
                self.mark_element(spec, body, "b");
                "add a mocap body".to_owned()
            }
            5 => {
                let Some(joint) = self.pick(&joints) else { return "nothing".to_owned() };
                let is_stateful = if cfg!(engine_since = "3.2.0") { self.rng.random_bool(0.5) } else { self.stateful };
                let kind = if is_stateful { ActuatorElement::Cylinder } else { ActuatorElement::Motor };
                let actuator = spec.add_actuator(kind).set_joint(joint).id();
                self.mark_element(spec, actuator, "a");
                "add an actuator".to_owned()
            }
            6 => {
                let Some(joint) = self.pick(&joints) else { return "nothing".to_owned() };
                let kind = self.pick(&types).unwrap();
                spec.edit(joint).set_type(kind);
                format!("{:?} becomes {kind:?}", spec.element(joint))
            }
            7 => {
                let Some(id) = self.pick(&all) else { return "nothing".to_owned() };
                if spec.element(id).name().is_none() {
                    return "nothing".to_owned();
                }
                let name = format!("r{}", self.number());
                let description = format!("rename {:?} to {name}", spec.element(id));
                spec.edit(id).set_name(&name);
                description
            }
            8 => {
                // An element is replaced by another one of the same name.
                let Some(body) = self.pick(&bodies) else { return "nothing".to_owned() };
                let Some(name) = spec.element(body).name().map(str::to_owned) else { return "nothing".to_owned() };
                spec.remove_with_references(body).unwrap();
                let world = spec.world();
                self.add_body(spec, world, JointType::Free);
                let added = *spec.ids::<Body>().last().unwrap();
                spec.edit(added).set_name(&name);
                format!("replace {name}")
            }
            9 => {
                let Some(body) = self.pick(&bodies) else { return "nothing".to_owned() };
                let is_mocap = spec.element(body).attribute("mocap").is_some();
                spec.edit(body).set_mocap(!is_mocap);
                "a mocap body or none".to_owned()
            }
            10 => {
                let child = self.spec();
                let prefix = format!("p{}_", self.number());
                let mount = Mount::body(self.pick(&bodies).unwrap_or(spec.world())).with_pos([0.5, 0.0, 0.25]);
                // Mocap and free bodies can be in the world only.
                if spec.attach(&child, mount, &prefix).and_then(|_| spec.compile()).is_err() {
                    return "reject".to_owned();
                }
                format!("attach {}", child.to_xml())
            }
            _ => {
                spec.section_mut("option")
                    .unwrap()
                    .set("gravity", [0.0, 0.0, -self.rng.random_range(1.0..9.0)])
                    .unwrap();
                spec.section_mut("size").unwrap().set("nuserdata", self.rng.random_range(0..6)).unwrap();
                "another option".to_owned()
            }
        }
    }

    /// Sets all of the state to random numbers.
    fn fill(&mut self, data: &mut Data) {
        let mut fill =
            |values: &mut [f64]| values.iter_mut().for_each(|value| *value = self.rng.random_range(-9.0..9.0));
        fill(data.qpos_mut());
        fill(data.qvel_mut());
        fill(data.act_mut());
        fill(data.ctrl_mut());
        fill(data.qacc_warmstart_mut());
        fill(data.qfrc_applied_mut());
        fill(data.xfrc_applied_mut().as_flattened_mut());
        fill(data.mocap_pos_mut().as_flattened_mut());
        fill(data.mocap_quat_mut().as_flattened_mut());
        fill(data.userdata_mut());
        data.set_time(self.rng.random_range(0.0..9.0));
        for equality in 0..data.model().neq() {
            if self.rng.random_bool(0.3) {
                data.set_equality_active(equality, false).unwrap();
            }
        }
        #[cfg(engine_since = "3.5.0")]
        {
            let model = data.model().clone();
            let mut samples = || std::array::from_fn::<f64, 4, _>(|_| self.rng.random_range(-9.0..9.0));
            for actuator in (0..model.nu()).filter(|&actuator| model.actuator_history()[actuator][0] > 0) {
                data.init_ctrl_history(actuator, &[0.1, 0.2, 0.3, 0.4], &samples()).unwrap();
            }
            for sensor in (0..model.nsensor()).filter(|&sensor| model.sensor_history()[sensor][0] > 0) {
                let phase = samples()[0];
                data.init_sensor_history(sensor, &[0.1, 0.2, 0.3, 0.4], &samples(), phase).unwrap();
            }
        }
    }
}

/// Returns the number by which an equality constraint is found.
fn solref(number: u32) -> f64 {
    0.02 + f64::from(number) * 1e-6
}

/// Checks the state after an edit. Elements are the same if their numbers are, or else if their
/// names are. Beside copies they may also be new. Returns the numbers of elements that are the same
/// and of those that have become new.
fn check(
    (before, after, adoption): (&Data, &Data, &Adoption),
    (by_number, copies): (bool, bool),
    log: &[String],
) -> [usize; 2] {
    let is_new = |kind, index| adoption.new.iter().any(|element| (element.kind, element.index) == (kind, index));
    let mut counts = [0; 2];
    let [old, new] = [before, after].map(elements);
    let fresh = elements(&Data::new(after.model()).unwrap());
    let by_name: HashMap<_, _> =
        old.iter().filter_map(|(key, element)| Some(((key.0, element.name.as_deref()?), element))).collect();
    for (key, element) in &new {
        let origin = if by_number {
            old.get(key)
        } else {
            element.name.as_deref().and_then(|name| by_name.get(&(key.0, name)).copied())
        };
        let mut origin = origin.filter(|origin| origin.form == element.form);
        let has_state = key.0 != Kind::Sensor || element.values.contains_key("history");
        if let Some(found) = origin.filter(|_| has_state) {
            let is_new = is_new(key.0, element.index);
            assert!(!is_new || copies, "{} {:?} is not new\n{log:#?}", key.0, element.name);
            origin = (!is_new).then_some(found);
            counts[usize::from(is_new)] += 1;
        } else if has_state {
            assert!(is_new(key.0, element.index), "{} {:?} is new\n{log:#?}", key.0, element.name);
        }
        for (vector, values) in &element.values {
            let kept = origin.and_then(|origin| origin.values.get(vector));
            let expected = kept.filter(|kept| kept.len() == values.len()).unwrap_or(&fresh[key].values[vector]);
            let same = values.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits());
            let name = &element.name;
            assert!(same, "{vector} of {} {name:?}: {values:?}, not {expected:?}\n{log:#?}", key.0);
        }
    }
    assert_eq!(after.time(), before.time());
    let common = after.userdata().len().min(before.userdata().len());
    assert_eq!(after.userdata()[..common], before.userdata()[..common]);
    assert!(after.userdata()[common..].iter().all(|value| *value == 0.0));
    counts
}

#[test]
fn the_state_of_surviving_elements_is_kept_in_random_edits() {
    let first: u64 = std::env::var("SKIP").map_or(0, |number| number.parse().unwrap());
    let (mut edits, mut surviving, mut beside_copies) = (0, 0, [0; 2]);
    let count = std::env::var("MODELS").map_or(cases(60_usize, 500), |number| number.parse().unwrap());
    for seed in first..first + count as u64 {
        // Half of the models are compiled from specs with unnamed elements, others also from texts.
        let from_texts = seed % 2 == 1;
        let named = if from_texts { 1.0 } else { 0.5 };
        let mut generator = Generator {
            rng: Rng::seed_from_u64(seed),
            number: 0,
            named,
            stateful: seed % 4 < 2,
            copies: cfg!(engine_since = "3.2.0") && seed % 8 < 5,
        };
        let mut spec = generator.spec();
        let mut log = vec![format!("seed {seed}"), spec.to_xml()];
        let mut data = Data::new(spec.compile().unwrap()).unwrap();
        let mut is_compiled = true;
        for _ in 0..generator.rng.random_range(2..8) {
            generator.fill(&mut data);
            let mut is_same_spec = true;
            for _ in 0..generator.rng.random_range(1..3) {
                let mut edited = spec.clone();
                let description = generator.edit(&mut edited);
                if edited.compile().is_ok() {
                    log.push(description);
                    (spec, edits) = (edited, edits + 1);
                }
            }
            if from_texts && generator.rng.random_bool(0.2) {
                spec = Spec::from_xml_str(&spec.to_xml()).unwrap();
                log.push("read again".to_owned());
                is_same_spec = false;
            }
            let was_compiled = std::mem::replace(&mut is_compiled, !from_texts || generator.rng.random_bool(0.3));
            let model = if is_compiled { spec.compile() } else { Model::from_xml_str(&spec.to_xml()) }.unwrap();
            let before = data.clone();
            let adoption = data.adopt(model).unwrap();
            let by_number = was_compiled && is_compiled && is_same_spec;
            let has_copies = spec.to_xml().contains("<replicate");
            let [same, new] = check((&before, &data, &adoption), (by_number, has_copies), &log);
            surviving += same;
            if has_copies {
                beside_copies = [beside_copies[0] + same, beside_copies[1] + new];
            }
            // It is a usable simulation.
            data.clone().forward().unwrap_or_else(|error| panic!("{error}\n{log:#?}"));
        }
    }
    let least = if count >= 2600 { 10_000 } else { 10 * count / 3 };
    assert!(edits >= least, "{edits} edits");
    assert!(surviving > 3 * edits, "{surviving} elements survived {edits} edits");
    if cfg!(engine_since = "3.2.0") {
        let [same, new] = beside_copies;
        assert!(same > edits && new < same / 50, "beside copies {same} elements survived, {new} did not");
    }
}
