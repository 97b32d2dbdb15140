//! Random models, as texts: nested classes with joints of several types, orientations in several
//! notations, limits, names with spaces, and references of all kinds.

#![allow(clippy::format_push_string, reason = "texts in the order of their parts")]

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::random_text::RandomText;

type Rng = Xoshiro256PlusPlus;

fn chance(rng: &mut Rng, percent: u32) -> bool {
    rng.random_range(0..100) < percent
}

/// Returns an attribute with a probability in percent.
fn word(rng: &mut Rng, percent: u32, attribute: &str, words: &[&str]) -> String {
    rng.maybe(f64::from(percent) / 100.0, attribute, |rng| rng.one_of(words).to_owned())
}

fn orientation(rng: &mut Rng, percent: u32) -> String {
    if !chance(rng, percent) {
        return String::new();
    }
    match rng.random_range(0..5) {
        0 => format!(" quat='{}'", rng.numbers::<4>(-1.0, 1.0)),
        1 => format!(" euler='{}'", rng.numbers::<3>(-1.0, 1.0)),
        2 => format!(" axisangle='{} {}'", rng.one_of(&["1 0 0", "0 1 1"]), rng.numbers::<1>(-1.0, 1.0)),
        3 => format!(" xyaxes='{}'", rng.one_of(&["0 1 0 -1 0 0", "1 1 0 0 0 1"])),
        _ => format!(" zaxis='{}'", rng.numbers::<3>(-1.0, 1.0)),
    }
}

fn joint_numbers(rng: &mut Rng) -> String {
    // A limit of a ball starts at 0.
    let mut text = match rng.random_range(0..20) {
        0..3 => " range='-.5 .7' type='slide'".to_owned(),
        3..6 => " range='-.5 .7' type='hinge'".to_owned(),
        6..10 => format!(" range='0 .4'{}", word(rng, 50, "limited", &["true", "auto", "false"])),
        10 => " range='0 0'".to_owned(),
        11 => " limited='false'".to_owned(),
        12..15 => format!(" type='{}'", rng.one_of(&["hinge", "slide"])),
        15 => " type='ball'".to_owned(),
        _ => String::new(),
    };
    text += &rng.maybe(0.3, "ref", |rng| rng.numbers::<1>(-1.0, 1.0));
    text += &rng.maybe(0.3, "springref", |rng| rng.numbers::<1>(-1.0, 1.0));
    text += &word(rng, 20, "stiffness", &["1", "2"]);
    text += &word(rng, 20, "margin", &[".1"]);
    #[cfg(engine_since = "4.0.0")]
    {
        text += &word(rng, 20, "springyield", &[".2", ".4"]);
    }
    #[cfg(engine_since = "3.5.0")]
    {
        text += &word(rng, 10, "actuatorfrcrange", &["-1 1", "0 0"]);
        text += &word(rng, 10, "solreflimit", &[".1 1"]);
    }
    text
}

fn geom_numbers(rng: &mut Rng) -> String {
    let mut text = orientation(rng, 40);
    text += &rng.maybe(0.3, "pos", |rng| rng.numbers::<3>(-1.0, 1.0));
    text += &word(rng, 30, "type", &["sphere", "capsule", "box", "ellipsoid", "cylinder"]);
    text += &word(rng, 20, "size", &[".1 .2 .3", ".3 .2 .1"]);
    text += &word(rng, 20, "friction", &["1 .1 .1", ".5"]);
    text += &word(rng, 10, "user", &["1 2", "3"]);
    text
}

fn defaults(rng: &mut Rng, class: Option<&str>) -> String {
    let name = class.map_or(String::new(), |class| format!(" class='{class}'"));
    let mut text = format!("<default{name}>");
    let outer = if class.is_none() { "size='.1 .1 .1'" } else { "" };
    text += &format!("<geom {outer}{}/>", geom_numbers(rng));
    if chance(rng, 70) {
        text += &format!("<joint{}/>", joint_numbers(rng));
    }
    if chance(rng, 50) {
        text += &format!("<site{}/>", orientation(rng, 60));
    }
    if chance(rng, 50) {
        text += &format!("<camera fovy='30'{}/>", orientation(rng, 60));
    }
    if chance(rng, 50) {
        text +=
            &format!("<tendon{}{}/>", word(rng, 50, "range", &["-1 1"]), word(rng, 30, "limited", &["false", "true"]));
    }
    if chance(rng, 50) {
        text += &format!(
            "<motor{}{}/>",
            word(rng, 50, "ctrlrange", &["-1 1", "0 0"]),
            word(rng, 30, "ctrllimited", &["false", "auto"])
        );
    }
    if chance(rng, 30) {
        text += "<equality solref='.1 1'/>";
    }
    match class {
        None => {
            text += &defaults(rng, Some("one"));
            text += &defaults(rng, Some("two 2"));
        }
        Some("one") => text += &defaults(rng, Some("inner")),
        Some(_) => {}
    }
    text + "</default>"
}

const CLASSES: [&str; 4] = ["one", "two 2", "inner", "main"];

struct Names {
    number: usize,
    joints: Vec<String>,
    bodies: Vec<String>,
    sites: Vec<String>,
    geoms: Vec<String>,
}

impl Names {
    fn next(&mut self, rng: &mut Rng, kind: &str) -> String {
        self.number += 1;
        // Some names are words of others.
        if chance(rng, 50) { format!("{kind} {}", self.number) } else { format!("{kind}{}", self.number) }
    }
}

fn body(rng: &mut Rng, names: &mut Names, depth: usize) -> String {
    let name = names.next(rng, "b");
    names.bodies.push(name.clone());
    let mut text = format!(
        "<body name='{name}'{}{}{}>",
        orientation(rng, 50),
        rng.maybe(0.7, "pos", |rng| rng.numbers::<3>(-1.0, 1.0)),
        word(rng, 30, "childclass", &CLASSES)
    );
    if chance(rng, 20) {
        text += &format!("<inertial pos='0 0 0' mass='1' diaginertia='1 2 2.5'{}/>", orientation(rng, 50));
    }
    for _ in 0..rng.random_range(0..3) {
        let joint = names.next(rng, "j");
        text += &format!("<joint name='{joint}'{}{}/>", joint_numbers(rng), word(rng, 30, "class", &CLASSES));
        names.joints.push(joint);
    }
    text += "<geom type='sphere' size='.1'/>";
    text += &elements(rng, names);
    if depth > 0 {
        for _ in 0..rng.random_range(0..3) {
            text += &body(rng, names, depth - 1);
        }
    }
    text + "</body>"
}

/// Elements that bodies and the world can have.
fn elements(rng: &mut Rng, names: &mut Names) -> String {
    let mut text = String::new();
    for _ in 0..rng.random_range(0..3) {
        let geom = names.next(rng, "g");
        text += &format!(
            "<geom name='{geom}'{}{}{}/>",
            geom_numbers(rng),
            word(rng, 30, "class", &CLASSES),
            word(rng, 20, "material", &["m", "m 2"])
        );
        names.geoms.push(geom);
    }
    if chance(rng, 50) {
        let site = names.next(rng, "s");
        text += &format!(
            "<site name='{site}'{}{}{}/>",
            orientation(rng, 40),
            rng.maybe(0.5, "pos", |rng| rng.numbers::<3>(-1.0, 1.0)),
            word(rng, 30, "class", &CLASSES)
        );
        names.sites.push(site);
    }
    if chance(rng, 30) {
        text += &format!("<camera{}{}/>", orientation(rng, 40), word(rng, 30, "class", &CLASSES));
    }
    if chance(rng, 20) {
        text += &format!(
            "<light pos='{}' dir='{}' cutoff='30'/>",
            rng.numbers::<3>(-1.0, 1.0),
            rng.numbers::<3>(-1.0, 1.0)
        );
    }
    if chance(rng, 20) {
        text += &format!("<geom type='capsule' size='.1' fromto='{}'/>", rng.numbers::<6>(-1.0, 1.0));
    }
    #[cfg(engine_since = "3.5.0")]
    if chance(rng, 20) {
        text += &format!(
            "<frame pos='{}'{}{}>{}</frame>",
            rng.numbers::<3>(-1.0, 1.0),
            orientation(rng, 60),
            word(rng, 30, "childclass", &CLASSES),
            elements(rng, names)
        );
    }
    text
}

fn one<'a>(rng: &mut Rng, items: &'a [String]) -> &'a str {
    &items[rng.random_range(0..items.len())]
}

/// Returns the text of a model, which the compiler may reject.
pub(super) fn text(rng: &mut Rng) -> String {
    let mut names = Names { number: 0, joints: Vec::new(), bodies: Vec::new(), sites: Vec::new(), geoms: Vec::new() };
    let compiler = format!(
        "<compiler autolimits='{}'{}{}/>",
        if chance(rng, 95) { "true" } else { "false" },
        word(rng, 60, "angle", &["degree", "radian"]),
        word(rng, 30, "eulerseq", &["xyz", "zyx", "XYZ"])
    );
    let defaults = if chance(rng, 80) {
        defaults(rng, None)
    } else {
        "<default><geom size='.1 .1 .1'/></default>".to_owned()
            + "<default><default class='one'/><default class='two 2'/><default class='inner'/></default>"
    };
    let mut world = elements(rng, &mut names);
    for _ in 0..rng.random_range(1..4) {
        world += &body(rng, &mut names, 2);
    }
    let mut rest = String::new();
    if !names.joints.is_empty() {
        for _ in 0..rng.random_range(0..4) {
            let name = names.next(rng, "a");
            let joint = one(rng, &names.joints);
            rest += &format!(
                "<actuator><{} name='{name}' joint='{joint}'{}{}/></actuator>",
                rng.one_of(&["motor", "position", "velocity"]),
                word(rng, 30, "ctrlrange", &["-1 1", "0 0"]),
                word(rng, 30, "class", &CLASSES)
            );
            rest += &format!("<sensor><actuatorfrc actuator='{name}'/></sensor>");
        }
        if chance(rng, 40) {
            let (name, joint) = (names.next(rng, "t"), one(rng, &names.joints).to_owned());
            rest += &format!(
                "<tendon><fixed name='{name}'{}{}><joint joint='{joint}' coef='2'/></fixed></tendon><sensor><tendonpos tendon='{name}'/></sensor>",
                word(rng, 40, "range", &["-1 1", "0 0"]),
                word(rng, 30, "class", &CLASSES)
            );
        }
    }
    if names.sites.len() > 1 {
        let (a, b) = (one(rng, &names.sites).to_owned(), one(rng, &names.sites).to_owned());
        if a != b {
            let name = names.next(rng, "t");
            rest += &format!(
                "<tendon><spatial name='{name}'{}><site site='{a}'/><site site='{b}'/></spatial></tendon>",
                word(rng, 30, "material", &["m", "m 2"])
            );
        }
        rest += &format!(
            "<sensor><gyro site='{a}'/><framepos objtype='site' objname='{b}' reftype='body' refname='{}'/></sensor>",
            one(rng, &names.bodies)
        );
    }
    let (first, second) = (one(rng, &names.bodies).to_owned(), one(rng, &names.bodies).to_owned());
    if first != second {
        rest += &format!(
            "<contact><exclude body1='{first}' body2='{second}'/></contact><equality><weld body1='{first}'{}/></equality>",
            rng.maybe(0.5, "body2", |_| second.clone())
        );
    }
    rest +=
        &format!("<custom><tuple name='tuple'><element objtype='body' objname='{first}' prm='1'/></tuple></custom>");
    format!(
        "<mujoco model='m'>{compiler}{defaults}<asset><texture name='x' type='2d' builtin='flat' width='2' height='2'/><material name='m'/><material name='m 2' texture='x'/></asset><worldbody>{world}</worldbody>{rest}</mujoco>"
    )
}
