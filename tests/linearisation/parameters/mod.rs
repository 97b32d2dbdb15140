//! Derivatives by parameters of the model against extrapolated differences of the engine's
//! `mj_step` with edited models, and against identities.

mod adjoint;
mod constraints;
mod contract;
mod identities;
mod oracle;
mod random_models;
mod sensors;

use mujoco_safe::derivative::{ModelParameter, TransitionMethod, TransitionOptions};
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Lineariser, Model};

use self::oracle::Oracle;

/// Largest deviation relative to the largest entry of a column.
const TOLERANCE: f64 = 1e-7;

/// Largest deviation of noisy differences, relative to the largest entry and to their estimated
/// error.
const NOISY_TOLERANCE: f64 = 1e-5;
/// The same for columns that are differenced, which have an error next to kinks.
const NOISY_TOLERANCE_IF_DIFFERENCED: f64 = 1e-4;
const NOISE_FACTOR: f64 = 10.0;

/// Largest error of a derivative that is zero, relative to the size of the samples.
const SMALLEST: f64 = 1e-9;

/// Least size of a column that relative deviations refer to, and of one that is differenced, which
/// has rounding errors of its own.
const SMALL: f64 = 1e-4;
const SMALL_IF_DIFFERENCED: f64 = 1e-2;

/// Agreement of a column with differences.
#[derive(Debug, PartialEq)]
enum Agreement {
    Close,
    /// Within the estimated error of the differences.
    Noisy,
    /// Description of the deviation.
    Far(String),
}

/// Returns the largest difference of two columns, and its row.
fn deviation(one: &[f64], other: &[f64]) -> (f64, usize) {
    let differences = one.iter().zip(other).map(|(one, other)| (one - other).abs());
    let rows = differences.enumerate().map(|(row, difference)| (difference, row));
    rows.max_by(|one, other| one.0.total_cmp(&other.0)).unwrap_or_default()
}

/// Compares a column with differences by one step after another, until they agree. The error of
/// differences is estimated from their last extrapolation, and from the nearest ones by another
/// step. Deviations are relative to the largest entry, or to a least one.
fn compare(oracle: &Oracle, parameter: ModelParameter, column: &[f64], is_differenced: bool) -> Agreement {
    let (least, tolerance) =
        if is_differenced { (SMALL_IF_DIFFERENCED, NOISY_TOLERANCE_IF_DIFFERENCED) } else { (SMALL, NOISY_TOLERANCE) };
    let scale = column.iter().fold(least, |largest: f64, value| largest.max(value.abs()));
    let mut estimates = Vec::new();
    for estimate in oracle.estimates(parameter) {
        if deviation(column, &estimate.column).0 <= TOLERANCE * scale {
            return Agreement::Close;
        }
        estimates.push(estimate);
    }
    let mut list = Vec::new();
    for (index, estimate) in estimates.iter().enumerate() {
        let (of_column, row) = deviation(column, &estimate.column);
        let others = estimates.iter().enumerate().filter(|(other, _)| *other != index);
        let nearest =
            others.map(|(_, other)| deviation(&other.column, &estimate.column).0).fold(f64::INFINITY, f64::min);
        let is_near = of_column <= tolerance * scale
            && (is_differenced || of_column <= nearest.max(NOISE_FACTOR * estimate.error));
        if is_near || of_column <= estimate.error && estimate.error <= SMALLEST * estimate.size {
            return Agreement::Noisy;
        }
        list.push(format!("{:.1e} (±{:.1e}) in row {row}", of_column / scale, estimate.error / scale));
    }
    Agreement::Far(list.join(", "))
}

/// Returns the numbers of an array as parameters.
fn field(model: &Model, array: &str, columns: usize) -> Vec<ModelParameter> {
    let mut list = Vec::new();
    for row in 0.. {
        for column in 0..columns {
            match ModelParameter::field(model, array, row, column) {
                Ok(parameter) => list.push(parameter),
                Err(_) => return list,
            }
        }
    }
    list
}

/// Returns all parameters of a model that have a formula in general.
fn with_formulas(model: &Model) -> Vec<ModelParameter> {
    let mut list: Vec<ModelParameter> = (0..3).map(|axis| Parameter::Gravity(axis).into()).collect();
    for body in model.bodies().skip(1).map(|body| body.id()) {
        list.extend([ModelParameter::Mass(body), Parameter::MassFactor(body).into()]);
        list.extend((0..3).map(|axis| ModelParameter::from(Parameter::CentreOfMass(body, axis))));
        list.extend((0..6).map(|at| ModelParameter::Inertia(body, at)));
        list.extend((0..10).map(|at| ModelParameter::LogCholesky(body, at)));
        list.extend((0..10).map(|at| ModelParameter::Inertial(body, at)));
    }
    list.extend(field(model, "body_inertia", 3).into_iter().skip(3));
    for joint in model.joints().map(|joint| joint.id()) {
        let of_joint = [
            Parameter::JointArmature(joint),
            Parameter::JointDamping(joint),
            Parameter::JointFrictionLoss(joint),
            Parameter::JointStiffness(joint),
        ];
        list.extend(of_joint.map(ModelParameter::from));
    }
    for array in
        ["dof_damping", "dof_armature", "qpos_spring", "tendon_stiffness", "tendon_damping", "tendon_frictionloss"]
    {
        list.extend(field(model, array, 1));
    }
    list.extend(field(model, "tendon_lengthspring", if cfg!(engine_since = "2.3.0") { 2 } else { 1 }));
    for array in ["actuator_gainprm", "actuator_biasprm"] {
        list.extend(field(model, array, 3));
    }
    list.extend(field(model, "actuator_dynprm", 1));
    list.extend(field(model, "actuator_gear", 1));
    list.extend(of_constraints(model));
    list
}

/// Returns all solver parameters of constraints.
fn of_constraints(model: &Model) -> Vec<ModelParameter> {
    const ARRAYS: [(&str, usize); 17] = [
        ("geom_friction", 3),
        ("geom_solref", 2),
        ("geom_solimp", 5),
        ("geom_solmix", 1),
        ("pair_friction", 5),
        ("pair_solref", 2),
        ("pair_solimp", 5),
        ("jnt_solref", 2),
        ("jnt_solimp", 5),
        ("dof_solref", 2),
        ("dof_solimp", 5),
        ("tendon_solref_lim", 2),
        ("tendon_solimp_lim", 5),
        ("tendon_solref_fri", 2),
        ("tendon_solimp_fri", 5),
        ("eq_solref", 2),
        ("eq_solimp", 5),
    ];
    ARRAYS.into_iter().flat_map(|(array, columns)| field(model, array, columns)).collect()
}

/// Returns parameters without a formula.
fn without_formulas(model: &Model) -> Vec<ModelParameter> {
    let mut list = Vec::new();
    for (array, columns) in [
        ("geom_margin", 1),
        ("jnt_range", 2),
        ("jnt_pos", 3),
        ("jnt_axis", 3),
        ("body_pos", 3),
        ("geom_pos", 3),
        ("geom_size", 1),
        ("body_iquat", 4),
    ] {
        list.extend(field(model, array, columns));
    }
    list
}

/// Gives each geom other friction: a contact has the larger one of its geoms, which has a kink
/// where both are equal.
fn vary_friction(data: &mut Data) {
    data.edit_model(|model| {
        let frictions = model.geom_friction_mut().iter_mut().flatten();
        frictions.enumerate().for_each(|(at, friction)| *friction *= 1.0 + 0.3 * (at as f64).sin());
    })
    .unwrap();
}

/// Differentiates in closed form and compares all columns. Returns the numbers of columns within
/// the tolerance and of noisy ones, or the columns that deviate.
fn compare_all(data: &mut Data, parameters: &[ModelParameter]) -> Result<[usize; 2], String> {
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    let (jacobian, report) = lineariser.parameter_jacobian(data, parameters).unwrap();
    assert_eq!(report.method, TransitionMethod::Analytic, "{report:?}");
    let differenced = lineariser.differenced_parameters(parameters).unwrap();
    let oracle = Oracle::new(data);
    let (mut close, mut noisy, mut failures) = (0, 0, Vec::new());
    for (index, &parameter) in parameters.iter().enumerate() {
        let rows = jacobian.state.rows().chain(jacobian.sensors.rows());
        let column: Vec<f64> = rows.map(|row| row[index]).collect();
        match compare(&oracle, parameter, &column, differenced.contains(&parameter)) {
            Agreement::Close => close += 1,
            Agreement::Noisy => noisy += 1,
            Agreement::Far(text) => {
                let model = data.model();
                let last = text.rsplit(' ').next().unwrap().parse::<usize>().unwrap();
                let sensor = last.checked_sub(jacobian.state.nrows()).map(|address| {
                    let sensor = model.sensor_adr().iter().rposition(|&start| start as usize <= address).unwrap();
                    format!("{:?}, sensor {sensor}", model.sensors().nth(sensor).unwrap().sensor_type())
                });
                failures.push(format!("{}: {text} {sensor:?}", parameter.name(model).unwrap()));
            }
        }
    }
    if failures.is_empty() { Ok([close, noisy]) } else { Err(format!("{report:?}:\n{}", failures.join("\n"))) }
}
