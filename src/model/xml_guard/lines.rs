//! Lines and words of asset files in text formats.

/// Returns the lines of a text without leading whitespace.
pub(super) fn lines(content: &[u8]) -> impl Iterator<Item = &[u8]> {
    content.split(|byte| b"\n\r".contains(byte)).map(<[u8]>::trim_ascii_start)
}

/// Returns the rest of a line that starts with a word.
pub(super) fn after_word<'l>(line: &'l [u8], word: &[u8]) -> Option<&'l [u8]> {
    line.strip_prefix(word).filter(|rest| matches!(rest.first(), Some(b' ' | b'\t')))
}

/// Returns the words of a line.
pub(super) fn fields(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty())
}
