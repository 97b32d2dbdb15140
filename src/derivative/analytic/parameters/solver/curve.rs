//! Stiffness, damping and impedance of a constraint, with their derivatives.
//!
//! With the impedances d₀ and d₁ at zero and at full violation, the width w, the midpoint m and the
//! power p of `solimp`, the violation r, and a time constant τ and a damping ratio ζ, or −k and −b,
//! in `solref`,
//!
//! ```text
//! K = 1/(d₁ τ ζ)²,   B = 2/(d₁ τ)        or        K = k/d₁²,   B = b/d₁,
//! I = d₀ + y (d₁ − d₀),     x = min(r/w, 1),
//! y = xᵖ m¹⁻ᵖ  for x ≤ m,   y = 1 − (1 − x)ᵖ (1 − m)¹⁻ᵖ  otherwise.
//! ```

use mujoco_sys::{mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON, mjMAXIMP, mjMINIMP, mjMINVAL};

use super::dual::Dual;
use super::sources::SolverParameters;
use crate::data::Data;
use crate::derivative::analytic::constraint::violation;
use crate::model::DisableFlags;

/// Largest relative difference from the engine's numbers.
const ROUNDING: f64 = 1e-9;

/// `solref` that the engine takes if one has mixed formats.
const DEFAULT_REFERENCE: [f64; 2] = [0.02, 1.0];

/// K, B and I.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    pub(super) stiffness: Dual,
    pub(super) damping: Dual,
    pub(super) impedance: Dual,
}

impl Curve {
    /// Computes the numbers of the constraint that starts at a row from its parameters.
    pub(super) fn new(data: &Data, row: usize, count: usize, parameters: &SolverParameters) -> Self {
        let options = &data.model().raw().opt;
        let mut reference = parameters.reference;
        if (reference[0].value > 0.0) != (reference[1].value > 0.0) {
            reference = DEFAULT_REFERENCE.map(Dual::constant);
        }
        let is_safe = options.disableflags as u32 & DisableFlags::REFSAFE.bits() == 0;
        if is_safe && reference[0].value > 0.0 {
            reference[0] = reference[0].clamped(2.0 * options.timestep, f64::INFINITY);
        }
        let [start, end, width, midpoint, power] = parameters.impedance;
        let [start, end, midpoint] = [start, end, midpoint].map(|number| number.clamped(mjMINIMP, mjMAXIMP));
        let (width, power) = (width.clamped(0.0, f64::INFINITY), power.clamped(1.0, f64::INFINITY));

        let [first, second] = reference;
        let [stiffness, damping] = if first.value > 0.0 {
            let (product, invert) = (end * first, |number: Dual, numerator: f64| {
                Dual::constant(numerator) / number.clamped(mjMINVAL, f64::INFINITY)
            });
            let frequency = product * second;
            [invert(frequency * frequency, 1.0), invert(product, 2.0)]
        } else {
            [-1.0 * first / (end * end), -1.0 * second / end]
        };
        let fraction = fraction(violation(data, row, count), width, midpoint, power);
        Self { stiffness, damping, impedance: start + fraction * (end - start) }
    }

    /// Returns `true` if the values are those of the engine.
    pub(super) fn is_of_engine(&self, data: &Data, row: usize) -> bool {
        let [stiffness, damping, impedance, _] = data.efc_KBIP()[row];
        let is_friction = [mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON].contains(&(data.efc_type()[row] as u32));
        let agree = |ours: Dual, theirs: f64| (ours.value - theirs).abs() <= ROUNDING * theirs.abs();
        (is_friction || agree(self.stiffness, stiffness))
            && agree(self.damping, damping)
            && agree(self.impedance, impedance)
    }
}

/// Returns y for a violation.
fn fraction(violation: f64, width: Dual, midpoint: Dual, power: Dual) -> Dual {
    if width.value <= mjMINVAL {
        // The impedance is the mean of both.
        return Dual::constant(0.5);
    }
    let (x, one) = (Dual::constant(violation) / width, Dual::constant(1.0));
    if x.value <= 0.0 || x.value >= 1.0 {
        return Dual::constant(if x.value >= 1.0 { 1.0 } else { 0.0 });
    }
    let scaled_power = |x: Dual, midpoint: Dual| x * (x / midpoint).power(power - one);
    if x.value <= midpoint.value { scaled_power(x, midpoint) } else { one - scaled_power(one - x, one - midpoint) }
}
