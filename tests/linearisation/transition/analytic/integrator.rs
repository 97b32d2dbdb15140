//! The step of the implicit integrator.

use mujoco_safe::derivative::{Fallback, TransitionMethod, TransitionOptions};
use mujoco_safe::enums::Integrator;
use mujoco_safe::{Data, Lineariser, sample};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::constraints::{collide, constrained};
use super::smooth::joints;
use super::{OPTIONS, analytic, check, model, randomise, without_passive_forces};
use crate::transition::features::{chain, moving};

#[test]
fn bias_forces_and_damping_agree_with_differences_for_every_joint() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(40);
    for damping in ["", r#"damping="0.3" stiffness="2""#, r#"damping="20""#] {
        let xml = joints("").replace("<worldbody>", &format!("<default><joint {damping}/></default><worldbody>"));
        let mut data = model(&xml.replace("<option ", r#"<option integrator="implicit" "#));
        for state in 0..8 {
            randomise(&mut data, &mut random);
            check(&format!("{damping}, state {state}"), &mut data);
        }
    }
}

#[test]
fn tendons_and_actuators_on_two_branches_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(41);
    // The engine omits the coupling of the slide and the hinge of another branch.
    let tendon = r#"<tendon><fixed name="t" damping="2"><joint joint="h" coef="1"/><joint joint="i" coef="-0.5"/></fixed></tendon>"#;
    for actuator in [
        r#"<velocity joint="h" kv="3"/><velocity tendon="t" kv="2"/>"#,
        r#"<general tendon="t" gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/>"#,
        r#"<general joint="i" gaintype="affine" gainprm="2 0.5 0.9" ctrllimited="true" ctrlrange="-0.1 0.1"/>"#,
        r#"<velocity joint="h" kv="3" forcelimited="true" forcerange="-0.1 0.1"/>"#,
        r#"<general joint="h" dyntype="filter" dynprm="0.05" gaintype="affine" gainprm="3 0 0.8"/>"#,
    ] {
        for flag in ["", r#"<flag actuation="disable"/>"#, without_passive_forces()] {
            if actuator.contains("filter") && flag.contains("actuation") {
                continue;
            }
            let rest =
                format!(r#"<option integrator="implicit">{flag}</option>{tendon}<actuator>{actuator}</actuator>"#);
            let mut data = model(&joints(&rest));
            for state in 0..3 {
                randomise(&mut data, &mut random);
                check(&format!("{actuator}, {flag}, state {state}"), &mut data);
            }
        }
    }
}

#[test]
fn constraints_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(42);
    for option in OPTIONS {
        let option = format!(r#"{option} integrator="implicit""#);
        let mut data = model(&constrained(&option));
        for state in 0..2 {
            collide(&mut data, &mut random);
            assert!(data.ncon() > 0);
            check(&format!("{option}, state {state}"), &mut data);
        }
    }
}

#[test]
fn a_lineariser_follows_a_change_of_the_integrator() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(43));
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    let (explicit, _) = lineariser.linear_system(&mut data).unwrap();
    data.edit_model(|model| model.edit_options(|options| options.integrator = Integrator::Implicit)).unwrap();
    let (system, report) = lineariser.linear_system(&mut data).unwrap();
    assert_eq!(report.method, TransitionMethod::Analytic);
    assert_eq!(system, analytic(&mut data).0);
    assert_ne!(system, explicit);
}

#[test]
fn terms_without_a_formula_fall_back_to_differences_of_steps() {
    let spatial = r#"<tendon><spatial name="s" damping="2"><site site="anchor"/><site site="tip"/></spatial></tendon>"#;
    let muscle = r#"<actuator><muscle joint="b" lengthrange="-1 1"/></actuator>"#;
    for xml in [
        chain(r#"integrator="implicit" density="900""#, "", "", ""),
        chain(r#"integrator="implicit" viscosity="0.1""#, "", "", ""),
        chain(r#"integrator="implicit""#, "", "", spatial),
        chain(r#"integrator="implicit""#, "", "", muscle),
    ] {
        let report = analytic(&mut moving(&xml, 3)).1;
        assert_eq!((report.method, report.fallback), (TransitionMethod::Columns, Some(Fallback::ImplicitIntegrator)));
    }
}
