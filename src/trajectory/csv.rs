//! Trajectories as CSV: a header line and one line per record.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;

use super::{Sizes, Trajectory};
use crate::error::{Error, Result};
use crate::file;
use crate::model::Model;

impl Trajectory {
    /// Writes the records as CSV with a header line: the columns `time`, `qpos0`, …, `qvel0`, …, `act0`, …, `ctrl0`, … and, if recorded,
    /// `sensordata0`, …. Reading the file restores every value bit for bit.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
    pub fn save_csv(&self, path: impl AsRef<Path>) -> Result<()> {
        file::replace(path.as_ref(), |out| self.write_csv(out))
    }

    fn write_csv(&self, out: &mut impl Write) -> std::io::Result<()> {
        for (index, column) in self.sizes.columns(self.nsensordata).enumerate() {
            write!(out, "{}{column}", if index == 0 { "" } else { "," })?;
        }
        writeln!(out)?;
        for record in 0..self.len() {
            write!(out, "{}", self.times[record])?;
            for value in self.state(record).iter().chain(self.ctrl(record)).chain(self.sensordata(record)) {
                // `Display` prints the shortest decimal that parses to the same value.
                write!(out, ",{value}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// Reads a file written by [`save_csv`](Self::save_csv), with or without sensor readings, for simulations of this model.
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
        let mut lines = BufReader::new(file::open_regular(path)?).lines();
        let header = lines.next().transpose()?.unwrap_or_default();
        let sizes = Sizes::of(model);
        let fits = |nsensordata: &usize| sizes.columns(*nsensordata).eq(header.trim_end().split(','));
        let counts = [0, model.nsensordata()];
        let Some(nsensordata) = counts.into_iter().find(fits) else {
            let [without, with] = counts.map(|nsensordata| sizes.columns(nsensordata).count());
            let found = header.split(',').count();
            return Err(invalid(format!(
                "line 1 is not the header of this model's trajectories: expected {without} columns starting with 'time', or {with} \
                 with the sensor readings, found {found}"
            )));
        };
        let mut trajectory = Self { nsensordata, ..Self::new(model) };
        let (controls, sensordata) = (1 + sizes.state(), 1 + sizes.state() + sizes.nu);
        let columns = sensordata + nsensordata;
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
            if values.len() != columns {
                return Err(invalid(format!("line {number} has {} columns, not {columns}", values.len())));
            }
            trajectory.times.push(values[0]);
            trajectory.states.extend_from_slice(&values[1..controls]);
            trajectory.controls.extend_from_slice(&values[controls..sensordata]);
            trajectory.sensordata.extend_from_slice(&values[sensordata..]);
        }
        Ok(trajectory)
    }
}
