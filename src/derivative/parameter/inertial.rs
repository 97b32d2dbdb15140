//! Inertial parameters of a body, and their log-Cholesky coordinates.
//!
//! With the second moments of mass `Σ = ½ tr(I) 1 − I` the pseudo-inertia of a body is
//!
//! ```text
//! J = [Σ h; hᵀ m] = U Uᵀ,      U = e^α [e^d₁ s₁₂ s₁₃ t₁; 0 e^d₂ s₂₃ t₂; 0 0 e^d₃ t₃; 0 0 0 1],
//! ```
//!
//! and positive definite exactly if a distribution of positive mass in space has these parameters.
//! Hence `m = e^2α`, the centre of mass is t, and `Σ = m (U₃ U₃ᵀ + t tᵀ)` with the upper left part
//! U₃ of `e^−α U`.

use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector4};

use crate::error::{Error, InvalidKind, Result};
use crate::id::BodyId;
use crate::kind::Kind;
use crate::math;
use crate::model::{Model, ModelMut};
use crate::numerics::spatial::{Vec3, add, dot, scale, sub};

/// Symmetric matrix: `xx`, `yy`, `zz`, `xy`, `xz`, `yz`.
type Symmetric = [f64; 6];

/// Rows and columns of the numbers of a symmetric matrix.
const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Those of the log-Cholesky coordinates after the first in U.
const ELEMENTS: [(usize, usize); 9] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)];

/// Ten inertial parameters of a rigid body, on which its equations of motion depend linearly.
///
/// In the frame of the body and about its origin: the mass m (kg), the first moment of mass
/// `h = m c` for the centre of mass c (kg·m), and the rotational inertia (kg·m²),
///
/// ```text
/// [m, h_x, h_y, h_z, I_xx, I_yy, I_zz, I_xy, I_xz, I_yz].
/// ```
///
/// The off-diagonal numbers are elements of the matrix: `I_xy = −∫ x y dm`.
///
/// ```
/// use mujoco_safe::derivative::InertialParameters;
/// use mujoco_safe::sample;
///
/// let mut model = sample::cartpole();
/// let pole = model.body("pole")?.id();
/// let parameters = InertialParameters::of(&model, pole);
/// assert!((parameters.mass() - model.body_mass()[pole.index()]).abs() < 1e-12);
///
/// // Another mass for the same shape, by a coordinate for which every value is possible.
/// let mut coordinates = parameters.log_cholesky().expect("the pole has three dimensions");
/// coordinates[0] += 0.5 * 2.0_f64.ln();
/// InertialParameters::from_log_cholesky(&coordinates).write(&mut model.edit(), pole)?;
/// assert!((model.body_mass()[pole.index()] - 2.0 * parameters.mass()).abs() < 1e-12);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// Sources: C. Atkeson, C. An and J. Hollerbach, "Estimation of inertial parameters of manipulator
/// loads and links", IJRR 1986; C. Rucker and P. Wensing, "Smooth parameterization of rigid-body
/// inertia", RA-L 2022.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "pseudo-inertia")]
#[doc(alias = "dynamic parameters")]
pub struct InertialParameters(pub [f64; 10]);

impl InertialParameters {
    /// Returns the parameters of a body: of its own mass, without its children.
    ///
    /// # Panics
    ///
    /// If the body belongs to another model.
    pub fn of(model: &Model, body: BodyId) -> Self {
        let body = model.body(body).id().index();
        let (mass, centre) = (model.body_mass()[body], model.body_ipos()[body]);
        let axes = inertial_axes(model, body);
        let central = axes * Matrix3::from_diagonal(&model.body_inertia()[body].into()) * axes.transpose();
        Self::point(mass, &centre).with_inertia(&PLACES.map(|place| central[place]))
    }

    /// Returns the parameters with the pseudo-inertia `P + Pᵀ`.
    pub(super) fn of_product(product: &Matrix4<f64>) -> Self {
        let pseudo = product + product.transpose();
        let trace = pseudo[(0, 0)] + pseudo[(1, 1)] + pseudo[(2, 2)];
        let [xx, yy, zz, xy, xz, yz] = PLACES.map(|place| -pseudo[place]);
        let [x, y, z, mass] = pseudo.column(3).into_owned().into();
        Self([mass, x, y, z, trace + xx, trace + yy, trace + zz, xy, xz, yz])
    }

    /// Returns the parameters of a mass at a point.
    pub(super) fn point(mass: f64, &[x, y, z]: &Vec3) -> Self {
        let point = Vector4::new(x, y, z, 1.0);
        Self::of_product(&(0.5 * mass * point * point.transpose()))
    }

    /// Returns the parameters with more rotational inertia.
    pub(super) fn with_inertia(self, more: &Symmetric) -> Self {
        let [mass, x, y, z, ..] = self.0;
        let [xx, yy, zz, xy, xz, yz] = add(&self.inertia(), more);
        Self([mass, x, y, z, xx, yy, zz, xy, xz, yz])
    }

    /// Returns the mass, kg.
    pub fn mass(&self) -> f64 {
        self.0[0]
    }

    /// Returns the centre of mass in the frame of the body, m. Not finite without mass.
    pub fn centre_of_mass(&self) -> [f64; 3] {
        let [mass, x, y, z, ..] = self.0;
        scale(&[x, y, z], 1.0 / mass)
    }

    fn inertia(&self) -> Symmetric {
        *self.0.last_chunk().expect("Bug: six of ten numbers")
    }

    /// Returns the rotational inertia about the centre of mass, in the axes of the body: `xx`,
    /// `yy`, `zz`, `xy`, `xz`, `yz`.
    pub fn central_inertia(&self) -> [f64; 6] {
        sub(&self.inertia(), &Self::point(self.mass(), &self.centre_of_mass()).inertia())
    }

    /// Returns the log-Cholesky coordinates `[α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃]` of C.
    /// Rucker and P. Wensing, "Smooth parameterization of rigid-body inertia", RA-L 2022: each ten
    /// numbers are the coordinates of parameters that a body can have. `None` for parameters that
    /// no body with an extent in three dimensions has.
    pub fn log_cholesky(&self) -> Option<[f64; 10]> {
        let mass = self.mass();
        let central = self.central_inertia();
        let trace = 0.5 * (central[0] + central[1] + central[2]);
        // Second moments about the centre of mass, for a mass of one.
        let [xx, yy, zz, xy, xz, yz] =
            std::array::from_fn(|at| (if at < 3 { trace - central[at] } else { -central[at] }) / mass);
        let third = zz.sqrt();
        let (s23, s13) = (yz / third, xz / third);
        let second = (yy - s23 * s23).sqrt();
        let s12 = (xy - s13 * s23) / second;
        let first = (xx - s12 * s12 - s13 * s13).sqrt();
        let [t1, t2, t3] = self.centre_of_mass();
        let coordinates = [0.5 * mass.ln(), first.ln(), second.ln(), third.ln(), s12, s23, s13, t1, t2, t3];
        coordinates.iter().all(|value| value.is_finite()).then_some(coordinates)
    }

    /// Returns the parameters for log-Cholesky coordinates: the inverse of
    /// [`log_cholesky`](Self::log_cholesky).
    pub fn from_log_cholesky(coordinates: &[f64; 10]) -> Self {
        let upper = upper(coordinates);
        Self::of_product(&(0.5 * upper * upper.transpose()))
    }

    /// Returns the derivatives of the parameters by the log-Cholesky coordinates: row k is the
    /// derivative by coordinate k.
    pub fn log_cholesky_derivative(coordinates: &[f64; 10]) -> [[f64; 10]; 10] {
        let upper = upper(coordinates);
        std::array::from_fn(|at| {
            let mut change = Matrix4::zeros();
            match at {
                0 => change = upper,
                1..4 => change[ELEMENTS[at - 1]] = upper[ELEMENTS[at - 1]],
                _ => change[ELEMENTS[at - 1]] = upper[(3, 3)],
            }
            Self::of_product(&(change * upper.transpose())).0
        })
    }

    /// Writes the parameters to `body_mass`, `body_ipos`, `body_iquat` and `body_inertia` of a
    /// body. Derived constants need a call of
    /// [`update_constants`](crate::ModelMut::update_constants) afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the mass and the principal moments of inertia are finite and
    /// positive.
    ///
    /// # Panics
    ///
    /// If the body belongs to another model.
    pub fn write(&self, model: &mut ModelMut<'_>, body: BodyId) -> Result<()> {
        let index = model.body(body).id().index();
        let (mass, centre) = (self.mass(), self.centre_of_mass());
        let [xx, yy, zz, xy, xz, yz] = self.central_inertia();
        let is_positive = |value: f64| value.is_finite() && value > 0.0;
        let invalid = |what: &str, value: f64| {
            let what = format!("the {what} of {}", model.described(Kind::Body, index));
            Error::invalid(InvalidKind::OutOfRange, what, value, "finite and positive")
        };
        if !is_positive(mass) {
            return Err(invalid("mass", mass));
        }
        if let Some(value) = [xx, yy, zz, xy, xz, yz].into_iter().chain(centre).find(|value| !value.is_finite()) {
            return Err(invalid("moment of inertia", value));
        }
        // The engine's own decomposition leaves rotations below 10⁻⁶.
        let SymmetricEigen { mut eigenvectors, eigenvalues } =
            SymmetricEigen::new(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
        if eigenvectors.determinant() < 0.0 {
            eigenvectors.neg_mut();
        }
        let moments: Vec3 = eigenvalues.into();
        if let Some(moment) = moments.into_iter().find(|&moment| !is_positive(moment)) {
            return Err(invalid("moment of inertia", moment));
        }
        let rotation: [[f64; 3]; 3] = eigenvectors.transpose().into();
        model.body_mass_mut()[index] = mass;
        model.body_ipos_mut()[index] = centre;
        model.body_inertia_mut()[index] = moments;
        model.body_iquat_mut()[index] = math::mat2quat(&std::array::from_fn(|at| rotation[at / 3][at % 3]));
        Ok(())
    }
}

/// Returns the rotation matrix from the inertial frame of a body to its frame.
fn inertial_axes(model: &Model, body: usize) -> Matrix3<f64> {
    let mut quat = model.body_iquat()[body];
    math::normalize4(&mut quat);
    Matrix3::from_row_slice(&math::quat2mat(&quat))
}

/// Returns `v vᵀ` for a principal axis of the inertia of a body in its frame.
pub(super) fn principal_moment(model: &Model, body: usize, axis: usize) -> Symmetric {
    let axes = inertial_axes(model, body);
    PLACES.map(|(row, column)| axes[(row, axis)] * axes[(column, axis)])
}

/// Returns U.
fn upper(coordinates: &[f64; 10]) -> Matrix4<f64> {
    let mut upper = Matrix4::identity();
    for (at, (&place, &value)) in ELEMENTS.iter().zip(&coordinates[1..]).enumerate() {
        upper[place] = if at < 3 { value.exp() } else { value };
    }
    coordinates[0].exp() * upper
}

/// Returns the change of the centre of mass by a change of the parameters.
pub(super) fn centre_change(parameters: &InertialParameters, change: &[f64; 10]) -> Vec3 {
    let (mass, centre) = (parameters.mass(), parameters.centre_of_mass());
    let change: Vec3 = std::array::from_fn(|axis| (change[1 + axis] - change[0] * centre[axis]) / mass);
    if dot(&change, &change).is_finite() { change } else { [0.0; 3] }
}

/// Returns the unit vector of a coordinate.
pub(super) fn unit<const N: usize>(at: usize) -> [f64; N] {
    let mut vector = [0.0; N];
    vector[at] = 1.0;
    vector
}
