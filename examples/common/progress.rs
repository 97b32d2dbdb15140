//! How far a program is.

use std::time::Duration;

use indicatif::style::TemplateError;
use indicatif::{ProgressBar, ProgressStyle};

/// A bar of so many seconds of simulation.
pub fn bar(seconds: f64) -> Result<ProgressBar, TemplateError> {
    let bar = ProgressBar::new(position(seconds));
    bar.set_style(ProgressStyle::with_template("{bar:40} {percent} %, {elapsed}")?);
    bar.enable_steady_tick(Duration::from_secs(1));
    Ok(bar)
}

/// Where a time is on it.
pub fn position(seconds: f64) -> u64 {
    (1000.0 * seconds) as u64
}
