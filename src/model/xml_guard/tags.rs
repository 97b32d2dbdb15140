//! Minimal parser for the tags of a text.

use std::borrow::Cow;
use std::ops::Range;

/// Start tag or end tag.
pub(in crate::model) struct Tag<'t> {
    /// The text from the start of the tag.
    text: &'t [u8],
    pub(super) position: usize,
    pub(in crate::model) name: &'t [u8],
    attributes: Vec<(&'t [u8], &'t [u8])>,
    /// `true` for `</name>`.
    pub(super) closes: bool,
    /// `true` for `<name/>`.
    pub(super) empty: bool,
}

impl<'t> Tag<'t> {
    pub(super) fn attribute(&self, name: &[u8]) -> Option<Cow<'t, [u8]>> {
        self.attributes.iter().find(|(found, _)| *found == name).map(|(_, value)| decoded(value))
    }

    /// Returns the names and the values of all attributes, with references.
    pub(super) fn attributes(&self) -> impl Iterator<Item = (&'t [u8], &'t [u8])> {
        self.attributes.iter().copied()
    }

    /// Returns the range of an attribute's value in the text, without the quotes.
    pub(in crate::model) fn attribute_range(&self, name: &[u8]) -> Option<Range<usize>> {
        let (_, value) = self.attributes.iter().find(|(found, _)| *found == name)?;
        let start = self.position + (value.as_ptr() as usize - self.text.as_ptr() as usize);
        Some(start..start + value.len())
    }

    /// Returns the integer in an attribute as `scanf` reads it, up to the first character that is
    /// not a digit. Returns `None` if the attribute is missing or has no integer, or if the integer
    /// does not fit into a C int.
    pub(super) fn integer(&self, name: &[u8]) -> Option<i32> {
        let value = self.attribute(name)?;
        let space = value.iter().take_while(|&&byte| is_space(byte)).count();
        let sign = usize::from(matches!(value.get(space), Some(b'+' | b'-')));
        let digits = value[space + sign..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        std::str::from_utf8(&value[space..space + sign + digits]).ok()?.parse().ok()
    }
}

/// Iterator over the tags of a text. It skips malformed parts, which the compiler's parser rejects.
pub(in crate::model) struct Tags<'t>(&'t [u8], usize);

impl<'t> Tags<'t> {
    pub(in crate::model) fn new(text: &'t [u8]) -> Self {
        Self(text, 0)
    }
}

impl<'t> Iterator for Tags<'t> {
    type Item = Tag<'t>;

    fn next(&mut self) -> Option<Tag<'t>> {
        loop {
            let Self(text, from) = *self;
            let position = from + text[from..].iter().position(|&byte| byte == b'<')?;
            let rest = &text[position..];
            let not_a_tag = [(&b"<!--"[..], &b"-->"[..]), (b"<![CDATA[", b"]]>"), (b"<!", b">"), (b"<?", b"?>")];
            if let Some((begin, end)) = not_a_tag.into_iter().find(|(begin, _)| rest.starts_with(begin)) {
                let length = rest[begin.len()..].windows(end.len()).position(|window| window == end)?;
                self.1 = position + begin.len() + length + end.len();
                continue;
            }
            let (tag, length) = tag(rest, position);
            self.1 = position + length;
            return Some(tag);
        }
    }
}

/// Parses the tag at the start of `text`, and returns it with its length.
fn tag(text: &[u8], position: usize) -> (Tag<'_>, usize) {
    let closes = text.get(1) == Some(&b'/');
    let mut at = 1 + usize::from(closes);
    let word = |at: &mut usize| {
        let start = *at;
        while text.get(*at).is_some_and(|&byte| !is_space(byte) && !b"/>=\"'<".contains(&byte)) {
            *at += 1;
        }
        &text[start..*at]
    };
    let space = |at: &mut usize| {
        while text.get(*at).is_some_and(|&byte| is_space(byte)) {
            *at += 1;
        }
    };
    let mut tag = Tag { text, position, name: word(&mut at), attributes: Vec::new(), closes, empty: false };
    loop {
        space(&mut at);
        let name = word(&mut at);
        space(&mut at);
        match text.get(at) {
            Some(b'=') if !name.is_empty() => {
                at += 1;
                space(&mut at);
                let Some(&quote) = text.get(at).filter(|quote| b"\"'".contains(quote)) else { break };
                let Some(length) = text[at + 1..].iter().position(|&byte| byte == quote) else { break };
                tag.attributes.push((name, &text[at + 1..][..length]));
                at += length + 2;
            }
            Some(b'/') => {
                at += 1;
                tag.empty = text.get(at) == Some(&b'>');
            }
            _ => break,
        }
    }
    (tag, at.max(1))
}

/// Returns `true` for the whitespace of C's `isspace`, which the compiler's parser uses.
fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// Parses the integers in a list. Items that are not integers are `None`.
pub(super) fn numbers(list: &[u8]) -> impl Iterator<Item = Option<i64>> {
    list.split(|&byte| is_space(byte))
        .filter(|word| !word.is_empty())
        .map(|word| std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()))
}

/// Decodes the entity and character references in an attribute value by the rules of the compiler's
/// parser.
pub(in crate::model) fn decoded(value: &[u8]) -> Cow<'_, [u8]> {
    const ENTITIES: [(&[u8], u8); 5] =
        [(b"quot;", b'"'), (b"apos;", b'\''), (b"lt;", b'<'), (b"gt;", b'>'), (b"amp;", b'&')];
    if !value.contains(&b'&') {
        return Cow::Borrowed(value);
    }
    let mut result = Vec::with_capacity(value.len());
    let mut rest = value;
    while let Some((&byte, tail)) = rest.split_first() {
        rest = tail;
        if byte != b'&' {
            result.push(byte);
        } else if let Some((name, byte)) = ENTITIES.iter().find(|(name, _)| tail.starts_with(name)) {
            result.push(*byte);
            rest = &tail[name.len()..];
        } else if let Some((character, length)) = reference(tail) {
            result.extend(character.encode_utf8(&mut [0; 4]).as_bytes());
            rest = &tail[length..];
        } else {
            result.push(byte);
        }
    }
    Cow::Owned(result)
}

/// Parses a character reference `#65;` or `#x41;`. Returns the character and the length of the
/// reference.
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

#[cfg(test)]
mod tests {
    use super::{Tags, decoded};

    #[test]
    fn attributes_are_counted_and_comments_are_skipped() {
        let text = b"<?xml version='1.0'?><!-- text - <no file=''/> --><a b = \"c>d\"\x0be='f'>text</a ><![CDATA[text <x>]]><g/>";
        let tags: Vec<_> =
            Tags::new(text).map(|tag| (tag.name.to_vec(), tag.attributes.len(), tag.closes, tag.empty)).collect();
        assert_eq!(
            tags,
            [(b"a".to_vec(), 2, false, false), (b"a".to_vec(), 0, true, false), (b"g".to_vec(), 0, false, true)]
        );
    }

    #[test]
    fn references_are_decoded_once() {
        for (value, expected) in [
            ("a&amp;lt;b", "a&lt;b"),
            ("&#46;&#x2f;&quot;", "./\""),
            ("&#xe4;", "ä"),
            ("&#; &#x; &#1114112; &nbsp; &", "&#; &#x; &#1114112; &nbsp; &"),
        ] {
            assert_eq!(*decoded(value.as_bytes()), *expected.as_bytes(), "{value}");
        }
    }
}
