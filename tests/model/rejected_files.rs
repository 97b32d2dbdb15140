//! An unusable file is an error that names the file.

use mujoco_safe::{Error, LoadOptions, Model};

use crate::{assets, folder, from_memory};

fn error(xml: &str, files: &[(&str, &[u8])]) -> String {
    Model::from_xml_str_with(xml, &LoadOptions::default().with_files(files)).unwrap_err().to_string()
}

#[test]
fn file_names_that_the_engine_cannot_store_are_rejected() {
    let long = "n".repeat(1000);
    for (name, expected) in [
        ("", "named with 0 bytes"),
        ("folder/", "named with 0 bytes"),
        ("folder\\", "named with 0 bytes"),
        (&long, "named with 1000 bytes"),
        ("a\0b", "NUL byte"),
    ] {
        let error = error("<mujoco/>", &[(name, b"content")]);
        assert!(error.contains(expected), "{error}");
    }
    Model::from_xml_str_with("<mujoco/>", &LoadOptions::default().with_files(&[(&long[..999], b"content")])).unwrap();
    let deep = format!("{}/{}", "folder/".repeat(1000), "a.xml");
    let include = r#"<mujoco><include file="a.xml"/></mujoco>"#;
    Model::from_xml_str_with(include, &LoadOptions::default().with_files(&[(&deep, b"<mujoco><worldbody/></mujoco>")]))
        .unwrap();
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files in memory with their path")]
fn two_files_of_the_same_name_for_the_engine_are_rejected() {
    for names in [["a.stl", "a.stl"], ["one/a.stl", "two/a.stl"], ["a.stl", "A.STL"], ["one\\a.stl", "a.stl"]] {
        let error = error("<mujoco/>", &[(names[0], b"content"), (names[1], b"content")]);
        assert!(error.contains(names[1]) && error.contains("given twice"), "{error}");
    }
    let error = error("<mujoco/>", &[("(main).xml", b"content")]);
    assert!(error.contains("(main).xml"), "{error}");
}

#[test]
fn empty_files_and_files_of_2_gib_are_rejected() {
    let message = error("<mujoco/>", &[("a.stl", b"")]);
    assert!(message.contains("'a.stl' is empty"), "{message}");
    // The pages are never touched, so the array takes no memory.
    let huge = vec![0; 1 << 31];
    let message = error("<mujoco/>", &[("a.stl", &huge)]);
    assert!(message.contains("'a.stl' is 2147483648 bytes long, but must be smaller than 2 GiB"), "{message}");
}

#[test]
fn a_damaged_file_is_an_error() {
    let all = assets::all();
    from_memory(assets::MODEL, &all).unwrap();
    for index in 1..all.len() {
        let (name, content) = &all[index];
        let longer = [content.as_slice(), b"123"].concat();
        let mut damaged: Vec<&[u8]> = vec![b"x", &content[..content.len() / 2]];
        // The readers of text and of PNG stop at the end of the content.
        if !name.ends_with("obj") && !name.ends_with("png") {
            damaged.extend([&content[..content.len() - 1], &longer]);
        }
        for damaged in damaged {
            let mut files = all.clone();
            files[index].1 = damaged.to_vec();
            // A truncated text may still be complete.
            match from_memory(assets::MODEL, &files) {
                Ok(_) => assert!(name.ends_with("obj"), "{name}, {} bytes of {}", damaged.len(), content.len()),
                Err(error) => {
                    let error = error.to_string();
                    assert!(error.starts_with("cannot load "), "{error}");
                }
            }
        }
    }
}

#[test]
fn loading_with_a_missing_file_names_the_file() {
    let all = assets::all();
    for index in 0..all.len() {
        let mut files = all.clone();
        let (name, _) = files.remove(index);
        let error = from_memory(assets::MODEL, &files).unwrap_err().to_string();
        // For an image, the compiler's message has the name of the texture or height field.
        let stem = name.rsplit('/').next().unwrap().split('.').next().unwrap();
        assert!(error.contains("cannot load the given XML") && error.contains(stem), "{name}: {error}");
    }
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files in memory with their path")]
fn damaged_files_are_rejected_by_every_way_of_loading() {
    let folder = folder();
    let path = folder.path().join("model.xml");
    let mut damaged = assets::msh();
    let last = damaged.len() - 4;
    damaged[last..].copy_from_slice(&9_u32.to_ne_bytes());
    let assert_rejected = |result: mujoco_safe::Result<Model>| {
        let error = result.unwrap_err().to_string();
        assert!(error.contains("model.xml") || error.contains("part.xml"), "{error}");
        assert!(error.contains("'solid.msh' has a face with a nonexistent vertex"), "{error}");
    };
    assert_rejected(Model::from_xml_path_with(&path, &LoadOptions::default().with_files(&[("solid.msh", &damaged)])));
    std::fs::write(folder.path().join("meshes/solid.msh"), &damaged).unwrap();
    assert_rejected(Model::from_xml_path(&path));
    assert_rejected(Model::from_xml_path_with(
        &path,
        &LoadOptions::default().with_files(&[("part.xml", assets::PART.as_bytes())]),
    ));
    Model::from_xml_path_with(&path, &LoadOptions::default().with_files(&[("solid.msh", &assets::msh())])).unwrap();
    for (files, expected) in [
        ([("a.stl", &b""[..]), ("b.stl", b"x")], "'a.stl' is empty"),
        ([("a.stl", b"x"), ("A.STL", b"x")], "given twice"),
        ([("a.stl", b"x"), ("(main).xml", b"x")], "given twice"),
    ] {
        let error =
            Model::from_xml_path_with(&path, &LoadOptions::default().with_files(&files)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let error = Model::from_xml_path_with(
        folder.path().join("no.xml"),
        &LoadOptions::default().with_files(&[("no.xml", b"<mujoco/>")]),
    )
    .unwrap_err();
    assert!(matches!(error, Error::File { .. }), "{error}");
    std::fs::write(&path, "").unwrap();
    let error = Model::from_xml_path(&path).unwrap_err().to_string();
    assert!(error.contains("model.xml: the text is empty"), "{error}");
}

#[test]
fn file_names_that_crash_the_engine_are_rejected_and_loading_still_works() {
    let folder = folder();
    let path = folder.path().join("invalid.xml");
    // With a muscle the compiler runs twice.
    let muscle = "<worldbody><body><joint name='j' range='-1 1' limited='true'/><geom size='.1' pos='.2 0 0'/></body></worldbody>
                  <actuator><muscle joint='j'/></actuator>";
    for muscle in ["", muscle] {
        for (element, expected) in [
            ("<include file=''/>", "is empty after its last slash"),
            ("<include file='no/'/>", "is empty after its last slash"),
            ("<asset><mesh file='no/'/></asset>", "is empty after its last slash"),
            ("<asset><mesh name='m' file='no/&#0;'/></asset>", "invalid character reference"),
            (&format!("<include file='{}'/>", "n".repeat(1000)), "longer than 900 bytes"),
        ] {
            std::fs::write(&path, format!("<mujoco>{element}{muscle}</mujoco>")).unwrap();
            let error = Model::from_xml_path(&path).unwrap_err().to_string();
            assert!(error.contains("invalid.xml") && error.contains(expected), "{element:.60}: {error}");
            Model::from_xml_str("<mujoco/>").unwrap();
        }
    }
}

#[test]
fn file_names_too_short_for_an_extension_are_rejected() {
    let folder = folder();
    for (asset, name) in [
        ("<mesh name='a' file='a'/>", "a"),
        ("<mesh name='a' file='ab'/>", "ab"),
        ("<skin name='a' file='a'/>", "a"),
        ("<hfield name='a' file='abc' size='1 1 1 1'/>", "abc"),
        ("<texture name='a' type='2d' file='a'/>", "a"),
        ("<texture name='a' type='cube' fileback='a'/>", "a"),
    ] {
        let message = error(&format!("<mujoco><asset>{asset}</asset></mujoco>"), &[(name, b"content")]);
        assert!(message.contains(&format!("'{name}' has a name too short for an extension")), "{message}");
    }
    // The compiler removes the extension from the full path.
    let path = folder.path().join("short.xml");
    std::fs::write(folder.path().join("a"), assets::height_field()).unwrap();
    let text = "<mujoco><asset><hfield file='a' size='1 1 1 1'/></asset></mujoco>";
    std::fs::write(&path, text).unwrap();
    assert_eq!(Model::from_xml_path(&path).unwrap().hfield_nrow(), [3]);
    let text = text.replace("<asset>", "<compiler meshdir='fields'/><asset>");
    assert_eq!(from_memory(&text, &[("a", assets::height_field())]).unwrap().hfield_nrow(), [3]);
}

/// Newer compilers also search the directory of an included text for the files that it names, and
/// distinguish upper and lower case. Since 3.5 they treat a file in memory as a directory.
#[test]
#[cfg(engine_since = "3.5.0")]
fn files_are_checked_wherever_the_compiler_finds_them() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &str| std::fs::write(folder.path().join(name), content).unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    let damaged = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 9\n";
    let mesh = r#"<mujoco><asset><mesh name="m" file="damaged.obj"/></asset></mujoco>"#;
    let field = r#"<mujoco><asset><hfield name="h" nrow="50000" ncol="50000" size="1 1 1 1"/></asset></mujoco>"#;
    write("parts/damaged.obj", damaged);
    write("parts/mesh.xml", mesh);
    write("parts/field.xml", field);
    write("parts/include.xml", r#"<mujoco><include file="field.xml"/></mujoco>"#);
    write("parts/x.xml", "<mujoco><worldbody/></mujoco>");
    write("parts/X.xml", field);
    let absolute = folder.path().join("parts/field.xml");
    for (includes, expected) in [
        (&["parts/mesh.xml"][..], "'damaged.obj' has a face with a nonexistent vertex"),
        (&["parts/include.xml"], "a height field is too large"),
        (&[absolute.to_str().unwrap()], "a height field is too large"),
        (&["parts/x.xml", "parts/X.xml"], "a height field is too large"),
    ] {
        let includes: Vec<String> = includes.iter().map(|file| format!(r#"<include file="{file}"/>"#)).collect();
        let includes = includes.concat();
        write("main.xml", &format!("<mujoco>{includes}</mujoco>"));
        let error = Model::from_xml_path(folder.path().join("main.xml")).unwrap_err().to_string();
        assert!(error.contains(expected), "{includes}: {error}");
    }
    let error = error(&mesh.replace("damaged.obj", "damaged/a.obj"), &[("damaged", damaged.as_bytes())]);
    assert!(error.contains("has a face with a nonexistent vertex"), "{error}");
}

/// A rangefinder over a height field.
fn rangefinder(field: &str) -> String {
    format!(
        "<mujoco><asset><hfield name='h' {field} size='1 1 1 1'/></asset>
         <worldbody><geom type='hfield' hfield='h'/><site name='s' pos='0 0 3' zaxis='1 0 -1'/></worldbody>
         <sensor><rangefinder site='s'/></sensor></mujoco>"
    )
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers reject height fields of one row")]
fn a_height_field_that_a_rangefinder_would_read_beyond_is_rejected_for_every_source() {
    let raw = |rows: u32, columns: u32| {
        let mut bytes = [rows, columns].map(u32::to_ne_bytes).concat();
        bytes.extend((0..rows * columns).flat_map(|cell| (cell as f32).to_ne_bytes()));
        bytes
    };
    let image = |rows: u32, columns: u32| {
        let samples: Vec<u8> = (0..rows * columns).map(|cell| cell as u8).collect();
        assets::png(png::ColorType::Grayscale, columns, rows, &samples)
    };
    let folder = folder();
    let path = folder.path().join("model.xml");
    for (rows, columns) in [(3, 2), (40, 39), (1, 4), (2, 2), (2, 5), (39, 40)] {
        let good = rows >= 2 && rows <= columns;
        let check = |what: &str, result: mujoco_safe::Result<Model>| match result {
            Ok(_) => assert!(good, "{what}: {rows}, {columns}"),
            Err(error) => {
                let expected = format!("beyond a height field of {rows} rows and {columns} columns");
                assert!(!good && error.to_string().contains(&expected), "{what}: {error}");
            }
        };
        check("text", Model::from_xml_str(&rangefinder(&format!("nrow='{rows}' ncol='{columns}'"))));
        for (name, content) in [("a.raw", raw(rows, columns)), ("a.png", image(rows, columns))] {
            let text = rangefinder(&format!("file='{name}'"));
            check("memory", from_memory(&text, &[(name, content.clone())]));
            std::fs::write(&path, &text).unwrap();
            std::fs::write(folder.path().join(name), &content).unwrap();
            check("disk", Model::from_xml_path(&path));
            let no_rangefinder = text.replace("rangefinder site='s'", "clock");
            assert_eq!(from_memory(&no_rangefinder, &[(name, content)]).unwrap().hfield_ncol(), [columns as i32]);
        }
    }
}

#[test]
fn sizes_whose_product_overflows_a_c_int_are_rejected() {
    // 65537 × 65537 is 131073 in 32 bits, and 46341 × 46341 is negative.
    for side in [65_537_u32, 46_341] {
        let wrapped = side.wrapping_mul(side) & 0x7fff_ffff;
        let file = |cell: u32| {
            [[side, side].map(u32::to_ne_bytes).concat(), vec![0; (wrapped * cell).min(1 << 20) as usize]].concat()
        };
        let sizes = format!("nrow='{side}' ncol='{side}'");
        for (asset, cell) in [
            (format!("<hfield name='a' {sizes} size='1 1 1 1'/>"), 4),
            ("<hfield name='a' file='a.raw' size='1 1 1 1'/>".to_owned(), 4),
            ("<texture name='a' type='2d' file='a.raw'/>".to_owned(), 3),
            ("<texture name='a' type='cube' file='a.raw'/>".to_owned(), 3),
            ("<texture name='a' type='cube' file='a.raw' gridsize='3 4' gridlayout='.U..LFRB.D..'/>".to_owned(), 3),
            ("<texture name='a' type='skybox' fileup='a.raw'/>".to_owned(), 3),
        ] {
            let text = format!("<mujoco><asset>{asset}</asset></mujoco>");
            let error = from_memory(&text, &[("a.raw", file(cell))]).unwrap_err().to_string();
            assert!(
                error.contains("a size that contradicts its header") || error.contains("too large"),
                "{asset}: {error}"
            );
        }
    }
}

/// Expects that each element with the name of this file is rejected.
fn assert_special(path: &str) {
    for element in [
        format!("<include file='{path}'/>"),
        format!("<asset><mesh name='m' file='{path}'/></asset>"),
        format!("<asset><hfield name='h' file='{path}' size='1 1 1 1'/></asset>"),
        format!("<asset><texture name='t' type='2d' file='{path}'/></asset>"),
        format!("<asset><texture name='t' type='cube' fileup='{path}'/></asset>"),
        format!("<asset><skin name='s' file='{path}'/></asset>"),
    ] {
        let error = error(&format!("<mujoco>{element}</mujoco>"), &[]);
        assert!(error.contains("regular file"), "{element}: {error}");
    }
    let robot = format!(
        "<robot name='r'><link name='l'><collision><geometry><mesh filename='{path}'/></geometry></collision></link></robot>"
    );
    assert!(error(&robot, &[]).contains("regular file"), "{path}");
    for result in [Model::from_xml_path(path), Model::from_binary_path(path)] {
        assert!(matches!(result, Err(Error::File { .. })), "{path}");
    }
}

#[cfg(windows)]
#[test]
fn the_name_of_a_device_is_an_error_wherever_a_text_names_it() {
    for path in ["nul.stl", "CON.xml", "meshes/aux", "COM1.obj", "//./pipe/name", r"\\.\COM56"] {
        assert_special(path);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_special_file_is_an_error_wherever_a_text_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("link.stl");
    std::os::unix::fs::symlink("/proc/version", &link).unwrap();
    let pipe = folder.path().join("pipe.stl");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let socket = folder.path().join("socket.stl");
    let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    let special = [
        // Reading this file blocks until the kernel's next message.
        "/proc/kmsg",
        "/proc/version",
        "/proc/self/environ",
        "/sys/kernel/mm/transparent_hugepage/enabled",
        "/dev/null",
        "/dev/zero",
        link.to_str().unwrap(),
        pipe.to_str().unwrap(),
        socket.to_str().unwrap(),
    ];
    special.into_iter().filter(|path| std::path::Path::new(path).exists()).for_each(assert_special);
}

#[test]
fn a_file_of_more_than_2_gib_is_rejected_before_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.xml");
    // A sparse file, which takes no space on the disk.
    std::fs::File::create(&path).unwrap().set_len((1 << 31) + 1).unwrap();
    for result in [Model::from_xml_path(&path), Model::from_binary_path(&path)] {
        let error = result.unwrap_err();
        assert!(matches!(error, Error::File { .. }) && error.to_string().contains("larger than 2 GiB"), "{error}");
    }
    for element in ["<include file='huge.xml'/>", "<asset><mesh name='m' file='huge.xml.stl'/></asset>"] {
        std::fs::write(folder.path().join("model.xml"), format!("<mujoco>{element}</mujoco>")).unwrap();
        let _ = std::fs::hard_link(&path, folder.path().join("huge.xml.stl"));
        let error = Model::from_xml_path(folder.path().join("model.xml")).unwrap_err().to_string();
        assert!(error.contains("is larger than 2 GiB"), "{element}: {error}");
    }
}
