//! The numbers of the engine's text in their shortest form.
//!
//! The engine prints 17 significant digits, which every double survives: 0.1 as 0.10000000000000001, and 0.8 in single
//! precision as 0.80000001192092896. The shortest digits that load as the same number are 0.1 and 0.8.

/// Attributes that the engine keeps in single precision, in every element that has them.
const SINGLE: [&str; 12] = [
    "rgba",
    "ambient",
    "diffuse",
    "specular",
    "attenuation",
    "exponent",
    "emission",
    "shininess",
    "reflectance",
    "texrepeat",
    "bindpos",
    "bindquat",
];
/// Elements whose real attributes are all in single precision: those of `<visual>`.
const SINGLE_ELEMENTS: [&str; 5] = ["global", "headlight", "map", "scale", "rgba"];

/// Shortens the numbers in all attributes.
pub(super) fn shorten(text: Vec<u8>) -> Vec<u8> {
    // The engine's own text is UTF-8 if the names in it are.
    let text = match String::from_utf8(text) {
        Ok(text) => text,
        Err(error) => return error.into_bytes(),
    };
    let mut out = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(start) = rest.find('<') {
        let end = match rest[start..].strip_prefix("<!--") {
            Some(comment) => comment.find("-->").map(|length| start + 4 + length),
            None => rest[start..].find('>').map(|length| start + length),
        };
        let Some(end) = end else { break };
        out.push_str(&rest[..start]);
        shorten_tag(&rest[start..end], &mut out);
        rest = &rest[end..];
    }
    out.push_str(rest);
    out.into_bytes()
}

/// Shortens the numbers of a tag. In a comment and a custom text, every character counts.
fn shorten_tag(tag: &str, out: &mut String) {
    let element = tag[1..].split([' ', '/']).next().unwrap_or_default();
    if element.starts_with('!') || element == "text" {
        out.push_str(tag);
        return;
    }
    // Behind every other quote is a value, and before it the attribute.
    let mut attribute = "";
    for (index, part) in tag.split('"').enumerate() {
        if index > 0 {
            out.push('"');
        }
        if index % 2 == 0 {
            attribute = part.trim_matches([' ', '=']).rsplit(' ').next().unwrap_or_default();
            out.push_str(part);
            continue;
        }
        let single = SINGLE.contains(&attribute)
            || SINGLE_ELEMENTS.contains(&element)
            || (element, attribute) == ("light", "cutoff");
        for (index, token) in part.split(' ').enumerate() {
            if index > 0 {
                out.push(' ');
            }
            match shortest(token, single) {
                Some(short) => out.push_str(&short),
                None => out.push_str(token),
            }
        }
    }
}

/// Returns a shorter form of a number, if it has so many digits that they may be those of 17-digit printing.
fn shortest(token: &str, single: bool) -> Option<String> {
    const LEAST_DIGITS: usize = 9;
    let digits = token.split('e').next()?.bytes().filter(u8::is_ascii_digit).count();
    if digits < LEAST_DIGITS || !token.contains(['.', 'e']) {
        return None;
    }
    let value: f64 = token.parse().ok().filter(|value: &f64| value.is_finite())?;
    let rounded = value as f32;
    let (plain, scientific) = if single && f64::from(rounded) == value {
        (format!("{rounded}"), format!("{rounded:e}"))
    } else {
        (format!("{value}"), format!("{value:e}"))
    };
    let short = if scientific.len() < plain.len() { scientific } else { plain };
    (short.len() < token.len()).then_some(short)
}

#[cfg(test)]
mod tests {
    use super::shorten;

    #[test]
    fn numbers_lose_digits_and_nothing_else_does() {
        for (text, expected) in [
            (r#"<a pos="0.10000000000000001 -3"/>"#, r#"<a pos="0.1 -3"/>"#),
            (r#"<a pos="1.0000000000000001e-09"/>"#, r#"<a pos="1e-9"/>"#),
            (r#"<a pos="0.80000001192092896"/>"#, r#"<a pos="0.800000011920929"/>"#),
            (r#"<geom name="b 1" rgba="0.80000001192092896 1"/>"#, r#"<geom name="b 1" rgba="0.8 1"/>"#),
            (r#"<light cutoff="0.80000001192092896"/>"#, r#"<light cutoff="0.8"/>"#),
            (r#"<text data="0.10000000000000001"/>"#, r#"<text data="0.10000000000000001"/>"#),
            (r#"<!-- <a b="0.10000000000000001"/> --><c/>"#, r#"<!-- <a b="0.10000000000000001"/> --><c/>"#),
            ("<a b=\"-2147483648 1234567890\"", "<a b=\"-2147483648 1234567890\""),
            ("", ""),
        ] {
            assert_eq!(String::from_utf8(shorten(text.as_bytes().to_vec())).unwrap(), expected);
        }
        let bytes = b"<a b=\"0.10000000000000001 \xff\"/>".to_vec();
        assert_eq!(shorten(bytes.clone()), bytes);
    }
}
