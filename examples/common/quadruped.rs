//! A small quadruped with an inertial measurement unit in its trunk, and a servo and an encoder at
//! each joint.

use std::f64::consts::{PI, TAU};

use mujoco_safe::{Data, Model, Result};

/// Name, place of the hip (m) and phase of the gait (rad) of each leg.
const LEGS: [(&str, [f64; 2], f64); 4] =
    [("fl", [0.2, 0.12], 0.0), ("fr", [0.2, -0.12], PI), ("rl", [-0.2, 0.12], PI), ("rr", [-0.2, -0.12], 0.0)];
/// Angles of the hips and knees of a standing robot, rad.
const STANCE: [f64; 2] = [0.6, -1.2];

/// Returns the model, on a floor with this friction. The sensors are the gyroscope and the
/// accelerometer, then the encoders of the hip and the knee of each leg.
pub fn model(friction: f64) -> Result<Model> {
    let legs = LEGS.map(|(name, [x, y], _)| {
        format!(
            r#"<body name="{name}_thigh" pos="{x} {y} 0">
                 <joint name="{name}_hip" axis="0 1 0"/>
                 <geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass=".5" contype="0" conaffinity="0"/>
                 <body name="{name}_shin" pos="0 0 -.2">
                   <joint name="{name}_knee" axis="0 1 0"/>
                   <geom type="capsule" fromto="0 0 0 0 0 -.18" size=".015" mass=".2" contype="0" conaffinity="0"/>
                   <geom name="{name}_foot" size=".02" pos="0 0 -.2" mass=".05"/>
                 </body>
               </body>"#
        )
    });
    let joints = LEGS.map(|(name, ..)| [format!("{name}_hip"), format!("{name}_knee")]).concat();
    let each = |element: &dyn Fn(&str) -> String| joints.iter().map(|joint| element(joint)).collect::<String>();
    Model::from_xml_str(&format!(
        r#"<mujoco>
             <option timestep=".005"/>
             <default><joint damping="2" armature=".01"/><geom condim="3" friction="{friction} .005 .0001"/></default>
             <worldbody>
               <geom type="plane" size="10 10 .1"/>
               <body name="trunk" pos="0 0 .355">
                 <freejoint/>
                 <geom type="box" size=".25 .1 .05" mass="6"/>
                 <site name="imu" pos=".05 0 .02"/>
                 {legs}
               </body>
             </worldbody>
             <actuator>{servos}</actuator>
             <sensor><gyro name="gyro" site="imu"/><accelerometer name="accelerometer" site="imu"/>{encoders}</sensor>
           </mujoco>"#,
        legs = legs.concat(),
        servos = each(&|joint| format!(r#"<position name="{joint}" joint="{joint}" kp="100"/>"#)),
        encoders = each(&|joint| format!(r#"<jointpos name="{joint}" joint="{joint}"/>"#)),
    ))
}

/// Returns the robot at rest on the floor.
pub fn standing(model: Model) -> Result<Data> {
    let mut data = Data::new(model)?;
    data.qpos_mut()[7..].copy_from_slice(&STANCE.repeat(4));
    data.ctrl_mut().copy_from_slice(&STANCE.repeat(4));
    data.step_n(400)?;
    Ok(data)
}

/// Returns the targets of the servos after this time of a trot, s, which starts slowly.
pub fn trot(time: f64) -> [f64; 8] {
    let amplitude = (time / 0.5).min(1.0);
    let mut targets = [0.0; 8];
    for ((_, _, phase), target) in LEGS.iter().zip(targets.chunks_exact_mut(2)) {
        let (sin, cos) = (TAU * 1.5 * time + phase).sin_cos();
        // The foot is lifted while it swings forward.
        let lift = amplitude * 0.5 * cos.max(0.0);
        target[0] = STANCE[0] - amplitude * 0.2 * sin + 0.5 * lift;
        target[1] = STANCE[1] - lift;
    }
    targets
}
