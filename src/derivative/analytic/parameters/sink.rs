//! Receiver of the derivatives of the terms of the equations of motion.

/// Receiver of the derivatives by one parameter.
pub(super) trait Sink {
    /// Adds to ∂g.
    fn residual(&mut self, dof: usize, value: f64);
    /// Adds to `∂M w + h ∂Q s`.
    fn spread(&mut self, dof: usize, value: f64);
    /// Adds to the derivative of a next activation.
    fn activation(&mut self, activation: usize, value: f64);
    /// Adds to the derivative of a reading at constant accelerations.
    fn sensor(&mut self, address: usize, value: f64);
}
