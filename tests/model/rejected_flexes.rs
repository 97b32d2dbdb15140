//! Flexes on which the compiler or the visualiser crashes, and similar ones that load.

#![forbid(unsafe_code)]

use mujoco_safe::Model;

const CORNERS: &str = "0 0 0 1 0 0 0 1 0 0 0 1";
/// The tetrahedra of a simplex of four dimensions.
const CLOSED: &str = "0 1 2 3 0 1 2 4 0 1 3 4 0 2 3 4 1 2 3 4";

/// Loads a text with files on disk: the compiler of 3.5 looks up the file of a flex only there.
fn load(text: &str, files: &[(&str, &[u8])]) -> Result<Model, String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in [("model.xml", text.as_bytes())].iter().chain(files) {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    Model::from_xml_path(folder.path().join("model.xml")).map_err(|error| error.to_string())
}

fn flexcomp(attributes: &str) -> String {
    format!("<mujoco><worldbody><body name='b'><flexcomp name='f' {attributes}/></body></worldbody></mujoco>")
}

/// Returns a flex of eight bodies.
fn flex(attributes: &str) -> String {
    let body = |at: u32| {
        let [x, y, z] = [at & 1, at >> 1 & 1, at >> 2];
        format!("<body name='n{at}' pos='{x} {y} {z}'><joint type='slide'/><geom size='.01'/></body>")
    };
    let bodies: String = (0..8).map(body).collect();
    let contact = "<contact selfcollide='none'/>";
    let flex = format!("<flex name='f' {attributes}>{contact}</flex>");
    format!("<mujoco><worldbody>{bodies}</worldbody><deformable>{flex}</deformable></mujoco>")
}

/// Returns a file of Gmsh with the tetrahedra of four nodes.
fn gmsh(version: &str, elements: &[&str]) -> Vec<u8> {
    let count = elements.len();
    let coordinates = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let (nodes, head, tags) = if version == "2.2" {
        let nodes = (1..).zip(coordinates).map(|(tag, at)| format!("{tag} {at}\n")).collect::<Vec<_>>().concat();
        (format!("4\n{nodes}"), format!("{count}\n"), "4 2 0 1 ")
    } else {
        let nodes = format!("1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n{}\n", coordinates.join("\n"));
        (nodes, format!("1 {count} 1 {count}\n3 1 4 {count}\n"), "")
    };
    let elements =
        (1..).zip(elements).map(|(tag, nodes)| format!("{tag} {tags}{nodes}\n")).collect::<Vec<_>>().concat();
    let parts = [("MeshFormat", format!("{version} 0 8\n")), ("Nodes", nodes), ("Elements", head + &elements)];
    parts.map(|(name, part)| format!("${name}\n{part}$End{name}\n")).concat().into_bytes()
}

/// Returns a file of Gmsh in binary format with a tetrahedron, and a number of elements in its
/// header.
fn binary_gmsh(times: usize, count: u64) -> Vec<u8> {
    let words = |words: &[u64]| words.iter().flat_map(|word| word.to_ne_bytes()).collect::<Vec<u8>>();
    let header = |count: u64, kind: u64| words(&[1, count, 1, count, (1 << 32) | 3, kind]);
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].concat();
    let points: Vec<u8> = points.iter().flat_map(|number: &f64| number.to_ne_bytes()).collect();
    // The type of the elements is followed by their number without padding.
    let head = |count: u64, kind: u64| [&header(count, kind)[..44], &count.to_ne_bytes()].concat();
    let elements = words(&[1, 1, 2, 3, 4]).repeat(times);
    let parts: [&[u8]; 5] = [
        b"$MeshFormat\n4.1 1 8\n\x01\x00\x00\x00\n$EndMeshFormat\n$Nodes\n",
        &[head(4, 0), words(&[1, 2, 3, 4]), points].concat(),
        b"\n$EndNodes\n$Elements\n",
        &[head(count, 4), elements].concat(),
        b"\n$EndElements\n",
    ];
    parts.concat()
}

/// Returns a tetrahedron as OBJ, with each face a number of times.
fn obj(times: usize, vertices: &str) -> Vec<u8> {
    let faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n".repeat(times);
    format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{vertices}{faces}").into_bytes()
}

/// The compiler reads the root of an empty hierarchy of bounding volumes.
#[test]
fn tetrahedra_without_a_border_are_rejected() {
    for element in ["0 1 2 3 0 1 2 3", "0 1 2 3 1 2 0 3", CLOSED] {
        for text in [
            flexcomp(&format!("type='direct' dim='3' point='{CORNERS} 1 1 1' element='{element}'")),
            flexcomp(&format!("type='direct' dim='3' rigid='true' point='{CORNERS} 1 1 1' element='{element}'")),
            flex(&format!("dim='3' body='n0 n1 n2 n4 n7' element='{element}'")),
        ] {
            let error = load(&text, &[]).unwrap_err();
            assert!(error.contains("no face that belongs to only one of them"), "{element}: {error}");
        }
    }
    // The compiler appends its own tetrahedra to these, which are the same.
    let cube = "0 6 4 7 0 4 1 7 4 6 2 7 4 2 3 7 4 5 1 7 4 3 5 7";
    let text = flexcomp(&format!("type='grid' dim='3' count='2 2 2' spacing='.1 .1 .1' radius='.01' element='{cube}'"));
    let error = load(&text, &[]).unwrap_err();
    assert!(error.contains("only a flexcomp of type direct"), "{error}");

    let solid = flexcomp("type='mesh' dim='3' file='f.obj' origin='.1 .1 .1'");
    let error = load(&solid, &[("f.obj", &obj(2, ""))]).unwrap_err();
    assert!(error.contains("has a face twice"), "{error}");
    for version in ["2.2", "4.1"] {
        let file = gmsh(version, &["1 2 3 4"; 2]);
        let error = load(&flexcomp("type='gmsh' dim='3' file='f.msh'"), &[("f.msh", &file)]).unwrap_err();
        assert!(error.contains("without a face that belongs to only one"), "{version}: {error}");
    }
    let text = flexcomp("type='gmsh' dim='3' file='f.msh'");
    let error = load(&text, &[("f.msh", &binary_gmsh(2, 2))]).unwrap_err();
    assert!(error.contains("without a face that belongs to only one"), "{error}");
    let error = load(&text, &[("f.msh", &binary_gmsh(1, u64::MAX / 40 + 1))]).unwrap_err();
    assert!(error.contains("is not a Gmsh file in the text format 2.2"), "{error}");
    for length in [4096 - 64, 4096 - 16, 50 * 4096 - 16] {
        let mut file = gmsh("2.2", &["1 2 3 4"]);
        file.resize(length, b'\n');
        let error = load(&text, &[("f.msh", &file)]).unwrap_err();
        assert!(error.contains("append a line break"), "{length}: {error}");
        file.push(b'\n');
        let other = load(&text, &[("f.msh", &file)]).err().unwrap_or_default();
        assert!(!other.contains("append a line break"), "{length}: {other}");
    }
    let older = String::from_utf8(gmsh("2.2", &["1 2 3 4"])).unwrap().replace("2.2 0", "2.2 1");
    let error = load(&text, &[("f.msh", older.as_bytes())]).unwrap_err();
    assert!(error.contains("is not a Gmsh file in the text format 2.2"), "{error}");
}

#[test]
fn lists_that_contradict_each_other_are_rejected() {
    let nodes = "n0 n1 n2 n3 n4 n5 n6 n7";
    let dof = if cfg!(engine_since = "3.6.0") { "dof='trilinear'" } else { "" };
    let solid = format!("{dof} dim='3' element='0 1 2 3' node='{nodes}'");
    let texture = "dim='2' body='n0 n1 n2' vertex='0 0 0 0 0 0 0 0 0' element='0 1 2' texcoord='0 0 1 0 1 1'";
    let (many, few) = ("0 1 2 ".repeat(500), "0 0 0 ".repeat(400));
    for (text, expected) in [
        (flex(&format!("{solid} body='n0' vertex='{CORNERS}'")), "a body for each vertex"),
        (flex(&format!("{solid} body='n0 n1 n2 n3'")), "a body for each vertex"),
        (flex(&format!("dim='3' element='0 1 2 3' node='n0' body='n0 n0 n0 n0' vertex='{CORNERS}'")), "at least 8"),
        (flex(&format!("{texture} elemtexcoord='{many}'")), "elemtexcoord an index"),
        (flex(&format!("{texture} elemtexcoord='0 1 9999999'")), "elemtexcoord an index"),
        (flexcomp(&format!("type='direct' dim='2' point='{few}' element='0 1 399' texcoord='0 0'")), "two numbers"),
    ] {
        let error = load(&text, &[]).unwrap_err();
        assert!(error.contains(expected), "{text:.300}: {error}");
    }
    let coordinates = format!("{solid} body='n0 n0 n0 n0' vertex='{CORNERS}' nodecoord='1 1 1'");
    let error = load(&flex(&coordinates), &[]).unwrap_err();
    assert!(error.contains("three numbers for each node"), "{error}");
    // Most vertices have no face, and the only texture coordinate is that of all corners.
    let vertices = (0..400).map(|at| format!("v {at} 1 2\n")).collect::<Vec<_>>().concat();
    let faces = "f 1/1 3/1 2/1\nf 1/1 2/1 4/1\nf 1/1 4/1 3/1\nf 2/1 3/1 400/1\n";
    let file = format!("{vertices}vt 0 0\n{faces}");
    if cfg!(not(engine_since = "4.0.0")) {
        let error = load(&flexcomp("type='mesh' dim='2' file='f.obj'"), &[("f.obj", file.as_bytes())]).unwrap_err();
        assert!(error.contains("must have dim 2 and use all vertices"), "{error}");
    }
}

/// The visualiser takes the vertices of an open border as indices of texture coordinates.
#[test]
#[cfg_attr(not(engine_since = "3.5.0"), ignore = "older engines have no indices of texture coordinates")]
fn a_border_without_texture_coordinates_is_rejected() {
    let attributes = "dim='2' body='n0 n1 n2' vertex='0 0 0 0 0 0 0 0 0' element='0 1 2' elemtexcoord='0 0 0'";
    let error = load(&flex(&format!("{attributes} texcoord='0 0'")), &[]).unwrap_err();
    assert!(error.contains("flex_shell[") && error.contains("it must be from 0 to 0"), "{error}");
    assert!(load(&flex(&format!("{attributes} texcoord='0 0 0 0 0 0'")), &[]).is_ok());
}

#[cfg(engine_since = "3.5.0")]
mod similar {
    use mujoco_safe::scene::{Camera, Categories, SceneOptions, VisualFlags};
    use mujoco_safe::{Data, Scene};

    use super::{CLOSED, CORNERS, binary_gmsh, flex, flexcomp, gmsh, load, obj};

    /// The faces of a tetrahedron.
    const SURFACE: &str = "0 1 2 0 1 3 0 2 3 1 2 3";

    /// The numbers of elements are those of the texts. A tetrahedron has 4 faces of 3 vertices, and
    /// a closed surface has no border.
    #[test]
    fn similar_flexes_load() {
        let direct = |attributes: &str| flexcomp(&format!("type='direct' {attributes}"));
        let both = format!("{CLOSED} 5 6 7 8");
        let far = "7 0 0 8 0 0 7 1 0 7 0 1";
        let unused = "point='9 9 9 0 0 0 1 0 0 0 1 0' element='1 2 3' texcoord='9 9 0 0 1 0 0 1'";
        let solid = "type='mesh' dim='3' file='f.obj' origin='.1 .1 .1'";
        for (text, file, [vertices, elements, shell]) in [
            (direct(&format!("dim='3' point='{CORNERS}' element='0 1 2 3'")), vec![], [4, 1, 12]),
            (direct(&format!("dim='3' point='{CORNERS} 1 1 1 {far}' element='{both}'")), vec![], [9, 6, 12]),
            (direct(&format!("dim='2' point='{CORNERS}' element='{SURFACE}'")), vec![], [4, 4, 0]),
            (direct(&format!("dim='2' point='{CORNERS}' element='0 1 2 0 1 2'")), vec![], [3, 2, 0]),
            (direct(&format!("dim='1' point='{CORNERS}' element='0 1 1 2 2 0'")), vec![], [3, 3, 0]),
            (direct(&format!("dim='2' {unused}")), vec![], [3, 1, 6]),
            (flex(&format!("dim='2' body='n0 n1 n2 n4' element='{SURFACE}'")), vec![], [4, 4, 0]),
            // A vertex at the origin of the four faces, and a vertex that has no face.
            (flexcomp(solid), obj(1, "v 5 5 5\n"), [5, 4, 12]),
            (flexcomp("type='mesh' dim='2' file='f.obj'"), obj(2, "v 5 5 5\n"), [4, 8, 0]),
            (flexcomp("type='gmsh' dim='3' file='f.msh'"), gmsh("2.2", &["1 2 3 4"]), [4, 1, 12]),
            (flexcomp("type='gmsh' dim='3' file='f.msh'"), gmsh("4.1", &["1 2 3 4"]), [4, 1, 12]),
            (flexcomp("type='gmsh' dim='3' file='f.msh'"), binary_gmsh(1, 1), [4, 1, 12]),
        ] {
            let model =
                load(&text, &[("f.obj", &file), ("f.msh", &file)]).unwrap_or_else(|error| panic!("{text}: {error}"));
            let found = [model.nflexvert(), model.nflexelem(), model.nflexshelldata()];
            assert_eq!(found, [vertices, elements, shell], "{text}");
            let mut data = Data::new(model).unwrap();
            data.step().unwrap();
            let mut scene = Scene::new(data.model(), 100).unwrap();
            let mut camera = Camera::free(data.model());
            for flags in [VisualFlags::FLEXFACE, VisualFlags::FLEXSKIN] {
                let options = SceneOptions::default().with_flags(flags);
                scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
            }
        }
    }
}
