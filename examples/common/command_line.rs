//! Command line of the examples: values of options, progress bar and exit code. [`clap`] parses the
//! options.

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use indicatif::style::TemplateError;
use indicatif::{ProgressBar, ProgressStyle};

// Options of the examples that plan a motion. A comment for documentation would replace the
// description of the program in `--help`.
#[derive(clap::Args)]
pub struct Planning {
    /// Folder for the plot and the trajectory; without it, no files are written
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Show the run in a window (requires the feature viewer)
    #[arg(long)]
    pub view: bool,
}

/// Parses width and height in pixels, such as `640x480`.
pub fn size(text: &str) -> Result<[usize; 2], &'static str> {
    let size = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    size.filter(|size| !size.contains(&0)).ok_or("expected width and height, such as 640x480")
}

/// Parses a number that is finite and not negative.
pub fn not_negative(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|error| format!("{error}"))?;
    if number.is_finite() && number >= 0.0 {
        Ok(number)
    } else {
        Err("expected a number that is finite and not negative".into())
    }
}

/// Returns the number of processor cores.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, |cores| cores.get())
}

/// Creates a progress bar for a simulation of this duration, s. Its position is in
/// [`milliseconds`].
pub fn progress_bar(seconds: f64) -> Result<ProgressBar, TemplateError> {
    let bar = ProgressBar::new(milliseconds(seconds));
    bar.set_style(ProgressStyle::with_template("{bar:40} {percent} %, {elapsed}")?);
    bar.enable_steady_tick(Duration::from_secs(1));
    Ok(bar)
}

/// Converts a simulation time to a position of the progress bar.
pub fn milliseconds(seconds: f64) -> u64 {
    (1000.0 * seconds) as u64
}

/// Converts the result of an example to its exit code. Prints an error to standard error.
pub fn exit_code(result: Result<(), Box<dyn Error>>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
