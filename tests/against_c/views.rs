//! Named access: every field of every element is what the engine has at the address that its documentation gives.

use mujoco_safe::sys::{self, mjData, mjModel};
use mujoco_safe::{Data, GeomType, JointType, Model};

use crate::twins::{Twins, read, subjects, usual_subjects};

/// What a field returns, as bits.
trait Bits {
    fn bits(&self) -> Vec<u64>;
}

macro_rules! scalar_bits {
    ($($type:ty => |$value:ident| $bits:expr),*) => {$(
        impl Bits for $type {
            fn bits(&self) -> Vec<u64> {
                let $value = *self;
                vec![u64::from($bits)]
            }
        }
    )*};
}
scalar_bits!(f64 => |value| value.to_bits(), f32 => |value| value.to_bits(), i32 => |value| value.cast_unsigned());

impl<T: Bits> Bits for [T] {
    fn bits(&self) -> Vec<u64> {
        self.iter().flat_map(Bits::bits).collect()
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn bits(&self) -> Vec<u64> {
        self.as_slice().bits()
    }
}

/// Compares each field of each view with `array[start; length]` of the engine, or with an expression, and makes sure that no
/// field that a view lists is left out.
macro_rules! check_fields {
    ($name:expr, $views:expr, |$view:ident, $i:ident| {
        $($field:ident: $array:expr, [$start:expr; $length:expr];)*
        $(=> $special:ident: $ours:expr, $theirs:expr;)*
    }) => {
        for $view in $views {
            let $i = $view.index();
            $(
                // SAFETY: the engine's arrays have a row for each element.
                let theirs = unsafe { read($array, $start, $length) };
                assert_eq!(
                    $view.$field().bits(), theirs.bits(),
                    "{}, {:?}: {} is {:?}, not {:?}", $name, $view, stringify!($field), $view.$field(), theirs
                );
            )*
            $(assert_eq!($ours, $theirs, "{}, {:?}: {}", $name, $view, stringify!($special));)*
            let mut checked = vec![$(stringify!($field),)* $(stringify!($special),)*];
            let text = $view.to_string();
            let mut listed: Vec<&str> = text.lines().skip(3).filter_map(|line| line.split(':').next()).collect();
            checked.sort_unstable();
            listed.sort_unstable();
            assert_eq!(listed, checked, "the fields of {:?}", $view);
        }
    };
}

/// An index of the engine's.
fn int(array: *const i32, index: usize) -> usize {
    // SAFETY: as for the other arrays.
    usize::try_from(unsafe { *array.add(index) }).expect("not negative")
}

fn flag(array: *const u8, index: usize) -> bool {
    // SAFETY: as for the other arrays.
    unsafe { *array.add(index) != 0 }
}

fn joint_type(kind: JointType) -> u32 {
    match kind {
        JointType::Free => sys::mjJNT_FREE,
        JointType::Ball => sys::mjJNT_BALL,
        JointType::Slide => sys::mjJNT_SLIDE,
        JointType::Hinge => sys::mjJNT_HINGE,
        other => panic!("a new type of joint: {other:?}"),
    }
}

fn geom_type(kind: GeomType) -> u32 {
    match kind {
        GeomType::Plane => sys::mjGEOM_PLANE,
        GeomType::HeightField => sys::mjGEOM_HFIELD,
        GeomType::Sphere => sys::mjGEOM_SPHERE,
        GeomType::Capsule => sys::mjGEOM_CAPSULE,
        GeomType::Ellipsoid => sys::mjGEOM_ELLIPSOID,
        GeomType::Cylinder => sys::mjGEOM_CYLINDER,
        GeomType::Box => sys::mjGEOM_BOX,
        GeomType::Mesh => sys::mjGEOM_MESH,
        other => panic!("a new shape: {other:?}"),
    }
}

/// How many numbers in `qpos` and `qvel` a joint has.
fn joint_sizes(m: &mjModel, joint: usize) -> (usize, usize) {
    match int(m.jnt_type, joint) as u32 {
        sys::mjJNT_FREE => (7, 6),
        sys::mjJNT_BALL => (4, 3),
        _ => (1, 1),
    }
}

fn on_model(model: &Model) -> &mjModel {
    // SAFETY: valid as long as the model, which nothing writes to meanwhile.
    unsafe { &*model.as_ptr() }
}

fn on_data(data: &Data) -> &mjData {
    // SAFETY: valid as long as the data, which nothing writes to meanwhile.
    unsafe { &*data.as_ptr() }
}

#[test]
fn fields_of_bodies_and_joints_are_the_engines() {
    for subject in subjects() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        let nuser = m.nuser_body as usize;
        check_fields!(name, model.bodies(), |body, i| {
            pos: m.body_pos, [3 * i; 3];
            quat: m.body_quat, [4 * i; 4];
            ipos: m.body_ipos, [3 * i; 3];
            iquat: m.body_iquat, [4 * i; 4];
            mass: m.body_mass, [i; 1];
            subtreemass: m.body_subtreemass, [i; 1];
            inertia: m.body_inertia, [3 * i; 3];
            invweight0: m.body_invweight0, [2 * i; 2];
            user: m.body_user, [nuser * i; nuser];
            => parent: body.parent().index(), int(m.body_parentid, i);
            => root: body.root().index(), int(m.body_rootid, i);
            => njnt: body.njnt(), int(m.body_jntnum, i);
            => ngeom: body.ngeom(), int(m.body_geomnum, i);
            => dofs: (body.dofs().len(), body.dofs().start),
                (int(m.body_dofnum, i), if body.dofs().is_empty() { 0 } else { int(m.body_dofadr, i) });
            // SAFETY: as for the other arrays.
            => mocap: body.mocap().map_or(-1, |mocap| mocap as i32), unsafe { *m.body_mocapid.add(i) };
        });
        let nuser = m.nuser_jnt as usize;
        let (q, v) = (|i| int(m.jnt_qposadr, i), |i| int(m.jnt_dofadr, i));
        check_fields!(name, model.joints(), |joint, i| {
            group: m.jnt_group, [i; 1];
            pos: m.jnt_pos, [3 * i; 3];
            axis: m.jnt_axis, [3 * i; 3];
            stiffness: m.jnt_stiffness, [i; 1];
            range: m.jnt_range, [2 * i; 2];
            margin: m.jnt_margin, [i; 1];
            qpos0: m.qpos0, [q(i); joint_sizes(m, i).0];
            qpos_spring: m.qpos_spring, [q(i); joint_sizes(m, i).0];
            armature: m.dof_armature, [v(i); joint_sizes(m, i).1];
            damping: m.dof_damping, [v(i); joint_sizes(m, i).1];
            frictionloss: m.dof_frictionloss, [v(i); joint_sizes(m, i).1];
            user: m.jnt_user, [nuser * i; nuser];
            => joint_type: joint_type(joint.joint_type()) as usize, int(m.jnt_type, i);
            => qpos_range: joint.qpos_range(), q(i)..q(i) + joint_sizes(m, i).0;
            => dofs: joint.dofs(), v(i)..v(i) + joint_sizes(m, i).1;
            => body: joint.body().index(), int(m.jnt_bodyid, i);
            => limited: joint.limited(), flag(m.jnt_limited, i);
        });
    }
}

#[test]
fn fields_of_geoms_sites_cameras_and_lights_are_the_engines() {
    for subject in subjects() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        let nuser = m.nuser_geom as usize;
        check_fields!(name, model.geoms(), |geom, i| {
            contype: m.geom_contype, [i; 1];
            conaffinity: m.geom_conaffinity, [i; 1];
            condim: m.geom_condim, [i; 1];
            group: m.geom_group, [i; 1];
            priority: m.geom_priority, [i; 1];
            solmix: m.geom_solmix, [i; 1];
            solref: m.geom_solref, [2 * i; 2];
            solimp: m.geom_solimp, [5 * i; 5];
            size: m.geom_size, [3 * i; 3];
            rbound: m.geom_rbound, [i; 1];
            pos: m.geom_pos, [3 * i; 3];
            quat: m.geom_quat, [4 * i; 4];
            friction: m.geom_friction, [3 * i; 3];
            margin: m.geom_margin, [i; 1];
            gap: m.geom_gap, [i; 1];
            rgba: m.geom_rgba, [4 * i; 4];
            user: m.geom_user, [nuser * i; nuser];
            => geom_type: geom_type(geom.geom_type()) as usize, int(m.geom_type, i);
            => body: geom.body().index(), int(m.geom_bodyid, i);
        });
        let nuser = m.nuser_site as usize;
        check_fields!(name, model.sites(), |site, i| {
            group: m.site_group, [i; 1];
            size: m.site_size, [3 * i; 3];
            pos: m.site_pos, [3 * i; 3];
            quat: m.site_quat, [4 * i; 4];
            rgba: m.site_rgba, [4 * i; 4];
            user: m.site_user, [nuser * i; nuser];
            => site_type: geom_type(site.site_type()) as usize, int(m.site_type, i);
            => body: site.body().index(), int(m.site_bodyid, i);
        });
        let nuser = m.nuser_cam as usize;
        check_fields!(name, model.cameras(), |camera, i| {
            pos: m.cam_pos, [3 * i; 3];
            quat: m.cam_quat, [4 * i; 4];
            poscom0: m.cam_poscom0, [3 * i; 3];
            pos0: m.cam_pos0, [3 * i; 3];
            mat0: m.cam_mat0, [9 * i; 9];
            fovy: m.cam_fovy, [i; 1];
            ipd: m.cam_ipd, [i; 1];
            user: m.cam_user, [nuser * i; nuser];
            => body: camera.body().index(), int(m.cam_bodyid, i);
        });
        check_fields!(name, model.lights(), |light, i| {
            pos: m.light_pos, [3 * i; 3];
            dir: m.light_dir, [3 * i; 3];
            poscom0: m.light_poscom0, [3 * i; 3];
            pos0: m.light_pos0, [3 * i; 3];
            dir0: m.light_dir0, [3 * i; 3];
            attenuation: m.light_attenuation, [3 * i; 3];
            cutoff: m.light_cutoff, [i; 1];
            exponent: m.light_exponent, [i; 1];
            ambient: m.light_ambient, [3 * i; 3];
            diffuse: m.light_diffuse, [3 * i; 3];
            specular: m.light_specular, [3 * i; 3];
            => body: light.body().index(), int(m.light_bodyid, i);
            => directional: light.directional(), flag(m.light_directional, i);
            => castshadow: light.castshadow(), flag(m.light_castshadow, i);
            => active: light.active(), flag(m.light_active, i);
        });
    }
}

#[test]
fn fields_of_tendons_actuators_sensors_and_keyframes_are_the_engines() {
    for subject in subjects() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        let nuser = m.nuser_tendon as usize;
        check_fields!(name, model.tendons(), |tendon, i| {
            group: m.tendon_group, [i; 1];
            width: m.tendon_width, [i; 1];
            range: m.tendon_range, [2 * i; 2];
            margin: m.tendon_margin, [i; 1];
            stiffness: m.tendon_stiffness, [i; 1];
            damping: m.tendon_damping, [i; 1];
            frictionloss: m.tendon_frictionloss, [i; 1];
            lengthspring: m.tendon_lengthspring, [i; 1];
            length0: m.tendon_length0, [i; 1];
            invweight0: m.tendon_invweight0, [i; 1];
            solref_lim: m.tendon_solref_lim, [2 * i; 2];
            solimp_lim: m.tendon_solimp_lim, [5 * i; 5];
            solref_fri: m.tendon_solref_fri, [2 * i; 2];
            solimp_fri: m.tendon_solimp_fri, [5 * i; 5];
            rgba: m.tendon_rgba, [4 * i; 4];
            user: m.tendon_user, [nuser * i; nuser];
            => limited: tendon.limited(), flag(m.tendon_limited, i);
        });
        let (nuser, nu, na) = (m.nuser_actuator as usize, m.nu as usize, m.na as usize);
        check_fields!(name, model.actuators(), |actuator, i| {
            group: m.actuator_group, [i; 1];
            dynprm: m.actuator_dynprm, [10 * i; 10];
            gainprm: m.actuator_gainprm, [10 * i; 10];
            biasprm: m.actuator_biasprm, [10 * i; 10];
            ctrlrange: m.actuator_ctrlrange, [2 * i; 2];
            forcerange: m.actuator_forcerange, [2 * i; 2];
            actrange: m.actuator_actrange, [2 * i; 2];
            gear: m.actuator_gear, [6 * i; 6];
            cranklength: m.actuator_cranklength, [i; 1];
            acc0: m.actuator_acc0, [i; 1];
            length0: m.actuator_length0, [i; 1];
            lengthrange: m.actuator_lengthrange, [2 * i; 2];
            user: m.actuator_user, [nuser * i; nuser];
            => ctrllimited: actuator.ctrllimited(), flag(m.actuator_ctrllimited, i);
            => forcelimited: actuator.forcelimited(), flag(m.actuator_forcelimited, i);
            => actlimited: actuator.actlimited(), flag(m.actuator_actlimited, i);
            // Whoever has dynamics has an activation, and those come last.
            => activation: actuator.activation(),
                (int(m.actuator_dyntype, i) as u32 != sys::mjDYN_NONE).then(|| i - (nu - na));
        });
        let nuser = m.nuser_sensor as usize;
        check_fields!(name, model.sensors(), |sensor, i| {
            sensor_type: m.sensor_type, [i; 1];
            cutoff: m.sensor_cutoff, [i; 1];
            noise: m.sensor_noise, [i; 1];
            user: m.sensor_user, [nuser * i; nuser];
            => dim: sensor.dim(), int(m.sensor_dim, i);
            => data_range: sensor.data_range(), int(m.sensor_adr, i)..int(m.sensor_adr, i) + int(m.sensor_dim, i);
        });
        let [nq, nv, nmocap] = [m.nq, m.nv, m.nmocap].map(|size| size as usize);
        check_fields!(name, model.keyframes(), |keyframe, i| {
            time: m.key_time, [i; 1];
            qpos: m.key_qpos, [nq * i; nq];
            qvel: m.key_qvel, [nv * i; nv];
            act: m.key_act, [na * i; na];
            mpos: m.key_mpos, [3 * nmocap * i; 3 * nmocap];
            mquat: m.key_mquat, [4 * nmocap * i; 4 * nmocap];
            ctrl: m.key_ctrl, [nu * i; nu];
        });
    }
}

#[test]
fn fields_of_elements_in_a_simulation_are_the_engines() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        twins.ours.inverse().expect("inverse dynamics");
        let (name, data) = (&subject.name, &twins.ours);
        let (m, d) = (on_model(&twins.model), on_data(data));
        let nv = m.nv as usize;
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
            subtree_linvel: d.subtree_linvel, [3 * i; 3];
            subtree_angmom: d.subtree_angmom, [3 * i; 3];
            cacc: d.cacc, [6 * i; 6];
            cfrc_int: d.cfrc_int, [6 * i; 6];
            cfrc_ext: d.cfrc_ext, [6 * i; 6];
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
        });
        check_fields!(name, data.actuators(), |actuator, i| {
            ctrl: d.ctrl, [i; 1];
            length: d.actuator_length, [i; 1];
            velocity: d.actuator_velocity, [i; 1];
            force: d.actuator_force, [i; 1];
            moment: d.actuator_moment, [nv * i; nv];
        });
        check_fields!(name, data.sensors(), |sensor, i| {
            data: d.sensordata, [int(m.sensor_adr, i); int(m.sensor_dim, i)];
        });
    }
}
