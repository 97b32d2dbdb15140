//! Other moments of a trajectory in the same picture.

/// How other moments of a trajectory are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Burst {
    pub on: bool,
    /// Past moments red, future ones blue.
    pub doppler: bool,
    /// How many there are, from 1 to 40. Fractions add up until they make a whole one.
    pub factor: f64,
    /// How slowly they fade with their distance in time, from 1 to 40.
    pub gamma: f64,
}
