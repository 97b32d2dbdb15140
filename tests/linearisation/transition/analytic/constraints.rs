//! Limits, friction loss, equalities, and all constraints together, for both cones and both formats
//! of the Jacobian.

use mujoco_safe::derivative::Fallback;
use mujoco_safe::{Data, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::contacts::assert_falls_back;
use super::{OPTIONS, check, model, randomise};
use crate::cases::cases;
use crate::transition::standing;

/// Three free bodies and all joints, with contacts, limits and friction loss.
pub(super) const MIXED: &str = r#"<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.004" CONE/>
  <default><geom friction="0.7 0.02 0.003" solimp="0.85 0.97 0.01 0.4 3" solref="0.02 0.9"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 0.05" pos="0 0 0.02" euler="0.05 -0.03 0.2" condim="3"/>
    <geom name="post" type="capsule" size="0.06" fromto="0.55 -0.5 0.12 0.5 0.5 0.17" condim="4"/>
    <body name="base" pos="0 0 0.3">
      <freejoint/>
      <geom type="capsule" size="0.1" fromto="-0.15 0 0 0.2 0.05 0.03" condim="6" mass="2"/>
      <body name="arm" pos="0.25 0 0.05">
        <joint name="ball" type="ball" pos="-0.03 0.02 0.01" limited="true" range="0 0.35" damping="0.2" stiffness="3"
               solimplimit="0.8 0.99 0.2 0.5 2"/>
        <geom type="capsule" size="0.05" fromto="0 0 0 0.3 0.02 -0.05" mass="0.7" condim="3"/>
        <body name="rod" pos="0.32 0 -0.05">
          <joint name="slide" type="slide" axis="1 0.2 -0.1" limited="true" range="-0.02 0.05" damping="1" stiffness="20"
                 solimplimit="0.8 0.99 0.05 0.5 2" frictionloss="0.5"/>
          <joint name="hinge1" axis="0 1 0.3" pos="0.01 0 0.02" damping="0.1" frictionloss="0.05"/>
          <joint name="hinge2" axis="0.2 0 1" pos="0 0.03 0" damping="0.1" stiffness="1" springref="0.2"/>
          <geom type="sphere" size="0.08" mass="0.5" condim="4"/>
          <geom type="capsule" size="0.03" fromto="0 0 0 0.1 0.1 0" mass="0.3"/>
        </body>
      </body>
    </body>
    <body name="pebble" pos="0.1 0.02 0.5">
      <freejoint/>
      <geom type="sphere" size="0.07" mass="0.6" condim="6" margin="0.01" gap="0.002"/>
    </body>
    <body name="chest" pos="-0.3 0.4 0.12">
      <freejoint/>
      <geom type="box" size="0.1 0.08 0.06" mass="1" condim="3"/>
    </body>
  </worldbody>
  ROWS
  <actuator>
    <motor joint="slide" gear="3"/>
    <position joint="hinge1" kp="4" gear="1.5"/>
    <velocity joint="hinge2" kv="0.3"/>
  </actuator>
</mujoco>"#;

/// Returns a model with all constraints that have a formula: those between bodies have none since
/// 3.7.
pub(crate) fn constrained(option: &str) -> String {
    let bodies = if cfg!(engine_since = "3.7.0") { "" } else { BODIES };
    MIXED.replace("CONE", option).replace("ROWS", &format!("{bodies}{ROWS}"))
}

const BODIES: &str = r#"<equality>
    <connect body1="chest" anchor="0.1 0.05 0.02" solimp="0.8 0.97 0.1 0.4 2"/>
    <weld body1="pebble" body2="rod" solref="0.1 1" solimp="0.7 0.97 0.8 0.5 3" torquescale="0.6"/>
  </equality>
  "#;

const ROWS: &str = r#"<equality>
    <joint joint1="hinge1" joint2="hinge2" polycoef="0.1 0.5 0.3 -0.2 0.1" solimp="0.8 0.97 0.5 0.5 2"/>
    <tendon tendon1="mix" tendon2="other" polycoef="0 0.5 0.3 0 0.1" solimp="0.8 0.97 0.5 0.5 2"/>
  </equality>
  <tendon>
    <fixed name="mix" limited="true" range="-0.02 0.02" stiffness="3" damping="0.3" frictionloss="0.1" solimplimit="0.7 0.95 0.5">
      <joint joint="hinge1" coef="1"/><joint joint="slide" coef="-2"/>
    </fixed>
    <fixed name="other" stiffness="1"><joint joint="hinge2" coef="0.7"/><joint joint="slide" coef="1"/></fixed>
  </tendon>"#;

/// Simulates with random controls until the model has contacts.
pub(crate) fn collide(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    data.reset().unwrap();
    data.qvel_mut().iter_mut().for_each(|qvel| *qvel = random.random_range(-0.5..0.5));
    for _ in 0..random.random_range(50..300) {
        for ctrl in data.ctrl_mut() {
            *ctrl = 0.7 * *ctrl + random.random_range(-0.3..0.3);
        }
        data.step().unwrap();
    }
}

#[test]
fn limits_and_friction_loss_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(10);
    for option in OPTIONS {
        // Without contacts.
        let xml = MIXED
            .replace("CONE", option)
            .replace("ROWS", "")
            .replace("<geom friction", r#"<geom contype="0" conaffinity="0" friction"#);
        let mut data = model(&xml);
        for state in 0..cases(2, 5) {
            randomise(&mut data, &mut random);
            data.forward().unwrap();
            assert!(data.nefc() > 2, "the ball and the slide are at their limits");
            check(&format!("{option}, state {state}"), &mut data);
        }
    }
}

#[test]
fn equality_constraints_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(11);
    for option in OPTIONS {
        let xml = constrained(option).replace("<geom friction", r#"<geom contype="0" conaffinity="0" friction"#);
        let mut data = model(&xml);
        for state in 0..cases(1, 3) {
            collide(&mut data, &mut random);
            assert!(
                data.ne() >= if cfg!(engine_since = "3.7.0") { 2 } else { 11 },
                "all equality constraints have rows"
            );
            check(&format!("{option}, state {state}"), &mut data);
        }
    }
}

/// The Jacobian of the constraint is zero at the second joint.
#[test]
fn a_joint_at_a_minimum_of_its_polynomial_agrees_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(17);
    for option in OPTIONS {
        for second in [0, 1] {
            let joints = ["upper", "lower"];
            let mut data = model(&format!(
                r#"<mujoco><option {option}/><worldbody>
                     <body><joint name="upper" axis="0 1 0"/><geom size="0.1" pos="0.2 0 0"/>
                       <body pos="0.4 0 0"><joint name="lower" axis="0 0.2 1"/><geom size="0.1" pos="0.2 0 0"/></body></body>
                   </worldbody>
                   <equality><joint joint1="{}" joint2="{}" polycoef="0 0 0.5 0 0"/></equality></mujoco>"#,
                joints[1 - second],
                joints[second]
            ));
            for state in 0..cases(1, 3) {
                randomise(&mut data, &mut random);
                data.qpos_mut()[second] = 0.0;
                check(&format!("{option}, joint {second}, state {state}"), &mut data);
            }
        }
    }
}

#[test]
fn bodies_welded_or_connected_to_each_other_or_a_mocap_body_agree_with_differences_or_fall_back() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(12);
    for equality in [
        r#"<connect body1="a" body2="b" anchor="0.1 0.05 0.02"/>"#,
        r#"<connect body1="a" body2="hand" anchor="0.1 0.05 0.02"/>"#,
        r#"<weld body1="a" body2="b" torquescale="0.3"/>"#,
        r#"<weld body1="hand" body2="b"/>"#,
        r#"<weld body1="c" body2="a" relpose="0.1 0.1 0.1 1 0.3 0.2 0.1"/>"#,
    ] {
        let mut data = model(&format!(
            r#"<mujoco><option timestep="0.003"/><worldbody>
                 <body name="hand" mocap="true" pos="0.5 0.2 0.3"/>
                 <body name="a" pos="0 0 1"><freejoint/><geom type="capsule" size="0.05 0.1"/>
                   <body name="c" pos="0 0 0.3"><joint type="ball" damping="0.1"/><geom type="box" size="0.05 0.1 0.02"/></body>
                 </body>
                 <body name="b" pos="0.3 0 1"><joint type="slide" axis="1 0 0"/><joint axis="0 1 0.2"/><geom size="0.07" pos="0.2 0 0"/></body>
               </worldbody><equality>{equality}</equality></mujoco>"#
        ));
        for state in 0..cases(1, 3) {
            randomise(&mut data, &mut random);
            if cfg!(engine_since = "3.7.0") {
                assert_falls_back(&mut data, Fallback::Constraint);
            } else {
                check(&format!("{equality}, state {state}"), &mut data);
            }
        }
    }
}

#[test]
fn all_constraints_together_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(15);
    for option in OPTIONS {
        for xml in [MIXED.replace("CONE", option).replace("ROWS", ""), constrained(option)] {
            let mut data = model(&xml);
            for state in 0..cases(1, 3) {
                collide(&mut data, &mut random);
                assert!(data.ncon() > 0);
                check(&format!("{option}, {} equalities, state {state}", data.ne()), &mut data);
            }
        }
    }
}

#[test]
fn the_humanoid_agrees_with_differences_while_it_stands_falls_and_lies() {
    check("standing", &mut standing());
    let mut random = Xoshiro256PlusPlus::seed_from_u64(16);
    for option in ["pyramidal", "elliptic"] {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.edit_model(|model| {
            model.edit_options(|options| {
                if option == "elliptic" {
                    options.cone = mujoco_safe::enums::Cone::Elliptic;
                }
            })
        })
        .unwrap();
        for state in 0..cases(2, 6) {
            collide(&mut data, &mut random);
            check(&format!("{option}, state {state}, {} contacts", data.ncon()), &mut data);
        }
    }
}
