//! Trajectories as files of NumPy: an archive (ZIP) of the arrays `time`, `qpos`, `qvel`, `act` and `ctrl`.
//!
//! The archive is the crate zip's business. The arrays in it are a header of text and the numbers; the crates for those
//! allocate what a header asks for, or multiply its sizes unchecked, so that a damaged file would end the program.

use std::io::{self, Read, Seek, Write};
use std::path::Path;

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::{Sizes, Trajectory};
use crate::error::{Error, Result};
use crate::file;
use crate::model::Model;

/// What every array begins with: the magic text, and version 1.0 of the format.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// The numbers begin at a multiple of this.
const ALIGNMENT: usize = 64;
/// Bytes of a header. An array of numbers has a short one.
const LONGEST_HEADER: u32 = 1 << 16;

/// The bytes that the arrays of a file may unpack to: this many, and as many times the size of the file. Numbers of a simulation
/// seldom pack to a tenth of their size; a file that unpacks to a thousand times its size is made to use up memory.
const FREE_BYTES: u64 = 64 << 20;
const MOST_UNPACKING: u64 = 100;

/// The arrays of a file, the times aside, and their numbers in a record.
fn arrays(sizes: Sizes) -> [(&'static str, usize); 4] {
    [("qpos", sizes.nq), ("qvel", sizes.nv), ("act", sizes.na), ("ctrl", sizes.nu)]
}

impl Trajectory {
    /// Writes the records as NumPy's `.npz`, which Python reads with `numpy.load`: the arrays `time` of shape `(n)`, s, `qpos`
    /// `(n, nq)`, `qvel` `(n, nv)`, `act` `(n, na)` and `ctrl` `(n, nu)`, of `n` records each. Reading them back gives the same
    /// numbers, bit for bit.
    ///
    /// Needs the feature `npz`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; one that was there before is as it was.
    ///
    /// ```
    /// use mujoco_safe::{Data, RandomController, Trajectory, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut trajectory = Trajectory::new(data.model());
    /// trajectory.record(&mut data, &mut RandomController::new(1), 100)?;
    ///
    /// let path = std::env::temp_dir().join("mujoco_safe_cartpole.npz");
    /// trajectory.save_npz(&path)?;
    /// assert_eq!(Trajectory::load_npz(data.model(), &path)?, trajectory);
    /// # std::fs::remove_file(path).ok();
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "savez")]
    pub fn save_npz(&self, path: impl AsRef<Path>) -> Result<()> {
        file::replace(path.as_ref(), |out| self.write_npz(out))
    }

    fn write_npz(&self, out: &mut (impl Write + Seek)) -> io::Result<()> {
        let mut archive = ZipWriter::new(out);
        // As NumPy does it: not compressed, and with room for more than 4 GiB.
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(true);
        archive.start_file("time.npy", options)?;
        write_array(&mut archive, &format!("({},)", self.len()), [self.times()])?;
        let mut start = 0;
        for (name, width) in arrays(self.sizes) {
            archive.start_file(format!("{name}.npy"), options)?;
            let rows = (0..self.len()).map(|record| match name {
                "ctrl" => self.ctrl(record),
                _ => &self.state(record)[start..][..width],
            });
            write_array(&mut archive, &format!("({}, {width})", self.len()), rows)?;
            start += width;
        }
        archive.finish()?;
        Ok(())
    }

    /// Reads what [`save_npz`](Self::save_npz) wrote, or a file of NumPy's with these arrays (`numpy.savez`,
    /// `numpy.savez_compressed`), for simulations of this model. Other arrays in the file are left alone. The arrays may
    /// unpack to 64 MiB, or to a hundred times the size of the file if that is more, so that a small file cannot take all memory.
    ///
    /// Needs the feature `npz`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, is a pipe or a device, lacks an array, or has one of another shape than this model's or of
    /// something other than double precision, which the text names, has two arrays of one name, or unpacks to more than is allowed.
    pub fn load_npz(model: &Model, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::read_npz(model, path).map_err(Error::file(path))
    }

    fn read_npz(model: &Model, path: &Path) -> io::Result<Self> {
        let file = file::open_regular(path)?;
        let mut allowed = file.metadata()?.len().saturating_mul(MOST_UNPACKING).max(FREE_BYTES);
        let mut archive = ZipArchive::new(io::BufReader::new(file))?;
        if archive.has_duplicate_names() {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "two arrays have the same name"));
        }
        let sizes = Sizes::of(model);
        let times = read_array(&mut archive, &mut allowed, "time", |shape| match shape {
            &[records] => Ok(records),
            _ => Err("(n)".to_owned()),
        })?;
        let records = times.len();
        let mut parts = Vec::new();
        for (name, width) in arrays(sizes) {
            let values = read_array(&mut archive, &mut allowed, name, |shape| match shape {
                &[rows, columns] if (rows, columns) == (records, width) => {
                    rows.checked_mul(columns).ok_or_else(|| "smaller".to_owned())
                }
                _ => Err(format!("({records}, {width}) for the records of 'time' and this model")),
            })?;
            parts.push((values, width));
        }
        let mut trajectory = Self { sizes, times, states: Vec::new(), controls: Vec::new() };
        trajectory.controls = parts.pop().map(|(values, _)| values).unwrap_or_default();
        trajectory.states.reserve_exact(parts.iter().map(|(values, _)| values.len()).sum());
        for record in 0..records {
            for (values, width) in &parts {
                trajectory.states.extend_from_slice(&values[record * width..][..*width]);
            }
        }
        Ok(trajectory)
    }
}

/// Writes an array of NumPy's: its header, and its rows.
fn write_array<'a>(out: &mut impl Write, shape: &str, rows: impl IntoIterator<Item = &'a [f64]>) -> io::Result<()> {
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    // The magic text, the header's length, the header, and a line's end.
    let length = MAGIC.len() + 2 + header.len() + 1;
    header.extend(std::iter::repeat_n(' ', length.next_multiple_of(ALIGNMENT) - length));
    header.push('\n');
    let length = u16::try_from(header.len()).map_err(io::Error::other)?;
    out.write_all(MAGIC)?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    let mut bytes = Vec::new();
    for row in rows {
        bytes.clear();
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Says that an array is shorter than its shape.
const FEWER: &str = "has not as many numbers as its shape says";

/// Reads an array of an archive, and takes its bytes off those that are allowed. `length` returns the number of values in an array
/// of a shape, or else the shape that is right.
fn read_array(
    archive: &mut ZipArchive<impl Read + Seek>,
    allowed: &mut u64,
    name: &str,
    length: impl FnOnce(&[usize]) -> std::result::Result<usize, String>,
) -> io::Result<Vec<f64>> {
    let bad = |text: &str| io::Error::new(io::ErrorKind::InvalidData, format!("the array '{name}' {text}"));
    let mut array = archive.by_name(&format!("{name}.npy")).map_err(|error| match error {
        ZipError::FileNotFound => bad("is not in the file"),
        error => io::Error::from(error),
    })?;
    let mut start = [0; MAGIC.len()];
    array.read_exact(&mut start)?;
    if start[..6] != MAGIC[..6] {
        return Err(bad("is not one of NumPy's"));
    }
    let mut size = [0; 4];
    // Two bytes of length in version 1, four in later ones.
    array.read_exact(&mut size[..if start[6] == 1 { 2 } else { 4 }])?;
    let size = u32::from_le_bytes(size);
    if size > LONGEST_HEADER {
        return Err(bad("has a header of another form"));
    }
    let mut header = vec![0; size as usize];
    array.read_exact(&mut header)?;
    let header = Header::parse(&String::from_utf8_lossy(&header)).ok_or_else(|| bad("has a header of another form"))?;
    if header.descr != "<f8" {
        return Err(bad(&format!("is of the type '{}', but must be of double precision ('<f8')", header.descr)));
    }
    if header.fortran_order {
        return Err(bad("is in Fortran's order, but must be in C's (numpy.ascontiguousarray)"));
    }
    let length = length(&header.shape).map_err(|expected| {
        let shape = header.shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        bad(&format!("has shape ({shape}), but must have {expected}"))
    })?;
    let size = length.checked_mul(8).ok_or_else(|| bad("is too large"))?;
    let Some(rest) = allowed.checked_sub(size as u64) else {
        let is_there = size as u64 <= array.size();
        let text =
            format!("unpacks to {size} bytes, and all arrays may to {MOST_UNPACKING} times the size of the file");
        return Err(bad(if is_there { &text } else { FEWER }));
    };
    *allowed = rest;
    // Grows with what is there, whatever the header says.
    let mut bytes = Vec::new();
    array.by_ref().take(size as u64).read_to_end(&mut bytes)?;
    // At its end the archive checks its sum.
    if bytes.len() != size || array.read(&mut [0])? != 0 {
        return Err(bad(FEWER));
    }
    Ok(bytes.as_chunks().0.iter().map(|&value| f64::from_le_bytes(value)).collect())
}

/// What the header of an array says: a dictionary in Python's notation.
#[derive(Debug, PartialEq)]
struct Header {
    descr: String,
    fortran_order: bool,
    shape: Vec<usize>,
}

impl Header {
    fn parse(text: &str) -> Option<Self> {
        let text: String = text.chars().filter(|character| !character.is_whitespace()).collect();
        let value = |key: &str| {
            let found = [format!("'{key}':"), format!("\"{key}\":")].into_iter();
            found.filter_map(|key| text.split_once(&key)).map(|(_, value)| value).next()
        };
        let descr = value("descr")?;
        let quote = descr.chars().next().filter(|quote| matches!(quote, '\'' | '"'))?;
        let descr = descr[1..].split_once(quote)?.0.to_owned();
        let fortran_order = match value("fortran_order")? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return None,
        };
        let (shape, _) = value("shape")?.strip_prefix('(')?.split_once(')')?;
        let shape =
            shape.split(',').filter(|size| !size.is_empty()).map(|size| size.parse().ok()).collect::<Option<_>>()?;
        Some(Self { descr, fortran_order, shape })
    }
}

#[cfg(test)]
mod tests {
    use super::Header;

    #[test]
    fn headers_are_read_in_any_order_and_spacing() {
        let expected = |descr: &str, fortran_order, shape: &[usize]| {
            Some(Header { descr: descr.to_owned(), fortran_order, shape: shape.to_vec() })
        };
        for (text, header) in [
            ("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }  \n", expected("<f8", false, &[3, 4])),
            ("{\"shape\":(7,),\"fortran_order\":True,\"descr\":\">f4\"}", expected(">f4", true, &[7])),
            ("{'descr': '|u1', 'fortran_order': False, 'shape': ()}", expected("|u1", false, &[])),
            ("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1,)}", None),
            ("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 4)}", None),
            ("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 4)}", None),
            ("{'descr': '<f8', 'fortran_order': 0, 'shape': (1,)}", None),
            ("{'descr': '<f8', 'fortran_order': False}", None),
            ("", None),
        ] {
            assert_eq!(Header::parse(text), header, "{text}");
        }
    }
}
