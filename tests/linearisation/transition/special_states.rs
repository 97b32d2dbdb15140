//! Special states (rest, controls that equal activations, ends of ranges, saturation, contacts that
//! touch, disabled stages) by each method, integrator and cone, against differences of `mj_step` to
//! the right and to the left.
//!
//! An entry must be between the derivatives of the two sides. If they differ, the report names a
//! kink.

use std::fmt::Write as _;

use mujoco_safe::derivative::{Kinks, TransitionMethod, TransitionOptions};
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Data, Error, Lineariser, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::oracle::Oracle;
use crate::cases::cases;

/// Largest deviation from the derivatives of the sides, relative to the largest entry of a column.
const TOLERANCE: f64 = 2e-4;

/// The same for differences of steps, which have an error of truncation. It is proportional to the
/// step where the curvature of the two sides differs, such as 5e-4 for a box on the floor with the
/// step 1e-6.
const TOLERANCE_OF_STEPS: f64 = 1e-3;

/// Integrators, of which 2.2.2 lacks the last.
const INTEGRATORS: [&str; 4] = ["Euler", "implicit", "RK4", "implicitfast"];

const ACTUATORS: [&str; 10] = [
    r#"<motor joint="j" ctrllimited="true" ctrlrange="-0.5 0.5"/>"#,
    r#"<motor joint="s" gear="4" forcelimited="true" forcerange="-1 1"/>"#,
    r#"<position joint="j" kp="4" ctrllimited="true" ctrlrange="-0.5 0.5" forcelimited="true" forcerange="-2 2"/>"#,
    r#"<velocity joint="s" kv="3"/>"#,
    r#"<general joint="j" dyntype="integrator" gainprm="3" actlimited="true" actrange="-0.5 0.5"/>"#,
    r#"<general joint="s" dyntype="filter" dynprm="0.03" gainprm="2" actlimited="true" actrange="-0.5 0.5"/>"#,
    r#"<general tendon="t" dyntype="filter" dynprm="0.1" biastype="affine" biasprm="0.1 -2 -0.3"/>"#,
    r#"<muscle joint="j" lengthrange="-1 1" force="20"/>"#,
    r#"<muscle joint="s" lengthrange="-0.4 0.3" force="30" ctrllimited="true" ctrlrange="0 1"/>"#,
    r#"<muscle tendon="t" lengthrange="-1 1" force="10" timeconst="0.02 0.05"/>"#,
];

/// Values of controls and activations: rest, ends of ranges, saturation and ordinary ones.
const INPUTS: [f64; 8] = [0.0, 0.5, -0.5, 1.0, 0.3, -0.2, 1.7, 0.25];

const FLAGS: [DisableFlags; 7] = [
    DisableFlags::LIMIT,
    DisableFlags::CLAMPCTRL,
    DisableFlags::CONTACT,
    DisableFlags::ACTUATION,
    DisableFlags::GRAVITY,
    DisableFlags::FRICTIONLOSS,
    DisableFlags::CONSTRAINT,
];

fn one_of<T: Copy>(random: &mut Xoshiro256PlusPlus, values: &[T]) -> T {
    values[random.random_range(0..values.len())]
}

/// Returns a random model, in a special state.
fn special(random: &mut Xoshiro256PlusPlus) -> (String, Data) {
    let integrators = if cfg!(engine_since = "3.5.0") { &INTEGRATORS[..] } else { &INTEGRATORS[..3] };
    let (integrator, cone) = (one_of(random, integrators), one_of(random, &["pyramidal", "elliptic"]));
    let (gravity, margin) = (one_of(random, &["0 0 -9.81", "0 0 0"]), one_of(random, &["0", "0.1"]));
    let medium = one_of(random, &["", r#"density="50" viscosity="0.3""#]);
    // The engine wants those without activations first.
    let mut chosen: Vec<usize> =
        (0..random.random_range(1..4)).map(|_| random.random_range(0..ACTUATORS.len())).collect();
    chosen.sort_unstable();
    let actuators: String = chosen.iter().map(|&index| ACTUATORS[index]).collect();
    let mut xml = String::new();
    write!(
        xml,
        r#"<mujoco>
             <compiler angle="radian"/>
             <option timestep="0.004" integrator="{integrator}" cone="{cone}" gravity="{gravity}" {medium}/>
             <worldbody>
               <geom name="floor" type="plane" size="5 5 1" margin="{margin}"/>
               <body pos="0 0 2">
                 <joint name="j" axis="0 1 0" limited="true" range="-0.5 0.5" margin="{margin}" damping="0.2" frictionloss="0.05"/>
                 <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.04" contype="0" conaffinity="0"/>
                 <body pos="0.3 0 0">
                   <joint name="s" type="slide" axis="1 0 0.2" limited="true" range="-0.25 0.25"/>
                   <geom size="0.05" contype="0" conaffinity="0"/><site name="tip"/>
                 </body>
               </body>
               <body pos="1 0 0.5"><joint name="z" type="slide" axis="0 0 1"/><joint name="x" type="slide" axis="1 0 0"/><geom name="ball" size="0.25" mass="2"/></body>
             </worldbody>
             <tendon><fixed name="t" limited="true" range="-0.8 0.8"><joint joint="j" coef="1"/><joint joint="s" coef="-1.2"/></fixed></tendon>
             <actuator>{actuators}</actuator>
             <sensor><jointpos joint="j" cutoff="0.5"/><jointvel joint="s"/><actuatorfrc actuator="first"/><actuatorvel actuator="first"/>
               <framepos objtype="site" objname="tip"/><accelerometer site="tip"/><jointlimitpos joint="j"/><tendonpos tendon="t"/></sensor>
           </mujoco>"#
    )
    .unwrap();
    let xml = name_first_actuator(&xml);
    let mut data = Data::new(Model::from_xml_str(&xml).unwrap_or_else(|error| panic!("{error}: {xml}"))).unwrap();
    if random.random_bool(0.3) {
        let flag = one_of(random, &FLAGS);
        data.edit_model(|model| model.edit_options(|options| options.disable |= flag)).unwrap();
    }
    let height: f64 = if margin == "0" { -0.25 } else { -0.15 };
    let positions = [
        one_of(random, &[0.0, 0.5, -0.5, 0.4, -0.4, 0.2, 0.6]),
        one_of(random, &[0.0, 0.25, -0.25, 0.1, -0.3]),
        one_of(random, &[0.0, height, -0.26, -0.2]),
        0.0,
    ];
    data.qpos_mut().copy_from_slice(&positions);
    if random.random_bool(0.4) {
        data.qvel_mut().iter_mut().for_each(|value| *value = random.random_range(-1.0..1.0));
    }
    data.ctrl_mut().iter_mut().for_each(|value| *value = one_of(random, &INPUTS));
    let model = data.model().clone();
    for (control, actuator) in model.actuators().enumerate() {
        let Some(activation) = actuator.activation() else { continue };
        let steady = random.random_bool(0.5);
        data.act_mut()[activation] = if steady { data.ctrl()[control] } else { one_of(random, &INPUTS) };
    }
    (xml, data)
}

/// Gives the first actuator a name.
fn name_first_actuator(xml: &str) -> String {
    let start = xml.find("<actuator>").unwrap() + "<actuator><".len();
    let end = start + xml[start..].find(' ').unwrap();
    format!("{} name=\"first\"{}", &xml[..end], &xml[end..])
}

/// Counts of entries.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) compared: usize,
    with_kink: usize,
    pub(crate) noisy: usize,
    /// Entries of systems whose report states that some entries are not derivatives.
    without_derivative: usize,
    pub(crate) failures: Vec<String>,
}

pub(crate) fn compare(what: &str, data: &mut Data, tally: &mut Tally) {
    let mut systems = Vec::new();
    for method in [TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic] {
        let options = TransitionOptions::default().with_method(method);
        let (system, report) = match Lineariser::new(data.model(), options).unwrap().linear_system(data) {
            // A model with delays, or a state that is unstable.
            Err(Error::Unsupported(_) | Error::Unstable(_)) => return,
            result => result.unwrap(),
        };
        systems.push((method, system, report));
    }
    let mut oracle = Oracle::new(data);
    let base = oracle.base();
    let nx = systems[0].1.a.ncols();
    for index in 0..nx + systems[0].1.b.ncols() {
        let sides = [1.0, -1.0].map(|side| oracle.one_sided(index, side, &base));
        let largest = |side: &[(f64, f64)]| side.iter().fold(0.0, |largest: f64, (value, _)| largest.max(value.abs()));
        let scale = largest(&sides[0]).max(largest(&sides[1]));
        for (method, system, report) in &systems {
            for (row, (&(right, right_error), &(left, left_error))) in sides[0].iter().zip(&sides[1]).enumerate() {
                let value = match (row < nx, index < nx) {
                    (true, true) => system.a[(row, index)],
                    (true, false) => system.b[(row, index - nx)],
                    (false, true) => system.c[(row - nx, index)],
                    (false, false) => system.d[(row - nx, index - nx)],
                };
                let noise = right_error + left_error;
                if noise > 1e-3 * scale {
                    tally.noisy += 1;
                    continue;
                }
                tally.compared += 1;
                let is_step = report.method == TransitionMethod::Columns;
                let relative = if is_step { TOLERANCE_OF_STEPS } else { TOLERANCE };
                let tolerance = relative * scale + 10.0 * noise + 1e-7;
                let is_between = right.min(left) - tolerance <= value && value <= right.max(left) + tolerance;
                // The report is silent about a small kink, such as that of the implicit integrator
                // with the drag of a body at rest.
                let has_kink = (right - left).abs() > 10.0 * tolerance + 0.03 * right.abs().max(left.abs());
                tally.with_kink += usize::from(has_kink);
                let is_named = !has_kink || report.kinks != Kinks::empty();
                // A step that jumps, as at a limit that a joint reaches in motion, or with several
                // new constraints, has no derivative.
                if report.kinks.intersects(Kinks::DIFFERENCES | Kinks::CONSTRAINTS) {
                    tally.without_derivative += 1;
                    continue;
                }
                if !is_between || !is_named {
                    tally.failures.push(format!(
                        "{method:?} [{row}, {index}] is {value:e} instead of {right:e} to {left:e}, {report:?}: {what}"
                    ));
                }
            }
        }
    }
}

fn campaign(seeds: std::ops::Range<u64>) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let (xml, mut data) = special(&mut random);
        if data.clone().step().is_err() {
            continue;
        }
        let state = format!(
            "seed {seed}, disabled {:?}, qpos {:?} qvel {:?} ctrl {:?} act {:?} {xml}",
            data.model().options().disable,
            data.qpos(),
            data.qvel(),
            data.ctrl(),
            data.act()
        );
        compare(&state, &mut data, &mut tally);
    }
    tally
}

#[test]
fn special_states_have_a_derivative_of_a_side() {
    let tally = campaign(0..cases(5, 12));
    assert!(
        tally.failures.is_empty(),
        "{} failures: {:#?}",
        tally.failures.len(),
        &tally.failures[..tally.failures.len().min(30)]
    );
    assert!(
        tally.compared > cases(1000, 4000) && tally.with_kink > cases(4, 20) && tally.noisy * 5 < tally.compared,
        "{tally:?}"
    );
}

/// Set `SEEDS` for another number of states.
#[test]
#[ignore = "minutes: 200,000 entries"]
fn many_special_states_have_a_derivative_of_a_side() {
    let seeds = std::env::var("SEEDS").map_or(400, |text| text.parse().unwrap());
    let tally = campaign(1000..1000 + seeds);
    println!(
        "{} entries, {} at kinks, {} noisy, {} failures",
        tally.compared,
        tally.with_kink,
        tally.noisy,
        tally.failures.len()
    );
    assert!(tally.failures.is_empty(), "{:#?}", &tally.failures[..tally.failures.len().min(20)]);
}
