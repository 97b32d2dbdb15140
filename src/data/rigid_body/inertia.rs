//! Inertia matrix: conversion, products, linear solves, sums, and recursive Newton–Euler.

use std::ptr;

use mujoco_sys::{self as sys, guard};

use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::matrix::Matrix;

/// Accelerations that [`Data::rne_into`] uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Accelerations {
    /// No accelerations.
    Zero,
    /// Present accelerations, [`Data::qacc`].
    Present,
}

/// # Inertia matrix and inverse dynamics
impl Data {
    /// Returns the inertia matrix M as a full matrix `(nv, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed.
    #[doc(alias = "mass matrix")]
    #[doc(alias = "inertia matrix")]
    #[doc(alias = "mj_fullM")]
    pub fn full_m(&self) -> Result<Matrix> {
        let nv = self.model().nv();
        let mut full = Matrix::zeros(nv, nv);
        self.full_m_into(&mut full)?;
        Ok(full)
    }

    /// Writes the inertia matrix M to a full matrix of the shape `(nv, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape.
    #[doc(alias = "mj_fullM")]
    pub fn full_m_into(&self, full: &mut Matrix) -> Result<()> {
        self.check_computed("full_m", Stage::Position)?;
        let nv = self.model().nv();
        Error::check_shape("the output of full_m", full.shape(), (nv, nv))?;
        // SAFETY: the output has nv × nv elements, and the inertia matrix was computed for this
        // model.
        unsafe { sys::adapted::full_m(self.model().as_ptr(), self.as_ptr(), full.as_mut_ptr()) };
        Ok(())
    }

    /// Computes `result = M vector`. Both have length nv.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong length.
    #[doc(alias = "mj_mulM")]
    pub fn mul_m_into(&self, vector: &[f64], result: &mut [f64]) -> Result<()> {
        self.check_computed("mul_m_into", Stage::Position)?;
        let nv = self.model().nv();
        Error::check_length("the result of mul_m_into", result.len(), nv)?;
        Error::check_length("the vector of mul_m_into", vector.len(), nv)?;
        // SAFETY: both have nv elements.
        unsafe { sys::mj_mulM(self.model().as_ptr(), self.as_ptr(), result.as_mut_ptr(), vector.as_ptr()) };
        Ok(())
    }

    /// Solves `M result = vector` with the factorisation that the pipeline computed. Both have
    /// length nv, or n·nv for n concatenated vectors.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] unless both lengths
    /// are the same multiple of nv.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let force = vec![1.0; data.model().nv()];
    /// let mut acceleration = vec![0.0; force.len()];
    /// let mut again = vec![0.0; force.len()];
    /// data.solve_m_into(&force, &mut acceleration)?;
    /// data.mul_m_into(&acceleration, &mut again)?;
    /// assert!(again.iter().all(|value| (value - 1.0).abs() < 1e-9));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_solveM")]
    pub fn solve_m_into(&mut self, vector: &[f64], result: &mut [f64]) -> Result<()> {
        self.check_computed("solve_m_into", Stage::Position)?;
        let names = ["the vector of solve_m_into", "the result of solve_m_into"];
        let n = self.vector_count("solve_m", names, vector.len(), result.len())?;
        self.call_mut("mj_solveM", |m, d| {
            // SAFETY: both vectors have n × nv elements, and the factor was computed for this
            // model.
            unsafe { guard::mj_solve_m(m, d, result.as_mut_ptr(), vector.as_ptr(), n) }
        })
    }

    /// Computes `result = M^½ vector` with the square root of the factorisation, `D^½ L`, so that
    /// the squared length of the result is `vectorᵀ M vector`. Both have length nv. (The function
    /// of 2.2.2 is not used: it does not scale the off-diagonal elements of `L`, so its matrix is
    /// not a square root.)
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong length.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let vector = vec![1.0; data.model().nv()];
    /// let (mut root, mut product) = (vec![0.0; vector.len()], vec![0.0; vector.len()]);
    /// data.mul_m2_into(&vector, &mut root)?;
    /// data.mul_m_into(&vector, &mut product)?;
    /// let squared: f64 = root.iter().map(|value| value * value).sum();
    /// assert!((squared - product.iter().sum::<f64>()).abs() < 1e-9 * squared);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_mulM2")]
    pub fn mul_m2_into(&self, vector: &[f64], result: &mut [f64]) -> Result<()> {
        self.check_computed("mul_m2_into", Stage::Position)?;
        let nv = self.model().nv();
        Error::check_length("the result of mul_m2_into", result.len(), nv)?;
        Error::check_length("the vector of mul_m2_into", vector.len(), nv)?;
        let model = self.model();
        for (dof, result) in result.iter_mut().enumerate() {
            let mut sum = vector[dof];
            // L has ones on its diagonal, and off-diagonal elements for the ancestors of a degree
            // of freedom.
            if let Some(row) = self.factor_row(dof) {
                row.iter().for_each(|(ancestor, value)| sum += value * vector[ancestor]);
                *result = sum / self.qLDiagInv()[dof].sqrt();
                continue;
            }
            let mut address = model.dof_Madr()[dof] as usize;
            let mut ancestor = model.dof_parentid()[dof];
            while model.dof_simplenum()[dof] == 0 && ancestor >= 0 {
                address += 1;
                sum += self.qLD()[address] * vector[ancestor as usize];
                ancestor = model.dof_parentid()[ancestor as usize];
            }
            *result = sum / self.qLDiagInv()[dof].sqrt();
        }
        Ok(())
    }

    /// Computes `result = D^-½ L⁻ᵀ vector`, the first half of a solve, so that the squared length
    /// of the result is `vectorᵀ M⁻¹ vector`. Both have length nv, or n·nv for n concatenated
    /// vectors.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] unless both lengths
    /// are the same multiple of nv.
    #[doc(alias = "mj_solveM2")]
    pub fn solve_m2_into(&mut self, vector: &[f64], result: &mut [f64]) -> Result<()> {
        self.check_computed("solve_m2_into", Stage::Position)?;
        let names = ["the vector of solve_m2_into", "the result of solve_m2_into"];
        let n = self.vector_count("solve_m2", names, vector.len(), result.len())?;
        self.call_mut("mj_solveM2", |m, d| {
            // SAFETY: as in `solve_m_into`.
            unsafe { guard::mj_solve_m2(m, d, result.as_mut_ptr(), vector.as_ptr(), n) }
        })
    }

    /// Checks that `vector` and `result` are the same multiple n of nv, and returns n.
    fn vector_count(&self, call: &str, names: [&'static str; 2], vector: usize, result: usize) -> Result<i32> {
        let nv = self.model().nv();
        let n = vector.checked_div(nv).unwrap_or(0);
        Error::check_length(names[0], vector, n.max(1) * nv)?;
        Error::check_length(names[1], result, vector)?;
        // The engine counts all elements with a C int.
        i32::try_from(vector)
            .map(|_| n as i32)
            .map_err(|_| Error::Unsupported(format!("{call} of {n} vectors of length {nv} at once")))
    }

    /// Computes inverse dynamics without constraints and passive forces, by the recursive
    /// Newton–Euler algorithm (Featherstone, Rigid Body Dynamics Algorithms, chapter 5):
    /// `result = M qacc + bias` of length nv, without the armature. With [`Accelerations::Zero`]
    /// the result is the bias forces.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before velocities were computed, [`Error::Shape`] for a wrong length,
    /// [`Error::Engine`] if the engine's stack is too small.
    ///
    /// ```
    /// use mujoco_safe::data::Accelerations;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut bias = vec![0.0; data.model().nv()];
    /// data.rne_into(Accelerations::Zero, &mut bias)?;
    /// assert_eq!(bias, data.qfrc_bias());
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_rne")]
    pub fn rne_into(&mut self, accelerations: Accelerations, result: &mut [f64]) -> Result<()> {
        self.check_computed("rne_into", Stage::Velocity)?;
        Error::check_length("the result of rne_into", result.len(), self.model().nv())?;
        self.call_mut("mj_rne", |m, d| {
            // SAFETY: the result has nv elements.
            unsafe { guard::mj_rne(m, d, (accelerations == Accelerations::Present).into(), result.as_mut_ptr()) }
        })
    }

    /// Adds the inertia matrix to a matrix of the shape `(nv, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut sum = data.full_m()?;
    /// data.add_m(&mut sum)?;
    /// assert_eq!(sum[(0, 0)], 2.0 * data.full_m()?[(0, 0)]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_addM")]
    pub fn add_m(&mut self, sum: &mut Matrix) -> Result<()> {
        self.check_computed("add_m", Stage::Position)?;
        let nv = self.model().nv();
        Error::check_shape("the sum of add_m", sum.shape(), (nv, nv))?;
        let null = ptr::null_mut;
        self.call_mut("mj_addM", |m, d| {
            // SAFETY: without index arrays the engine treats the sum as a full matrix, and it has
            // nv × nv elements.
            unsafe { guard::mj_add_m(m, d, sum.as_mut_ptr(), null(), null(), null()) }
        })
    }

    /// Adds the inertia matrix to a sparse matrix of nv rows. Row `r` has `rownnz[r]` elements,
    /// which start at `values[rowadr[r]]`; their column indices, in ascending order, start at
    /// `colind[rowadr[r]]`. The call adds to existing elements, inserts missing columns, and
    /// updates `rownnz`. Each row needs enough space for the insertions before the start of the
    /// next row.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] unless `rownnz` and
    /// `rowadr` have length nv and `colind` has the length of `values`, [`Error::Invalid`] for an
    /// invalid row or one with too little space, [`Error::Engine`] if the engine's stack is too
    /// small.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// // Empty rows with space for nv elements each.
    /// let nv = data.model().nv();
    /// let mut rownnz = vec![0; nv];
    /// let rowadr: Vec<i32> = (0..nv).map(|row| (row * nv) as i32).collect();
    /// let (mut values, mut colind) = (vec![0.0; nv * nv], vec![0; nv * nv]);
    /// data.add_m_sparse(&mut values, &mut rownnz, &rowadr, &mut colind)?;
    /// let nonzeros: i32 = rownnz.iter().sum();
    /// assert_eq!(nonzeros as usize, 2 * data.model().nM() - nv);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_addM")]
    pub fn add_m_sparse(
        &mut self,
        values: &mut [f64],
        rownnz: &mut [i32],
        rowadr: &[i32],
        colind: &mut [i32],
    ) -> Result<()> {
        self.check_computed("add_m_sparse", Stage::Position)?;
        let nv = self.model().nv();
        Error::check_length("rownnz of add_m_sparse", rownnz.len(), nv)?;
        Error::check_length("rowadr of add_m_sparse", rowadr.len(), nv)?;
        Error::check_length("colind of add_m_sparse", colind.len(), values.len())?;
        for row in 0..nv {
            let end = rowadr.get(row + 1).map_or(values.len(), |&next| usize::try_from(next).unwrap_or(0));
            self.check_sparse_row(row, rownnz[row], rowadr[row], end.min(values.len()), colind)?;
        }
        let (values, rownnz, colind) = (values.as_mut_ptr(), rownnz.as_mut_ptr(), colind.as_mut_ptr());
        let rowadr = rowadr.as_ptr().cast_mut();
        self.call_mut("mj_addM", |m, d| {
            // SAFETY: `check_sparse_row` has checked that the rows are in order and within the
            // arrays, that the columns are ascending and below nv, and that each row has space for
            // the insertions. The engine only reads the addresses.
            unsafe { guard::mj_add_m(m, d, values, rownnz, rowadr, colind) }
        })
    }

    /// Returns an error for a row with which the engine would access memory outside of the arrays.
    fn check_sparse_row(&self, row: usize, nnz: i32, adr: i32, end: usize, colind: &[i32]) -> Result<()> {
        let model = self.model();
        let invalid = |value: String, expected: String| {
            Err(Error::out_of_range(format!("row {row} of add_m_sparse"), value, expected))
        };
        let (Ok(count), Ok(start)) = (usize::try_from(nnz), usize::try_from(adr)) else {
            return invalid(format!("{nnz} elements from {adr} on"), "within the arrays".to_owned());
        };
        let Some(columns) =
            start.checked_add(count).filter(|&last| last <= end).and_then(|last| colind.get(start..last))
        else {
            return invalid(
                format!("{count} elements from {start} on"),
                format!("before the next row, which starts at {end}"),
            );
        };
        let ascending = columns.windows(2).all(|pair| pair[0] < pair[1]);
        let within = columns.iter().all(|&column| usize::try_from(column).is_ok_and(|column| column < model.nv()));
        if !(ascending && within) {
            return invalid(format!("the columns {columns:?}"), format!("ascending, from 0 to {}", model.nv() - 1));
        }
        let in_m = |column: usize| self.is_in_m(row.max(column), row.min(column));
        let missing =
            (0..model.nv()).filter(|&column| in_m(column) && columns.binary_search(&(column as i32)).is_err()).count();
        if model.dof_simplenum()[row] > 0 && count > 0 && missing > 0 {
            return invalid("without its diagonal".to_owned(), "empty, or with its diagonal".to_owned());
        }
        if start + count + missing > end {
            return invalid(format!("{} elements long", end - start), format!("at least {}", count + missing));
        }
        Ok(())
    }

    /// Returns `true` if the inertia matrix stores an element for two degrees of freedom, of which
    /// `later` has the larger index.
    fn is_in_m(&self, later: usize, earlier: usize) -> bool {
        let model = self.model();
        if model.dof_simplenum()[later] > 0 {
            return later == earlier;
        }
        let chain = std::iter::successors(Some(later), |&dof| usize::try_from(model.dof_parentid()[dof]).ok());
        chain.take_while(|&dof| dof >= earlier).any(|dof| dof == earlier)
    }
}
