//! Binary data of a page: streams of integers, and images.
//!
//! A stream has channels. Each number of a channel is the difference to its prediction from the
//! numbers before it, as a zigzag varint: seven bits per byte, lowest first, which is the format of
//! postcard. Slow motions and nearby vertices then need one byte per number.

use serde::Serialize;

/// Largest absolute value of a number in a stream. The differences of its predictions are exact in
/// the double precision of JavaScript.
pub(super) const LIMIT: f64 = (1u64 << 48) as f64;

/// Prediction of a number. The discriminant is that of the page's decoder: the number of earlier
/// numbers that it uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Prediction {
    /// The previous number.
    Previous,
    /// The line through the previous two numbers.
    Line,
}

/// Part of the binary data: offset and length, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Part(usize, usize);

/// Binary data.
#[derive(Debug, Default)]
pub(super) struct Binary(pub(super) Vec<u8>);

impl Binary {
    pub(super) fn raw(&mut self, bytes: &[u8]) -> Part {
        let start = self.0.len();
        self.0.extend_from_slice(bytes);
        Part(start, bytes.len())
    }

    /// Appends a stream of channels.
    pub(super) fn stream<C>(&mut self, prediction: Prediction, channels: impl IntoIterator<Item = C>) -> Part
    where
        C: IntoIterator<Item = i64>,
    {
        let start = self.0.len();
        for channel in channels {
            let (mut previous, mut step) = (None, 0);
            for number in channel {
                let difference = number - previous.unwrap_or(0) - step;
                postcard::to_io(&difference, &mut self.0).expect("Bug: a vector takes all bytes");
                step = if prediction == Prediction::Line { number - previous.unwrap_or(number) } else { 0 };
                previous = Some(number);
            }
        }
        Part(start, self.0.len() - start)
    }
}

/// Uniform quantisation of an interval to 16 bits. `value = low + step * number`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) step: f64,
}

impl Interval {
    /// Number of steps of the interval.
    const STEPS: f64 = 65535.0;

    /// Returns the smallest interval with all finite values.
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
        if low > high {
            return Self { low: 0.0, step: 0.0 };
        }
        // Divided first, because the difference of two finite numbers can be infinite.
        Self { low, step: high / Self::STEPS - low / Self::STEPS }
    }

    /// Returns the number of a finite value of the interval.
    pub(super) fn number(self, value: f64) -> i64 {
        let number = value / self.step - self.low / self.step;
        // With a step of zero there is only one value.
        if number.is_finite() { number.round().clamp(0.0, Self::STEPS) as i64 } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::{Binary, Interval, Prediction};

    fn bytes(prediction: Prediction, numbers: &[i64]) -> Vec<u8> {
        let mut binary = Binary::default();
        binary.stream(prediction, [numbers.iter().copied()]);
        binary.0
    }

    #[test]
    fn numbers_are_zigzag_varints_of_differences() {
        assert_eq!(bytes(Prediction::Previous, &[0, -1, 0, 64, 63]), [0, 1, 2, 0x80, 1, 1]);
        // The second number is predicted as the first, the third on the line through both.
        assert_eq!(bytes(Prediction::Line, &[3, 5, 7, 9, 8]), [6, 4, 4 - 4, 0, 5]);
    }

    #[test]
    fn an_interval_contains_its_ends_and_halves_its_step() {
        let values = [-1.0, 0.25, f64::NAN, 3.0];
        let interval = Interval::of(values.into_iter());
        assert_eq!([-1.0, 3.0].map(|value| interval.number(value)), [0, 65535]);
        let error = interval.low + interval.step * interval.number(0.25) as f64 - 0.25;
        assert!(error.abs() <= 0.5 * interval.step, "{error}");
        for constant in [0.0, 7.5, f64::MAX, -f64::MAX] {
            let interval = Interval::of([constant].into_iter());
            assert_eq!(interval.low + interval.step * interval.number(constant) as f64, constant);
        }
        assert!(Interval::of([-f64::MAX, f64::MAX].into_iter()).step.is_finite());
        assert_eq!(Interval::of([f64::INFINITY].into_iter()), Interval { low: 0.0, step: 0.0 });
    }
}
