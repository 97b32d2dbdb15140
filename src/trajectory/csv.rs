//! Trajectories as CSV: a header line and one line per record.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;

use super::Trajectory;
use crate::error::{Error, Result};
use crate::file;
use crate::model::Model;

impl Trajectory {
    /// Writes the records as CSV with a header line. Reading the file restores every value bit for bit.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
    pub fn save_csv(&self, path: impl AsRef<Path>) -> Result<()> {
        file::replace(path.as_ref(), |out| self.write_csv(out))
    }

    fn write_csv(&self, out: &mut impl Write) -> std::io::Result<()> {
        for (index, column) in self.sizes.columns().enumerate() {
            write!(out, "{}{column}", if index == 0 { "" } else { "," })?;
        }
        writeln!(out)?;
        for record in 0..self.len() {
            write!(out, "{}", self.times[record])?;
            for value in self.state(record).iter().chain(self.ctrl(record)) {
                // `Display` prints the shortest decimal that parses to the same value.
                write!(out, ",{value}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// Reads a file written by [`save_csv`](Self::save_csv), for simulations of this model.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, is a pipe or a device, belongs to a model with other sizes, or contains
    /// a cell that is not a number. The message contains the line number.
    pub fn load_csv(model: &Model, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::read_csv(model, path).map_err(Error::file(path))
    }

    fn read_csv(model: &Model, path: &Path) -> std::io::Result<Self> {
        let invalid = |text: String| std::io::Error::new(std::io::ErrorKind::InvalidData, text);
        let mut trajectory = Self::new(model);
        let sizes = trajectory.sizes;
        let mut lines = BufReader::new(file::open_regular(path)?).lines();
        let header = lines.next().transpose()?.unwrap_or_default();
        let expected = sizes.columns().collect::<Vec<_>>().join(",");
        if header.trim_end() != expected {
            let (found, columns) = (header.split(',').count(), sizes.state() + sizes.nu + 1);
            return Err(invalid(format!(
                "line 1 is not the header of this model's trajectories: expected {columns} columns starting with 'time', found {found}"
            )));
        }
        for (index, line) in lines.enumerate() {
            let line = line?;
            let number = index + 2;
            let values: Vec<f64> = line
                .split(',')
                .map(|cell| {
                    cell.trim()
                        .parse()
                        .map_err(|_| invalid(format!("line {number}: '{}' is not a number", cell.trim())))
                })
                .collect::<std::io::Result<_>>()?;
            if values.len() != 1 + sizes.state() + sizes.nu {
                return Err(invalid(format!(
                    "line {number} has {} columns, not {}",
                    values.len(),
                    1 + sizes.state() + sizes.nu
                )));
            }
            trajectory.times.push(values[0]);
            trajectory.states.extend_from_slice(&values[1..=sizes.state()]);
            trajectory.controls.extend_from_slice(&values[1 + sizes.state()..]);
        }
        Ok(trajectory)
    }
}
