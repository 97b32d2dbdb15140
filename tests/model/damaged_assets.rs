//! Damaged files of meshes, skins, height fields and textures, with which the engine's compiler
//! accesses memory out of bounds: each is rejected.

#![forbid(unsafe_code)]

use mujoco_safe::{LoadOptions, Model};

use crate::{DEVICE, is_default};

fn integers(values: &[i32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_ne_bytes()).collect()
}

fn reals(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_ne_bytes()).collect()
}

const TETRAHEDRON: [f32; 12] = [0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.3];
const FACES: [i32; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];

fn msh(header: [i32; 4], vertices: &[f32], faces: &[i32]) -> Vec<u8> {
    [integers(&header), reals(vertices), integers(faces)].concat()
}

/// Returns a skin of one bone, the world.
fn skin(header: [i32; 4], faces: &[i32], vertices_of_bone: i32) -> Vec<u8> {
    let mut name = *b"world                                   ";
    name[5..].fill(0);
    let pose = reals(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let bone = [integers(&[vertices_of_bone, 0, 1, 2, 3]), reals(&[1.0; 4])].concat();
    [integers(&header), reals(&TETRAHEDRON), integers(faces), name.to_vec(), pose, bone].concat()
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut file = include_bytes!("../models/grey.png").to_vec();
    file[16..20].copy_from_slice(&width.to_be_bytes());
    file[20..24].copy_from_slice(&height.to_be_bytes());
    file
}

/// Returns a text with an asset and a geom that uses it.
fn with_asset(asset: &str) -> String {
    let kind = asset[1..].split(' ').next().unwrap();
    let geom = match kind {
        "mesh" => "<body><freejoint/><geom type='mesh' mesh='a'/></body>",
        "hfield" => "<geom type='hfield' hfield='a'/>",
        _ => "",
    };
    format!("<mujoco><compiler meshdir='parts'/><asset>{asset}</asset><worldbody>{geom}</worldbody></mujoco>")
}

#[test]
fn damaged_files_that_make_the_compiler_access_memory_out_of_bounds_are_rejected() {
    let obj = |text: &str| format!("v 0 0 0\nv .3 0 0\nv 0 .3 0\nv 0 0 .3\n{text}\n").into_bytes();
    let faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4";
    let tetrahedron = |texts: &str| obj(&format!("{faces}\n{texts}"));
    let mut not_finite = TETRAHEDRON;
    not_finite[7] = f32::NAN;
    let mut outside = FACES;
    outside[5] = 4;
    let mut negative = FACES;
    negative[11] = -1_000_000;
    let mesh = ("a.msh", "<mesh name='a' file='a.msh'/>");
    let object = ("a.obj", "<mesh name='a' file='sub/a.OBJ'/>");
    let skinned = ("a.skn", "<skin name='a' file='a.skn'/>");
    let field = ("a.raw", "<hfield name='a' file='a.raw' size='1 1 1 1'/>");
    let texture = ("a.raw", "<texture name='a' type='2d' file='a.raw'/>");
    let cube = ("a.png", "<texture name='a' type='cube' fileup='a.png'/>");
    let picture = ("a.png", "<hfield name='a' file='a.png' size='1 1 1 1'/>");
    let good = "";
    for ((name, asset), content, expected) in [
        (mesh, msh([4, 0, 0, 4], &TETRAHEDRON, &FACES), good),
        (mesh, msh([4, 0, 0, 4], &TETRAHEDRON, &outside), "has a face with a nonexistent vertex"),
        (mesh, msh([4, 0, 0, 4], &TETRAHEDRON, &negative), "has a face with a nonexistent vertex"),
        (mesh, msh([4, 0, 0, 4], &not_finite, &FACES), "not finite"),
        (mesh, msh([4, 4, 0, 4], &[TETRAHEDRON, not_finite].concat(), &FACES), "not finite"),
        // 3 × 4 × 1431655766 is 8 in 32 bits.
        (mesh, msh([1_431_655_766, 0, 0, 0], &TETRAHEDRON[..2], &[]), "a size that contradicts its header"),
        (object, tetrahedron(""), good),
        (object, obj("f -4 -2 -3\nf 1 2 4\nf 1 4 3\nf 2 3 4"), good),
        (object, tetrahedron("f 1 2 5"), "has a face with a nonexistent vertex"),
        (object, tetrahedron("f 1 2 -5"), "has a face with a nonexistent vertex"),
        (object, tetrahedron("f 1 2"), "three or more vertices"),
        (object, tetrahedron("f 1 2 x"), "three or more vertices"),
        (object, tetrahedron("vn 0 0 1"), "without a normal"),
        (object, tetrahedron("f 1//1 2//1 3//1"), "a nonexistent normal or texture coordinate"),
        (object, obj("vn 0 0 1"), "without a normal"),
        (object, tetrahedron("v nan 0 0"), "not finite"),
        (object, b"v 0 0 0\nv .3 0 0\nv 0 .3 0".to_vec(), "fewer than the four vertices"),
        (skinned, skin([4, 0, 4, 1], &FACES, 4), good),
        (skinned, skin([4, 0, 4, 1], &outside, 4), "has a face with a nonexistent vertex"),
        (skinned, skin([4, 0, 4, 1], &FACES, 1 << 30), "a size that contradicts its header"),
        (skinned, skin([357_913_942, 0, 4, 1], &FACES, 4), "a size that contradicts its header"),
        (skinned, skin([4, 0, 4, 2], &FACES, 4), "a size that contradicts its header"),
        (field, [integers(&[2, 3]), reals(&[0.0, 0.1, 0.2, 0.3, 0.4, 0.5])].concat(), good),
        (field, [integers(&[65_536, 65_537]), vec![1; 4 * 65_536]].concat(), "a size that contradicts its header"),
        (texture, [integers(&[2, 2]), vec![1; 12]].concat(), good),
        (texture, vec![1], "a size that contradicts its header"),
        (texture, integers(&[2]), "a size that contradicts its header"),
        (field, vec![1; 7], "a size that contradicts its header"),
        (mesh, vec![1; 15], "a size that contradicts its header"),
        (skinned, vec![1; 12], "a size that contradicts its header"),
        (texture, [integers(&[0x4000_0001, 4]), vec![1; 12]].concat(), "a size that contradicts its header"),
        (cube, png(6, 6), good),
        (cube, png(20_000, 20_000), "too many pixels"),
        (cube, png(11_000, 11_000), "too many pixels"),
        (picture, png(6, 6), good),
        (picture, png(u32::MAX, u32::MAX), "too many pixels"),
    ]
    .into_iter()
    // Newer compilers do not read the engine's texture format.
    .filter(|(asset, _, expected)| is_default() || *asset != texture || *expected != good)
    {
        match Model::from_xml_str_with(&with_asset(asset), &LoadOptions::default().with_files(&[(name, &content)])) {
            Ok(_) => assert_eq!(expected, good, "{asset}, {name}"),
            Err(error) => {
                assert!(expected != good && error.to_string().contains(expected), "{asset}: {error}");
            }
        }
    }
}

#[test]
fn texture_coordinates_without_indices_in_faces_are_rejected_where_the_compiler_crashes() {
    let corners = "0 0 0 1 1 0 1 1";
    let text = format!(
        "<mesh name='a' vertex='0 0 0 .3 0 0 0 .3 0 0 0 .3' face='0 2 1 0 1 3 0 3 2 1 2 3' texcoord='{corners}'/>"
    );
    let obj = |elements: &str| {
        format!("v 0 0 0\nv .3 0 0\nv 0 .3 0\nv 0 0 .3\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n{elements}\n").into_bytes()
    };
    let faces = "f 1/1 3/3 2/2\nf 1/1 2/2 4/4\nf 1/1 4/4 3/3\nf 2/2 3/3 4/4";
    let texcoords = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let msh = |faces: &[i32]| {
        [msh([4, 0, 4, faces.len() as i32 / 3], &TETRAHEDRON, &[]), reals(&texcoords), integers(faces)].concat()
    };
    let (object, mesh) = ("<mesh name='a' file='a.obj'/>", "<mesh name='a' file='a.msh'/>");
    for (asset, content, has_indices) in [
        (&text[..], b"unused".to_vec(), false),
        (object, obj(faces), true),
        (object, obj(""), false),
        // The compiler's first shape is a line.
        (object, obj(&format!("l 1 2\ng b\n{faces}")), false),
        (mesh, msh(&FACES), true),
        (mesh, msh(&[]), false),
    ] {
        let files = [("a.obj", &content[..]), ("a.msh", &content[..])];
        let loaded = Model::from_xml_str_with(&with_asset(asset), &LoadOptions::default().with_files(&files));
        let crashes = cfg!(all(engine_since = "2.3.3", not(engine_since = "3.1.3"))) && !has_indices;
        match loaded {
            Ok(model) => assert!(!crashes && model.nmesh() == 1, "{asset}"),
            Err(error) => {
                let is_reason = error.to_string().contains("texture coordinates");
                // A file whose first shape has no faces is an error of other compilers, or a model
                // without these faces.
                assert!(if crashes { is_reason } else { !has_indices && !is_reason }, "{asset}: {error}");
            }
        }
    }
}

#[test]
fn a_damaged_file_is_found_in_every_directory_of_the_compiler() {
    let dir = std::env::temp_dir().join(format!("mujoco_safe_assets_{}", std::process::id()));
    std::fs::create_dir_all(dir.join("meshes")).unwrap();
    let path = dir.join("model.xml");
    let damaged = msh([4, 0, 0, 1], &TETRAHEDRON, &[0, 1, 4]);
    let good = msh([4, 0, 0, 4], &TETRAHEDRON, &FACES);
    let mesh = dir.join("meshes/a.msh");
    for (compiler, file) in [
        ("meshdir='meshes'", "a.msh"),
        ("meshdir='meshes/'", "a&#46;msh"),
        ("", "meshes/a.msh"),
        ("meshdir='&#x6d;eshes' strippath='true'", "no/such/a.msh"),
        (&format!("meshdir='{}'", dir.join("meshes").display()), "a.msh"),
        ("meshdir='no such'", &mesh.display().to_string()),
    ] {
        let mesh_text = format!("<asset><mesh name='a' file='{file}'/></asset>");
        let geom = "<worldbody><geom type='mesh' mesh='a'/></worldbody>";
        // The directory may be named after the mesh.
        let text = format!("<mujoco>{mesh_text}{geom}<compiler {compiler}/></mujoco>");
        std::fs::write(&path, text).unwrap();
        std::fs::write(&mesh, &damaged).unwrap();
        let error = Model::from_xml_path(&path).unwrap_err();
        assert!(error.to_string().contains("has a face with a nonexistent vertex"), "{compiler}, {file}: {error}");
        std::fs::write(&mesh, &good).unwrap();
        assert_eq!(Model::from_xml_path(&path).unwrap().nmesh(), 1, "{compiler}, {file}");
    }
    // The engine's reader opens the material libraries that a mesh names.
    let object =
        format!("mtllib {DEVICE}\nv 0 0 0\nv .3 0 0\nv 0 .3 0\nv 0 0 .3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    std::fs::write(dir.join("a.obj"), object).unwrap();
    std::fs::write(&path, "<mujoco><asset><mesh name='a' file='a.obj'/></asset></mujoco>").unwrap();
    assert!(Model::from_xml_path(&path).unwrap_err().to_string().contains("material file"));

    if !is_default() {
        // Newer compilers open package URIs as they are.
        return std::fs::remove_dir_all(&dir).unwrap();
    }
    let robot = dir.join("robot.urdf");
    let link = "<link name='l'><visual><geometry><mesh filename='package://meshes/a.msh'/></geometry></visual></link>";
    let collision = link.replace("visual", "collision");
    std::fs::write(&robot, format!("<robot name='r'><mujoco><compiler meshdir='meshes'/></mujoco>{collision}</robot>"))
        .unwrap();
    assert_eq!(Model::from_xml_path(&robot).unwrap().nmesh(), 1);
    std::fs::write(&mesh, &damaged).unwrap();
    assert!(Model::from_xml_path(&robot).unwrap_err().to_string().contains("has a face with a nonexistent vertex"));
    std::fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn elements_of_newer_compilers_that_exhaust_memory_or_hide_a_format_are_rejected() {
    let nested = |counts: &[&str]| {
        let open = counts.iter().map(|count| format!("<replicate count='{count}'>")).collect::<Vec<_>>().concat();
        format!("<worldbody>{open}<geom size='.1'/>{}</worldbody>", "</replicate>".repeat(counts.len()))
    };
    // On a flex without an active layer the compiler crashes.
    let flex = |layers: &str| {
        format!(
            "<worldbody><body name='b'><geom size='.1'/></body></worldbody><deformable><flex name='f' dim='3' body='b' element='0 1 2 3'
             vertex='0 0 0  1 0 0  0 1 0  0 0 1'><contact activelayers='{layers}'/></flex></deformable>"
        )
    };
    for (xml, expected) in [
        (nested(&["1000000000"]), "1000000 elements"),
        (nested(&["99999999999"]), "1000000 elements"),
        (nested(&["200", "200", "200"]), "1000000 elements"),
        ("<worldbody><flexcomp name='f' type='grid' count='9999 9999 9999'/></worldbody>".to_owned(), "32766 bodies"),
        ("<asset><hfield name='h' size='1 1 1 1' file='h.txt' content_type='x/y'/></asset>".to_owned(), "content_type"),
        ("<asset><mesh name='m' file='m.txt' content_type='model/obj'/></asset>".to_owned(), "content_type"),
        ("<asset><mesh name='m' builtin='sphere' params='1e9'/></asset>".to_owned(), "generated mesh"),
        ("<asset><mesh name='m' builtin='sphere' params='nan'/></asset>".to_owned(), "generated mesh"),
        ("<asset><mesh name='m' builtin='supersphere' params='201 1 1'/></asset>".to_owned(), "at most 200"),
        (
            "<asset><texture name='t' builtin='flat' type='2d' width='9000' height='9000' nchannel='99'/></asset>"
                .to_owned(),
            "too large",
        ),
        ("<sensor><contact num='2000000000'/></sensor>".to_owned(), "num must be"),
        ("<actuator><motor nsample='2000000000'/></actuator>".to_owned(), "nsample must be"),
        ("<size nuserdata='2000000000'/>".to_owned(), "nuserdata must be"),
        (flex("-1"), "activelayers must be"),
        (flex("0"), "activelayers must be"),
        (flex("1e15"), "activelayers must be"),
    ] {
        let error = Model::from_xml_str(&format!("<mujoco>{xml}</mujoco>")).unwrap_err();
        assert!(error.to_string().contains(expected), "{xml:.60}: {error}");
    }
    // A replication of moderate size passes the check. The compiler of 2.2.2 does not have the
    // element.
    match Model::from_xml_str(&format!("<mujoco>{}</mujoco>", nested(&["10", "20"]))) {
        Ok(model) => assert_eq!(model.ngeom(), 200),
        Err(error) => assert!(error.to_string().contains("unrecognized element"), "{error}"),
    }
}

#[test]
fn a_damaged_file_is_found_by_every_path_that_a_newer_compiler_opens() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &[u8]| std::fs::write(folder.path().join(name), content).unwrap();
    // The header states more elevations than the file has.
    let damaged = [integers(&[30_000, 30_000]), reals(&[0.0; 4])].concat();
    std::fs::create_dir(folder.path().join("assets")).unwrap();
    write("assets/h.bin", &damaged);
    for (compiler, file) in [
        ("assetdir='assets'", "h.bin"),
        ("", "assets/h.bin"),
        ("", "nowhere/../assets/h.bin"),
        ("", "./assets/./h.bin"),
        ("meshdir='nowhere/../assets'", "h.bin"),
    ] {
        let field = format!("<hfield name='h' size='1 1 1 1' file='{file}'/>");
        write("model.xml", format!("<mujoco><compiler {compiler}/><asset>{field}</asset></mujoco>").as_bytes());
        let error = Model::from_xml_path(folder.path().join("model.xml")).unwrap_err().to_string();
        let is_reported = error.contains("contradicts its header");
        // The compiler of 2.2.2 opens the path as it is.
        let opens = !file.contains("..") && !compiler.contains("..") && !compiler.contains("assetdir");
        assert!(is_reported || is_default() && !opens, "{compiler} {file}: {error}");
    }
}
