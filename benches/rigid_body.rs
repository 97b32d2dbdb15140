//! Derivatives of rigid-body dynamics of an arm (6 degrees of freedom) and of the humanoid (27),
//! without contacts: of inverse dynamics, the regressor, and the linear system of a step.
//!
//! If the environment variable `MUJOCO_PYTHON` names a Python with Pinocchio and Crocoddyl, both
//! compute the same alternately, from C++ that Python calls, and the ratio of the times is printed.
//! For the arm, the largest difference of the results is printed too, relative to the largest
//! element of a matrix.
//!
//! ```text
//! cargo bench --bench rigid_body
//! pip install pin==4.0.0 crocoddyl==3.2.1
//! MUJOCO_PYTHON=python3 cargo bench --bench rigid_body
//! ```

mod common;

use std::time::Instant;
use std::{array, env, iter};

use common::peer::{Comparison, Peer, line};
use mujoco_safe::derivative::{
    InverseForce, InverseJacobians, InverseOutputs, TransitionMethod, TransitionOptions, TransitionOutputs,
};
use mujoco_safe::enums::{Integrator, JointType};
use mujoco_safe::math::{cross, mul_quat, neg_quat, quat2mat, rot_vec_quat};
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Data, Lineariser, Matrix, Model, Result, StateSpace, sample};

const PEER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/perf/rigid_body.py");
/// States of a run.
const STATES: usize = 50;
/// Number of runs by each program.
const PAIRS: usize = 60;
/// Inertial parameters in the order of Pinocchio.
const ORDER: [usize; 10] = [0, 1, 2, 3, 4, 7, 5, 8, 9, 6];

/// Positions, velocities, accelerations and forces.
type State = [Vec<f64>; 4];

/// Name of a computation of this library, the request for the other, and the function.
type Computation = (&'static str, &'static str, fn(&mut Robot));

struct Robot {
    data: Data,
    lineariser: Lineariser,
    states: Vec<State>,
    system: StateSpace,
    inverse: InverseJacobians,
    regressor: Matrix,
}

impl Robot {
    /// Creates a robot without constraints, passive forces and implicit damping.
    fn new(mut model: Model) -> Result<Self> {
        let mut edit = model.edit();
        edit.dof_damping_mut().fill(0.0);
        edit.edit_options(|options| {
            options.integrator = Integrator::Euler;
            options.disable |= DisableFlags::CONSTRAINT | DisableFlags::PASSIVE;
        })?;
        let data = Data::new(model)?;
        let model = data.model().clone();
        let mut number = 1_u32;
        let mut random = |size: f64| {
            number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            size * (f64::from(number >> 8) / f64::from(1 << 23) - 1.0)
        };
        let mut states = Vec::new();
        for _ in 0..STATES {
            let mut qpos = model.qpos0().to_vec();
            let moves: Vec<f64> = iter::repeat_with(|| random(0.7)).take(model.nv()).collect();
            model.integrate_pos(&mut qpos, &moves, 1.0)?;
            let mut vector = |size| iter::repeat_with(|| random(size)).take(model.nv()).collect::<Vec<f64>>();
            states.push([qpos, vector(1.0), vector(2.0), vector(1.0)]);
        }
        Ok(Self {
            lineariser: Lineariser::new(model.clone(), TransitionOptions::default())?,
            system: StateSpace::zeros(&model),
            inverse: InverseJacobians::zeros(&model),
            regressor: Matrix::zeros(model.nv(), 10 * model.nbody()),
            states,
            data,
        })
    }

    fn set(&mut self, index: usize) {
        let [qpos, qvel, qacc, force] = &self.states[index];
        self.data.qpos_mut().copy_from_slice(qpos);
        self.data.qvel_mut().copy_from_slice(qvel);
        self.data.qacc_mut().copy_from_slice(qacc);
        self.data.qfrc_applied_mut().copy_from_slice(force);
    }

    fn inverse(&mut self) {
        let InverseJacobians { df_dq, df_dv, df_da, .. } = &mut self.inverse;
        let outputs =
            InverseOutputs { df_dq: Some(df_dq), df_dv: Some(df_dv), df_da: Some(df_da), ..Default::default() };
        let result = self.lineariser.inverse_jacobians_into(&mut self.data, InverseForce::Total, outputs);
        assert_eq!(result.expect("a valid state").method, TransitionMethod::Analytic);
    }

    fn regressor(&mut self) {
        self.data.fwd_position().and_then(|()| self.data.fwd_velocity()).expect("a valid state");
        self.data.joint_regressor_into(&mut self.regressor).expect("velocities are computed");
    }

    fn linear_system(&mut self) {
        let StateSpace { a, b, .. } = &mut self.system;
        let outputs = TransitionOutputs { a: Some(a), b: Some(b), ..Default::default() };
        let result = self.lineariser.linear_system_into(&mut self.data, outputs);
        assert_eq!(result.expect("a valid state").method, TransitionMethod::Analytic);
    }

    /// Returns the median seconds of a computation.
    fn time(&mut self, compute: fn(&mut Self)) -> f64 {
        let times = (0..STATES).map(|index| {
            self.set(index);
            let start = Instant::now();
            compute(self);
            start.elapsed().as_secs_f64()
        });
        common::median(times.collect())
    }

    /// Returns the largest differences of the results of an arm from those of Pinocchio.
    fn differences(&mut self, peer: &mut Peer) -> std::io::Result<[f64; 3]> {
        let model = self.data.model().clone();
        let (nv, mut differences) = (model.nv(), [0.0; 3]);
        let mut compare = |peer: &mut Peer, which: usize, name: &str, ours: &[(Matrix, usize)]| {
            let values = peer.ask(&format!("values {name}"))?;
            let mut rest = &values[..];
            for (matrix, columns) in ours {
                let (theirs, others) = rest.split_at(matrix.nrows() * columns);
                let largest = theirs.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                for (theirs, ours) in theirs.iter().zip(matrix.as_slice()).filter(|(_, ours)| !ours.is_nan()) {
                    differences[which] = f64::max(differences[which], (theirs - ours).abs() / largest);
                }
                rest = others;
            }
            Ok::<_, std::io::Error>(())
        };
        self.set(0);
        self.inverse();
        let inverse = [&self.inverse.df_dq, &self.inverse.df_dv, &self.inverse.df_da];
        // Its derivatives by forces are the transposed ones of this library.
        compare(peer, 0, "inverse", &inverse.map(|matrix| (transposed(matrix), nv)))?;
        self.regressor();
        let joints = model.njnt();
        let mut regressor = Matrix::from_row_major(nv, 10 * joints, vec![f64::NAN; nv * 10 * joints]);
        for joint in 0..joints {
            let body = model.jnt_bodyid()[joint] as usize;
            // The last joint of a body carries it. The others have columns too in Pinocchio.
            if model.jnt_bodyid().get(joint + 1) == Some(&(body as i32)) {
                continue;
            }
            for (at, number) in ORDER.into_iter().enumerate() {
                (0..nv).for_each(|dof| regressor[(dof, 10 * joint + at)] = self.regressor[(dof, 10 * body + number)]);
            }
        }
        compare(peer, 1, "regressor", &[(regressor, 10 * joints)])?;
        self.linear_system();
        let mut by_force = Matrix::zeros(2 * nv, nv);
        for (actuator, gear) in model.actuator_gear().iter().enumerate() {
            (0..2 * nv).for_each(|row| by_force[(row, actuator)] = self.system.b[(row, actuator)] / gear[0]);
        }
        compare(peer, 2, "linear_system", &[(self.system.a.clone(), 2 * nv), (by_force, nv)])?;
        Ok(differences)
    }
}

fn transposed(matrix: &Matrix) -> Matrix {
    let columns = (0..matrix.ncols()).flat_map(|column| matrix.rows().map(move |row| row[column]));
    Matrix::from_row_major(matrix.ncols(), matrix.nrows(), columns.collect::<Vec<_>>())
}

/// Returns the model as lines of the input of the program.
fn description(model: &Model, states: &[State]) -> Vec<String> {
    let mut records: Vec<Vec<f64>> = Vec::new();
    let (mut joints, mut frames) = (0, vec![(-1, [0.0; 3], [1.0, 0.0, 0.0, 0.0])]);
    let plus = |a: [f64; 3], b: [f64; 3]| array::from_fn(|axis| a[axis] + b[axis]);
    for body in model.bodies().skip(1) {
        let index = body.id().index();
        let (mut joint, origin, rotation) = frames[model.body_parentid()[index] as usize];
        let mut position = plus(origin, rot_vec_quat(&model.body_pos()[index], &rotation));
        let mut rotation = mul_quat(&rotation, &model.body_quat()[index]);
        for view in model.joints().filter(|view| model.jnt_bodyid()[view.id().index()] as usize == index) {
            let number = view.id().index();
            let anchor = model.jnt_pos()[number];
            let (kind, place) = match view.joint_type() {
                JointType::Free => (0.0, None),
                JointType::Slide => (2.0, Some(anchor)),
                _ => (1.0, Some(anchor)),
            };
            let mut record = vec![f64::from(joint), kind];
            let at = place.map_or([0.0; 3], |anchor| plus(position, rot_vec_quat(&anchor, &rotation)));
            record.extend(at);
            record.extend(quat2mat(if place.is_some() { &rotation } else { &frames[0].2 }));
            record.extend(model.jnt_axis()[number]);
            record.extend([0.0; 13]);
            record.push(model.dof_armature()[model.jnt_dofadr()[number] as usize]);
            records.push(record);
            joint = joints;
            joints += 1;
            position = place.map_or([0.0; 3], |anchor| anchor.map(|value| -value));
            rotation = frames[0].2;
        }
        let axes = quat2mat(&mul_quat(&rotation, &model.body_iquat()[index]));
        let moments = model.body_inertia()[index];
        let inertia = (0..9).map(|at| (0..3).map(|k| axes[at / 3 * 3 + k] * moments[k] * axes[at % 3 * 3 + k]).sum());
        let mut record = vec![f64::from(joint), 3.0];
        record.extend([0.0; 15]);
        record.push(model.body_mass()[index]);
        record.extend(plus(position, rot_vec_quat(&model.body_ipos()[index], &rotation)));
        record.extend(inertia.collect::<Vec<f64>>());
        record.push(0.0);
        records.push(record);
        frames.push((joint, position, rotation));
    }
    let options = model.options();
    let head = [records.len() as f64, states.len() as f64, options.gravity[2], options.timestep];
    let records = records.into_iter().map(line);
    iter::once(line(head)).chain(records).chain(states.iter().map(|state| line(coordinates(model, state)))).collect()
}

/// Returns a state in the coordinates of Pinocchio, where velocities of a free joint are in the
/// axes of its body, and accelerations are spatial.
fn coordinates(model: &Model, [qpos, qvel, qacc, force]: &State) -> Vec<f64> {
    let [mut qpos, mut qvel, mut qacc, mut force] = [qpos, qvel, qacc, force].map(Clone::clone);
    if model.jnt_type()[0] == JointType::Free as i32 {
        let to_body = neg_quat(&array::from_fn(|at| qpos[3 + at]));
        qpos[3..7].rotate_left(1);
        for vector in [&mut qvel, &mut qacc, &mut force] {
            let turned = rot_vec_quat(&array::from_fn(|axis| vector[axis]), &to_body);
            vector[..3].copy_from_slice(&turned);
        }
        let (linear, angular) = (array::from_fn(|axis| qvel[axis]), array::from_fn(|axis| qvel[3 + axis]));
        for (value, part) in qacc.iter_mut().zip(cross(&angular, &linear)) {
            *value -= part;
        }
    }
    [qpos, qvel, qacc, force].concat()
}

fn beside_pinocchio(python: &str, name: &str, robot: &mut Robot) -> std::io::Result<()> {
    let lines = description(robot.data.model(), &robot.states);
    let mut peer = Peer::start(python, &[PEER], &lines)?;
    let computations: [Computation; 4] = [
        ("inverse_jacobians_into", "inverse", Robot::inverse),
        ("joint_regressor_into", "regressor", Robot::regressor),
        ("linear_system_into, derivatives of accelerations alone by Pinocchio", "forward", Robot::linear_system),
        ("linear_system_into, by Crocoddyl", "linear_system", Robot::linear_system),
    ];
    for (what, request, compute) in computations {
        let Comparison { ours, theirs, ratio, .. } = peer.compare(PAIRS, request, || robot.time(compute))?;
        let ([low, middle, high], [ours, theirs]) = (ratio, [ours, theirs].map(|seconds| 1e6 * seconds));
        println!("{name}/{what}: {ours:.1} µs, the other {theirs:.1} µs, ratio {middle:.3} [{low:.3}, {high:.3}]");
    }
    if robot.data.model().nq() == robot.data.model().nv() {
        let [inverse, regressor, system] = robot.differences(&mut peer)?;
        println!("{name}/differences: inverse {inverse:.1e}, regressor {regressor:.1e}, linear system {system:.1e}");
    }
    Ok(())
}

fn main() -> Result<()> {
    let arm = concat!(env!("CARGO_MANIFEST_DIR"), "/models/arm.xml");
    for (name, model) in [("rigid_body/arm", Model::from_xml_path(arm)?), ("rigid_body/humanoid", sample::humanoid())] {
        let mut robot = Robot::new(model)?;
        let Ok(python) = env::var("MUJOCO_PYTHON") else {
            common::bench(&format!("{name}/inverse_jacobians_into"), 1, &mut || robot.inverse());
            common::bench(&format!("{name}/joint_regressor_into"), 1, &mut || robot.regressor());
            common::bench(&format!("{name}/linear_system_into"), 1, &mut || robot.linear_system());
            continue;
        };
        beside_pinocchio(&python, name, &mut robot).unwrap_or_else(|error| println!("{name}: {error}"));
    }
    Ok(())
}
