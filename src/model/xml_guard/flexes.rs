//! Flexes on which the compiler or the visualiser crashes or accesses elements beyond an array:
//! their lists contradict each other, or their tetrahedra have no border.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::hash::Hash;

use super::files::has_extension;
use super::lines::{after_word, fields, lines};
use super::tags::{Tag, numbers};

/// Dimension of the elements of a flex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Dim {
    Line,
    Surface,
    Solid,
}

impl Dim {
    /// Returns the dimension in a tag. A value that the compiler may reject counts as solid.
    pub(super) fn of(tag: &Tag<'_>) -> Self {
        match tag.attribute(b"dim").as_deref().map(<[u8]>::trim_ascii) {
            Some(b"1") => Self::Line,
            None | Some(b"2") => Self::Surface,
            _ => Self::Solid,
        }
    }
}

/// Largest number of operations with which the compiler removes points that no element has: 5 s.
const MOST_REMOVALS: usize = 100_000_000_000;
/// `true` if the compiler checks the number of texture coordinates before it uses them.
const CHECKS_TEXTURES: bool = cfg!(engine_since = "4.0.0");

const CLOSED: &str = "a flex of tetrahedra has no face that belongs to only one of them";
const DOUBLED: &str = "has a face twice, or one of more than four vertices, from which a flex cannot have tetrahedra";
const TOO_MANY: &str = "has too many vertices that no element of the flex uses";
const WRONG_TEXTURE: &str =
    "has texture coordinates: with engines before 4.0 a flex of it must have dim 2 and use all vertices";

/// Returns the reason to reject a flex by its lists.
pub(super) fn reject(tag: &Tag<'_>) -> Option<&'static str> {
    if ![&b"flex"[..], b"flexcomp"].contains(&tag.name) {
        return None;
    }
    let list = |name: &[u8]| tag.attribute(name).unwrap_or(Cow::Borrowed(b""));
    let count = |name: &[u8]| numbers(&list(name)).count();
    let has = |name: &[u8]| count(name) > 0;
    let (elements, texcoords) = (list(b"element"), count(b"texcoord"));
    let is_closed = || {
        Dim::of(tag) == Dim::Solid && is_closed(numbers(&elements).collect::<Vec<_>>().as_chunks().0.iter().copied())
    };
    // Older compilers copy three indices of each element.
    let is_line = cfg!(not(engine_since = "3.17.0")) && Dim::of(tag) == Dim::Line;
    if is_line && texcoords > 0 && !has(b"elemtexcoord") {
        return Some("texture coordinates of a flex of dim 1 need elemtexcoord");
    }
    if tag.name == b"flex" {
        let nodes = count(b"node");
        // From one node the compiler of 3.5 computes stiffnesses of order zero.
        let lacks = || nodes < 8 || !has(b"vertex") || count(b"vertex") != 3 * count(b"body");
        if nodes > 0 && lacks() {
            return Some("a flex with nodes needs at least 8, the attribute vertex, and a body for each vertex");
        }
        if nodes > 0 && has(b"nodecoord") && count(b"nodecoord") != 3 * nodes {
            return Some("nodecoord must have three numbers for each node");
        }
        let indices = list(b"elemtexcoord");
        let is_outside = |index: Option<i64>| !index.is_some_and(|index| (0..texcoords as i64 / 2).contains(&index));
        let is_wrong = || has(b"elemtexcoord") && count(b"elemtexcoord") != count(b"element");
        if texcoords > 0 && (texcoords % 2 > 0 || is_wrong() || numbers(&indices).any(is_outside)) {
            return Some(
                "texcoord must have two numbers for each vertex, and elemtexcoord an index of these for each of element",
            );
        }
        return is_closed().then_some(CLOSED);
    }
    let kind = tag.attribute(b"type");
    let points = count(b"point");
    if kind.as_deref() != Some(b"direct") {
        // The compiler appends to these lists, which then may be a closed complex.
        if points > 0 || has(b"element") {
            return Some("only a flexcomp of type direct has the attributes point and element");
        }
        let has_file = matches!(kind.as_deref(), Some(b"mesh" | b"gmsh"));
        return (!CHECKS_TEXTURES && has_file && texcoords > 0)
            .then_some("engines before 4.0 need a flexcomp without texcoord for points from a file");
    }
    // Older compilers drop the coordinates of points that no element has before they check the
    // number.
    if texcoords > 0 && 3 * texcoords != 2 * points {
        return Some("texcoord must have two numbers for each point");
    }
    let used: HashSet<_> = numbers(&elements).collect();
    if is_wasteful(points / 3, used.len()) {
        return Some("a flexcomp has too many points that no element uses");
    }
    is_closed().then_some(CLOSED)
}

/// Returns `true` if the compiler needs a long time to remove points that no element uses: it
/// renumbers all later points for each of them.
fn is_wasteful(points: usize, used: usize) -> bool {
    points.saturating_sub(used).saturating_mul(points) > MOST_REMOVALS
}

/// Returns `true` if no face belongs to only one tetrahedron. The compiler then puts no element
/// into the hierarchy of bounding volumes, and reads its root.
fn is_closed<V: Copy + Ord + Hash>(tetrahedra: impl Iterator<Item = [V; 4]>) -> bool {
    let mut counts: HashMap<[V; 3], usize> = HashMap::new();
    for [a, b, c, d] in tetrahedra {
        for mut face in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
            face.sort_unstable();
            *counts.entry(face).or_default() += 1;
        }
    }
    counts.values().all(|&count| count > 1)
}

/// Vertices and faces of a mesh. A vertex is the bits of its coordinates, because the compiler
/// unites equal ones.
#[derive(Default)]
pub(super) struct Mesh {
    vertices: Vec<[u32; 3]>,
    faces: Vec<Vec<usize>>,
    has_texture: bool,
}

/// Returns the bits of a coordinate, the same for both zeros.
fn bits(coordinate: f32) -> u32 {
    (coordinate + 0.0).to_bits()
}

impl Mesh {
    /// Reads a file that the other checks accept: OBJ, STL or the engine's own format.
    pub(super) fn of_file(path: &[u8], content: &[u8]) -> Self {
        let ends = |end| has_extension(path, end);
        let real = |at: usize| {
            content.get(at..at + 4).map_or(0, |word| bits(f32::from_ne_bytes(word.try_into().unwrap_or_default())))
        };
        let integer = |at: usize| {
            content.get(at..at + 4).map_or(0, |word| u32::from_ne_bytes(word.try_into().unwrap_or_default()))
        };
        let vertex = |at: usize| [real(at), real(at + 4), real(at + 8)];
        let mut mesh = Self::default();
        if ends(b"obj") {
            mesh.read_obj(content);
        } else if ends(b"stl") {
            let corners = (84..content.len()).step_by(50).flat_map(|face| [12, 24, 36].map(|corner| face + corner));
            mesh.vertices = corners.map(vertex).collect();
            mesh.faces = (0..mesh.vertices.len()).step_by(3).map(|at| vec![at, at + 1, at + 2]).collect();
        } else if ends(b"msh") {
            let [vertices, normals, texcoords, faces] = [0, 4, 8, 12].map(|at| integer(at) as usize);
            let start = 16 + 12 * (vertices + normals) + 8 * texcoords;
            mesh.vertices = (0..vertices).map(|at| vertex(16 + 12 * at)).collect();
            let face = |at: usize| [0, 4, 8].map(|corner| integer(start + 12 * at + corner) as usize).to_vec();
            mesh.faces = (0..faces).map(face).collect();
            mesh.has_texture = texcoords > 0;
        }
        mesh
    }

    fn read_obj(&mut self, content: &[u8]) {
        for line in lines(content) {
            let parsed = |field: &[u8]| std::str::from_utf8(field).ok().and_then(|field| field.parse().ok());
            if let Some(rest) = after_word(line, b"v") {
                let mut reals = fields(rest).map(|field| parsed(field).map_or(0, bits));
                self.vertices.push(std::array::from_fn(|_| reals.next().unwrap_or(0)));
            } else if let Some(rest) = after_word(line, b"f") {
                let known = self.vertices.len() as i64;
                let corner = |field: &[u8]| {
                    let index = field
                        .split(|&byte| byte == b'/')
                        .next()
                        .and_then(|field| std::str::from_utf8(field).ok().and_then(|field| field.parse::<i64>().ok()));
                    index.map_or(usize::MAX, |index| {
                        usize::try_from(if index < 0 { known + index } else { index - 1 }).unwrap_or(usize::MAX)
                    })
                };
                self.faces.push(fields(rest).map(corner).collect());
            }
            self.has_texture |= after_word(line, b"vt").is_some();
        }
    }

    /// Reads the attributes of a mesh in the text.
    pub(super) fn of_tag(tag: &Tag<'_>) -> Self {
        let list = |name: &[u8]| tag.attribute(name).unwrap_or(Cow::Borrowed(b""));
        let reals: Vec<u32> = String::from_utf8_lossy(&list(b"vertex"))
            .split_whitespace()
            .map(|word| word.parse().map_or(0, bits))
            .collect();
        let indices: Vec<usize> = numbers(&list(b"face"))
            .map(|index| index.and_then(|index| usize::try_from(index).ok()).unwrap_or(usize::MAX))
            .collect();
        Self {
            vertices: reals.as_chunks().0.to_vec(),
            faces: indices.chunks_exact(3).map(<[usize]>::to_vec).collect(),
            // The compiler generates texture coordinates of some meshes.
            has_texture: [&b"texcoord"[..], b"builtin"].iter().any(|name| !list(name).is_empty()),
        }
    }

    /// Returns the reason to reject a flex of this mesh.
    pub(super) fn reject(&self, dim: Dim) -> Option<&'static str> {
        let used: HashSet<usize> = self.faces.iter().flatten().copied().collect();
        let distinct: HashSet<[u32; 3]> = self.vertices.iter().copied().collect();
        let uses_all =
            distinct.len() == used.iter().filter_map(|&at| self.vertices.get(at)).collect::<HashSet<_>>().len();
        if !CHECKS_TEXTURES && self.has_texture && (dim != Dim::Surface || !uses_all) {
            return Some(WRONG_TEXTURE);
        }
        if is_wasteful(self.vertices.len(), used.len()) {
            return Some(TOO_MANY);
        }
        (dim == Dim::Solid && self.has_repeated_face()).then_some(DOUBLED)
    }

    /// Returns `true` if a face may occur twice. Its tetrahedra with the origin would have no
    /// border. Two quadrilaterals with three common vertices may have a common triangle.
    fn has_repeated_face(&self) -> bool {
        let mut seen = HashSet::new();
        self.faces.iter().any(|face| {
            let corners: Vec<_> = face.iter().map(|&at| self.vertices.get(at)).collect();
            let mut is_new = |mut triangle: [Option<&[u32; 3]>; 3]| {
                triangle.sort_unstable();
                seen.insert(triangle.map(Option::<&_>::copied))
            };
            match corners[..] {
                [a, b, c] => !is_new([a, b, c]),
                [a, b, c, d] => [[a, b, c], [a, b, d], [a, c, d], [b, c, d]].into_iter().any(|it| !is_new(it)),
                _ => true,
            }
        })
    }
}

/// Returns the reason to reject a file of Gmsh. Ignores errors that the compiler reports.
pub(super) fn gmsh(content: &[u8]) -> Option<&'static str> {
    const UNKNOWN: &str =
        "is not a Gmsh file in the text format 2.2 or the format 4.1 with one block of elements of one type";
    let mut header = fields(content.strip_prefix(b"$MeshFormat")?);
    if fills_its_pages(content) {
        return Some("has a length for which the engine reads beyond its end; append a line break");
    }
    let (version, is_binary) = (header.next(), header.next() != Some(b"0"));
    let find = |name: &[u8]| content.windows(name.len()).position(|window| window == name);
    let section = |start: &[u8], end: &[u8]| content.get(find(start)? + start.len()..find(end)?);
    let (nodes, elements) = (section(b"$Nodes", b"$EndNodes")?, section(b"$Elements", b"$EndElements")?);
    let (points, elements) = match version {
        Some(b"4.1") if is_binary => (nodes.len() / 32, gmsh_binary(nodes, 32).and_then(|_| gmsh_elements(elements))),
        Some(b"2.2" | b"4.1") if !is_binary => {
            (fields(nodes).count() / 4, gmsh_text(version == Some(b"4.1"), elements))
        }
        _ => return Some(UNKNOWN),
    };
    let Some(elements) = elements else { return Some(UNKNOWN) };
    let used: HashSet<i32> = elements.iter().flatten().copied().collect();
    if is_wasteful(points, used.len()) {
        return Some(TOO_MANY);
    }
    let tetrahedra: Result<Vec<[i32; 4]>, _> = elements.into_iter().map(TryFrom::try_from).collect();
    (tetrahedra.is_ok_and(|tetrahedra| is_closed(tetrahedra.into_iter())))
        .then_some("has tetrahedra without a face that belongs to only one of them")
}

/// Returns `true` if the compiler may read beyond the memory of a file. It reads the header as a C
/// string. The allocators of the engines put 16 or 64 bytes before a large block, which ends with a
/// page of memory if its length allows it. After any other block, other bytes follow.
fn fills_its_pages(content: &[u8]) -> bool {
    const PAGE: usize = 4096;
    [16, 64].iter().any(|before| (content.len() + before).is_multiple_of(PAGE)) && !content.contains(&0)
}

/// Returns the number of vertices of lines, triangles and tetrahedra by their type in a file of
/// Gmsh.
fn gmsh_corners(kind: i32) -> Option<usize> {
    [(1, 2), (2, 3), (4, 4)].into_iter().find_map(|(of, corners)| (of == kind).then_some(corners))
}

/// Returns the vertices of each element of a section in text format.
fn gmsh_text(is_new: bool, section: &[u8]) -> Option<Vec<Vec<i32>>> {
    let integers = fields(section).map(|field| std::str::from_utf8(field).ok()?.parse::<i32>().ok());
    let integers = integers.collect::<Option<Vec<i32>>>()?;
    // The numbers before the vertices of each element are its tag, and in the older format also its
    // type and its other tags.
    let (start, count, kind, head) = match integers[..] {
        [1, count, _, _, _, _, kind, _, ..] if is_new => (8, count, kind, 1),
        [count, _, kind, tags, ..] if !is_new => (1, count, kind, if tags > 0 { 5 } else { 3 }),
        _ => return None,
    };
    let length = head + gmsh_corners(kind)?;
    let elements = integers[start..].chunks(length);
    let is_of_kind = |element: &[i32]| head == 1 || element[1] == kind && element[2] == if head == 5 { 2 } else { 0 };
    let is_valid = usize::try_from(count) == Ok(elements.len())
        && elements.clone().all(|element| element.len() == length && is_of_kind(element));
    is_valid.then(|| elements.map(|element| element[head..].to_vec()).collect())
}

/// Returns the items after the header of a section in binary format. The compiler does not check
/// the product of their number and their size for overflow.
fn gmsh_binary(section: &[u8], size: usize) -> Option<impl Iterator<Item = &[u8]>> {
    const HEADER: usize = 53;
    let count = usize::try_from(u64::from_ne_bytes(section.get(9..17)?.try_into().ok()?)).ok()?;
    let items = section.get(HEADER..)?.chunks_exact(size);
    (count <= items.len()).then(|| items.take(count))
}

/// Returns the vertices of each element of a section in binary format.
fn gmsh_elements(section: &[u8]) -> Option<Vec<Vec<i32>>> {
    let corners = gmsh_corners(i32::from_ne_bytes(section.get(41..45)?.try_into().ok()?))?;
    let vertex = |word: &[u8; 8]| i32::try_from(u64::from_ne_bytes(*word)).ok();
    let elements = gmsh_binary(section, 8 + 8 * corners)?;
    elements.map(|element| element[8..].as_chunks().0.iter().map(vertex).collect()).collect()
}
