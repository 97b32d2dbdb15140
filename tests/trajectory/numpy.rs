//! NumPy archives read by other code than this crate's.

use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::Command;

use zip::ZipArchive;

use crate::installed::has;

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

/// Runs a Python script, whose argument is a path, and returns its output. The interpreter is the
/// first of `$PYTHON`, `python3` and that of the system which has NumPy. `None` if the tests may
/// pass without NumPy.
pub(crate) fn python(script: &str, path: &Path) -> Option<String> {
    let run = |python: &OsStr, script: &str| Command::new(python).arg("-c").arg(script).arg(path).output();
    let named = std::env::var_os("PYTHON");
    let all = named.into_iter().chain(["python3", "/usr/bin/python3"].map(OsString::from));
    let mut fit = all.filter(|python| run(python, "import numpy").is_ok_and(|output| output.status.success()));
    let python = fit.next();
    has("python3-numpy", python.is_some());
    let output = run(&python?, script).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}
