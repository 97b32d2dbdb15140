//! Predictive controller whose plan is shown in the viewer: the path of points over the horizon,
//! the cost of each term, and sliders for the weights.

use mujoco_safe::control::predictive::{IlqrPlanner, PredictiveController};
use mujoco_safe::control::residual::ResidualCost;
#[cfg(feature = "viewer")]
use mujoco_safe::viewer::Instruments;
use mujoco_safe::{Controller, Data, Result};

/// Radius of the path of a point, m.
const RADIUS: f64 = 0.01;
/// Largest change of a weight, as a factor.
const FACTOR: f64 = 100.0;

/// Function that reads the position of a point, m, world frame.
type Position = Box<dyn Fn(&Data) -> [f64; 3] + Send>;

/// Point of the model whose path is drawn.
pub struct Point {
    pub position: Position,
    pub rgba: [f32; 4],
}

/// Term of the cost.
struct ShownTerm {
    name: String,
    /// Initial weights: in a step, and at the end.
    initial: [f64; 2],
    /// Cost of the plan.
    cost: f64,
}

/// Predictive controller that shows its plan. The simulation waits for the planner, so on a slow
/// machine it is slower than real time.
pub struct LivePlan {
    controller: PredictiveController<IlqrPlanner, ResidualCost>,
    before_step: fn(&mut Data),
    points: Vec<Point>,
    /// Path of each point.
    paths: Vec<Vec<[f64; 3]>>,
    terms: Vec<ShownTerm>,
    /// Cost of each term in a step.
    costs: Vec<f64>,
    /// Simulation that takes the states of the plan.
    data: Data,
    /// Start of the plan that is shown, s. NaN before the first.
    start: f64,
}

impl LivePlan {
    /// Adds the display to a controller. The controller calls `before_step` before each step, for
    /// inputs such as the place of a target.
    pub fn new(
        data: &Data,
        controller: PredictiveController<IlqrPlanner, ResidualCost>,
        points: Vec<Point>,
        before_step: fn(&mut Data),
    ) -> Result<Self> {
        let cost = controller.cost();
        let terms = cost.terms().iter().map(|term| ShownTerm {
            name: term.name().to_owned(),
            initial: [term.weight, term.terminal_weight],
            cost: 0.0,
        });
        let terms: Vec<_> = terms.collect();
        Ok(Self {
            controller,
            before_step,
            paths: vec![Vec::new(); points.len()],
            points,
            costs: vec![0.0; terms.len()],
            terms,
            data: Data::new(data.model().clone())?,
            start: f64::NAN,
        })
    }

    /// Computes the paths and the costs of the present plan.
    fn update(&mut self) -> Result<()> {
        let Self { controller, points, paths, terms, costs, data, .. } = self;
        let (policy, cost, model) = (controller.policy(), controller.cost(), data.model().clone());
        paths.iter_mut().for_each(Vec::clear);
        for term in &mut *terms {
            term.cost = 0.0;
        }
        for step in 0..=policy.steps() {
            let state = policy.states().row(step);
            let controls = (step < policy.steps()).then(|| policy.controls().row(step));
            cost.values_into(step, state, controls, costs)?;
            terms.iter_mut().zip(&*costs).for_each(|(term, cost)| term.cost += cost);
            data.qpos_mut().copy_from_slice(&state[..model.nq()]);
            data.kinematics()?;
            data.com_pos()?;
            for (path, point) in paths.iter_mut().zip(&*points) {
                path.push((point.position)(data));
            }
        }
        Ok(())
    }

    /// Shows the plan.
    #[cfg(feature = "viewer")]
    pub fn declare(&mut self, instruments: &mut Instruments) -> Result<()> {
        for (term, shown) in self.controller.cost_mut().terms_mut().iter_mut().zip(&self.terms) {
            let [initial, terminal] = shown.initial;
            let mut weight = term.weight;
            if instruments.parameter(&shown.name, &mut weight, initial / FACTOR..=initial * FACTOR) {
                (term.weight, term.terminal_weight) = (weight, terminal * weight / initial);
            }
        }
        if self.controller.report().is_none() {
            // There is no plan before the first step.
            return Ok(());
        }
        if self.start != self.controller.policy().start() {
            self.start = self.controller.policy().start();
            self.update()?;
        }
        for term in &self.terms {
            instruments.value("log10 of the cost of the plan", &term.name, term.cost.log10());
        }
        for (path, point) in self.paths.iter().zip(&self.points) {
            instruments.path(path.iter().copied(), RADIUS, point.rgba);
        }
        Ok(())
    }
}

impl Controller for LivePlan {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        (self.before_step)(data);
        self.controller.control(data)
    }
}
