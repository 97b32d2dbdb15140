//! Curve of a signal over simulated time.

use std::collections::VecDeque;
use std::ops::Range;

use crate::viewer::signal::{Signal, union};

/// Maximum number of points of a curve.
const MAX_POINTS: usize = 1000;

/// Newest points of a signal over simulated time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub name: String,
    /// Part of the name that differs from the names of the other curves of a plot.
    pub short: Range<usize>,
    /// The user has hidden the curve.
    pub is_hidden: bool,
    /// The name contains the text of the filter.
    pub is_found: bool,
    points: VecDeque<Point>,
}

/// Value at a time, s, and the range since the previous point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    time: f64,
    signal: Signal,
}

/// Range of values in an interval of time, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Band {
    pub times: [f64; 2],
    pub range: [f64; 2],
}

impl Curve {
    pub fn new(name: impl Into<String>) -> Self {
        let name = name.into();
        let short = 0..name.len();
        Self { name, short, is_hidden: false, is_found: true, points: VecDeque::with_capacity(MAX_POINTS) }
    }

    /// Returns the part of the name that differs from the names of the other curves of the plot.
    pub fn short_name(&self) -> &str {
        &self.name[self.short.clone()]
    }

    /// Appends a point, and removes points at or after its time, which decreases after a step back.
    /// NaN leaves a gap.
    pub fn push(&mut self, time: f64, signal: impl Into<Signal>) {
        let mut signal = signal.into();
        while let Some(last) = self.points.back().filter(|last| last.time >= time) {
            // The new values belong to no interval after the previous point: they are from later
            // times, or the user changes them while the simulation is paused.
            signal.range = if last.time > time { Signal::NO_RANGE } else { last.signal.range };
            self.points.pop_back();
        }
        if self.points.len() == MAX_POINTS {
            self.points.pop_front();
        }
        self.points.push_back(Point { time, signal });
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        self.points.clear();
    }

    /// Returns the times, s, and values of the points, from the oldest to the newest.
    pub fn points(&self) -> impl ExactSizeIterator<Item = [f64; 2]> + '_ {
        self.points.iter().map(|point| [point.time, point.signal.value])
    }

    /// Returns the times of the oldest and the newest point, s.
    pub fn times(&self) -> Option<[f64; 2]> {
        Some([self.points.front()?.time, self.points.back()?.time])
    }

    /// Returns the points, in parts that are separated by values that are not finite. Of the points
    /// in a column of this width, s, only the lowest and the highest are left. The columns start at
    /// the time zero, so that old parts of a curve keep their points.
    pub fn parts(&self, column: f64) -> Vec<Vec<[f64; 2]>> {
        let mut parts = vec![Vec::new()];
        let mut extremes: Option<[[f64; 2]; 2]> = None;
        let finish = |part: &mut Vec<[f64; 2]>, extremes: &mut Option<[[f64; 2]; 2]>| {
            let Some([low, high]) = extremes.take() else { return };
            part.push(if low[0] < high[0] { low } else { high });
            if low != high {
                part.push(if low[0] < high[0] { high } else { low });
            }
        };
        for point in self.points() {
            let part = parts.last_mut().expect("Bug: a curve without parts");
            if !point[1].is_finite() {
                finish(part, &mut extremes);
                parts.push(Vec::new());
                continue;
            }
            let index = |point: [f64; 2]| (point[0] / column).floor();
            match &mut extremes {
                Some([low, high]) if index(*low) == index(point) => {
                    if point[1] < low[1] {
                        *low = point;
                    } else if point[1] > high[1] {
                        *high = point;
                    }
                }
                _ => {
                    finish(part, &mut extremes);
                    extremes = Some([point; 2]);
                }
            }
        }
        finish(parts.last_mut().expect("Bug: a curve without parts"), &mut extremes);
        parts.retain(|part| !part.is_empty());
        parts
    }

    /// Returns the ranges between the points that the line through the points does not cover, at
    /// most one for each column of this width, s. They consist of whole columns.
    pub fn bands(&self, column: f64) -> Vec<Band> {
        let mut bands: Vec<Band> = Vec::new();
        for (previous, point) in self.points.iter().zip(self.points.iter().skip(1)) {
            let ends = [previous, point].map(|point| point.signal.value);
            let Some(range) = uncovered(ends, point.signal.range) else { continue };
            let [start, end] = [previous, point].map(|point| (point.time / column).ceil() * column);
            match bands.last_mut().filter(|last| last.times[1] == end) {
                Some(last) => last.range = union(last.range, range),
                None => bands.push(Band { times: [start.min(end - column), end], range }),
            }
        }
        bands
    }
}

/// Returns the part of a range beyond the line between two values, or the whole range if it extends
/// beyond both ends. A signal that has crossed the line more than once is thus a filled area.
fn uncovered(ends: [f64; 2], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let finite = ends.into_iter().filter(|value| value.is_finite());
    let [bottom, top] = finite.fold(Signal::NO_RANGE, |range, value| union(range, [value; 2]));
    match (low < bottom, high > top) {
        (true, true) => Some([low, high]),
        (true, false) => Some([low, bottom]),
        (false, true) => Some([top, high]),
        (false, false) => None,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::{Band, Curve, MAX_POINTS};
    use crate::viewer::signal::Signal;

    /// Returns a signal after these values.
    fn signal(values: impl IntoIterator<Item = f64>) -> Signal {
        let mut signal = Signal::default();
        values.into_iter().for_each(|value| signal.push(value));
        signal
    }

    /// Returns a curve with a point after each ten values of a function of time, whose unit is the
    /// time between two points.
    fn sampled(points: u32, value: impl Fn(f64) -> f64) -> Curve {
        let mut curve = Curve::new("x");
        for point in 1..=points {
            let time = |index: u32| f64::from(10 * (point - 1) + index) / 10.0;
            curve.push(point.into(), signal((1..=10).map(|index| value(time(index)))));
        }
        curve
    }

    #[test]
    fn fast_sine_is_a_band_although_the_last_values_are_constant() {
        let curve = sampled(100, |time| (2.0 * PI * time).sin());
        assert!(curve.points().all(|[_, value]| value.abs() < 1e-12));
        // The highest of ten values in a period.
        let top = (0.4 * PI).sin();
        for column in [1.0, 7.0] {
            let bands = curve.bands(column);
            assert!(bands.windows(2).all(|pair| pair[0].times[1] == pair[1].times[0]), "there is no gap");
            assert!(bands[0].times[0] <= 1.0 && bands.last().unwrap().times[1] >= 100.0);
            for band in bands {
                assert_eq!(band.times[1] - band.times[0], column);
                assert!((band.range[0] + top).abs() < 1e-12 && (band.range[1] - top).abs() < 1e-12, "{band:?}");
            }
        }
    }

    #[test]
    fn slow_signal_is_a_line() {
        assert_eq!(sampled(100, |time| time).bands(1.0), []);
        // A line does not reach the extremes of a sine of 400 points and of a cosine of 4.
        let height = |curve: Curve| curve.bands(1.0).iter().map(|band| band.range[1] - band.range[0]).sum::<f64>();
        assert!(height(sampled(400, |time| (2.0 * PI * (time + 0.5) / 400.0).sin())) < 1e-3);
        assert!(height(sampled(400, |time| (2.0 * PI * (time + 0.5) / 4.0).cos())) > 10.0);
    }

    #[test]
    fn spike_is_in_the_interval_between_two_points() {
        let spike = |time: f64| if (time - 6.5).abs() < 1e-9 { 9.0 } else { 1.0 };
        let curve = sampled(20, spike);
        assert_eq!(curve.bands(0.25), [Band { times: [6.0, 7.0], range: [1.0, 9.0] }]);
        assert_eq!(curve.bands(4.0), [Band { times: [4.0, 8.0], range: [1.0, 9.0] }]);
        assert!(curve.points().all(|[_, value]| value == 1.0));
    }

    #[test]
    fn band_is_beyond_the_line_unless_the_signal_has_crossed_the_line() {
        let mut curve = Curve::new("x");
        curve.push(0.0, signal([1.0]));
        curve.push(1.0, signal([1.0, 3.0, 2.0]));
        curve.push(2.0, signal([-1.0, 0.0]));
        curve.push(3.0, signal([-1.0, 2.0, 1.0]));
        let band = |start: f64, low: f64, high: f64| Band { times: [start, start + 1.0], range: [low, high] };
        assert_eq!(curve.bands(0.5), [band(0.0, 2.0, 3.0), band(1.0, -1.0, 0.0), band(2.0, -1.0, 2.0)]);
        // All are in one column.
        assert_eq!(curve.bands(3.0), [Band { times: [0.0, 3.0], range: [-1.0, 3.0] }]);
    }

    #[test]
    fn values_that_are_not_finite_leave_a_gap_in_the_line_and_are_in_no_band() {
        let mut curve = Curve::new("x");
        let nan = f64::NAN;
        for (time, values) in (0_u32..).zip([[1.0, 1.0], [f64::INFINITY, 1.0], [2.0, nan], [nan, nan], [nan, 1.0]]) {
            curve.push(time.into(), signal(values));
        }
        assert_eq!(curve.parts(0.5), [vec![[0.0, 1.0], [1.0, 1.0]], vec![[4.0, 1.0]]]);
        assert_eq!(curve.bands(0.5), [Band { times: [1.0, 2.0], range: [1.0, 2.0] }]);
    }

    #[test]
    fn changes_of_the_last_point_and_undone_steps_leave_no_band() {
        let mut curve = Curve::new("x");
        curve.push(0.0, signal([0.0]));
        curve.push(1.0, signal([0.0, 5.0, 0.0]));
        // The user moves a joint while the simulation is paused.
        curve.push(1.0, signal([0.0, -9.0, 1.0]));
        let spike = Band { times: [0.0, 1.0], range: [1.0, 5.0] };
        assert_eq!(curve.bands(0.5), [spike]);
        curve.push(2.0, signal([1.0]));
        curve.push(1.5, signal([1.0, 8.0, 1.0]));
        assert_eq!(curve.bands(0.5), [spike]);
        assert_eq!(curve.points().collect::<Vec<_>>(), [[0.0, 0.0], [1.0, 1.0], [1.5, 1.0]]);
    }

    #[test]
    fn curve_keeps_the_newest_points_and_discards_undone_steps() {
        let mut curve = Curve::new("x");
        for index in 0..3 * MAX_POINTS {
            curve.push(index as f64, -(index as f64));
        }
        assert_eq!(curve.points().len(), MAX_POINTS);
        assert_eq!(curve.points().next(), Some([2.0 * MAX_POINTS as f64, -2.0 * MAX_POINTS as f64]));
        // Time decreases after steps back.
        let back = 2.5 * MAX_POINTS as f64;
        curve.push(back, 7.0);
        assert_eq!((curve.points().len(), curve.points().last()), (MAX_POINTS / 2 + 1, Some([back, 7.0])));
        curve.push(0.0, 1.0);
        assert_eq!(curve.points().collect::<Vec<_>>(), [[0.0, 1.0]]);
    }

    #[test]
    fn parts_of_a_curve_are_separated_by_gaps_and_keep_the_extremes() {
        let mut curve = Curve::new("x");
        let values = [0.0, 5.0, -3.0, 1.0, f64::NAN, 2.0, 2.0, 9.0, f64::INFINITY];
        for (index, value) in values.into_iter().enumerate() {
            curve.push(index as f64, value);
        }
        // Every point has a column.
        let all: Vec<Vec<f64>> =
            curve.parts(0.5).iter().map(|part| part.iter().map(|[_, value]| *value).collect()).collect();
        assert_eq!(all, [&[0.0, 5.0, -3.0, 1.0][..], &[2.0, 2.0, 9.0]]);
        // Columns of four points.
        assert_eq!(curve.parts(4.0), [vec![[1.0, 5.0], [2.0, -3.0]], vec![[5.0, 2.0], [7.0, 9.0]]]);
        assert!(Curve::new("empty").parts(1.0).is_empty());
    }
}
