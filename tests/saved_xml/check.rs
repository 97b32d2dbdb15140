//! The check that the saved text loads as the model, and the text itself.

use std::path::Path;

use mujoco_safe::model::{SaveXmlOptions, XmlCheck};
use mujoco_safe::{Error, LoadOptions, Model, sample};

use super::{assets, copy_into, folder, lost, samples, saved_with};

#[test]
fn sample_models_save_without_loss() {
    let _lock = super::lock_engine();
    let mut models = 0;
    for original in samples() {
        // Files for inclusion are not models.
        let Ok(model) = Model::from_xml_path(&original) else { continue };
        let folder = tempfile::tempdir().unwrap();
        let path = copy_into(&original, folder.path());
        let lost = lost(|| Model::from_xml_path(&original).unwrap(), &path).unwrap();
        // The compiler sorts pairs after resolving the tuples that refer to them, so the text is right and the model wrong.
        let expected: &[&str] = if original.ends_with("every_element.xml") { &["tuple_objid"] } else { &[] };
        assert_eq!(lost, expected, "{}", original.display());
        let again = Model::from_xml_path(&path).unwrap();
        assert_eq!((again.nv(), again.ngeom()), (model.nv(), model.ngeom()));
        assert!(std::iter::zip(again.body_mass(), model.body_mass()).all(|(a, b)| (a - b).abs() <= 1e-8 * b));
        models += 1;
    }
    assert!(models >= 15, "{models}");
}

#[test]
fn a_lost_edit_is_an_error_that_names_it_and_writes_nothing() {
    const XML: &str = r#"<mujoco><worldbody><body name="ball"><freejoint/><geom name="skin" size="0.1" mass="1"/></body>
        <body><joint/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("heavy.xml");
    let load = || {
        let mut model = Model::from_xml_str(XML).unwrap();
        model.edit().body_mut("ball").unwrap().set_mass(5.0);
        model.edit().update_constants().unwrap();
        model
    };
    let (model, rejected) = saved_with(load, &path, &SaveXmlOptions::default());
    let error = rejected.unwrap_err();
    let text = error.to_string();
    assert!(text.contains("body_mass (ball)") && text.contains("save a binary model"), "{text}");
    let Error::XmlLosesEdits { fields, .. } = error else { panic!("{text}") };
    assert!(fields.iter().any(|lost| lost.field == "body_mass" && lost.elements == ["ball"]));
    assert!(!path.exists() && model.body_mass()[1] == 5.0);
    // Elements without a name are identified by number.
    let load = || {
        let mut model = Model::from_xml_str(XML).unwrap();
        model.edit().body_mass_mut()[2] = 9.0;
        model
    };
    let (_, rejected) = saved_with(load, &path, &SaveXmlOptions::default());
    assert!(rejected.unwrap_err().to_string().contains("body_mass (2)"));
    let report = SaveXmlOptions::default().with_check(XmlCheck::Report);
    let (_, lost) = saved_with(load, &path, &report);
    assert!(lost.unwrap().iter().any(|lost| lost.to_string() == "body_mass (2)"));
    assert!(Model::from_xml_path(&path).unwrap().body_mass()[2] < 5.0);
}

#[test]
fn a_model_can_be_saved_again_after_a_failed_check() {
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("again.xml");
    let mut model = Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
    let mut edited = model.clone();
    edited.edit().body_mass_mut()[1] = 7.0;
    assert!(matches!(edited.save_xml(&path), Err(Error::XmlLosesEdits { .. })));
    model.save_xml(&path).unwrap();
    let first = std::fs::read(&path).unwrap();
    model.save_xml(&path).unwrap();
    assert!(std::fs::read(&path).unwrap() == first);
    // A text that does not load from its path keeps the engine's tree.
    Model::from_xml_str("<mujoco><worldbody><geom size='1' type='mesh'/></worldbody></mujoco>").unwrap_err();
    model.edit().set_timestep(0.003).unwrap();
    model.save_xml(&path).unwrap();
    assert_eq!(Model::from_xml_path(&path).unwrap().timestep(), 0.003);
    assert!(matches!(model.save_xml(&path), Err(Error::XmlReplaced)));
}

#[test]
fn a_text_without_its_files_is_rejected() {
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("memory.xml");
    let files = assets::all();
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (*name, content.as_slice())).collect();
    let load = || Model::from_xml_str_with(assets::MODEL, &LoadOptions::default().with_files(&files)).unwrap();
    let (_, rejected) = saved_with(load, &path, &SaveXmlOptions::default());
    let text = rejected.unwrap_err().to_string();
    assert!(text.contains("memory.xml") && text.contains("does not load from there"), "{text}");
    assert!(!path.exists());
    for options in [SaveXmlOptions::default().with_files(&files), SaveXmlOptions::default().with_check(XmlCheck::Skip)]
    {
        let (_, saved) = saved_with(load, &path, &options);
        assert_eq!(saved.unwrap(), []);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(Model::from_xml_str_with(&text, &LoadOptions::default().with_files(&files)).is_ok());
    }
}

#[test]
fn the_text_has_the_changes_of_the_compiler() {
    let _lock = super::lock_engine();
    let folder = folder();
    let path = folder.path().join("saved.xml");
    for compiler in [r#"fusestatic="true""#, r#"discardvisual="true""#, r#"fusestatic="true" discardvisual="true""#, ""]
    {
        let xml = format!(
            r#"<mujoco><compiler {compiler}/><asset><mesh name="solid" file="solid.stl"/></asset><worldbody>
                 <body name="a" pos="0 0 1"><joint/><geom size="0.1"/><body name="b" pos="0 0.3 0.1" euler="10 20 30"><geom size="0.1 0.2 0.3" type="box"/>
                 <geom type="mesh" mesh="solid" contype="0" conaffinity="0" group="1"/></body></body></worldbody></mujoco>"#
        );
        let lost = lost(|| load_in_folder(&xml, folder.path()), &path).unwrap();
        assert_eq!(lost, [""; 0], "{compiler}");
    }
    let lost = lost(|| Model::from_xml_path(folder.path().join("arm.urdf")).unwrap(), &path).unwrap();
    assert_eq!(lost, [""; 0]);
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("<mujoco"));
    // The writer does not support these.
    for (compiler, expected) in [(r#"settotalmass="7""#, "body_mass"), (r#"boundmass="50""#, "body_mass")] {
        let xml = format!(
            r#"<mujoco><compiler {compiler}/><worldbody><body name="a"><joint/><geom size="0.1"/></body></worldbody></mujoco>"#
        );
        let lost = self::lost(|| Model::from_xml_str(&xml).unwrap(), &path).unwrap();
        assert!(lost.iter().any(|field| field == expected), "{compiler}: {lost:?}");
    }
}

/// Loads a text as if from a file in a folder.
fn load_in_folder(xml: &str, folder: &Path) -> Model {
    let path = folder.join("written.xml");
    std::fs::write(&path, xml).unwrap();
    Model::from_xml_path(path).unwrap()
}

#[test]
fn numbers_that_the_writer_corrupts_are_named() {
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.xml");
    // The writer converts integers to a C int, and omits an attribute that contains NaN.
    for value in [1e10, f64::NAN, -1e300] {
        let load = || {
            let mut model = Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
            model.edit().dof_damping_mut()[0] = value;
            model
        };
        assert_eq!(lost(load, &path).unwrap(), ["dof_damping"], "{value}");
    }
    // Other numbers keep all digits.
    for value in [f64::INFINITY, 0.1 + 0.2, 1.0 / 3.0, 1e-7 / 3.0, 123_456.789_012_345_67] {
        let load = || {
            let mut model = Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
            model.edit().dof_damping_mut()[0] = value;
            model
        };
        assert_eq!(lost(load, &path).unwrap(), [""; 0]);
        assert_eq!(Model::from_xml_path(&path).unwrap().dof_damping()[0], value);
    }
}
