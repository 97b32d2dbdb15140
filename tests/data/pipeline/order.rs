//! Every stage after every other stage, and long random sequences of stages.

use mujoco_safe::data::{ConeHessian, MissingResults, SensorUpdate};
use mujoco_safe::enums::{Cone, Integrator, JacobianStorage, Solver};
use mujoco_safe::model::EnableFlags;
use mujoco_safe::{Data, Error, Model, Result, Stage, StateSpec, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::cases::cases;

type Part = (&'static str, fn(&mut Data) -> Result<()>);

macro_rules! parts {
    ($($name:ident)*) => { [$((stringify!($name), Data::$name as fn(&mut Data) -> Result<()>)),*] };
}

/// In the order of the engine's forward dynamics.
pub(super) const IN_ORDER: [Part; 19] = parts! {
    kinematics com_pos camlight compute_tendon compute_crb factor_m collision make_constraint transmission project_constraint
    compute_ten_velocity compute_actuator_velocity com_vel passive reference_constraint compute_qfrc_bias
    fwd_actuation fwd_acceleration fwd_constraint
};

const OTHERS: [Part; 22] = parts! {
    subtree_vel fwd_position fwd_velocity inv_position inv_velocity inv_constraint compare_fwd_inv
    sensor_pos sensor_vel sensor_acc energy_pos energy_vel rne_post_constraint euler runge_kutta
    step step1 step2 forward inverse reset cost
};

/// Extension methods, which the tables list beside the methods of the library.
trait More {
    fn cost(&mut self) -> Result<()>;
}

impl More for Data {
    fn cost(&mut self) -> Result<()> {
        let jar = vec![-0.1; self.nefc()];
        self.constraint_update(&jar, ConeHessian::Compute).map(drop)
    }
}

/// Returns calls with arguments, and calls that read the results of stages.
fn more() -> Vec<Part> {
    fn skip(data: &mut Data, stage: Stage, sensors: SensorUpdate) -> Result<()> {
        data.forward_skip(stage, sensors)
    }
    vec![
        ("skip nothing", |data| skip(data, Stage::None, SensorUpdate::Skip)),
        ("skip positions", |data| skip(data, Stage::Position, SensorUpdate::Compute)),
        ("skip velocities", |data| skip(data, Stage::Velocity, SensorUpdate::Skip)),
        ("inverse, skip nothing", |data| data.inverse_skip(Stage::None, SensorUpdate::Skip)),
        ("inverse, skip positions", |data| data.inverse_skip(Stage::Position, SensorUpdate::Compute)),
        ("inverse, skip velocities", |data| data.inverse_skip(Stage::Velocity, SensorUpdate::Skip)),
        ("full_m", |data| data.full_m().map(drop)),
        ("full_moment", |data| data.full_moment().map(drop)),
        ("solve_m", |data| {
            let vector = vec![1.0; data.model().nv()];
            data.solve_m_into(&vector, &mut vec![0.0; vector.len()])
        }),
        ("mul_jac_vec", |data| {
            let vector = vec![1.0; data.model().nv()];
            data.mul_jac_vec_into(&vector, &mut vec![0.0; data.nefc()])
        }),
        ("mul_jac_t_vec", |data| {
            let vector = vec![1.0; data.nefc()];
            data.mul_jac_t_vec_into(&vector, &mut vec![0.0; data.model().nv()])
        }),
        ("contact forces", |data| data.contacts().try_for_each(|contact| contact.force().map(drop))),
        ("another solver", |data| {
            data.edit_model(|model| {
                model.edit_options(|options| {
                    options.solver = if options.solver == Solver::Pgs { Solver::Newton } else { Solver::Pgs };
                })
            })
        }),
        ("another storage", |data| {
            data.edit_model(|model| {
                model.edit_options(|options| {
                    options.jacobian = match options.jacobian {
                        JacobianStorage::Sparse => JacobianStorage::Dense,
                        _ => JacobianStorage::Sparse,
                    };
                })
            })
        }),
        ("another cone", |data| {
            data.edit_model(|model| {
                model.edit_options(|options| {
                    options.cone = if options.cone == Cone::Elliptic { Cone::Pyramidal } else { Cone::Elliptic };
                })
            })
        }),
    ]
}

fn all() -> Vec<Part> {
    IN_ORDER.into_iter().chain(OTHERS).chain(more()).collect()
}

/// Returns the two models with all solvers, cones and storages, with and without the no-slip
/// solver, and every optional computation.
fn subjects() -> impl Iterator<Item = (String, Data)> {
    let every = Model::from_xml_str(include_str!("../../models/every_element.xml")).unwrap();
    let models = [("every element", every), ("humanoid", sample::humanoid()), ("adhesion", adhesion())];
    models.into_iter().flat_map(|(name, model)| {
        let mut cases = Vec::new();
        for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
            for cone in [Cone::Pyramidal, Cone::Elliptic] {
                for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
                    for noslip_iterations in [0, 3] {
                        let mut model = model.clone();
                        model
                            .edit()
                            .edit_options(|options| {
                                (options.solver, options.cone, options.jacobian) = (solver, cone, jacobian);
                                options.noslip_iterations = noslip_iterations;
                                options.enable |= EnableFlags::ENERGY;
                                options.iterations = options.iterations.min(10);
                            })
                            .unwrap();
                        let mut data = Data::new(model).unwrap();
                        if name == "humanoid" {
                            data.reset_to_key("squat").unwrap();
                        }
                        cases.push((format!("{name}, {solver:?}, {cone:?}, {jacobian:?}, {noslip_iterations}"), data));
                    }
                }
            }
        }
        cases
    })
}

/// Returns two balls on a floor, one of which has an adhesion actuator.
fn adhesion() -> Model {
    Model::from_xml_str(
        r#"<mujoco>
             <size njmax="100" nconmax="20"/>
             <worldbody>
               <geom type="plane" size="1 1 .1"/>
               <body pos="0 0 .099"><freejoint/><geom size=".1" condim="3"/></body>
               <body name="sticky" pos=".3 0 .099"><freejoint/><geom size=".1" condim="4"/></body>
             </worldbody>
             <actuator><adhesion body="sticky" ctrlrange="0 1" gain="10"/></actuator>
           </mujoco>"#,
    )
    .unwrap()
}

/// Calls the stages in the given order. Only a stage that is out of order may be rejected.
fn call(what: &str, data: &mut Data, parts: &[Part]) -> usize {
    let mut done = 0;
    for (name, part) in parts {
        match part(data) {
            Ok(()) => done += 1,
            Err(Error::NotComputed { .. }) => {}
            // A meaningless order may produce NaN, which is reported.
            Err(Error::Unstable(_)) => data.reset().unwrap(),
            Err(error) => {
                let names: Vec<_> = parts.iter().map(|(name, _)| name).collect();
                panic!("{what}: {name} of {names:?}: {error}");
            }
        }
    }
    done
}

#[test]
fn stages_in_order_equal_forward_dynamics() {
    for (name, mut whole) in subjects() {
        for _ in 0..30 {
            whole.step().unwrap();
        }
        let mut parts = whole.clone();
        parts.edit_model(|_| ()).unwrap(); // which discards computed results
        assert_eq!(parts.stage(), Stage::None);
        let mut stepped = whole.clone();
        whole.forward().unwrap();
        for (part, compute) in IN_ORDER {
            compute(&mut parts).unwrap_or_else(|error| panic!("{name}: {part}: {error}"));
            match part {
                "project_constraint" => {
                    parts.sensor_pos().unwrap();
                    parts.energy_pos().unwrap();
                    assert_eq!(parts.stage(), Stage::Position);
                }
                "compute_qfrc_bias" => {
                    parts.sensor_vel().unwrap();
                    parts.energy_vel().unwrap();
                    assert_eq!(parts.stage(), Stage::Velocity);
                }
                _ => {}
            }
        }
        assert_eq!(parts.stage(), Stage::Acceleration);
        parts.sensor_acc().unwrap();
        assert_same(&name, &parts, &whole);
        assert!(whole.nefc() > 0, "{name} must have constraints");

        // Followed by an integrator, the stages equal a step.
        if whole.model().options().integrator == Integrator::Euler {
            parts.euler().unwrap();
            stepped.step().unwrap();
            assert!(parts.state(StateSpec::INTEGRATION) == stepped.state(StateSpec::INTEGRATION), "{name}");
        }
    }
}

#[test]
fn stages_of_the_inverse_in_order_equal_inverse_dynamics() {
    for (name, mut whole) in subjects() {
        for _ in 0..30 {
            whole.step().unwrap();
        }
        whole.forward().unwrap();
        let mut parts = whole.clone();
        whole.inverse().unwrap();
        parts.inv_position().unwrap();
        parts.inv_velocity().unwrap();
        parts.inverse_skip(Stage::Velocity, SensorUpdate::Skip).unwrap();
        let nv = parts.model().nv();
        let bits = |values: &[f64]| -> Vec<u64> { values.iter().map(|value| value.to_bits()).collect() };
        assert_eq!(bits(parts.qfrc_inverse()), bits(whole.qfrc_inverse()), "{name}");
        assert_eq!(parts.qfrc_inverse().len(), nv);
        parts.inv_constraint().unwrap();
        assert_eq!(bits(parts.qfrc_constraint()), bits(whole.qfrc_constraint()), "{name}");
    }
}

#[test]
fn a_runge_kutta_step_equals_forward_and_runge_kutta() {
    for (name, mut data) in subjects() {
        data.edit_model(|model| model.edit_options(|options| options.integrator = Integrator::Rk4)).unwrap();
        let mut whole = data.clone();
        whole.step().unwrap();
        data.forward().unwrap();
        data.runge_kutta().unwrap();
        assert!(data.state(StateSpec::INTEGRATION) == whole.state(StateSpec::INTEGRATION), "{name}");
        assert_eq!(data.stage(), whole.stage(), "{name}");
        data.require(MissingResults::SENSORS).unwrap();
        assert!(matches!(data.runge_kutta(), Err(Error::NotComputed { call: "runge_kutta", .. })));
    }
}

#[track_caller]
fn assert_same(name: &str, ours: &Data, theirs: &Data) {
    // The velocities of actuators with sparse moments are summed in another order than by the
    // engine.
    assert_within(name, ours, theirs, if cfg!(engine_since = "3.2.5") { 1e-9 } else { 0.0 });
}

/// Checks that all results are equal, within a tolerance relative to their sizes or to one.
#[track_caller]
pub(super) fn assert_within(name: &str, ours: &Data, theirs: &Data, tolerance: f64) {
    let same = |what: &str, ours: &[f64], theirs: &[f64]| {
        let is_same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a - b).abs() < tolerance * (1.0 + b.abs());
        let differs = ours.iter().zip(theirs).position(|(&a, &b)| !is_same(a, b));
        assert!(ours.len() == theirs.len() && differs.is_none(), "{name}: {what} at {differs:?}");
    };
    same("ten_length", ours.ten_length(), theirs.ten_length());
    same("actuator_length", ours.actuator_length(), theirs.actuator_length());
    same("crb", ours.crb().as_flattened(), theirs.crb().as_flattened());
    same("full_m", ours.full_m().unwrap().as_slice(), theirs.full_m().unwrap().as_slice());
    same("efc_aref", ours.efc_aref(), theirs.efc_aref());
    same("qacc", ours.qacc(), theirs.qacc());
    same("qfrc_bias", ours.qfrc_bias(), theirs.qfrc_bias());
    same("qfrc_passive", ours.qfrc_passive(), theirs.qfrc_passive());
    same("qfrc_constraint", ours.qfrc_constraint(), theirs.qfrc_constraint());
    same("actuator_force", ours.actuator_force(), theirs.actuator_force());
    same("actuator_velocity", ours.actuator_velocity(), theirs.actuator_velocity());
    same("ten_velocity", ours.ten_velocity(), theirs.ten_velocity());
    same("efc_force", ours.efc_force(), theirs.efc_force());
    same("sensordata", ours.sensordata(), theirs.sensordata());
    same("energy", &ours.energy(), &theirs.energy());
    same("qacc_warmstart", ours.qacc_warmstart(), theirs.qacc_warmstart());
    assert_eq!(ours.contacts().len(), theirs.contacts().len(), "{name}");
}

/// Each pair runs with a fifth of the settings of each model. Five shares no factor with the
/// numbers of settings, so that each pair meets each solver, cone, storage and number of
/// iterations.
#[test]
fn all_pairs_succeed_or_are_rejected() {
    let all = all();
    let pairs: Vec<[Part; 2]> = all.iter().flat_map(|first| all.iter().map(|second| [*first, *second])).collect();
    let nth = cases(15, 5);
    for (case, (name, data)) in subjects().enumerate() {
        let mut scratch = data.clone();
        for pair in pairs.iter().skip(case % nth).step_by(nth) {
            scratch.clone_from(&data);
            scratch.reset().unwrap();
            call(&name, &mut scratch, pair);
        }
    }
}

#[test]
fn triples_after_forward_succeed_or_are_rejected() {
    let all = all();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    for (name, mut data) in subjects() {
        for _ in 0..5 {
            data.step().unwrap();
        }
        data.forward().unwrap();
        let mut scratch = data.clone();
        for _ in 0..cases(60, 200) {
            scratch.clone_from(&data);
            let triple: Vec<Part> = (0..3).map(|_| all[random.random_range(0..all.len())]).collect();
            call(&name, &mut scratch, &triple);
        }
    }
}

#[test]
fn long_random_sequences_succeed_or_are_rejected() {
    let all = all();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(6);
    let mut done = 0;
    for (name, mut data) in subjects() {
        for _ in 0..20 {
            let sequence: Vec<Part> = (0..20).map(|_| all[random.random_range(0..all.len())]).collect();
            done += call(&name, &mut data, &sequence);
            data.reset().unwrap();
        }
    }
    assert!(done > 5000, "{done} calls were in order");
}

#[test]
fn the_error_names_the_missing_calls_in_order() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let error = data.com_vel().unwrap_err().to_string();
    assert!(error.contains("com_vel needs the results of kinematics, com_pos, which"), "{error}");
    data.forward().unwrap();
    data.kinematics().unwrap();
    let error = data.fwd_constraint().unwrap_err().to_string();
    assert!(error.contains("project_constraint, reference_constraint, fwd_acceleration"), "{error}");
    assert!(error.contains("call these first, in this order, or forward"), "{error}");
    data.forward().unwrap();
    data.euler().unwrap();
    let error = data.euler().unwrap_err().to_string();
    assert!(error.contains("euler needs the results of kinematics"), "{error}");
}

/// As in Python programs that call `mj_kinematics` and `mj_comPos` before a Jacobian.
#[test]
fn jacobians_after_kinematics_and_com_pos_equal_those_after_forward() {
    for (name, mut data) in subjects().step_by(24) {
        let error = data.jac_body(1).unwrap_err().to_string();
        assert!(error.contains("jac_body needs the results of kinematics, com_pos"), "{error}");
        data.kinematics().unwrap();
        data.com_pos().unwrap();
        let jacobians = |data: &mut Data| {
            let mut all: Vec<_> =
                (0..data.model().nbody()).map(|body| data.jac_body_com(body).unwrap().stacked()).collect();
            all.extend((0..data.model().nsite()).map(|site| data.jac_site(site).unwrap().stacked()));
            all.push(data.jac_subtree_com(1).unwrap());
            all.push(data.angmom_mat(1).unwrap());
            all
        };
        let early = jacobians(&mut data);
        data.forward().unwrap();
        assert_eq!(early, jacobians(&mut data), "{name}");
    }
}
