//! The check that the saved text loads as the model, and the text itself.

use std::collections::BTreeSet;
use std::path::Path;

use mujoco_safe::model::{SaveXmlOptions, XmlCheck};
use mujoco_safe::spec::Spec;
use mujoco_safe::{Error, LoadOptions, Model, sample};

use super::{assets, copy_into, folder, lost, samples, saved_with};

use crate::cases::cases;

#[test]
fn sample_models_save_without_loss() {
    let _lock = super::lock_engine();
    let options = SaveXmlOptions::default().with_check(XmlCheck::Report);
    let mut models = 0;
    for original in samples().into_iter().step_by(cases(3, 1)) {
        // Files for inclusion are not models, and newer engines reject the composites of 2.2.2.
        let Ok(model) = Model::from_xml_path(&original) else { continue };
        let folder = tempfile::tempdir().unwrap();
        let path = copy_into(&original, folder.path());
        let lost = model.save_xml_with(&path, &options).unwrap();
        let lost: Vec<_> = lost.iter().map(|lost| lost.field.as_str()).collect();
        let expected: &[&str] = if original.ends_with("every_element.xml") { LOST_OF_EVERY_ELEMENT } else { &[] };
        assert_eq!(lost, expected, "{}", original.display());
        models += 1;
        // The check itself loads the text. An independent comparison takes too long for the large
        // models.
        if model.nv() < MOST_DOFS {
            let again = Model::from_xml_path(&path).unwrap();
            assert_eq!((again.nv(), again.ngeom()), (model.nv(), model.ngeom()));
            assert!(std::iter::zip(again.body_mass(), model.body_mass()).all(|(a, b)| (a - b).abs() <= 1e-8 * b));
        }
    }
    assert!(models >= cases(5, 14), "{models}");
}

/// Largest number of degrees of freedom of a model that is compared a second time.
const MOST_DOFS: usize = 100;

const IS_3_5: bool = cfg!(all(engine_since = "3.5.0", not(engine_since = "3.6.0")));

/// Fields of `every_element.xml` that its text loses. The compiler of 2.2.2 sorts pairs after
/// resolving the tuples that refer to them, so the text is right and the model wrong. A primitive
/// geom that is fitted to a mesh refers to the mesh in 3.5.0, and not if it is loaded again.
const LOST_OF_EVERY_ELEMENT: &[&str] = if cfg!(not(engine_since = "2.3.0")) {
    &["tuple_objid"]
} else if IS_3_5 {
    &["geom_dataid"]
} else {
    &[]
};

/// The sort of 2.2.2 gives pairs of the same two bodies another order after each load.
#[test]
fn many_pairs_of_the_same_bodies_are_saved() {
    const BODIES: [(&str, usize); 2] = [("a", 6), ("b", 5)];
    let body = |(body, geoms): (&str, usize)| {
        let geom = |index| format!("<geom name='{body}{index}' size='.02' pos='{}5 0 0'/>", 0.1 * index as f64);
        let geoms: String = (0..geoms).map(geom).collect();
        format!("<body name='{body}'><freejoint/>{geoms}</body>")
    };
    let pair = |(a, b)| {
        let condim = 1 + 2 * (a % 2);
        format!("<pair name='{b} to {a}' geom1='a{a}' geom2='b{b}' margin='0.{a}{b}' condim='{condim}'/>")
    };
    let of_a = |a| (0..BODIES[1].1).map(move |b| pair((a, b)));
    let pairs = (0..BODIES[0].1).flat_map(of_a).collect::<Vec<_>>().concat();
    let xml =
        format!("<mujoco><worldbody>{}</worldbody><contact>{pairs}</contact></mujoco>", BODIES.map(body).concat());
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pairs.xml");
    let named = |model: &Model| {
        let pairs = (0..model.npair()).map(|pair| {
            let geoms = [model.pair_geom1()[pair], model.pair_geom2()[pair]];
            let name = model.pair(pair).unwrap().name().map(str::to_owned);
            (name, geoms, model.pair_dim()[pair], model.pair_margin()[pair].to_bits())
        });
        pairs.collect::<BTreeSet<_>>()
    };
    let (model, saved) = saved_with(|| Model::from_xml_str(&xml).unwrap(), &path, &SaveXmlOptions::default());
    assert_eq!(saved.unwrap(), []);
    assert_eq!(named(&Model::from_xml_path(&path).unwrap()), named(&model));

    // An edit is saved or reported as lost, under the name of its pair.
    let edited = || {
        let mut model = Model::from_xml_str(&xml).unwrap();
        model.edit().pair_margin_mut()[7] = 0.77;
        model
    };
    let (model, saved) = saved_with(edited, &path, &SaveXmlOptions::default());
    match saved {
        Ok(_) => assert_eq!(named(&Model::from_xml_path(&path).unwrap()), named(&model)),
        Err(error) => {
            let Error::XmlLosesEdits { fields, .. } = &error else { panic!("{error}") };
            let name = model.pair(7).unwrap().name().unwrap();
            assert!(fields[0].field == "pair_margin" && fields[0].elements == [name], "{error}");
        }
    }
}

/// The writer of 2.2.2 raises an exception (mujoco#561).
#[test]
fn a_mass_in_the_defaults_of_meshes_is_saved_or_the_error_names_the_ways_out() {
    const XML: &str = r#"<mujoco><default><geom type="mesh" mass="2"/></default>
        <asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
        <worldbody><body><freejoint/><geom mesh="m"/></body></worldbody></mujoco>"#;
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.xml");
    let load = || Model::from_xml_str(XML).unwrap();
    let (model, saved) = saved_with(load, &path, &SaveXmlOptions::default());
    match saved {
        Ok(_) => assert!((Model::from_xml_path(&path).unwrap().total_mass() - model.total_mass()).abs() < 1e-4),
        Err(error) => {
            assert!(cfg!(not(engine_since = "2.3.0")) && matches!(error, Error::Save { .. }), "{error}");
            let text = error.to_string();
            assert!(["Spec::to_xml", "save_binary", "type='mesh'"].iter().all(|way| text.contains(way)), "{text}");
            std::fs::write(&path, Spec::from_xml_str(XML).unwrap().to_xml()).unwrap();
            assert_eq!(Model::from_xml_path(&path).unwrap().body_mass(), model.body_mass());
            assert_eq!(Model::from_binary(&model.to_binary().unwrap()).unwrap().body_mass(), model.body_mass());
        }
    }
}

#[test]
fn a_lost_edit_is_an_error_that_names_it_and_writes_nothing() {
    const XML: &str = r#"<mujoco><worldbody><body name="ball"><freejoint/><geom name="skin" size="0.1" mass="1"/></body>
        <body><joint/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("filtered.xml");
    let load = || {
        let mut model = Model::from_xml_str(XML).unwrap();
        model.edit().geom_mut("skin").unwrap().set_contype(5);
        model
    };
    let (model, rejected) = saved_with(load, &path, &SaveXmlOptions::default());
    let error = rejected.unwrap_err();
    let text = error.to_string();
    assert!(text.contains("geom_contype (skin)") && text.contains("save a binary model"), "{text}");
    let Error::XmlLosesEdits { fields, .. } = error else { panic!("{text}") };
    assert!(fields.iter().any(|lost| lost.field == "geom_contype" && lost.elements == ["skin"]));
    assert!(!path.exists() && model.geom_contype()[0] == 5);
    // Elements without a name are identified by number.
    let load = || {
        let mut model = Model::from_xml_str(XML).unwrap();
        model.edit().geom_mut(1).unwrap().set_contype(5);
        model
    };
    let (_, rejected) = saved_with(load, &path, &SaveXmlOptions::default());
    assert!(rejected.unwrap_err().to_string().contains("geom_contype (1)"));
    let report = SaveXmlOptions::default().with_check(XmlCheck::Report);
    let (_, lost) = saved_with(load, &path, &report);
    assert!(lost.unwrap().iter().any(|lost| lost.to_string() == "geom_contype (1)"));
    assert_eq!(Model::from_xml_path(&path).unwrap().geom_contype(), [1, 1]);
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
fn a_model_with_files_can_be_saved_to_several_folders() {
    const XML: &str = r#"<mujoco><asset><mesh name="solid" file="solid.stl"/></asset><worldbody><geom type="mesh" mesh="solid"/></worldbody></mujoco>"#;
    let _lock = super::lock_engine();
    let (original, copy) = (folder(), folder());
    let longer = copy.path().join("a/folder/with/a/longer/path");
    std::fs::create_dir_all(&longer).unwrap();
    std::fs::copy(copy.path().join("solid.stl"), longer.join("solid.stl")).unwrap();
    let model = load_in_folder(XML, original.path());
    for folder in [&longer, copy.path(), original.path()] {
        let path = folder.join("saved.xml");
        model.save_xml(&path).unwrap();
        assert!(std::fs::read_to_string(&path).unwrap().contains("solid.stl"));
    }
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
    assert!(text.contains("Spec::save_xml_with_assets"), "{text}");
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
fn the_text_of_a_model_is_that_of_its_file() {
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.xml");
    let mut model = Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
    model.edit().set_timestep(0.003).unwrap();
    let text = model.to_xml().unwrap();
    model.save_xml(&path).unwrap();
    assert_eq!(text, std::fs::read_to_string(&path).unwrap());

    model.edit().geom_mut(0).unwrap().set_contype(2);
    let error = model.to_xml().unwrap_err();
    assert!(matches!(&error, Error::XmlLosesEdits { .. }) && error.to_string().contains("geom_contype"), "{error}");
    let (text, lost) = model.to_xml_with(&SaveXmlOptions::default().with_check(XmlCheck::Report)).unwrap();
    assert!(text.starts_with("<mujoco") && lost.iter().any(|lost| lost.field == "geom_contype"), "{lost:?}");
    assert_eq!(Model::from_xml_str(&text).unwrap().timestep(), 0.003);
    assert!(matches!(model.to_xml(), Err(Error::XmlReplaced)));

    // A file in memory, which the check finds only among the options.
    let files = assets::all();
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (*name, content.as_slice())).collect();
    let options = LoadOptions::default().with_files(&files);
    let model = Model::from_xml_str_with(assets::MODEL, &options).unwrap();
    let error = model.to_xml().unwrap_err().to_string();
    assert!(error.contains("cannot save to a text") && error.contains("does not load"), "{error}");
    let model = Model::from_xml_str_with(assets::MODEL, &options).unwrap();
    let (text, lost) = model.to_xml_with(&SaveXmlOptions::default().with_files(&files)).unwrap();
    assert_eq!(lost, []);
    assert_eq!(Model::from_xml_str_with(&text, &options).unwrap().nmesh(), model.nmesh());

    // A name in another encoding.
    std::fs::write(&path, b"<mujoco><worldbody><geom name='\xe9' size='.1'/></worldbody></mujoco>").unwrap();
    let model = Model::from_xml_path(&path).unwrap();
    let error = model.to_xml().unwrap_err().to_string();
    assert!(error.contains("not UTF-8"), "{error}");
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
        // After fusing bodies, 3.5.0 keeps the bounding volumes and statistics of all bodies, and
        // the text loads without them.
        assert!(lost.is_empty() || IS_3_5 && compiler.contains("fusestatic"), "{compiler}: {lost:?}");
    }
    // 3.17 and 4.0 write the URI of a mesh's package, which they do not resolve in MJCF.
    let robot = folder.path().join("arm.urdf");
    let package = LoadOptions::default().with_package("arm", folder.path());
    let (_, saved) =
        saved_with(|| Model::from_xml_path_with(&robot, &package).unwrap(), &path, &SaveXmlOptions::default());
    if cfg!(engine_since = "3.17.0") {
        assert!(saved.unwrap_err().to_string().contains("package:"));
    } else {
        assert_eq!(saved.unwrap(), []);
        assert!(std::fs::read_to_string(&path).unwrap().starts_with("<mujoco"));
    }
    // A spec writes the paths of the files.
    Spec::from_xml_path_with(&robot, &package).unwrap().save_xml(&path).unwrap();
    assert_eq!(Model::from_xml_path(&path).unwrap().nmesh(), 1);
    // The writer of 2.2.2 does not support these, and that of 3.5 only the second.
    for (compiler, mass) in [(r#"settotalmass="7""#, 7.0), (r#"boundmass="50""#, 50.0)] {
        let xml = format!(
            r#"<mujoco><compiler {compiler}/><worldbody><body name="a"><joint/><geom size="0.1"/></body></worldbody></mujoco>"#
        );
        let lost = lost(|| Model::from_xml_str(&xml).unwrap(), &path).unwrap();
        let is_carried = (Model::from_xml_path(&path).unwrap().body_mass()[1] - mass).abs() < 1e-6;
        let is_supported =
            cfg!(engine_since = "3.17.0") || cfg!(engine_since = "3.5.0") && compiler.starts_with("boundmass");
        assert_eq!(is_carried, is_supported, "{compiler}");
        assert_eq!(is_carried, !lost.contains(&"body_mass".to_owned()), "{compiler}: {lost:?}");
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
    // The writer of 2.2.2 converts integers to a C int, and omits an attribute that contains NaN.
    for value in [1e10, f64::NAN, -1e300] {
        let load = || {
            let mut model = Model::from_xml_str(sample::CARTPOLE_XML).unwrap();
            model.edit().dof_damping_mut()[0] = value;
            model
        };
        let lost = lost(load, &path).unwrap();
        if cfg!(engine_since = "2.3.0") && lost.is_empty() {
            assert_eq!(Model::from_xml_path(&path).unwrap().dof_damping()[0], value);
        } else {
            assert_eq!(lost, ["dof_damping"], "{value}");
        }
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
