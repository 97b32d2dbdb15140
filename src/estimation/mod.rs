//! State estimation: the extended Kalman filter, and a smoother over a window of steps.
//!
//! [`ExtendedKalmanFilter`] estimates positions, velocities and activations from sensors that see
//! a part of them with noise, such as the pose of a floating base from an inertial measurement unit
//! and joint encoders. [`FixedLagSmoother`] improves the last estimates by later readings.
//! [`ProcessNoise`] is the random part of the motion, [`Measurement`] is the list of sensors.
//!
//! # Theory
//!
//! Positions with quaternions are not vectors, so the error of an estimate x̂ is a vector in the
//! tangent space there, as for all derivatives in this crate:
//!
//! ```text
//! e = x ⊟ x̂ = [dq; dv; da]      x = x̂ ⊞ e      length nx = 2 nv + na
//! ```
//!
//! with [`differentiate_pos_into`](crate::Model::differentiate_pos_into) for ⊟ and
//! [`integrate_pos`](crate::Model::integrate_pos) for ⊞: rotations are rotation vectors in the
//! frame of the body, positions of free joints are in the world frame. P is the covariance of e.
//! This is the error-state Kalman filter (J. Solà, *Quaternion kinematics for the error-state
//! Kalman filter*, arXiv:1711.02508, 2017), with the engine's step for the motion.
//!
//! **Prediction.** The estimate takes a [`step`](crate::Data::step) of the simulation. With the
//! derivatives A and B of this step, the covariance becomes
//!
//! ```text
//! P ← A (P + G F Gᵀ) Aᵀ + B U Bᵀ + Q      G = [0; h M⁻¹; 0]
//! ```
//!
//! with the covariances F of forces, U of the noise of controls and Q of other noise
//! ([`ProcessNoise`]).
//!
//! **Correction.** A reading is `y = h(x, u) + v`, where v is independent noise with the variances
//! R. With the derivatives C of h, one component after another,
//!
//! ```text
//! ν = y − h(x̂, u)    s = C P Cᵀ + r    K = P Cᵀ / s
//! x̂ ← x̂ ⊞ K ν        P ← (I − K C) P (I − K C)ᵀ + r K Kᵀ
//! ```
//!
//! in the form of P. Joseph, which rounding does not make indefinite. Then P is transported to the
//! tangent space of the new estimate (Solà, section 6.3).
//!
//! **Noise of the controls** acts on the next state through B, and on readings of accelerations and
//! forces through D, so the noise of the step and of the reading are correlated. The filter
//! therefore estimates it together with the state until the step: P has nx + nu rows, C is `[C D]`
//! and A is `[A B]`.
//!
//! # Time of readings
//!
//! The reading that belongs to a state, and to the controls there, is that of
//! [`Data::forward`](crate::Data::forward). After a step, `sensordata` has the readings in the
//! state [before the step](crate::guide::concepts#age-of-results). The order of a loop is therefore
//! `update`, `predict`, in the controls of the same step:
//!
//! ```text
//! robot.ctrl = u; robot.step()      filter.update(u, readings)      filter.predict(u)
//! ```
//!
//! # Contacts
//!
//! The step is not smooth where contacts begin and end. A is the derivative for the contacts of the
//! estimate, so an error across such a kink is propagated badly. Noise of
//! [contact forces](ProcessNoise::with_contact_forces) allows for it, and a
//! [gate](ExtendedKalmanFilter::with_gate) rejects readings of impacts.
//!
//! # Consistency
//!
//! A filter is consistent if its errors are as large as its covariance says. Test it in simulations
//! whose state is known, by [`nees`](ExtendedKalmanFilter::nees), and on a robot by
//! [`Update::nis`], with the bounds of [`chi_square_quantile`]. An extended Kalman filter tends to
//! trust itself too much where the motion is far from linear within the error; larger process noise
//! is the remedy.
//!
//! The [recipe](crate::guide::cookbook::state_estimation) estimates the pose of a floating base.

mod chi_square;
mod covariance;
mod filter;
mod measurement;
mod noise;
mod plant;
mod smoother;
mod update;

pub use self::chi_square::chi_square_quantile;
pub use self::filter::ExtendedKalmanFilter;
pub use self::measurement::Measurement;
pub use self::noise::ProcessNoise;
pub use self::smoother::{FixedLagSmoother, Smoothing};
pub use self::update::{ReadingOutcome, Update, UpdateStatus};
