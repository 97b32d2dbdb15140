//! A model that references a file of every type that the engine reads, and its files.

use super::Bytes;

/// Name and content of a file.
pub(super) type File = (String, Vec<u8>);

pub(super) const TEXT: &str = r#"<mujoco>
  <compiler meshdir="meshes" texturedir="textures/"/>
  <asset>
    <texture name="png" type="2d" file="grey.png"/>
    <texture name="raw" type="cube" file="t.tex"/>
    <texture name="cube" type="skybox" fileright="grey.png" fileleft="grey.png"/>
    <material name="m" texture="png"/>
    <mesh name="stl" file="t.stl"/>
    <mesh name="msh" file="t.msh"/>
    <mesh name="obj" file="t.obj" scale="1 -1 1"/>
    <hfield name="field" file="t.hf" size="1 1 .2 .1"/>
    <hfield name="picture" file="grey.png" size="1 1 .2 .1"/>
    <skin name="skin" file="t.skn" material="m"/>
  </asset>
  <worldbody>
    <geom type="hfield" hfield="field"/>
    <geom type="hfield" hfield="picture" pos="3 0 0"/>
    <body name="b" pos="0 0 1"><freejoint/><geom type="mesh" mesh="stl"/></body>
    <body pos="0 1 1"><freejoint/><geom type="mesh" mesh="msh"/></body>
    <body pos="1 0 1"><freejoint/><geom type="mesh" mesh="obj" material="m"/></body>
  </worldbody>
</mujoco>"#;

const VERTICES: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]];
const FACES: [[i32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

pub(super) fn files() -> Vec<File> {
    let [mut stl, mut msh, mut hf, mut tex, mut skn] = [const { Vec::new() }; 5];
    stl.resize(80, b' ');
    integers(&mut stl, &[4]);
    for face in FACES {
        reals(&mut stl, &[0.0; 3]);
        for vertex in face {
            reals(&mut stl, &VERTICES[vertex as usize]);
        }
        stl.extend([0, 0]);
    }
    integers(&mut msh, &[4, 4, 4, 4]);
    reals(&mut msh, VERTICES.as_flattened()); // positions
    reals(&mut msh, [[0.0, 0.6, 0.8]; 4].as_flattened()); // normals
    reals(&mut msh, &[0.25; 8]); // texture coordinates
    integers(&mut msh, FACES.as_flattened());
    integers(&mut hf, &[3, 4]);
    reals(&mut hf, &std::array::from_fn::<f32, 12, _>(|at| at as f32 / 12.0));
    integers(&mut tex, &[4, 4]);
    tex.resize(8 + 3 * 16, 100);
    integers(&mut skn, &[4, 4, 4, 1]);
    reals(&mut skn, VERTICES.as_flattened());
    reals(&mut skn, &[0.5; 8]);
    integers(&mut skn, FACES.as_flattened());
    let mut name = *b"b.......................................";
    name[1..].fill(0);
    skn.extend(name);
    reals(&mut skn, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    integers(&mut skn, &[4, 0, 1, 2, 3]);
    reals(&mut skn, &[1.0; 4]);
    let obj = "# a tetrahedron\no first\nv 0 0 0\nv .3 0 0\nv 0 .3 0\nv 0 0 .3\nvn 0 0 1\nvn 0 1 0\nvt 0 0\nvt 1 1\n\
               f 1/1/1 3/2/2 2/1/1\nf 1/1/1 2/2/2 4/1/1\nf 1/1/1 4/2/2 3/1/1\nf -3/1/1 -2/2/2 -1/1/1\n";
    let png = &include_bytes!("../../models/grey.png")[..];
    [
        ("t.stl", &stl[..]),
        ("t.msh", &msh),
        ("t.obj", obj.as_bytes()),
        ("t.hf", &hf),
        ("t.tex", &tex),
        ("t.skn", &skn),
        ("grey.png", png),
    ]
    .map(|(name, content)| (name.to_owned(), content.to_owned()))
    .to_vec()
}

fn integers(file: &mut Vec<u8>, values: &[i32]) {
    file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

fn reals(file: &mut Vec<u8>, values: &[f32]) {
    file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

/// Damages a file.
pub(super) fn damage(content: &mut Vec<u8>, bytes: &mut Bytes<'_>) {
    const VALUES: [u32; 14] = [
        0,
        1,
        2,
        5,
        u32::MAX,
        0x8000_0000,
        0x7fff_ffff,
        1 << 16,
        1_431_655_766,
        357_913_942,
        1 << 29,
        0x7fc0_0000, // NaN
        0x7f80_0000, // infinity
        0x7f00_0000, // 1.7e38
    ];
    if content.is_empty() {
        return;
    }
    for _ in 0..=bytes.below(3) {
        let at = bytes.below(content.len());
        match bytes.below(8) {
            0 => content[at] ^= 1 << bytes.below(8),
            1 => content[at] = bytes.word() as u8,
            // The header contains the counts.
            2..5 if content.len() >= 4 => {
                let words = if bytes.once_in(2) { content.len() / 4 } else { 8.min(content.len() / 4) };
                let count = content.starts_with(b"      ") && content.len() >= 84 && bytes.once_in(2);
                let at = if count { 80 } else { 4 * bytes.below(words) };
                let value = VALUES[bytes.below(VALUES.len())];
                content[at..at + 4].copy_from_slice(&value.to_le_bytes());
            }
            5 => content.truncate(at.max(1)),
            6 => content.extend(std::iter::repeat_n(0, bytes.below(40))),
            // In a text: another number, or an invalid number.
            _ => {
                let words = [
                    &b"0"[..],
                    b"-1",
                    b"-9",
                    b"99",
                    b"2147483648",
                    b"1e300",
                    b"nan",
                    b"f 1 2 3",
                    b"",
                    b"/",
                    b"\n",
                    b"//",
                ];
                let end =
                    content[at..].iter().position(|byte| b" /\n".contains(byte)).map_or(content.len(), |end| at + end);
                content.splice(at..end, words[bytes.below(words.len())].iter().copied());
            }
        }
        if content.is_empty() {
            content.push(b' ');
        }
    }
}
