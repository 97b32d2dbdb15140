//! Page about a result, with plots.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

use super::plot::{Curve, plot};
use super::{Estimate, Fit, MeasurementError, Unknown};
use crate::error::Result;
use crate::file;
use crate::least_squares::LeastSquaresOutcome;

/// Start of the page. The policy allows no program and no connection.
const HEAD: &str = r#"<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'">
<meta name="viewport" content="width=device-width">
<title>Identification</title>
<style>
body { font: 15px/1.45 sans-serif; color: #282c34; max-width: 1100px; margin: 2em auto; padding: 0 1em }
table { border-collapse: collapse; margin: .5em 0 }
th, td { padding: .2em .8em; text-align: right; border-bottom: 1px solid #e2e4e8; white-space: nowrap }
th:first-child, td:first-child { text-align: left; white-space: normal }
h2 { margin-top: 2em; border-bottom: 2px solid #e2e4e8 }
svg { width: 100%; height: auto }
.plots { display: grid; grid-template-columns: 1fr 1fr; gap: 1em }
.fit { color: #0072b2 } .measured { color: #787878 } .residual { color: #d55e00 }
@media (max-width: 700px) { .plots { grid-template-columns: 1fr } }
</style>
"#;

impl Fit {
    /// Writes a page about the result that a browser opens from disk: the values with their
    /// confidence intervals and bounds, what the data do not determine, the cost in each iteration,
    /// and for each measurement the simulated readings beside the measured ones and their
    /// differences. `held_out` are the errors that [`validate`](Self::validate) returns, or none.
    ///
    /// The page has no program, and names are texts in it.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written; an existing file is then
    /// unchanged.
    ///
    /// ```
    /// use mujoco_safe::identification::{Experiment, Identification, Options, Unknown};
    /// use mujoco_safe::rollout::Parameter;
    /// use mujoco_safe::{Data, RandomController, Trajectory, sample};
    ///
    /// let data = Data::new(sample::cartpole())?;
    /// let mut real = data.clone();
    /// real.edit_model(|model| model.body_mut("pole")?.scale_mass(1.5))?;
    /// let mut record = |seed| {
    ///     let mut trajectory = Trajectory::with_sensordata(data.model());
    ///     real.reset()?;
    ///     trajectory.record(&mut real, &mut RandomController::new(seed), 100)?;
    ///     Experiment::of_trajectory(format!("log {seed}"), &data, &trajectory)
    /// };
    /// let (first, second) = (record(1)?, record(2)?);
    ///
    /// let pole = data.model().body("pole")?.id();
    /// let mass = Unknown::parameter(data.model(), Parameter::MassFactor(pole))?;
    /// let fit = Identification::new(vec![mass])?.with_experiment(first)?.solve(Options::default())?;
    /// let held_out = fit.validate([second])?;
    /// let path = std::env::temp_dir().join("mujoco_safe_identification.html");
    /// fit.save_report(&path, &held_out)?;
    /// # std::fs::remove_file(path).ok();
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "plot")]
    #[doc(alias = "html")]
    pub fn save_report(&self, path: impl AsRef<Path>, held_out: &[MeasurementError]) -> Result<()> {
        file::replace(path.as_ref(), |page| self.write(page, held_out))
    }

    fn write(&self, page: &mut impl Write, held_out: &[MeasurementError]) -> io::Result<()> {
        page.write_all(HEAD.as_bytes())?;
        let LeastSquaresOutcome { status, iterations, first_cost, cost } = self.outcome();
        writeln!(
            page,
            "<h1>Identification</h1>\n<p>{status:?} after {iterations} iterations, cost {first_cost:.4e} → {cost:.4e}. \
             Root mean square of the residuals in units of their standard deviations: {:.3e}.</p>",
            self.noise()
        )?;
        self.write_values(page)?;
        let costs = self.costs().iter().enumerate().map(|(iteration, cost)| [iteration as f64, cost.log10()]);
        let curve = Curve { points: costs.collect(), color: [0, 114, 178], width: 2 };
        let cost = plot(["iteration", "log₁₀ cost"], &[curve])?;
        writeln!(page, "<h2>Cost</h2>\n<div class=plots>{cost}</div>")?;
        if self.gap() > 0.0 {
            let text = "The weight of the gaps between segments grows during the search, and the cost with it. Largest gap at the end";
            writeln!(page, "<p>{text}: {:.3e}.</p>", self.gap())?;
        }
        write_errors(page, "Measurements", self.errors())?;
        write_errors(page, "Held-out experiments", held_out)
    }

    /// Writes the values, and what the data do not determine.
    fn write_values(&self, page: &mut impl Write) -> io::Result<()> {
        writeln!(
            page,
            "<h2>Values</h2>\n<table><tr><th>unknown<th>first<th>value<th>standard deviation<th>95 % interval<th>bounds<th>prior"
        )?;
        for (estimate, unknown) in self.estimates().iter().zip(self.identification.unknowns()) {
            let Estimate { name, first, value, deviation, interval: [low, high], is_at_bound } = estimate;
            let Unknown { lower, upper, prior, .. } = unknown;
            let [value, low, high] = [value, low, high].map(|value| number(*value));
            let interval = if *is_at_bound { "at a bound".to_owned() } else { format!("[{low}, {high}]") };
            let prior = prior.map_or(String::new(), |(mean, deviation)| format!("{mean} ± {deviation}"));
            let name = escaped(name);
            writeln!(
                page,
                "<tr><td>{name}<td>{first}<td><b>{value}</b><td>{deviation:.2e}<td>{interval}<td>[{lower}, {upper}]<td>{prior}"
            )?;
        }
        writeln!(page, "</table>\n<h2>Undetermined combinations</h2>")?;
        if self.undetermined().is_empty() {
            return writeln!(page, "<p>None: the data determine all unknowns.</p>");
        }
        let text = "All values can change together by multiples of these factors, and the readings stay.";
        writeln!(page, "<p>{text}</p>\n<ul>")?;
        for combination in self.undetermined() {
            writeln!(page, "<li>{}", escaped(combination))?;
        }
        writeln!(page, "</ul>")
    }
}

/// Writes the errors of measurements under a title, unless there are none.
fn write_errors(page: &mut impl Write, title: &str, errors: &[MeasurementError]) -> io::Result<()> {
    if errors.is_empty() {
        return Ok(());
    }
    writeln!(
        page,
        "<h2>{title}</h2>\n<p>Left: <span class=measured>measured</span> and <span class=fit>simulated</span> \
         readings. Right: <span class=residual>simulated minus measured</span>.</p>"
    )?;
    for MeasurementError { experiment, measurement, count, rms, simulated, measured } in errors {
        let (experiment, measurement) = (escaped(experiment), escaped(measurement));
        writeln!(page, "<h3>{experiment}: {measurement}</h3>\n<p>{count} readings, rms error {rms:.4e}</p>")?;
        for component in 0..simulated.width() {
            let times = simulated.times().iter().enumerate();
            let [simulated, measured] = [simulated.values(), measured.values()];
            let curve = |value: &dyn Fn(usize) -> f64, color, width| {
                let points = times.clone().map(|(row, &time)| [time, value(row)]).collect();
                Curve { points, color, width }
            };
            let both = [
                curve(&|row| measured[(row, component)], [170, 174, 180], 5),
                curve(&|row| simulated[(row, component)], [0, 114, 178], 2),
            ];
            let difference = curve(&|row| simulated[(row, component)] - measured[(row, component)], [213, 94, 0], 2);
            let reading = if simulated.ncols() > 1 { format!("reading {component}") } else { "reading".to_owned() };
            let left = plot(["time (s)", &reading], &both)?;
            let right = plot(["time (s)", "residual"], &[difference])?;
            writeln!(page, "<div class=plots>{left}{right}</div>")?;
        }
    }
    Ok(())
}

/// Returns a number with at least six digits.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-2..1e6).contains(&size) || !size.is_finite() {
        format!("{value:.6}")
    } else {
        format!("{value:.5e}")
    }
}

/// Returns a text with the characters of markup replaced.
fn escaped(text: impl Display) -> String {
    let text = text.to_string();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}
