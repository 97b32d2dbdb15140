//! A program of another library, which computes the same as a benchmark, alternately with it.

use std::io::{Error, Result};
use std::process::Command;

use super::process::Process;

/// A running program. It reads one line for each request, and answers with a line of numbers. All
/// other lines that it prints are ignored.
pub(crate) struct Peer(Process);

/// Medians of the seconds of both libraries and of the ratio, with the range of the middle 60 % of
/// the ratios, and the numbers that follow the seconds in the last answer.
pub(crate) struct Comparison {
    pub(crate) ours: f64,
    pub(crate) theirs: f64,
    pub(crate) ratio: [f64; 3],
    pub(crate) rest: Vec<f64>,
}

impl Peer {
    /// Starts a program with the first lines of its input, and waits until it prints `ready`.
    pub(crate) fn start(python: &str, arguments: &[&str], lines: &[String]) -> Result<Self> {
        let mut process = Process::spawn(Command::new(python).args(arguments))?;
        lines.iter().try_for_each(|line| process.send(line))?;
        while process.line()? != "ready" {}
        Ok(Self(process))
    }

    /// Sends a request, and returns the numbers of the answer.
    pub(crate) fn ask(&mut self, request: &str) -> Result<Vec<f64>> {
        self.0.send(request)?;
        loop {
            let line = self.0.line()?;
            if let Ok(numbers) = line.split_whitespace().map(str::parse).collect() {
                return Ok(numbers);
            }
        }
    }

    /// Runs both programs alternately. `ours` returns the seconds of a run.
    pub(crate) fn compare(&mut self, pairs: usize, request: &str, mut ours: impl FnMut() -> f64) -> Result<Comparison> {
        let (mut times, mut rest) = (Vec::new(), Vec::new());
        for _ in 0..pairs {
            let seconds = ours();
            let answer = self.ask(request)?;
            let [theirs, others @ ..] = answer.as_slice() else { return Err(Error::other("an answer is empty")) };
            times.push((seconds, *theirs));
            rest = others.to_vec();
        }
        let mut ratios: Vec<f64> = times.iter().map(|(ours, theirs)| ours / theirs).collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let ratio = [ratios[pairs / 5], super::median(ratios.clone()), ratios[pairs - 1 - pairs / 5]];
        let ours = super::median(times.iter().map(|(ours, _)| *ours).collect());
        let theirs = super::median(times.iter().map(|(_, theirs)| *theirs).collect());
        Ok(Comparison { ours, theirs, ratio, rest })
    }
}

/// Returns numbers as a line of input.
pub(crate) fn line(numbers: impl IntoIterator<Item = f64>) -> String {
    numbers.into_iter().map(|number| format!("{number:e}")).collect::<Vec<_>>().join(" ")
}
