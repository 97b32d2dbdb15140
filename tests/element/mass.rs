//! Mass and inertia of bodies.

use mujoco_safe::{Data, Error, Model};

/// Returns two linked bodies whose geoms have a density.
fn arm(upper: f64, lower: f64) -> Model {
    let xml = format!(
        r#"<mujoco><worldbody><body name="upper" pos="0 0 2"><joint axis="0 1 0"/><joint axis="1 0 0"/>
             <geom type="box" size="0.1 0.2 0.3" pos="0.1 0.2 -0.3" euler="10 20 30" density="{upper}"/>
             <geom type="sphere" size="0.1" density="{upper}"/>
             <body name="lower" pos="0 0.1 -0.6"><joint type="ball"/>
               <geom type="capsule" size="0.05 0.3" pos="0 0.1 -0.3" density="{lower}"/></body></body></worldbody></mujoco>"#
    );
    Model::from_xml_str(&xml).unwrap()
}

/// Returns the accelerations of a model in a fixed state.
fn accelerations(model: &Model) -> Vec<f64> {
    let mut data = Data::new(model.clone()).unwrap();
    data.qpos_mut()[..2].copy_from_slice(&[0.3, -0.2]);
    for (dof, qvel) in data.qvel_mut().iter_mut().enumerate() {
        *qvel = 0.5 - 0.2 * dof as f64;
    }
    data.forward().unwrap();
    data.qacc().to_vec()
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-10 * scale;
    assert!(found.iter().zip(expected).all(close), "{what}: {found:?}, not {expected:?}");
}

#[test]
fn scaling_the_mass_equals_scaling_the_density() {
    for factor in [0.3, 1.0, 7.0] {
        let mut model = arm(500.0, 800.0);
        let mut edit = model.edit();
        edit.body_mut("lower").unwrap().scale_mass(factor).unwrap();
        edit.update_constants().unwrap();
        let compiled = arm(500.0, 800.0 * factor);
        assert_close(model.body_mass(), compiled.body_mass(), "body_mass");
        assert_close(model.body_inertia().as_flattened(), compiled.body_inertia().as_flattened(), "body_inertia");
        assert_close(model.body_subtreemass(), compiled.body_subtreemass(), "body_subtreemass");
        assert_close(
            model.body_invweight0().as_flattened(),
            compiled.body_invweight0().as_flattened(),
            "body_invweight0",
        );
        assert_close(model.dof_invweight0(), compiled.dof_invweight0(), "dof_invweight0");
        assert_close(&[model.statistics().meaninertia], &[compiled.statistics().meaninertia], "meaninertia");
        assert_close(&[model.statistics().meanmass], &[compiled.statistics().meanmass], "meanmass");
        assert_close(&accelerations(&model), &accelerations(&compiled), "qacc");
        // Scaling the mass without the inertia gives a different body.
        if factor != 1.0 {
            let mut model = arm(500.0, 800.0);
            let mass = model.body("lower").unwrap().mass();
            let inertia = *model.body("lower").unwrap().inertia();
            let mut edit = model.edit();
            edit.body_mut("lower").unwrap().set_mass(factor * mass);
            edit.update_constants().unwrap();
            assert_eq!(*model.body("lower").unwrap().inertia(), inertia);
            let difference =
                std::iter::zip(accelerations(&model), accelerations(&compiled)).map(|(a, b)| (a - b).abs());
            assert!(difference.fold(0.0, f64::max) > 1e-3);
        }
    }
}

#[test]
fn an_invalid_scale_is_an_error_that_changes_nothing() {
    let mut model = arm(500.0, 800.0);
    let before = model.to_binary().unwrap();
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
        let error = model.edit().body_mut("upper").unwrap().scale_mass(factor).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }) && error.to_string().contains("upper"), "{error}");
    }
    assert!(model.to_binary().unwrap() == before);
}
