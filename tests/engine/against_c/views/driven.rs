//! Tendons, actuators, sensors and keyframes of a model.

use mujoco_safe::element::{Object, Transmission, Wrap};
use mujoco_safe::sys::{self, mjModel};

use super::enums::{bias, dynamics, gain, sensor_type};
use super::{check_fields, int, models, on_model, optional, raw, span};

/// Returns type, object and parameter of a path element.
fn raw_wrap(wrap: &Wrap) -> (u32, i32, f64) {
    match *wrap {
        Wrap::Joint { joint, coefficient } => (sys::mjWRAP_JOINT, joint.index() as i32, coefficient),
        Wrap::Pulley { divisor } => (sys::mjWRAP_PULLEY, -1, divisor),
        Wrap::Site(site) => (sys::mjWRAP_SITE, site.index() as i32, 0.0),
        Wrap::Sphere { geom, side } => (sys::mjWRAP_SPHERE, geom.index() as i32, optional(side).into()),
        Wrap::Cylinder { geom, side } => (sys::mjWRAP_CYLINDER, geom.index() as i32, optional(side).into()),
        other => panic!("unexpected path element: {other:?}"),
    }
}

fn engine_wrap(m: &mjModel, at: usize) -> (u32, i32, f64) {
    let kind = int(m.wrap_type, at) as u32;
    // SAFETY: the engine's arrays have an entry for each path element. The parameter of a site is
    // meaningless.
    let parameter = if kind == sys::mjWRAP_SITE { 0.0 } else { unsafe { *m.wrap_prm.add(at) } };
    (kind, raw(m.wrap_objid, at), parameter)
}

fn raw_transmission(transmission: Transmission) -> [i32; 3] {
    let (kind, end, other) = match transmission {
        Transmission::Joint(joint) => (sys::mjTRN_JOINT, joint.index(), None),
        Transmission::JointInParent(joint) => (sys::mjTRN_JOINTINPARENT, joint.index(), None),
        Transmission::SliderCrank { crank, slider } => (sys::mjTRN_SLIDERCRANK, crank.index(), Some(slider)),
        Transmission::Tendon(tendon) => (sys::mjTRN_TENDON, tendon.index(), None),
        Transmission::Site(site) => (sys::mjTRN_SITE, site.index(), None),
        Transmission::Body(body) => (sys::mjTRN_BODY, body.index(), None),
        other => panic!("unexpected transmission: {other:?}"),
    };
    [kind as i32, end as i32, optional(other)]
}

/// Returns type and id of an object.
pub(super) fn raw_object(object: Option<Object>) -> [i32; 2] {
    let Some(object) = object else { return [sys::mjOBJ_UNKNOWN as i32, -1] };
    let kind = match object {
        Object::Body(_) => sys::mjOBJ_BODY,
        Object::XBody(_) => sys::mjOBJ_XBODY,
        Object::Joint(_) => sys::mjOBJ_JOINT,
        Object::Dof(_) => sys::mjOBJ_DOF,
        Object::Geom(_) => sys::mjOBJ_GEOM,
        Object::Site(_) => sys::mjOBJ_SITE,
        Object::Camera(_) => sys::mjOBJ_CAMERA,
        Object::Light(_) => sys::mjOBJ_LIGHT,
        Object::Mesh(_) => sys::mjOBJ_MESH,
        Object::Skin(_) => sys::mjOBJ_SKIN,
        Object::HeightField(_) => sys::mjOBJ_HFIELD,
        Object::Texture(_) => sys::mjOBJ_TEXTURE,
        Object::Material(_) => sys::mjOBJ_MATERIAL,
        Object::Pair(_) => sys::mjOBJ_PAIR,
        Object::Exclude(_) => sys::mjOBJ_EXCLUDE,
        Object::Equality(_) => sys::mjOBJ_EQUALITY,
        Object::Tendon(_) => sys::mjOBJ_TENDON,
        Object::Actuator(_) => sys::mjOBJ_ACTUATOR,
        Object::Sensor(_) => sys::mjOBJ_SENSOR,
        Object::Numeric(_) => sys::mjOBJ_NUMERIC,
        Object::Text(_) => sys::mjOBJ_TEXT,
        Object::Tuple(_) => sys::mjOBJ_TUPLE,
        Object::Keyframe(_) => sys::mjOBJ_KEY,
        other => panic!("unexpected object: {other:?}"),
    };
    [kind as i32, object.index() as i32]
}

/// Number of rest lengths of a tendon in the engine's array: since 2.3 both ends of a range.
const ENDS: usize = if cfg!(engine_since = "2.3.0") { 2 } else { 1 };

#[test]
fn fields_of_tendons_actuators_sensors_and_keyframes_equal_c() {
    for subject in models() {
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
            lengthspring: m.tendon_lengthspring, [ENDS * i; 1];
            length0: m.tendon_length0, [i; 1];
            invweight0: m.tendon_invweight0, [i; 1];
            solref_lim: m.tendon_solref_lim, [2 * i; 2];
            solimp_lim: m.tendon_solimp_lim, [5 * i; 5];
            solref_fri: m.tendon_solref_fri, [2 * i; 2];
            solimp_fri: m.tendon_solimp_fri, [5 * i; 5];
            rgba: m.tendon_rgba, [4 * i; 4];
            user: m.tendon_user, [nuser * i; nuser];
            limited: m.tendon_limited, [i; 1];
            => path: tendon.path().map(|wrap| raw_wrap(&wrap)).collect::<Vec<_>>(),
                span(m.tendon_adr, m.tendon_num, i).map(|at| engine_wrap(m, at)).collect::<Vec<_>>();
            => material: optional(tendon.material()), raw(m.tendon_matid, i);
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
            ctrllimited: m.actuator_ctrllimited, [i; 1];
            forcelimited: m.actuator_forcelimited, [i; 1];
            actlimited: m.actuator_actlimited, [i; 1];
            // Actuators with dynamics have activations, in the order of the actuators.
            => dynamics: dynamics(actuator.dynamics()), int(m.actuator_dyntype, i) as u32;
            => gain: gain(actuator.gain()), int(m.actuator_gaintype, i) as u32;
            => bias: bias(actuator.bias()), int(m.actuator_biastype, i) as u32;
            => transmission: raw_transmission(actuator.transmission()),
                [raw(m.actuator_trntype, i), raw(m.actuator_trnid, 2 * i), raw(m.actuator_trnid, 2 * i + 1)];
            // The program smoke has models with several controls, forces and activations.
            => controls: actuator.controls(), i..i + 1;
            => outputs: actuator.outputs(), i..i + 1;
            => activations: actuator.activations(), actuator.activation().map_or(0..0, |first| first..first + 1);
            => activation: actuator.activation(),
                (int(m.actuator_dyntype, i) as u32 != sys::mjDYN_NONE).then(|| (0..i).filter(|at| int(m.actuator_dyntype, *at) as u32 != sys::mjDYN_NONE).count());
        });
        let nuser = m.nuser_sensor as usize;
        check_fields!(name, model.sensors(), |sensor, i| {
            cutoff: m.sensor_cutoff, [i; 1];
            noise: m.sensor_noise, [i; 1];
            user: m.sensor_user, [nuser * i; nuser];
            => sensor_type: sensor_type(sensor.sensor_type()), int(m.sensor_type, i) as u32;
            => datatype: sensor.datatype() as i32, raw(m.sensor_datatype, i);
            => needstage: sensor.needstage() as i32, raw(m.sensor_needstage, i);
            => object: raw_object(sensor.object()), [raw(m.sensor_objtype, i), raw(m.sensor_objid, i)];
            => reference: raw_object(sensor.reference()), [raw(m.sensor_reftype, i), raw(m.sensor_refid, i)];
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
