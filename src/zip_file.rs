//! ZIP archives, which may be decompression bombs.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use zip::ZipArchive;

use crate::file;

/// Unpacked size of all files that is allowed for an archive of any size, bytes.
const MIN_LIMIT: u64 = 64 << 20;
/// Ratio of unpacked size to file size that is always allowed. Simulation data rarely compress to
/// less than a tenth, as do meshes in text; a file that expands a thousandfold is a decompression
/// bomb.
pub(crate) const MAX_EXPANSION: u64 = 100;

/// Opens a regular file. Returns the archive, and the number of bytes that its files may unpack to.
pub(crate) fn open(path: &Path) -> io::Result<(ZipArchive<BufReader<File>>, u64)> {
    let file = file::open_regular(path)?;
    let allowed = file.metadata()?.len().saturating_mul(MAX_EXPANSION).max(MIN_LIMIT);
    Ok((ZipArchive::new(BufReader::new(file))?, allowed))
}
