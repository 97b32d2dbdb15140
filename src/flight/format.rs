//! Primitive parts of the file: numbers, blocks of bytes and texts.

use std::fmt;

use crate::error::Error;

/// Defect of a recording, and its place in bytes.
#[derive(Debug)]
pub(super) struct Invalid {
    pub(super) reason: String,
}

impl Invalid {
    /// Returns the error with the name of the source.
    pub(super) fn of(self, source_name: &str) -> Error {
        Error::InvalidRecording { source_name: source_name.to_owned(), reason: self.reason }
    }
}

/// Reads parts from untrusted bytes.
#[derive(Clone)]
pub(super) struct Reader<'b> {
    rest: &'b [u8],
    /// Place of `rest`, for errors.
    at: usize,
}

impl<'b> Reader<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Self { rest: bytes, at: 0 }
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.rest.is_empty()
    }

    /// Returns the error about a value that was just read.
    pub(super) fn invalid(&self, reason: impl fmt::Display) -> Invalid {
        Invalid { reason: format!("{reason}, before byte {}", self.at) }
    }

    /// Returns the next bytes, without a copy.
    pub(super) fn take(&mut self, count: usize, what: &str) -> Result<&'b [u8], Invalid> {
        let Some((bytes, rest)) = self.rest.split_at_checked(count) else {
            let reason = format!("{what} at byte {} needs {count} bytes, but {} remain", self.at, self.rest.len());
            return Err(Invalid { reason });
        };
        (self.rest, self.at) = (rest, self.at + count);
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Invalid> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    pub(super) fn u8(&mut self) -> Result<u8, Invalid> {
        Ok(u8::from_le_bytes(self.array("a byte")?))
    }

    pub(super) fn u32(&mut self) -> Result<u32, Invalid> {
        Ok(u32::from_le_bytes(self.array("a number")?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, Invalid> {
        Ok(u64::from_le_bytes(self.array("a number")?))
    }

    /// Returns a block of bytes, which has its length before it.
    pub(super) fn block(&mut self, what: &str) -> Result<&'b [u8], Invalid> {
        let length = usize::try_from(self.u64()?).unwrap_or(usize::MAX);
        self.take(length, what)
    }

    /// Returns a text, which is a block.
    pub(super) fn text(&mut self, what: &str) -> Result<&'b str, Invalid> {
        let bytes = self.block(what)?;
        str::from_utf8(bytes).map_err(|_| self.invalid(format!("{what} is not UTF-8")))
    }
}

/// Writes a block of bytes.
pub(super) trait Block {
    fn put_block(&mut self, bytes: &[u8]);
}

impl Block for Vec<u8> {
    fn put_block(&mut self, bytes: &[u8]) {
        self.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.extend_from_slice(bytes);
    }
}
