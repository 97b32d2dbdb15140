//! A model that is attached at a pose moves as it does alone, in the frame of the pose. The
//! expected values are those of the model alone and an identity of mechanics: the laws of motion
//! are the same in each frame that does not move.

use mujoco_safe::math::{Pose, rot_vec_quat, trn_vec_pose};
use mujoco_safe::spec::{Mount, Spec};
use mujoco_safe::{Data, Model, sys};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::schema_models::Node;
use super::counts::Counts;

const MOUNT: Pose = Pose { pos: [0.3, -0.2, 0.5], quat: [0.8, 0.0, 0.36, -0.48] };

/// Attaches a spec to the world at a pose, and to a body that does not move.
pub(super) fn check(name: &str, spec: &Spec, alone: Model, rng: &mut Xoshiro256PlusPlus, counts: &mut Counts) {
    let Ok(mut alone) = Data::new(alone) else { return };
    for is_body in [false, true] {
        // The joints of vertices in the world keep its axes, so the same state has other numbers.
        #[cfg(engine_since = "3.0.0")]
        if !is_body && has_vertices_in_world(alone.model()) {
            continue;
        }
        let what = format!("{} {name}", if is_body { "in a body" } else { "at a pose" });
        let moved = attached(spec, alone.model(), is_body).and_then(|spec| spec.compile()).and_then(Data::new);
        counts.operations += 1;
        let mut moved = match moved {
            Ok(moved) => moved,
            Err(error) => {
                counts.refuse(&what, &error);
                continue;
            }
        };
        let found =
            move_both(&mut alone, &mut moved, rng).map_or_else(|error| vec![error], |()| differences(&alone, &moved));
        if found.is_empty() {
            counts.same += 1;
        } else {
            counts.differ.push(format!("{found:?} {what}"));
        }
    }
}

/// Returns `true` if a body that carries a part of a flex is in the world and moves.
#[cfg(engine_since = "3.0.0")]
fn has_vertices_in_world(model: &Model) -> bool {
    let mut bodies = model.flex_vertbodyid().to_vec();
    #[cfg(engine_since = "3.3.0")]
    bodies.extend(model.flex_nodebodyid());
    let is_in_world = |body: usize| model.body_parentid()[body] == 0 && model.body_dofnum()[body] > 0;
    bodies.into_iter().filter_map(|body| usize::try_from(body).ok()).any(is_in_world)
}

/// Attaches a spec to one with the same settings, whose gravity, wind and magnetic field have the
/// same direction in the frame of the pose, and whose angles have other units.
fn attached(spec: &Spec, alone: &Model, is_body: bool) -> mujoco_safe::Result<Spec> {
    let words = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let settings = ["compiler", "option", "size", "statistic", "visual"];
    let mut document = Node::parse(&spec.to_xml());
    document.children.retain(|section| settings.contains(&&section.name[..]));
    let mut option = Node::new("option");
    let options = alone.options();
    for (name, vector) in [("gravity", options.gravity), ("wind", options.wind), ("magnetic", options.magnetic)] {
        option.set(name, &words(&rot_vec_quat(&vector, &MOUNT.quat)));
    }
    let mut compiler = Node::new("compiler");
    compiler.set("angle", "radian");
    compiler.set("eulerseq", "zyx");
    document.children.extend([option, compiler]);
    if is_body {
        let stand = document.descend(["worldbody", "body"]);
        stand.set("name", "the stand");
        stand.set("pos", &words(&MOUNT.pos));
        stand.set("quat", &words(&MOUNT.quat));
    }
    let mut outer = Spec::from_xml_str(&document.text())?;
    let mount = if is_body {
        Mount::body(outer.body("the stand")?.id())
    } else {
        Mount::body(outer.world()).with_pos(MOUNT.pos).with_quat(MOUNT.quat)
    };
    outer.attach(spec, mount, "p_")?;
    Ok(outer)
}

fn is_free(model: &Model, joint: usize) -> bool {
    model.jnt_type()[joint] == sys::mjJNT_FREE as i32
}

/// Gives both simulations the same state with respect to their frames.
fn move_both(alone: &mut Data, moved: &mut Data, rng: &mut Xoshiro256PlusPlus) -> Result<(), String> {
    let sizes = |model: &Model| [model.nq(), model.nv(), model.nu(), model.na(), model.ngeom(), model.nsensordata()];
    let [ours, theirs] = [&*moved, &*alone].map(|data| sizes(data.model()));
    if ours != theirs {
        return Err(format!("sizes {ours:?} instead of {theirs:?}"));
    }
    let velocity: Vec<f64> = (0..alone.model().nv()).map(|_| rng.random_range(-0.5..0.5)).collect();
    let control: Vec<f64> = (0..alone.model().nu()).map(|_| rng.random_range(-0.5..0.5)).collect();
    let turned = turned(alone.model(), &velocity);
    for (data, velocity) in [(alone, velocity), (moved, turned)] {
        data.reset().and_then(|()| data.integrate_pos(&velocity, 0.3)).map_err(|error| error.to_string())?;
        data.qvel_mut().copy_from_slice(&velocity);
        data.ctrl_mut().copy_from_slice(&control);
        data.forward().map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Turns the linear velocities or forces of free joints, which are in the frame of the world.
fn turned(model: &Model, velocity: &[f64]) -> Vec<f64> {
    let mut turned = velocity.to_vec();
    for joint in (0..model.njnt()).filter(|&joint| is_free(model, joint)) {
        let first = model.jnt_dofadr()[joint] as usize;
        let linear = &mut turned[first..first + 3];
        linear.copy_from_slice(&rot_vec_quat(&[linear[0], linear[1], linear[2]], &MOUNT.quat));
    }
    turned
}

/// Returns the values that differ from those of the model alone.
fn differences(alone: &Data, moved: &Data) -> Vec<String> {
    const TOLERANCE: f64 = 1e-7;
    let mut found = Vec::new();
    let mut compare = |name: &str, expected: &[f64], ours: &[f64]| {
        let size = expected.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= TOLERANCE * size || (a.is_nan() && b.is_nan());
        if expected.len() != ours.len() {
            found.push(format!("{name}: {} numbers instead of {}", ours.len(), expected.len()));
        } else if let Some(at) = expected.iter().zip(ours).position(|pair| !is_near(pair)) {
            found.push(format!("{name}[{at}]: {} instead of {}", ours[at], expected[at]));
        }
    };
    let points = |points: &[[f64; 3]]| points.iter().flat_map(|point| trn_vec_pose(&MOUNT, point)).collect::<Vec<_>>();
    let vectors = |all: &[[f64; 3]]| all.iter().flat_map(|one| rot_vec_quat(one, &MOUNT.quat)).collect::<Vec<_>>();
    let matrices = |all: &[[f64; 9]]| {
        let columns = |one: &[f64; 9]| [0, 1, 2].map(|column| [one[column], one[column + 3], one[column + 6]]);
        let turn = |one: &[f64; 9]| columns(one).map(|column| rot_vec_quat(&column, &MOUNT.quat));
        all.iter()
            .flat_map(|one| {
                let c = turn(one);
                std::array::from_fn::<f64, 9, _>(|cell| c[cell % 3][cell / 3])
            })
            .collect::<Vec<_>>()
    };
    let model = alone.model();
    // The stand is before the bodies of the model.
    let more = moved.model().nbody() - model.nbody();
    let bodies = 1 + more..;
    compare("xpos", &points(&alone.xpos()[1..]), moved.xpos()[bodies.clone()].as_flattened());
    compare("xmat", &matrices(&alone.xmat()[1..]), moved.xmat()[bodies.clone()].as_flattened());
    // The compiler gives a body without mass and geoms an inertial frame that depends on its pose.
    let masses = &model.body_subtreemass()[1..];
    let centres = |all: &[[f64; 3]]| {
        all.iter().zip(masses).filter(|&(_, &mass)| mass > 0.0).map(|(centre, _)| *centre).collect::<Vec<_>>()
    };
    let ours = centres(&moved.subtree_com()[bodies]);
    compare("subtree_com", &points(&centres(&alone.subtree_com()[1..])), ours.as_flattened());
    compare("geom_xpos", &points(alone.geom_xpos()), moved.geom_xpos().as_flattened());
    compare("geom_xmat", &matrices(alone.geom_xmat()), moved.geom_xmat().as_flattened());
    compare("site_xpos", &points(alone.site_xpos()), moved.site_xpos().as_flattened());
    compare("site_xmat", &matrices(alone.site_xmat()), moved.site_xmat().as_flattened());
    compare("cam_xpos", &points(alone.cam_xpos()), moved.cam_xpos().as_flattened());
    compare("light_xpos", &points(alone.light_xpos()), moved.light_xpos().as_flattened());
    compare("light_xdir", &vectors(alone.light_xdir()), moved.light_xdir().as_flattened());
    compare("xanchor", &points(alone.xanchor()), moved.xanchor().as_flattened());
    #[cfg(engine_since = "3.5.0")]
    compare("flexvert_xpos", &points(alone.flexvert_xpos()), moved.flexvert_xpos().as_flattened());
    // Cameras with a target are upright in the world.
    let upright = [sys::mjCAMLIGHT_TARGETBODY, sys::mjCAMLIGHT_TARGETBODYCOM].map(|mode| mode as i32);
    let turns: Vec<usize> = (0..model.ncam()).filter(|&camera| !upright.contains(&model.cam_mode()[camera])).collect();
    let of = |data: &Data| turns.iter().map(|&camera| data.cam_xmat()[camera]).collect::<Vec<_>>();
    compare("cam_xmat", &matrices(&of(alone)), of(moved).as_flattened());
    compare("ten_length", alone.ten_length(), moved.ten_length());
    compare("actuator_length", alone.actuator_length(), moved.actuator_length());
    compare("actuator_velocity", alone.actuator_velocity(), moved.actuator_velocity());
    compare("actuator_force", alone.actuator_force(), moved.actuator_force());
    // Not the accelerations: random joints can have a singular inertia.
    compare("qfrc_smooth", &turned(model, alone.qfrc_smooth()), moved.qfrc_smooth());
    // The rows of a constraint are in the frame of the world. Contacts may be others, because their
    // frames depend on it. The engine leaves out constraints whose Jacobian is 0, which rounding
    // decides for bodies that are fixed to each other.
    let norm = |data: &Data| data.efc_pos()[..data.ne()].iter().map(|row| row * row).sum::<f64>();
    compare("equality", &[norm(alone)], &[norm(moved)]);
    for sensor in (0..model.nsensor()).filter(|&sensor| is_local(model, sensor)) {
        let cells = model.sensor_adr()[sensor] as usize..;
        let cells = cells.start..cells.start + model.sensor_dim()[sensor] as usize;
        compare(&format!("sensor {sensor}"), &alone.sensordata()[cells.clone()], &moved.sensordata()[cells]);
    }
    found
}

/// Returns `true` for sensors that measure in the frame of an element, without forces of
/// constraints.
fn is_local(model: &Model, sensor: usize) -> bool {
    const LOCAL: [u32; 16] = [
        sys::mjSENS_VELOCIMETER,
        sys::mjSENS_GYRO,
        sys::mjSENS_MAGNETOMETER,
        sys::mjSENS_JOINTPOS,
        sys::mjSENS_JOINTVEL,
        sys::mjSENS_TENDONPOS,
        sys::mjSENS_TENDONVEL,
        sys::mjSENS_ACTUATORPOS,
        sys::mjSENS_ACTUATORVEL,
        sys::mjSENS_ACTUATORFRC,
        sys::mjSENS_BALLQUAT,
        sys::mjSENS_BALLANGVEL,
        sys::mjSENS_JOINTLIMITPOS,
        sys::mjSENS_JOINTLIMITVEL,
        sys::mjSENS_TENDONLIMITPOS,
        sys::mjSENS_TENDONLIMITVEL,
    ];
    const RELATIVE: [u32; 6] = [
        sys::mjSENS_FRAMEPOS,
        sys::mjSENS_FRAMEXAXIS,
        sys::mjSENS_FRAMEYAXIS,
        sys::mjSENS_FRAMEZAXIS,
        sys::mjSENS_FRAMELINVEL,
        sys::mjSENS_FRAMEANGVEL,
    ];
    let kind = model.sensor_type()[sensor] as u32;
    LOCAL.contains(&kind) || (RELATIVE.contains(&kind) && model.sensor_refid()[sensor] >= 0)
}
