//! Texts that the engine's reader accepts and that are not XML.

/// Character for colons in names.
pub(super) const COLON: char = '꞉';

/// Returns a text with the same elements as XML, in the same lines:
///
/// - comments, also those with `--` in them, declarations and `<!DOCTYPE …>` become blanks,
/// - colons in names become [`COLON`], because their prefixes can be unknown,
/// - `&` that starts no reference, and `<` in values of attributes, become references,
/// - what follows the first element is removed.
pub(super) fn to_xml(text: &str) -> String {
    let mut xml = String::new();
    let mut rest = text;
    let mut depth = 0_usize;
    while let Some(start) = rest.find('<') {
        push_text(&rest[..start], false, &mut xml);
        rest = &rest[start..];
        let ignored = [("<!--", "-->"), ("<?", "?>")].into_iter().find(|(open, _)| rest.starts_with(open));
        let ignored = ignored.or_else(|| {
            (rest.starts_with("<!") && !rest.starts_with("<![CDATA[")).then(|| ("<!", end_of_declaration(rest)))
        });
        if let Some((open, close)) = ignored {
            let Some(end) = rest[open.len()..].find(close) else { break };
            let (comment, after) = rest.split_at(open.len() + end + close.len());
            xml.extend(comment.chars().map(|character| if character == '\n' { '\n' } else { ' ' }));
            rest = after;
            continue;
        }
        if rest.starts_with("<![CDATA[") {
            let Some(end) = rest.find("]]>") else { break };
            let (data, after) = rest.split_at(end + "]]>".len());
            xml += data;
            rest = after;
            continue;
        }
        let Some(end) = end_of_tag(rest) else { break };
        let (tag, after) = rest.split_at(end);
        push_tag(tag, &mut xml);
        rest = after;
        if tag.starts_with("</") {
            depth = depth.saturating_sub(1);
        } else if !tag.ends_with("/>") {
            depth += 1;
        }
        if depth == 0 {
            return xml;
        }
    }
    xml + rest
}

/// Returns the end of a declaration, which can have others in brackets.
fn end_of_declaration(text: &str) -> &'static str {
    let start = text.split('>').next().unwrap_or_default();
    if start.starts_with("<!DOCTYPE") && start.contains('[') && text.contains("]>") { "]>" } else { ">" }
}

/// Returns the length of a tag, in which values can contain `>`.
fn end_of_tag(text: &str) -> Option<usize> {
    let mut quote = None;
    for (position, character) in text.char_indices() {
        match (quote, character) {
            (None, '\'' | '"') => quote = Some(character),
            (Some(open), _) if open == character => quote = None,
            (None, '>') => return Some(position + 1),
            _ => {}
        }
    }
    None
}

fn push_tag(tag: &str, xml: &mut String) {
    let mut characters = tag.chars();
    xml.extend(characters.next());
    push_text(characters.as_str(), true, xml);
}

/// Appends text or the content of a tag, without markup.
fn push_text(text: &str, is_tag: bool, xml: &mut String) {
    let mut quote = None;
    // The engine's reader puts another character in the place of `&` after a reference or a line
    // break of Windows in the same value.
    let mut is_shifted = false;
    for (position, character) in text.char_indices() {
        let starts_reference = is_reference(&text[position..]);
        match character {
            '<' => *xml += "&lt;",
            ':' if is_tag && quote.is_none() => xml.push(COLON),
            '&' if !starts_reference && !is_shifted => *xml += "&amp;",
            _ => xml.push(character),
        }
        match (quote, character) {
            (None, '\'' | '"') => quote = Some(character),
            (Some(open), _) if open == character => (quote, is_shifted) = (None, false),
            _ => is_shifted |= character == '\r' || starts_reference,
        }
    }
}

/// Returns `true` if a text starts with a reference that all readers know.
fn is_reference(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('&') else { return false };
    let Some((end, _)) = rest.char_indices().take(64).find(|(_, character)| *character == ';') else { return false };
    let name = &rest[..end];
    let is_number = |digits: &str, radix| !digits.is_empty() && digits.chars().all(|digit| digit.is_digit(radix));
    match name.strip_prefix('#') {
        Some(number) => number.strip_prefix('x').map_or_else(|| is_number(number, 10), |digits| is_number(digits, 16)),
        None => matches!(name, "amp" | "lt" | "gt" | "quot" | "apos"),
    }
}
