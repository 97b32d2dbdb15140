//! Control characters in attributes. XML has no form for most of them, but the engine reads
//! references such as `&#1;` and writes the characters themselves, so names in models can have
//! them.

/// First of the private characters that represent control characters while a text is parsed as XML.
const HIDDEN: u32 = 0xF_0000;
/// Number of these characters.
const NUMBER: u32 = 0x22;

/// Returns `true` for a character that XML excludes.
pub(super) fn is_not_xml(character: char) -> bool {
    (character < ' ' && !matches!(character, '\t' | '\n' | '\r')) || matches!(character, '\u{FFFE}' | '\u{FFFF}')
}

/// Replaces the characters that XML excludes, and references to them, by private characters.
/// Returns `None` if there are none, and an error if a replacement is not possible.
pub(super) fn hide(text: &str) -> Result<Option<String>, String> {
    let mut hidden = String::new();
    let mut rest = text;
    while let Some(position) = rest.find(|character| character == '&' || is_not_xml(character)) {
        let found = &rest[position..];
        let reference = reference(found).filter(|&(character, _)| is_not_xml(character));
        let raw =
            found.chars().next().filter(|&character| is_not_xml(character)).map(|found| (found, found.len_utf8()));
        let (shown, length) = match reference.or(raw) {
            None => ("&".to_owned(), 1),
            Some(('\0', _)) => return Err("the text has a NUL character".to_owned()),
            Some((character, length)) => (private(character).to_string(), length),
        };
        hidden += &rest[..position];
        hidden += &shown;
        rest = &found[length..];
    }
    hidden += rest;
    if hidden == text {
        return Ok(None);
    }
    if text.contains(is_hidden) {
        return Err(format!("the text has control characters and private characters such as U+{HIDDEN:X}"));
    }
    Ok(Some(hidden))
}

/// Restores the characters that were hidden.
pub(super) fn show(value: &str) -> String {
    value.chars().map(|character| if is_hidden(character) { original(character) } else { character }).collect()
}

/// Returns the character of a numeric reference at the start of a text, and its length.
fn reference(text: &str) -> Option<(char, usize)> {
    let digits = text.strip_prefix("&#")?;
    let end = digits.find(';')?;
    let number = match digits[..end].strip_prefix('x') {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => digits[..end].parse(),
    };
    Some((char::from_u32(number.ok()?)?, "&#".len() + end + 1))
}

fn private(character: char) -> char {
    let offset = match character {
        '\u{FFFE}' => NUMBER - 2,
        '\u{FFFF}' => NUMBER - 1,
        control => u32::from(control),
    };
    char::from_u32(HIDDEN + offset).unwrap_or(character)
}

fn original(character: char) -> char {
    let offset = u32::from(character) - HIDDEN;
    char::from_u32(if offset < NUMBER - 2 { offset } else { 0xFFFE + offset - (NUMBER - 2) }).unwrap_or(character)
}

fn is_hidden(character: char) -> bool {
    (HIDDEN..HIDDEN + NUMBER).contains(&u32::from(character))
}
