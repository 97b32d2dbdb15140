//! Named access: what can be looked up and by what, what an unknown name is told, that writing through a view arrives where
//! the engine reads it, and how a view is printed.
//!
//! `models/zoo.xml` has every kind of element, with and without names; the expected names and numbers are those of its text.
//! That each field reads the engine's memory is the matter of `against_c`.
#![allow(clippy::float_cmp, reason = "what is written is what is read")]

use std::collections::HashSet;
use std::sync::Arc;

use mujoco_safe::{BodyId, Data, EnableFlags, Error, JointId, JointType, KeyframeId, Kind, Model, SensorId, sample};

const ZOO_XML: &str = include_str!("models/zoo.xml");

fn zoo() -> Arc<Model> {
    Arc::new(Model::from_xml_str(ZOO_XML).expect("the zoo loads"))
}

fn simulation() -> Data {
    let mut data = Data::new(zoo()).expect("there is memory");
    data.forward().expect("forward dynamics");
    data
}

/// The text of the error, if it is of the kind that an unknown name gives.
fn unknown<T: std::fmt::Debug>(result: Result<T, Error>) -> String {
    let error = result.expect_err("there is no such element");
    assert!(matches!(error, Error::NoSuchName { .. }), "{error}");
    error.to_string()
}

mod looking_up {
    use super::*;

    #[test]
    fn a_name_an_index_an_id_and_a_view_lead_to_the_same_element() {
        let model = zoo();
        let data = Data::new(model.clone()).expect("there is memory");
        for (index, name) in
            [(0, Some("crate")), (1, Some("rail")), (2, Some("shoulder")), (3, Some("elbow")), (4, None)]
        {
            let by_index = model.joint(index).expect("there are five joints");
            assert_eq!((by_index.index(), by_index.name()), (index, name));
            assert_eq!(model.joint(by_index.id()).id(), by_index.id());
            assert_eq!(model.joint(by_index).id(), by_index.id());
            assert_eq!(data.joint(by_index).id(), by_index.id());
            assert_eq!(model.joint(data.joint(by_index)).id(), by_index.id());
            assert_eq!(JointId::from(by_index), by_index.id());
            if let Some(name) = name {
                assert_eq!(model.joint(name).expect("it has this name").id(), by_index.id());
                assert_eq!(model.joint(&name.to_owned()).expect("it has this name").id(), by_index.id());
                assert_eq!(data.joint(name).expect("it has this name").id(), by_index.id());
                assert_eq!(model.id::<mujoco_safe::kind::Joint>(name).expect("it has this name"), by_index.id());
                assert_eq!(model.name(by_index.id()), Some(name));
            }
        }
    }

    #[test]
    fn every_name_of_every_kind_leads_back_to_its_element() {
        macro_rules! check {
            ($model:ident, $data:ident: $($one:ident, $many:ident;)*) => {$(
                for element in $model.$many() {
                    let Some(name) = element.name() else { continue };
                    assert_eq!($model.$one(name).expect("it has this name").id(), element.id());
                    assert_eq!($data.$one(name).expect("it has this name").id(), element.id());
                }
            )*};
        }
        for model in [zoo(), Arc::new(sample::humanoid()), Arc::new(sample::cartpole())] {
            let data = Data::new(model.clone()).expect("there is memory");
            check!(model, data: body, bodies; joint, joints; geom, geoms; site, sites; camera, cameras; light, lights;
                tendon, tendons; actuator, actuators; sensor, sensors;);
            for key in model.keyframes() {
                if let Some(name) = key.name() {
                    assert_eq!(model.keyframe(name).expect("it has this name").id(), key.id());
                }
            }
        }
    }

    #[test]
    fn elements_of_different_kinds_may_share_a_name() {
        let model = zoo();
        assert_eq!(model.body("crate").expect("a body").index(), 3);
        assert_eq!(model.joint("crate").expect("a joint").index(), 0);
        assert_eq!(model.site("crate").expect("a site").index(), 1);
        assert_eq!(model.actuator("rail").expect("an actuator").index(), 0);
        assert_eq!(model.joint("rail").expect("a joint").index(), 1);
    }

    #[test]
    fn an_index_beyond_the_last_element_is_an_error_with_the_count() {
        let model = zoo();
        let error = model.sensor(10).expect_err("there are ten, from 0");
        assert!(matches!(error, Error::NoSuchIndex { kind: Kind::Sensor, index: 10, count: 10 }), "{error:?}");
        assert_eq!(error.to_string(), "there is no sensor 10: the model has 10, counted from 0");
        assert!(model.joint(usize::MAX).is_err());
        assert!(model.id_at::<mujoco_safe::kind::Body>(1 << 32).is_err(), "an index is not cut to 32 bits");
    }

    #[test]
    fn ids_are_values_that_can_be_kept_compared_and_hashed() {
        let model = zoo();
        let ids: HashSet<BodyId> = model.bodies().map(|body| body.id()).collect();
        assert_eq!(ids.len(), model.nbody());
        assert!(ids.contains(&model.body("base").expect("there is a base").id()));
        let kept: SensorId = model.sensor("elbow").expect("there is an elbow").id();
        assert_eq!(kept.index(), 1);
    }

    #[test]
    fn ids_fit_clones_of_the_model_and_edited_copies_of_simulations() {
        let model = zoo();
        let elbow = model.joint("elbow").expect("there is an elbow").id();
        let copy = (*model).clone();
        assert_eq!(copy.joint(elbow).name(), Some("elbow"));
        let mut data = Data::new(model.clone()).expect("there is memory");
        data.edit_model(|model| model.joint_mut(elbow).set_stiffness(4.0)).expect("there is memory");
        assert_eq!(data.joint(elbow).in_model().stiffness(), 4.0);
    }

    #[test]
    #[should_panic(expected = "belongs to another model")]
    fn an_id_of_a_model_that_was_loaded_separately_panics() {
        let elbow = zoo().joint("elbow").expect("there is an elbow").id();
        zoo().joint(elbow);
    }

    #[test]
    fn keyframes_are_keys_of_a_reset() {
        let model = zoo();
        let mut data = Data::new(model.clone()).expect("there is memory");
        let lifted: KeyframeId = model.keyframe("lifted").expect("there is a keyframe").id();
        data.reset_to_key("lifted").expect("there is a keyframe");
        let by_name = data.physics_state();
        assert_eq!((data.time(), data.qpos()[2]), (1.5, 0.6));
        data.reset_to_key(1).expect("there is a keyframe");
        assert_ne!(data.physics_state(), by_name);
        data.reset_to_key(lifted).expect("there is a keyframe");
        assert_eq!(data.physics_state(), by_name);
        data.reset_to_key(model.keyframe(lifted)).expect("there is a keyframe");
        assert_eq!(data.physics_state(), by_name);
    }
}

mod unknown_names {
    use super::*;

    #[test]
    fn the_error_proposes_the_nearest_name_and_lists_all() {
        let text = unknown(zoo().joint("elbwo"));
        assert_eq!(
            text,
            "there is no joint named 'elbwo', did you mean 'elbow'? (there are: crate, rail, shoulder, elbow)"
        );
        let text = unknown(zoo().actuator("no such thing"));
        assert!(!text.contains("did you mean"), "{text}");
        assert!(text.contains("rail, turn, filter, winch, biceps"), "{text}");
    }

    #[test]
    fn the_error_has_the_names_for_programs_too() {
        let Err(Error::NoSuchName { kind, name, known }) = sample::humanoid().keyframe("handstand").map(|_| ()) else {
            panic!("there is no such keyframe")
        };
        assert_eq!((kind, name.as_str()), (Kind::Keyframe, "handstand"));
        assert_eq!(known, ["squat", "stand_on_left_leg", "stand"]);
    }

    #[test]
    fn a_kind_without_names_says_so() {
        let text = unknown(sample::cartpole().tendon("rope"));
        assert_eq!(text, "there is no tendon named 'rope' (none of this kind has a name)");
    }

    #[test]
    fn the_empty_name_is_nobodys() {
        // The engine itself finds the first element without a name under it.
        unknown(zoo().joint(""));
        unknown(zoo().geom(""));
        unknown(simulation().light(""));
    }

    #[test]
    fn a_name_with_a_nul_in_it_is_not_cut_there() {
        unknown(zoo().joint("elbow\0"));
        unknown(zoo().joint("elbow\0x"));
    }

    #[test]
    fn names_are_compared_whole_and_by_case() {
        for name in ["Elbow", "elbow ", "elbo", "elbows", "ellenbogen ‐ coude"] {
            unknown(zoo().joint(name));
        }
    }

    #[test]
    fn a_mutable_lookup_gives_the_same_error() {
        let mut data = simulation();
        assert!(unknown(data.joint_mut("elbwo")).contains("'elbow'"));
        assert!(data.sensor_mut(99).is_err());
        let text = data.edit_model(|model| unknown(model.geom_mut("grund"))).expect("there is memory");
        assert!(text.contains("'ground'"), "{text}");
    }
}

mod iterating {
    use super::*;

    #[test]
    fn each_kind_has_as_many_elements_as_the_model_says_in_order() {
        macro_rules! check {
            ($model:ident: $($many:ident = $count:ident, $kind:ident;)*) => {$(
                assert_eq!($model.$many().len(), $model.$count(), stringify!($many));
                assert_eq!($model.count(Kind::$kind), $model.$count());
                assert!($model.$many().map(|element| element.index()).eq(0..$model.$count()), stringify!($many));
                let names: Vec<&str> = $model.$many().filter_map(|element| element.name()).collect();
                assert!($model.names(Kind::$kind).eq(names), stringify!($many));
            )*};
        }
        for model in [zoo(), Arc::new(sample::humanoid()), Arc::new(sample::cartpole())] {
            check!(model: bodies = nbody, Body; joints = njnt, Joint; geoms = ngeom, Geom; sites = nsite, Site;
                cameras = ncam, Camera; lights = nlight, Light; tendons = ntendon, Tendon; actuators = nu, Actuator;
                sensors = nsensor, Sensor; keyframes = nkey, Keyframe;);
        }
    }

    #[test]
    fn the_zoo_has_the_names_that_its_text_gives() {
        let model = zoo();
        let names = |kind| model.names(kind).collect::<Vec<_>>();
        assert_eq!(names(Kind::Body), ["world", "hand", "other_hand", "crate", "base", "shoulder", "elbow"]);
        assert_eq!(names(Kind::Tendon), ["rope", "coupling"]);
        assert_eq!(names(Kind::Camera), ["overview"]);
        assert_eq!(names(Kind::Sensor), ["acceleration", "elbow", "swing", "touch", "load", "height"]);
        assert_eq!(names(Kind::Keyframe), ["lifted"]);
        assert_eq!((model.ntendon(), model.ncam(), model.nlight(), model.nkey()), (3, 2, 3, 2));
    }

    #[test]
    fn iteration_goes_backwards_too_and_knows_its_length() {
        let model = zoo();
        let mut joints = model.joints();
        assert_eq!(joints.next_back().map(|joint| joint.index()), Some(4));
        assert_eq!(joints.len(), 4);
        let data = simulation();
        let backwards: Vec<_> = data.bodies().rev().filter_map(|body| body.name()).collect();
        assert_eq!(backwards, ["elbow", "shoulder", "base", "crate", "other_hand", "hand", "world"]);
    }

    #[test]
    fn the_left_joints_of_the_humanoid_are_found_by_their_names() {
        let model = sample::humanoid();
        let left = model.joints().filter(|joint| joint.name().is_some_and(|name| name.contains("left")));
        assert_eq!(left.count(), 9);
    }
}

mod ranges {
    use super::*;

    #[test]
    fn a_joint_has_the_positions_and_degrees_of_freedom_of_its_type() {
        let model = zoo();
        let expected = [
            ("crate", JointType::Free, 0..7, 0..6),
            ("rail", JointType::Slide, 7..8, 6..7),
            ("shoulder", JointType::Ball, 8..12, 7..10),
            ("elbow", JointType::Hinge, 12..13, 10..11),
        ];
        for (name, joint_type, qpos, dofs) in expected {
            let joint = model.joint(name).expect("it has this name");
            assert_eq!((joint.joint_type(), joint.qpos_range(), joint.dofs()), (joint_type, qpos, dofs), "{name}");
        }
        assert_eq!((model.nq(), model.nv()), (14, 12));
    }

    #[test]
    fn the_ranges_of_all_joints_cover_each_index_once() {
        for model in [zoo(), Arc::new(sample::humanoid()), Arc::new(sample::cartpole())] {
            assert!(model.joints().flat_map(|joint| joint.qpos_range()).eq(0..model.nq()));
            assert!(model.joints().flat_map(|joint| joint.dofs()).eq(0..model.nv()));
            assert!(model.bodies().flat_map(|body| body.dofs()).eq(0..model.nv()));
            assert!(model.sensors().flat_map(|sensor| sensor.data_range()).eq(0..model.nsensordata()));
        }
    }

    #[test]
    fn a_joint_behind_a_free_joint_is_not_its_own_degree_of_freedom() {
        let model = sample::humanoid();
        let knee = model.joint("left_knee").expect("there is a left knee");
        assert_eq!(knee.dofs(), knee.index() + 5..knee.index() + 6);
        assert_eq!(knee.qpos_range(), knee.index() + 6..knee.index() + 7);
    }

    #[test]
    fn elements_know_the_elements_that_they_hang_on() {
        let model = zoo();
        let body = |name: &str| model.body(name).expect("there is such a body");
        assert_eq!(body("elbow").parent(), body("shoulder").id());
        assert_eq!(body("elbow").root(), body("base").id());
        assert_eq!(body("world").parent(), body("world").id());
        assert_eq!(model.joint("shoulder").expect("a joint").body(), body("shoulder").id());
        assert_eq!(model.geom("pulley").expect("a geom").body(), body("base").id());
        assert_eq!(model.site("crate").expect("a site").body(), body("crate").id());
        assert_eq!(model.camera("overview").expect("a camera").body(), body("world").id());
        assert_eq!((body("elbow").njnt(), body("base").ngeom()), (2, 2));
        assert_eq!([body("hand").mocap(), body("other_hand").mocap(), body("base").mocap()], [Some(0), Some(1), None]);
    }

    #[test]
    fn only_the_last_actuators_have_activations() {
        let model = zoo();
        let activations: Vec<_> = model.actuators().map(|actuator| actuator.activation()).collect();
        assert_eq!(activations, [None, None, None, Some(0), Some(1), Some(2)]);
    }
}

mod writing {
    use super::*;

    #[test]
    fn positions_velocities_and_forces_of_a_joint_arrive_in_its_ranges() {
        let mut data = simulation();
        let model = data.model().clone();
        let shoulder = model.joint("shoulder").expect("there is a shoulder");
        data.joint_mut(shoulder).qpos_mut().copy_from_slice(&[0.6, 0.8, 0.0, 0.0]);
        data.joint_mut(shoulder).qvel_mut().copy_from_slice(&[1.0, 2.0, 3.0]);
        data.joint_mut(shoulder).qfrc_applied_mut()[1] = 5.0;
        data.joint_mut(shoulder).qacc_mut()[2] = 7.0;
        assert_eq!(data.qpos()[8..12], [0.6, 0.8, 0.0, 0.0]);
        assert_eq!(data.qvel()[7..10], [1.0, 2.0, 3.0]);
        assert_eq!(data.qfrc_applied()[7..10], [0.0, 5.0, 0.0]);
        assert_eq!(data.qacc()[9], 7.0);
        assert!(data.qvel().iter().enumerate().all(|(dof, value)| (7..10).contains(&dof) || *value == 0.0));
    }

    #[test]
    fn what_is_written_in_a_simulation_moves_it() {
        let mut data = simulation();
        let force = |data: &Data| data.joint("rail").expect("a joint").qfrc_actuator()[0];
        let before = force(&data);
        data.actuator_mut("rail").expect("a motor").set_ctrl(2.0);
        data.body_mut("crate").expect("a crate").xfrc_applied_mut()[2] = 100.0;
        data.forward().expect("forward dynamics");
        assert_eq!(data.actuator("rail").expect("a motor").force(), 2.0);
        // The gear is 5. A muscle pulls at the joint too, as before.
        assert!((force(&data) - before - 10.0).abs() < 1e-12, "{before} and {}", force(&data));
        let lift = data.joint("crate").expect("a joint").qacc()[2];
        let expected = 100.0 / 1.5 - 9.81;
        assert!((lift - expected).abs() < 0.5, "{lift} m/s², not {expected}");
    }

    #[test]
    fn what_is_written_to_a_model_changes_the_next_step() {
        let mut data = simulation();
        let fall = |data: &mut Data| {
            data.forward().expect("forward dynamics");
            data.joint("crate").expect("a crate").qfrc_passive().to_vec()
        };
        let before = fall(&mut data);
        data.edit_model(|model| {
            model.joint_mut("crate").expect("a crate").damping_mut().fill(3.0);
            model.body_mut("crate").expect("a crate").set_mass(2.5);
            model.geom_mut("crate").expect("a crate").rgba_mut()[1] = 0.25;
            model.keyframe_mut(1).expect("a keyframe").qpos_mut()[0] = -4.0;
            model.light_mut("lamp").expect("a lamp").set_cutoff(30.0);
        })
        .expect("there is memory");
        data.joint_mut("crate").expect("a crate").qvel_mut()[0] = 1.0;
        let after = fall(&mut data);
        assert!((after[0] - before[0] + 3.0).abs() < 0.1, "{before:?} {after:?}");
        let model = data.model();
        assert_eq!(model.body("crate").expect("a crate").mass(), 2.5);
        assert_eq!(model.body_mass()[3], 2.5);
        assert_eq!(model.geom("crate").expect("a crate").rgba(), &[1.0, 0.25, 0.0, 1.0]);
        assert_eq!(model.light("lamp").expect("a lamp").cutoff(), 30.0);
        data.reset_to_key(1).expect("a keyframe");
        assert_eq!(data.qpos()[0], -4.0);
    }

    #[test]
    fn a_simulation_that_changes_its_model_leaves_that_of_others_as_it_is() {
        let model = zoo();
        let mut data = Data::new(model.clone()).expect("there is memory");
        data.edit_model(|model| model.body_mut("crate").expect("a crate").set_mass(9.0)).expect("there is memory");
        assert_eq!(model.body("crate").expect("a crate").mass(), 1.5);
        assert_eq!(data.model().body("crate").expect("a crate").mass(), 9.0);
    }

    #[test]
    fn every_setter_of_a_tendon_and_an_actuator_writes_its_own_field() {
        let mut model = Model::from_xml_str(ZOO_XML).expect("the zoo loads");
        let before = [model.tendon(1).expect("three").to_string(), model.actuator(1).expect("six").to_string()];
        let mut edit = model.edit();
        let mut rope = edit.tendon_mut("rope").expect("a rope");
        rope.set_width(1.0);
        rope.set_margin(2.0);
        rope.set_stiffness(3.0);
        rope.set_damping(4.0);
        rope.set_frictionloss(5.0);
        rope.set_lengthspring(6.0);
        rope.range_mut().copy_from_slice(&[7.0, 8.0]);
        rope.user_mut().copy_from_slice(&[9.0, 10.0]);
        let mut motor = edit.actuator_mut("rail").expect("a motor");
        motor.gear_mut()[5] = 11.0;
        motor.ctrlrange_mut()[0] = -12.0;
        motor.set_cranklength(13.0);
        motor.gainprm_mut()[9] = 14.0;
        let rope = model.tendon("rope").expect("a rope");
        let found = [
            rope.width(),
            rope.margin(),
            rope.stiffness(),
            rope.damping(),
            rope.frictionloss(),
            rope.lengthspring(),
            rope.range()[0],
            rope.range()[1],
            rope.user()[0],
            rope.user()[1],
        ];
        assert_eq!(found, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
        let motor = model.actuator("rail").expect("a motor");
        assert_eq!(
            [motor.gear()[5], motor.ctrlrange()[0], motor.cranklength(), motor.gainprm()[9]],
            [11.0, -12.0, 13.0, 14.0]
        );
        let after = [model.tendon(1).expect("three").to_string(), model.actuator(1).expect("six").to_string()];
        assert_eq!(before, after, "the neighbours are as they were");
    }
}

mod printing {
    use super::*;

    /// The text behind a field's name in a listing.
    fn field<'t>(listing: &'t str, name: &str) -> &'t str {
        listing
            .lines()
            .find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))
            .unwrap_or_else(|| panic!("no field {name} in\n{listing}"))
            .trim()
    }

    #[test]
    fn a_torso_lists_its_kind_index_name_and_every_field_of_the_reference() {
        let mut data = Data::new(sample::humanoid()).expect("there is memory");
        data.step().expect("a step");
        let torso = data.body("torso").expect("there is a torso");
        let listing = torso.to_string();
        assert!(listing.starts_with("Body:\nindex: "), "{listing}");
        assert_eq!(field(&listing, "name"), "\"torso\"");
        assert_eq!(field(&listing, "index"), "1");
        // The reference's applied, com, linvel, angmom, int and ext have the engine's names here.
        for (name, count) in [
            ("xfrc_applied", 6),
            ("xpos", 3),
            ("xquat", 4),
            ("xmat", 9),
            ("xipos", 3),
            ("ximat", 9),
            ("subtree_com", 3),
            ("cinert", 10),
            ("crb", 10),
            ("cvel", 6),
            ("subtree_linvel", 3),
            ("subtree_angmom", 3),
            ("cacc", 6),
            ("cfrc_int", 6),
            ("cfrc_ext", 6),
        ] {
            let values = field(&listing, name).trim_matches(['[', ']']);
            assert_eq!(values.split(", ").count(), count, "{name}: {values}");
        }
        assert_eq!(field(&listing, "xpos"), "[0.0, 0.0, 1.28]");
        assert_eq!(field(&listing, "xquat"), "[1.0, 0.0, 0.0, 0.0]");
    }

    #[test]
    fn numbers_are_listed_with_four_significant_digits() {
        let mut data = Data::new(sample::humanoid()).expect("there is memory");
        data.step().expect("a step");
        let torso = data.body("torso").expect("there is a torso");
        let listing = torso.to_string();
        for (name, values) in
            [("subtree_com", &torso.subtree_com()[..]), ("cinert", torso.cinert()), ("crb", torso.crb())]
        {
            let listed = field(&listing, name).trim_matches(['[', ']']).split(", ").collect::<Vec<_>>();
            assert_eq!(listed.len(), values.len());
            for (text, value) in listed.into_iter().zip(values) {
                let digits = text.split('e').next().unwrap_or_default().trim_start_matches(['-', '0', '.']);
                assert!(digits.chars().filter(char::is_ascii_digit).count() <= 5, "{name}: {text} for {value}");
                let listed: f64 = text.parse().expect("a number");
                assert!((listed - value).abs() <= 0.5e-3 * value.abs(), "{name}: {text} for {value}");
            }
        }
    }

    #[test]
    fn an_element_without_a_name_and_fields_without_values_are_listed_as_such() {
        let model = sample::cartpole();
        let listing = model.joint("slider").expect("there is a slider").to_string();
        assert_eq!(field(&listing, "user"), "[]");
        assert_eq!(field(&listing, "joint_type"), "Slide");
        assert_eq!(field(&listing, "qpos_range"), "0..1");
        assert_eq!(field(&listing, "limited"), "true");
        assert_eq!(field(&listing, "range"), "[-1.0, 1.0]");
        let listing = zoo().joint(4).expect("five joints").to_string();
        assert_eq!(field(&listing, "name"), "(none)");
    }

    #[test]
    fn debug_texts_are_one_line_with_kind_index_and_name() {
        let model = zoo();
        let mut data = simulation();
        assert_eq!(format!("{:?}", model.joint("elbow").expect("an elbow")), "joint 3 'elbow'");
        assert_eq!(format!("{:?}", model.joint(4).expect("five joints")), "joint 4");
        assert_eq!(format!("{:?}", model.joint("elbow").expect("an elbow").id()), "joint 3");
        assert_eq!(format!("{:?}", data.camera("overview").expect("a camera")), "camera 0 'overview'");
        assert_eq!(format!("{:?}", data.sensor_mut("touch").expect("a sensor")), "sensor 5 'touch'");
        assert_eq!(format!("{:?}", model.keyframe("lifted").expect("a keyframe")), "keyframe 0 'lifted'");
        assert_eq!(
            format!("{model:?}"),
            "Model: 7 bodies, 5 joints, 8 geoms, 6 actuators, 10 sensors, 3 tendons, 2 keyframes (nq 14, nv 12, nu 6)"
        );
        let text = format!("{data:?}");
        assert!(text.starts_with("Data: time 0 s, ") && text.ends_with("(nq 14, nv 12, nu 6)"), "{text}");
    }
}

#[test]
fn readings_of_a_sensor_are_its_part_of_the_sensor_data() {
    let mut data = simulation();
    let model = data.model().clone();
    let elbow = model.sensor("elbow").expect("there is a sensor");
    assert_eq!((elbow.dim(), elbow.data_range()), (1, 3..4));
    data.joint_mut("elbow").expect("an elbow").qpos_mut()[0] = 0.75;
    data.forward().expect("forward dynamics");
    assert_eq!(data.sensor(elbow).data(), [0.75]);
    // Beyond its cutoff of 1 it is clamped.
    data.joint_mut("elbow").expect("an elbow").qpos_mut()[0] = 1.5;
    data.forward().expect("forward dynamics");
    assert_eq!(data.sensor(elbow).data(), [1.0]);
    assert_eq!(data.sensordata()[3], 1.0);
    assert!(!model.options().enable.contains(EnableFlags::SENSORNOISE));
}

#[test]
fn custom_texts_are_found_by_their_address_and_size() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
    let model = mujoco_safe::Model::from_xml_path(path).expect("it is valid");
    let texts: Vec<&[u8]> = (0..model.ntext())
        .map(|text| &model.text_data()[model.text_adr()[text] as usize..][..model.text_size()[text] as usize])
        .collect();
    assert_eq!(texts, [&b"every kind of element\0"[..], b"metre\0"]);
}
