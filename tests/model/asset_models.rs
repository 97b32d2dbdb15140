//! Models as assets of other models (`<model>` and `<attach>`), which compilers since 3.2 read.

#![forbid(unsafe_code)]

use std::path::Path;

use mujoco_safe::Model;

const ARM: &str = r#"<mujoco model="arm"><worldbody><body name="arm"><joint name="elbow"/><geom size=".1"/></body></worldbody></mujoco>"#;

/// Returns a text with a model as an asset, and elements in its world.
fn parent(model: &str, world: &str) -> String {
    format!("<mujoco><asset>{model}</asset><worldbody>{world}</worldbody></mujoco>")
}

fn write(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
}

/// Returns the message of the error for a text in a folder.
#[track_caller]
fn error(folder: &Path, text: &str) -> String {
    write(folder, &[("main.xml", text)]);
    Model::from_xml_path(folder.join("main.xml")).unwrap_err().to_string()
}

const ONE: &str = r#"<model name="arm" file="arm.xml"/>"#;
const ATTACH: &str = r#"<attach model="arm" body="arm" prefix="left_"/>"#;

#[test]
#[cfg(not(engine_since = "3.2.0"))]
fn older_compilers_reject_a_model_as_an_asset() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[("arm.xml", ARM)]);
    let error = error(folder.path(), &parent(ONE, ATTACH));
    assert!(error.contains("unrecognized element") && error.contains("'model'"), "{error}");
}

#[cfg(engine_since = "3.2.0")]
mod supported {
    use mujoco_safe::LoadOptions;

    use super::*;
    use crate::assets;

    /// The engine loads the same model, as its own binary format shows.
    #[test]
    fn models_as_assets_load_as_in_c() {
        let folder = tempfile::tempdir().unwrap();
        let key = r#"</worldbody><keyframe><key name="bent" qpos="1"/></keyframe>"#;
        let robot = r#"<robot name="r"><link name="base"/><link name="tip"><inertial><mass value="1"/>
            <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
            <joint name="slide" type="prismatic"><parent link="base"/><child link="tip"/><limit lower="0" upper="1"/></joint></robot>"#;
        let with_mesh = r#"<mujoco model="solid"><compiler meshdir="meshes"/><asset><mesh name="m" file="solid.obj"/></asset>
            <worldbody><body name="solid"><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"#;
        write(
            folder.path(),
            &[
                ("arm.xml", ARM),
                ("arm", ARM),
                ("key.xml", &ARM.replace("</worldbody>", key)),
                ("robot.urdf", robot),
                ("parts/solid.xml", with_mesh),
                ("parts/meshes/solid.obj", std::str::from_utf8(&assets::obj()).unwrap()),
                (
                    "parts/nested.xml",
                    &parent(r#"<model name="s" file="solid.xml"/>"#, r#"<attach model="s" body="solid" prefix="n_"/>"#),
                ),
                ("parts/includes.xml", r#"<mujoco><include file="body.xml"/></mujoco>"#),
                ("parts/body.xml", ARM),
            ],
        );
        for (model, world, nbody) in [
            (ONE, ATTACH.to_owned(), 2),
            (ONE, format!("{ATTACH}{}", ATTACH.replace("left_", "right_")), 3),
            (ONE, format!(r#"<replicate count="3" offset="1 0 0">{ATTACH}</replicate>"#), 4),
            (r#"<model name="arm" file="arm" content_type="text/xml"/>"#, ATTACH.to_owned(), 2),
            (r#"<model name="arm" file="key.xml"/>"#, ATTACH.to_owned(), 2),
            (r#"<model name="arm" file="robot.urdf"/>"#, ATTACH.replace(r#"body="arm""#, r#"body="tip""#), 2),
            (r#"<model name="arm" file="parts/solid.xml"/>"#, ATTACH.replace(r#"body="arm""#, r#"body="solid""#), 2),
            (r#"<model name="arm" file="parts/nested.xml"/>"#, ATTACH.replace(r#"body="arm""#, r#"body="n_solid""#), 2),
            (r#"<model name="arm" file="parts/includes.xml"/>"#, ATTACH.to_owned(), 2),
        ] {
            let path = folder.path().join("main.xml");
            write(folder.path(), &[("main.xml", &parent(model, &world))]);
            let loaded = Model::from_xml_path(&path).unwrap_or_else(|error| panic!("{model}: {error}"));
            assert_eq!(loaded.nbody(), nbody, "{model}");
            assert!(loaded.to_binary().unwrap() == crate::bytes_in_c(&path), "{model}");
        }
        let files: [(&str, &[u8]); 1] = [("arm.xml", ARM.as_bytes())];
        let options = LoadOptions::default().with_files(&files);
        let in_memory = Model::from_xml_str_with(&parent(ONE, ATTACH), &options).unwrap();
        assert_eq!(in_memory.njnt(), 1);
        in_memory.joint("left_elbow").unwrap();
    }

    #[test]
    fn models_that_contain_themselves_are_rejected() {
        let folder = tempfile::tempdir().unwrap();
        let link = |to: &str| parent(&format!(r#"<model file="{to}.xml"/>"#), "");
        write(folder.path(), &[("a.xml", &link("b")), ("b.xml", &link("./a"))]);
        write(folder.path(), &[("includes.xml", r#"<mujoco><include file="main.xml"/></mujoco>"#)]);
        for text in [link("main"), link("a"), link("(main)"), link("includes")] {
            let error = error(folder.path(), &text);
            assert!(error.contains("nested more than 20 deep") && error.contains("line 1"), "{error}");
        }
    }

    /// The check itself recurses, so the sum of both depths is limited.
    #[test]
    fn includes_and_models_in_each_other_are_limited_together() {
        let folder = tempfile::tempdir().unwrap();
        for index in 0..57 {
            let next = format!(r#"file="{}.xml""#, index + 1);
            let text = if index % 3 == 0 {
                parent(&format!("<model {next}/>"), "")
            } else {
                format!("<mujoco><include {next}/></mujoco>")
            };
            write(folder.path(), &[(&format!("{index}.xml"), &text)]);
        }
        write(folder.path(), &[("57.xml", ARM)]);
        let include = |index: usize| format!(r#"<mujoco><include file="{index}.xml"/></mujoco>"#);
        let error = error(folder.path(), &include(0));
        assert!(error.contains("includes are nested more than 50 deep"), "{error}");
        // The last 30 files have 10 models.
        write(folder.path(), &[("main.xml", &include(27))]);
        Model::from_xml_path(folder.path().join("main.xml")).unwrap();
    }

    #[test]
    fn an_attachment_that_the_engine_rejects_is_an_error_and_loading_still_works() {
        let folder = tempfile::tempdir().unwrap();
        let key = r#"</worldbody><keyframe><key qpos="1 2"/></keyframe>"#;
        write(
            folder.path(),
            &[("arm.xml", ARM), ("key.xml", &ARM.replace("</worldbody>", key)), ("text.xml", "<mujoco")],
        );
        let same_name = format!(r#"<body><joint name="left_elbow"/><geom size=".1"/></body>{ATTACH}"#);
        let missing_body = ATTACH.replace(r#"body="arm""#, r#"body="hand""#);
        for (model, world, expected) in [
            (ONE, &*missing_body, "'hand'"),
            (ONE, &same_name, "left_elbow"),
            ("", ATTACH, "'arm'"),
            (r#"<model name="arm" file="key.xml"/>"#, ATTACH, "qpos"),
            (r#"<model name="arm" file="text.xml"/>"#, ATTACH, "XML parse error"),
            (r#"<model name="arm" file="none.xml"/>"#, ATTACH, "none.xml"),
        ] {
            let error = error(folder.path(), &parent(model, world));
            assert!(error.contains(expected), "{model}: {error}");
            write(folder.path(), &[("main.xml", &parent(ONE, ATTACH))]);
            assert_eq!(Model::from_xml_path(folder.path().join("main.xml")).unwrap().nbody(), 2);
        }
    }

    #[test]
    fn copies_of_copies_are_limited() {
        let folder = tempfile::tempdir().unwrap();
        // Each model has two copies of the previous one.
        write(folder.path(), &[("0.xml", ARM)]);
        for index in 1..19 {
            let model = format!(r#"<model name="m" file="{}.xml"/>"#, index - 1);
            let twice = r#"<attach model="m" prefix="p"/><attach model="m" prefix="q"/>"#;
            write(folder.path(), &[(&format!("{index}.xml"), &parent(&model, twice))]);
        }
        let error_of_model = error(folder.path(), &parent(r#"<model name="m" file="18.xml"/>"#, ""));
        assert!(error_of_model.contains("more than 1000000 elements"), "{error_of_model}");

        let body = |name: usize, inside: &str| format!(r#"<body name="b{name}">{inside}</body>"#);
        let doubled: String = (1..30)
            .map(|name| {
                let attach = |prefix| format!(r#"<attach body="b{}" prefix="{prefix}{name}"/>"#, name - 1);
                body(name, &(attach("p") + &attach("q")))
            })
            .collect();
        let inside_itself: Vec<String> =
            (0..30).map(|name| format!(r#"<attach body="b0" prefix="p{name}"/>"#)).collect();
        for world in [body(0, "") + &doubled, body(0, &inside_itself.concat())] {
            let error = error(folder.path(), &parent("", &world));
            assert!(error.contains("more than 1000000 elements"), "{error}");
        }
        // One branch of each model is 300 elements deep.
        let deep = |inside: &str| format!("{}{inside}{}", "<body>".repeat(300), "</body>".repeat(300));
        let arm = ARM.replace("</worldbody>", &format!("{}</worldbody>", deep("")));
        write(folder.path(), &[("arm.xml", &arm)]);
        let error = error(folder.path(), &parent(ONE, &deep(&ATTACH.replace(r#" body="arm""#, ""))));
        assert!(error.contains("nested more than 400 deep"), "{error}");
    }

    #[test]
    fn the_files_of_a_model_as_an_asset_are_checked() {
        let folder = tempfile::tempdir().unwrap();
        let damaged = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 9\n";
        let mesh = |file: &str| {
            format!(
                r#"<mujoco model="arm"><asset><mesh name="m" file="{file}"/></asset>
                   <worldbody><body name="arm"><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"#
            )
        };
        write(
            folder.path(),
            &[
                ("parts/damaged.obj", damaged),
                ("parts/arm.xml", &mesh("damaged.obj")),
                ("parts/includes.xml", r#"<mujoco><include file="arm.xml"/></mujoco>"#),
                (
                    "parts/sizes.xml",
                    r#"<mujoco><asset><hfield name="h" nrow="50000" ncol="50000" size="1 1 1 1"/></asset></mujoco>"#,
                ),
                ("type.urdf", r#"<robot name="r"><link name="l"/><joint name="j" type="screw"/></robot>"#),
                ("model.mjb", "x"),
                ("folder.xml/file", "x"),
            ],
        );
        for (file, expected) in [
            ("parts/arm.xml", "'damaged.obj' has a face with a nonexistent vertex"),
            ("parts/includes.xml", "'damaged.obj' has a face with a nonexistent vertex"),
            ("parts/sizes.xml", "a height field is too large"),
            ("type.urdf", "type 'screw'"),
            ("model.mjb", "must end in .xml or .urdf"),
            ("folder.xml", "is not a regular file"),
            ("", "must end in .xml or .urdf"),
        ] {
            let error = error(folder.path(), &parent(&format!(r#"<model name="arm" file="{file}"/>"#), ATTACH));
            assert!(error.contains(expected), "{file}: {error}");
        }
        let error = error(folder.path(), &parent(r#"<model name="arm"/>"#, ATTACH));
        assert!(error.contains("needs a file, line 1"), "{error}");
    }

    /// The muscle of a child is simulated with the parent's settings.
    #[test]
    fn a_length_range_in_a_model_as_an_asset_is_checked() {
        let folder = tempfile::tempdir().unwrap();
        let muscle = r#"<mujoco model="arm"><compiler><lengthrange mode="none"/></compiler><worldbody>
            <body name="arm"><joint name="j" limited="true" range="-1 1"/><geom size=".1" pos=".2 0 0"/></body></worldbody>
            <actuator><muscle joint="j"/></actuator></mujoco>"#;
        write(folder.path(), &[("arm.xml", muscle)]);
        let settings = r#"<mujoco><compiler><lengthrange inttotal="1e300"/></compiler>"#;
        let error = error(folder.path(), &parent(ONE, ATTACH).replace("<mujoco>", settings));
        assert!(error.contains("steps"), "{error}");
    }
}
