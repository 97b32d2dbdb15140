//! Spatial tendons: their springs and dampers, actuators, limits, friction loss and sensors.

use mujoco_safe::derivative::Fallback;
use mujoco_safe::{Data, sys};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{analytic, check, model, randomise, sensors, without_passive_forces};
use crate::cases::cases;

/// Tendons between a free body, its arm, a pendulum and the world, one of them with a pulley and
/// one along a geom that it may touch.
pub(crate) fn strings(tendon: &str, rest: &str) -> String {
    format!(
        r#"<mujoco><option timestep="0.002" OPTION/>
          <default><geom contype="0" conaffinity="0"/><tendon {tendon}/></default>
          <worldbody>
            <site name="w1" pos="0.3 -0.2 0.9"/><site name="w2" pos="-1 0.4 1.2"/>
            <body name="base" pos="0 0 0.1">
              <freejoint/><geom type="capsule" size="0.1" fromto="-0.15 0 0 0.2 0.05 0.03"/>
              <site name="b1" pos="0.1 0.2 0.1"/><site name="b2" pos="-0.3 0.1 0"/>
              <body name="arm" pos="0.4 0 0.25">
                <joint name="ball" type="ball" pos="-0.03 0.02 0.01" damping="0.1"/>
                <geom type="capsule" size="0.05" fromto="0 0 0 0.3 0.02 -0.05"/><site name="a1" pos="0.3 0 0.05"/>
                <body name="hand" pos="0.32 0 0.05" euler="10 20 30">
                  <joint name="slide" type="slide" axis="1 0.2 -0.1"/><joint name="hinge" axis="0 1 0.3" pos="0.01 0 0.02"/>
                  <geom name="palm" type="sphere" size="0.04" pos="0.05 0 0.01"/><site name="h1" pos="0.3 0.02 0"/>
                </body>
              </body>
            </body>
            <body name="pendulum" pos="1 0 0.5">
              <joint name="swing" axis="0 1 0"/><geom size="0.1" pos="0.2 0.1 -0.3"/><site name="p1" pos="0.2 0.3 -0.3"/>
            </body>
          </worldbody>
          <tendon>
            <spatial name="to_world"><site site="w1"/><site site="h1"/></spatial>
            <spatial name="inside"><site site="b1"/><site site="b2"/><site site="a1"/><site site="h1"/></spatial>
            <spatial name="pulleys">
              <site site="w2"/><site site="b1"/><pulley divisor="2"/><site site="b2"/><site site="p1"/><pulley divisor="3"/>
              <site site="w1"/><site site="a1"/>
            </spatial>
            <spatial name="passing"><site site="p1"/><geom geom="palm"/><site site="w2"/></spatial>
            <fixed name="fixed"><joint joint="slide" coef="1"/><joint joint="swing" coef="-0.5"/></fixed>
          </tendon>
          {rest}</mujoco>"#
    )
}

/// Compares A and B in random states of each format of the Jacobian and each cone. Returns the last
/// state.
fn check_states(xml: &str, seed: u64) -> Data {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut last = None;
    for option in ["", r#"jacobian="sparse""#] {
        let mut data = model(&xml.replace("OPTION", option));
        let mut compared = 0;
        for state in 0..cases(4, 6) {
            randomise(&mut data, &mut random);
            // The tendon may wind around the sphere.
            if analytic(&mut data).1.fallback != Some(Fallback::SpatialTendon) {
                check(&format!("{option}, state {state}"), &mut data);
                compared += 1;
            }
        }
        assert!(compared >= cases(1, 3));
        last = Some(data);
    }
    last.unwrap()
}

#[test]
fn springs_and_dampers_of_spatial_tendons_agree_with_differences() {
    check_states(&strings(r#"stiffness="8" springlength="0.5" damping="0.4""#, ""), 30);
    check_states(&strings(r#"stiffness="8""#, &format!("<option>{}</option>", without_passive_forces())), 31);
}

#[test]
fn actuators_of_spatial_tendons_agree_with_differences() {
    let actuators = r#"<actuator>
        <motor tendon="to_world" gear="2"/><position tendon="inside" kp="4" gear="-1.5"/><velocity tendon="pulleys" kv="0.3"/>
        <general tendon="inside" gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/>
        <motor tendon="to_world" forcelimited="true" forcerange="-0.01 0.01"/>
        <muscle tendon="passing" lengthrange="0.5 3" force="20"/>
      </actuator>"#;
    check_states(&strings("", actuators), 32);
}

#[test]
fn limits_and_friction_loss_of_spatial_tendons_agree_with_differences() {
    for cone in ["", r#"<option cone="elliptic"/>"#] {
        let xml = strings(r#"limited="true" range="0.8 1.2" frictionloss="0.3" solimplimit="0.7 0.95 0.5""#, cone);
        let mut data = check_states(&xml, 33);
        data.forward().unwrap();
        for kind in [sys::mjCNSTR_LIMIT_TENDON, sys::mjCNSTR_FRICTION_TENDON] {
            assert!(data.efc_type().contains(&(kind as i32)));
        }
    }
}

#[test]
fn sensors_of_spatial_tendons_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(34);
    let mut data = model(
        &strings(
            r#"limited="true" range="0.8 1.2" damping="0.2""#,
            r#"<actuator>
                 <velocity name="servo" tendon="inside" kv="2" gear="-1.5"/><muscle name="muscle" tendon="passing" lengthrange="0.5 3"/>
               </actuator>
               <sensor>
                 <tendonpos tendon="pulleys"/><tendonvel tendon="pulleys"/><tendonvel tendon="fixed"/>
                 <tendonlimitpos tendon="inside"/><tendonlimitvel tendon="inside"/><tendonlimitvel tendon="to_world"/>
                 <actuatorpos actuator="servo"/><actuatorvel actuator="servo"/><actuatorfrc actuator="servo"/>
                 <actuatorfrc actuator="muscle"/><accelerometer site="h1"/>
               </sensor>"#,
        )
        .replace("OPTION", ""),
    );
    let mut compared = 0;
    for state in 0..cases(4, 6) {
        randomise(&mut data, &mut random);
        let (ours, report) = analytic(&mut data);
        if report.fallback != Some(Fallback::SpatialTendon) {
            assert!(report.differenced.is_empty());
            sensors::compare(&format!("state {state}"), &data, &ours);
            compared += 1;
        }
    }
    assert!(compared >= cases(1, 3));
}

#[test]
fn an_equality_of_spatial_tendons_falls_back_to_the_implicit_method() {
    let equality = r#"<equality><tendon tendon1="to_world" tendon2="inside"/></equality>"#;
    let mut data = model(&strings("", equality).replace("OPTION", ""));
    randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(35));
    assert_eq!(analytic(&mut data).1.fallback, Some(Fallback::SpatialTendon));
}
