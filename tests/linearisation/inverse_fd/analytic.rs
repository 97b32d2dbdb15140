//! Derivatives of inverse dynamics in closed form, one term at a time: against extrapolated
//! differences of the engine's `mj_inverse`.

use mujoco_safe::derivative::{
    DifferencedTerms, Fallback, InverseForce, InverseJacobians, InverseOutputs, LinearisationReport, TransitionMethod,
    TransitionOptions,
};
use mujoco_safe::{Data, Lineariser, Matrix, Model, StateSpec, sample, sys};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::oracle::Oracle;
use super::{EPS, computed_alone, subjects};
use crate::transition::analytic::{
    OPTIONS, constraints, contacts, model, random_models, randomise, sensors, smooth, tendons,
};
use crate::transition::features::{chain, moving};

const FORCES: [InverseForce; 2] = [InverseForce::Total, InverseForce::WithoutActuators];

/// Largest deviation, relative to the largest number of a matrix or of the columns of a sensor.
const TOLERANCE: f64 = 1e-7;

/// Steps of the differences. The smaller ones avoid kinks, the larger ones suit stiff constraints.
const WIDTHS: [f64; 6] = [2e-5, 2e-6, 2e-4, 2e-7, 2e-3, 2e-8];

/// Ratio of the steps of accelerations, which have large values, to those of the state.
const ACCELERATION_FACTOR: f64 = 1e2;

fn analytic(data: &mut Data, force: InverseForce) -> (InverseJacobians, LinearisationReport) {
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    lineariser.inverse_jacobians(data, force).unwrap()
}

/// Returns the matrices with their names and the ranges of columns that are compared with their
/// largest number.
fn parts<'a>(model: &Model, jacobians: &'a InverseJacobians) -> Vec<(String, &'a Matrix, std::ops::Range<usize>)> {
    let InverseJacobians { df_dq, df_dv, df_da, ds_dq, ds_dv, ds_da, dm_dq } = jacobians;
    let whole = [("DfDq", df_dq), ("DfDv", df_dv), ("DfDa", df_da), ("DmDq", dm_dq)];
    let mut parts: Vec<_> =
        whole.into_iter().map(|(name, matrix)| (name.to_owned(), matrix, 0..matrix.ncols())).collect();
    for (name, matrix) in [("DsDq", ds_dq), ("DsDv", ds_dv), ("DsDa", ds_da)] {
        for sensor in 0..model.nsensor() {
            let first = model.sensor_adr()[sensor] as usize;
            let columns = first..first + model.sensor_dim()[sensor] as usize;
            parts.push((format!("{name} of sensor {sensor} of type {}", model.sensor_type()[sensor]), matrix, columns));
        }
    }
    parts
}

/// Number below which the rounding of the differences is not small any more.
const SMALL: f64 = 1e-3;

/// Returns the largest deviation of some columns, relative to their largest number.
fn error(ours: &Matrix, theirs: &Matrix, columns: std::ops::Range<usize>) -> f64 {
    let entries = |matrix: &Matrix| -> Vec<f64> {
        (0..matrix.nrows()).flat_map(|row| matrix.row(row)[columns.clone()].to_vec()).collect()
    };
    let (ours, theirs) = (entries(ours), entries(theirs));
    let largest = theirs.iter().fold(SMALL, |largest: f64, value| largest.max(value.abs()));
    let worst = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).max_by(f64::total_cmp).unwrap_or(0.0);
    worst / largest
}

/// Compares all outputs with the differences, and checks that the method did not fall back to
/// another. Returns the differenced terms.
#[track_caller]
fn check_force(what: &str, data: &mut Data, force: InverseForce) -> DifferencedTerms {
    let (ours, report) = analytic(data, force);
    assert_eq!((report.method, report.fallback), (TransitionMethod::Analytic, None), "{what}, {force:?}");
    let model = data.model().clone();
    let mut oracle = Oracle::new(data, force);
    let mut least: Vec<f64> = parts(&model, &ours).iter().map(|_| f64::INFINITY).collect();
    for width in WIDTHS {
        let truth = oracle.jacobians(width, ACCELERATION_FACTOR * width);
        for ((least, (_, ours, columns)), (_, theirs, _)) in
            least.iter_mut().zip(parts(&model, &ours)).zip(parts(&model, &truth))
        {
            *least = least.min(error(ours, theirs, columns));
        }
        if least.iter().all(|&error| error <= TOLERANCE) {
            return report.differenced;
        }
    }
    for ((name, ..), error) in parts(&model, &ours).iter().zip(least) {
        assert!(error <= TOLERANCE, "{what}, {force:?}: {name} deviates by {error:.1e}");
    }
    report.differenced
}

#[track_caller]
fn check(what: &str, data: &mut Data) -> DifferencedTerms {
    FORCES.map(|force| check_force(what, data, force))[0]
}

/// Sets random accelerations.
fn accelerate(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    data.qacc_mut().iter_mut().for_each(|qacc| *qacc = random.random_range(-10.0..10.0));
}

/// Compares random states of a model.
#[track_caller]
fn check_states(what: &str, xml: &str, seed: u64, states: usize) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut data = model(xml);
    for state in 0..states {
        randomise(&mut data, &mut random);
        accelerate(&mut data, &mut random);
        check(&format!("{what}, state {state}"), &mut data);
    }
}

#[test]
fn bodies_with_every_joint_agree_with_differences() {
    check_states("joints", &smooth::joints(""), 1, 10);
    let weightless = r#"<option><flag gravity="disable"/></option><worldbody>"#;
    check_states("without gravity", &smooth::joints("").replace("<worldbody>", weightless), 2, 2);
}

#[test]
fn passive_forces_agree_with_differences() {
    let joint = r#"<default><joint damping="0.7" stiffness="3" springref="10"/></default><worldbody>"#;
    check_states("springs and dampers", &smooth::joints("").replace("<worldbody>", joint), 3, 4);
    let medium = r#"<option density="900" viscosity="0.7" wind="1 0 0.3"/><worldbody>"#;
    check_states("a medium", &smooth::joints("").replace("<worldbody>", medium), 4, 4);
}

#[test]
fn actuators_count_only_in_the_force_without_them() {
    let actuators = r#"<actuator><motor joint="a" gear="2"/><position joint="b" kp="20"/>
        <general joint="c" gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/></actuator>"#;
    let site = r#"<velocity site="tip" kv="0.7" gear="1 2 3 0.1 0.2 0.3"/></actuator>"#;
    let actuators = actuators.replace("</actuator>", site);
    let mut data = moving(&chain("", "", r#"damping="0.1""#, &actuators), 5);
    check("actuators", &mut data);
    let [total, without] = FORCES.map(|force| analytic(&mut data, force).0);
    assert_ne!(total.df_dq, without.df_dq);
    assert_eq!((total.df_da, total.ds_da), (without.df_da, without.ds_da));
}

#[test]
fn tensions_of_actuators_count_only_in_the_force_without_them() {
    let rest = r#"<actuator><position tendon="to_world" kp="30"/><motor tendon="inside" gear="3"/></actuator>
                  <sensor><tendonvel tendon="to_world"/><actuatorvel actuator="0"/></sensor>"#
        .replace("<position", r#"<position name="0""#);
    let tendon = r#"stiffness="20" damping="2" limited="true" range="0 0.5" frictionloss="0.3""#;
    let xml = tendons::strings(tendon, &rest).replace(r#"<geom geom="palm"/>"#, "");
    for option in ["", r#"jacobian="sparse""#] {
        check_states(option, &xml.replace("OPTION", option), 5, 3);
    }
}

#[test]
fn constraints_of_each_cone_and_layout_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(6);
    for option in OPTIONS {
        let mut data = model(&constraints::constrained(option));
        for state in 0..4 {
            constraints::collide(&mut data, &mut random);
            accelerate(&mut data, &mut random);
            let differenced = check(&format!("{option}, state {state}"), &mut data);
            assert!(data.nefc() > 0);
            assert!((DifferencedTerms::CONTACTS).contains(differenced));
        }
    }
}

#[test]
fn sensors_with_a_formula_agree_with_differences() {
    let sensors = sensors::all_kinds();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    for option in ["", r#"cone="elliptic" jacobian="sparse""#] {
        let mut data = model(&sensors::machine(&sensors).replace("OPTION", option));
        for state in 0..4 {
            randomise(&mut data, &mut random);
            data.qpos_mut().iter_mut().for_each(|value| *value *= 0.5);
            data.qpos_mut()[2] = if state % 2 == 0 { -0.05 } else { 1.0 };
            accelerate(&mut data, &mut random);
            let differenced = check(&format!("{option}, state {state}"), &mut data);
            assert!(!differenced.contains(DifferencedTerms::SENSORS));
        }
    }
}

#[test]
fn random_states_of_the_samples_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(8);
    for sample in [sample::cartpole(), sample::humanoid()] {
        let mut data = Data::new(sample).unwrap();
        for state in 0..3 {
            constraints::collide(&mut data, &mut random);
            accelerate(&mut data, &mut random);
            check(&format!("{data:?}, state {state}"), &mut data);
        }
    }
}

#[test]
fn random_models_agree_with_differences() {
    for seed in 2000..2010 {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut data = model(&random_models::xml(seed));
        for state in 0..2 {
            randomise(&mut data, &mut random);
            accelerate(&mut data, &mut random);
            check(&format!("model {seed}, state {state}"), &mut data);
        }
    }
}

/// Compares with the forward differences of `inverse_fd` to the last bit, and checks the report.
#[track_caller]
fn assert_falls_back(data: &mut Data, options: TransitionOptions, force: InverseForce, reason: Option<Fallback>) {
    let differences = data.clone().inverse_fd(options.eps.unwrap_or(EPS), force).unwrap();
    let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
    let (jacobians, report) = lineariser.inverse_jacobians(data, force).unwrap();
    assert_eq!((report.method, report.fallback), (TransitionMethod::Engine, reason));
    assert!(report.differenced.is_empty());
    assert_eq!(jacobians, differences);
}

#[test]
fn terms_without_a_formula_are_differenced_with_the_reason() {
    let options = TransitionOptions::default();
    let medium = chain(r#"density="900""#, "", "", "").replace("<geom type", r#"<geom fluidshape="ellipsoid" type"#);
    assert_falls_back(&mut moving(&medium, 5), options, InverseForce::Total, Some(Fallback::Fluid));
    let adhesion = r#"<actuator><adhesion body="lower" ctrlrange="0 1"/></actuator>"#;
    let mut data = moving(&chain("", "", "", adhesion), 5);
    assert_falls_back(&mut data, options, InverseForce::WithoutActuators, Some(Fallback::Actuator));
    check_force("an actuator does not affect the total force", &mut data, InverseForce::Total);
    let mut data = contacts::without_formula();
    assert_falls_back(&mut data, options, InverseForce::Total, Some(Fallback::Constraint));
}

#[test]
fn other_methods_are_differences_with_the_given_step() {
    let mut data = subjects().nth(1).unwrap();
    for method in [TransitionMethod::Engine, TransitionMethod::Columns, TransitionMethod::Implicit] {
        let options = TransitionOptions::default().with_method(method).with_eps(3e-6);
        assert_falls_back(&mut data, options, InverseForce::Total, None);
    }
}

#[test]
fn the_integrator_and_the_noslip_solver_do_not_matter() {
    let mut data = moving(&chain("", "", r#"damping="0.1" frictionloss="0.2""#, ""), 5);
    let expected = analytic(&mut data, InverseForce::Total).0;
    for option in [r#"integrator="RK4""#, r#"integrator="implicit""#, r#"noslip_iterations="3""#] {
        let mut other = model(&chain(option, "", r#"damping="0.1" frictionloss="0.2""#, ""));
        other.set_state(StateSpec::FULL_PHYSICS, &data.state(StateSpec::FULL_PHYSICS)).unwrap();
        other.qacc_mut().copy_from_slice(data.qacc());
        let (found, report) = analytic(&mut other, InverseForce::Total);
        assert_eq!(report.fallback, None, "{option}");
        assert_eq!(found, expected, "{option}");
    }
}

#[test]
fn callbacks_are_called_on_the_simulation_itself() {
    let mut data = moving(&chain("", "", "", ""), 5);
    let expected = analytic(&mut data, InverseForce::Total).0;
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    let stiffness = 7.0;
    let callbacks = mujoco_safe::callback::Callbacks::new()
        .with_passive(|context| context.qfrc_passive_mut()[0] -= stiffness * context.qpos()[0]);
    let (found, report) =
        data.with_callbacks(callbacks, |data| lineariser.inverse_jacobians(data, InverseForce::Total)).unwrap();
    assert_eq!((report.method, report.fallback), (TransitionMethod::Engine, Some(Fallback::Callbacks)));
    assert!((found.df_dq[(0, 0)] - expected.df_dq[(0, 0)] - stiffness).abs() < 1e-4);
}

#[test]
fn the_simulation_is_unchanged_and_each_output_is_independent() {
    for mut data in subjects() {
        data.qpos_mut().iter_mut().for_each(|value| *value *= 1.01);
        let before = (data.state(StateSpec::all()), data.qacc().to_vec(), data.qfrc_inverse().to_vec());
        let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
        let (all, _) = lineariser.inverse_jacobians(&mut data, InverseForce::Total).unwrap();
        let alone = computed_alone(&data.model().clone(), |outputs| {
            lineariser.inverse_jacobians_into(&mut data, InverseForce::Total, outputs).unwrap();
        });
        assert_eq!(alone, all);
        assert_eq!((data.state(StateSpec::all()), data.qacc().to_vec(), data.qfrc_inverse().to_vec()), before);
    }
}

#[test]
fn wrong_shapes_and_other_models_are_rejected() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    let mut wrong = Matrix::zeros(3, 2);
    let outputs = InverseOutputs { df_dv: Some(&mut wrong), ..Default::default() };
    let error = lineariser.inverse_jacobians_into(&mut data, InverseForce::Total, outputs).unwrap_err();
    assert!(matches!(error, mujoco_safe::Error::Shape { .. }), "{error}");
    let mut other = Data::new(sample::humanoid()).unwrap();
    let error = lineariser.inverse_jacobians(&mut other, InverseForce::Total).unwrap_err();
    assert!(matches!(error, mujoco_safe::Error::OtherModel { .. }), "{error}");
}

#[test]
fn sensors_of_subtrees_follow_masses_that_were_edited() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    for density in [1e3, 1e-6, 1e9] {
        let mut data = model(&format!(
            r#"<mujoco><default><geom size="0.1" density="{density}"/></default>
               <worldbody><body name="a"><joint axis="0 1 0"/><geom pos="0.2 0 0"/>
                 <body pos="0.4 0 0"><joint axis="0 0 1"/><geom pos="0.2 0 0.1"/>
                   <body pos="0.3 0 0"><joint axis="1 0 0"/><geom pos="0.1 0.2 0"/></body></body></body></worldbody>
               <sensor><subtreeangmom body="a"/><subtreecom body="a"/><subtreelinvel body="a"/></sensor></mujoco>"#,
        ));
        randomise(&mut data, &mut random);
        assert_eq!(analytic(&mut data, InverseForce::Total).1.differenced, DifferencedTerms::empty(), "{density}");
        // The masses of the subtrees are constants that no call updates here.
        data.edit_model(|model| model.body_mass_mut()[2] *= 3.0).unwrap();
        for _ in 0..3 {
            randomise(&mut data, &mut random);
            let (jacobians, report) = analytic(&mut data, InverseForce::Total);
            assert_eq!((report.method, report.differenced), (TransitionMethod::Analytic, DifferencedTerms::SENSORS));
            let expected = Oracle::new(&data, InverseForce::Total).jacobians(1e-5, 1e-3);
            for (ours, theirs) in [(&jacobians.ds_dq, &expected.ds_dq), (&jacobians.ds_dv, &expected.ds_dv)] {
                let error = error(ours, theirs, 0..9);
                assert!(error < 1e-5, "density {density}: {error:e}");
            }
        }
    }
}

/// In newer engines, force sensors read the forces of tendons, which contain those of actuators.
#[test]
fn sensors_read_the_forces_of_actuators_at_the_present_state() {
    for spring in ["", r#"stiffness="3" damping="0.5""#] {
        let mut data = model(&format!(
            r#"<mujoco><worldbody><site name="w" pos="0 0.1 1"/><body><joint axis="0 1 0"/><geom size="0.1" pos="0.2 0 0"/>
                 <body pos="0.4 0 0"><joint axis="0 0 1"/><geom size="0.1" pos="0.2 0 0.1"/><site name="s" pos="0.1 0.1 0"/></body></body></worldbody>
               <tendon><spatial name="t" {spring}><site site="w"/><site site="s"/></spatial></tendon>
               <actuator><motor tendon="t" gear="5"/></actuator>
               <sensor><force site="s"/><torque site="s"/></sensor></mujoco>"#
        ));
        let mut random = Xoshiro256PlusPlus::seed_from_u64(6);
        randomise(&mut data, &mut random);
        data.ctrl_mut()[0] = 3.0;
        for method in [TransitionMethod::Analytic, TransitionMethod::Engine] {
            let options = TransitionOptions::default().with_method(method);
            let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
            // The result does not depend on earlier calls.
            for _ in 0..2 {
                let (jacobians, _) = lineariser.inverse_jacobians(&mut data, InverseForce::Total).unwrap();
                let expected = Oracle::new(&data, InverseForce::Total).jacobians(1e-5, 1e-3);
                for (ours, theirs) in [(&jacobians.ds_dq, &expected.ds_dq), (&jacobians.ds_dv, &expected.ds_dv)] {
                    let error = error(ours, theirs, 0..6);
                    assert!(error < 1e-4, "{spring} {method:?}: {error:e}");
                }
            }
        }
    }
}

/// Returns the slopes of the force of a muscle by length and by velocity, from differences of the
/// engine's functions.
fn muscle_slopes(model: &Model, [length, velocity]: [f64; 2], activation: f64) -> [f64; 2] {
    let (range, acc0) = (model.actuator_lengthrange()[0], model.actuator_acc0()[0]);
    let (gain, bias) = (&model.actuator_gainprm()[0], &model.actuator_biasprm()[0]);
    let force = |length: f64, velocity: f64| {
        // SAFETY: the functions read two numbers of the range and nine of the parameters.
        unsafe {
            let (range, gain, bias) = (range.as_ptr(), gain.as_ptr(), bias.as_ptr());
            activation * sys::mju_muscleGain(length, velocity, range, acc0, gain)
                + sys::mju_muscleBias(length, range, acc0, bias)
        }
    };
    let step = 1e-5;
    [
        (force(length + step, velocity) - force(length - step, velocity)) / (2.0 * step),
        (force(length, velocity + step) - force(length, velocity - step)) / (2.0 * step),
    ]
}

/// Newer engines have another force of muscles far from their range of lengths.
#[test]
fn muscles_outside_of_their_range_of_lengths_agree_with_the_engine() {
    let mut data = model(
        r#"<mujoco><option timestep="0.01" gravity="0 0 0"/>
             <worldbody><body><joint name="j" type="slide" axis="1 0 0" ref="0.6"/><geom size=".1" mass="1"/></body></worldbody>
             <actuator><muscle joint="j" gear="-12.348" lengthrange="-1.63 0.78" force="29.21" timeconst=".02 .05"/></actuator></mujoco>"#,
    );
    let gear = -12.348;
    let mut random = Xoshiro256PlusPlus::seed_from_u64(9);
    let mut outside = 0;
    for state in 0..60 {
        data.qpos_mut()[0] = -3.0 + 6.0 * f64::from(state) / 59.0;
        data.qvel_mut()[0] = random.random_range(-0.3..0.3);
        data.act_mut()[0] = random.random_range(0.1..0.9);
        accelerate(&mut data, &mut random);
        check_force(&format!("state {state}"), &mut data, InverseForce::WithoutActuators);
        let (jacobians, _) = analytic(&mut data, InverseForce::WithoutActuators);
        let [length, velocity] = [data.qpos()[0], data.qvel()[0]].map(|value| gear * value);
        let [shortest, longest] = data.model().actuator_lengthrange()[0];
        outside += usize::from(!(shortest..=longest).contains(&length));
        let slopes = muscle_slopes(data.model(), [length, velocity], data.act()[0]);
        // The force of the actuator is subtracted, and its length and velocity are those of the
        // joint times the gear.
        for (found, slope) in [jacobians.df_dq[(0, 0)], jacobians.df_dv[(0, 0)]].into_iter().zip(slopes) {
            let expected = -gear * gear * slope;
            assert!((found - expected).abs() <= 1e-4 * (1.0 + expected.abs()), "state {state}: {found}, {expected}");
        }
    }
    assert!((20..60).contains(&outside), "{outside} states outside of the range");
}
