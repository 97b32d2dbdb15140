//! The text of a model is written only if it loads as that model.

use std::path::{Path, PathBuf};

use mujoco_safe::{Error, MatrixView, MatrixViewMut, Model, SaveXmlOptions, XmlCheck};

use crate::assets;
use crate::save::saved_with;

/// Every model file of the repository and of the engine's samples.
fn samples() -> Vec<PathBuf> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    let mut folders =
        vec![PathBuf::from("/usr/share/mujoco/model"), repository.join("models"), repository.join("tests/models")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "xml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Copies what a model names to a folder, and returns the path of a model file there.
fn beside(original: &Path, folder: &Path) -> PathBuf {
    for entry in std::fs::read_dir(original.parent().unwrap()).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        } else {
            let inner = folder.join(path.file_name().unwrap());
            std::fs::create_dir_all(&inner).unwrap();
            for entry in std::fs::read_dir(path).unwrap() {
                let path = entry.unwrap().path();
                std::fs::copy(&path, inner.join(path.file_name().unwrap())).unwrap();
            }
        }
    }
    folder.join("saved.xml")
}

/// Saves a model before another test loads one, with a check, and returns the fields that the check names.
fn lost(load: impl Fn() -> Model, path: &Path) -> mujoco_safe::Result<Vec<String>> {
    let options = SaveXmlOptions::default().with_check(XmlCheck::Report);
    let (_, lost) = saved_with(|| Some(load()), path, &options).unwrap();
    lost.map(|lost| lost.into_iter().map(|lost| lost.field).collect())
}

#[test]
fn sample_models_save_without_a_loss() {
    let mut models = 0;
    for original in samples() {
        // Files for inclusion are not models.
        let Ok(model) = Model::from_xml_path(&original) else { continue };
        let folder = tempfile::tempdir().unwrap();
        let path = beside(&original, folder.path());
        let lost = lost(|| Model::from_xml_path(&original).unwrap(), &path).unwrap();
        // The compiler sorts pairs after it has resolved the tuples that refer to them, so the text is right and the model wrong.
        let expected: &[&str] = if original.ends_with("every_element.xml") { &["tuple_objid"] } else { &[] };
        assert_eq!(lost, expected, "{}", original.display());
        let again = Model::from_xml_path(&path).unwrap();
        assert_eq!((again.nv(), again.ngeom()), (model.nv(), model.ngeom()));
        assert!(std::iter::zip(again.body_mass(), model.body_mass()).all(|(a, b)| (a - b).abs() <= 1e-8 * b));
        models += 1;
    }
    assert!(models >= 15, "{models}");
}

/// One thing that can be edited, and what it is then.
struct Edit {
    field: &'static str,
    edit: fn(&mut Model),
    numbers: fn(&Model) -> Vec<f64>,
}

/// Arrays of all kinds as numbers, the last of which is edited.
trait Numbers {
    fn numbers(self) -> Vec<f64>;
}

trait EditLast {
    fn edit_last(self);
}

macro_rules! arrays {
    ($($type:ty)*) => { $(
        impl Numbers for &[$type] {
            fn numbers(self) -> Vec<f64> {
                self.iter().map(|&value| value.into()).collect()
            }
        }
        impl<const N: usize> Numbers for &[[$type; N]] {
            fn numbers(self) -> Vec<f64> {
                self.as_flattened().numbers()
            }
        }
        impl EditLast for &mut [$type] {
            fn edit_last(self) {
                if let Some(last) = self.last_mut() {
                    *last = *last * 0.75 + 0.0625;
                }
            }
        }
        impl<const N: usize> EditLast for &mut [[$type; N]] {
            fn edit_last(self) {
                self.as_flattened_mut().edit_last();
            }
        }
    )* };
}
arrays! { f32 f64 }

impl Numbers for MatrixView<'_> {
    fn numbers(self) -> Vec<f64> {
        self.as_slice().to_vec()
    }
}

impl EditLast for MatrixViewMut<'_> {
    fn edit_last(mut self) {
        self.as_mut_slice().edit_last();
    }
}

/// Every array that can be written to, and settings and switches of every kind.
fn edits() -> Vec<Edit> {
    macro_rules! arrays {
        ($($writer:ident($field:ident))*) => { vec![$(Edit {
            field: stringify!($field),
            edit: |model| model.edit().$writer().edit_last(),
            numbers: |model| model.$field().numbers(),
        }),*] };
    }
    macro_rules! others {
        ($($field:literal, $edit:expr, $numbers:expr;)*) => { vec![$(Edit {
            field: $field, edit: $edit, numbers: $numbers
        }),*] };
    }
    let mut edits = model_writers! { arrays };
    edits.extend(others! {
        "opt.timestep", |model| model.edit().set_timestep(0.0123).unwrap(), |model| vec![model.timestep()];
        "opt.gravity", |model| model.edit().options(|it| it.gravity[0] = 1.5).unwrap(), |model| model.options().gravity.to_vec();
        "opt.iterations", |model| model.edit().options(|it| it.iterations = 7).unwrap(),
            |model| vec![model.options().iterations as f64];
        "stat.meansize", |model| model.edit().statistics(|it| it.meansize *= 3.0).unwrap(),
            |model| vec![model.statistics().meansize];
        "stat.extent", |model| model.edit().statistics(|it| it.extent *= 3.0).unwrap(), |model| vec![model.statistics().extent];
        "vis.map.force", |model| model.edit().visual(|it| it.map.force = 0.3).unwrap(),
            |model| vec![model.visual().map.force.into()];
        "geom_contype", |model| model.edit().geom_mut(0).unwrap().set_contype(6),
            |model| vec![model.geom_contype()[0].into()];
        "geom_group", |model| model.edit().geom_mut(0).unwrap().set_group(3), |model| vec![model.geom_group()[0].into()];
        "jnt_limited", |model| { let now = model.joint(1).unwrap().limited(); model.edit().joint_mut(1).unwrap().set_limited(!now) },
            |model| vec![model.jnt_limited()[1].into()];
        "tex_rgb", |model| model.edit().texture_mut(0).unwrap().rgb_mut().fill(77),
            |model| model.texture(0).unwrap().rgb().iter().map(|&byte| byte.into()).collect();
    });
    edits
}

#[test]
fn each_edit_is_in_the_saved_text_or_named_as_lost() {
    let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/every_element.xml");
    let folder = tempfile::tempdir().unwrap();
    let path = beside(&original, folder.path());
    let (mut carried, mut named, mut refused) = (0, 0, 0);
    for Edit { field, edit, numbers } in edits() {
        let load = || {
            let mut model = Model::from_xml_path(&original).unwrap();
            edit(&mut model);
            model
        };
        let expected = numbers(&load());
        let before = numbers(&Model::from_xml_path(&original).unwrap());
        if expected.is_empty() {
            assert!(["qpos_spring"].contains(&field) || before.is_empty(), "{field}");
            continue;
        }
        assert!(expected != before, "{field} was not edited");
        let _ = std::fs::remove_file(&path);
        let lost = match lost(load, &path) {
            Ok(lost) => lost,
            Err(error) => {
                // For example a range with its ends in the wrong order.
                assert!(matches!(error, Error::Save { .. }), "{field}: {error}");
                assert!(!path.exists(), "{field}");
                refused += 1;
                continue;
            }
        };
        let again = numbers(&Model::from_xml_path(&path).unwrap());
        let scale = expected.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
        let is_carried = expected.len() == again.len()
            && std::iter::zip(&expected, &again).all(|(a, b)| (a - b).abs() <= 1e-5 * scale);
        assert!(is_carried || lost.iter().any(|name| name == field), "{field} is lost, and not named: {lost:?}");
        if is_carried { carried += 1 } else { named += 1 }
    }
    assert!(carried > 60 && named > 20 && refused < 20, "{carried} {named} {refused}");
}

#[test]
fn a_loss_is_an_error_that_names_field_and_element_and_writes_nothing() {
    const XML: &str = r#"<mujoco><worldbody><body name="ball"><freejoint/><geom name="skin" size="0.1" mass="1"/></body>
        <body><joint/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("heavy.xml");
    let load = || {
        let mut model = Model::from_xml_str(XML).unwrap();
        model.edit().body_mut("ball").unwrap().set_mass(5.0);
        model.edit().update_constants().unwrap();
        Some(model)
    };
    let (model, refused) = saved_with(load, &path, &SaveXmlOptions::default()).unwrap();
    let error = refused.unwrap_err();
    let text = error.to_string();
    assert!(text.contains("body_mass (ball)") && text.contains("save a binary model"), "{text}");
    let Error::XmlLosesEdits { fields, .. } = error else { panic!("{text}") };
    assert!(fields.iter().any(|lost| lost.field == "body_mass" && lost.elements == ["ball"]));
    assert!(!path.exists() && model.body_mass()[1] == 5.0);
    // An element without a name has a number.
    let load = || {
        let mut model = Model::from_xml_str(XML).unwrap();
        model.edit().body_mass_mut()[2] = 9.0;
        Some(model)
    };
    let (_, refused) = saved_with(load, &path, &SaveXmlOptions::default()).unwrap();
    assert!(refused.unwrap_err().to_string().contains("body_mass (2)"));
    let report = SaveXmlOptions::default().with_check(XmlCheck::Report);
    let (_, lost) = saved_with(load, &path, &report).unwrap();
    assert!(lost.unwrap().iter().any(|lost| lost.to_string() == "body_mass (2)"));
    assert!(Model::from_xml_path(&path).unwrap().body_mass()[2] < 5.0);
}

#[test]
fn a_model_can_be_saved_again_after_a_check_of_any_outcome() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("again.xml");
    // Another test may load a model in between.
    let saved = (0..10_000).any(|_| {
        let mut model = Model::from_xml_str(mujoco_safe::sample::CARTPOLE_XML).unwrap();
        let edited = {
            let mut edited = model.clone();
            edited.edit().body_mass_mut()[1] = 7.0;
            edited
        };
        let results = [
            edited
                .save_xml(&path)
                .map_err(|error| if matches!(error, Error::XmlLosesEdits { .. }) { None } else { Some(error) }),
            model.save_xml(&path).map_err(Some),
            {
                model.edit().set_timestep(0.003).unwrap();
                model.save_xml(&path).map_err(Some)
            },
        ];
        if results.iter().any(|result| matches!(result, Err(Some(Error::XmlReplaced)))) {
            return false;
        }
        let [lossy, first, second] = results;
        assert!(matches!(lossy, Err(None)));
        first.unwrap_or_else(|error| panic!("{error:?}"));
        second.unwrap_or_else(|error| panic!("{error:?}"));
        assert_eq!(Model::from_xml_path(&path).unwrap().timestep(), 0.003);
        true
    });
    assert!(saved);
}

#[test]
fn a_text_whose_files_are_not_beside_it_is_refused_unless_they_are_given() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("memory.xml");
    let files = assets::all();
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (*name, content.as_slice())).collect();
    let load = || Some(Model::from_xml_str_with_files(assets::MODEL, &files).unwrap());
    let (_, refused) = saved_with(load, &path, &SaveXmlOptions::default()).unwrap();
    let text = refused.unwrap_err().to_string();
    assert!(text.contains("memory.xml") && text.contains("does not load from there"), "{text}");
    assert!(!path.exists());
    for options in [SaveXmlOptions::default().with_files(&files), SaveXmlOptions::default().with_check(XmlCheck::Skip)]
    {
        let (_, saved) = saved_with(load, &path, &options).unwrap();
        assert_eq!(saved.unwrap(), []);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(Model::from_xml_str_with_files(&text, &files).is_ok());
    }
}

#[test]
fn what_the_compiler_changes_is_in_the_text() {
    let folder = crate::folder();
    let path = folder.path().join("saved.xml");
    for compiler in [r#"fusestatic="true""#, r#"discardvisual="true""#, r#"fusestatic="true" discardvisual="true""#, ""]
    {
        let xml = format!(
            r#"<mujoco><compiler {compiler}/><asset><mesh name="solid" file="solid.stl"/></asset><worldbody>
                 <body name="a" pos="0 0 1"><joint/><geom size="0.1"/><body name="b" pos="0 0.3 0.1" euler="10 20 30"><geom size="0.1 0.2 0.3" type="box"/>
                 <geom type="mesh" mesh="solid" contype="0" conaffinity="0" group="1"/></body></body></worldbody></mujoco>"#
        );
        let lost = lost(|| from_beside(&xml, folder.path()), &path).unwrap();
        assert_eq!(lost, [""; 0], "{compiler}");
    }
    let lost = lost(|| Model::from_xml_path(folder.path().join("arm.urdf")).unwrap(), &path).unwrap();
    assert_eq!(lost, [""; 0]);
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("<mujoco"));
    // The writer has no place for these.
    for (compiler, expected) in [(r#"settotalmass="7""#, "body_mass"), (r#"boundmass="50""#, "body_mass")] {
        let xml = format!(
            r#"<mujoco><compiler {compiler}/><worldbody><body name="a"><joint/><geom size="0.1"/></body></worldbody></mujoco>"#
        );
        let lost = self::lost(|| Model::from_xml_str(&xml).unwrap(), &path).unwrap();
        assert!(lost.iter().any(|field| field == expected), "{compiler}: {lost:?}");
    }
}

/// Loads a text as if from a file in a folder.
fn from_beside(xml: &str, folder: &Path) -> Model {
    let path = folder.join("written.xml");
    std::fs::write(&path, xml).unwrap();
    Model::from_xml_path(path).unwrap()
}

#[test]
fn numbers_that_the_writer_garbles_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.xml");
    // It converts integers to a C int, and leaves out an attribute that contains NaN.
    for value in [1e10, f64::NAN, -1e300] {
        let load = || {
            let mut model = Model::from_xml_str(mujoco_safe::sample::CARTPOLE_XML).unwrap();
            model.edit().dof_damping_mut()[0] = value;
            model
        };
        assert_eq!(lost(load, &path).unwrap(), ["dof_damping"], "{value}");
    }
    // All digits of others are there.
    for value in [f64::INFINITY, 0.1 + 0.2, 1.0 / 3.0, 1e-7 / 3.0, 123_456.789_012_345_67] {
        let load = || {
            let mut model = Model::from_xml_str(mujoco_safe::sample::CARTPOLE_XML).unwrap();
            model.edit().dof_damping_mut()[0] = value;
            model
        };
        assert_eq!(lost(load, &path).unwrap(), [""; 0]);
        assert_eq!(Model::from_xml_path(&path).unwrap().dof_damping()[0], value);
    }
}
