//! A tolerant tokeniser of XML: positions of tags, attributes and words.

use std::ops::Range;

/// Returns the tags, from `<` to `>`.
pub(super) fn tags(text: &[u8]) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = None;
    for (at, byte) in text.iter().enumerate() {
        match (byte, start) {
            (b'<', _) => start = Some(at),
            (b'>', Some(from)) => {
                found.push(from..at + 1);
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// Returns an element, from a start tag to its end tag.
pub(super) fn element(text: &[u8], tags: &[Range<usize>], first: usize) -> Range<usize> {
    let mut depth = 0_i32;
    for tag in &tags[first..] {
        let content = &text[tag.clone()];
        if content.starts_with(b"</") {
            depth -= 1;
        } else if !content.ends_with(b"/>") && !content.starts_with(b"<!") && !content.starts_with(b"<?") {
            depth += 1;
        }
        if depth <= 0 {
            return tags[first].start..tag.end;
        }
    }
    tags[first].start..text.len()
}

/// An attribute's name, and its value without quotes.
#[derive(Clone)]
pub(super) struct Attribute {
    pub(super) name: Range<usize>,
    pub(super) value: Range<usize>,
}

impl Attribute {
    pub(super) fn whole(&self) -> Range<usize> {
        self.name.start..self.value.end + 1
    }
}

/// Returns the attributes of all tags.
pub(super) fn attributes(text: &[u8]) -> Vec<Attribute> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(equals) = text[at..].iter().position(|&byte| byte == b'=').map(|length| at + length) {
        at = equals + 1;
        let name = text[..equals].iter().rposition(|byte| b" \n\t<>\"'".contains(byte)).map_or(0, |before| before + 1);
        let Some(quote) = text.get(at).filter(|quote| b"\"'".contains(quote)) else { continue };
        let Some(length) = text[at + 1..].iter().position(|byte| byte == quote) else { continue };
        found.push(Attribute { name: name..equals, value: at + 1..at + 1 + length });
        at += length + 2;
    }
    found
}

/// Returns the words of a value.
pub(super) fn words(text: &[u8], value: &Range<usize>) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = None;
    for at in value.clone().chain([value.end]) {
        let is_word = at < value.end && !text[at].is_ascii_whitespace();
        match start {
            None if is_word => start = Some(at),
            Some(from) if !is_word => {
                found.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    found
}
