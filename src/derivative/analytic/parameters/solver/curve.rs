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

use super::sources::SolverParameters;
use crate::data::Data;
use crate::derivative::analytic::constraint::violation;
use crate::model::DisableFlags;

/// Largest relative difference from the engine's numbers.
const ROUNDING: f64 = 1e-9;

/// `solref` that the engine takes if one has mixed formats.
const DEFAULT_REFERENCE: [f64; 2] = [0.02, 1.0];

/// A number with its derivative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Varied {
    pub(super) value: f64,
    pub(super) change: f64,
}

impl Varied {
    /// Returns the number in a range, with the derivative inside.
    fn clamped(self, low: f64, high: f64) -> Self {
        if self.value < low {
            Self { value: low, change: 0.0 }
        } else if self.value > high {
            Self { value: high, change: 0.0 }
        } else {
            self
        }
    }

    /// Returns the derivative of the logarithm.
    fn rate(self) -> f64 {
        self.change / self.value
    }
}

/// K, B and I.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    pub(super) stiffness: Varied,
    pub(super) damping: Varied,
    pub(super) impedance: Varied,
}

impl Curve {
    /// Computes the numbers of the constraint that starts at a row, for the derivatives of its
    /// parameters.
    pub(super) fn new(
        data: &Data,
        row: usize,
        count: usize,
        values: &SolverParameters,
        change: &SolverParameters,
    ) -> Self {
        let options = &data.model().raw().opt;
        let mut reference = [0, 1].map(|at| Varied { value: values.reference[at], change: change.reference[at] });
        if (reference[0].value > 0.0) != (reference[1].value > 0.0) {
            reference = DEFAULT_REFERENCE.map(|value| Varied { value, change: 0.0 });
        }
        let is_safe = options.disableflags as u32 & DisableFlags::REFSAFE.bits() == 0;
        if is_safe && reference[0].value > 0.0 {
            reference[0] = reference[0].clamped(2.0 * options.timestep, f64::INFINITY);
        }
        let of_impedance = |at: usize| Varied { value: values.impedance[at], change: change.impedance[at] };
        let [start, end, midpoint] = [0, 1, 3].map(|at| of_impedance(at).clamped(mjMINIMP, mjMAXIMP));
        let (width, power) = (of_impedance(2).clamped(0.0, f64::INFINITY), of_impedance(4).clamped(1.0, f64::INFINITY));

        let [stiffness, damping] = reference_of(reference, end);
        let fraction = fraction(violation(data, row, count), width, midpoint, power);
        let impedance = Varied {
            value: start.value + fraction.value * (end.value - start.value),
            change: (1.0 - fraction.value) * start.change
                + fraction.value * end.change
                + fraction.change * (end.value - start.value),
        };
        Self { stiffness, damping, impedance }
    }

    /// Returns `true` if the values are those of the engine.
    pub(super) fn is_of_engine(&self, data: &Data, row: usize) -> bool {
        let [stiffness, damping, impedance, _] = data.efc_KBIP()[row];
        let is_friction = [mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON].contains(&(data.efc_type()[row] as u32));
        let agree = |ours: Varied, theirs: f64| (ours.value - theirs).abs() <= ROUNDING * theirs.abs();
        (is_friction || agree(self.stiffness, stiffness))
            && agree(self.damping, damping)
            && agree(self.impedance, impedance)
    }
}

/// Returns K and B.
fn reference_of([first, second]: [Varied; 2], end: Varied) -> [Varied; 2] {
    let inverse = |square: f64, factor: f64, rate: f64| {
        let value = factor / square.max(mjMINVAL);
        Varied { value, change: if square > mjMINVAL { -value * rate } else { 0.0 } }
    };
    if first.value > 0.0 {
        let product = end.value * first.value;
        [
            inverse((product * second.value).powi(2), 1.0, 2.0 * (end.rate() + first.rate() + second.rate())),
            inverse(product, 2.0, end.rate() + first.rate()),
        ]
    } else {
        let direct = |number: Varied, divisor: f64, rate: f64| {
            let value = -number.value / divisor;
            Varied { value, change: -number.change / divisor - value * rate }
        };
        [direct(first, end.value * end.value, 2.0 * end.rate()), direct(second, end.value, end.rate())]
    }
}

/// Returns y for a violation.
fn fraction(violation: f64, width: Varied, midpoint: Varied, power: Varied) -> Varied {
    if width.value <= mjMINVAL {
        // The impedance is the mean of both.
        return Varied { value: 0.5, change: 0.0 };
    }
    let x = violation / width.value;
    if x <= 0.0 || x >= 1.0 {
        return Varied { value: if x >= 1.0 { 1.0 } else { 0.0 }, change: 0.0 };
    }
    let x = Varied { value: x, change: -x * width.rate() };
    let complement = |number: Varied| Varied { value: 1.0 - number.value, change: -number.change };
    if x.value <= midpoint.value {
        scaled_power(x, midpoint, power)
    } else {
        complement(scaled_power(complement(x), complement(midpoint), power))
    }
}

/// Returns `xᵖ m¹⁻ᵖ`.
fn scaled_power(x: Varied, midpoint: Varied, power: Varied) -> Varied {
    let value = x.value * (x.value / midpoint.value).powf(power.value - 1.0);
    let rate =
        power.value * x.rate() + (1.0 - power.value) * midpoint.rate() + power.change * (x.value / midpoint.value).ln();
    Varied { value, change: value * rate }
}
