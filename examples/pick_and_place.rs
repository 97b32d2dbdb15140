//! A scene that changes while it runs: an arm from MJCF puts boxes on a shuttle from URDF.
//!
//! ```text
//! cargo run --release --features renderer --example pick_and_place -- --out pick_and_place.gif
//! ```
//!
//! The arm grasps a box (a weld at the present pose), puts it on the shuttle and releases it. Then
//! the program adds a second box to the model of the running simulation, which keeps its state
//! ([`Data::adopt`]), and the arm fetches that too. At the end the shuttle drives off, and the
//! first box is removed. The program prints what happens, and writes a film. `--help` lists the
//! options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;

use clap::Parser;
use common::{command_line, parts};
use mujoco_safe::enums::GeomType;
use mujoco_safe::record::{Recorder, RecorderOptions};
use mujoco_safe::render::{Renderer, RgbImage};
use mujoco_safe::spec::{ActuatorElement, Mount, Spec};
use mujoco_safe::{Data, Result};

/// Place of the arm on the table, m.
const ARM: [f64; 2] = [-0.25, 0.0];
/// Place of a new box on the table, m.
const SUPPLY: [f64; 2] = [0.2, -0.15];
/// Half of the edge of a box, m.
const HALF: f64 = 0.035;
/// Height of the hand above the centre of a box that it holds, m.
const REACH: f64 = HALF + 0.03;
/// Height of the hand above that place while it moves, m.
const LIFT: f64 = 0.28;
/// Height of the arm's shoulder, and lengths of its upper arm, forearm and hand, m.
const SHOULDER: f64 = 0.36;
const UPPER: f64 = 0.33;
const FOREARM: f64 = 0.27;
const HAND: f64 = 0.15;

/// The shuttle: a tray on a rail.
const SHUTTLE: &str = r#"
<robot name="shuttle">
  <material name="steel"><color rgba=".55 .6 .66 1"/></material>
  <link name="world"/>
  <link name="tray">
    <inertial><mass value="2"/><inertia ixx=".02" iyy=".01" izz=".03" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size=".16 .34 .02"/></geometry></collision>
  </link>
  <joint name="rail" type="prismatic">
    <parent link="world"/><child link="tray"/><origin xyz="0 0 .03"/><axis xyz="0 1 0"/>
    <limit lower="-.6" upper=".6" effort="40" velocity="1"/><dynamics damping="10"/>
  </joint>
</robot>"#;

/// Runs an arm that puts boxes on a shuttle, in a scene that changes.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Film; the example `record` lists the formats
    #[arg(long, value_name = "PATH", default_value = "pick_and_place.gif")]
    out: PathBuf,
    /// Frames per second of the film
    #[arg(long, value_name = "N", default_value_t = 20.0)]
    rate: f64,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> std::result::Result<(), Box<dyn Error>> {
    let mut spec = workcell()?;
    add_box(&mut spec, "red", [0.85, 0.3, 0.2, 1.0])?;
    let mut cell = Cell::new(Data::new(spec.compile()?)?, arguments)?;
    cell.wait(0.3)?;
    cell.deliver("red", -0.08)?;

    add_box(&mut spec, "blue", [0.2, 0.4, 0.8, 1.0])?;
    cell.adopt(&spec)?;
    cell.wait(0.3)?;
    cell.deliver("blue", 0.08)?;

    cell.data.actuator_mut("shuttle_rail")?.set_ctrl(0.3);
    cell.wait(1.5)?;
    let red = spec.body("red")?.id();
    spec.remove_with_references(red)?;
    cell.adopt(&spec)?;
    cell.wait(0.5)?;

    let [tray, blue] = ["shuttle_tray", "blue"].map(|name| cell.data.body(name).map(|body| *body.xpos()));
    println!("the shuttle is at y = {:.2} m with the blue box at y = {:.2} m", tray?[1], blue?[1]);
    let recorded = cell.recorder.finish()?;
    println!("wrote {}: {} frames, {:.1} s", recorded.path.display(), recorded.frames, recorded.seconds);
    Ok(())
}

/// Simulation of the scene, and the film of it.
struct Cell {
    data: Data,
    renderer: Renderer,
    recorder: Recorder,
    picture: RgbImage,
    /// Present targets of the arm's servos, rad.
    posture: [f64; 6],
}

/// Servos of the arm.
const SERVOS: [&str; 6] = ["arm_yaw", "arm_pitch", "arm_elbow", "arm_wrist_roll", "arm_wrist_pitch", "arm_wrist_yaw"];

impl Cell {
    fn new(mut data: Data, arguments: &Arguments) -> std::result::Result<Self, Box<dyn Error>> {
        let posture = posture([SUPPLY[0], SUPPLY[1], HALF + LIFT]);
        for (servo, angle) in SERVOS.into_iter().zip(posture) {
            data.joint_mut(servo)?.qpos_mut()[0] = angle;
            data.actuator_mut(servo)?.set_ctrl(angle);
        }
        let renderer = Renderer::new(data.model(), 560, 420)?;
        let options = RecorderOptions::default().with_frames_per_second(arguments.rate);
        let recorder = Recorder::create(&arguments.out, options)?;
        Ok(Self { data, renderer, recorder, picture: RgbImage::default(), posture })
    }

    /// Continues with an edited scene.
    fn adopt(&mut self, spec: &Spec) -> std::result::Result<(), Box<dyn Error>> {
        let adoption = self.data.adopt(spec.compile()?)?;
        self.renderer.adopt(self.data.model())?;
        for (what, elements) in [("added", &adoption.new), ("removed", &adoption.lost)] {
            for element in elements {
                println!("{:5.2} s: {what} {element}", self.data.time());
            }
        }
        Ok(())
    }

    /// Fetches a box and puts it on the shuttle, at a distance along the tray from its centre.
    fn deliver(&mut self, name: &str, along: f64) -> std::result::Result<(), Box<dyn Error>> {
        let grasp = format!("grasp_{name}");
        let [x, y, z] = *self.data.body(name)?.xpos();
        self.move_hand([x, y, z + LIFT], 0.8)?;
        self.move_hand([x, y, z + REACH], 0.5)?;
        self.data.weld_at_present_pose(&grasp[..])?;
        self.move_hand([x, y, z + LIFT], 0.5)?;
        let [x, y, z] = *self.data.body("shuttle_tray")?.xpos();
        let place = [x, y + along, z + 0.01 + HALF];
        self.move_hand([place[0], place[1], place[2] + LIFT], 1.0)?;
        self.move_hand([place[0], place[1], place[2] + REACH + 0.005], 0.5)?;
        self.data.set_equality_active(&grasp[..], false)?;
        self.wait(0.2)?;
        self.move_hand([place[0], place[1], place[2] + LIFT], 0.4)?;
        let found = self.data.body(name)?.xpos();
        let distance = found.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        println!(
            "{:5.2} s: the {name} box is {:.1} mm from its place on the shuttle",
            self.data.time(),
            1e3 * distance
        );
        Ok(())
    }

    /// Moves the hand, which points down, to a place on a smooth path of the joints.
    fn move_hand(&mut self, place: [f64; 3], seconds: f64) -> std::result::Result<(), Box<dyn Error>> {
        let (from, to, start) = (self.posture, posture(place), self.data.time());
        while self.data.time() < start + seconds {
            let part = ((self.data.time() - start) / seconds).min(1.0);
            let part = part * part * (3.0 - 2.0 * part);
            for (servo, (from, to)) in SERVOS.into_iter().zip(from.into_iter().zip(to)) {
                self.data.actuator_mut(servo)?.set_ctrl(from + part * (to - from));
            }
            self.step()?;
        }
        self.posture = to;
        self.wait(0.1)
    }

    fn wait(&mut self, seconds: f64) -> std::result::Result<(), Box<dyn Error>> {
        let end = self.data.time() + seconds;
        while self.data.time() < end {
            self.step()?;
        }
        Ok(())
    }

    fn step(&mut self) -> std::result::Result<(), Box<dyn Error>> {
        // Carry the weight of the arm, which would bend the servos.
        for servo in SERVOS {
            let bias = self.data.joint(servo)?.qfrc_bias()[0];
            self.data.joint_mut(servo)?.qfrc_applied_mut()[0] = bias;
        }
        self.data.step()?;
        if self.recorder.is_due(self.data.time()) {
            self.renderer.snapshot(&mut self.data, "overview")?.rgb_into(&mut self.picture)?;
            self.recorder.push(&self.picture, self.data.time())?;
        }
        Ok(())
    }
}

/// Returns the angles of the joints at which the hand points down at a place relative to the table.
fn posture([x, y, z]: [f64; 3]) -> [f64; 6] {
    let [x, y] = [x - ARM[0], y - ARM[1]];
    let (out, down) = (x.hypot(y), SHOULDER - z - HAND);
    let cosine = (out.powi(2) + down.powi(2) - UPPER.powi(2) - FOREARM.powi(2)) / (2.0 * UPPER * FOREARM);
    let elbow = cosine.clamp(-1.0, 1.0).acos();
    let pitch = down.atan2(out) - (FOREARM * elbow.sin()).atan2(UPPER + FOREARM * elbow.cos());
    [y.atan2(x), pitch, elbow, 0.0, FRAC_PI_2 - pitch - elbow, 0.0]
}

/// Builds the scene without boxes. The table is at the height 0.
fn workcell() -> Result<Spec> {
    let mut spec = Spec::new("cell");
    spec.section_mut("option")?.set("timestep", 0.002)?.set("integrator", "implicit")?;
    spec.section_mut("visual")?.child_mut("headlight")?.set("ambient", [0.35; 3])?.set("diffuse", [0.3; 3])?;
    parts::add_sky(&mut spec, [0.9, 0.93, 0.96], [0.55, 0.66, 0.78])?;
    let world = spec.world();
    spec.add_light(world).set_pos([1.0, -1.0, 2.5]).set_dir([-0.3, 0.3, -1.0]).set_diffuse([0.5; 3]);
    spec.add_camera(world)
        .set_name("overview")
        .set_pos([1.15, -0.55, 0.85])
        .set_xyaxes([0.5, 0.86, 0.0, -0.42, 0.24, 0.87]);
    spec.add_geom(world).set_type(GeomType::Plane).set_size(&[1.5, 1.5, 0.1]).set_rgba([0.72, 0.62, 0.5, 1.0]);
    spec.attach(&parts::servo_arm()?, Mount::body(world).with_pos([ARM[0], ARM[1], 0.0]), "arm_")?;

    let mut shuttle = Spec::from_xml_str(SHUTTLE)?;
    shuttle
        .add_actuator(ActuatorElement::Position)
        .set_name("rail")
        .set_joint("rail")
        .set_kp(60.0)
        .set_ctrlrange([-0.6, 0.6]);
    spec.attach(&shuttle, Mount::body(world).with_pos([0.1, 0.3, 0.0]), "shuttle_")?;
    Ok(spec)
}

/// Adds a box on the table, and the weld by which the hand can hold it.
fn add_box(spec: &mut Spec, name: &str, rgba: [f32; 4]) -> Result<()> {
    let hand = spec.body("arm_wrist")?.id();
    let body = spec.add_body(spec.world()).set_name(name).set_pos([SUPPLY[0], SUPPLY[1], HALF]).id();
    spec.add_freejoint(body);
    spec.add_geom(body).set_type(GeomType::Box).set_size(&[HALF; 3]).set_mass(0.2).set_rgba(rgba);
    let hand = spec.body(hand).name().unwrap_or_default().to_owned();
    let mut section = spec.section_mut("equality")?;
    section
        .add("weld")?
        .set_name(&format!("grasp_{name}"))
        .set("body1", hand)?
        .set("body2", name)?
        .set("active", false)?;
    Ok(())
}
