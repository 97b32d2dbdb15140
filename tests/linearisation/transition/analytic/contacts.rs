//! Contacts of each pair of shapes, for both cones, each dimension and both formats of the
//! Jacobian.

use mujoco_safe::derivative::{DifferencedTerms, Fallback, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{OPTIONS, analytic, check, model, randomise};

use crate::cases::cases;

/// Two free bodies in contact.
fn pair(option: &str, dim: usize, geoms: [&str; 2]) -> Model {
    let [first, second] = geoms;
    Model::from_xml_str(&format!(
        r#"<mujoco><option timestep="0.003" {option}/>
             <default><geom condim="{dim}" friction="0.8 0.02 0.01" solref="0.03 0.8" solimp="0.8 0.95 0.05 0.5 3"/></default>
             <worldbody>
               <body><freejoint/><geom type="{first}"/></body>
               <body pos="0 0 0.12"><joint type="slide" axis="0 0 1"/><joint type="slide" axis="1 0 0"/><joint type="ball"/><geom type="{second}"/></body>
             </worldbody></mujoco>"#
    ))
    .unwrap()
}

#[test]
fn contacts_of_spheres_and_capsules_agree_with_differences_for_each_cone_and_dimension() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(13);
    let (sphere, capsule) = (r#"sphere" size="0.1"#, r#"capsule" size="0.08 0.15"#);
    for option in OPTIONS {
        for dim in [1, 3, 4, 6] {
            for geoms in [[sphere, sphere], [sphere, capsule], [capsule, capsule]] {
                let mut data = Data::new(pair(option, dim, geoms)).unwrap();
                let mut states = 0;
                while states < cases(1, 2) {
                    // This test does not cover parallel capsules and contacts with several points.
                    if !overlap(&mut data, &mut random) || data.ncon() != 1 {
                        continue;
                    }
                    states += 1;
                    let differenced = check(&format!("{option}, {dim}, {geoms:?}, state {states}"), &mut data);
                    assert!(differenced.is_empty());
                }
            }
        }
    }
}

/// Returns a body that slides and turns above an inclined plane.
fn above_plane(option: &str, dim: usize, geom: &str) -> Data {
    model(&format!(
        r#"<mujoco><option timestep="0.003" {option}/>
             <asset><mesh name="m" vertex="0.1 0 0  -0.1 0.05 0  -0.1 -0.05 0  0 0 0.1  0 0.02 -0.06"/></asset>
             <default><geom condim="{dim}" friction="0.8 0.02 0.01"/></default>
             <worldbody>
               <geom type="plane" size="1 1 1" euler="20 -30 10"/>
               <body>
                 <joint type="slide" axis="0 0 1" damping="1"/><joint type="slide" axis="0 1 0"/><joint type="ball"/>
                 <geom {geom}/>
               </body>
             </worldbody></mujoco>"#
    ))
}

/// Moves the body of [`above_plane`] to a random state in contact.
fn touch(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    loop {
        randomise(data, random);
        data.qpos_mut()[..2].copy_from_slice(&[0.05, 0.01]);
        data.forward().unwrap();
        if data.nefc() > 0 {
            return;
        }
    }
}

#[test]
fn contacts_with_a_plane_agree_with_differences_for_each_cone_and_dimension() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(14);
    let (sphere, capsule, cuboid) =
        (r#"type="sphere" size="0.1""#, r#"type="capsule" size="0.05 0.1""#, r#"type="box" size="0.05 0.06 0.07""#);
    for option in OPTIONS {
        for dim in [1, 3, 4, 6] {
            for geom in [sphere, capsule, cuboid] {
                let mut data = above_plane(option, dim, geom);
                for state in 0..cases(1, 2) {
                    touch(&mut data, &mut random);
                    let differenced = check(&format!("{option}, {dim}, {geom}, state {state}"), &mut data);
                    assert!(differenced.is_empty());
                }
            }
        }
    }
    for geom in
        [r#"type="cylinder" size="0.06 0.1""#, r#"type="ellipsoid" size="0.06 0.1 0.08""#, r#"type="mesh" mesh="m""#]
    {
        let mut data = above_plane("", 3, geom);
        for state in 0..cases(2, 4) {
            touch(&mut data, &mut random);
            let differenced = check(&format!("{geom}, state {state}"), &mut data);
            assert_eq!(differenced, DifferencedTerms::CONTACTS);
        }
    }
}

/// Returns a simulation with an active contact whose collision function iterates.
pub(crate) fn without_formula() -> Data {
    let geoms = [r#"sphere" size="0.1"#, r#"cylinder" size="0.1 0.1"#];
    let mut data = Data::new(pair("", 3, geoms)).unwrap();
    data.forward().unwrap();
    data
}

#[test]
fn contacts_by_iteration_and_of_singular_capsules_fall_back_to_the_implicit_method() {
    let capsule = r#"capsule" size="0.08 0.15"#;
    for geoms in
        [[r#"ellipsoid" size="0.1 0.2 0.15"#; 2], [r#"sphere" size="0.1"#, r#"cylinder" size="0.1 0.1"#], [capsule; 2]]
    {
        let mut data = Data::new(pair("", 3, geoms)).unwrap();
        assert_falls_back(&mut data, Fallback::Constraint);
    }
    // The first tangent is the projection of the capsule's axis to the plane, which vanishes.
    let upright = r#"<mujoco><worldbody>
        <geom type="plane" size="1 1 1"/><body pos="0 0 0.14"><freejoint/><geom type="capsule" size="0.05 0.1"/></body>
      </worldbody></mujoco>"#;
    assert_falls_back(&mut model(upright), Fallback::Constraint);
}

#[test]
fn the_limit_of_a_ball_at_its_zero_rotation_falls_back_to_the_implicit_method() {
    let xml = r#"<mujoco><worldbody>
        <body><joint type="ball" limited="true" range="0 1" margin="0.1"/><geom size="0.1" pos="0.2 0 0"/></body>
      </worldbody></mujoco>"#;
    assert_falls_back(&mut model(xml), Fallback::Singular);
}

#[track_caller]
pub(super) fn assert_falls_back(data: &mut Data, reason: Fallback) {
    let (system, report) = analytic(data);
    assert_eq!((report.method, report.fallback), (TransitionMethod::Implicit, Some(reason)));
    let options = TransitionOptions::default().with_method(TransitionMethod::Implicit);
    assert_eq!(system, Lineariser::new(data.model().clone(), options).unwrap().linear_system(data).unwrap().0);
}

/// Moves two bodies of [`pair`] until they overlap, and returns whether they have a contact.
fn overlap(data: &mut Data, random: &mut Xoshiro256PlusPlus) -> bool {
    data.reset().unwrap();
    let model = data.model().clone();
    let mut shift = vec![0.0; model.nv()];
    for (dof, shift) in shift.iter_mut().enumerate() {
        let is_rotation = [3, 4, 5].contains(&dof) || dof > 7;
        *shift = random.random_range(-1.0..1.0) * if is_rotation { 2.0 } else { 0.03 };
    }
    model.integrate_pos(data.qpos_mut(), &shift, 1.0).unwrap();
    data.qvel_mut().iter_mut().for_each(|qvel| *qvel = random.random_range(-0.3..0.3));
    data.forward().unwrap();
    data.contacts().any(|contact| contact.dist() < -0.001)
}

#[test]
fn a_contact_nearly_as_deep_as_a_radius_agrees_with_differences() {
    // The centre of the sphere is 2 mm from the edge of the box, about which the normal turns.
    let xml = r#"<mujoco><worldbody>
        <geom type="box" size="0.1 0.2 0.1"/>
        <body pos="0.1014 0.03 0.1014"><freejoint/><geom type="sphere" size="0.05"/></body>
      </worldbody></mujoco>"#;
    let mut data = model(xml);
    data.qvel_mut().copy_from_slice(&[0.2, 0.1, -0.3, 0.5, -0.4, 0.3]);
    assert_eq!(check("a deep contact", &mut data), DifferencedTerms::CONTACTS);
}

/// The collision function has another formula on the other side of the border.
#[test]
fn a_contact_within_two_micrometres_of_the_border_of_a_face_agrees_with_differences() {
    // Beyond the border of the upper face, and in the box beneath a side face.
    for centre in [[0.1 + 1.5e-6, 0.01, 0.17], [0.1 - 1.5e-6, 0.02, 0.03]] {
        let [x, y, z] = centre;
        let mut data = model(&format!(
            r#"<mujoco><worldbody>
                 <geom type="box" size="0.1 0.1 0.1"/>
                 <body pos="{x} {y} {z}">
                   <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint axis="0 1 0" pos="0.3 0 0.1"/>
                   <geom type="sphere" size="0.08"/>
                 </body>
               </worldbody></mujoco>"#
        ));
        data.qvel_mut().copy_from_slice(&[0.1, -0.2, 0.3]);
        assert_eq!(check(&format!("{centre:?}"), &mut data), DifferencedTerms::CONTACTS);
    }
}

#[test]
fn contacts_by_differences_of_their_collision_function_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(17);
    let (sphere, capsule, cuboid) =
        (r#"sphere" size="0.1"#, r#"capsule" size="0.04 0.1"#, r#"box" size="0.08 0.07 0.06"#);
    for option in [OPTIONS[0], OPTIONS[2]] {
        for geoms in [[sphere, cuboid], [capsule, cuboid], [cuboid, cuboid]] {
            let mut data = Data::new(pair(option, 3, geoms)).unwrap();
            for state in 0..cases(1, 4) {
                while !overlap(&mut data, &mut random) {}
                let differenced = check(&format!("{option}, {geoms:?}, state {state}"), &mut data);
                assert_eq!(differenced, DifferencedTerms::CONTACTS);
            }
        }
    }
}
