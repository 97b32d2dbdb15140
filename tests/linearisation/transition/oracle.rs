//! The linear system of a step computed from `mj_step` alone: central differences with Richardson
//! extrapolation, and a solver that iterates to convergence.

use mujoco_safe::{Data, StateSpace, StateSpec, sys};

/// Default of the largest step of the differences. Two halvings leave an error of its sixth power.
const WIDTH: f64 = 2e-5;

/// Differences of the engine's `mj_step` about the present state of a simulation.
pub(crate) struct Oracle {
    data: Data,
    inputs: Vec<f64>,
    width: f64,
}

impl Oracle {
    pub(crate) fn new(data: &Data) -> Self {
        let mut data = data.clone();
        data.edit_model(|model| {
            model.edit_options(|options| {
                options.tolerance = 0.0;
                options.iterations = options.iterations.max(200);
            })
        })
        .unwrap();
        Self { inputs: data.state(StateSpec::INTEGRATION), data, width: WIDTH }
    }

    /// Returns next state and sensors after a step from a perturbed state.
    fn step(&mut self, perturb: &dyn Fn(&mut Data, f64), by: f64) -> (Vec<f64>, Vec<f64>) {
        self.data.set_state(StateSpec::INTEGRATION, &self.inputs).unwrap();
        perturb(&mut self.data, by);
        // SAFETY: the data belongs to its model.
        unsafe { sys::mj_step(self.data.model().as_ptr(), self.data.as_mut_ptr()) };
        (self.data.physics_state(), self.data.sensordata().to_vec())
    }

    fn central(&mut self, perturb: &dyn Fn(&mut Data, f64), width: f64) -> Vec<f64> {
        let right = self.step(perturb, width);
        let left = self.step(perturb, -width);
        self.quotient(&left, &right, 2.0 * width)
    }

    fn quotient(
        &self,
        (left, left_sensors): &(Vec<f64>, Vec<f64>),
        (right, right_sensors): &(Vec<f64>, Vec<f64>),
        width: f64,
    ) -> Vec<f64> {
        let model = self.data.model();
        let (nq, nv) = (model.nq(), model.nv());
        let mut column = vec![0.0; nv];
        model.differentiate_pos_into(width, &left[..nq], &right[..nq], &mut column).unwrap();
        let rest = right[nq..].iter().zip(&left[nq..]).chain(right_sensors.iter().zip(left_sensors));
        column.extend(rest.map(|(right, left)| (right - left) / width));
        column
    }

    /// Returns a column by differences to the right (`side` 1) or to the left (-1), with the
    /// estimated errors: of several steps, the one with the least error for each entry. `base` is
    /// [`step`](Self::step) without a perturbation.
    pub(crate) fn one_sided(&mut self, index: usize, side: f64, base: &(Vec<f64>, Vec<f64>)) -> Vec<(f64, f64)> {
        let perturb = self.perturbation(index);
        let quotients = |oracle: &mut Self, width: f64| {
            let sample = oracle.step(&perturb, side * width);
            oracle.quotient(base, &sample, side * width)
        };
        let mut best = Vec::new();
        for width in [1e-3, 1e-4, 1e-5, 1e-6] {
            let [coarse, middle, fine] = [1.0, 0.5, 0.25].map(|part| quotients(self, part * width));
            let estimates = (0..coarse.len()).map(|i| {
                let (first, second) = (2.0 * middle[i] - coarse[i], 2.0 * fine[i] - middle[i]);
                (second, (second - first).abs())
            });
            if best.is_empty() {
                best = estimates.collect();
            } else {
                let better = |(best, new): (&mut (f64, f64), (f64, f64))| {
                    if new.1 < best.1 {
                        *best = new;
                    }
                };
                best.iter_mut().zip(estimates).for_each(better);
            }
        }
        best
    }

    /// Returns the state and the sensors after a step.
    pub(crate) fn base(&mut self) -> (Vec<f64>, Vec<f64>) {
        self.step(&|_, _| (), 0.0)
    }

    fn extrapolate(&mut self, perturb: &dyn Fn(&mut Data, f64)) -> Vec<f64> {
        let [coarse, middle, fine] = [1.0, 0.5, 0.25].map(|part| self.central(perturb, part * self.width));
        (0..coarse.len())
            .map(|i| {
                let (first, second) = ((4.0 * middle[i] - coarse[i]) / 3.0, (4.0 * fine[i] - middle[i]) / 3.0);
                (16.0 * second - first) / 15.0
            })
            .collect()
    }

    /// Returns a column of the linear system, `[next state; sensors]`, by differences whose largest
    /// step is `width`. The columns are those of A and C, and then those of B and D.
    pub(crate) fn column(&mut self, index: usize, width: f64) -> Vec<f64> {
        let perturb = self.perturbation(index);
        self.width = width;
        self.extrapolate(&perturb)
    }

    /// Returns a column by central differences with one step, without extrapolation.
    pub(crate) fn central_column(&mut self, index: usize, width: f64) -> Vec<f64> {
        let perturb = self.perturbation(index);
        self.central(&perturb, width)
    }

    /// Returns the function that adds a number to the input of a column.
    fn perturbation(&self, index: usize) -> impl Fn(&mut Data, f64) + use<> {
        let model = self.data.model().clone();
        let (nv, na, nx) = (model.nv(), model.na(), 2 * model.nv() + model.na());
        move |data: &mut Data, by: f64| {
            if index < nv {
                let mut direction = vec![0.0; nv];
                direction[index] = 1.0;
                model.integrate_pos(data.qpos_mut(), &direction, by).unwrap();
            } else if index < 2 * nv {
                data.qvel_mut()[index - nv] += by;
            } else if index < 2 * nv + na {
                data.act_mut()[index - 2 * nv] += by;
            } else {
                data.ctrl_mut()[index - nx] += by;
            }
        }
    }
}

pub(crate) fn linear_system(data: &Data) -> StateSpace {
    linear_system_by(data, WIDTH, WIDTH)
}

/// Returns the linear system by differences whose largest step is `width`, and `control_width` for
/// controls.
pub(crate) fn linear_system_by(data: &Data, width: f64, control_width: f64) -> StateSpace {
    let mut oracle = Oracle::new(data);
    let mut system = StateSpace::zeros(data.model());
    let nx = system.a.ncols();
    for index in 0..nx + system.b.ncols() {
        let (a, c, column, width) = if index < nx {
            (&mut system.a, &mut system.c, index, width)
        } else {
            (&mut system.b, &mut system.d, index - nx, control_width)
        };
        for (row, value) in oracle.column(index, width).into_iter().enumerate() {
            let (output, row) = if row < nx { (&mut *a, row) } else { (&mut *c, row - nx) };
            output[(row, column)] = value;
        }
    }
    system
}
