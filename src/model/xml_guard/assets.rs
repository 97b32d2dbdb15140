//! Validation of mesh, skin, height field and texture files before the compiler reads them. The
//! compiler's readers compute sizes in C ints, which can overflow, and do not check the indices of
//! vertices.

use std::borrow::Cow;

use super::files::{Files, Found, directory, has_extension};
use super::flexes::{self, Dim, Mesh};
use super::lines::{after_word, fields, lines};
use super::tags::Tag;

/// Largest number of values in the image of a texture or in a height field.
pub(super) const MOST_NUMBERS: u64 = 500_000_000;
/// Largest size of a file in bytes; the engine stores it in a C int.
const LARGEST_FILE: usize = 1 << 30;

/// `true` if the compiler copies the texture indices of the faces from a null pointer for a mesh
/// that has texture coordinates without such indices. Only files with faces have them; no attribute
/// of a text specifies them.
pub(super) const NEEDS_TEXTURE_INDICES: bool = cfg!(all(engine_since = "2.3.3", not(engine_since = "3.1.3")));

/// File format by the compiler's rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Format {
    Msh,
    Obj,
    Skin,
    /// Texture in PNG format.
    Png,
    /// Height field in PNG format.
    HeightPng,
    /// Height field in the engine's own format.
    HeightField,
    /// Texture in the engine's own format.
    Texture,
    /// Mesh of a flex of this dimension.
    Flex(Dim),
    /// Mesh of a flex in the format of Gmsh.
    Gmsh,
    /// A format that the compiler checks itself or does not support.
    Other,
}

impl Format {
    pub(super) fn of(tag: &Tag<'_>, name: &[u8]) -> Self {
        let ends = |end| has_extension(name, end);
        match tag.name {
            b"mesh" => Self::of_mesh(name),
            b"flexcomp" if tag.attribute(b"type").as_deref() == Some(b"gmsh") => Self::Gmsh,
            b"flexcomp" => Self::Flex(Dim::of(tag)),
            b"skin" => Self::Skin,
            b"texture" => Self::of_texture(name),
            b"hfield" if ends(b".png") => Self::HeightPng,
            b"hfield" => Self::HeightField,
            _ => Self::Other,
        }
    }

    pub(super) fn of_texture(name: &[u8]) -> Self {
        if has_extension(name, b".png") { Self::Png } else { Self::Texture }
    }

    fn of_mesh(name: &[u8]) -> Self {
        match name {
            _ if has_extension(name, b"msh") => Self::Msh,
            _ if has_extension(name, b"obj") => Self::Obj,
            _ => Self::Other,
        }
    }

    /// Returns the reason to reject the contents of a file. Ignores errors that the compiler itself
    /// reports.
    pub(super) fn reject(self, path: &[u8], content: &[u8], files: &Files<'_>) -> Option<&'static str> {
        if content.len() > LARGEST_FILE {
            return Some("is larger than 1 GiB");
        }
        if content.len() < self.header() {
            return Some(WRONG_SIZE);
        }
        match self {
            Self::Msh => msh(content),
            Self::Obj => obj(content).or_else(|| materials(path, content, files)),
            Self::Flex(dim) => {
                let own = Self::of_mesh(path).reject(path, content, files);
                own.or_else(|| Mesh::of_file(path, content).reject(dim))
            }
            Self::Gmsh => flexes::gmsh(content),
            Self::Skin => skin(content),
            Self::Png | Self::HeightPng => png(content),
            Self::HeightField => grid(content, 4),
            Self::Texture => grid(content, 3),
            Self::Other => None,
        }
    }

    /// Returns the number of bytes at the start of a file that the compiler reads without checking
    /// the length of the file.
    fn header(self) -> usize {
        match self {
            Self::Msh | Self::Skin => 16,
            Self::HeightField | Self::Texture => 8,
            _ => 0,
        }
    }

    /// Returns `true` if the compiler determines the format from the end of the whole path.
    pub(super) fn is_grid(self) -> bool {
        matches!(self, Self::Png | Self::HeightPng | Self::HeightField | Self::Texture)
    }

    /// Returns the rows and columns if the file is a height field.
    pub(super) fn rows_and_columns(self, content: &[u8]) -> Option<[u64; 2]> {
        match self {
            Self::HeightField => header(content),
            Self::HeightPng => png_size(content).map(|[width, height]| [height, width]),
            _ => None,
        }
    }
}

/// Returns the 32-bit words of a file in native byte order, as the compiler reads them.
fn words(content: &[u8]) -> impl Iterator<Item = i32> {
    content.as_chunks().0.iter().map(|&word| i32::from_ne_bytes(word))
}

/// Reads the integers of a header, or returns `None` if one of them is negative.
fn header<const N: usize>(content: &[u8]) -> Option<[u64; N]> {
    let mut header = [0; N];
    let mut words = words(content);
    for value in &mut header {
        *value = u64::try_from(words.next()?).ok()?;
    }
    Some(header)
}

const WRONG_SIZE: &str = "has a size that contradicts its header";
const WRONG_FACE: &str = "has a face with a nonexistent vertex";
const NOT_FINITE: &str = "has a vertex that is not finite";
const NO_TEXTURE_INDICES: &str = "has texture coordinates and does not start with a face of three or four vertices: MuJoCo 2.3.3 to 3.1.2 \
    cannot compile it";

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
    if NEEDS_TEXTURE_INDICES && ntexcoord > 0 && nface == 0 {
        return Some(NO_TEXTURE_INDICES);
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
            Some(tail) => rest = tail,
            None => return Some(WRONG_SIZE),
        }
    }
    (!rest.is_empty()).then_some(WRONG_SIZE)
}

/// Checks a file of two sizes, followed by cells of `width` bytes.
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

/// Returns the width and height of a PNG image.
fn png_size(content: &[u8]) -> Option<[u64; 2]> {
    // The sizes follow the signature and the header of the first chunk.
    let (&[width, height], _) = content.get(16..)?.as_chunks().0.split_first_chunk()?;
    Some([width, height].map(|size| u64::from(u32::from_be_bytes(size))))
}

const LARGE: &str = "is an image with too many pixels";

/// Returns `true` if a size computed from the image overflows. From a square image the compiler
/// makes a texture of six squares.
fn is_large(width: u64, height: u64) -> bool {
    let pixels = width.saturating_mul(height);
    pixels > MOST_NUMBERS / 3 || width == height && pixels > i32::MAX as u64 / 18
}

fn obj(content: &[u8]) -> Option<&'static str> {
    const MALFORMED: &str = "has a face that is not three or more vertices of the form 1, 1/2, 1//3 or 1/2/3";
    const MIXED: &str =
        "has a face without a normal or texture coordinate, although it has some: the engine requires all or none";
    let count = |word: &[u8]| lines(content).filter(|line| after_word(line, word).is_some()).count() as i64;
    let all = [count(b"v"), count(b"vt"), count(b"vn")];
    let mut seen = [0; 3];
    let mut faces = 0;
    for line in lines(content) {
        for (number, word) in seen.iter_mut().zip([&b"v"[..], b"vt", b"vn"]) {
            if let Some(rest) = after_word(line, word) {
                *number += 1;
                let finite =
                    |field: &[u8]| std::str::from_utf8(field).is_ok_and(|it| it.parse().is_ok_and(f32::is_finite));
                if word == b"v" && !fields(rest).take(3).all(finite) {
                    return Some(NOT_FINITE);
                }
            }
        }
        let Some(rest) = after_word(line, b"f") else { continue };
        faces += 1;
        if fields(rest).count() < 3 {
            return Some(MALFORMED);
        }
        for vertex in fields(rest) {
            let mut indices = vertex.split(|&byte| byte == b'/');
            for part in 0..3 {
                let index = indices.next().unwrap_or_default();
                if index.is_empty() && part > 0 {
                    // Without an index the engine reads before the first element.
                    if all[part] > 0 {
                        return Some(MIXED);
                    }
                    continue;
                }
                let Some(index) = std::str::from_utf8(index).ok().and_then(|index| index.parse::<i64>().ok()) else {
                    return Some(MALFORMED);
                };
                let index = if index < 0 { seen[part] + index } else { index - 1 };
                if !(0..all[part]).contains(&index) {
                    return Some(if part == 0 {
                        WRONG_FACE
                    } else {
                        "has a face with a nonexistent normal or texture coordinate"
                    });
                }
            }
            if indices.next().is_some() {
                return Some(MALFORMED);
            }
        }
    }
    if faces == 0 && all[0] < 4 {
        return Some("has no face, and fewer than the four vertices that a convex hull needs");
    }
    if NEEDS_TEXTURE_INDICES && all[1] > 0 && !starts_with_face(content) {
        return Some(NO_TEXTURE_INDICES);
    }
    // Without faces, the counts must match each other.
    (faces == 0 && all[1..].iter().any(|&count| count != 0 && count != all[0])).then_some(MIXED)
}

/// Returns `true` if the first element of an OBJ file is a triangle or a quadrilateral. Only then
/// is the compiler's first shape certain to have faces: a shape can consist of lines or points, and
/// the triangulation of a larger polygon can be empty.
fn starts_with_face(content: &[u8]) -> bool {
    let mut elements = lines(content).filter_map(|line| {
        [&b"f"[..], b"l", b"p"].into_iter().find_map(|word| Some((word, fields(after_word(line, word)?).count())))
    });
    matches!(elements.next(), Some((b"f", 3 | 4)))
}

/// Rejects names of material files that are not regular files, because the OBJ reader opens them.
fn materials(path: &[u8], content: &[u8], files: &Files<'_>) -> Option<&'static str> {
    // The reader of files in memory ignores materials.
    if matches!(files.find(path)[..], [Found::Content(Cow::Borrowed(_))]) {
        return None;
    }
    lines(content)
        .filter_map(|line| after_word(line, b"mtllib"))
        .flat_map(|rest| fields(rest).chain([rest.trim_ascii()]))
        .any(|name| {
            let irregular = |path: &[u8]| matches!(Files::default().find(path)[..], [Found::Rejected(_)]);
            irregular(name) || irregular(&[directory(path), name].concat())
        })
        .then_some("names a material file that is not a regular file")
}
