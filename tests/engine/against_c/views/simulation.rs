//! Fields of elements in a simulation.

use mujoco_safe::element::WrapPoint;
use mujoco_safe::sys::{self, mjData, mjModel};

use super::{Bits, check_fields, every_element, int, joint_sizes, on_data, on_model, raw, span};
use crate::twins::{Twins, differing, read, usual_subjects};

/// Returns numbers of an engine array, as bits.
fn at(array: *const f64, start: usize, length: usize) -> Vec<u64> {
    // SAFETY: the engine's arrays have a row for each element.
    unsafe { read(array, start, length) }.bits()
}

fn mocap(m: &mjModel, body: usize) -> Option<usize> {
    usize::try_from(raw(m.body_mocapid, body)).ok()
}

/// Returns the index of an actuator's activation: actuators with dynamics have activations, in the
/// order of the actuators.
fn activation(m: &mjModel, actuator: usize) -> Option<usize> {
    let has_one = |at: usize| raw(m.actuator_dyntype, at) as u32 != sys::mjDYN_NONE;
    has_one(actuator).then(|| (0..actuator).filter(|at| has_one(*at)).count())
}

/// Returns the object and the position of a wrap point, as bits.
fn raw_point(point: &WrapPoint) -> (i32, Option<Vec<u64>>) {
    match point {
        WrapPoint::Site { xpos } => (-1, Some(xpos.bits())),
        WrapPoint::Geom { geom, xpos } => (geom.index() as i32, Some(xpos.bits())),
        WrapPoint::Pulley => (-2, None),
        other => panic!("unexpected wrap point: {other:?}"),
    }
}

fn engine_point(d: &mjData, point: usize) -> (i32, Option<Vec<u64>>) {
    let object = raw(d.wrap_obj, point);
    (object, (object != -2).then(|| at(d.wrap_xpos, 3 * point, 3)))
}

#[test]
fn fields_of_elements_in_a_simulation_equal_c() {
    for subject in usual_subjects().chain([every_element()]) {
        let mut twins = Twins::in_motion(subject);
        twins.ours.inverse().unwrap();
        twins.ours.subtree_vel().unwrap();
        twins.ours.rne_post_constraint().unwrap();
        let (name, data) = (&subject.name, &twins.ours);
        let (m, d) = (on_model(&twins.model), on_data(data));
        // SAFETY: the tendons and actuators of the model.
        let tendon_jacobian = |i| unsafe { differing::tendon_jacobian(m, d, i) };
        // SAFETY: as above.
        let moment = |i| unsafe { differing::actuator_moment(m, d, i) };
        check_fields!(name, data.bodies(), |body, i| {
            xfrc_applied: d.xfrc_applied, [6 * i; 6];
            xpos: d.xpos, [3 * i; 3];
            xquat: d.xquat, [4 * i; 4];
            xmat: d.xmat, [9 * i; 9];
            xipos: d.xipos, [3 * i; 3];
            ximat: d.ximat, [9 * i; 9];
            subtree_com: d.subtree_com, [3 * i; 3];
            cinert: d.cinert, [10 * i; 10];
            crb: d.crb, [10 * i; 10];
            cvel: d.cvel, [6 * i; 6];
            // The program smoke has models with sleeping bodies.
            => is_asleep: body.is_asleep(), false;
            => subtree_linvel: body.subtree_linvel().unwrap().bits(), at(d.subtree_linvel, 3 * i, 3);
            => subtree_angmom: body.subtree_angmom().unwrap().bits(), at(d.subtree_angmom, 3 * i, 3);
            => cacc: body.cacc().unwrap().bits(), at(d.cacc, 6 * i, 6);
            => cfrc_int: body.cfrc_int().unwrap().bits(), at(d.cfrc_int, 6 * i, 6);
            => cfrc_ext: body.cfrc_ext().unwrap().bits(), at(d.cfrc_ext, 6 * i, 6);
            => mocap_pos: body.mocap_pos().map(|pos| pos.bits()), mocap(m, i).map(|id| at(d.mocap_pos, 3 * id, 3));
            => mocap_quat: body.mocap_quat().map(|quat| quat.bits()), mocap(m, i).map(|id| at(d.mocap_quat, 4 * id, 4));
        });
        let (q, v) = (|i| int(m.jnt_qposadr, i), |i| int(m.jnt_dofadr, i));
        check_fields!(name, data.joints(), |joint, i| {
            qpos: d.qpos, [q(i); joint_sizes(m, i).0];
            qvel: d.qvel, [v(i); joint_sizes(m, i).1];
            qacc: d.qacc, [v(i); joint_sizes(m, i).1];
            qacc_warmstart: d.qacc_warmstart, [v(i); joint_sizes(m, i).1];
            qfrc_applied: d.qfrc_applied, [v(i); joint_sizes(m, i).1];
            qfrc_bias: d.qfrc_bias, [v(i); joint_sizes(m, i).1];
            qfrc_passive: d.qfrc_passive, [v(i); joint_sizes(m, i).1];
            qfrc_actuator: d.qfrc_actuator, [v(i); joint_sizes(m, i).1];
            qfrc_smooth: d.qfrc_smooth, [v(i); joint_sizes(m, i).1];
            qfrc_constraint: d.qfrc_constraint, [v(i); joint_sizes(m, i).1];
            qfrc_inverse: d.qfrc_inverse, [v(i); joint_sizes(m, i).1];
            qacc_smooth: d.qacc_smooth, [v(i); joint_sizes(m, i).1];
            cdof: d.cdof, [6 * v(i); 6 * joint_sizes(m, i).1];
            cdof_dot: d.cdof_dot, [6 * v(i); 6 * joint_sizes(m, i).1];
            qLDiagInv: d.qLDiagInv, [v(i); joint_sizes(m, i).1];
            qHDiagInv: d.qHDiagInv, [v(i); joint_sizes(m, i).1];
            xanchor: d.xanchor, [3 * i; 3];
            xaxis: d.xaxis, [3 * i; 3];
        });
        check_fields!(name, data.geoms(), |geom, i| {
            xpos: d.geom_xpos, [3 * i; 3];
            xmat: d.geom_xmat, [9 * i; 9];
        });
        check_fields!(name, data.sites(), |site, i| {
            xpos: d.site_xpos, [3 * i; 3];
            xmat: d.site_xmat, [9 * i; 9];
        });
        check_fields!(name, data.cameras(), |camera, i| {
            xpos: d.cam_xpos, [3 * i; 3];
            xmat: d.cam_xmat, [9 * i; 9];
        });
        check_fields!(name, data.lights(), |light, i| {
            xpos: d.light_xpos, [3 * i; 3];
            xdir: d.light_xdir, [3 * i; 3];
        });
        check_fields!(name, data.tendons(), |tendon, i| {
            length: d.ten_length, [i; 1];
            velocity: d.ten_velocity, [i; 1];
            => J: tendon.J().unwrap().to_vec().bits(), tendon_jacobian(i).bits();
            => wrap_range: tendon.wrap_range(), span(d.ten_wrapadr, d.ten_wrapnum, i);
            => wrap_points: tendon.wrap_points().map(|point| raw_point(&point)).collect::<Vec<_>>(),
                span(d.ten_wrapadr, d.ten_wrapnum, i).map(|point| engine_point(d, point)).collect::<Vec<_>>();
        });
        check_fields!(name, data.actuators(), |actuator, i| {
            ctrl: d.ctrl, [i; 1];
            length: d.actuator_length, [i; 1];
            velocity: d.actuator_velocity, [i; 1];
            force: d.actuator_force, [i; 1];
            ctrls: d.ctrl, [i; 1];
            forces: d.actuator_force, [i; 1];
            => acts: actuator.acts().bits(), activation(m, i).map_or(Vec::new(), |act| at(d.act, act, 1));
            => moment: actuator.moment().to_vec().bits(), moment(i).bits();
            => act: actuator.act().map(|act| act.bits()), activation(m, i).map(|act| at(d.act, act, 1));
            => act_dot: actuator.act_dot().map(|act| act.bits()), activation(m, i).map(|act| at(d.act_dot, act, 1));
        });
        check_fields!(name, data.sensors(), |sensor, i| {
            => data: sensor.data().unwrap().bits(), at(d.sensordata, int(m.sensor_adr, i), int(m.sensor_dim, i));
        });
    }
}
