//! Reading of the archives of trajectories.
//!
//! The crate `zip` reads the archive. The arrays, a text header followed by the values, are parsed
//! here: existing crates allocate the size in the header without a limit, or multiply its
//! dimensions unchecked, so a damaged file could abort the program.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use zip::ZipArchive;
use zip::result::ZipError;

use super::MAGIC;
use crate::zip_file::{self, MAX_EXPANSION};

/// Maximum length of a header, bytes. Headers of plain numeric arrays are short.
const MAX_HEADER: u32 = 1 << 16;

/// Error text for an array whose length disagrees with its shape.
const LENGTH_MISMATCH: &str = "has a length that disagrees with its shape";

/// Opened archive.
pub(crate) struct Archive {
    archive: ZipArchive<BufReader<File>>,
    /// Number of bytes that the remaining arrays may unpack to.
    allowed: u64,
}

impl Archive {
    /// Opens a regular file whose arrays have different names.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let (archive, allowed) = zip_file::open(path)?;
        if archive.has_duplicate_names() {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "two arrays have the same name"));
        }
        Ok(Self { archive, allowed })
    }

    /// Returns `true` if the archive has an array of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.archive.index_for_name(&format!("{name}.npy")).is_some()
    }

    /// Reads an array. `length` returns the number of values for a shape, or the expected shape if
    /// the given one is wrong.
    pub(crate) fn array(
        &mut self,
        name: &str,
        length: impl FnOnce(&[usize]) -> Result<usize, String>,
    ) -> io::Result<Vec<f64>> {
        let invalid = |text: &str| io::Error::new(io::ErrorKind::InvalidData, format!("the array '{name}' {text}"));
        let mut array = self.archive.by_name(&format!("{name}.npy")).map_err(|error| match error {
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
        let Some(rest) = self.allowed.checked_sub(size as u64) else {
            let fits_in_file = size as u64 <= array.size();
            let text = format!(
                "unpacks to {size} bytes; the limit for all arrays is {MAX_EXPANSION} times the size of the file"
            );
            return Err(invalid(if fits_in_file { &text } else { LENGTH_MISMATCH }));
        };
        self.allowed = rest;
        // The buffer grows with the bytes in the file, regardless of the size in the header.
        let mut bytes = Vec::new();
        array.by_ref().take(size as u64).read_to_end(&mut bytes)?;
        // Reading past the end makes the archive verify its checksum.
        if bytes.len() != size || array.read(&mut [0])? != 0 {
            return Err(invalid(LENGTH_MISMATCH));
        }
        Ok(bytes.as_chunks().0.iter().map(|&value| f64::from_le_bytes(value)).collect())
    }
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
