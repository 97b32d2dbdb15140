//! Linear feedback: the deviation from a set-point and its product with a gain.

use crate::data::Data;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// Buffer for the deviation `dx = [qpos ⊖ qpos0; qvel − qvel0; act − act0]`, so that control loops
/// do not allocate.
#[derive(Clone, Debug)]
pub(super) struct Feedback {
    deviation: Vec<f64>,
}

impl Feedback {
    /// Creates a buffer for `nx = 2 nv + na` states.
    pub(super) fn new(nx: usize) -> Self {
        Self { deviation: vec![0.0; nx] }
    }

    /// Changes the number of states.
    pub(super) fn resize(&mut self, nx: usize) {
        self.deviation.resize(nx, 0.0);
    }

    /// Computes the deviation of a simulation from a set-point. Without `qvel0` the set-point is at
    /// rest.
    #[inline]
    pub(super) fn measure(&mut self, data: &Data, qpos0: &[f64], qvel0: Option<&[f64]>, act0: &[f64]) -> Result<()> {
        let model = data.model();
        let nv = model.nv();
        Error::check_length("the positions of a set-point", qpos0.len(), model.nq())?;
        Error::check_length("the activations of a set-point", act0.len(), model.na())?;
        Error::check_length("the deviation from a set-point", self.deviation.len(), 2 * nv + model.na())?;
        let (dq, rest) = self.deviation.split_at_mut(nv);
        let (dv, da) = rest.split_at_mut(nv);
        model.differentiate_pos_into(1.0, qpos0, data.qpos(), dq)?;
        dv.copy_from_slice(data.qvel());
        if let Some(qvel0) = qvel0 {
            Error::check_length("the velocities of a set-point", qvel0.len(), nv)?;
            dv.iter_mut().zip(qvel0).for_each(|(dv, qvel0)| *dv -= qvel0);
        }
        for ((da, act), act0) in da.iter_mut().zip(data.act()).zip(act0) {
            *da = act - act0;
        }
        Ok(())
    }

    /// Computes `ctrl −= K dx` with a gain K `(nu, nx)`.
    #[inline]
    pub(super) fn subtract(&self, gain: &Matrix, ctrl: &mut [f64]) {
        let nx = self.deviation.len().max(1);
        for (ctrl, rows) in ctrl.chunks_mut(2).zip(gain.as_slice().chunks(2 * nx)) {
            // With an odd number of rows, the last row is passed twice.
            let feedback = dots([&rows[..nx], &rows[rows.len() - nx..]], &self.deviation);
            for (ctrl, feedback) in ctrl.iter_mut().zip(feedback) {
                *ctrl -= feedback;
            }
        }
    }
}

/// Returns the range of a control, which is infinite for an unlimited control.
pub(super) fn control_range(model: &Model, index: usize) -> [f64; 2] {
    if model.actuator_ctrllimited()[index] == 0 {
        [f64::NEG_INFINITY, f64::INFINITY]
    } else {
        model.actuator_ctrlrange()[index]
    }
}

/// Clamps the controls to their ranges, as the engine does before it uses them.
#[inline]
pub(super) fn clamp(data: &mut Data) {
    for index in 0..data.model().nu() {
        let [low, high] = control_range(data.model(), index);
        let ctrl = &mut data.ctrl_mut()[index];
        // Not `f64::clamp`, which panics if the ends of an edited range are in the wrong order. NaN
        // stays NaN, which the engine reports.
        if *ctrl < low {
            *ctrl = low;
        } else if *ctrl > high {
            *ctrl = high;
        }
    }
}

/// Returns the scalar products of two vectors with a third. Each product has four partial sums,
/// which the compiler keeps in vector registers. Both products are computed in one loop, so the
/// third vector is loaded once.
#[inline]
fn dots([a, b]: [&[f64]; 2], x: &[f64]) -> [f64; 2] {
    let ((a, a_rest), (b, b_rest), (x, x_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>(), x.as_chunks::<4>());
    let (mut a_sums, mut b_sums) = ([0.0; 4], [0.0; 4]);
    for ((a, b), x) in a.iter().zip(b).zip(x) {
        for lane in 0..4 {
            a_sums[lane] += a[lane] * x[lane];
        }
        for lane in 0..4 {
            b_sums[lane] += b[lane] * x[lane];
        }
    }
    [(a_sums, a_rest), (b_sums, b_rest)]
        .map(|([a, b, c, d], rest)| a + b + (c + d) + rest.iter().zip(x_rest).map(|(a, x)| a * x).sum::<f64>())
}
