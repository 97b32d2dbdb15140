//! Parameters of the model for each simulation of a batch.

use super::Batch;
use crate::error::Result;
use crate::matrix::{Matrix, MatrixView};
use crate::rollout::Parameters;

/// # Parameters of the model for each simulation
impl Batch<'_> {
    /// Gives each simulation its own values of these parameters, at first the model's. Replaces
    /// earlier parameters, whose values remain in the simulations.
    ///
    /// A simulation with other values keeps them and the quantities derived from them, a few
    /// kilobytes for a humanoid, instead of a copy of the model. Each thread has one copy, into
    /// which it writes the values of a simulation before a step. This adds about 4 % to the time of
    /// a humanoid's step (`cargo bench --bench batch`).
    ///
    /// [`set_parameters`](Self::set_parameters) and [`sample_parameters`](Self::sample_parameters)
    /// change the values. [`Parameters`] has an example.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) if the model does not have a parameter.
    ///
    /// # Panics
    ///
    /// If the parameters belong to another model, or memory does not suffice for the values.
    pub fn with_parameters(mut self, parameters: Parameters) -> Result<Self> {
        parameters.check_model(self.model())?;
        let nominal = parameters.nominal(self.model());
        let mut values = Matrix::zeros(self.len(), parameters.len());
        for row in 0..self.len() {
            values.row_mut(row).copy_from_slice(&nominal);
        }
        (self.common.parameters, self.values) = (parameters, values);
        Ok(self)
    }

    /// Returns the values of the parameters `(n, nparameter)`, in the order of
    /// [`Parameters::names`].
    pub fn parameters(&self) -> MatrixView<'_> {
        self.values.view()
    }

    /// Calls `set` to change the values `(nparameter)` of the simulations whose index satisfies
    /// `which`, and observes those that change. The state of a simulation does not change, even if
    /// it has failed.
    ///
    /// A change of a [`MassFactor`](crate::rollout::Parameter::MassFactor), or of another parameter
    /// that is documented to update the derived constants, costs a call of
    /// [`update_constants`](crate::ModelMut::update_constants) for each simulation: as long as ten
    /// to twenty steps of a humanoid. The cost arises once per change, not in every step.
    ///
    /// Values that do not change are not written. Edits of a simulation's model by
    /// [`Data::edit_model`](crate::Data::edit_model) remain, unless they concern the same values.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) with the parameter, the simulation, the value and
    /// the valid values. In that case no simulation has changed. An error of
    /// [`update_constants`](crate::ModelMut::update_constants) with the smallest index; the
    /// simulations with such an error keep their values.
    ///
    /// # Panics
    ///
    /// If a closure panics.
    ///
    /// ```
    /// use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
    /// use mujoco_safe::sample;
    ///
    /// // Let cart-poles fall on planets of different gravity.
    /// let model = sample::cartpole();
    /// let parameters = Parameters::new().with(&model, Parameter::Gravity(2), Distribution::Unchanged)?;
    /// let mut batch = Batch::new(model, 3)?.with_parameters(parameters)?;
    /// assert_eq!(batch.parameters()[(0, 0)], -9.81);
    /// batch.set_parameters(|_| true, |index, values| values[0] = [-1.62, -3.72, -9.81][index])?; // Moon, Mars, Earth
    /// batch.reset_where(|_| true, |_, _, data| data.qpos_mut()[1] = 0.2)?;
    /// for _ in 0..30 {
    ///     batch.step(|_, _| ())?;
    /// }
    /// let angles = batch.observations();
    /// assert!(angles[(0, 1)] < angles[(1, 1)] && angles[(1, 1)] < angles[(2, 1)]);
    ///
    /// let error = batch.set_parameters(|index| index == 1, |_, values| values[0] = f64::NAN).unwrap_err();
    /// assert_eq!(error.to_string(), "the gravity[2] of simulation 1 is NaN, but must be finite");
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn set_parameters(
        &mut self,
        which: impl Fn(usize) -> bool,
        mut set: impl FnMut(usize, &mut [f64]),
    ) -> Result<()> {
        let mut values = self.values.clone();
        for index in (0..self.len()).filter(|&index| which(index)) {
            set(index, values.row_mut(index));
            self.common.parameters.check(index, values.row(index))?;
        }
        self.try_each(|index, member| member.set_parameters(values.row(index)))
    }

    /// Draws the values of the simulations whose index satisfies `which` from their distributions,
    /// as [`set_parameters`](Self::set_parameters) sets them.
    ///
    /// A value is determined by the seed, the index of the simulation (plus the
    /// [`with_first_index`](Self::with_first_index)), the number of its [`episode`](Self::episode)
    /// and the position of the parameter in the list. For other values in each episode, draw before
    /// or after each reset:
    ///
    /// ```
    /// # use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
    /// # use mujoco_safe::sample;
    /// # let model = sample::cartpole();
    /// # let gravity = Distribution::Normal { mean: -9.81, deviation: 0.1 };
    /// # let parameters = Parameters::new().with(&model, Parameter::Gravity(2), gravity)?;
    /// # let mut batch = Batch::new(model, 3)?.with_parameters(parameters)?;
    /// # let ended = [true, false, true];
    /// batch.reset_where(|index| ended[index], |_, _, data| data.qpos_mut()[1] = 0.1)?;
    /// batch.sample_parameters(|index| ended[index], 42)?;
    /// # assert_eq!(batch.parameters()[(1, 0)], -9.81);
    /// # assert!(batch.parameters()[(0, 0)] != -9.81 && (batch.parameters()[(0, 0)] + 9.81).abs() <= 0.3);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// An error of [`update_constants`](crate::ModelMut::update_constants), as for
    /// [`set_parameters`](Self::set_parameters).
    pub fn sample_parameters(&mut self, which: impl Fn(usize) -> bool, seed: u64) -> Result<()> {
        let parameters = self.common.parameters.clone();
        let numbers: Vec<_> = (0..self.len()).map(|index| (self.random_index(index), self.episode(index))).collect();
        self.set_parameters(which, |index, values| {
            let (index, episode) = numbers[index];
            parameters.draw(seed, index, episode, values);
        })
    }

    /// Sets the index that [`sample_parameters`](Self::sample_parameters) uses for the first
    /// simulation; zero by default. If a process has only the simulations from `index` on of a
    /// larger batch, it draws the values that one process with all of them would draw.
    ///
    /// All other indices, such as those that closures receive, still start at zero.
    ///
    /// ```
    /// use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
    /// use mujoco_safe::sample;
    ///
    /// let model = std::sync::Arc::new(sample::cartpole());
    /// let gravity = Distribution::Normal { mean: -9.81, deviation: 0.1 };
    /// let parameters = Parameters::new().with(&model, Parameter::Gravity(2), gravity)?;
    /// let mut all = Batch::new(&model, 8)?.with_parameters(parameters.clone())?;
    /// let mut half = Batch::new(&model, 4)?.with_parameters(parameters)?.with_first_index(4);
    /// all.sample_parameters(|_| true, 42)?;
    /// half.sample_parameters(|_| true, 42)?;
    /// assert_eq!(half.parameters().row(0), all.parameters().row(4));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[must_use]
    pub fn with_first_index(mut self, index: usize) -> Self {
        self.first_index = index;
        self
    }

    /// Returns the index of a simulation for random numbers.
    pub(crate) fn random_index(&self, index: usize) -> usize {
        self.first_index.wrapping_add(index)
    }
}
