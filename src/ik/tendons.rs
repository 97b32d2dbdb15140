//! Limits of the lengths of tendons, as inequalities of the displacement.

use crate::data::Data;
use crate::error::{Error, Result};
use crate::id::{Id, TendonId};
use crate::model::Model;

/// Tendons with a range.
#[derive(Debug)]
pub(super) struct TendonLimits {
    pub(super) tendons: Vec<TendonId>,
}

impl TendonLimits {
    pub(super) fn new(model: &Model) -> Self {
        let limited = (0..model.ntendon()).filter(|&tendon| model.tendon_limited()[tendon] != 0);
        Self { tendons: limited.map(|tendon| Id::new(tendon, model.lineage())).collect() }
    }

    pub(super) fn len(&self) -> usize {
        self.tendons.len()
    }

    /// Writes the derivative of a length, and returns its smallest and its largest change. Outside
    /// of the range, the length returns.
    pub(super) fn write(&self, data: &Data, index: usize, row: &mut [f64]) -> Result<[f64; 2]> {
        row.fill(0.0);
        data.tendon_row(self.tendons[index].index()).iter().for_each(|(dof, moment)| row[dof] = moment);
        self.room(data, index)
    }

    /// Returns the distances from a length to the ends of its range.
    fn room(&self, data: &Data, index: usize) -> Result<[f64; 2]> {
        let tendon = self.tendons[index].index();
        let length = data.ten_length()[tendon];
        let room = data.model().tendon_range()[tendon].map(|end| end - length);
        if room[0] <= room[1] {
            return Ok(room);
        }
        let range = format!("{length} in {:?}", data.model().tendon_range()[tendon]);
        Err(Error::out_of_range(format!("the length of tendon {tendon} and its range"), range, "finite, in this order"))
    }

    /// Returns the largest distance of a length from its range.
    pub(super) fn violation(&self, data: &Data) -> Result<f64> {
        (0..self.len()).try_fold(0.0, |largest: f64, index| {
            let [lower, upper] = self.room(data, index)?;
            Ok(largest.max(lower).max(-upper))
        })
    }
}
