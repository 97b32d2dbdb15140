//! What is saved loads again as the same model.

use std::sync::PoisonError;

use mujoco_safe::{Error, Kind, Model, sample};

use crate::{RAW_LOADS, assets, bytes, bytes_in_c, folder};

/// Loads a model and saves it as XML before another test loads one: the engine keeps the XML of the last one only.
fn saved(load: impl Fn() -> Model, path: &std::path::Path) -> Model {
    (0..10_000)
        .find_map(|_| {
            // The library does not know of loads past it.
            let _raw = RAW_LOADS.lock().unwrap_or_else(PoisonError::into_inner);
            let model = load();
            match model.save_xml(path) {
                Err(Error::XmlReplaced) => None,
                saved => Some(saved.map(|()| model).unwrap()),
            }
        })
        .expect("a moment in which nobody else loads")
}

#[test]
fn a_binary_model_comes_back_whole_from_a_file_and_from_memory() {
    let folder = folder();
    let path = folder.path().join("model.mjb");
    let model = Model::from_xml_path(folder.path().join("model.xml")).unwrap();
    model.save_binary(&path).unwrap();
    assert!(std::fs::read(&path).unwrap() == bytes(&model));
    assert!(bytes(&Model::from_binary_path(&path).unwrap()) == bytes(&model));
    assert!(bytes(&Model::from_binary(&bytes(&model)).unwrap()) == bytes(&model));
    assert!(bytes_in_c(&folder.path().join("model.xml")).starts_with(&bytes(&model)));
}

#[test]
fn a_model_that_was_saved_as_xml_loads_as_the_same_model() {
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
        // Once rounded, they stay.
        let twice = folder.path().join("twice.xml");
        saved(|| Model::from_xml_path(&path).unwrap(), &twice);
        assert!(bytes(&Model::from_xml_path(&twice).unwrap()) == bytes(&again));
    }
}

#[test]
fn saved_xml_has_the_numbers_of_now_and_names_the_files_it_came_from() {
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
fn xml_that_cannot_be_saved_leaves_what_was_there_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (folder.path().join("model.xml"), folder.path().join("link.xml"));
    let load = || Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
    std::fs::write(&path, "before").unwrap();
    // Replaced in between by another load: the file is as it was.
    let model = load();
    saved(|| Model::from_xml_str(sample::HUMANOID_XML).unwrap(), &folder.path().join("other.xml"));
    assert!(matches!(model.save_xml(&path), Err(Error::XmlReplaced)));
    assert_eq!(std::fs::read(&path).unwrap(), b"before");
    std::os::unix::fs::symlink(&path, &link).unwrap();
    saved(load, &link);
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("<mujoco") && text.ends_with("</mujoco>\n"), "{text}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn the_schema_has_every_element_that_the_official_bindings_print() {
    let (text, html) = (mujoco_safe::schema().unwrap(), mujoco_safe::schema_html().unwrap());
    let elements: Vec<&str> =
        text.lines().filter_map(|line| line.trim_start().split_once(" (").map(|it| it.0)).collect();
    assert_eq!((text.lines().count(), elements.len()), (301, 127));
    assert!(["mujoco", "(world)body", "composite", "adhesion", "key"].iter().all(|name| elements.contains(name)));
    assert_eq!(html.matches("class=\"el\"").count(), elements.len());
    assert!(html.trim_end().ends_with("</table>"));
}
