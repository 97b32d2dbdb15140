//! Control splines: controls over time between equidistant knots.

/// Interpolation of the controls between two knots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Interpolation {
    /// The value of the earlier knot.
    Zero,
    /// A straight line.
    #[default]
    Linear,
    /// Cubic Hermite polynomial whose slope at a knot is the slope of the line through its two
    /// neighbours (Catmull and Rom, *A class of local interpolating splines*, 1974), and zero at
    /// the first and the last knot. It can exceed the values of the knots.
    Cubic,
}

/// Position of the plan on the grid of the knots. The grid is fixed in time, so a knot keeps its
/// time from one plan to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    interpolation: Interpolation,
    /// Number of steps between two knots.
    spacing: usize,
    /// Number of steps from the first knot to the start of the plan, less than the spacing.
    phase: usize,
}

impl Grid {
    /// Creates a grid with `knots` knots in `horizon` steps.
    pub(super) fn new(interpolation: Interpolation, horizon: usize, knots: usize) -> Self {
        let intervals = match interpolation {
            Interpolation::Zero => knots,
            Interpolation::Linear | Interpolation::Cubic => knots.saturating_sub(1),
        };
        Self { interpolation, spacing: horizon.div_ceil(intervals.max(1)), phase: 0 }
    }

    /// Returns the number of knots that a plan reads, at any phase.
    pub(super) fn rows(&self, horizon: usize) -> usize {
        (horizon + self.spacing).div_ceil(self.spacing) + 1
    }

    /// Starts the plan at the first knot.
    pub(super) fn restart(&mut self) {
        self.phase = 0;
    }

    /// Moves the start of the plan forward by some steps. Removes the knots `(rows, nu)` that end
    /// before it, and repeats the last one.
    pub(super) fn shift(&mut self, steps: usize, knots: &mut [f64], nu: usize) {
        let rows = knots.len() / nu.max(1);
        // After that number of steps, all knots are equal to the last one.
        let phase = self.phase + steps.min(rows * self.spacing);
        self.phase = phase % self.spacing;
        let removed = (phase / self.spacing).min(rows.saturating_sub(1));
        knots.copy_within(removed * nu.., 0);
        for row in rows - removed..rows {
            knots.copy_within((rows - removed - 1) * nu..(rows - removed) * nu, row * nu);
        }
    }

    /// Adds the value of the spline in a step of the plan to the controls `(nu)`.
    pub(super) fn add(&self, step: usize, knots: &[f64], ctrl: &mut [f64]) {
        let nu = ctrl.len();
        let last = (knots.len() / nu.max(1)).saturating_sub(1);
        let position = self.phase + step;
        let row = (position / self.spacing).min(last);
        let fraction = (position % self.spacing) as f64 / self.spacing as f64;
        let rows = [row.saturating_sub(1), row, (row + 1).min(last), (row + 2).min(last)];
        for (index, ctrl) in ctrl.iter_mut().enumerate() {
            let [before, from, to, after] = rows.map(|row| knots[row * nu + index]);
            *ctrl += match self.interpolation {
                Interpolation::Zero => from,
                Interpolation::Linear => from + fraction * (to - from),
                Interpolation::Cubic => {
                    let slope = |is_end: bool, difference: f64| if is_end { 0.0 } else { 0.5 * difference };
                    let slopes = [slope(row == 0, to - before), slope(row + 1 >= last, after - from)];
                    hermite([from, to], slopes, fraction)
                }
            };
        }
    }
}

/// Returns the cubic polynomial with these values and slopes at 0 and 1.
fn hermite(values: [f64; 2], slopes: [f64; 2], at: f64) -> f64 {
    let (square, rest) = (at * at, 1.0 - at);
    let ease = square * (3.0 - 2.0 * at);
    values[0] + ease * (values[1] - values[0]) + slopes[0] * at * rest * rest - slopes[1] * square * rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the values of a spline in `steps` steps.
    fn values(grid: &Grid, knots: &[f64], steps: usize) -> Vec<f64> {
        let value = |step| {
            let mut ctrl = [0.0];
            grid.add(step, knots, &mut ctrl);
            ctrl[0]
        };
        (0..steps).map(value).collect()
    }

    #[test]
    fn splines_pass_through_their_knots() {
        for interpolation in [Interpolation::Zero, Interpolation::Linear, Interpolation::Cubic] {
            let grid = Grid::new(interpolation, 12, if interpolation == Interpolation::Zero { 3 } else { 4 });
            assert_eq!(grid.spacing, 4);
            let knots = [1.0, -2.0, 0.5, 3.0, 3.0];
            let values = values(&grid, &knots, 16);
            assert_eq!([values[0], values[4], values[8], values[12]], knots[..4], "{interpolation:?}");
        }
    }

    #[test]
    fn linear_splines_are_exact_for_lines_and_inner_cubic_segments_for_parabolas() {
        let line: Vec<f64> = (0..6).map(|knot| 2.0 - 0.5 * f64::from(knot)).collect();
        let grid = Grid::new(Interpolation::Linear, 20, 5);
        for (step, value) in values(&grid, &line, 20).into_iter().enumerate() {
            assert!((value - (2.0 - 0.1 * step as f64)).abs() < 1e-12, "step {step}: {value}");
        }
        let parabola: Vec<f64> = (0..6).map(|knot| f64::from(knot).powi(2)).collect();
        let grid = Grid::new(Interpolation::Cubic, 20, 5);
        for (step, value) in values(&grid, &parabola, 20).into_iter().enumerate().skip(5).take(15) {
            assert!((value - (step as f64 / 5.0).powi(2)).abs() < 1e-12, "step {step}: {value}");
        }
    }

    #[test]
    fn a_shifted_spline_has_the_values_of_the_remaining_steps() {
        for interpolation in [Interpolation::Zero, Interpolation::Linear] {
            let mut grid = Grid::new(interpolation, 12, 4);
            let mut knots: Vec<f64> = (0..grid.rows(12)).map(|knot| f64::from(knot as u32 * 7 % 5)).collect();
            let expected = values(&grid, &knots, 12);
            for shift in [1, 2, 4] {
                let before = values(&grid, &knots, 12);
                grid.shift(shift, &mut knots, 1);
                assert_eq!(values(&grid, &knots, 12 - shift), before[shift..], "{interpolation:?}");
            }
            assert_eq!(values(&grid, &knots, 5), expected[7..]);
            grid.shift(usize::MAX, &mut knots, 1);
            assert!(values(&grid, &knots, 12).windows(2).all(|pair| pair[0] == pair[1]));
        }
    }
}
