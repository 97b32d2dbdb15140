//! Report of a comparison as text.

use std::fmt;

use super::compare::Comparison;
use super::origin::Origin;

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let here = Origin::here();
        writeln!(
            f,
            "there: engine {} on {}; here: engine {} on {}",
            self.origin.engine, self.origin.target, here.engine, here.target
        )?;
        writeln!(f, "{} calls, {} with the same bits", self.calls, self.identical)?;
        for (title, divergences) in [
            ("first differences beyond rounding", &self.divergences),
            ("differences of a solver that stops before it has converged", &self.convergence),
        ] {
            writeln!(f, "{title}: {}", if divergences.is_empty() { "none" } else { "" })?;
            divergences.iter().try_for_each(|divergence| writeln!(f, "  {divergence}"))?;
        }
        if !self.other_fields.is_empty() {
            writeln!(f, "other fields of the model that differ: {}", self.other_fields.join(", "))?;
        }
        Ok(())
    }
}
