//! Views of matrices as arrays of the crate `ndarray`.

use ndarray::{ArrayView2, ArrayViewMut2};

use super::{Matrix, MatrixView, MatrixViewMut};

/// Message for an empty matrix with more than `isize::MAX` rows or columns.
const TOO_LONG: &str = "ndarray has no arrays with more than isize::MAX rows or columns";

/// # Views of ndarray
///
/// These methods need the feature `ndarray`. The arrays are contiguous and row-major. The methods
/// panic if a matrix without values has more than `isize::MAX` rows or columns.
impl<'a> MatrixView<'a> {
    /// Returns the matrix as an array of ndarray, without a copy.
    ///
    /// ```
    /// use mujoco_safe::ndarray::Axis;
    /// use mujoco_safe::{Batch, sample};
    ///
    /// let mut batch = Batch::new(sample::cartpole(), 8)?;
    /// batch.reset_where(|_| true, |index, _, data| data.qpos_mut()[1] = 0.01 * index as f64)?;
    /// let means = batch.observations().as_ndarray().mean_axis(Axis(0)).unwrap();
    /// assert!((means[1] - 0.035).abs() < 1e-12);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn as_ndarray(&self) -> ArrayView2<'a, f64> {
        ArrayView2::from_shape(self.shape(), self.as_slice()).expect(TOO_LONG)
    }
}

/// # Views of ndarray
///
/// These methods need the feature `ndarray`. The arrays are contiguous and row-major. The methods
/// panic if a matrix without values has more than `isize::MAX` rows or columns.
impl MatrixViewMut<'_> {
    /// Returns the matrix as a mutable array of ndarray, without a copy.
    ///
    /// ```
    /// use mujoco_safe::ndarray::array;
    /// use mujoco_safe::{Batch, sample};
    ///
    /// // A linear policy for all simulations: controls = observations · gainsᵀ.
    /// let gains = array![[0.3, 3.0, 0.4, 0.6]]; // (nu, nobs)
    /// let mut batch = Batch::new(sample::cartpole(), 8)?;
    /// batch.step(|observations, controls| {
    ///     controls.as_ndarray_mut().assign(&observations.as_ndarray().dot(&gains.t()));
    /// })?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn as_ndarray_mut(&mut self) -> ArrayViewMut2<'_, f64> {
        ArrayViewMut2::from_shape(self.shape(), self.as_mut_slice()).expect(TOO_LONG)
    }
}

/// # Views of ndarray
///
/// These methods need the feature `ndarray`. The arrays are contiguous and row-major. The methods
/// panic if a matrix without values has more than `isize::MAX` rows or columns.
impl Matrix {
    /// Returns the matrix as an array of ndarray, without a copy.
    pub fn as_ndarray(&self) -> ArrayView2<'_, f64> {
        self.view().as_ndarray()
    }

    /// Returns the matrix as a mutable array of ndarray, without a copy.
    pub fn as_ndarray_mut(&mut self) -> ArrayViewMut2<'_, f64> {
        ArrayViewMut2::from_shape(self.shape(), self.as_mut_slice()).expect(TOO_LONG)
    }
}
