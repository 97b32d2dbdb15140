//! Norms: the cost of a residual.

/// Cost ρ(r) of each component r of a residual. The cost of a residual is the sum over its
/// components.
///
/// | norm | ρ(r) | ρ′(r) | ρ″(r) |
/// |---|---|---|---|
/// | quadratic | `r²/2` | `r` | `1` |
/// | smooth absolute value, width w | `√(r² + w²) − w` | `r/√(r² + w²)` | `w²/(r² + w²)^(3/2)` |
/// | Huber, width w, `|r| ≤ w` | `r²/2` | `r` | `1` |
/// | Huber, width w, `|r| > w` | `w (|r| − w/2)` | `w sign r` | `0` |
///
/// The last two grow linearly, so a large residual does not outweigh all others. Near zero, the
/// smooth absolute value is `r²/(2w)`. All norms are convex.
///
/// Sources: P. J. Huber, *Robust estimation of a location parameter*, Annals of Mathematical
/// Statistics 35, 1964; P. Charbonnier, L. Blanc-Féraud, G. Aubert, M. Barlaud, *Two deterministic
/// half-quadratic regularization algorithms for computed imaging*, ICIP 1994, for the smooth
/// absolute value.
///
/// ```
/// use mujoco_safe::control::residual::Norm;
///
/// assert_eq!(Norm::Quadratic.value(3.0), 4.5);
/// assert_eq!(Norm::SmoothAbs { width: 4.0 }.value(3.0), 1.0);
/// assert_eq!(Norm::Huber { width: 1.0 }.value(3.0), 2.5);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Norm {
    /// Half the square.
    #[default]
    Quadratic,
    /// Smooth absolute value, also called pseudo-L1 or Charbonnier loss.
    SmoothAbs {
        /// Residual at which the slope is `1/√2`, above zero, in the unit of the residual.
        width: f64,
    },
    /// Quadratic up to the width, linear beyond.
    Huber {
        /// Residual at which the linear part begins, above zero, in the unit of the residual.
        width: f64,
    },
}

impl Norm {
    /// Returns ρ(r).
    pub fn value(self, residual: f64) -> f64 {
        match self {
            Self::Quadratic => 0.5 * residual * residual,
            Self::SmoothAbs { width } => residual.hypot(width) - width,
            Self::Huber { width } => {
                let size = residual.abs();
                if size <= width { 0.5 * size * size } else { width * (size - 0.5 * width) }
            }
        }
    }

    /// Returns ρ′(r).
    pub fn slope(self, residual: f64) -> f64 {
        match self {
            Self::Quadratic => residual,
            Self::SmoothAbs { width } => residual / residual.hypot(width),
            // Not `clamp`, which panics for a negative width.
            Self::Huber { width } => residual.min(width).max(-width),
        }
    }

    /// Returns ρ″(r).
    pub fn curvature(self, residual: f64) -> f64 {
        match self {
            Self::Quadratic => 1.0,
            Self::SmoothAbs { width } => {
                let distance = residual.hypot(width);
                (width / distance).powi(2) / distance
            }
            Self::Huber { width } => f64::from(u8::from(residual.abs() <= width)),
        }
    }

    /// Returns the factor `ρ′(r)/r` of the squares whose slope is that of the norm, for iteratively
    /// reweighted least squares.
    pub(crate) fn weight(self, residual: f64) -> f64 {
        if residual == 0.0 { self.curvature(0.0) } else { self.slope(residual) / residual }
    }

    /// Returns the width, if the norm has one.
    pub(super) fn width(self) -> Option<f64> {
        match self {
            Self::Quadratic => None,
            Self::SmoothAbs { width } | Self::Huber { width } => Some(width),
        }
    }
}
