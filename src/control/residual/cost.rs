//! Sums of terms, as costs of trajectories.

use super::Term;
use super::evaluator::{Evaluators, Point};
use crate::control::ilqr::{CostExpansion, TrajectoryCost};
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::model::IntoModel;

/// Cost of a trajectory as a sum of weighted norms of residuals; see the
/// [module](crate::control::residual).
///
/// Residuals are evaluated in simulations of this cost, one for each thread, created on demand.
/// Time, mocap poses, applied forces and user data are those at the last
/// [`begin`](TrajectoryCost::begin), which [`Ilqr::solve`](crate::control::ilqr::Ilqr::solve)
/// calls; before the first one, those after a reset. After the first evaluation in each thread,
/// values and expansions do not allocate.
///
/// ```
/// use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions};
/// use mujoco_safe::control::residual::{Controls, FramePosition, JointVelocity, ResidualCost, Term};
/// use mujoco_safe::{Data, Matrix, Model};
///
/// // An arm in the plane reaches for a point.
/// let mut data = Data::new(Model::from_xml_str(
///     r#"<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="shoulder" axis="0 0 1" damping="0.1"/><geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/>
///          <body pos="0.3 0 0"><joint name="elbow" axis="0 0 1" damping="0.1"/><geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/>
///            <site name="hand" pos="0.3 0 0"/></body></body></worldbody>
///        <actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator></mujoco>"#,
/// )?)?;
/// let model = data.model().clone();
/// let mut cost = ResidualCost::new(
///     &model,
///     [
///         Term::new("reach", FramePosition::site(&model, "hand")?.with_target([0.3, 0.3, 0.0])).with_terminal_weight(1e3),
///         Term::new("rest", JointVelocity::all(&model)).with_weight(1e-3).with_terminal_weight(1.0),
///         Term::new("effort", Controls::new(&model)).with_weight(1e-2),
///     ],
/// )?;
/// let mut solver = Ilqr::new(&model, IlqrOptions::default())?;
/// let plan = solver.solve(&data, &Matrix::from_row_major(200, 2, vec![0.01; 400]), &cost)?;
/// data.set_physics_state(plan.states.row(200))?;
/// data.forward()?;
/// assert!((data.site("hand")?.xpos()[1] - 0.3).abs() < 0.01);
///
/// // Weights and targets can change between searches.
/// cost.term_mut("reach")?.set_target(&[0.3, -0.3, 0.0])?;
/// cost.term_mut("effort")?.weight = 1e-3;
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Debug)]
pub struct ResidualCost {
    terms: Vec<Term>,
    evaluators: Evaluators,
}

impl ResidualCost {
    /// Creates a cost from its terms. Takes a [`Model`](crate::Model), an `Arc<Model>` or an
    /// `&Arc<Model>`.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for two terms of the same name, or for a norm whose width is not above
    /// zero, [`Error::Shape`] unless there is one scale for each component, [`Error::Engine`] or
    /// [`Error::OutOfMemory`] if the engine cannot allocate a simulation.
    pub fn new(model: impl IntoModel, terms: impl IntoIterator<Item = Term>) -> Result<Self> {
        let terms: Vec<Term> = terms.into_iter().collect();
        for (index, term) in terms.iter().enumerate() {
            term.check()?;
            if terms[..index].iter().any(|earlier| earlier.name() == term.name()) {
                return Err(Error::invalid(
                    InvalidKind::Duplicate,
                    "the name of a term",
                    term.name(),
                    "different from those of the other terms",
                ));
            }
        }
        let size = terms.iter().map(Term::size).max().unwrap_or(0);
        Ok(Self { terms, evaluators: Evaluators::new(Data::new(model)?, size) })
    }

    /// Returns the terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Returns the terms, to change weights, norms and targets.
    pub fn terms_mut(&mut self) -> &mut [Term] {
        &mut self.terms
    }

    /// Returns the term of a name, to change its weight, norm or target.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for an unknown name. The error lists the names.
    pub fn term_mut(&mut self, name: &str) -> Result<&mut Term> {
        if let Some(index) = self.terms.iter().position(|term| term.name() == name) {
            return Ok(&mut self.terms[index]);
        }
        let names: Vec<&str> = self.terms.iter().map(Term::name).collect();
        Err(Error::invalid(InvalidKind::Unknown, "the name of a term", name, format!("one of {}", names.join(", "))))
    }

    /// Writes the cost of each term in a step, or at the end without controls, to a slice with one
    /// entry for each term. Their sum is [`value`](TrajectoryCost::value).
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, the errors of the residuals, and of [`Data::forward`]
    /// if a residual needs it.
    pub fn values_into(&self, step: usize, state: &[f64], controls: Option<&[f64]>, values: &mut [f64]) -> Result<()> {
        Error::check_length("the values of the terms", values.len(), self.terms.len())?;
        values.fill(0.0);
        self.evaluators.value(&self.terms, Point { step, state, controls }, Some(values)).map(drop)
    }
}

impl TrajectoryCost for ResidualCost {
    fn begin(&self, data: &Data) -> Result<()> {
        self.evaluators.begin(data)
    }

    fn value(&self, step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        self.evaluators.value(&self.terms, Point { step, state, controls }, None)
    }

    fn expand(
        &self,
        step: usize,
        state: &[f64],
        controls: Option<&[f64]>,
        expansion: &mut CostExpansion,
    ) -> Result<()> {
        self.evaluators.expand(&self.terms, Point { step, state, controls }, expansion)
    }
}
