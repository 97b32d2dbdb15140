//! Trajectories as CSV: a header line and one line per record.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;

use super::{Sizes, Trajectory};
use crate::error::{Error, Result};
use crate::file;
use crate::model::Model;

/// Largest number of bytes of a cell. The longest numbers that [`Trajectory::save_csv`] writes are
/// subnormal, with fewer than 350 characters.
const LONGEST_CELL: usize = 1000;

impl Trajectory {
    /// Writes the records as CSV with a header line: the columns `time`, `qpos0`, …, `qvel0`, …,
    /// `act0`, …, `ctrl0`, … and, if recorded, `sensordata0`, …. Reading the file restores every
    /// value bit for bit, except that the sign and the payload of a NaN are lost: it is written as
    /// `NaN`, because other programs do not read the payload. NumPy files (`save_npz`) keep them.
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

    /// Reads a file written by [`save_csv`](Self::save_csv), with or without sensor readings, for
    /// simulations of this model.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, is a pipe or a device, belongs to a model with
    /// other sizes, or contains a cell that is not a number, or a line of more than 1000 bytes for
    /// each column. The message contains the line number.
    pub fn load_csv(model: &Model, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::read_csv(model, path).map_err(Error::file(path))
    }

    fn read_csv(model: &Model, path: &Path) -> std::io::Result<Self> {
        let sizes = Sizes::of(model);
        let longest = LONGEST_CELL * sizes.columns(model.nsensordata()).count();
        let mut lines = Lines { file: BufReader::new(file::open_regular(path)?), longest, number: 0 };
        let header = lines.next().transpose()?.unwrap_or_default();
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
            for (output, values) in [
                (&mut trajectory.times, &values[..1]),
                (&mut trajectory.states, &values[1..controls]),
                (&mut trajectory.controls, &values[controls..sensordata]),
                (&mut trajectory.sensordata, &values[sensordata..]),
            ] {
                output.try_reserve(values.len())?;
                output.extend_from_slice(values);
            }
        }
        Ok(trajectory)
    }
}

/// Lines of a file, up to a length, because a failed allocation for a longer one would abort the
/// process.
struct Lines<R> {
    file: R,
    /// Largest number of bytes of a line.
    longest: usize,
    /// Number of the last line, from 1.
    number: usize,
}

impl<R: BufRead> Iterator for Lines<R> {
    type Item = std::io::Result<String>;

    fn next(&mut self) -> Option<Self::Item> {
        self.number += 1;
        let mut line = String::new();
        match self.file.by_ref().take(self.longest as u64 + 1).read_line(&mut line) {
            Ok(0) => None,
            Ok(length) if length > self.longest => {
                Some(Err(invalid(format!("line {} has more than {} bytes", self.number, self.longest))))
            }
            Ok(_) => Some(Ok(line)),
            Err(error) => Some(Err(error)),
        }
    }
}

fn invalid(text: String) -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::InvalidData, text)
}
