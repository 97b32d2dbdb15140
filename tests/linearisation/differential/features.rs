//! Models with each feature of newer engines, and models with all elements of 2.2.2.

use std::fmt::Write as _;

use mujoco_safe::{Model, built_against};

use super::{Tally, compare_model};

use crate::cases::cases;

/// Arrays of numbers that newer engines have.
pub(super) const NEW_ARRAYS: [&str; 24] = [
    "body_gravcomp",
    "jnt_stiffnesspoly",
    "jnt_springyield",
    "jnt_actfrcrange",
    "dof_dampingpoly",
    "dof_length",
    "geom_surfacevel",
    "geom_adhesion",
    "pair_adhesion",
    "pair_solreffriction",
    "tendon_stiffnesspoly",
    "tendon_dampingpoly",
    "tendon_armature",
    "tendon_springyield",
    "tendon_actfrcrange",
    "actuator_delay",
    "actuator_damping",
    "actuator_dampingpoly",
    "actuator_armature",
    "sensor_delay",
    "sensor_interval",
    "body_margin",
    "actuator_acc0",
    "actuator_lengthrange",
];

/// Returns a mechanism with attributes of the first joint, the first geom, the second body and the
/// options, and with elements.
fn mechanism(option: &str, [joint, geom, body]: [&str; 3], tendons: &str, actuators: &str, rest: &str) -> String {
    format!(
        r#"<mujoco><option timestep="0.004" gravity="0.4 0.2 -3" {option}
             <worldbody>
               <geom name="floor" type="plane" size="3 3 .1" friction="0.6 0.02 0.01" euler="1 2 0"/><site name="w" pos="0.1 0 1"/>
               <body name="a" pos="0 0 0.5"><joint name="j" axis="0 1 0.2" {joint}/>
                 <geom name="g" type="capsule" size=".05" fromto="0 0 0 .3 0 0" mass="1" {geom}/><site name="s" pos=".3 0 0"/>
                 <body name="b" pos=".3 0 0" {body}><joint name="k" type="slide" axis="1 0 1" damping="0.3" stiffness="2"/>
                   <geom name="q" size=".1" mass="1"/><site name="t" pos="0 .1 .1"/>
                   <body name="c" pos="0 .2 0"><joint type="ball" name="l" damping="0.1"/><geom type="box" size=".05 .06 .07" mass="0.5"/>
                     <site name="u" pos="0 .1 .1"/></body>
                 </body>
               </body>
               <body name="ball" pos="1 0 .095"><freejoint/><geom name="bg" size=".1" condim="4" {geom}/></body>
             </worldbody>
             <tendon>{tendons}</tendon><actuator>{actuators}</actuator>{rest}</mujoco>"#
    )
}

/// 2.2.2 has no damping of position servos.
const MOTOR: &str = if cfg!(engine_since = "3.5.0") {
    r#"<motor name="m" joint="j" gear="2"/><position joint="k" kp="8" kv="0.5"/>"#
} else {
    r#"<motor name="m" joint="j" gear="2"/><position joint="k" kp="8"/>"#
};
const SPATIAL: &str = r#"<spatial name="x" TE stiffness="3" damping="0.4"><site site="w"/><site site="t"/></spatial>"#;
const FIXED: &str =
    r#"<fixed name="x" TE stiffness="3" damping="0.4"><joint joint="j" coef="2"/><joint joint="k" coef="-1"/></fixed>"#;

/// Attributes of the hinge.
#[rustfmt::skip]
const JOINTS: [&str; 8] = [
    r#"damping="0.5""#,
    r#"damping="3 2 1""#,
    r#"stiffness="3 2 1" springref="10""#,
    r#"actuatorfrcrange="-.1 .1""#,
    r#"actuatorgravcomp="true""#,
    r#"springyield="0.01" stiffness="5""#,
    r#"range="-5 5" limited="true" margin="0.02""#,
    r#"frictionloss="0.2" armature="0.1""#,
];

/// Attributes of geoms.
#[rustfmt::skip]
const GEOMS: [&str; 6] = [
    r#"surfacevel="0.3 0.1 0 0 0 0.5""#,
    r#"adhesion="2""#,
    r#"fluidshape="ellipsoid""#,
    r#"margin="0.01" gap="0.005""#,
    r#"solref="-500 -20""#,
    r#"priority="1" solmix="0.3""#,
];

/// Actuators.
#[rustfmt::skip]
const ACTUATORS: [&str; 26] = [
    r#"<general joint="j" gaintype="affine" gainprm="2 0.5 -3" ctrlrange="-.2 .2" ctrllimited="true"/>"#,
    r#"<motor joint="j" damping=".5" gear="2"/>"#,
    r#"<motor joint="j" damping=".5 .3 .2" gear="2"/>"#,
    r#"<motor joint="j" armature=".5" gear="2"/>"#,
    r#"<motor tendon="x" armature="2"/>"#,
    r#"<motor tendon="x" damping="2"/>"#,
    r#"<position tendon="x" kp="20" kv="1"/>"#,
    r#"<general joint="j" dyntype="filterexact" dynprm="0.05" gainprm="3" actlimited="true" actrange="-1 1"/>"#,
    r#"<general joint="j" dyntype="filter" dynprm="0.05" gainprm="3" actearly="true"/>"#,
    r#"<general joint="j" dyntype="integrator" biastype="affine" biasprm="0 -3 -0.4" gainprm="3" actearly="true" actlimited="true" actrange="-1 1"/>"#,
    r#"<intvelocity joint="j" kp="5" actrange="-1 1"/>"#,
    r#"<dcmotor joint="j" resistance="2" motorconst="0.5 0.5" inductance="0.1"/>"#,
    r#"<dcmotor joint="j" resistance="2" motorconst="0.5 0.5"/>"#,
    r#"<pid joint="j" kp="5" kv="0.5" ki="2" imax="1" input="pos"/>"#,
    r#"<pid joint="j" kp="5" kv="0.5"/>"#,
    r#"<position joint="j" kp="5" dampratio="1"/>"#,
    r#"<position joint="j" kp="5" kv="1" timeconst="0.1"/>"#,
    r#"<position joint="l" kp="5" gear="1 0 0 0 0 0"/>"#,
    r#"<motor joint="j" delay="0.01" nsample="4"/>"#,
    r#"<motor site="u" gear="1 0.3 0 0.2 0 0.1"/><motor site="t" refsite="w" gear="1 0 0 0 0.2 0"/>"#,
    r#"<position site="t" refsite="w" gear="0 1 0 0 0.2 0" kp="4"/>"#,
    r#"<adhesion body="ball" gain="3" ctrlrange="0 1"/>"#,
    r#"<damper joint="j" kv="2" ctrlrange="0 1"/>"#,
    r#"<cylinder joint="k" timeconst="0.05" area="0.3" bias="0.1 -1 -0.2"/>"#,
    r#"<motor joint="j" group="2"/><motor joint="k" group="1"/>"#,
    r#"<motor joint="j" forcerange="-0.1 0.1" forcelimited="true"/><velocity joint="k" kv="3" ctrlrange="-.3 .3" ctrllimited="true"/>"#,
];

/// Attributes of tendons.
#[rustfmt::skip]
const TENDONS: [&str; 9] = [
    r#"damping="-0.4""#,
    r#"armature="0.5""#,
    r#"actuatorfrcrange="-.1 .1""#,
    r#"stiffness="3 2 1""#,
    r#"damping="3 2 1""#,
    r#"springyield="0.01""#,
    r#"limited="true" range="0.1 0.3" margin="0.1""#,
    r#"frictionloss="0.4""#,
    r#"springlength="0.2 0.4""#,
];

/// Flags of the options.
#[rustfmt::skip]
const FLAGS: [&str; 28] = [
    r#"eulerdamp="disable""#,
    r#"spring="disable""#,
    r#"damper="disable""#,
    r#"spring="disable" damper="disable""#,
    r#"passive="disable""#,
    r#"actuation="disable""#,
    r#"clampctrl="disable""#,
    r#"gravity="disable""#,
    r#"limit="disable""#,
    r#"contact="disable""#,
    r#"constraint="disable""#,
    r#"frictionloss="disable""#,
    r#"refsafe="disable""#,
    r#"sensor="disable""#,
    r#"autoreset="disable""#,
    r#"nativeccd="disable""#,
    r#"multiccd="disable""#,
    r#"island="disable""#,
    r#"midphase="disable""#,
    r#"warmstart="disable""#,
    r#"filterparent="disable""#,
    r#"override="enable""#,
    r#"energy="enable""#,
    r#"fwdinv="enable""#,
    r#"invdiscrete="enable""#,
    r#"diagexact="enable""#,
    r#"speculative="enable""#,
    r#"multiccd="enable""#,
];

/// Contacts, equality constraints and sensors.
#[rustfmt::skip]
const ELEMENTS: [&str; 20] = [
    r#"<contact><pair geom1="floor" geom2="bg" solreffriction="0.05 1" adhesion="1"/></contact>"#,
    r#"<contact><pair geom1="floor" geom2="bg" solreffriction="0.05 1"/></contact>"#,
    r#"<equality><connect site1="u" site2="w"/></equality>"#,
    r#"<equality><weld site1="u" site2="w" solref="0.1 1"/></equality>"#,
    r#"<equality><connect body1="c" anchor="0.1 0 0"/></equality>"#,
    r#"<equality><weld body1="c" body2="ball" torquescale="0.5" relpose="0 0.1 0 1 0.1 0 0"/></equality>"#,
    r#"<equality><joint joint1="j" joint2="k" polycoef="0.1 0.5 0.2 0.1 0"/></equality>"#,
    r#"<equality><tendon tendon1="x" polycoef="0.1 0.5 0.2 0.1 0"/></equality>"#,
    r#"<sensor><rangefinder site="u" data="depth"/><rangefinder site="t"/></sensor>"#,
    r#"<sensor><rangefinder site="u" data="dist point normal"/></sensor>"#,
    r#"<sensor><jointactuatorfrc joint="j"/></sensor>"#,
    r#"<sensor><tendonactuatorfrc tendon="x"/></sensor>"#,
    r#"<sensor><contact geom1="floor" geom2="bg" data="found force dist"/></sensor>"#,
    r#"<tendon><fixed stiffness="3" damping="0.2" limited="true" range="-.1 .1"><joint joint="l" coef="1"/><joint joint="k" coef=".3"/></fixed></tendon>"#,
    r#"<tendon><fixed name="f"><joint joint="l" coef="1"/></fixed></tendon><actuator><position tendon="f" kp="4"/></actuator><sensor><tendonpos tendon="f"/></sensor>"#,
    "<sensor><e_kinetic/></sensor>",
    "<sensor><e_potential/></sensor>",
    r#"<sensor><distance geom1="bg" geom2="g" cutoff="3"/><normal geom1="bg" geom2="g" cutoff="3"/><fromto geom1="bg" geom2="g" cutoff="3"/></sensor>"#,
    r#"<sensor><insidesite site="w" objtype="geom" objname="bg"/></sensor>"#,
    r#"<sensor><gyro site="u" cutoff="0.3"/><accelerometer site="u" cutoff="2"/><actuatorfrc actuator="m" cutoff="0.1"/></sensor>"#,
];

const LIMITED: &str = r#"limited="true" range="-0.1 0.1""#;

/// Returns the models, of which the engine may not know all attributes.
pub(super) fn features() -> Vec<(String, String)> {
    let mut models = Vec::new();
    let integrators: &[&str] =
        &["", r#"integrator="implicit""#, r#"integrator="implicitfast""#, r#"integrator="discrete""#];
    for integrator in integrators {
        let mut add = |what: &str, xml: String| models.push((format!("{what} {integrator}"), xml));
        let option = |more: &str| format!("{integrator} {more}/>");
        let plain = ["", "", ""];
        for joint in JOINTS {
            add(joint, mechanism(&option(""), [joint, "", r#"gravcomp="0.7""#], "", MOTOR, ""));
            add(joint, mechanism(&option(""), [joint, "", ""], "", MOTOR, ""));
        }
        for geom in GEOMS {
            add(geom, mechanism(&option(r#"density="80" viscosity="0.3""#), ["", geom, ""], "", MOTOR, ""));
        }
        for actuators in ACTUATORS {
            for (tendon, te) in [(SPATIAL, ""), (FIXED, "")] {
                if tendon == FIXED && !actuators.contains("tendon=") {
                    continue;
                }
                add(actuators, mechanism(&option(""), plain, &tendon.replace("TE", te), actuators, ""));
            }
            if actuators.contains("group=") {
                let groups = option(r#"actuatorgroupdisable="2""#);
                add(&format!("disabled {actuators}"), mechanism(&groups, plain, "", actuators, ""));
            }
        }
        for te in TENDONS {
            for tendon in [SPATIAL, FIXED] {
                let text = te.split('=').next().unwrap();
                let own = if text == "stiffness" { r#"stiffness="3""# } else { r#"damping="0.4""# };
                let tendon =
                    if ["stiffness", "damping"].contains(&text) { tendon.replace(own, "") } else { tendon.to_owned() };
                let servo = if cfg!(engine_since = "3.5.0") { r#"kp="20" kv="1""# } else { r#"kp="20""# };
                let actuators = format!(r#"<position tendon="x" {servo}/><motor joint="j"/>"#);
                add(te, mechanism(&option(""), plain, &tendon.replace("TE", te), &actuators, ""));
            }
        }
        for flag in FLAGS {
            let flagged = format!("{integrator}><flag {flag}/></option>");
            let joint = r#"damping="0.7" stiffness="4" springref="10" range="-5 5" limited="true" frictionloss="0.1""#;
            let actuators = format!(
                r#"{MOTOR}<motor joint="k" ctrllimited="true" ctrlrange="-.2 .2"/><general joint="j" dyntype="filter" dynprm="0.1"/>"#
            );
            add(flag, mechanism(&flagged, [joint, "", ""], &FIXED.replace("TE", LIMITED), &actuators, &sensors()));
        }
        for rest in ELEMENTS {
            let actuators = r#"<motor name="m" joint="j"/><motor tendon="x"/>"#;
            add(rest, mechanism(&option(""), plain, &SPATIAL.replace("TE", ""), actuators, rest));
            if rest.starts_with("<equality>") {
                // Forces of constraints between bodies in sensors.
                let rest = format!("{rest}{}", sensors());
                let [joint, geom] = [r#"limited="true" range="-5 5""#, r#"margin="0.02""#];
                let tendon = FIXED.replace("TE", r#"limited="true" range="-0.1 0.1""#);
                add(
                    &format!("sensors and {rest}"),
                    mechanism(&option(""), [joint, geom, ""], &tendon, actuators, &rest),
                );
            }
            let elliptic = option(r#"cone="elliptic" impratio="2" jacobian="sparse""#);
            add(&format!("elliptic {rest}"), mechanism(&elliptic, plain, &FIXED.replace("TE", ""), actuators, rest));
        }
    }
    models
}

fn sensors() -> String {
    let mut text = String::from("<sensor>");
    for kind in ["accelerometer", "velocimeter", "gyro", "force", "torque", "magnetometer", "touch", "rangefinder"] {
        write!(text, r#"<{kind} site="u"/>"#).unwrap();
    }
    for kind in ["framepos", "framequat", "framexaxis", "framelinvel", "frameangvel", "framelinacc", "frameangacc"] {
        write!(text, r#"<{kind} objtype="body" objname="b"/>"#).unwrap();
    }
    for kind in ["framepos", "framequat", "framexaxis", "framelinvel", "frameangvel"] {
        write!(text, r#"<{kind} objtype="site" objname="u" reftype="body" refname="a"/>"#).unwrap();
        write!(text, r#"<{kind} objtype="xbody" objname="ball" reftype="geom" refname="g"/>"#).unwrap();
    }
    for kind in ["tendonlimitpos", "tendonlimitvel", "tendonlimitfrc"] {
        write!(text, r#"<{kind} tendon="x"/>"#).unwrap();
    }
    for kind in ["jointpos", "jointvel", "jointlimitpos", "jointlimitvel", "jointlimitfrc"] {
        write!(text, r#"<{kind} joint="j"/>"#).unwrap();
    }
    for kind in ["tendonpos", "tendonvel"] {
        write!(text, r#"<{kind} tendon="x"/>"#).unwrap();
    }
    for kind in ["actuatorpos", "actuatorvel", "actuatorfrc"] {
        write!(text, r#"<{kind} actuator="m"/>"#).unwrap();
    }
    text += r#"<ballquat joint="l"/><ballangvel joint="l"/><subtreecom body="a"/><subtreelinvel body="a"/><subtreeangmom body="a"/><clock/>"#;
    text + "</sensor>"
}

/// Returns models with the elements of 2.2.2: at rest on the floor, and with tendons and actuators.
pub(super) fn bases() -> Vec<String> {
    let actuators = r#"<motor name="m" joint="j" gear="2"/><position joint="k" kp="5"/><motor tendon="x"/>
        <motor site="u" gear="1 0.3 0 0.2 0 0.1"/><general joint="j" dyntype="filter" dynprm="0.1" gaintype="affine" gainprm="2 0.5 0.3"
        biastype="affine" biasprm="0.1 -3 -0.4"/><muscle tendon="x" lengthrange="0.1 2"/>"#;
    let joint = r#"damping="0.7" stiffness="4" springref="10" range="-5 5" limited="true" frictionloss="0.1""#;
    let rest = format!(
        r#"<contact><pair geom1="q" geom2="bg" margin="1.5"/></contact>
           <equality><joint joint1="j" joint2="k" polycoef="0.1 0.5 0.2 0.1 0"/></equality>{}"#,
        sensors()
    );
    let euler =
        mechanism("/>", [joint, "", ""], &SPATIAL.replace("TE", r#"limited="true" range="0.1 0.9""#), actuators, &rest);
    let motors = r#"<motor name="m" joint="j" gear="2"/><position joint="k" kp="5"/><general tendon="x" gaintype="affine"
        gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/>"#;
    let tendon = FIXED.replace("TE", r#"limited="true" range="-0.01 0.01" frictionloss="0.1""#);
    let implicit = mechanism(
        r#"integrator="implicit" cone="elliptic"/>"#,
        [joint, "", ""],
        &tendon,
        motors,
        &rest.replace(r#"margin="1.5""#, ""),
    );
    vec![euler, implicit]
}

/// Features that were silently wrong: with the implicit integrators controls beyond their range and
/// negative damping of tendons, and limits of actuator forces and sensors that depend on controls;
/// by the implicit method damping of higher order, damping and armature of actuators; fixed tendons
/// at ball joints; with the discrete integrator inverse dynamics.
///
/// Each with whether the linked engine must load models of it.
const REGRESSIONS: [(&str, bool); 12] = [
    (r#"<general joint="j" gaintype="affine""#, true),
    (r#"damping="-0.4""#, true),
    ("<tendon><fixed ", cfg!(not(engine_since = "4.0.0"))),
    (r#"actuatorfrcrange="-.1 .1""#, cfg!(engine_since = "3.5.0")),
    ("<sensor><jointactuatorfrc", cfg!(engine_since = "3.5.0")),
    ("<sensor><tendonactuatorfrc", cfg!(engine_since = "3.5.0")),
    (r#"damping="3 2 1""#, cfg!(engine_since = "3.17.0")),
    (r#"<motor joint="j" damping"#, cfg!(engine_since = "3.17.0")),
    (r#"<motor joint="j" armature"#, cfg!(engine_since = "3.17.0")),
    (r#"<motor tendon="x" "#, cfg!(engine_since = "3.17.0")),
    (r#"damping="0.5" integrator="discrete""#, cfg!(engine_since = "3.17.0")),
    ("<sensor><rangefinder", cfg!(engine_since = "3.5.0")),
];

fn compare_features(states: usize, only: impl Fn(usize, &str) -> bool) -> Tally {
    let (mut total, mut unknown) = (Tally::default(), Vec::new());
    // Names of the loaded models, and how many entries agree with differences, and do not.
    let mut loaded: Vec<(String, [usize; 2])> = Vec::new();
    for (seed, (what, xml)) in features().into_iter().enumerate().filter(|(seed, (what, _))| only(*seed, what)) {
        let model = match Model::from_xml_str(&xml) {
            Ok(model) => model,
            Err(error) => {
                unknown.push(format!("{what}: {}", error.to_string().replace('\n', " ")));
                continue;
            }
        };
        let mut tally = Tally::default();
        compare_model(model, seed as u64, states, &mut tally);
        let unsure = tally.noisy + tally.reported;
        loaded.push((what.clone(), [tally.compared - tally.reported, unsure]));
        total.compared += tally.compared;
        total.noisy += tally.noisy;
        total.reported += tally.reported;
        total.failures.extend(tally.failures.iter().map(|failure| format!("{what}: {failure}")));
    }
    println!(
        "MuJoCo {}: {} entries compared, {} noisy, {} reported, {} models unknown, {} blocks wrong",
        built_against(),
        total.compared,
        total.noisy,
        total.reported,
        unknown.len(),
        total.failures.len()
    );
    for unknown in unknown {
        println!("    {unknown}");
    }
    for (feature, loads) in REGRESSIONS {
        let models = loaded.iter().filter(|(what, _)| what.starts_with(feature));
        let [agree, unsure] = models.clone().fold([0, 0], |sum, (_, of)| [sum[0] + of[0], sum[1] + of[1]]);
        println!(
            "    {feature}: {} models, {agree} entries agree, {unsure} are noisy or at kinks",
            models.clone().count()
        );
        assert_eq!(models.clone().next().is_some(), loads, "{feature}");
        assert!(!loads || agree > 20 * unsure, "{feature}: {agree} entries agree, {unsure} are noisy or at kinks");
    }
    total
}

/// `STATES=5 cargo test --release --test linearisation -- --ignored --nocapture
/// each_feature_is_linearised`
#[test]
#[ignore = "a campaign"]
fn each_feature_is_linearised() {
    let states = std::env::var("STATES").map_or(5, |text| text.parse().expect("STATES is a number"));
    let total = compare_features(states, |_, _| true);
    assert!(total.failures.is_empty(), "{:#?}", total.failures);
}

#[test]
fn features_of_newer_engines_are_linearised() {
    // Some of the models, and those that other versions of this library got wrong.
    let total = compare_features(1, |number, what| {
        number % cases(30, 5) == 0 || REGRESSIONS.iter().any(|(known, _)| what.starts_with(known))
    });
    assert!(total.failures.is_empty(), "{:#?}", total.failures);
}
