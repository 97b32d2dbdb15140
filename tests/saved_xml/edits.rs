//! Each edit is in the saved text or reported as lost.

use std::path::Path;

use mujoco_safe::{Error, MatrixView, MatrixViewMut, Model};

use super::{copy_into, lost};

use crate::cases::cases;

/// An edit and the edited value.
struct Edit {
    field: &'static str,
    change: fn(&mut Model),
    numbers: fn(&Model) -> Vec<f64>,
}

/// Arrays of all kinds as numbers. Edits change the last number.
trait Numbers {
    fn numbers(self) -> Vec<f64>;
}

trait EditLast {
    fn edit_last(self);
    fn fill_all(self, number: f64);
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
            fn fill_all(self, number: f64) {
                self.fill(number as $type);
            }
        }
        impl<const N: usize> EditLast for &mut [[$type; N]] {
            fn edit_last(self) {
                self.as_flattened_mut().edit_last();
            }
            fn fill_all(self, number: f64) {
                self.as_flattened_mut().fill_all(number);
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

    fn fill_all(mut self, number: f64) {
        self.as_mut_slice().fill(number);
    }
}

/// Name of the array of texels.
const TEXELS: &str = if cfg!(engine_since = "3.2.5") { "tex_data" } else { "tex_rgb" };

/// Returns edits of every writable array, and of settings and flags of every kind.
fn edits() -> Vec<Edit> {
    macro_rules! arrays {
        ($($writer:ident($field:ident))*) => { vec![$(Edit {
            field: stringify!($field),
            change: |model| model.edit().$writer().edit_last(),
            numbers: |model| model.$field().numbers(),
        }),*] };
    }
    macro_rules! others {
        ($($field:expr, $edit:expr, $numbers:expr;)*) => { vec![$(Edit {
            field: $field, change: $edit, numbers: $numbers
        }),*] };
    }
    let mut edits = model_writers! { arrays };
    edits.extend(others! {
        "opt.timestep", |model| model.edit().set_timestep(0.0123).unwrap(), |model| vec![model.timestep()];
        "opt.gravity", |model| model.edit().edit_options(|it| it.gravity[0] = 1.5).unwrap(), |model| model.options().gravity.to_vec();
        "opt.iterations", |model| model.edit().edit_options(|it| it.iterations = 7).unwrap(),
            |model| vec![model.options().iterations as f64];
        "stat.meansize", |model| model.edit().edit_statistics(|it| it.meansize *= 3.0).unwrap(),
            |model| vec![model.statistics().meansize];
        "stat.extent", |model| model.edit().edit_statistics(|it| it.extent *= 3.0).unwrap(), |model| vec![model.statistics().extent];
        "vis.map.force", |model| model.edit().edit_visual(|it| it.map.force = 0.3).unwrap(),
            |model| vec![model.visual().map.force.into()];
        "geom_contype", |model| model.edit().geom_mut(0).unwrap().set_contype(6),
            |model| vec![model.geom_contype()[0].into()];
        "geom_group", |model| model.edit().geom_mut(0).unwrap().set_group(3), |model| vec![model.geom_group()[0].into()];
        "jnt_limited", |model| { let now = model.joint(1).unwrap().limited(); model.edit().joint_mut(1).unwrap().set_limited(!now) },
            |model| vec![model.jnt_limited()[1].into()];
        TEXELS, |model| model.edit().texture_mut(0).unwrap().rgb_mut().fill(77),
            |model| model.texture(0).unwrap().rgb().iter().map(|&byte| byte.into()).collect();
    });
    edits
}

#[test]
fn each_edit_is_saved_or_reported_as_lost() {
    let _lock = super::lock_engine();
    let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/every_element.xml");
    let folder = tempfile::tempdir().unwrap();
    let path = copy_into(&original, folder.path());
    let model = Model::from_xml_path(&original).unwrap();
    let edits: Vec<_> = edits().into_iter().step_by(cases(3, 1)).collect();
    // All models are saved before any is loaded, which replaces the engine's tree.
    let saved = edits.iter().map(|Edit { field, change, numbers }| {
        let mut edited = model.clone();
        change(&mut edited);
        let expected = numbers(&edited);
        assert!(expected.is_empty() || expected != numbers(&model), "{field} was not edited");
        let path = path.with_file_name(format!("{field}.xml"));
        let lost = lost(|| edited, &path);
        (expected, path, lost)
    });
    let saved: Vec<_> = saved.collect();
    let (mut carried, mut named, mut rejected) = (0, 0, 0);
    for (Edit { field, numbers, .. }, (expected, path, lost)) in edits.iter().zip(saved) {
        let lost = match lost {
            Ok(lost) => lost,
            Err(error) => {
                // For example a range with reversed limits.
                assert!(matches!(error, Error::Save { .. }) && !path.exists(), "{field}: {error}");
                rejected += 1;
                continue;
            }
        };
        if lost.iter().any(|name| name == field) {
            named += 1;
            continue;
        }
        let again = numbers(&Model::from_xml_path(&path).unwrap());
        let scale = expected.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
        let is_carried = expected.len() == again.len()
            && std::iter::zip(&expected, &again).all(|(a, b)| (a - b).abs() <= 1e-5 * scale);
        assert!(is_carried, "{field} is lost, and not named: {lost:?}");
        carried += 1;
    }
    assert!(carried > cases(15, 60) && named > cases(5, 20) && rejected < 20, "{carried} {named} {rejected}");
}

/// Sets all values of an array.
type Fill = fn(&mut Model, f64);

#[test]
fn extreme_numbers_are_saved_or_rejected() {
    const NUMBERS: [f64; 7] = [0.0, -1.0, 1e-300, 1e10, 1e300, f64::NAN, f64::INFINITY];
    let _lock = super::lock_engine();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.xml");
    // Small buffers, because the compiler clears them in each load.
    let text = include_str!("../models/zoo.xml").replacen("<size ", r#"<size njmax="200" nconmax="30" "#, 1);
    let zoo = Model::from_xml_str(&text).unwrap();
    macro_rules! fills {
        ($($writer:ident($field:ident))*) => { vec![$(
            (!zoo.$field().numbers().is_empty()).then_some(|model: &mut Model, number| model.edit().$writer().fill_all(number))
        ),*] };
    }
    let fills: Vec<Option<Fill>> = model_writers! { fills };
    let fills: Vec<Fill> = fills.into_iter().flatten().collect();
    let (mut saved, mut rejected) = (0, 0);
    // Each array has each number once. Two arrays share a model, which halves the time.
    for arrays in fills.chunks(2).step_by(cases(4, 1)) {
        for index in 0..NUMBERS.len() {
            let mut model = zoo.clone();
            for (fill, number) in arrays.iter().zip(NUMBERS.iter().cycle().skip(index).step_by(3)) {
                fill(&mut model, *number);
            }
            match lost(|| model, &path) {
                Ok(_) => saved += 1,
                Err(error) => {
                    assert!(matches!(error, Error::Save { .. }), "{error}");
                    rejected += 1;
                }
            }
        }
    }
    assert!(saved > cases(60, 250) && rejected > cases(2, 10), "{saved} {rejected}");
}
