//! Contacts added by the caller.

use mujoco_safe::data::NewContact;
use mujoco_safe::enums::{Cone, JacobianStorage};
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Data, Error, Model, Result};

/// Returns a ball far above a floor, with room for three contacts.
fn ball() -> Data {
    let xml = r#"<mujoco>
        <size nconmax="3" njmax="100"/>
        <worldbody>
          <geom name="floor" type="plane" size="5 5 .1"/>
          <body name="ball" pos="0 0 3"><freejoint/><geom name="ball" size=".1"/></body>
          <body name="fixed" pos="2 0 3"><geom name="fixed" size=".1"/></body>
        </worldbody>
        <actuator><adhesion body="ball" ctrlrange="0 1" gain="10"/></actuator>
      </mujoco>"#;
    Data::new(Model::from_xml_str(xml).unwrap()).unwrap()
}

fn contact(data: &Data, other: &str) -> NewContact {
    let geoms = [other, "ball"].map(|name| data.model().geom(name).unwrap().id());
    NewContact::new(geoms, -0.01, [0.0, 0.0, 2.9], [0.0, 0.0, 2.0])
}

fn solve(data: &mut Data) -> Result<()> {
    data.make_constraint()?;
    data.transmission()?;
    data.project_constraint()?;
    data.fwd_velocity()?;
    data.fwd_actuation()?;
    data.fwd_acceleration()?;
    data.fwd_constraint()
}

#[test]
fn an_added_contact_carries_the_weight() {
    for dim in [1, 3, 4, 6] {
        for cone in [Cone::Pyramidal, Cone::Elliptic] {
            for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
                let mut data = ball();
                data.edit_model(|model| {
                    model.edit_options(|options| (options.cone, options.jacobian) = (cone, jacobian)).unwrap();
                })
                .unwrap();
                data.fwd_position().unwrap();
                assert_eq!(data.contacts().len(), 0);
                data.add_contact(&NewContact { dim, ..contact(&data, "floor") }).unwrap();
                assert!(matches!(data.fwd_velocity(), Err(Error::NotComputed { .. })), "its rows are not computed yet");
                solve(&mut data).unwrap();
                let found = data.contacts().next().unwrap();
                assert_eq!((found.dim(), found.is_active()), (dim, true));
                assert_eq!(found.normal(), &[0.0, 0.0, 1.0]);
                // The contact carries the weight, and pushes the ball out of the penetration.
                let weight = 9.81 * data.model().body_mass()[1];
                assert!(found.force().unwrap().force[0] > weight, "{dim}, {cone:?}, {jacobian:?}");
                assert!(data.qacc()[2] > 0.0);
                // The next step does not have the contact.
                data.step().unwrap();
                assert_eq!(data.contacts().len(), 0);
            }
        }
    }
}

#[test]
fn a_contact_of_static_geoms_has_no_effect() {
    for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
        let mut data = ball();
        data.edit_model(|model| model.edit_options(|options| options.jacobian = jacobian)).unwrap();
        data.fwd_position().unwrap();
        let geoms = ["floor", "fixed"].map(|name| data.model().geom(name).unwrap().id());
        data.add_contact(&NewContact::new(geoms, -0.01, [0.0; 3], [0.0, 0.0, 1.0])).unwrap();
        // Twice, because the engine marks the contact the first time.
        solve(&mut data).unwrap();
        solve(&mut data).unwrap();
        assert!((data.qacc()[2] + 9.81).abs() < 1e-9, "the ball falls");
    }
}

#[test]
fn invalid_numbers_of_a_contact_are_errors() {
    let mut data = ball();
    let good = contact(&data, "floor");
    assert!(matches!(data.add_contact(&good), Err(Error::NotComputed { call: "add_contact", .. })));
    data.fwd_position().unwrap();
    let nan = f64::NAN;
    for invalid in [
        NewContact { dim: 0, ..good },
        NewContact { dim: 2, ..good },
        NewContact { dim: 7, ..good },
        NewContact { dim: usize::MAX, ..good },
        NewContact { dist: nan, ..good },
        NewContact { includemargin: f64::INFINITY, ..good },
        NewContact { pos: [0.0, nan, 0.0], ..good },
        NewContact { normal: [0.0; 3], ..good },
        NewContact { normal: [nan; 3], ..good },
        NewContact { normal: [1e300; 3], ..good },
        NewContact { friction: [1.0, 1.0, -1.0, 1.0, 1.0], ..good },
        NewContact { solref: [nan, 1.0], ..good },
        NewContact { solimp: [0.9, 0.95, nan, 0.5, 2.0], ..good },
    ] {
        assert!(matches!(data.add_contact(&invalid), Err(Error::Invalid { .. })), "{invalid:?}");
    }
    assert_eq!(data.contacts().len(), 0);
}

#[test]
fn a_full_contact_buffer_is_an_error() {
    let mut data = ball();
    data.fwd_position().unwrap();
    let new = contact(&data, "floor");
    for _ in 0..3 {
        data.add_contact(&new).unwrap();
    }
    let error = data.add_contact(&new).unwrap_err();
    assert!(error.to_string().contains("nconmax"), "{error}");
    assert_eq!(data.contacts().len(), 3);
    solve(&mut data).unwrap();
    assert!(data.contacts().all(|contact| contact.is_active()));
}

#[test]
fn adding_a_contact_is_an_error_if_contacts_are_disabled() {
    for flag in [DisableFlags::CONTACT, DisableFlags::CONSTRAINT] {
        let mut data = ball();
        data.edit_model(|model| model.edit_options(|options| options.disable |= flag)).unwrap();
        data.fwd_position().unwrap();
        let new = contact(&data, "floor");
        assert!(matches!(data.add_contact(&new), Err(Error::Unsupported(_))), "{flag:?}");
    }
}

#[test]
#[should_panic(expected = "another model")]
fn a_contact_of_a_geom_of_another_model_panics() {
    let (mut data, other) = (ball(), ball());
    data.fwd_position().unwrap();
    let _ = data.add_contact(&contact(&other, "floor"));
}
