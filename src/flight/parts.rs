//! Parts of files: values in the encoding of the crate `postcard`, each with its length before and
//! its checksum after it.

use std::io::{self, ErrorKind, Read, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::change::Checksum;
use crate::error::{Error, Result};

/// Version of all formats.
pub(super) const VERSION: u32 = 3;
/// Largest size of a part in bytes.
const MOST_BYTES: u64 = 1 << 31;

/// Writes the begin of a file.
pub(super) fn put_begin(out: &mut impl Write, magic: [u8; 8]) -> io::Result<()> {
    out.write_all(&magic)?;
    out.write_all(&VERSION.to_le_bytes())
}

/// Writes a part.
pub(super) fn put(out: &mut impl Write, part: &impl Serialize) -> io::Result<()> {
    let bytes = postcard::to_stdvec(part).expect("Bug: a part of a file has no encoding");
    out.write_all(&(bytes.len() as u64).to_le_bytes())?;
    out.write_all(&bytes)?;
    out.write_all(&Checksum::of_bytes(&bytes).to_le_bytes())
}

/// Reads the begin of a file, which is not trusted.
pub(super) fn read_begin(source: &mut impl Read, magic: [u8; 8], name: &str) -> Result<()> {
    if array(source, name).ok() != Some(magic) {
        return Err(invalid(name, format!("it does not begin with {}", magic.escape_ascii())));
    }
    let version = u32::from_le_bytes(array(source, name)?);
    if version != VERSION {
        return Err(invalid(name, format!("format {version}, but this version of the crate reads {VERSION}")));
    }
    Ok(())
}

/// Reads the next part, which is not trusted. Memory grows with the bytes of the source.
pub(super) fn read<T: DeserializeOwned>(source: &mut impl Read, name: &str) -> Result<T> {
    let length = u64::from_le_bytes(array(source, name)?);
    if length > MOST_BYTES {
        return Err(invalid(name, format!("a part has {length} bytes, more than {MOST_BYTES}")));
    }
    let mut bytes = Vec::new();
    source.by_ref().take(length).read_to_end(&mut bytes).map_err(Error::file(name))?;
    // The checksum finds accidental damage. Every value is checked besides.
    if u64::from_le_bytes(array(source, name)?) != Checksum::of_bytes(&bytes) {
        return Err(invalid(name, "a checksum is wrong: it is damaged"));
    }
    let mut decoder = postcard::Deserializer::from_bytes(&bytes);
    let part = T::deserialize(&mut decoder);
    let rest = decoder.finalize().map_or(0, <[u8]>::len);
    let place = bytes.len() - rest;
    match part {
        Ok(part) if rest == 0 => Ok(part),
        Ok(_) => Err(invalid(name, format!("a part ends at byte {place}, and {rest} bytes follow"))),
        Err(error) => Err(invalid(name, format!("{error}, at byte {place} of a part"))),
    }
}

/// Returns the error about a file with a defect.
pub(super) fn invalid(name: &str, reason: impl Into<String>) -> Error {
    Error::InvalidRecording { source_name: name.to_owned(), reason: reason.into() }
}

fn array<const N: usize>(source: &mut impl Read, name: &str) -> Result<[u8; N]> {
    let mut bytes = [0; N];
    match source.read_exact(&mut bytes) {
        Ok(()) => Ok(bytes),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Err(invalid(name, "it is incomplete")),
        Err(error) => Err(Error::file(name)(error)),
    }
}
