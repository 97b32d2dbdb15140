//! The chi-square distribution, whose quantiles bound normalised squares of errors and innovations.

use std::f64::consts::{FRAC_2_SQRT_PI, PI};

use crate::error::{Error, Result};

/// Most degrees of freedom. The number of terms grows with them.
const MOST_DEGREES: usize = 1_000_000;

/// Returns the value that a chi-square variable stays below with this probability, between 0 and 1
/// exclusive. `degrees` is the number of degrees of freedom, from 1 to 1,000,000.
///
/// The sum of n independent normalised squares
/// ([`nees`](super::ExtendedKalmanFilter::nees), [`Update::nis`](super::Update::nis)) of d
/// components each has n·d degrees of freedom.
///
/// # Errors
///
/// [`Error::Invalid`] for a probability or a number of degrees outside of its range.
///
/// ```
/// use mujoco_safe::estimation::chi_square_quantile;
///
/// // A consistent estimate of a pose, with 6 components, is within this distance in 99 % of cases.
/// assert!((chi_square_quantile(0.99, 6)? - 16.811_893_829_770_927).abs() < 1e-9);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "chi2inv")]
#[doc(alias = "chi2.ppf")]
#[doc(alias = "NEES")]
#[doc(alias = "NIS")]
pub fn chi_square_quantile(probability: f64, degrees: usize) -> Result<f64> {
    let (is_valid, what) = (probability > 0.0 && probability < 1.0, "the probability of chi_square_quantile");
    Error::check_range(is_valid, what, probability, "between 0 and 1, exclusive")?;
    let (is_valid, what) = ((1..=MOST_DEGREES).contains(&degrees), "the degrees of freedom of chi_square_quantile");
    Error::check_range(is_valid, what, degrees, format_args!("from 1 to {MOST_DEGREES}"))?;
    let (mut low, mut high) = (0.0, degrees as f64);
    while 1.0 - tail(high, degrees) < probability {
        (low, high) = (high, 2.0 * high);
    }
    // Halves the interval until no number lies inside.
    loop {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            return Ok(middle);
        }
        if 1.0 - tail(middle, degrees) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Returns the probability that a variable exceeds `value`, which is positive. For whole degrees of
/// freedom, the incomplete gamma function is a finite sum (M. Abramowitz and I. A. Stegun,
/// *Handbook of Mathematical Functions*, 1964, 26.4.4 and 26.4.5).
fn tail(value: f64, degrees: usize) -> f64 {
    let half = 0.5 * value;
    if half <= 0.0 {
        return 1.0;
    }
    let (mut sum, mut power, mut logarithm): (f64, f64, f64) = if degrees.is_multiple_of(2) {
        (0.0, 0.0, -half)
    } else {
        // The first term has the power 1/2 and the gamma function of 3/2.
        (complementary_error_function(half.sqrt()), 0.5, 0.5 * half.ln() - half - (0.5 * PI.sqrt()).ln())
    };
    for _ in 0..degrees / 2 {
        sum += logarithm.exp();
        power += 1.0;
        logarithm += half.ln() - power.ln();
    }
    sum.min(1.0)
}

/// Returns the complementary error function of a number that is not negative, with a relative error
/// below 1e-12.
fn complementary_error_function(x: f64) -> f64 {
    if x < 2.5 {
        // Abramowitz and Stegun 7.1.6, whose terms are positive.
        let (mut term, mut sum) = (x, x);
        let mut odd = 1.0;
        while term > 1e-17 * sum {
            odd += 2.0;
            term *= 2.0 * x * x / odd;
            sum += term;
        }
        return 1.0 - FRAC_2_SQRT_PI * (-x * x).exp() * sum;
    }
    // The continued fraction 7.1.14.
    let fraction = (1..=60).rev().fold(x, |rest, index| x + 0.5 * f64::from(index) / rest);
    (-x * x).exp() / (PI.sqrt() * fraction)
}

#[cfg(test)]
mod tests {
    use super::chi_square_quantile;

    /// `scipy.stats.chi2.ppf` of SciPy 1.18.1.
    #[test]
    fn quantiles_agree_with_scipy() {
        for (probability, degrees, expected) in SCIPY {
            let found = chi_square_quantile(probability, degrees).unwrap();
            assert!((found - expected).abs() <= 1e-9 * expected, "{probability}, {degrees}: {found} for {expected}");
        }
    }

    const SCIPY: [(f64, usize, f64); 14] = [
        (0.5, 1, 0.454_936_423_119_572),
        (0.99, 1, 6.634_896_601_021_214_5),
        (0.001, 1, 1.570_797_149_262_492_1e-06),
        (0.95, 2, 5.991_464_547_107_979),
        (0.99, 3, 11.344_866_730_144_373),
        (0.01, 3, 0.114_831_801_899_117_07),
        (0.999_999, 3, 30.664_849_706_154_27),
        (0.99, 6, 16.811_893_829_770_927),
        (0.025, 7, 1.689_869_180_677_355),
        (0.975, 54, 76.192_048_166_249_99),
        (0.005, 300, 240.663_388_916_512_56),
        (0.995, 300, 366.844_446_134_908_7),
        (0.999_5, 2701, 2_949.418_128_511_254_5),
        (0.000_5, 2700, 2_464.728_558_550_151_3),
    ];
}
