//! Random models with several geoms per body, all joints, meshes, tendons, actuators, equalities,
//! pairs, sensors and cameras.

use std::fmt::Write as _;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::random_text::RandomText;

struct Generator {
    random: Xoshiro256PlusPlus,
    /// Numbers of bodies, scalar joints and geoms so far.
    bodies: usize,
    joints: usize,
    geoms: usize,
}

impl Generator {
    fn geom(&mut self) -> String {
        let shape = match self.random.random_range(0..12) {
            0..3 => format!("type='sphere' size='{}'", self.random.number(0.03, 0.2)),
            3..5 => format!("type='capsule' size='{}'", self.random.numbers::<2>(0.03, 0.2)),
            5..7 => format!("type='cylinder' size='{}'", self.random.numbers::<2>(0.03, 0.2)),
            7 => format!("type='ellipsoid' size='{}'", self.random.numbers::<3>(0.03, 0.2)),
            8..11 => format!("type='box' size='{}'", self.random.numbers::<3>(0.03, 0.2)),
            _ => "type='mesh' mesh='mesh'".to_owned(),
        };
        let mut text = format!("<geom name='g{}' {shape}", self.geoms);
        self.geoms += 1;
        text += &self.random.maybe(0.7, "pos", |g| g.numbers::<3>(-0.3, 0.3));
        text += &self.random.maybe(0.5, "euler", |g| g.numbers::<3>(-90.0, 90.0));
        text += &self.random.maybe(0.4, "margin", |g| g.number(0.0, 0.1));
        text += &self.random.maybe(0.3, "gap", |g| g.number(0.0, 0.05));
        text += &self.random.maybe(0.3, "contype", |g| g.one_of(&["0", "1", "2", "3"]).to_owned());
        text += &self.random.maybe(0.3, "conaffinity", |g| g.one_of(&["0", "1", "2", "3"]).to_owned());
        text += &self.random.maybe(0.2, "mass", |g| g.number(0.1, 2.0));
        text += &self.random.maybe(0.3, "condim", |g| g.one_of(&["1", "3", "4", "6"]).to_owned());
        text += &self.random.maybe(0.3, "friction", |g| g.numbers::<3>(0.01, 1.0));
        text += &self.random.maybe(0.2, "priority", |g| g.one_of(&["0", "1", "2"]).to_owned());
        text += &self.random.maybe(0.2, "solref", |g| format!("{} {}", g.number(0.01, 0.1), g.number(0.5, 2.0)));
        text += &self.random.maybe(0.2, "solimp", |_| "0.8 0.95 0.002 0.4 2".to_owned());
        text += &self.random.maybe(0.2, "solmix", |g| g.number(0.1, 3.0));
        text += &self.random.maybe(0.1, "rgba", |g| g.numbers::<4>(0.0, 1.0));
        text + "/>"
    }

    fn joint(&mut self) -> String {
        let kind = self.random.one_of(&["hinge", "hinge", "slide"]);
        let mut text = format!("<joint name='j{}' type='{kind}'", self.joints);
        self.joints += 1;
        text += &self.random.maybe(0.7, "axis", |g| g.numbers::<3>(-1.0, 1.0));
        text += &self.random.maybe(0.4, "pos", |g| g.numbers::<3>(-0.2, 0.2));
        text += &self.random.maybe(0.4, "stiffness", |g| g.number(0.0, 10.0));
        text += &self.random.maybe(0.4, "damping", |g| g.number(0.0, 2.0));
        text += &self.random.maybe(0.3, "armature", |g| g.number(0.0, 0.2));
        text += &self.random.maybe(0.3, "frictionloss", |g| g.number(0.0, 0.5));
        text += &self.random.maybe(0.3, "ref", |g| g.number(-0.2, 0.2));
        text += &self.random.maybe(0.3, "springref", |g| g.number(-0.2, 0.2));
        text += &self.random.maybe(0.2, "springdamper", |g| g.numbers::<2>(0.1, 1.0));
        if self.random.random_bool(0.5) {
            let _ = write!(
                text,
                " limited='true' range='{} {}'",
                self.random.number(-0.4, -0.1),
                self.random.number(0.1, 0.5)
            );
            text += &self.random.maybe(0.3, "margin", |g| g.number(0.0, 0.1));
        }
        text + "/>"
    }

    fn body(&mut self, depth: usize) -> String {
        let name = self.bodies;
        self.bodies += 1;
        let mut text = format!("<body name='b{name}' pos='{}'", self.random.numbers::<3>(-0.4, 0.4));
        text += &self.random.maybe(0.4, "euler", |g| g.numbers::<3>(-60.0, 60.0));
        if depth == 0 && self.random.random_bool(0.1) {
            text += " mocap='true'>";
        } else {
            text += ">";
            match self.random.random_range(0..6) {
                0 if depth == 0 => text += "<freejoint/>",
                1 => text += "<joint type='ball' damping='.1'/>",
                2 => {
                    text += &self.joint();
                    text += &self.joint();
                }
                3 if depth > 0 => {}
                _ => text += &self.joint(),
            }
        }
        if self.random.random_bool(0.2) {
            let _ = write!(
                text,
                "<inertial pos='{}' mass='{}' diaginertia='0.1 0.12 0.{}'/>",
                self.random.numbers::<3>(-0.1, 0.1),
                self.random.number(0.5, 3.0),
                self.random.random_range(14..20),
            );
        }
        for _ in 0..self.random.random_range(1..5) {
            text += &self.geom();
        }
        let _ = write!(text, "<site name='s{name}' pos='{}' size='.05'/>", self.random.numbers::<3>(-0.2, 0.2));
        let mode = self.random.one_of(&["fixed", "track", "trackcom"]);
        let _ = write!(text, "<camera mode='{mode}' pos='{}' fovy='40'/>", self.random.numbers::<3>(-1.0, 1.0));
        let _ = write!(text, "<light mode='{mode}' pos='{0}' dir='{0}'/>", self.random.numbers::<3>(-1.0, 1.0));
        if depth < 2 && !text.contains("mocap") {
            for _ in 0..self.random.random_range(0..3) {
                text += &self.body(depth + 1);
            }
        }
        text + "</body>"
    }

    fn actuator(&mut self, target: &str) -> String {
        let limits = self.random.maybe(0.4, "ctrllimited", |g| format!("true' ctrlrange='-1 {}", g.number(0.1, 1.0)))
            + &self.random.maybe(0.4, "forcelimited", |g| format!("true' forcerange='-2 {}", g.number(0.1, 3.0)));
        let gear = self.random.maybe(0.5, "gear", |g| g.number(0.5, 3.0));
        match self.random.random_range(0..5) {
            0 => format!("<motor {target}{limits}{gear}/>"),
            1 => format!("<position {target} kp='{}'{limits}{gear}/>", self.random.number(1.0, 9.0)),
            2 => format!("<velocity {target} kv='{}'{limits}{gear}/>", self.random.number(0.1, 2.0)),
            3 => {
                format!("<general {target} dyntype='filter' dynprm='{}'{limits}{gear}/>", self.random.number(0.1, 1.0))
            }
            _ => format!(
                "<general {target} biastype='affine' biasprm='{}'{limits}{gear}/>",
                self.random.numbers::<3>(-1.0, 0.0)
            ),
        }
    }
}

const MESH: &str = "<asset><mesh name='mesh' vertex='0 0 0 .2 0 0 0 .2 0 0 0 .2 .1 .1 .2'/></asset>";

/// Returns the text of the model of a seed.
pub(super) fn xml(seed: u64) -> String {
    let random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut g = Generator { random, bodies: 0, joints: 0, geoms: 0 };
    let option = g.random.one_of(&[
        "timestep='0.004'",
        "integrator='implicit' density='1.2' viscosity='0.1'",
        "cone='elliptic' impratio='2'",
        "jacobian='sparse' solver='CG'",
        "solver='PGS' wind='1 0 .5' density='1'",
    ]);
    let mut text = format!(
        "<mujoco><option {option}><flag energy='enable'/></option>{MESH}<worldbody><geom type='plane' size='3 3 .1' pos='0 0 -.4'/>"
    );
    for _ in 0..g.random.random_range(0..3) {
        text += &g.geom();
    }
    for _ in 0..g.random.random_range(1..4) {
        text += &g.body(0);
    }
    text += "</worldbody>";
    let geom_pair = (g.geoms > 1 && g.random.random_bool(0.4)).then(|| {
        format!(
            "<contact><pair geom1='g0' geom2='g{}' condim='3' margin='{}' friction='.5 .5 .01 .001 .001'/></contact>",
            g.geoms - 1,
            g.random.number(0.0, 0.1)
        )
    });
    text += &geom_pair.unwrap_or_default();
    if g.joints > 1 {
        let _ = write!(
            text,
            "<tendon><fixed name='t0' stiffness='{}' damping='.1'><joint joint='j0' coef='1'/><joint joint='j1' coef='{}'/></fixed>\
             <spatial name='t1' stiffness='{}' {}><site site='s0'/><site site='s{}'/></spatial></tendon>",
            g.random.number(0.0, 5.0),
            g.random.number(-2.0, 2.0),
            g.random.number(0.0, 5.0),
            g.random.one_of(&["", "limited='true' range='0 .5'", "frictionloss='.2'", "springlength='.3'"]),
            g.bodies - 1,
        );
        let (one, other, third) = (g.actuator("joint='j0'"), g.actuator("tendon='t0'"), g.actuator("tendon='t1'"));
        let _ = write!(text, "<actuator>{one}{other}{third}</actuator>");
        let equality = match g.random.random_range(0..5) {
            0 => format!("<joint joint1='j0' joint2='j1' polycoef='0 {} 0 0 0'/>", g.random.number(0.2, 2.0)),
            1 => format!("<connect body1='b0' anchor='{}'/>", g.random.numbers::<3>(-0.2, 0.2)),
            2 if g.bodies > 1 => format!("<weld body1='b0' body2='b{}'/>", g.bodies - 1),
            3 => format!("<tendon tendon1='t0' polycoef='{} 1 0 0 0'/>", g.random.number(-0.2, 0.2)),
            _ => String::new(),
        };
        let _ = write!(text, "<equality>{equality}</equality>");
        text += "<sensor><jointpos joint='j0'/><tendonpos tendon='t1'/><framepos objtype='site' objname='s0'/>\
                 <subtreecom body='b0'/><touch site='s0'/><accelerometer site='s0' cutoff='5' noise='.1'/></sensor>";
    }
    text + "</mujoco>"
}
