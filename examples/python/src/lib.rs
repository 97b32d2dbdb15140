//! Python module with a batch of simulations whose states and sensor readings are NumPy arrays
//! without a copy.
//!
//! ```text
//! scripts/python-module                                     # builds and tests the module
//! PYTHONPATH=target/python/module target/python/venv/bin/python
//! ```
//!
//! ```python
//! import mujoco_safe_python, numpy
//!
//! batch = mujoco_safe_python.Batch("models/humanoid.xml", 64)
//! for _ in range(100):
//!     controls = numpy.sin(batch.states[:, :1]) * numpy.ones(batch.nu)  # Reads the memory of the batch.
//!     batch.step(controls)
//! states = batch.states.copy()  # Remains valid after the next step.
//! ```
//!
//! # Aliasing
//!
//! The arrays borrow the memory that the next step overwrites. Python can read an array at any
//! time, from any thread, since NumPy releases the interpreter's lock during its loops. Rust must
//! therefore not write to the memory while an array exists. The base of each array is a [`View`],
//! which the batch counts. The methods that change the batch raise `BufferError` if there is a
//! view, as a `bytearray` does that is resized while a `memoryview` of it exists. Slices and other
//! views of an array keep its base. The arrays are read-only, and NumPy refuses to make them
//! writable, because their base does not offer a writable buffer. Code that ignores this, for
//! example by `ctypes`, can still write to the memory.
//!
//! A step releases the lock. If another thread uses the batch in the meantime, PyO3's check of
//! borrows raises `RuntimeError`.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mujoco_safe::{MatrixView, Model};
use numpy::ndarray::ArrayView2;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyBufferError, PyValueError};
use pyo3::prelude::*;

/// Batch of simulations of one model.
#[pyclass]
struct Batch {
    batch: mujoco_safe::Batch<'static>,
    /// Number of views.
    views: Arc<AtomicUsize>,
}

/// Base of an array that borrows the memory of a batch.
#[pyclass(frozen)]
struct View {
    /// Keeps the memory.
    _batch: Py<Batch>,
    views: Arc<AtomicUsize>,
}

impl Drop for View {
    fn drop(&mut self) {
        self.views.fetch_sub(1, Ordering::Release);
    }
}

#[pymethods]
impl Batch {
    /// Loads a model, and creates `count` simulations of it.
    #[new]
    fn new(path: PathBuf, count: usize) -> PyResult<Self> {
        let model = Model::from_xml_path(path).map_err(value_error)?;
        let width = model.nsensordata();
        let batch = mujoco_safe::Batch::new(model, count).map_err(value_error)?;
        let batch = batch.with_observations(width, |data, row| row.copy_from_slice(data.sensordata()));
        Ok(Self { batch, views: Arc::default() })
    }

    /// Number of simulations.
    #[getter]
    fn count(&self) -> usize {
        self.batch.len()
    }

    /// Number of controls of a simulation.
    #[getter]
    fn nu(&self) -> usize {
        self.batch.model().nu()
    }

    /// States `(count, nstate)`: time, `qpos`, `qvel`, `act`, warm start, controls, and further
    /// inputs. Read-only, without a copy.
    #[getter]
    fn states(slf: &Bound<'_, Self>) -> PyResult<Py<PyArray2<f64>>> {
        view(slf, |batch| batch.states())
    }

    /// Sensor readings `(count, nsensordata)` of the last step, which are those of the state before
    /// it; zero after a reset, NaN in a failed simulation. Read-only, without a copy.
    #[getter]
    fn sensordata(slf: &Bound<'_, Self>) -> PyResult<Py<PyArray2<f64>>> {
        view(slf, |batch| batch.observations())
    }

    /// Sets the controls `(count, nu)`, and steps all simulations a number of times.
    #[pyo3(signature = (controls, steps = 1))]
    fn step(&mut self, py: Python<'_>, controls: PyReadonlyArray2<'_, f64>, steps: usize) -> PyResult<()> {
        self.check_views()?;
        let (count, nu) = self.batch.controls().shape();
        if controls.shape() != [count, nu] {
            return Err(PyValueError::new_err(format!("the controls must have the shape ({count}, {nu})")));
        }
        // Copied before the lock is released, because another thread could change the array
        // afterwards.
        let controls: Vec<f64> = controls.as_array().iter().copied().collect();
        let batch = &mut self.batch;
        py.detach(|| {
            for _ in 0..steps {
                batch.step(|_, to| to.as_mut_slice().copy_from_slice(&controls))?;
            }
            Ok(())
        })
        .map_err(value_error)
    }

    /// Resets all simulations to the reference position, or to a keyframe.
    #[pyo3(signature = (keyframe = None))]
    fn reset(&mut self, py: Python<'_>, keyframe: Option<&str>) -> PyResult<()> {
        self.check_views()?;
        let batch = &mut self.batch;
        let start = |_: usize, _: u64, data: &mut mujoco_safe::Data| match keyframe {
            Some(keyframe) => data.reset_to_key(keyframe),
            None => Ok(()),
        };
        py.detach(|| batch.reset_where(|_| true, start)).map_err(value_error)
    }

    /// Returns the indices and the errors of all failed simulations.
    fn failures(&self) -> Vec<(usize, String)> {
        self.batch.failures().map(|(index, error)| (index, error.to_string())).collect()
    }
}

impl Batch {
    /// Checks that no array borrows the memory. The exclusive borrow of the batch prevents new
    /// ones.
    fn check_views(&self) -> PyResult<()> {
        match self.views.load(Ordering::Acquire) {
            0 => Ok(()),
            views => Err(PyBufferError::new_err(format!(
                "arrays borrow the memory of the batch ({views}): delete them (del), or keep copies (array.copy())"
            ))),
        }
    }
}

/// Returns a matrix of the batch as a read-only array.
fn view(
    batch: &Bound<'_, Batch>,
    matrix: impl for<'b> Fn(&'b mujoco_safe::Batch<'static>) -> MatrixView<'b>,
) -> PyResult<Py<PyArray2<f64>>> {
    // Fails during a step in another thread.
    let borrowed = batch.try_borrow()?;
    let matrix = matrix(&borrowed.batch);
    let matrix = ArrayView2::from_shape(matrix.shape(), matrix.as_slice()).expect("Bug: the matrix is not contiguous");
    borrowed.views.fetch_add(1, Ordering::Relaxed);
    let base = Bound::new(batch.py(), View { _batch: batch.clone().unbind(), views: borrowed.views.clone() })?;
    // SAFETY: the base keeps the batch, whose matrices are neither moved nor reallocated after its
    // creation. Its counter prevents writes until the base is dropped, which is when NumPy drops
    // the last view of the array.
    let array = unsafe { PyArray2::borrow_from_array(&matrix, base.into_any()) };
    array.try_readwrite()?.make_nonwriteable();
    Ok(array.unbind())
}

fn value_error(error: mujoco_safe::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Batches of simulations with NumPy arrays that borrow their memory.
#[pymodule]
mod mujoco_safe_python {
    #[pymodule_export]
    use super::Batch;
}
