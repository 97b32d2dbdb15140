//! MJCF texts from a grammar of most kinds of elements. Nearly all texts are valid: they test that
//! a model that loads can be saved, loaded again and used. Damaged texts are in `text`.

use std::fmt::Write as _;

use super::text::load_and_use;
use super::{Bytes, Verdict, assets};

const GEOMS: [&str; 8] = [
    "size='.1'",
    "type='capsule' size='.05 .1'",
    "type='box' size='.1 .2 .1'",
    "type='cylinder' size='.1 .1'",
    "type='ellipsoid' size='.1 .2 .3'",
    "type='capsule' size='.05' fromto='0 0 0 .2 0 .1'",
    "type='mesh' mesh='tetrahedron'",
    "type='mesh' mesh='stl' material='material'",
];

const OPTIONS: [&str; 12] = [
    "",
    "integrator='RK4'",
    "integrator='implicit'",
    "solver='PGS' jacobian='dense'",
    "solver='CG' jacobian='sparse'",
    "cone='elliptic' impratio='3'",
    "iterations='0' noslip_iterations='2'",
    "iterations='-1'",
    "timestep='.01' density='1000' viscosity='.1' wind='1 0 0'",
    "gravity='0 0 0' collision='predefined'",
    "mpr_iterations='3' tolerance='0'",
    "o_margin='.01' o_solref='.01 1'",
];

const FLAGS: [&str; 6] = [
    "",
    "<flag contact='disable'/>",
    "<flag energy='enable' fwdinv='enable'/>",
    "<flag override='enable' sensornoise='enable'/>",
    "<flag warmstart='disable' filterparent='disable'/>",
    "<flag multiccd='enable' limit='disable'/>",
];

const VISUALS: [&str; 6] = [
    "",
    "<quality numslices='0' numstacks='0' numquads='0'/>",
    "<quality numslices='5000' shadowsize='-1' offsamples='-4'/>",
    "<global offwidth='0' offheight='-1'/>",
    "<map znear='.1' zfar='5' haze='2'/>",
    "<scale forcewidth='-1'/><rgba fog='2 0 0 1'/>",
];

const COMPILERS: [&str; 9] = [
    "",
    "angle='radian'",
    "coordinate='local' strippath='true'",
    "boundmass='.01' boundinertia='.001'",
    "settotalmass='3'",
    "balanceinertia='true' inertiafromgeom='true'",
    "fusestatic='true' discardvisual='true'",
    "usethread='false' eulerseq='ZYX'",
    "fitaabb='true' inertiagrouprange='0 1'",
];

const SIZES: [&str; 8] = [
    "",
    "njmax='0' nconmax='0'",
    "njmax='20' nconmax='3'",
    "nkey='3' nuserdata='2'",
    "nuser_body='2' nuser_jnt='1' nuser_geom='3' nuser_site='1'",
    "nuser_cam='1' nuser_tendon='2' nuser_actuator='1' nuser_sensor='2'",
    "nstack='100000'",
    "nuser_geom='0' nkey='0'",
];

/// Names of the elements generated so far.
#[derive(Default)]
struct Names {
    bodies: usize,
    joints: usize,
    /// Joints with one degree of freedom.
    scalars: Vec<usize>,
    balls: Vec<usize>,
    sites: usize,
    geoms: usize,
}

pub(super) fn generated_mjcf(bytes: &mut Bytes<'_>, log: &mut dyn FnMut(&str)) -> Verdict {
    let text = model(bytes);
    load_and_use(&text, &assets::files(), log)
}

fn model(bytes: &mut Bytes<'_>) -> String {
    let mut names = Names::default();
    let mut bodies = String::new();
    for _ in 0..=bytes.below(3) {
        bodies += &body(0, &mut names, bytes);
    }
    let (compiler, size, option) = (bytes.choose(&COMPILERS), bytes.choose(&SIZES), bytes.choose(&OPTIONS));
    let (flag, visual) = (bytes.choose(&FLAGS), bytes.choose(&VISUALS));
    let ground = bytes.choose(&[
        "<geom name='ground' type='plane' size='3 3 .1'/>",
        "<geom name='ground' type='hfield' hfield='field'/>",
        "<geom name='ground' type='plane' size='0 0 1' material='material'/>",
    ]);
    let rest = [
        tendons(&names, bytes),
        actuators(&names, bytes),
        sensors(&names, bytes),
        equalities(&names, bytes),
        contacts(&names, bytes),
        custom(bytes),
    ]
    .concat();
    format!(
        "<mujoco model='m'><compiler {compiler}/><size {size}/><option {option}>{flag}</option><visual>{visual}</visual>
         <asset>
           <mesh name='tetrahedron' vertex='0 0 0 .3 0 0 0 .3 0 0 0 .3'/><mesh name='stl' file='t.stl' scale='1 -1 1'/>
           <hfield name='field' nrow='3' ncol='4' size='1 1 .2 .1'/>
           <texture name='texture' type='2d' builtin='checker' width='8' height='8'/>
           <material name='material' texture='texture' reflectance='.3'/>
         </asset>
         <worldbody>{ground}<site name='s0'/><light pos='0 0 3'/><camera name='c' pos='0 -3 1'/>{bodies}</worldbody>{rest}</mujoco>"
    )
}

fn body(depth: usize, names: &mut Names, bytes: &mut Bytes<'_>) -> String {
    names.bodies += 1;
    let name = names.bodies;
    let pose = bytes.choose(&[
        "pos='0 0 1'",
        "pos='.3 0 .4' euler='10 20 30'",
        "pos='0 .5 .5' quat='1 1 0 0'",
        "axisangle='0 0 1 45'",
        "pos='0 0 .1' mocap='true'",
    ]);
    let is_mocap = pose.ends_with("mocap='true'") && depth == 0;
    let pose = if is_mocap { pose } else { pose.trim_end_matches(" mocap='true'") };
    let mut content = String::new();
    if !is_mocap {
        joints(depth, names, &mut content, bytes);
    }
    for _ in 0..=bytes.below(2) {
        names.geoms += 1;
        let more = bytes.choose(&[
            "",
            "condim='1'",
            "condim='6' margin='.01' gap='.005'",
            "mass='.5'",
            "group='7' rgba='1 0 0 .5'",
        ]);
        let _ = write!(content, "<geom name='g{}' {} {more}/>", names.geoms, bytes.choose(&GEOMS));
    }
    names.sites += 1;
    let site = bytes.choose(&["", "pos='.1 0 0'", "type='box' size='.1 .1 .1' quat='1 0 1 0'"]);
    let _ = write!(content, "<site name='s{}' {site}/>", names.sites);
    if bytes.once_in(4) {
        content += bytes.choose(&[
            "<camera mode='track'/>",
            "<camera mode='targetbodycom' target='world'/>",
            "<light mode='trackcom'/>",
            "<inertial pos='0 0 .1' mass='2' diaginertia='.1 .1 .1'/>",
            "<inertial pos='0 0 0' mass='1' fullinertia='.1 .1 .1 .01 0 0'/>",
        ]);
    }
    if depth < 3 && !is_mocap {
        for _ in 0..bytes.below(3) {
            content += &body(depth + 1, names, bytes);
        }
    }
    format!("<body name='b{name}' {pose}>{content}</body>")
}

fn joints(depth: usize, names: &mut Names, content: &mut String, bytes: &mut Bytes<'_>) {
    let more = bytes.choose(&[
        "",
        "damping='1' armature='.1'",
        "range='-1 1' limited='true'",
        "frictionloss='.2' stiffness='5' springref='.1'",
        "ref='.2' solreflimit='.01 1'",
    ]);
    let kinds: &[&[&str]] = match bytes.below(6) {
        0 if depth == 0 => &[&["free"]],
        1 => &[&["ball"]],
        2 => &[&["slide", "0 0 1"], &["hinge", "0 1 0"]],
        3 => &[&["hinge", "1 0 0"], &["hinge", "0 1 0"], &["hinge", "0 0 1"]],
        4 if depth > 0 => &[],
        _ => &[&["hinge", "0 1 0"]],
    };
    for kind in kinds {
        names.joints += 1;
        let name = names.joints;
        match kind[0] {
            "free" => {
                let _ = write!(content, "<freejoint name='j{name}'/>");
            }
            "ball" => {
                names.balls.push(name);
                let _ = write!(content, "<joint name='j{name}' type='ball' damping='.1'/>");
            }
            kind_name => {
                names.scalars.push(name);
                let _ = write!(content, "<joint name='j{name}' type='{kind_name}' axis='{}' {more}/>", kind[1]);
            }
        }
    }
}

/// Returns an element of a list, or nothing if it is empty.
fn pick(list: &[usize], bytes: &mut Bytes<'_>) -> Option<usize> {
    list.get(bytes.below(list.len())).copied()
}

fn tendons(names: &Names, bytes: &mut Bytes<'_>) -> String {
    let mut content = String::new();
    if let (Some(joint), true) = (pick(&names.scalars, bytes), bytes.once_in(2)) {
        let _ = write!(content, "<fixed name='t1'><joint joint='j{joint}' coef='2'/></fixed>");
    } else {
        content += "<spatial name='t1' width='.01'><site site='s0'/><site site='s1'/></spatial>";
    }
    let more = bytes.choose(&["", "range='0 2' limited='true'", "stiffness='3' damping='.1'", "frictionloss='.1'"]);
    let last = if names.sites == 1 { 0 } else { names.sites };
    let _ = write!(
        content,
        "<spatial name='t2' {more}><site site='s0'/><site site='s1'/><pulley divisor='2'/><site site='s1'/><site site='s{last}'/></spatial>"
    );
    format!("<tendon>{content}</tendon>")
}

fn actuators(names: &Names, bytes: &mut Bytes<'_>) -> String {
    let mut stateless = String::new();
    let mut stateful = String::new();
    for _ in 0..bytes.below(5) {
        let (site, other) = (bytes.below(names.sites + 1), bytes.below(names.sites + 1));
        let scalar = pick(&names.scalars, bytes);
        let target = match (bytes.below(4), scalar) {
            (0, Some(joint)) => format!("joint='j{joint}'"),
            (1, _) => "tendon='t2'".to_owned(),
            (2, _) => format!("site='s{site}' refsite='s{other}' gear='1 0 0 0 0 1'"),
            _ => format!("site='s{site}' gear='0 0 1 0 0 0'"),
        };
        let more = bytes.choose(&["", "ctrlrange='-1 1' ctrllimited='true'", "forcerange='-2 2' forcelimited='true'"]);
        // The engine requires actuators with activations to be last.
        let (list, text) = match bytes.below(8) {
            0 => (&mut stateless, format!("<position {target} kp='3' {more}/>")),
            1 => (&mut stateless, format!("<velocity {target} kv='.3' {more}/>")),
            2 => (&mut stateless, format!("<damper {target} kv='1' ctrlrange='0 1'/>")),
            3 => (&mut stateful, format!("<intvelocity {target} kp='2' actrange='-1 1' {more}/>")),
            4 => (&mut stateful, format!("<cylinder {target} timeconst='.1' area='.2'/>")),
            5 => (
                &mut stateful,
                format!("<general {target} dyntype='filter' dynprm='.1' biastype='affine' biasprm='0 -1 -.1'/>"),
            ),
            6 => (&mut stateless, format!("<general cranksite='s{site}' slidersite='s{other}' cranklength='.3'/>")),
            _ => (&mut stateless, format!("<motor {target} {more}/>")),
        };
        list.push_str(&text);
    }
    format!("<actuator>{stateless}{stateful}</actuator>")
}

fn sensors(names: &Names, bytes: &mut Bytes<'_>) -> String {
    let mut content = String::new();
    for _ in 0..bytes.below(8) {
        let (site, body) = (bytes.below(names.sites + 1), 1 + bytes.below(names.bodies));
        let geom = 1 + bytes.below(names.geoms);
        let text = match (bytes.below(14), pick(&names.scalars, bytes), pick(&names.balls, bytes)) {
            (0, Some(joint), _) => format!("<jointpos joint='j{joint}' noise='.1'/>"),
            (1, Some(joint), _) => format!("<jointvel joint='j{joint}' cutoff='1'/>"),
            (2, _, Some(ball)) => format!("<ballquat joint='j{ball}'/>"),
            (3, ..) => format!("<accelerometer site='s{site}'/>"),
            (4, ..) => format!("<gyro site='s{site}'/><magnetometer site='s{site}'/>"),
            (5, ..) => format!("<touch site='s{site}'/><force site='s{site}'/><torque site='s{site}'/>"),
            (6, ..) => format!("<framepos objtype='geom' objname='g{geom}' reftype='site' refname='s{site}'/>"),
            (7, ..) => format!("<framequat objtype='xbody' objname='b{body}' reftype='camera' refname='c'/>"),
            (8, ..) => format!(
                "<framelinvel objtype='body' objname='b{body}'/><frameangacc objtype='site' objname='s{site}'/>"
            ),
            (9, ..) => format!("<subtreecom body='b{body}'/><subtreeangmom body='b{body}'/>"),
            (10, ..) => "<tendonpos tendon='t2'/><tendonvel tendon='t1'/><clock/>".to_owned(),
            (11, ..) => format!("<rangefinder site='s{site}'/>"),
            (12, ..) => format!("<user objtype='geom' objname='g{geom}' dim='2' needstage='vel' datatype='real'/>"),
            _ => format!("<velocimeter site='s{site}'/>"),
        };
        content += &text;
    }
    format!("<sensor>{content}</sensor>")
}

fn equalities(names: &Names, bytes: &mut Bytes<'_>) -> String {
    let mut content = String::new();
    for _ in 0..bytes.below(3) {
        let (one, two) = (1 + bytes.below(names.bodies), 1 + bytes.below(names.bodies));
        let active = bytes.choose(&["", "active='false'", "solref='.01 1'"]);
        let text = match (bytes.below(4), pick(&names.scalars, bytes), pick(&names.scalars, bytes)) {
            (0, Some(a), Some(b)) if a != b => {
                format!("<joint joint1='j{a}' joint2='j{b}' polycoef='0 1 0 .1 0' {active}/>")
            }
            (1, ..) => format!("<tendon tendon1='t1' tendon2='t2' {active}/>"),
            (2, ..) if one != two => format!("<weld body1='b{one}' body2='b{two}' {active}/>"),
            _ if one != two => format!("<connect body1='b{one}' body2='b{two}' anchor='.1 0 0' {active}/>"),
            _ => String::new(),
        };
        content += &text;
    }
    format!("<equality>{content}</equality>")
}

fn contacts(names: &Names, bytes: &mut Bytes<'_>) -> String {
    let mut content = String::new();
    if bytes.once_in(2) {
        let geom = 1 + bytes.below(names.geoms);
        let more =
            bytes.choose(&["", "condim='4' friction='1 1 .1 .01 .01'", "margin='.1' gap='.05' solref='-100 -10'"]);
        let _ = write!(content, "<pair geom1='ground' geom2='g{geom}' {more}/>");
    }
    if names.bodies > 1 && bytes.once_in(3) {
        content += "<exclude body1='b1' body2='b2'/>";
    }
    format!("<contact>{content}</contact>")
}

fn custom(bytes: &mut Bytes<'_>) -> String {
    let numeric = bytes.choose(&["<numeric name='n' data='1 2 3'/>", "<numeric name='n' size='5' data='1'/>", ""]);
    let tuple = bytes.choose(&[
        "<tuple name='u'><element objtype='body' objname='b1' prm='2'/></tuple>",
        "<text name='x' data='text'/>",
        "",
    ]);
    let key = bytes.choose(&["", "<key name='k' time='1'/>", "<key/><key time='2'/>"]);
    format!("<custom>{numeric}{tuple}</custom><keyframe>{key}</keyframe>")
}
