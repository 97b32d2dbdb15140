//! Random numbers that depend on the simulation and its episode only, and distributions of
//! parameters.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Generator of random numbers for one episode of one simulation.
///
/// The numbers are determined by the seed, the index of the simulation and the number of the
/// episode. They depend neither on the number of threads nor on other simulations.
///
/// ```
/// use mujoco_safe::rollout::Random;
/// use mujoco_safe::{Batch, sample};
///
/// let mut batch = Batch::new(sample::cartpole(), 8)?;
/// batch.reset_where(
///     |_| true,
///     |index, episode, data| {
///         let mut random = Random::new(42, index, episode);
///         data.qpos_mut()[1] = random.uniform(-0.1, 0.1);
///         data.qvel_mut()[1] = 0.01 * random.normal();
///     },
/// )?;
/// assert_ne!(batch.data(3)?.qpos()[1], batch.data(4)?.qpos()[1]);
/// assert_eq!(batch.data(3)?.qpos()[1], Random::new(42, 3, 1).uniform(-0.1, 0.1));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Random {
    generator: Xoshiro256PlusPlus,
}

impl Random {
    /// Creates the generator of an episode.
    pub fn new(seed: u64, index: usize, episode: u64) -> Self {
        Self::stream(seed, index, episode, 0)
    }

    /// Creates one of several independent generators of an episode. Stream 0 is the stream of
    /// [`new`](Self::new). Parameter `k` of [`Parameters`](super::Parameters) uses stream `k + 1`,
    /// and the noise and delays of a [`VectorEnvironment`](crate::environment::VectorEnvironment)
    /// use stream `u64::MAX`. For others, choose large numbers.
    pub fn stream(seed: u64, index: usize, episode: u64, stream: u64) -> Self {
        let key = [index as u64, episode, stream].into_iter().fold(mix(seed), |key, number| mix(key ^ mix(number)));
        Self { generator: Xoshiro256PlusPlus::seed_from_u64(key) }
    }

    /// Draws from the uniform distribution between two numbers.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let fraction: f64 = self.generator.random();
        let width = high - low;
        // The width of a range of finite numbers can exceed the largest number.
        if width.is_finite() { low + fraction * width } else { (1.0 - fraction) * low + fraction * high }
    }

    /// Draws from the standard normal distribution.
    pub fn normal(&mut self) -> f64 {
        // Box and Muller (1958). The first number is positive, so its logarithm is finite.
        let (radius, angle) = (1.0 - self.uniform(0.0, 1.0), self.uniform(0.0, std::f64::consts::TAU));
        (-2.0 * radius.ln()).sqrt() * angle.cos()
    }
}

/// Permutes 64-bit integers so that neighbours differ in about half of their bits: the output
/// function of SplitMix64 (Steele et al. 2014).
fn mix(number: u64) -> u64 {
    let mut mixed = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

/// Distribution from which
/// [`Batch::sample_parameters`](super::super::Batch::sample_parameters) draws the value of a
/// [`Parameter`](super::Parameter).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Distribution {
    /// None: draws leave the value unchanged, which is at first the model's.
    Unchanged,
    /// Uniform distribution.
    Uniform {
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// Distribution whose logarithm is uniform, for factors: 1/2 is as probable as 2.
    LogUniform {
        /// Smallest value. Positive.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// Normal distribution, truncated at three standard deviations from the mean.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation. Not negative.
        deviation: f64,
    },
}

/// Number of standard deviations at which normal distributions are truncated.
const TRUNCATION: f64 = 3.0;

impl Distribution {
    /// Returns the smallest and the largest value, if any. They are in this order if the
    /// distribution is valid.
    pub(super) fn bounds(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Unchanged => None,
            Self::Uniform { low, high } | Self::LogUniform { low, high } => Some([low, high]),
            Self::Normal { mean, deviation } => Some([mean - TRUNCATION * deviation, mean + TRUNCATION * deviation]),
        }
    }

    /// Draws a value within the bounds.
    pub(super) fn draw(&self, random: &mut Random) -> Option<f64> {
        let [least, most] = self.bounds()?;
        let value = match *self {
            Self::Unchanged => return None,
            Self::Uniform { low, high } => random.uniform(low, high),
            Self::LogUniform { low, high } => random.uniform(low.ln(), high.ln()).exp(),
            Self::Normal { mean, deviation } => {
                let mut draws = std::iter::repeat_with(|| random.normal());
                mean + deviation
                    * draws.find(|draw| draw.abs() <= TRUNCATION).expect("Bug: an endless iterator has ended")
            }
        };
        // Rounding can exceed a bound in the last bit.
        Some(value.clamp(least, most))
    }
}
