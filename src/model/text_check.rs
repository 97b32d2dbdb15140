//! A look at model texts before the engine's compiler sees them, for what makes it crash, raise a fatal error while it holds
//! its lock, or read standard input. What a look at the text cannot see stays the compiler's: see
//! [`Model::from_xml_str`](super::Model::from_xml_str).

use std::borrow::Cow;
use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::Path;

use crate::error::{Error, Result};

/// How deep files may include each other, and elements be nested over all of them. The compiler recurses, and a file in every
/// file ends the stack of a thread.
const MOST_INCLUDED: usize = 50;
const MOST_NESTED: usize = 400;
/// Bytes of a file name; the engine's limit is 999.
const LONGEST_NAME: usize = 900;
/// Bodies, and degrees of freedom: the engine counts pairs of them with a C int, and writes before its stack when that
/// overflows.
const MOST_BODIES: usize = 40_000;
/// The least room for constraints that a text with adhesion may give. The compiler takes a step, in which each contact needs
/// up to ten (see `hazard.rs`).
const LEAST_NJMAX: i64 = 100;
/// Numbers in the image of a texture or in a height field.
const MOST_NUMBERS: u64 = 500_000_000;

/// Where the compiler will look for included files.
pub(super) enum Files<'f> {
    /// In memory, by their names without a path, and then on the disk.
    Memory(&'f [(&'f str, &'f [u8])]),
    /// On the disk, behind the directory of this file.
    Disk(&'f Path),
}

/// Refuses what the compiler must not see in this text, or in the texts that it includes.
pub(super) fn check(source_name: &str, text: &[u8], files: &Files<'_>) -> Result<()> {
    let mut check = Check {
        files,
        seen: HashSet::new(),
        bodies: 0,
        dofs: 0,
        joints: Vec::new(),
        little_room: false,
        adhesion: false,
    };
    check.text(source_name, text, 0)?;
    // The compiler takes a step, so that a look at the compiled model comes too late.
    if check.adhesion && check.little_room {
        let message = format!(
            "adhesion needs room for at least {LEAST_NJMAX} constraints (njmax), or for as many as the compiler finds"
        );
        return Err(Error::Load { source_name: source_name.to_owned(), message });
    }
    Ok(())
}

struct Check<'f> {
    files: &'f Files<'f>,
    /// The files that were included. The compiler refuses one that comes twice, so it is not looked at again.
    seen: HashSet<Vec<u8>>,
    bodies: usize,
    dofs: usize,
    /// The joints of the fixed tendon that was begun last.
    joints: Vec<Vec<u8>>,
    /// Whether there is little room for constraints.
    little_room: bool,
    /// Whether there is an actuator on a body.
    adhesion: bool,
}

impl<'f> Check<'f> {
    /// The depth of the deepest element.
    fn text(&mut self, source_name: &str, text: &[u8], included: usize) -> Result<usize> {
        let refuse = |position: usize, why: &str| {
            let line = text[..position].split(|&byte| byte == b'\n').count();
            Err(Error::Load { source_name: source_name.to_owned(), message: format!("{why}, line {line}") })
        };
        if let Some(position) = text.iter().position(|&byte| byte == 0) {
            return refuse(position, "the text has a NUL byte, at which the compiler would stop reading");
        }
        let (mut depth, mut deepest) = (0, 0);
        for tag in Tags(text, 0) {
            let is = |name: &[u8]| tag.name.eq_ignore_ascii_case(name);
            if tag.closes {
                depth -= usize::from(depth > 0);
                continue;
            }
            deepest = deepest.max(depth + 1);
            let file = tag.attribute(b"file");
            if let Some(why) = file.and_then(|name| self.bad_name(name)).or_else(|| bad_sizes(&tag)) {
                return refuse(tag.position, &why);
            }
            if let Some(name) = file.filter(|_| is(b"include")) {
                if included >= MOST_INCLUDED {
                    return refuse(tag.position, &format!("more than {MOST_INCLUDED} files include each other"));
                }
                let Ok(content) = self.included(name) else {
                    return refuse(tag.position, &format!("'{}' is not a regular file", shown(name)));
                };
                if let Some(content) = content {
                    let inner = self.text(&String::from_utf8_lossy(name), &content, included + 1)?;
                    deepest = deepest.max(depth + inner);
                }
            }
            if self.is_repeated(&tag) {
                return refuse(
                    tag.position,
                    "a fixed tendon has the same joint twice; give it once, with the sum of the coefficients",
                );
            }
            self.count(&tag);
            if self.bodies > MOST_BODIES || self.dofs > MOST_BODIES {
                return refuse(tag.position, &format!("more than {MOST_BODIES} bodies or degrees of freedom"));
            }
            if deepest > MOST_NESTED {
                return refuse(tag.position, &format!("elements are nested more than {MOST_NESTED} deep"));
            }
            depth += usize::from(!tag.empty);
        }
        Ok(deepest)
    }

    /// What is wrong with the name of a file. Only the table of files in memory makes a fatal error of it. Decoding the
    /// entities in a name makes it shorter, but must not be what leaves it empty.
    fn bad_name(&self, name: &[u8]) -> Option<String> {
        let why = match (self.files, name.last()) {
            (Files::Disk(_), _) => return irregular(name).then(|| format!("'{}' is not a regular file", shown(name))),
            (_, None | Some(b'/' | b'\\')) => "has nothing behind its last slash",
            _ if name.len() > LONGEST_NAME => "is longer than 900 bytes",
            _ if name.windows(2).any(|window| window == b"&#") => "has a numeric character reference",
            _ if irregular(name) => "is not that of a regular file",
            _ => return None,
        };
        Some(format!("the file name '{}' {why}", shown(name)))
    }

    /// What an included file contains; `None` if it was included before or cannot be read, which the compiler will tell, and
    /// an error if it is a pipe or a device.
    fn included(&mut self, name: &[u8]) -> Result<Option<Cow<'f, [u8]>>, ()> {
        let files = self.files;
        let path = match files {
            Files::Memory(_) => name.to_owned(),
            // The compiler puts the name behind the directory whatever it is.
            Files::Disk(file) => [directory(path_bytes(file)), name].concat(),
        };
        if !self.seen.insert(path.to_ascii_lowercase()) {
            return Ok(None);
        }
        if let Files::Memory(files) = files {
            let found = files.iter().find(|(file, _)| last_part(file.as_bytes()).eq_ignore_ascii_case(last_part(name)));
            if let Some((_, content)) = found {
                return Ok(Some(Cow::Borrowed(content)));
            }
        }
        let path = decoded(&path);
        match std::fs::metadata(os_path(&path)) {
            Ok(data) if !data.is_file() => Err(()),
            Ok(_) => Ok(std::fs::read(os_path(&path)).ok().map(Cow::Owned)),
            Err(_) => Ok(None),
        }
    }

    /// Whether this is another entry for a joint that the fixed tendon has an entry for.
    fn is_repeated(&mut self, tag: &Tag<'_>) -> bool {
        match (tag.name, tag.attribute(b"joint")) {
            (b"fixed", _) => self.joints.clear(),
            (b"joint", Some(joint)) if self.joints.iter().any(|known| known == joint) => return true,
            (b"joint", Some(joint)) => self.joints.push(joint.to_owned()),
            _ => {}
        }
        false
    }

    /// Counts bodies and degrees of freedom.
    fn count(&mut self, tag: &Tag<'_>) {
        match tag.name {
            b"size" => {
                let rows = tag.attribute(b"njmax").and_then(|rows| numbers(rows).next().flatten());
                self.little_room |= rows.is_some_and(|rows| (0..LEAST_NJMAX).contains(&rows));
            }
            b"adhesion" | b"general" => self.adhesion |= tag.attribute(b"body").is_some(),
            b"body" => self.bodies += 1,
            b"freejoint" => self.dofs += 6,
            b"joint" => {
                self.dofs += match tag.attribute(b"type") {
                    Some(b"free") => 6,
                    Some(b"ball") => 3,
                    _ => 1,
                }
            }
            b"composite" => {
                let bodies = numbers(tag.attribute(b"count").unwrap_or_default())
                    .map(|count| count.map_or(1, |count| count.clamp(1, 1 << 20) as usize))
                    .fold(1_usize, usize::saturating_mul);
                self.bodies = self.bodies.saturating_add(bodies);
            }
            _ => {}
        }
    }
}

/// Sizes at which a product of them overflows in the compiler, and faces of vertices that a mesh does not have.
fn bad_sizes(tag: &Tag<'_>) -> Option<String> {
    let size = |name: &[u8], otherwise: u64| {
        tag.attribute(name).map_or(otherwise, |value| {
            std::str::from_utf8(value.trim_ascii())
                .ok()
                .and_then(|value| value.parse::<f64>().ok())
                .map_or(u64::MAX, |value| value.max(0.0) as u64)
        })
    };
    match tag.name {
        b"texture" => {
            let width = size(b"width", 0);
            // A cube is six squares.
            let height = size(b"height", 0).max(width.saturating_mul(6));
            (width.saturating_mul(height).saturating_mul(3) > MOST_NUMBERS).then(|| "a texture is too large".to_owned())
        }
        b"hfield" => (size(b"nrow", 0).saturating_mul(size(b"ncol", 0)) > MOST_NUMBERS)
            .then(|| "a height field is too large".to_owned()),
        b"mesh" => {
            let vertices = numbers(tag.attribute(b"vertex")?).count() / 3;
            let outside = numbers(tag.attribute(b"face")?)
                .find(|vertex| !vertex.is_some_and(|vertex| usize::try_from(vertex).is_ok_and(|it| it < vertices)));
            outside.map(|_| {
                format!("a face of a mesh has something other than its vertices, 0 to {}", vertices.max(1) - 1)
            })
        }
        _ => None,
    }
}

/// The integers in a list; `None` for what is not one.
fn numbers(list: &[u8]) -> impl Iterator<Item = Option<i64>> {
    list.split(|&byte| is_space(byte))
        .filter(|word| !word.is_empty())
        .map(|word| std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()))
}

/// A start tag or an end tag.
struct Tag<'t> {
    position: usize,
    name: &'t [u8],
    attributes: Vec<(&'t [u8], &'t [u8])>,
    /// `</name>`
    closes: bool,
    /// `<name/>`
    empty: bool,
}

impl<'t> Tag<'t> {
    fn attribute(&self, name: &[u8]) -> Option<&'t [u8]> {
        self.attributes.iter().find(|(found, _)| *found == name).map(|(_, value)| *value)
    }
}

/// The tags of a text, from a position on. What is not well-formed is skipped: the compiler's parser will refuse it.
struct Tags<'t>(&'t [u8], usize);

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

/// The tag at the beginning of `text`, and its length.
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
    let mut tag = Tag { position, name: word(&mut at), attributes: Vec::new(), closes, empty: false };
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

/// C's `isspace`, which is the parser's notion of it.
fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

fn shown(name: &[u8]) -> String {
    String::from_utf8_lossy(name).chars().take(60).collect()
}

/// Everything up to the last slash.
fn directory(path: &[u8]) -> &[u8] {
    &path[..path.len() - last_part(path).len()]
}

/// Everything behind the last slash.
fn last_part(path: &[u8]) -> &[u8] {
    path.rsplit(|byte| b"/\\".contains(byte)).next().unwrap_or_default()
}

/// Whether there is such a file, and it is a pipe or a device, which could make the compiler wait for ever.
fn irregular(name: &[u8]) -> bool {
    let name = decoded(name);
    name.starts_with(b"/") && std::fs::metadata(os_path(&name)).is_ok_and(|data| !data.is_file() && !data.is_dir())
}

/// With the five entities of XML replaced.
fn decoded(name: &[u8]) -> Vec<u8> {
    let mut name = name.to_owned();
    for (entity, byte) in
        [(&b"&quot;"[..], b'"'), (b"&apos;", b'\''), (b"&lt;", b'<'), (b"&gt;", b'>'), (b"&amp;", b'&')]
    {
        while let Some(at) = name.windows(entity.len()).position(|window| window == entity) {
            name.splice(at..at + entity.len(), [byte]);
            if byte == b'&' {
                break;
            }
        }
    }
    name
}

#[cfg(unix)]
fn path_bytes(path: &Path) -> &[u8] {
    std::os::unix::ffi::OsStrExt::as_bytes(path.as_os_str())
}

#[cfg(unix)]
fn os_path(path: &[u8]) -> &Path {
    Path::new(<OsStr as std::os::unix::ffi::OsStrExt>::from_bytes(path))
}

#[cfg(not(unix))]
fn path_bytes(path: &Path) -> &[u8] {
    path.to_str().unwrap_or_default().as_bytes()
}

#[cfg(not(unix))]
fn os_path(path: &[u8]) -> &Path {
    Path::new(OsStr::new(std::str::from_utf8(path).unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::{Files, Tags, check};

    fn message(text: &str) -> String {
        check("the text", text.as_bytes(), &Files::Memory(&[]))
            .map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn tags_have_their_attributes_and_comments_are_skipped() {
        let text = b"<?xml version='1.0'?><!-- <no file=''/> --><a b = \"c>d\"\x0be='f'>text</a ><![CDATA[<x>]]><g/>";
        let tags: Vec<_> =
            Tags(text, 0).map(|tag| (tag.name.to_vec(), tag.attributes.len(), tag.closes, tag.empty)).collect();
        assert_eq!(
            tags,
            [(b"a".to_vec(), 2, false, false), (b"a".to_vec(), 0, true, false), (b"g".to_vec(), 0, false, true)]
        );
    }

    #[test]
    fn no_cut_of_a_text_makes_the_look_at_it_fail() {
        let text = b"<mujoco><mesh vertex='0 0 0' face = \"0 1 2\"/><!-- a --><include file='/x/'/><a/ b=/></mujoco>";
        for end in 0..text.len() {
            for start in 0..end {
                let _ = check("", &text[start..end], &Files::Memory(&[]));
            }
        }
    }

    #[test]
    fn what_the_compiler_must_not_see_is_refused_with_its_line() {
        for (text, expected) in [
            ("<mujoco>\n<include file=''/></mujoco>", "nothing behind its last slash, line 2"),
            ("<mujoco><include\x0bfile\x0b=\x0b''/></mujoco>", "nothing behind its last slash"),
            ("<mujoco><include file='a&#47;'/></mujoco>", "numeric character reference"),
            ("<mujoco>\0</mujoco>", "NUL byte"),
            ("<mujoco><include file='/dev/null'/></mujoco>", "regular file"),
            ("<mesh vertex='0 0 0 1 0 0 0 1 0' face='0 1 3'/>", "0 to 2"),
            ("<mesh vertex='0 0 0 1 0 0 0 1 0' face='0 1 -1'/>", "0 to 2"),
            ("<texture width='50000' height='50000'/>", "a texture is too large"),
            ("<hfield nrow='50000' ncol='50000'/>", "a height field is too large"),
            ("<composite count='1000 1000 1'/>", "40000 bodies"),
        ] {
            let message = message(text);
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn good_texts_pass() {
        for text in [
            crate::sample::CARTPOLE_XML,
            crate::sample::HUMANOID_XML,
            "<mujoco><!-- <include file=''/> --></mujoco>",
            "<mesh vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2\n1 2 3'/>",
            "<texture type='skybox' builtin='gradient' width='512' height='3072'/>",
        ] {
            assert_eq!(message(text), "");
        }
    }
}
