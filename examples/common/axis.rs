//! Axis of a chart: linear or logarithmic, with ticks at round values.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// Range of values on an axis.
pub struct Axis {
    /// Ends; on a logarithmic axis their logarithms with base 10.
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl Axis {
    /// Creates an axis between two values, which are positive on a logarithmic axis.
    pub fn new(low: f64, high: f64, logarithmic: bool) -> Self {
        let scale = |value: f64| if logarithmic { value.log10() } else { value };
        Self { low: scale(low), high: scale(high), logarithmic }
    }

    /// Extends both ends by a fraction of the length.
    pub fn with_margin(self, fraction: f64) -> Self {
        let margin = fraction * (self.high - self.low);
        Self { low: self.low - margin, high: self.high + margin, ..self }
    }

    /// Moves an end to a round value if that is nearer than 1 % of the length.
    pub fn with_round_ends(self) -> Self {
        let length = self.high - self.low;
        let step = 10_f64.powf(length.log10().floor());
        let [low, high] = [self.low, self.high].map(|end| {
            let round = (end / step).round() * step;
            if (round - end).abs() < 0.01 * length { round } else { end }
        });
        Self { low, high, ..self }
    }

    /// Returns the values at the ends.
    pub fn ends(&self) -> [f64; 2] {
        [self.low, self.high].map(|place| self.value(place))
    }

    /// Returns about `count` round values, at distances of 1, 2 or 5 times a power of ten. On a
    /// logarithmic axis they are powers of ten, on a short one also twice and five times these.
    pub fn ticks(&self, count: usize) -> Vec<f64> {
        let &Self { low, high, logarithmic } = self;
        if logarithmic && high - low < 2.0 {
            let decades = low.floor() as i32..=high.floor() as i32;
            let values = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(decade)));
            return values.filter(|value| (low..=high).contains(&value.log10())).collect();
        }
        let least = (high - low) / count.max(1) as f64;
        let power = 10_f64.powf(least.log10().floor());
        let step = [1.0, 2.0, 5.0].map(|digit| digit * power).into_iter().find(|&step| step >= least);
        let step = step.unwrap_or(10.0 * power).max(if logarithmic { 1.0 } else { 0.0 });
        let indices = (low / step).ceil() as i64..=(high / step).floor() as i64;
        indices.map(|index| self.value(index as f64 * step)).collect()
    }

    /// Formats the value of a tick.
    pub fn label(&self, value: f64) -> String {
        if self.logarithmic && !(9.9e-5..1e5).contains(&value) {
            return format!("{value:.0e}");
        }
        let rounded = (value * 1e6).round() / 1e6;
        // Adding zero turns a negative zero into zero.
        (rounded + 0.0).to_string()
    }

    fn value(&self, place: f64) -> f64 {
        if self.logarithmic { 10_f64.powf(place) } else { place }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    /// Returns the pixel of a value on an axis between two pixels.
    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let place = if self.logarithmic { value.log10() } else { *value };
        first + (f64::from(last - first) * (place - self.low) / (self.high - self.low)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks(hint.max_num_points()) }
    }

    fn range(&self) -> Range<f64> {
        let [low, high] = self.ends();
        low..high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}
