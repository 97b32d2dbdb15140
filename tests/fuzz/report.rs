//! Findings and counts as a table.

use std::fmt;
use std::time::Duration;

use crate::fuzz::Target;

/// A forbidden behaviour of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    Crash {
        signal: i32,
    },
    Exit {
        code: i32,
    },
    Hang,
    Panic,
    /// The case read from standard input.
    StandardInput,
    /// The case wrote to standard output or standard error.
    Print,
}

#[derive(Default)]
pub struct Counts {
    pub cases: u64,
    pub worked: u64,
    pub rejected: u64,
    /// Duration and seed of the slowest case, including the start of a process.
    pub slowest: (Duration, u64),
}

pub struct Report {
    target: Target,
    counts: Counts,
    findings: Vec<(u64, Finding)>,
    files: Vec<String>,
    pub seconds: f64,
}

impl Report {
    pub const HEADING: &'static str = "             cases    worked  rejected  crashes   exits   hangs  panics   stdin   prints  seconds  slowest (seed)";

    pub fn new(target: Target) -> Self {
        Self { target, counts: Counts::default(), findings: Vec::new(), files: Vec::new(), seconds: 0.0 }
    }

    pub fn add(&mut self, counts: &Counts, findings: Vec<(u64, Finding)>) {
        self.counts.cases += counts.cases;
        self.counts.worked += counts.worked;
        self.counts.rejected += counts.rejected;
        self.counts.slowest = self.counts.slowest.max(counts.slowest);
        self.findings.extend(findings);
        self.findings.sort_by_key(|(seed, _)| *seed);
        self.findings.dedup();
    }

    pub fn findings(&self) -> &[(u64, Finding)] {
        &self.findings
    }

    /// Records unexpected files.
    pub fn unexpected_files(&mut self, files: Vec<String>) {
        self.files = files;
    }

    pub fn is_bad(&self) -> bool {
        !self.findings.is_empty() || !self.files.is_empty()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |is: fn(&Finding) -> bool| self.findings.iter().filter(|(_, finding)| is(finding)).count();
        let Counts { cases, worked, rejected, slowest } = &self.counts;
        write!(
            f,
            "{:10} {cases:>7} {worked:>9} {rejected:>9} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8.1} {:>6.2} s ({})",
            self.target.name(),
            count(|finding| matches!(finding, Finding::Crash { .. })),
            count(|finding| matches!(finding, Finding::Exit { .. })),
            count(|finding| matches!(finding, Finding::Hang)),
            count(|finding| matches!(finding, Finding::Panic)),
            count(|finding| matches!(finding, Finding::StandardInput)),
            count(|finding| matches!(finding, Finding::Print)),
            self.seconds,
            slowest.0.as_secs_f64(),
            slowest.1,
        )?;
        for (seed, finding) in &self.findings {
            write!(f, "\n  {finding:?}: cargo test --test fuzz -- case {} {seed}", self.target.name())?;
        }
        for file in &self.files {
            write!(f, "\n  a file appeared: {file}")?;
        }
        Ok(())
    }
}
