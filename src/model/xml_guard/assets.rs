//! A look at meshes, skins, height fields and textures before the compiler's readers see them. These compute sizes with C ints
//! that overflow, and do not look at the indices of vertices.

use std::borrow::Cow;

use super::file::{Files, Found, directory, shown};

/// Numbers in the image of a texture or in a height field.
pub(super) const MOST_NUMBERS: u64 = 500_000_000;
/// Bytes of a file; the engine counts them with a C int.
const LONGEST: usize = 1 << 30;

/// What the compiler takes a file for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Format {
    Msh,
    Obj,
    Skin,
    /// A texture as PNG.
    Png,
    /// A height field as PNG.
    HeightPng,
    /// A height field in the engine's own format.
    HeightField,
    /// A texture in the engine's own format.
    Texture,
    /// Checked by the compiler, or unknown to it.
    Other,
}

impl Format {
    pub(super) fn of(element: &[u8], name: &[u8]) -> Self {
        let ends = |end: &[u8]| name.len() >= end.len() && name[name.len() - end.len()..].eq_ignore_ascii_case(end);
        match element {
            b"mesh" if ends(b"msh") => Self::Msh,
            b"mesh" if ends(b"obj") => Self::Obj,
            b"skin" => Self::Skin,
            b"texture" if ends(b".png") => Self::Png,
            b"hfield" if ends(b".png") => Self::HeightPng,
            b"texture" => Self::Texture,
            b"hfield" => Self::HeightField,
            _ => Self::Other,
        }
    }

    /// What is wrong with the content of such a file. What the compiler refuses itself need not be found.
    pub(super) fn fault(self, path: &[u8], content: &[u8], files: &Files<'_>) -> Option<&'static str> {
        if content.len() > LONGEST {
            return Some("is larger than 1 GiB");
        }
        if content.len() < self.header() {
            return Some(WRONG_SIZE);
        }
        match self {
            Self::Msh => msh(content),
            Self::Obj => obj(content).or_else(|| materials(path, content, files)),
            Self::Skin => skin(content),
            Self::Png | Self::HeightPng => png(content),
            Self::HeightField => grid(content, 4),
            Self::Texture => grid(content, 3),
            Self::Other => None,
        }
    }

    /// Bytes at the beginning of a file that the compiler reads, whether they are there or not.
    fn header(self) -> usize {
        match self {
            Self::Msh | Self::Skin => 16,
            Self::HeightField | Self::Texture => 8,
            _ => 0,
        }
    }

    /// Whether the compiler tells by the end of the whole path what is in the file.
    pub(super) fn is_grid(self) -> bool {
        matches!(self, Self::Png | Self::HeightPng | Self::HeightField | Self::Texture)
    }

    /// The rows and columns of a height field, if that is what the file has.
    pub(super) fn rows_and_columns(self, content: &[u8]) -> Option<[u64; 2]> {
        match self {
            Self::HeightField => header(content),
            Self::HeightPng => png_size(content).map(|[width, height]| [height, width]),
            _ => None,
        }
    }
}

/// The name of a file and what is wrong with it.
pub(super) fn message(name: &[u8], fault: &str) -> String {
    format!("the file '{}' {fault}", shown(name))
}

/// The 32-bit words of a file, in the order of the machine, as the compiler reads them.
fn words(content: &[u8]) -> impl Iterator<Item = i32> {
    content.as_chunks().0.iter().map(|&word| i32::from_ne_bytes(word))
}

/// The integers of a header, each not negative.
fn header<const N: usize>(content: &[u8]) -> Option<[u64; N]> {
    let mut header = [0; N];
    let mut words = words(content);
    for value in &mut header {
        *value = u64::try_from(words.next()?).ok()?;
    }
    Some(header)
}

const WRONG_SIZE: &str = "has another size than its header says";
const WRONG_FACE: &str = "has a face of a vertex that it does not have";
const NOT_FINITE: &str = "has a vertex that is not finite";

fn finite(content: &[u8], reals: u64) -> bool {
    words(content).take(reals as usize).all(|word| f32::from_bits(word as u32).is_finite())
}

fn msh(content: &[u8]) -> Option<&'static str> {
    let [nvert, nnormal, ntexcoord, nface] = header(content)?;
    if content.len() as u64 != 16 + 12 * nvert + 12 * nnormal + 8 * ntexcoord + 12 * nface {
        return Some(WRONG_SIZE);
    }
    if !finite(&content[16..], 3 * (nvert + nnormal)) {
        return Some(NOT_FINITE);
    }
    let faces = &content[content.len() - 12 * nface as usize..];
    words(faces).any(|vertex| u64::try_from(vertex).is_ok_and(|it| it >= nvert) || vertex < 0).then_some(WRONG_FACE)
}

fn skin(content: &[u8]) -> Option<&'static str> {
    let [nvert, ntexcoord, nface, nbone] = header(content)?;
    let end_of_faces = 16 + 12 * nvert + 8 * ntexcoord + 12 * nface;
    // Each bone has a name of 40 bytes, a pose of 7 numbers and a count.
    if !content.len().is_multiple_of(4) || end_of_faces + 72 * nbone > content.len() as u64 {
        return Some(WRONG_SIZE);
    }
    let end_of_faces = end_of_faces as usize;
    let faces = &content[end_of_faces - 12 * nface as usize..end_of_faces];
    if words(faces).any(|vertex| u64::try_from(vertex).map_or(true, |vertex| vertex >= nvert)) {
        return Some(WRONG_FACE);
    }
    let mut rest = &content[end_of_faces..];
    for _ in 0..nbone {
        let count = words(rest.get(68..)?).next()?;
        let length = 72 + 8 * u64::try_from(count).ok()?;
        match usize::try_from(length).ok().and_then(|length| rest.get(length..)) {
            Some(behind) => rest = behind,
            None => return Some(WRONG_SIZE),
        }
    }
    (!rest.is_empty()).then_some(WRONG_SIZE)
}

/// Two sizes and as many cells of `width` bytes.
fn grid(content: &[u8], width: u64) -> Option<&'static str> {
    let [rows, columns] = header(content)?;
    let cells = content.len() as u64 - 8;
    if rows.saturating_mul(columns) != cells / width || !cells.is_multiple_of(width) {
        return Some(WRONG_SIZE);
    }
    (width == 3 && is_large(rows, columns)).then_some(LARGE)
}

fn png(content: &[u8]) -> Option<&'static str> {
    let [width, height] = png_size(content)?;
    is_large(width, height).then_some(LARGE)
}

/// Width and height of an image.
fn png_size(content: &[u8]) -> Option<[u64; 2]> {
    // Behind the signature and the head of the first chunk.
    let (&[width, height], _) = content.get(16..)?.as_chunks().0.split_first_chunk()?;
    Some([width, height].map(|size| u64::from(u32::from_be_bytes(size))))
}

const LARGE: &str = "is an image of too many pixels";

/// Whether a size of the image overflows. The compiler makes a texture of six squares of a square one.
fn is_large(width: u64, height: u64) -> bool {
    let pixels = width.saturating_mul(height);
    pixels > MOST_NUMBERS / 3 || width == height && pixels > i32::MAX as u64 / 18
}

/// The lines of a text, with what is before them removed.
fn lines(content: &[u8]) -> impl Iterator<Item = &[u8]> {
    content.split(|byte| b"\n\r".contains(byte)).map(<[u8]>::trim_ascii_start)
}

/// What is behind a word at the beginning of a line.
fn behind<'l>(line: &'l [u8], word: &[u8]) -> Option<&'l [u8]> {
    line.strip_prefix(word).filter(|rest| matches!(rest.first(), Some(b' ' | b'\t')))
}

fn fields(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty())
}

fn obj(content: &[u8]) -> Option<&'static str> {
    const ODD: &str = "has a face that is not three or more vertices as in 1, 1/2, 1//3 or 1/2/3";
    const MIXED: &str =
        "has a face without a normal or texture coordinate, though there are some: the engine needs all or none";
    let count = |word: &[u8]| lines(content).filter(|line| behind(line, word).is_some()).count() as i64;
    let all = [count(b"v"), count(b"vt"), count(b"vn")];
    let mut seen = [0; 3];
    let mut faces = 0;
    for line in lines(content) {
        for (number, word) in seen.iter_mut().zip([&b"v"[..], b"vt", b"vn"]) {
            if let Some(rest) = behind(line, word) {
                *number += 1;
                let finite =
                    |field: &[u8]| std::str::from_utf8(field).is_ok_and(|it| it.parse().is_ok_and(f32::is_finite));
                if word == b"v" && !fields(rest).take(3).all(finite) {
                    return Some(NOT_FINITE);
                }
            }
        }
        let Some(rest) = behind(line, b"f") else { continue };
        faces += 1;
        if fields(rest).count() < 3 {
            return Some(ODD);
        }
        for vertex in fields(rest) {
            let mut indices = vertex.split(|&byte| byte == b'/');
            for part in 0..3 {
                let index = indices.next().unwrap_or_default();
                if index.is_empty() && part > 0 {
                    // Without one the engine reads before the first.
                    if all[part] > 0 {
                        return Some(MIXED);
                    }
                    continue;
                }
                let Some(index) = std::str::from_utf8(index).ok().and_then(|index| index.parse::<i64>().ok()) else {
                    return Some(ODD);
                };
                let index = if index < 0 { seen[part] + index } else { index - 1 };
                if !(0..all[part]).contains(&index) {
                    return Some(if part == 0 {
                        WRONG_FACE
                    } else {
                        "has a face of a normal or texture coordinate that it does not have"
                    });
                }
            }
            if indices.next().is_some() {
                return Some(ODD);
            }
        }
    }
    if faces == 0 && all[0] < 4 {
        return Some("has no face, and fewer than the four vertices of a convex hull");
    }
    // Without faces the numbers are taken as they are.
    (faces == 0 && all[1..].iter().any(|&count| count != 0 && count != all[0])).then_some(MIXED)
}

/// The reader opens the files of materials.
fn materials(path: &[u8], content: &[u8], files: &Files<'_>) -> Option<&'static str> {
    // That of a file in memory does not.
    if matches!(files.find(path), Found::Content(Cow::Borrowed(_))) {
        return None;
    }
    lines(content)
        .filter_map(|line| behind(line, b"mtllib"))
        .flat_map(|rest| fields(rest).chain([rest.trim_ascii()]))
        .any(|name| {
            let irregular = |path: &[u8]| matches!(Files::default().find(path), Found::Rejected(_));
            irregular(name) || irregular(&[directory(path), name].concat())
        })
        .then_some("names a file of materials that is not a regular file")
}
