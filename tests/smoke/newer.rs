//! Options and elements of newer engines: available where the engine has them, and
//! `Error::Unsupported` with the versions that have them elsewhere. The independent source is the C
//! API of the same engine.

use mujoco_safe::derivative::{Fallback, TransitionMethod, TransitionOptions};
use mujoco_safe::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, Integrator, SensorDataType, SensorType};
use mujoco_safe::model::{DisableFlags, EnableFlags};
use mujoco_safe::sys::{self, mjOption};
use mujoco_safe::{
    Data, Differences, Error, Lineariser, Model, Options, Stage, StateSpace, Version, built_against, sample,
};

use super::Raw;

const fn version(major: u32, minor: u32, patch: u32) -> Version {
    Version { major, minor, patch }
}

/// Checks that an error names the present engine and the versions that have a feature.
fn names_versions(error: &Error, versions: &str) {
    assert!(matches!(error, Error::Unsupported(_)), "{error}");
    let text = error.to_string();
    assert!(text.contains(&built_against().to_string()) && text.contains(versions), "{text}");
}

/// Changes the options of a model: `true` if the engine has the change, which the engines from
/// `first` to before `end` do.
fn changes(model: &mut Model, change: impl FnOnce(&mut Options), first: Version, end: Version, versions: &str) -> bool {
    let result = model.edit().edit_options(change);
    let expected = (first..end).contains(&built_against());
    match &result {
        Ok(()) => assert!(expected, "MuJoCo {} has what only {versions} have", built_against()),
        Err(error) => {
            assert!(!expected, "{error}");
            names_versions(error, versions);
        }
    }
    expected
}

const END: Version = version(u32::MAX, 0, 0);

const INTEGRATORS: [(Integrator, Version, &str); 5] = [
    (Integrator::Euler, version(2, 2, 2), "2.2.2 and later"),
    (Integrator::Rk4, version(2, 2, 2), "2.2.2 and later"),
    (Integrator::Implicit, version(2, 2, 2), "2.2.2 and later"),
    (Integrator::ImplicitFast, version(2, 3, 3), "2.3.3 and later"),
    (Integrator::Discrete, version(3, 13, 0), "3.13.0 and later"),
];

#[test]
fn every_integrator_that_the_engine_has_equals_the_c_function_bit_for_bit() {
    for (integrator, first, versions) in INTEGRATORS {
        let mut model = sample::humanoid();
        if !changes(&mut model, |options| options.integrator = integrator, first, END, versions) {
            continue;
        }
        assert_eq!(model.options().integrator, integrator);
        let mut data = Data::new(model).unwrap();
        let model = data.model().clone();
        let raw = Raw(c!(mj_makeData(model.as_ptr())));
        for step in 0..100 {
            data.step().unwrap();
            c!(mj_step(model.as_ptr(), raw.0));
            // SAFETY: the array has nq numbers.
            let qpos = unsafe { std::slice::from_raw_parts((*raw.0).qpos, model.nq()) };
            assert_eq!(data.qpos(), qpos, "{integrator:?}, step {step}");
        }
    }
}

/// Linearises by a method of this library and by the engine.
fn linearise_both(data: &Data, method: TransitionMethod) -> (StateSpace, StateSpace, Option<Fallback>) {
    let model = data.model();
    let options = TransitionOptions::default().with_method(method).with_eps(1e-6);
    let mut lineariser = Lineariser::new(model.clone(), options).unwrap();
    let mut ours = StateSpace::zeros(model);
    let report = lineariser.linear_system_into(&mut data.clone(), &mut ours).unwrap();
    let (nx, nu) = (2 * model.nv() + model.na(), model.nu());
    let raw = Raw(c!(mj_makeData(model.as_ptr())));
    let mut engine = StateSpace::zeros(model);
    c!(mj_copyData(raw.0, model.as_ptr(), data.as_ptr()));
    assert_eq!((engine.a.as_slice().len(), engine.b.as_slice().len()), (nx * nx, nx * nu));
    let (a, b) = (engine.a.as_mut_slice().as_mut_ptr(), engine.b.as_mut_slice().as_mut_ptr());
    let none = std::ptr::null_mut();
    c!(mjd_transitionFD(model.as_ptr(), raw.0, 1e-6, 1, a, b, none, none));
    (ours, engine, report.fallback)
}

/// Returns the reason for an engine with which the formulas were not verified, or this one.
fn reason(fallback: Fallback) -> Fallback {
    proved().unwrap_or(fallback)
}

/// Returns the reason why the method is not used with an engine with which the formulas were not
/// verified.
fn proved() -> Option<Fallback> {
    (!cfg!(tested_in_full)).then_some(Fallback::EngineVersion)
}

fn not_understood(field: &'static str, element: usize) -> Fallback {
    Fallback::NotUnderstood { field, element }
}

fn assert_close(ours: &StateSpace, engine: &StateSpace, what: &str) {
    for (ours, engine) in [(&ours.a, &engine.a), (&ours.b, &engine.b)] {
        let scale = engine.as_slice().iter().fold(1.0, |scale: f64, value| scale.max(value.abs()));
        for (one, other) in ours.as_slice().iter().zip(engine.as_slice()) {
            assert!((one - other).abs() < 1e-6 * scale, "{what}: {one} {other}, scale {scale}");
        }
    }
}

#[test]
fn linearisations_with_every_implicit_integrator_agree_with_the_engine() {
    for (integrator, first, _) in &INTEGRATORS[2..] {
        if built_against() < *first {
            continue;
        }
        let mut model = sample::humanoid();
        model.edit().edit_options(|options| options.integrator = *integrator).unwrap();
        let mut data = Data::new(model).unwrap();
        // In the air: at a contact the differences magnify the tolerance of the solver.
        data.qpos_mut()[2] += 1.0;
        data.qvel_mut().fill(0.1);
        data.ctrl_mut().fill(0.2);
        data.forward().unwrap();
        for method in [TransitionMethod::Engine, TransitionMethod::Columns, TransitionMethod::Implicit] {
            let (ours, engine, fallback) = linearise_both(&data, method);
            let expected = (method == TransitionMethod::Implicit).then_some(reason(Fallback::ImplicitIntegrator));
            assert_eq!(fallback, expected, "{integrator:?}");
            assert_close(&ours, &engine, &format!("{integrator:?} {method:?}"));
        }
    }
}

/// A mechanism for the sensors and actuators below: a pendulum above a ball on a floor.
fn mechanism(sensors: &str, actuators: &str) -> Model {
    loaded_mechanism(sensors, actuators).unwrap()
}

fn loaded_mechanism(sensors: &str, actuators: &str) -> Result<Model, Error> {
    let text = format!(
        r#"<mujoco>
          <asset><mesh name="tetrahedron" vertex="0 0 0  0.1 0 0  0 0.1 0  0 0 0.1"/></asset>
          <worldbody>
            <geom name="floor" type="plane" size="0 0 1"/>
            <camera name="camera" pos="0 -3 1" xyaxes="1 0 0 0 0 1"/>
            <site name="zone" type="box" size="0.5 0.5 0.5"/>
            <body name="pendulum" pos="0 0 2">
              <joint name="hinge" axis="0 1 0" damping="0.1"/>
              <geom name="rod" type="capsule" size="0.05" fromto="0 0 0 0.5 0 -0.5" mass="1"/>
              <site name="tip" pos="0.5 0 -0.5"/>
            </body>
            <body name="ball" pos="0 0 0.0999">
              <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
              <geom name="ball" size="0.1" mass="2"/>
              <geom name="skin" type="mesh" mesh="tetrahedron" contype="0" conaffinity="0" mass="0.01"/>
            </body>
          </worldbody>
          <tendon><fixed name="tendon"><joint joint="hinge" coef="0.5"/></fixed></tendon>
          <actuator>
            <motor name="motor" joint="hinge" gear="2"/><motor name="pull" tendon="tendon"/>
            {actuators}
          </actuator>
          <sensor>{sensors}</sensor>
        </mujoco>"#
    );
    Model::from_xml_str(&text)
}

/// Expected reading of a sensor.
type Reading = fn(&Data) -> Vec<f64>;

/// The type of a sensor, the first version that has it, its XML, the dimension and the data type of
/// its reading, its stage, and the reading by the definition of the sensor if it is known
/// otherwise.
type NewSensor = (SensorType, Version, &'static str, usize, SensorDataType, Stage, Option<Reading>);

/// Sensors of newer engines.
#[rustfmt::skip]
const SENSORS: [NewSensor; 11] = [
    (SensorType::JointActuatorForce, version(2, 3, 7), r#"<jointactuatorfrc name="s" joint="hinge"/>"#, 1, SensorDataType::Real,
        Stage::Acceleration, Some(|_| vec![2.0 * 0.3 + 0.5 * 0.7])),
    (SensorType::TendonActuatorForce, version(3, 3, 1), r#"<tendonactuatorfrc name="s" tendon="tendon"/>"#, 1, SensorDataType::Real,
        Stage::Acceleration, Some(|_| vec![0.7])),
    (SensorType::CameraProjection, version(3, 0, 0), r#"<camprojection name="s" site="tip" camera="camera"/>"#, 2, SensorDataType::Real,
        Stage::Position, None),
    (SensorType::GeomDistance, version(3, 1, 6), r#"<distance name="s" geom1="ball" geom2="floor" cutoff="1"/>"#, 1, SensorDataType::Real,
        Stage::Position, Some(|_| vec![-0.0001])),
    (SensorType::GeomNormal, version(3, 1, 6), r#"<normal name="s" geom1="floor" geom2="rod" cutoff="3"/>"#, 3, SensorDataType::Axis,
        Stage::Position, Some(|_| vec![0.0, 0.0, 1.0])),
    (SensorType::GeomFromTo, version(3, 1, 6), r#"<fromto name="s" geom1="floor" geom2="ball" cutoff="1"/>"#, 6, SensorDataType::Real,
        Stage::Position, Some(|_| vec![0.0, 0.0, 0.0, 0.0, 0.0, -0.0001])),
    (SensorType::PotentialEnergy, version(3, 3, 0), r#"<e_potential name="s"/>"#, 1, SensorDataType::Real, Stage::Position,
        Some(|data| vec![data.model().body_mass().iter().zip(data.xipos()).map(|(mass, x)| 9.81 * mass * x[2]).sum()])),
    (SensorType::KineticEnergy, version(3, 3, 0), r#"<e_kinetic name="s"/>"#, 1, SensorDataType::Real, Stage::Position, Some(|data| {
        let mut momentum = vec![0.0; data.model().nv()];
        data.mul_m_into(data.qvel(), &mut momentum).unwrap();
        vec![momentum.iter().zip(data.qvel()).map(|(p, v)| 0.5 * p * v).sum()]
    })),
    (SensorType::InsideSite, version(3, 3, 5), r#"<insidesite name="s" site="zone" objtype="geom" objname="ball"/>"#, 1,
        SensorDataType::Real, Stage::Position, Some(|_| vec![1.0])),
    (SensorType::Contact, version(3, 3, 5), r#"<contact name="s" geom1="floor" geom2="ball" num="2" data="found force dist"/>"#, 10,
        SensorDataType::Real, Stage::Acceleration,
        Some(|_| vec![1.0])),
    (SensorType::Tactile, version(3, 3, 5), r#"<tactile name="s" geom="skin" mesh="tetrahedron"/>"#, 12, SensorDataType::Real,
        Stage::Acceleration, None),
];

#[test]
fn sensors_of_newer_engines_have_the_readings_of_the_c_function() {
    let mut count = 0;
    for (kind, first, xml, dim, datatype, stage, expected) in SENSORS {
        if built_against() < first {
            assert!(mujoco_safe::sys::absent::versions(constant(kind)).unwrap().starts_with(&first.to_string()));
            continue;
        }
        let mut data = Data::new(mechanism(xml, "")).unwrap();
        let model = data.model().clone();
        let sensor = model.sensor("s").unwrap();
        assert_eq!(sensor.sensor_type(), kind);
        // A tactile sensor needs no accelerations in newer versions.
        assert!(sensor.needstage() == stage || kind == SensorType::Tactile, "{kind:?}");
        // The data types of these sensors differ between versions.
        let differs = matches!(kind, SensorType::InsideSite | SensorType::GeomDistance);
        assert!(sensor.datatype() == datatype || differs, "{kind:?}");
        assert_eq!((sensor.dim(), sensor.data_range()), (dim, 0..dim), "{kind:?}");
        assert!(matches!(data.sensor("s").unwrap().data(), Err(Error::NotComputed { .. })));
        data.ctrl_mut().copy_from_slice(&[0.3, 0.7]);
        data.qvel_mut().copy_from_slice(&[0.5, 0.2, 0.1]);
        let raw = Raw(c!(mj_makeData(model.as_ptr())));
        c!(mj_copyData(raw.0, model.as_ptr(), data.as_ptr()));
        c!(mj_forward(model.as_ptr(), raw.0));
        data.forward().unwrap();
        // SAFETY: the array has nsensordata numbers.
        let engine = unsafe { std::slice::from_raw_parts((*raw.0).sensordata, dim) };
        assert_eq!(data.sensor("s").unwrap().data().unwrap(), engine, "{kind:?}");
        for (at, expected) in expected.map(|expected| expected(&data)).into_iter().flatten().enumerate() {
            assert!((engine[at] - expected).abs() < 1e-9, "{kind:?} {at}: {} {expected}", engine[at]);
        }
        for _ in 0..20 {
            data.step().unwrap();
        }
        assert!(!format!("{}", data.sensor("s").unwrap()).is_empty());
        let (_, _, fallback) = linearise_both(&data, TransitionMethod::Implicit);
        let is_covered = stage != Stage::Acceleration;
        let expected = if is_covered { proved() } else { Some(reason(not_understood("sensor_type", 0))) };
        assert_eq!(fallback, expected, "{kind:?}");
        count += 1;
    }
    assert_eq!(count > 0, built_against() >= version(2, 3, 7));
}

/// Returns the engine's name of a sensor type.
fn constant(kind: SensorType) -> &'static str {
    match kind {
        SensorType::JointActuatorForce => "mjSENS_JOINTACTFRC",
        SensorType::TendonActuatorForce => "mjSENS_TENDONACTFRC",
        SensorType::CameraProjection => "mjSENS_CAMPROJECTION",
        SensorType::GeomDistance => "mjSENS_GEOMDIST",
        SensorType::GeomNormal => "mjSENS_GEOMNORMAL",
        SensorType::GeomFromTo => "mjSENS_GEOMFROMTO",
        SensorType::PotentialEnergy => "mjSENS_E_POTENTIAL",
        SensorType::KineticEnergy => "mjSENS_E_KINETIC",
        SensorType::InsideSite => "mjSENS_INSIDESITE",
        SensorType::Contact => "mjSENS_CONTACT",
        SensorType::Tactile => "mjSENS_TACTILE",
        other => panic!("{other:?} is not a sensor of newer engines"),
    }
}

/// Actuators of newer engines: the XML, the first version, the types, and whether the implicit
/// linearisation covers them.
#[rustfmt::skip]
const ACTUATORS: [(&str, Version, ActuatorDynamics, ActuatorGain, ActuatorBias, bool); 4] = [
    (r#"<general name="new" joint="hinge" dyntype="filterexact" dynprm="0.1" gainprm="3"/>"#, version(3, 0, 0),
        ActuatorDynamics::FilterExact, ActuatorGain::Fixed, ActuatorBias::None, true),
    (r#"<dcmotor name="new" joint="hinge" resistance="2" motorconst="0.5 0.5"/>"#, version(3, 7, 0),
        ActuatorDynamics::DcMotor, ActuatorGain::DcMotor, ActuatorBias::DcMotor, false),
    (r#"<dcmotor name="new" joint="hinge" resistance="2" motorconst="0.5 0.5" inductance="0.1"/>"#, version(3, 7, 0),
        ActuatorDynamics::DcMotor, ActuatorGain::DcMotor, ActuatorBias::DcMotor, false),
    (r#"<pid name="new" joint="hinge" kp="5" kv="0.5" ki="2" imax="1" input="pos"/>"#, version(3, 12, 0),
        ActuatorDynamics::Pid, ActuatorGain::Pid, ActuatorBias::Affine, false),
];

#[test]
fn actuators_of_newer_engines_step_and_linearise_like_the_c_functions() {
    for (xml, first, dynamics, gain, bias, is_covered) in ACTUATORS {
        if built_against() < first {
            continue;
        }
        let loaded = loaded_mechanism("", xml);
        if matches!(gain, ActuatorGain::DcMotor | ActuatorGain::Pid) && built_against() < version(3, 17, 0) {
            let error = loaded.unwrap_err().to_string();
            assert!(error.contains("DC motors with MuJoCo 3.6 to 3.16"), "{error}");
            continue;
        }
        let mut data = Data::new(loaded.unwrap()).unwrap();
        let model = data.model().clone();
        let actuator = model.actuator("new").unwrap();
        assert_eq!((actuator.dynamics(), actuator.gain(), actuator.bias()), (dynamics, gain, bias), "{xml}");
        let raw = Raw(c!(mj_makeData(model.as_ptr())));
        for step in 0..50 {
            data.ctrl_mut().copy_from_slice(&[0.1, 0.0, f64::sin(0.1 * f64::from(step))]);
            // SAFETY: both arrays have nu numbers.
            unsafe { std::ptr::copy_nonoverlapping(data.ctrl().as_ptr(), (*raw.0).ctrl, model.nu()) };
            data.step().unwrap();
            c!(mj_step(model.as_ptr(), raw.0));
        }
        // SAFETY: the arrays have nq and na numbers.
        let (qpos, act) = unsafe {
            let act = if model.na() == 0 { &[] } else { std::slice::from_raw_parts((*raw.0).act, model.na()) };
            (std::slice::from_raw_parts((*raw.0).qpos, model.nq()), act)
        };
        assert_eq!((data.qpos(), data.act()), (qpos, act), "{xml}");
        // Without contacts, whose forces have the tolerance of the solver.
        data.qpos_mut()[2] += 1.0;
        data.forward().unwrap();
        for method in [TransitionMethod::Columns, TransitionMethod::Implicit] {
            let (ours, engine, fallback) = linearise_both(&data, method);
            let expected = match method {
                TransitionMethod::Implicit if is_covered => proved(),
                TransitionMethod::Implicit => Some(reason(not_understood("actuator_dyntype", 2))),
                _ => None,
            };
            assert_eq!(fallback, expected, "{xml}");
            assert_close(&ours, &engine, xml);
        }
    }
}

#[test]
fn a_limit_of_the_actuator_force_at_a_joint_is_linearised_like_the_engine() {
    if built_against() < version(3, 1, 1) {
        return;
    }
    let text = r#"<mujoco><worldbody><body>
        <joint name="hinge" axis="0 1 0" actuatorfrclimited="true" actuatorfrcrange="-1 1"/><geom size="0.1" pos="0.5 0 0"/>
      </body></worldbody><actuator><motor joint="hinge"/></actuator></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    // Far beyond the limit, so the control has no effect.
    data.ctrl_mut()[0] = 5.0;
    data.forward().unwrap();
    let (ours, engine, fallback) = linearise_both(&data, TransitionMethod::Implicit);
    assert_eq!(fallback, Some(reason(not_understood("jnt_actfrclimited", 0))));
    assert_close(&ours, &engine, "limit");
    assert_eq!(ours.b.as_slice(), [0.0, 0.0]);
}

/// Reads a field of the raw options.
macro_rules! raw_option {
    ($model:expr, $field:ident) => {{
        let raw: *const mjOption = &raw const *raw_options(&$model);
        // SAFETY: the model owns the options.
        unsafe { (*raw).$field }
    }};
}

fn raw_options(model: &Model) -> &mjOption {
    // SAFETY: the model is borrowed.
    unsafe { &(*model.as_ptr()).opt }
}

#[test]
fn options_of_other_engines_are_rejected_with_the_versions_that_have_them() {
    let first = version(2, 2, 2);
    let mut model = sample::cartpole();
    changes(&mut model, |options| options.apirate = 50.0, first, version(3, 3, 7), "2.2.2 to 3.3.6");
    let since = version(3, 0, 0);
    let later = "3.0.0 and later";
    changes(&mut model, |options| options.ls_tolerance = 0.02, since, END, later);
    changes(&mut model, |options| options.ls_iterations = 7, since, END, later);
    changes(&mut model, |options| options.sdf_iterations = 8, since, END, later);
    changes(&mut model, |options| options.sdf_initpoints = 9, since, END, later);
    changes(&mut model, |options| options.o_friction = [0.5; 5], since, END, later);
    changes(&mut model, |options| options.disableactuator = 0b110, version(3, 0, 1), END, "3.0.1 and later");
    let collision = mujoco_safe::enums::Collision::Pair;
    changes(&mut model, |options| options.collision = collision, first, since, "2.2.2 to 2.3.7");
    let iterations = model.edit().edit_options(|options| options.ls_iterations = 1 << 32).unwrap_err();
    assert!(matches!(iterations, Error::Invalid { .. }), "{iterations}");
}

#[cfg(engine_since = "3.5.0")]
#[test]
fn options_of_newer_engines_are_the_fields_of_the_struct() {
    let mut model = sample::cartpole();
    let change = |options: &mut Options| {
        (options.ls_tolerance, options.ls_iterations, options.o_friction) = (0.02, 7, [0.1, 0.2, 0.3, 0.4, 0.5]);
        (options.sdf_iterations, options.sdf_initpoints, options.disableactuator) = (8, 9, 0b110);
    };
    model.edit().edit_options(change).unwrap();
    assert_eq!((raw_option!(model, ls_tolerance), raw_option!(model, ls_iterations)), (0.02, 7));
    assert_eq!((raw_option!(model, sdf_iterations), raw_option!(model, sdf_initpoints)), (8, 9));
    assert_eq!((raw_option!(model, o_friction), raw_option!(model, disableactuator)), ([0.1, 0.2, 0.3, 0.4, 0.5], 6));
    let mut expected = model.options();
    change(&mut expected);
    assert_eq!(model.options(), expected);
}

#[test]
fn flags_are_the_bits_of_the_engine_or_rejected_with_the_versions_that_have_them() {
    let first = version(2, 2, 2);
    #[rustfmt::skip]
    let disable = [
        (DisableFlags::CONTACT, sys::mjDSBL_CONTACT, first, END, ""),
        (DisableFlags::MIDPHASE, sys::mjDSBL_MIDPHASE, version(2, 3, 3), END, "2.3.3 and later"),
        (DisableFlags::EULERDAMP, sys::mjDSBL_EULERDAMP, version(3, 0, 0), END, "3.0.0 and later"),
        (DisableFlags::NATIVECCD, sys::mjDSBL_NATIVECCD, version(3, 3, 0), END, "3.3.0 and later"),
        (DisableFlags::SPRING, sys::mjDSBL_SPRING, version(3, 3, 6), END, "3.3.6 and later"),
        (DisableFlags::DAMPER, sys::mjDSBL_DAMPER, version(3, 3, 6), END, "3.3.6 and later"),
        (DisableFlags::ISLAND, sys::mjDSBL_ISLAND, version(3, 3, 6), END, "3.3.6 and later"),
        (DisableFlags::MULTICCD, sys::mjDSBL_MULTICCD, version(3, 8, 0), END, "3.8.0 and later"),
    ];
    for (flag, bit, first, end, versions) in disable {
        let mut model = sample::cartpole();
        if changes(&mut model, |options| options.disable |= flag, first, end, versions) {
            assert_eq!(raw_option!(model, disableflags) as u32, bit);
            assert_eq!(model.options().disable, flag);
            Data::new(model).unwrap().step().unwrap();
        }
    }
    #[rustfmt::skip]
    let enable = [
        (EnableFlags::ENERGY, sys::mjENBL_ENERGY, first, END, ""),
        (EnableFlags::SENSORNOISE, sys::mjENBL_SENSORNOISE, first, version(3, 1, 4), "2.2.2 to 3.1.3"),
        (EnableFlags::MULTICCD, sys::mjENBL_MULTICCD, first, version(3, 8, 0), "2.2.2 to 3.7.0"),
        (EnableFlags::INVDISCRETE, sys::mjENBL_INVDISCRETE, version(3, 0, 0), END, "3.0.0 and later"),
        (EnableFlags::DIAGEXACT, sys::mjENBL_DIAGEXACT, version(3, 9, 0), END, "3.9.0 and later"),
        (EnableFlags::SPECULATIVE, sys::mjENBL_SPECULATIVE, version(4, 0, 0), END, "4.0.0 and later"),
    ];
    for (flag, bit, first, end, versions) in enable {
        let mut model = sample::cartpole();
        if changes(&mut model, |options| options.enable |= flag, first, end, versions) {
            assert_eq!(raw_option!(model, enableflags) as u32, bit);
            assert_eq!(model.options().enable, flag);
            let mut data = Data::new(model).unwrap();
            data.step().unwrap();
            data.transition_fd(1e-6, Differences::Central).unwrap();
        }
    }
}

#[test]
fn the_defaults_of_the_options_are_those_of_the_engine() {
    let model = Model::from_xml_str("<mujoco/>").unwrap();
    assert_eq!(Options::default(), model.options());
}

#[test]
fn a_camera_or_light_of_a_body_that_is_fused_is_kept_or_rejected() {
    let text = |world: &str, body: &str| {
        format!(
            r#"<mujoco><compiler fusestatic="true"/><worldbody>{world}<body><freejoint/><geom size=".1"/>
            <body pos="0 0 1"><geom size=".1"/>{body}</body></body></worldbody></mujoco>"#
        )
    };
    // The compilers of these engines use a camera after they have deleted it.
    let is_rejected = cfg!(all(engine_since = "3.2.0", not(engine_since = "3.6.0")));
    for view in ["<camera/>", "<light/>"] {
        let in_world = Model::from_xml_str(&text(view, "")).unwrap();
        assert_eq!(in_world.ncam() + in_world.nlight(), 1);
        match Model::from_xml_str(&text("", view)) {
            Ok(model) => assert_eq!((model.ncam() + model.nlight(), is_rejected), (1, false)),
            Err(error) => {
                assert!(is_rejected, "{error}");
                assert!(error.to_string().contains("fusestatic"), "{error}");
            }
        }
    }
}
