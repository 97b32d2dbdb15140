//! Where the compiler looks for the files that a text names.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::Path;

/// Where the compiler will look for files.
pub(in crate::model) enum Files<'f> {
    /// In memory, by their names without a path, and then on the disk.
    Memory(&'f [(&'f str, &'f [u8])]),
    /// On the disk, behind the directory of this file.
    Disk(&'f Path),
}

/// What is behind a name.
pub(super) enum Found<'f> {
    /// Nothing that can be read, which the compiler will tell.
    Nothing,
    /// A pipe, a device or a directory, at which the compiler could wait for ever.
    Irregular,
    Content(Cow<'f, [u8]>),
}

impl<'f> Files<'f> {
    /// The directory that names are relative to.
    pub(super) fn directory(&self) -> &[u8] {
        match self {
            Self::Memory(_) => b"",
            Self::Disk(file) => directory(path_bytes(file)),
        }
    }

    /// What the compiler will find under a path.
    pub(super) fn find(&self, path: &[u8]) -> Found<'f> {
        if let Self::Memory(files) = self {
            let found = files.iter().find(|(file, _)| last_part(file.as_bytes()).eq_ignore_ascii_case(last_part(path)));
            if let Some((_, content)) = found {
                return Found::Content(Cow::Borrowed(content));
            }
        }
        match std::fs::metadata(os_path(path)) {
            Ok(data) if !data.is_file() => Found::Irregular,
            Ok(_) => std::fs::read(os_path(path)).map_or(Found::Nothing, |content| Found::Content(Cow::Owned(content))),
            Err(_) => Found::Nothing,
        }
    }

    /// The path of an asset, which may be behind a directory that the text gives.
    pub(super) fn asset_path(&self, folder: &[u8], name: &[u8]) -> Vec<u8> {
        let slash: &[u8] = if matches!(folder.last(), None | Some(b'/' | b'\\')) { b"" } else { b"/" };
        if is_absolute(name) {
            name.to_owned()
        } else if is_absolute(folder) {
            [folder, slash, name].concat()
        } else {
            [self.directory(), folder, slash, name].concat()
        }
    }
}

/// What the compiler takes for an absolute path.
fn is_absolute(path: &[u8]) -> bool {
    matches!(path.first(), Some(b'/' | b'\\')) || path.windows(2).any(|pair| pair == b":/" || pair == b":\\")
}

/// Whether there is something, and it is a pipe or a device.
pub(super) fn is_irregular(path: &[u8]) -> bool {
    std::fs::metadata(os_path(path)).is_ok_and(|data| !data.is_file() && !data.is_dir())
}

/// Everything up to the last slash.
pub(super) fn directory(path: &[u8]) -> &[u8] {
    &path[..path.len() - last_part(path).len()]
}

/// Everything behind the last slash.
pub(super) fn last_part(path: &[u8]) -> &[u8] {
    path.rsplit(|byte| b"/\\".contains(byte)).next().unwrap_or_default()
}

pub(super) fn shown(name: &[u8]) -> String {
    String::from_utf8_lossy(name).chars().take(60).collect()
}

/// The value of an attribute, with references to entities and characters replaced as the compiler's parser does it.
pub(super) fn decoded(value: &[u8]) -> Vec<u8> {
    const ENTITIES: [(&[u8], u8); 5] =
        [(b"quot;", b'"'), (b"apos;", b'\''), (b"lt;", b'<'), (b"gt;", b'>'), (b"amp;", b'&')];
    let mut result = Vec::with_capacity(value.len());
    let mut rest = value;
    while let Some((&byte, behind)) = rest.split_first() {
        rest = behind;
        if byte != b'&' {
            result.push(byte);
        } else if let Some((name, byte)) = ENTITIES.iter().find(|(name, _)| behind.starts_with(name)) {
            result.push(*byte);
            rest = &behind[name.len()..];
        } else if let Some((character, length)) = reference(behind) {
            result.extend(character.encode_utf8(&mut [0; 4]).as_bytes());
            rest = &behind[length..];
        } else {
            result.push(byte);
        }
    }
    result
}

/// The character of `#65;` or `#x41;`, and the length of that.
fn reference(text: &[u8]) -> Option<(char, usize)> {
    let digits = text.strip_prefix(b"#")?;
    let end = digits.iter().take(12).position(|&byte| byte == b';')?;
    let digits = std::str::from_utf8(&digits[..end]).ok()?;
    let code = match digits.strip_prefix('x') {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => digits.parse(),
    };
    Some((char::from_u32(code.ok()?)?, end + 2))
}

#[cfg(unix)]
pub(super) fn path_bytes(path: &Path) -> &[u8] {
    std::os::unix::ffi::OsStrExt::as_bytes(path.as_os_str())
}

#[cfg(unix)]
pub(super) fn os_path(path: &[u8]) -> &Path {
    Path::new(<OsStr as std::os::unix::ffi::OsStrExt>::from_bytes(path))
}

#[cfg(not(unix))]
pub(super) fn path_bytes(path: &Path) -> &[u8] {
    path.to_str().unwrap_or_default().as_bytes()
}

#[cfg(not(unix))]
pub(super) fn os_path(path: &[u8]) -> &Path {
    Path::new(OsStr::new(std::str::from_utf8(path).unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::decoded;

    #[test]
    fn references_are_replaced_once() {
        for (value, expected) in [
            ("a&amp;lt;b", "a&lt;b"),
            ("&#46;&#x2f;&quot;", "./\""),
            ("&#xe4;", "ä"),
            ("&#; &#x; &#1114112; &nbsp; &", "&#; &#x; &#1114112; &nbsp; &"),
        ] {
            assert_eq!(decoded(value.as_bytes()), expected.as_bytes(), "{value}");
        }
    }
}
