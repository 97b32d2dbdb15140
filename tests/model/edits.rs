//! Edited models: a simulation of an edited model equals that of a model compiled with the same
//! numbers.

#![forbid(unsafe_code)]

use mujoco_safe::enums::SameFrame;
use mujoco_safe::{Data, Error, Matrix, Model, ModelMut, sample};

/// A free body, a body on slide joints and a body on a ball joint: the cases for which the engine
/// caches flags.
fn model(inertial: &str, geom: &str, site: &str, joint: &str) -> Model {
    Model::from_xml_str(&format!(
        r#"<mujoco>
             <worldbody>
               <geom type="plane" size="9 9 .1" pos="0 0 -1"/>
               <body name="free" pos="0 0 1"><freejoint/>
                 <inertial {inertial}/><geom name="geom" {geom}/><site name="site" {site}/>
               </body>
               <body name="slides" pos="3 0 1"><joint name="x" type="slide" {joint}/><joint type="slide" axis="0 1 0"/>
                 <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/><geom size=".1"/>
               </body>
               <body name="ball" pos="-3 0 1"><joint type="ball"/>
                 <inertial pos="0 0 0" mass="1" diaginertia=".1 .2 .25"/><geom size=".1"/>
               </body>
             </worldbody>
           </mujoco>"#
    ))
    .unwrap()
}

const INERTIAL: &str = r#"pos="0 0 0" mass="1" diaginertia=".1 .2 .25""#;
const GEOM: &str = r#"size=".1""#;

fn plain() -> Model {
    model(INERTIAL, GEOM, "", "axis='1 0 0'")
}

/// Returns the state and the poses along a simulation in which the bodies turn and fall.
fn run(model: Model) -> Vec<f64> {
    let mut data = Data::new(model).unwrap();
    data.qvel_mut().iter_mut().zip(1..).for_each(|(velocity, i)| *velocity = 0.3 * f64::from(i));
    data.forward().unwrap();
    let mut all = data.full_m().unwrap().as_slice().to_vec();
    for _ in 0..50 {
        data.step().unwrap();
        all.extend_from_slice(data.qpos());
        all.extend_from_slice(data.geom_xpos().as_flattened());
        all.extend_from_slice(data.geom_xmat().as_flattened());
        all.extend_from_slice(data.site_xpos().as_flattened());
        all.extend_from_slice(data.xipos().as_flattened());
    }
    all
}

fn check(name: &str, compiled: Model, updates: bool, edit: impl Fn(&mut ModelMut<'_>)) {
    let mut edited = plain();
    edit(&mut edited.edit());
    if updates {
        edited.edit().update_constants().unwrap();
        for (edited, compiled) in [
            (edited.body_sameframe(), compiled.body_sameframe()),
            (edited.geom_sameframe(), compiled.geom_sameframe()),
            (edited.site_sameframe(), compiled.site_sameframe()),
            (edited.body_simple(), compiled.body_simple()),
        ] {
            assert_eq!(edited, compiled, "{name}");
        }
        assert_eq!(edited.dof_simplenum(), compiled.dof_simplenum(), "{name}");
        assert_eq!(edited.geom_rbound(), compiled.geom_rbound(), "{name}");
    }
    // A saved model must be valid.
    let edited = Model::from_binary(&edited.to_binary().unwrap()).unwrap();
    for (edited, compiled) in run(edited).into_iter().zip(run(compiled)) {
        assert!((edited - compiled).abs() < 1e-9, "{name}, updated: {updates}: {edited} but {compiled}");
    }
}

#[test]
#[cfg_attr(
    engine_since = "2.3.0",
    ignore = "newer engines take edited masses and joints with update_constants, as in C"
)]
fn an_edited_model_simulates_like_a_model_compiled_with_its_numbers() {
    for updates in [false, true] {
        check("nothing", plain(), updates, |_| ());
        let axis = "axis='1 0 0'";
        check("geom_pos", model(INERTIAL, "size='.1' pos='.2 0 .1'", "", axis), updates, |model| {
            model.geom_mut("geom").unwrap().pos_mut().copy_from_slice(&[0.2, 0.0, 0.1]);
        });
        check("geom_quat", model(INERTIAL, "size='.1' quat='.6 .8 0 0'", "", axis), updates, |model| {
            model.geom_mut("geom").unwrap().quat_mut().copy_from_slice(&[0.6, 0.8, 0.0, 0.0]);
        });
        check("site_pos", model(INERTIAL, GEOM, "pos='.2 0 .1'", axis), updates, |model| {
            model.site_mut("site").unwrap().pos_mut().copy_from_slice(&[0.2, 0.0, 0.1]);
        });
        let moved = r#"pos=".1 .2 .3" quat=".6 .8 0 0" mass="1" diaginertia=".1 .2 .25""#;
        check("body_ipos, body_iquat", model(moved, GEOM, "", axis), updates, |model| {
            model.body_mut("free").unwrap().ipos_mut().copy_from_slice(&[0.1, 0.2, 0.3]);
            model.body_mut("free").unwrap().iquat_mut().copy_from_slice(&[0.6, 0.8, 0.0, 0.0]);
        });
        let heavy = r#"pos="0 0 0" mass="5" diaginertia=".1 .2 .25""#;
        check("body_mass", model(heavy, GEOM, "", axis), updates, |model| {
            let free = model.body("free").unwrap().index();
            model.body_mass_mut()[free] = 5.0;
        });
        let wide = r#"pos="0 0 0" mass="1" diaginertia=".3 .2 .25""#;
        check("body_inertia", model(wide, GEOM, "", axis), updates, |model| {
            model.body_mut("free").unwrap().inertia_mut()[0] = 0.3;
        });
        check("dof_armature", model(INERTIAL, GEOM, "", "axis='1 0 0' armature='.5'"), updates, |model| {
            let dof = model.joint("x").unwrap().dofs().start;
            model.dof_armature_mut()[dof] = 0.5;
        });
        check("jnt_axis", model(INERTIAL, GEOM, "", "axis='.6 .8 0'"), updates, |model| {
            model.joint_mut("x").unwrap().axis_mut().copy_from_slice(&[0.6, 0.8, 0.0]);
        });
    }
    check("geom_size", model(INERTIAL, "size='.7'", "", "axis='1 0 0'"), true, |model| {
        model.geom_mut("geom").unwrap().size_mut()[0] = 0.7;
    });
}

#[test]
#[cfg_attr(
    engine_since = "2.3.0",
    ignore = "newer engines take edited masses and joints with update_constants, as in C"
)]
fn cleared_flags_are_recomputed_when_they_apply_again() {
    let xml = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml"));
    for xml in [sample::HUMANOID_XML, &xml.unwrap()] {
        let compiled = Model::from_xml_str(xml).unwrap();
        let mut model = compiled.clone();
        let mut edit = model.edit();
        edit.body_ipos_mut();
        edit.geom_pos_mut();
        edit.site_quat_mut();
        assert!(edit.geoms().all(|geom| geom.sameframe() == SameFrame::None));
        edit.update_constants().unwrap();
        assert_eq!(model.body_sameframe(), compiled.body_sameframe());
        assert_eq!(model.geom_sameframe(), compiled.geom_sameframe());
        assert_eq!(model.site_sameframe(), compiled.site_sameframe());
        assert_eq!(model.body_simple(), compiled.body_simple());
        assert_eq!(model.dof_simplenum(), compiled.dof_simplenum());
        assert_eq!(model.geom_rbound(), compiled.geom_rbound());
    }
}

/// Newer engines take the slides of a body for independent whose inertial frame is its own.
#[test]
fn two_slides_along_one_axis_are_coupled_or_rejected() {
    let slides = |geom: &str| {
        Model::from_xml_str(&format!(
            r#"<mujoco><worldbody><body name="b">
                 <joint type="slide" axis="1 0 0" armature="1"/><joint type="slide" axis="-1 0 0" armature="1"/>
                 <geom size=".1" mass="3" {geom}/>
               </body></worldbody></mujoco>"#
        ))
    };
    if cfg!(engine_since = "2.3.0") {
        let error = slides("").unwrap_err().to_string();
        assert!(error.contains("body 'b' has two slide joints along one axis"), "{error}");
    }
    let mut model = slides(if cfg!(engine_since = "2.3.0") { "pos='.1 0 0'" } else { "" }).unwrap();
    let expected = Matrix::from_rows(&[[4.0, -3.0], [-3.0, 4.0]]);
    for updates in [false, true] {
        if updates {
            model.edit().update_constants().unwrap();
        }
        let mut data = Data::new(model.clone()).unwrap();
        data.forward().unwrap();
        assert_eq!(data.full_m().unwrap(), expected);
    }
}

/// Returns a model of one body with this inertia, and a child fixed to it.
fn carrier(inertial: &str, child: &str) -> mujoco_safe::Result<Model> {
    Model::from_xml_str(&format!(
        r#"<mujoco><worldbody>
             <body name="carrier" pos="0 0 1"><freejoint/><inertial pos="0 0 0" {inertial}/><body>{child}</body></body>
           </worldbody></mujoco>"#
    ))
}

#[test]
fn a_moving_body_without_mass_or_inertia_is_rejected_as_in_the_compiler() {
    const GOOD: &str = r#"mass="1" diaginertia="1 1 1""#;
    for (mass, inertia, what) in [
        (0.0, [1.0; 3], "mass"),
        (-1.0, [1.0; 3], "mass"),
        (1e-16, [1.0; 3], "mass"),
        (f64::NAN, [1.0; 3], "mass"),
        (1.0, [1.0, 0.0, 1.0], "moment of inertia"),
        (1.0, [0.0; 3], "moment of inertia"),
    ] {
        let mut model = carrier(GOOD, "").unwrap();
        let mut edit = model.edit();
        edit.body_mut("carrier").unwrap().set_mass(mass);
        *edit.body_mut("carrier").unwrap().inertia_mut() = inertia;
        let before = edit.body_subtreemass().to_vec();
        match edit.update_constants() {
            Err(Error::Invalid { what: found, .. }) => assert_eq!(found, format!("the {what} of body 'carrier'")),
            other => panic!("{mass}, {inertia:?}: {other:?}"),
        }
        assert_eq!(edit.body_subtreemass(), before, "the model is unchanged");
        // Valid numbers make the model usable again.
        edit.body_mut("carrier").unwrap().set_mass(2.0);
        *edit.body_mut("carrier").unwrap().inertia_mut() = [1.0; 3];
        edit.update_constants().unwrap();
    }
}

#[test]
fn a_moving_body_without_mass_may_carry_a_fixed_child_with_mass() {
    const NOTHING: &str = r#"mass="0" diaginertia="0 0 0""#;
    const BALL: &str = r#"<geom size=".1"/>"#;
    assert!(carrier(NOTHING, "").is_err(), "the compiler rejects the body alone");
    let mut model = carrier(NOTHING, BALL).unwrap();
    model.edit().update_constants().unwrap();
    let child = model.body("carrier").unwrap().index() + 1;
    model.edit().body_mass_mut()[child] = 0.0;
    assert!(matches!(model.edit().update_constants(), Err(Error::Invalid { .. })));
    // Or a child of such a child, for some compilers. A muscle needs the constants when the model
    // is loaded.
    let chain = carrier(NOTHING, &format!("<body>{BALL}</body>"));
    assert_eq!(chain.is_ok(), cfg!(engine_since = "3.3.0"), "{chain:?}");
    if let Ok(mut chain) = chain {
        chain.edit().update_constants().unwrap();
        chain.edit().body_mass_mut()[child + 1] = 0.0;
        assert!(matches!(chain.edit().update_constants(), Err(Error::Invalid { .. })));
    }
    // Bodies without joints need no mass.
    let mut fixed = Model::from_xml_str("<mujoco><worldbody><body/></worldbody></mujoco>").unwrap();
    fixed.edit().update_constants().unwrap();
}

/// Compilers since 3.2.3 take frames for equal that differ by less than 1e-6.
#[test]
fn rounding_errors_in_frames_reject_no_edit() {
    const SLIDE: &str = "<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/>";
    for (joints, geom) in [
        ("<freejoint/>", "pos='1e-17 0 0'"),
        ("<freejoint/>", "pos='5e-7 0 0'"),
        ("<freejoint/>", "euler='0 0 360'"),
        ("<joint type='ball' pos='1e-9 0 0'/>", ""),
        (&SLIDE.replace("1 0 0", "1 0 1e-17"), ""),
        (&SLIDE.replace("1 0 0", "1 6.1e-17 0"), ""),
    ] {
        let mut model = Model::from_xml_str(&format!(
            "<mujoco><worldbody><body name='b'>{joints}<geom type='box' size='.1 .2 .3' {geom}/></body></worldbody></mujoco>"
        ))
        .unwrap();
        model.edit().update_constants().unwrap_or_else(|error| panic!("{joints} {geom}: {error}"));
        model.edit().body_mut("b").unwrap().scale_mass(2.0).unwrap();
        model.edit().update_constants().unwrap();
    }
}

/// Bodies with at most one degree of freedom: the inertia matrix has space for every edit.
#[test]
fn the_centre_of_mass_of_a_fixed_or_hinged_body_can_move() {
    let model = |fixed: &str, hinged: &str| {
        Model::from_xml_str(&format!(
            r#"<mujoco><worldbody>
                 <body name="fixed" pos="1 0 1"><inertial pos="{fixed}" mass="1" diaginertia=".1 .1 .1"/><geom size=".1"/></body>
                 <body name="hinged" pos="0 0 1"><joint axis="0 1 0"/>
                   <inertial pos="{hinged}" mass="1" diaginertia=".1 .1 .1"/><geom size=".1"/></body>
               </worldbody></mujoco>"#
        ))
        .unwrap()
    };
    let mut edited = model("0 0 0", "0 0 0");
    let mut edit = edited.edit();
    for name in ["fixed", "hinged"] {
        edit.body_mut(name).unwrap().ipos_mut()[0] = 0.1;
    }
    edit.update_constants().unwrap();
    assert_eq!(run(edited), run(model("0.1 0 0", "0.1 0 0")));
}
