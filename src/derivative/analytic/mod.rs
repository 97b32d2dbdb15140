//! Linear system of a step in closed form.
//!
//! As in `implicit.rs`, the accelerations a of a state solve g(q, v, a, u) = 0, and ∂a = −H⁻¹ ∂g.
//! Here ∂g is not differenced, but assembled from the derivatives of its terms,
//!
//! ```text
//! g = M a + c − passive − actuator − applied − Jᵀ f(J a − aref),
//! ```
//!
//! | term | derivative |
//! |---|---|
//! | `M a + c`: inertia, Coriolis and centrifugal forces, gravity | `rigid_body.rs`, along the tree (`tree.rs`) |
//! | springs and dampers of joints and tendons | `passive.rs` |
//! | forces of a medium | `fluid.rs` |
//! | moment arms of spatial tendons | `tendon.rs` |
//! | actuators | `actuators/` |
//! | forces on bodies | `applied.rs` |
//! | constraint forces `Jᵀ f` | `constraint/` |
//! | sensors | `sensors/` |
//! | step of the integrator | `integrator.rs`, `damped_inertia.rs`, `implicit_step.rs` |
//! | inertia matrix | `inertia.rs` |
//!
//! The derivatives of inverse dynamics (`inverse.rs`) consist of the same terms, and those by
//! parameters of the model (`parameters/`) have the same matrices.
//!
//! Positions are perturbed in the tangent space of [`Model::integrate_pos`]: degree of freedom j
//! displaces all bodies that it moves by the twist `cdof[j]`. This holds for all joints: for a free
//! joint `cdof` has the world's axes for translations and the axes of the body for rotations.
//!
//! Sources: J. Carpentier and N. Mansard, "Analytical derivatives of rigid body dynamics
//! algorithms", RSS 2018; R. Featherstone, "Rigid Body Dynamics Algorithms", Springer 2008; E.
//! Todorov, "Convex and analytically-invertible dynamics with contacts and constraints", ICRA 2014.

mod actuators;
mod applied;
mod constraint;
mod damped_inertia;
mod fluid;
mod implicit_step;
mod inertia;
mod integrator;
mod inverse;
mod parameters;
mod passive;
mod rigid_body;
mod sensors;
mod tendon;
mod tree;

use self::actuators::NextActivation;
pub(super) use self::actuators::obstacle as actuator_obstacle;
use self::constraint::Constraints;
pub(super) use self::fluid::is_obstacle as has_fluid_obstacle;
pub(super) use self::implicit_step::is_obstacle as has_implicit_step_obstacle;
use self::integrator::Integrator;
use self::inverse::Inverse;
pub(super) use self::parameters::Parameters;
use self::rigid_body::RigidBodies;
pub(super) use self::sensors::reads_tendons;
use self::sensors::{Point, Sensors};
use self::tendon::Tendons;
use self::tree::Tree;
use super::method::{DifferencedTerms, Fallback, Kinks};
use super::newton::Newton;
use super::{InverseForce, TransitionOutputs, sizes};
use crate::data::Data;
use crate::error::Result;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::solve_cholesky;

/// Terms that were differenced, or the reason why there is no closed form.
pub(super) type Outcome = std::result::Result<DifferencedTerms, Fallback>;

/// Linearisation in closed form, with its buffers.
#[derive(Debug)]
pub(super) struct Analytic {
    tree: Tree,
    bodies: RigidBodies,
    tendons: Tendons,
    constraints: Constraints,
    newton: Newton,
    pub(super) integrator: Integrator,
    sensors: Sensors,
    /// Created when inverse dynamics is first differentiated.
    inverse: Option<Inverse>,
    pub(super) parameters: Parameters,
    /// `(nv)`: g, and then a row of a Jacobian.
    row: Vec<f64>,
    /// `(nv, nx + nu)`: derivatives of g, and then of the next velocities, by positions,
    /// velocities, activations and controls.
    derivative: Matrix,
    /// `(nv, nx + nu)`: buffer of the integrator.
    sum: Matrix,
    /// `(na)`
    next_activation: Vec<NextActivation>,
    /// Kinks at the state of the last linearisation.
    pub(super) kinks: Kinks,
}

/// Returns the acceleration of gravity, zero if it is disabled.
fn gravity(model: &Model) -> [f64; 3] {
    let options = &model.raw().opt;
    if options.disableflags as u32 & DisableFlags::GRAVITY.bits() == 0 { options.gravity } else { [0.0; 3] }
}

/// Returns `true` if the rows of C and D of a sensor have a closed form.
pub(super) fn is_sensor_covered(model: &Model, sensor: usize) -> bool {
    sensors::is_covered(model, sensor)
}

/// Returns the kinks of constraints and springs after inverse dynamics, as far as positions
/// determine them.
pub(super) fn kinks_of_positions(data: &Data) -> Kinks {
    constraint::kinks_of_state(data, &[]) | passive::kinks(data)
}

impl Analytic {
    pub(super) fn new(model: &Model) -> Self {
        let tree = Tree::new(model);
        let (nx, nu, _) = sizes(model);
        Self {
            bodies: RigidBodies::new(model, &tree),
            tree,
            tendons: Tendons::new(model),
            constraints: Constraints::new(model),
            newton: Newton::new(model),
            integrator: Integrator::new(model),
            sensors: Sensors::new(model, nx + nu),
            inverse: None,
            parameters: Parameters::new(model),
            row: vec![0.0; model.nv()],
            derivative: Matrix::zeros(model.nv(), nx + nu),
            sum: Matrix::zeros(model.nv(), nx + nu),
            next_activation: vec![NextActivation::default(); model.na()],
            kinks: Kinks::empty(),
        }
    }

    /// Writes A and B of the present state, and the rows of C and D [in closed
    /// form](Self::sensors_in_closed_form), as far as they are wanted. `for_parameters` is
    /// true if derivatives by parameters follow, with the sensors if those are wanted here.
    pub(super) fn linearise(
        &mut self,
        data: &mut Data,
        outputs: &mut TransitionOutputs<'_>,
        for_parameters: bool,
    ) -> Result<Outcome> {
        if !self.newton.solve_accelerations(data, &mut self.row)? {
            return Ok(Err(Fallback::NotConverged));
        }
        let wants_sensors = outputs.c.is_some() || outputs.d.is_some();
        let differenced = match self.differentiate_forces(data, None, wants_sensors)? {
            Ok(differenced) => differenced,
            Err(reason) => return Ok(Err(reason)),
        };
        if for_parameters && wants_sensors {
            self.differentiate_readings(data);
        }
        let Self { tree, bodies, tendons, constraints, newton, integrator, sensors, derivative, sum, .. } = self;
        solve_cholesky(&newton.factor, derivative);
        if wants_sensors {
            let point = Point {
                data,
                tree,
                bodies,
                tendons,
                forces: &constraints.force_sensors,
                interactions: &constraints.interactions,
                deceleration: derivative,
                has_actuators: true,
            };
            sensors.differentiate(point, false);
        }
        integrator.differentiate(data, tree, bodies, derivative, sum)?;
        if !derivative.as_slice().iter().all(|value| value.is_finite()) {
            return Ok(Err(Fallback::Singular));
        }
        if wants_sensors {
            sensors.write(outputs);
        }
        self.write(data.model(), outputs);
        Ok(Ok(differenced))
    }

    /// Writes the derivatives of the equations of motion, at fixed accelerations, to `derivative`:
    /// with all forces, or with those that inverse dynamics subtracts. The sums that sensors need
    /// are updated if sensors are wanted.
    fn differentiate_forces(
        &mut self,
        data: &mut Data,
        inverse: Option<InverseForce>,
        wants_sensors: bool,
    ) -> Result<Outcome> {
        let has_actuators = inverse != Some(InverseForce::Total);
        let Self { tree, bodies, tendons, constraints, newton, row, derivative, next_activation, kinks, .. } = self;
        derivative.as_mut_slice().fill(0.0);
        next_activation.fill(NextActivation::default());
        bodies.differentiate(data, tree, gravity(data.model()), (data.qvel(), data.qacc()), derivative);
        if inverse.is_none() {
            applied::differentiate(data, tree, derivative);
        }
        fluid::differentiate(data, tree, bodies, derivative);
        if !tendons.differentiate(data, tree, has_actuators, derivative) {
            return Ok(Err(Fallback::SpatialTendon));
        }
        passive::differentiate(data, tendons, row, derivative);
        *kinks = passive::kinks(data);
        if has_actuators {
            let found = actuators::differentiate(data, tree, tendons, derivative, next_activation);
            // Inverse dynamics is not differentiated by controls and activations.
            *kinks |= if inverse.is_some() { found & Kinks::FORCES } else { found };
        }
        let differenced =
            constraints.differentiate(data, tree, tendons, wants_sensors, derivative, (&newton.jar, kinks))?;
        Ok(differenced.ok_or(Fallback::Constraint))
    }

    /// Returns the flags of the rows of C and D that the last linearisation has written,
    /// `(nsensordata)`.
    pub(super) fn sensors_in_closed_form(&self) -> &[bool] {
        self.sensors.in_closed_form()
    }

    /// Writes A and B from the derivatives of the next velocities and activations.
    fn write(&self, model: &Model, outputs: &mut TransitionOutputs<'_>) {
        let (nx, nu, _) = sizes(model);
        let (nv, h) = (model.nv(), model.raw().opt.timestep);
        if let Some(a) = &mut outputs.a {
            self.integrator.write(h, &self.derivative, 0..nx, a);
            self.integrator.add_position(nv, a);
            for (activation, next) in self.next_activation.iter().enumerate() {
                let row = a.row_mut(2 * nv + activation);
                row.fill(0.0);
                row[2 * nv + activation] = next.by_activation;
            }
        }
        if let Some(b) = &mut outputs.b {
            self.integrator.write(h, &self.derivative, nx..nx + nu, b);
            for (activation, next) in self.next_activation.iter().enumerate() {
                let row = b.row_mut(2 * nv + activation);
                row.fill(0.0);
                row[next.actuator] = next.by_control;
            }
        }
    }
}
