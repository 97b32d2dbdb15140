//! Derivatives of the forces of a medium on bodies, each approximated by the box of its inertia.
//!
//! In the axes of the body's inertia, each component of force and torque about the centre of mass
//! is a function `−a x − b |x| x` of the same component x of the velocity relative to the wind
//! ("Fluid forces" in the engine's documentation). Degree of freedom j changes that velocity, in
//! axes that move with j, by ψ_j (`rigid_body.rs`) and by the turn `ω × wind` of the wind, and the
//! velocity of j by S_j. With the change ∂W of the force vector W in these axes, the derivative of
//! `S_k · W` is
//!
//! ```text
//! S_k · ∂W  if j moves the axis of k,      S_k · (∂W + S_j ×* W)  otherwise.
//! ```
//!
//! Bodies with geoms of the ellipsoid model have no formula here.

use std::f64::consts::PI;

use super::rigid_body::RigidBodies;
use super::tree::Tree;
use crate::data::Data;
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::spatial::{
    Spatial, Vec3, add, angular, cross, cross_force, dot, linear, spatial, sub, velocity_at, wrench,
};

/// Smallest mass and inertia, as in the engine.
const MIN: f64 = mujoco_sys::mjMINVAL;

/// Returns `true` if the model has a medium.
fn has_medium(model: &Model) -> bool {
    let options = &model.raw().opt;
    let is_passive = options.disableflags as u32 & DisableFlags::PASSIVE.bits() == 0;
    is_passive && (options.density > 0.0 || options.viscosity > 0.0)
}

/// Returns `true` if a medium exerts forces that have no closed form here.
pub(in crate::derivative) fn is_obstacle(model: &Model) -> bool {
    has_medium(model) && model.geom_fluid().iter().any(|&[interaction, ..]| interaction > 0.0)
}

/// Force and torque on a body, for components of the velocity `[ω; v]` in the axes of its inertia:
/// `−(linear + quadratic |x|) x`.
struct Drag {
    linear: Spatial,
    quadratic: Spatial,
}

impl Drag {
    fn new(model: &Model, body: usize) -> Self {
        let options = &model.raw().opt;
        let [x, y, z] = model.body_inertia()[body];
        let side = |twice: f64| (twice.max(MIN) / model.body_mass()[body] * 6.0).sqrt();
        let sides: Vec3 = [side(y + z - x), side(x + z - y), side(x + y - z)];
        let diameter = (sides[0] + sides[1] + sides[2]) / 3.0;
        let (viscosity, density) = (options.viscosity.max(0.0), options.density.max(0.0));
        let others = |axis: usize| (sides[(axis + 1) % 3], sides[(axis + 2) % 3]);
        let torque: Vec3 = std::array::from_fn(|axis| {
            let (first, second) = others(axis);
            density * sides[axis] * (first.powi(4) + second.powi(4)) / 64.0
        });
        let force: Vec3 = std::array::from_fn(|axis| {
            let (first, second) = others(axis);
            0.5 * density * first * second
        });
        let turning = PI * diameter.powi(3) * viscosity;
        let sliding = 3.0 * PI * diameter * viscosity;
        Self { linear: spatial(&[turning; 3], &[sliding; 3]), quadratic: spatial(&torque, &force) }
    }

    fn force(&self, velocity: &Spatial) -> Spatial {
        std::array::from_fn(|i| -(self.linear[i] + self.quadratic[i] * velocity[i].abs()) * velocity[i])
    }

    /// Returns the change of the force with the velocity.
    fn change(&self, velocity: &Spatial, change: &Spatial) -> Spatial {
        std::array::from_fn(|i| -(self.linear[i] + 2.0 * self.quadratic[i] * velocity[i].abs()) * change[i])
    }
}

/// Subtracts the derivatives of the forces of the medium by positions and velocities from the
/// derivatives of the residual.
pub(super) fn differentiate(data: &Data, tree: &Tree, bodies: &RigidBodies, residual: &mut Matrix) {
    let (model, axes) = (data.model(), data.cdof());
    let nv = model.nv();
    if !has_medium(model) {
        return;
    }
    let wind = model.raw().opt.wind;
    for body in (1..model.nbody()).filter(|&body| model.body_mass()[body] >= MIN) {
        let rotation = &data.ximat()[body];
        let arm = sub(&data.xipos()[body], &data.subtree_com()[ffi::size(model.body_rootid()[body])]);
        let to_local = |vector: &Vec3| -> Vec3 {
            std::array::from_fn(|axis| (0..3).map(|i| rotation[3 * i + axis] * vector[i]).sum())
        };
        let to_world = |vector: &Vec3| -> Vec3 {
            std::array::from_fn(|i| dot(&[0, 1, 2].map(|axis| rotation[3 * i + axis]), vector))
        };
        let local = |motion: &Spatial, wind: &Vec3| -> Spatial {
            spatial(&to_local(&angular(motion)), &to_local(&sub(&velocity_at(motion, &arm), wind)))
        };
        // A force vector about the reference point of the tree.
        let global = |force: &Spatial| wrench(&to_world(&angular(force)), &to_world(&linear(force)), &arm);
        let drag = Drag::new(model, body);
        let velocity = local(&data.cvel()[body], &wind);
        let force = global(&drag.force(&velocity));
        for j in tree.chain(tree.last[body]) {
            let axis = &axes[j];
            // The wind turns backwards in axes that turn with j.
            let by_position = local(bodies.velocity_change(j), &cross(&wind, &angular(axis)));
            let fixed = global(&drag.change(&velocity, &by_position));
            let turned = add(&fixed, &cross_force(axis, &force));
            let by_velocity = global(&drag.change(&velocity, &local(axis, &[0.0; 3])));
            for k in tree.chain(tree.last[body]) {
                let change = if tree.group[j] <= tree.group[k] { &fixed } else { &turned };
                residual[(k, j)] -= dot(&axes[k], change);
                residual[(k, nv + j)] -= dot(&axes[k], &by_velocity);
            }
        }
    }
}
