//! Samples with their own clock.

use std::io::{BufRead, BufReader};
use std::path::Path;

use crate::error::{Error, InvalidKind, Result};
use crate::file;
use crate::matrix::Matrix;

/// Vectors of numbers at increasing times, such as the controls of a robot or the readings of a
/// sensor. The clock need not be that of the simulation, and the intervals may differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    times: Vec<f64>,
    values: Matrix,
}

impl Signal {
    /// Creates a signal from its times in seconds and one row of `values` for each.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] unless there is one row for each time, [`Error::Invalid`] if there is no
    /// sample, or the times are not finite and increasing.
    pub fn new(times: Vec<f64>, values: Matrix) -> Result<Self> {
        Error::check_length("the rows of a signal", values.nrows(), times.len())?;
        if times.is_empty() {
            return Err(Error::invalid(InvalidKind::OutOfRange, "a signal", "without samples", "with at least one"));
        }
        let previous = std::iter::once(f64::NEG_INFINITY).chain(times.iter().copied());
        if let Some((index, (before, time))) =
            previous.zip(&times).enumerate().find(|(_, (before, time))| !(time.is_finite() && *time > before))
        {
            let what = format!("time {index} of a signal");
            return Err(Error::out_of_range(what, time, format!("finite and after the one before, {before}")));
        }
        Ok(Self { times, values })
    }

    /// Creates a signal of one number per sample.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn scalar(times: Vec<f64>, values: Vec<f64>) -> Result<Self> {
        Self::new(times, Matrix::from_row_major(values.len(), 1, values))
    }

    /// Reads a CSV file with a header line: the times from the column `time`, and the numbers from
    /// `columns`, in this order. An empty cell, or one with `nan`, is a missing value.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, lacks a column, or has a cell that is not a
    /// number; the message has the line. The errors of [`new`](Self::new).
    pub fn load_csv(path: impl AsRef<Path>, time: &str, columns: &[&str]) -> Result<Self> {
        let path = path.as_ref();
        let (times, values) = read_csv(path, time, columns).map_err(Error::file(path))?;
        Self::new(times, values)
    }

    /// Returns the times, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the samples, one in each row.
    pub fn values(&self) -> &Matrix {
        &self.values
    }

    /// Returns the number of values of a sample.
    pub fn width(&self) -> usize {
        self.values.ncols()
    }

    /// Returns the time of the last sample.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Returns the samples of a range that is not empty.
    pub(super) fn rows(&self, rows: std::ops::Range<usize>) -> Result<Self> {
        let values = rows.clone().flat_map(|row| self.values.row(row)).copied().collect();
        Self::new(self.times[rows.clone()].to_vec(), Matrix::from_row_major(rows.len(), self.width(), values))
    }

    /// Returns the last sample that is not after a time, or the first one.
    pub fn held(&self, time: f64) -> &[f64] {
        self.values.row(self.times.partition_point(|&sample| sample <= time).saturating_sub(1))
    }

    /// Writes the values at a time, on the line between the two samples around it. Before the first
    /// and after the last sample, the values are theirs.
    pub fn interpolate_into(&self, time: f64, output: &mut [f64]) {
        let after = self.times.partition_point(|&sample| sample <= time);
        let Some(before) = after.checked_sub(1) else { return output.copy_from_slice(self.values.row(0)) };
        if after == self.times.len() {
            return output.copy_from_slice(self.values.row(before));
        }
        let part = (time - self.times[before]) / (self.times[after] - self.times[before]);
        for (output, (low, high)) in output.iter_mut().zip(self.values.row(before).iter().zip(self.values.row(after))) {
            *output = low + part * (high - low);
        }
    }
}

fn read_csv(path: &Path, time: &str, columns: &[&str]) -> std::io::Result<(Vec<f64>, Matrix)> {
    let invalid = |text: String| std::io::Error::new(std::io::ErrorKind::InvalidData, text);
    let mut lines = BufReader::new(file::open_regular(path)?).lines();
    let header = lines.next().transpose()?.unwrap_or_default();
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let place = |name: &str| {
        names
            .iter()
            .position(|found| *found == name)
            .ok_or_else(|| invalid(format!("no column is called {name:?}; the file has {}", names.join(", "))))
    };
    let time = place(time)?;
    let places = columns.iter().map(|name| place(name)).collect::<std::io::Result<Vec<_>>>()?;
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for (number, line) in lines.enumerate() {
        let line = line?;
        if line.trim().is_empty() {
            continue;
        }
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let read = |place: usize| match cells.get(place) {
            Some(&"") => Ok(f64::NAN),
            Some(cell) => cell.parse().map_err(|_| invalid(format!("line {}: {cell:?} is not a number", number + 2))),
            None => Err(invalid(format!("line {}: {} cells instead of {}", number + 2, cells.len(), names.len()))),
        };
        times.push(read(time)?);
        for &place in &places {
            values.push(read(place)?);
        }
    }
    let values = Matrix::from_row_major(times.len(), columns.len(), values);
    Ok((times, values))
}
