//! Riccati equation: this crate beside SLICOT.

use std::fs;
use std::path::Path;

use mujoco_safe::rayon::ThreadPool;

use crate::Outcome;
use crate::library::RiccatiProblem;
use crate::peer::Peer;
use crate::report::{Comparison, Report};

/// Routines of SLICOT, with their names in the report.
const ROUTINES: [(&str, &str); 2] = [("SB02OD", "SLICOT SB02OD"), ("SB02MD", "SLICOT SB02MD")];

/// Compares the time of the Riccati equation of a task with that of SLICOT's routines, which
/// `python` calls through slycot.
pub(crate) fn compare(
    report: &mut Report,
    (python, out): (&Path, &Path),
    (pool, pairs): (&ThreadPool, usize),
    (task, model): (&str, &Path),
    mut problem: RiccatiProblem,
) -> Outcome<()> {
    let mut slicot = Peer::start(python, model, None, Some("perf/slicot.py"))?;
    fs::create_dir_all(out)?;
    let file = std::path::absolute(out.join("riccati.txt"))?;
    fs::write(&file, problem.text())?;
    for (routine, reference) in ROUTINES {
        let command = format!("riccati {routine} {}", file.display());
        let comparison = Comparison::measure(pool, pairs, || problem.solve(), || slicot.run(&command))?;
        let (ours, theirs) = (comparison.our_checksum, comparison.their_checksum);
        println!("Riccati, {task}: relative residuals {ours:.1e} and {theirs:.1e} of {reference}");
        report.add(format!("Riccati equation, {task}"), reference, 1, &comparison);
    }
    fs::remove_file(&file)?;
    Ok(())
}
