//! Small handwritten files of every type that a model can reference.

/// The vertices of a tetrahedron.
pub const VERTICES: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]];
/// The faces of the tetrahedron, counter-clockwise seen from outside.
pub const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn floats(values: impl IntoIterator<Item = f32>) -> Vec<u8> {
    values.into_iter().flat_map(f32::to_le_bytes).collect()
}

fn integers(values: impl IntoIterator<Item = u32>) -> Vec<u8> {
    values.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// Binary STL: a header of 80 bytes, the number of faces, and for each face its normal, three
/// vertices, and two bytes.
pub fn stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(integers([4]));
    for face in FACES {
        bytes.extend(floats([0.0; 3]));
        bytes.extend(face.iter().flat_map(|&corner| floats(VERTICES[corner as usize])));
        bytes.extend([0, 0]);
    }
    bytes
}

/// OBJ: text, with indices from 1.
pub fn obj() -> Vec<u8> {
    let corners = VERTICES.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = FACES.map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).concat();
    (corners + &faces).into_bytes()
}

/// The engine's mesh format: the numbers of vertices, normals, texture coordinates and faces, and
/// then the arrays.
pub fn msh() -> Vec<u8> {
    let mut bytes = integers([4, 0, 0, 4]);
    bytes.extend(floats(VERTICES.into_iter().flatten()));
    bytes.extend(integers(FACES.into_iter().flatten()));
    bytes
}

/// The engine's skin format: the numbers of vertices, texture coordinates, faces and bones, then
/// the first three arrays, and for each bone a name of 40 bytes, a position, a quaternion, and its
/// vertices with their weights.
pub fn skn(body: &str) -> Vec<u8> {
    let mut bytes = integers([4, 0, 4, 1]);
    bytes.extend(floats(VERTICES.into_iter().flatten()));
    bytes.extend(integers(FACES.into_iter().flatten()));
    bytes.extend(body.bytes().chain(std::iter::repeat(0)).take(40));
    bytes.extend(floats([0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]));
    bytes.extend(integers([4, 0, 1, 2, 3]));
    bytes.extend(floats([1.0; 4]));
    bytes
}

/// The engine's height field format: rows, columns, heights.
pub fn height_field() -> Vec<u8> {
    let mut bytes = integers([3, 2]);
    bytes.extend(floats([0.0, 1.0, 2.0, 3.0, 4.0, 8.0]));
    bytes
}

/// The engine's texture format: width, height, colours.
pub fn texture() -> Vec<u8> {
    let mut bytes = integers([2, 1]);
    bytes.extend([10, 20, 30, 40, 50, 60]);
    bytes
}

/// Name of the second texture: newer engines do not read the engine's texture format.
#[cfg(not(engine_since = "2.3.0"))]
macro_rules! strip {
    () => {
        "strip.tex"
    };
}
#[cfg(engine_since = "2.3.0")]
macro_rules! strip {
    () => {
        "strip.png"
    };
}

/// Name of the skin: newer compilers search for it beside the model.
#[cfg(not(engine_since = "2.3.0"))]
macro_rules! skin {
    () => {
        "cover.skn"
    };
}
#[cfg(engine_since = "2.3.0")]
macro_rules! skin {
    () => {
        "meshes/cover.skn"
    };
}

fn strip() -> Vec<u8> {
    if strip!().ends_with("png") { png(png::ColorType::Rgb, 2, 1, &texture()[8..]) } else { texture() }
}

pub fn png(colour: png::ColorType, width: u32, height: u32, samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.write_header().unwrap().write_image_data(samples).unwrap();
    bytes
}

/// Names and contents of all files that [`MODEL`] and [`PART`] reference.
pub fn all() -> Vec<(&'static str, Vec<u8>)> {
    let colours: Vec<u8> = (0..4 * 4 * 3).map(|index| index * 5).collect();
    vec![
        ("part.xml", PART.as_bytes().to_vec()),
        ("meshes/solid.stl", stl()),
        ("meshes/solid.obj", obj()),
        ("meshes/solid.msh", msh()),
        ("meshes/cover.skn", skn("bone")),
        ("meshes/hills.bin", height_field()),
        ("meshes/dunes.png", png(png::ColorType::Grayscale, 3, 2, &[0, 50, 100, 150, 200, 250])),
        ("images/flat.png", png(png::ColorType::Rgb, 4, 4, &colours)),
        (concat!("images/", strip!()), strip()),
    ]
}

pub const MODEL: &str = r#"<mujoco model="files">
  <compiler meshdir="meshes/" texturedir="images/"/>
  <include file="part.xml"/>
  <worldbody>
    <geom type="hfield" hfield="hills"/>
    <geom type="hfield" hfield="dunes" pos="5 0 0"/>
    <body name="bone" pos="0 0 1">
      <freejoint/>
      <geom type="mesh" mesh="stl" material="flat"/>
      <geom type="mesh" mesh="obj" pos="1 0 0"/>
      <geom type="mesh" mesh="msh" pos="2 0 0"/>
    </body>
  </worldbody>
</mujoco>"#;

pub const PART: &str = concat!(
    r#"<mujoco>
  <asset>
    <mesh name="stl" file="solid.stl"/>
    <mesh name="obj" file="solid.obj"/>
    <mesh name="msh" file="solid.msh"/>
    <skin name="cover" file=""#,
    skin!(),
    r#""/>
    <hfield name="hills" file="hills.bin" size="1 1 1 .1"/>
    <hfield name="dunes" file="dunes.png" size="1 1 1 .1"/>
    <texture name="flat" type="2d" file="flat.png"/>
    <texture name="strip" type="2d" file=""#,
    strip!(),
    r#""/>
    <material name="flat" texture="flat"/>
  </asset>
</mujoco>"#
);

pub const URDF: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="link">
    <inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://arm/meshes/solid.stl"/></geometry></visual>
    <collision><geometry><mesh filename="package://arm/meshes/solid.stl" scale="2 2 2"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="link"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>"#;

/// Returns a folder with every file of [`all`], [`MODEL`] and [`URDF`].
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in all() {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    std::fs::write(folder.path().join("model.xml"), MODEL).unwrap();
    // The engine searches for the meshes of a URDF in its folder.
    std::fs::write(folder.path().join("arm.urdf"), URDF).unwrap();
    std::fs::write(folder.path().join("solid.stl"), stl()).unwrap();
    folder
}
