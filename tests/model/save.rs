//! A saved model loads as the same model.

use std::path::Path;
use std::sync::PoisonError;

use mujoco_safe::kind::Kind;
use mujoco_safe::model::{SaveXmlOptions, XmlCheck};
use mujoco_safe::{Error, LoadOptions, Model, sample};

use crate::cases::cases;
use crate::installed::sample_models;
use crate::{RAW_LOADS, assets, bytes, bytes_in_c, folder};

/// Loads a model and saves it as XML before another test loads a model: the engine keeps the XML of
/// the last model only.
fn saved(load: impl Fn() -> Model, path: &Path) -> Model {
    saved_with(load, path, &SaveXmlOptions::default())
}

fn saved_with(load: impl Fn() -> Model, path: &Path, options: &SaveXmlOptions) -> Model {
    (0..10_000)
        .find_map(|_| {
            // The library does not detect loads by raw calls.
            let _raw = RAW_LOADS.lock().unwrap_or_else(PoisonError::into_inner);
            let model = load();
            match model.save_xml_with(path, options) {
                Err(Error::XmlReplaced) => None,
                saved => Some(saved.map(|_| model).unwrap()),
            }
        })
        .expect("no load between loading and saving")
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files with their path")]
fn a_binary_model_round_trips_through_a_file_and_memory() {
    let folder = folder();
    let path = folder.path().join("model.mjb");
    let model = Model::from_xml_path(folder.path().join("model.xml")).unwrap();
    model.save_binary(&path).unwrap();
    assert!(std::fs::read(&path).unwrap() == bytes(&model));
    assert!(bytes(&Model::from_binary_path(&path).unwrap()) == bytes(&model));
    assert!(bytes(&Model::from_binary(&bytes(&model)).unwrap()) == bytes(&model));
    assert!(bytes_in_c(&folder.path().join("model.xml")).starts_with(&bytes(&model)));
}

/// Option with the iterations of the collision solver, and its least value.
const COLLISION: &str = if cfg!(engine_since = "3.5.0") { "ccd_iterations" } else { "mpr_iterations" };
const LEAST: i32 = if cfg!(engine_since = "3.5.0") { 1 } else { 0 };

#[test]
fn every_model_from_xml_round_trips_through_its_binary_form() {
    let body = "<body name='b'><joint name='j'/><geom size='.1'/><site name='s'/><site name='r' pos='1 0 0'/></body>
                <body><freejoint/><geom size='.1'/></body><site name='w'/>";
    let with = |rest: &str| Model::from_xml_str(&format!("<mujoco><worldbody>{body}</worldbody>{rest}</mujoco>"));
    let mut models: Vec<Model> = sample_models()
        .into_iter()
        .map(|(_, model)| model)
        .chain([Model::from_xml_str(include_str!("../models/every_element.xml")).unwrap()])
        .collect();
    for rest in [
        "<actuator><motor site='s' refsite='r'/></actuator>",
        "<actuator><position site='s' refsite='w' gear='1 0 0 0 1 0'/></actuator>",
        "<visual><quality numslices='0' numstacks='-3' numquads='0' shadowsize='-1' offsamples='-1'/></visual>",
        "<visual><quality numslices='5000' shadowsize='100000' offsamples='1000'/></visual>",
        "<visual><global offwidth='0' offheight='-1'/></visual>",
        "<visual><global offwidth='100000' offheight='100000'/></visual>",
        "<option iterations='-1' noslip_iterations='-1'/>",
        &format!("<option iterations='0' {COLLISION}='{LEAST}'/>"),
    ] {
        models.push(with(rest).unwrap_or_else(|error| panic!("{rest}: {error}")));
    }
    // Newer compilers reject some of the system's models.
    assert!(models.len() > if cfg!(engine_since = "3.5.0") { 15 } else { 20 });
    for model in models.into_iter().step_by(cases(4, 1)) {
        let saved = bytes(&model);
        let again = Model::from_binary(&saved).unwrap_or_else(|error| panic!("{model:?}: {error}"));
        assert!(bytes(&again) == saved, "{model:?}");
    }
    // A model that the binary format cannot hold is rejected when it is loaded.
    for (rest, expected) in [
        (&*format!("<option {COLLISION}='{}'/>", LEAST - 1), &*format!("opt.{COLLISION} is {}", LEAST - 1)),
        ("<option iterations='2000000'/>", "opt.iterations is 2000000; it must be"),
        ("<option timestep='0'/>", "opt.timestep is 0"),
    ] {
        let error = with(rest).unwrap_err().to_string();
        assert!(error.contains("the compiled model is invalid") && error.contains(expected), "{error}");
    }
}

#[test]
fn a_mesh_scale_that_makes_vertices_huge_is_an_error() {
    for scale in ["1e12 1 1", "1e39 1 1", "-1e300 1 1"] {
        let text = format!(
            "<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1' scale='{scale}'/></asset>
             <worldbody><body><freejoint/><geom size='.1'/><geom type='mesh' mesh='m' contype='0' conaffinity='0' mass='0'/></body></worldbody></mujoco>"
        );
        let error = Model::from_xml_str(&text).unwrap_err();
        assert!(matches!(error, Error::Load { .. }), "{scale}: {error}");
    }
}

#[test]
fn a_model_saved_as_xml_loads_as_the_same_model() {
    let folder = folder();
    let path = folder.path().join("again.xml");
    for xml in [sample::CARTPOLE_XML, sample::HUMANOID_XML] {
        let model = saved(|| Model::from_xml_str(xml).unwrap(), &path);
        let again = Model::from_xml_path(&path).unwrap();
        assert_eq!(
            (again.nq(), again.nv(), again.nu(), again.ngeom()),
            (model.nq(), model.nv(), model.nu(), model.ngeom())
        );
        assert!(again.names(Kind::Joint).eq(model.names(Kind::Joint)));
        // The engine writes numbers with six digits.
        for (found, expected) in [
            (again.body_mass(), model.body_mass()),
            (again.dof_damping(), model.dof_damping()),
            (again.body_pos().as_flattened(), model.body_pos().as_flattened()),
            (again.body_inertia().as_flattened(), model.body_inertia().as_flattened()),
            (again.geom_size().as_flattened(), model.geom_size().as_flattened()),
        ] {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() <= 2e-5 * expected.abs().max(1e-3), "{found}, not {expected}");
            }
        }
        // Rounding again does not change the numbers.
        let twice = folder.path().join("twice.xml");
        saved(|| Model::from_xml_path(&path).unwrap(), &twice);
        assert!(bytes(&Model::from_xml_path(&twice).unwrap()) == bytes(&again));
    }
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files with their path")]
fn saved_xml_has_the_current_numbers_and_names_its_files() {
    let folder = folder();
    let path = folder.path().join("again.xml");
    let load = || {
        let mut model = Model::from_xml_path(folder.path().join("model.xml")).unwrap();
        model.edit().set_timestep(0.0035).unwrap();
        model
    };
    let model = saved(load, &path);
    let again = Model::from_xml_path(&path).unwrap();
    assert_eq!(again.timestep(), 0.0035);
    assert_eq!((again.mesh_vertnum(), again.hfield_data()), (model.mesh_vertnum(), model.hfield_data()));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(!text.contains("<include") && text.contains("solid.stl"), "{text}");
    assert!(assets::MODEL.contains("<include"));
}

#[test]
fn a_failed_save_leaves_the_existing_file_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.xml");
    std::fs::write(&path, "before").unwrap();
    // Another load replaces the XML in between: the file stays unchanged.
    let model = Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
    saved(|| Model::from_xml_str(sample::HUMANOID_XML).unwrap(), &folder.path().join("other.xml"));
    assert!(matches!(model.save_xml(&path), Err(Error::XmlReplaced)));
    assert_eq!(std::fs::read(&path).unwrap(), b"before");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_save_replaces_the_file_and_leaves_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.xml");
    let load = || Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
    let assert_saved = |to: &Path| {
        std::fs::write(&path, "before").unwrap();
        saved(load, to);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("<mujoco") && text.trim_end().ends_with("</mujoco>"), "{text}");
    };
    assert_saved(&path);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    #[cfg(unix)]
    {
        let link = folder.path().join("link.xml");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        assert_saved(&link);
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}

#[test]
fn the_deepest_elements_load_and_are_saved_with_the_stack_of_a_thread() {
    // The stack of the main thread of Windows, or of a thread of Rust.
    let stack = if cfg!(windows) { 1 << 20 } else { 2 << 20 };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep.xml");
    for (section, element) in [("worldbody", "body"), ("default", "default")] {
        // The parser accepts up to 100 elements in each other in one file.
        let texts = (0..4).map(|file| {
            let class =
                |index: usize| if element == "body" { String::new() } else { format!("class='{file}-{index}'") };
            let starts = (0..95).map(|index| format!("<{element} {}>", class(index))).collect::<Vec<_>>().concat();
            let include = if file < 3 { format!("<include file='{}.xml'/>", file + 1) } else { String::new() };
            let text =
                format!("<mujoco>{starts}{include}<geom size='.1'/>{}</mujoco>", format!("</{element}>").repeat(95));
            (format!("{file}.xml"), text)
        });
        let texts: Vec<(String, String)> = texts.collect();
        let files: Vec<(&str, &[u8])> = texts.iter().map(|(name, text)| (&**name, text.as_bytes())).collect();
        let main = format!("<mujoco><{section}><include file='0.xml'/></{section}></mujoco>");
        let load = || Model::from_xml_str_with(&main, &LoadOptions::default().with_files(&files)).unwrap();
        // The text has all elements in one file, so it does not load.
        let options = SaveXmlOptions::default().with_check(XmlCheck::Skip);
        let save = || drop(saved_with(load, &path, &options));
        std::thread::scope(|scope| {
            std::thread::Builder::new().stack_size(stack).spawn_scoped(scope, save).unwrap().join().unwrap();
        });
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.matches(&format!("</{element}>")).count() >= 4 * 95, "{text}");
    }
}

#[test]
fn print_to_writes_every_array() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.txt");
    let model = sample::humanoid();
    model.print_to(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(model.bodies().all(|body| text.contains(body.name().unwrap())));
    assert!(["gravity", "qpos0", "key_qpos"].iter().all(|name| text.to_lowercase().contains(name)), "{text}");
    assert!(matches!(model.print_to(folder.path().join("missing/model.txt")), Err(Error::File { .. })));
    assert!(matches!(model.print_to("a\0b"), Err(Error::Invalid { .. })));
}

#[test]
fn the_schema_has_every_element_of_the_official_bindings() {
    let (text, html) = (mujoco_safe::model::schema().unwrap(), mujoco_safe::model::schema_html().unwrap());
    let elements: Vec<&str> =
        text.lines().filter_map(|line| line.trim_start().split_once(" (").map(|it| it.0)).collect();
    let counts = if cfg!(engine_since = "3.5.0") { (459, 171) } else { (301, 127) };
    assert_eq!((text.lines().count(), elements.len()), counts);
    assert!(["mujoco", "(world)body", "composite", "adhesion", "key"].iter().all(|name| elements.contains(name)));
    assert_eq!(html.matches("class=\"el\"").count(), elements.len());
    assert!(html.trim_end().ends_with("</table>"));
}
