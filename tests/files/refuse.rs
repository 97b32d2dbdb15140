//! Files that cannot be used are errors that name them, and never end the program.

use mujoco_safe::Model;

use crate::{assets, from_memory};

fn error(xml: &str, files: &[(&str, &[u8])]) -> String {
    Model::from_xml_str_with_files(xml, files).unwrap_err().to_string()
}

#[test]
fn names_that_the_engine_cannot_keep_are_refused() {
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
    Model::from_xml_str_with_files("<mujoco/>", &[(&long[..999], b"content")]).unwrap();
    let deep = format!("{}/{}", "folder/".repeat(1000), "a.xml");
    let include = r#"<mujoco><include file="a.xml"/></mujoco>"#;
    Model::from_xml_str_with_files(include, &[(&deep, b"<mujoco><worldbody/></mujoco>")]).unwrap();
}

#[test]
fn two_files_that_the_engine_cannot_tell_apart_are_refused() {
    for names in [["a.stl", "a.stl"], ["one/a.stl", "two/a.stl"], ["a.stl", "A.STL"], ["one\\a.stl", "a.stl"]] {
        let error = error("<mujoco/>", &[(names[0], b"content"), (names[1], b"content")]);
        assert!(error.contains(names[1]) && error.contains("given twice"), "{error}");
    }
    let error = error("<mujoco/>", &[("(main).xml", b"content")]);
    assert!(error.contains("(main).xml"), "{error}");
}

#[test]
fn files_without_content_or_with_too_much_are_refused() {
    let message = error("<mujoco/>", &[("a.stl", b"")]);
    assert!(message.contains("'a.stl' is empty"), "{message}");
    // Never touched, so it is memory in name only.
    let huge = vec![0; 1 << 31];
    let message = error("<mujoco/>", &[("a.stl", &huge)]);
    assert!(message.contains("'a.stl' is 2147483648 bytes long, but must be below 2 GiB"), "{message}");
}

#[test]
fn a_damaged_file_is_an_error() {
    let all = assets::all();
    from_memory(assets::MODEL, &all).unwrap();
    for index in 1..all.len() {
        let (name, content) = &all[index];
        let longer = [content.as_slice(), b"123"].concat();
        let mut bad: Vec<&[u8]> = vec![b"x", &content[..content.len() / 2]];
        // The readers of text and of PNG stop where the file should.
        if !name.ends_with("obj") && !name.ends_with("png") {
            bad.extend([&content[..content.len() - 1], &longer]);
        }
        for bad in bad {
            let mut files = all.clone();
            files[index].1 = bad.to_vec();
            // Half a text may be whole.
            match from_memory(assets::MODEL, &files) {
                Ok(_) => assert!(name.ends_with("obj"), "{name}, {} bytes of {}", bad.len(), content.len()),
                Err(error) => {
                    let error = error.to_string();
                    assert!(error.starts_with("cannot load "), "{error}");
                }
            }
        }
    }
}

#[test]
fn a_file_that_is_missing_is_an_error_that_names_it() {
    let all = assets::all();
    for index in 0..all.len() {
        let mut files = all.clone();
        let (name, _) = files.remove(index);
        let error = from_memory(assets::MODEL, &files).unwrap_err().to_string();
        // Of an image the compiler tells the name of the texture or height field.
        let stem = name.rsplit('/').next().unwrap().split('.').next().unwrap();
        assert!(error.contains("cannot load the XML given") && error.contains(stem), "{name}: {error}");
    }
}
