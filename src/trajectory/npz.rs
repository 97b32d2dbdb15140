//! Trajectories as NumPy archives (`.npz`): a ZIP archive of the arrays `time`, `qpos`, `qvel`, `act` and `ctrl`.
//!
//! The crate `zip` reads the archive. The arrays, a text header followed by the values, are parsed here: existing crates allocate
//! the size in the header without a limit, or multiply its dimensions unchecked, so a damaged file could abort the program.

use std::io::{self, Read, Seek, Write};
use std::path::Path;

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::{Sizes, Trajectory};
use crate::error::{Error, Result};
use crate::file;
use crate::model::Model;

/// Start of every array: the magic string and version 1.0 of the format.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// Alignment of the values within a file, bytes.
const ALIGNMENT: usize = 64;
/// Maximum length of a header, bytes. Headers of plain numeric arrays are short.
const MAX_HEADER: u32 = 1 << 16;

/// Unpacked size of all arrays that is allowed for a file of any size, bytes.
const MIN_LIMIT: u64 = 64 << 20;
/// Ratio of unpacked size to file size that is always allowed. Simulation data rarely compress to less than a tenth; a file that
/// expands a thousandfold is a decompression bomb.
const MAX_EXPANSION: u64 = 100;

/// Returns the names of the arrays other than `time`, and their widths.
fn arrays(sizes: Sizes) -> [(&'static str, usize); 4] {
    [("qpos", sizes.nq), ("qvel", sizes.nv), ("act", sizes.na), ("ctrl", sizes.nu)]
}

impl Trajectory {
    /// Writes the records as a NumPy archive (`.npz`), which Python reads with `numpy.load`. It contains the arrays `time` of
    /// shape `(n)`, s, `qpos` `(n, nq)`, `qvel` `(n, nv)`, `act` `(n, na)` and `ctrl` `(n, nu)` for `n` records. Reading the file
    /// restores every value bit for bit.
    ///
    /// Requires the feature `npz`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
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
        // Like `numpy.savez`: uncompressed, with 64-bit sizes.
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

    /// Reads a file written by [`save_npz`](Self::save_npz), or by `numpy.savez` or `numpy.savez_compressed` with these arrays,
    /// for simulations of this model. Other arrays in the file are ignored. The arrays may unpack to 64 MiB, or to a hundred
    /// times the size of the file if that is more, so that a small file cannot exhaust the memory.
    ///
    /// Requires the feature `npz`.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, is a pipe or a device, lacks an array, contains an array whose shape does not
    /// match this model or whose type is not double precision, contains two arrays of the same name, or unpacks to more than the
    /// limit. The message names the array.
    pub fn load_npz(model: &Model, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::read_npz(model, path).map_err(Error::file(path))
    }

    fn read_npz(model: &Model, path: &Path) -> io::Result<Self> {
        let file = file::open_regular(path)?;
        let mut allowed = file.metadata()?.len().saturating_mul(MAX_EXPANSION).max(MIN_LIMIT);
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
                    rows.checked_mul(columns).ok_or_else(|| "fewer values".to_owned())
                }
                _ => Err(format!("({records}, {width}) to match 'time' and this model")),
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

/// Writes an array in the NumPy format: its header and its rows.
fn write_array<'a>(out: &mut impl Write, shape: &str, rows: impl IntoIterator<Item = &'a [f64]>) -> io::Result<()> {
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic string, length of the header, header, and newline.
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

/// Error text for an array whose length disagrees with its shape.
const LENGTH_MISMATCH: &str = "has a length that disagrees with its shape";

/// Reads an array of an archive, and subtracts its size from the allowed bytes. `length` returns the number of values for a
/// shape, or the expected shape if the given one is wrong.
fn read_array(
    archive: &mut ZipArchive<impl Read + Seek>,
    allowed: &mut u64,
    name: &str,
    length: impl FnOnce(&[usize]) -> std::result::Result<usize, String>,
) -> io::Result<Vec<f64>> {
    let invalid = |text: &str| io::Error::new(io::ErrorKind::InvalidData, format!("the array '{name}' {text}"));
    let mut array = archive.by_name(&format!("{name}.npy")).map_err(|error| match error {
        ZipError::FileNotFound => invalid("is missing from the file"),
        error => io::Error::from(error),
    })?;
    let mut start = [0; MAGIC.len()];
    array.read_exact(&mut start)?;
    if start[..6] != MAGIC[..6] {
        return Err(invalid("is not in the NumPy format"));
    }
    let mut size = [0; 4];
    // The length has two bytes in version 1 and four in later versions.
    array.read_exact(&mut size[..if start[6] == 1 { 2 } else { 4 }])?;
    let size = u32::from_le_bytes(size);
    if size > MAX_HEADER {
        return Err(invalid("has an unsupported header"));
    }
    let mut header = vec![0; size as usize];
    array.read_exact(&mut header)?;
    let header =
        Header::parse(&String::from_utf8_lossy(&header)).ok_or_else(|| invalid("has an unsupported header"))?;
    if header.descr != "<f8" {
        return Err(invalid(&format!("has the type '{}', but must have double precision ('<f8')", header.descr)));
    }
    if header.fortran_order {
        return Err(invalid("is in Fortran order, but must be in C order (numpy.ascontiguousarray)"));
    }
    let length = length(&header.shape).map_err(|expected| {
        let shape = header.shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        invalid(&format!("has shape ({shape}), but must have {expected}"))
    })?;
    let size = length.checked_mul(8).ok_or_else(|| invalid("is too large"))?;
    let Some(rest) = allowed.checked_sub(size as u64) else {
        let fits_in_file = size as u64 <= array.size();
        let text =
            format!("unpacks to {size} bytes; the limit for all arrays is {MAX_EXPANSION} times the size of the file");
        return Err(invalid(if fits_in_file { &text } else { LENGTH_MISMATCH }));
    };
    *allowed = rest;
    // The buffer grows with the bytes in the file, regardless of the size in the header.
    let mut bytes = Vec::new();
    array.by_ref().take(size as u64).read_to_end(&mut bytes)?;
    // Reading past the end makes the archive verify its checksum.
    if bytes.len() != size || array.read(&mut [0])? != 0 {
        return Err(invalid(LENGTH_MISMATCH));
    }
    Ok(bytes.as_chunks().0.iter().map(|&value| f64::from_le_bytes(value)).collect())
}

/// Fields of an array's header, which is a Python dictionary literal.
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
    fn headers_are_parsed_in_any_order_and_spacing() {
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
