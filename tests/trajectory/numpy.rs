//! NumPy archives read by other code than this crate's.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use zip::ZipArchive;

/// Reads an array according to the format's specification: magic string, version, length of the
/// header, header, values. Returns the header and the bytes of the values.
pub(crate) fn array(path: &Path, name: &str) -> (String, Vec<u8>) {
    let mut archive = ZipArchive::new(File::open(path).unwrap()).unwrap();
    let mut bytes = Vec::new();
    archive.by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert!(start.is_multiple_of(64) && bytes[start - 1] == b'\n');
    let header = String::from_utf8(bytes[10..start].to_vec()).unwrap().trim_end().to_owned();
    (header, bytes[start..].to_vec())
}

/// Runs a Python script with NumPy, whose argument is a path, and returns its output. `None` if the
/// tests may pass without NumPy.
pub(crate) fn python(script: &str, path: &Path) -> Option<String> {
    crate::python::run("python3-numpy", "numpy", script, path)
}
