//! Comparison of a model with the model that is loaded from its saved text.
//!
//! The comparison has every size, setting and array in the engine's table of fields. A field that
//! has no rule here must have equal integers, and numbers that differ by rounding errors. Values of
//! `mjModel` outside of the table are flags and a signature that the compiler derives from the
//! fields.

use super::arrays::{Arrays, decode, sizes};
use super::order::{Orders, is_place_of_names, sorted_names};
use crate::error::{Result, UnsavedField};
use crate::field_docs::FieldDoc;
use crate::generated::model_settings;
use crate::model::Model;

/// Largest difference between two values that are considered equal, relative to the largest value
/// of their row. The text has 17 digits, so differences are rounding errors of derived fields,
/// whose condition numbers are far below 1e8.
const RELATIVE: f64 = 1e-8;
/// Relative tolerance for arrays that the engine always writes with six digits: the rounding error
/// is up to 5e-6.
const RELATIVE_OF_SIX_DIGITS: f64 = 1e-5;
/// Relative tolerance for all arrays, if the text has only six digits of numbers from which others
/// are derived: the vertices of a mesh without a file, or every number with an engine whose
/// precision cannot be set. Moments of inertia scale with the fifth power of a length, which
/// multiplies its relative error by five, and their axes are less exact than the moments.
const RELATIVE_OF_DERIVED: f64 = 1e-4;
/// Absolute tolerance: the writer prints numbers that are this close to an integer as that integer.
const ABSOLUTE: f64 = 1e-12;
/// Absolute tolerance for masses and moments of inertia: the engine treats smaller values as zero.
const ABSOLUTE_OF_MASS: f64 = mujoco_sys::mjMINVAL;

/// Masses and moments of inertia.
const MASSES: [&str; 2] = ["body_mass", "body_inertia"];

/// Arrays of skins, which the engine always writes with six digits if the skin has no file.
const SIX_DIGITS: [&str; 3] = ["skin_vert", "skin_texcoord", "skin_bonevertweight"];

/// Flags of the compiler for frames that coincide. An edit clears them, which slows the engine down
/// but does not change results.
const FRAME_FLAGS: [&str; 3] = ["body_sameframe", "geom_sameframe", "site_sameframe"];

/// Flags of the compiler for bodies that move independently. With 2.2.2 an edit clears them too.
/// With newer engines it does not, and they change results.
const SIMPLE_BODY_FLAGS: &[&str] = if cfg!(engine_since = "2.3.0") { &[] } else { &["body_simple", "dof_simplenum"] };

/// Paths of the files of assets, and the positions in them. Since 3.17 they are absolute, so they
/// depend on the directory from which the model was loaded. The contents of the files are compared
/// as meshes, textures, height fields and skins.
const PATHS: [&str; 6] =
    ["paths", "mesh_pathadr", "skin_pathadr", "hfield_pathadr", "tex_pathadr", "tex_contenttypeadr"];

/// Lengths of `paths` and of all arrays together.
const LENGTHS: [&str; 2] = ["npaths", "nbuffer"];

/// Returns `true` for a size that does not count elements: a length, or the number of non-zeros in
/// the inertia matrix, which depends on the bodies that move independently.
pub(super) fn is_derived(size: &str) -> bool {
    LENGTHS.contains(&size) || size == "nC"
}

/// Returns the fields of `model` whose values differ in `reloaded`.
pub(super) fn lost(model: &Model, reloaded: &Model) -> Result<Vec<UnsavedField>> {
    let relative = relative_tolerance(model, reloaded);
    let differ: Vec<&str> = differing_sizes(model, reloaded).filter(|name| !LENGTHS.contains(name)).collect();
    // Arrays can be compared only if they have the same elements.
    let have_same_elements = differ.iter().all(|name| is_derived(name));
    let mut lost: Vec<UnsavedField> = differ.into_iter().map(of_setting).collect();
    for ((name, own), (_, other)) in settings(model).zip(settings(reloaded)) {
        if !agree(&own, &other, relative, ABSOLUTE) {
            lost.push(of_setting(name));
        }
    }
    if have_same_elements {
        arrays(model, reloaded, relative, &mut lost)?;
    }
    Ok(lost)
}

/// Returns the names of the sizes that differ.
pub(super) fn differing_sizes(a: &Model, b: &Model) -> impl Iterator<Item = &'static str> {
    sizes(a).zip(sizes(b)).filter(|(own, other)| own != other).map(|((name, _), _)| name)
}

/// Returns the names and values of options, visualiser settings and statistics.
pub(crate) fn settings(model: &Model) -> impl Iterator<Item = (&'static str, Vec<f64>)> {
    macro_rules! list {
        ($($group:ident $(.$part:ident)+;)*) => {
            [$((concat!(stringify!($group) $(, ".", stringify!($part))+), model.raw().$group$(.$part)+.numbers())),*]
        };
    }
    model_settings! { list }.into_iter()
}

/// Conversion of a value of the engine's structs to numbers.
trait Numbers {
    fn numbers(&self) -> Vec<f64>;
}

macro_rules! numbers {
    ($($type:ty)*) => { $(
        impl Numbers for $type {
            fn numbers(&self) -> Vec<f64> {
                vec![f64::from(*self)]
            }
        }
        impl<const N: usize> Numbers for [$type; N] {
            fn numbers(&self) -> Vec<f64> {
                self.iter().map(|&value| f64::from(value)).collect()
            }
        }
    )* };
}
numbers! { i32 f32 f64 }

/// Returns the relative tolerance for all numbers. The vertices of meshes cannot be edited, so if
/// they differ, they were rounded.
fn relative_tolerance(model: &Model, reloaded: &Model) -> f64 {
    // SAFETY: the function returns a constant of the shim.
    let digits = unsafe { mujoco_sys::guard::xml_digits() };
    let is_exact = digits >= 17 && model.mesh_vert() == reloaded.mesh_vert();
    if is_exact { RELATIVE } else { RELATIVE_OF_DERIVED }
}

/// Returns `true` if two rows of numbers agree.
fn agree(own: &[f64], other: &[f64], relative: f64, absolute: f64) -> bool {
    let finite = own.iter().chain(other).filter(|value| value.is_finite());
    let scale = finite.fold(0.0, |scale: f64, value| scale.max(value.abs()));
    let close = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= relative * scale + absolute;
    own.iter().zip(other).all(|(&a, &b)| close(a, b))
}

/// Compares all arrays of two models with the same elements. An array whose length depends on a
/// derived size may have another length.
fn arrays(model: &Model, reloaded: &Model, relative: f64, lost: &mut Vec<UnsavedField>) -> Result<()> {
    let (own, other) = (Arrays::of(model)?, Arrays::of(reloaded)?);
    let orders = Orders::of([(model, &own), (reloaded, &other)]);
    for field in Model::fields().filter(|field| field.is_array) {
        let name = field.name;
        let (own_field, other_field) = (own.bytes(name), other.bytes(name));
        let is_skipped = [&FRAME_FLAGS[..], SIMPLE_BODY_FLAGS, &PATHS].iter().any(|names| names.contains(&name));
        let is_moved = orders.move_names()
            && (is_place_of_names(name) || (name == "names" && sorted_names(own_field) == sorted_names(other_field)));
        if is_skipped || is_moved || own_field.len() != other_field.len() || own_field == other_field {
            continue;
        }
        let absolute = if MASSES.contains(&name) { ABSOLUTE_OF_MASS } else { ABSOLUTE };
        let relative = if SIX_DIGITS.contains(&name) { relative.max(RELATIVE_OF_SIX_DIGITS) } else { relative };
        let row = own.row_length(&field);
        let differs = |own: usize, other: usize| {
            let (own, other) = (&own_field[own * row..][..row], &other_field[other * row..][..row]);
            own != other && !agree(&decode(field.ctype, own), &decode(field.ctype, other), relative, absolute)
        };
        let rows: Vec<usize> = match orders.of_rows(field.rows) {
            Some([own, other]) => {
                std::iter::zip(own, other).filter_map(|(&own, &other)| differs(own, other).then_some(own)).collect()
            }
            None => (0..own_field.len() / row).filter(|&row| differs(row, row)).collect(),
        };
        if !rows.is_empty() {
            lost.push(of_rows(&own, &field, &rows));
        }
    }
    Ok(())
}

/// Describes a field that has one value for the whole model.
fn of_setting(field: &str) -> UnsavedField {
    UnsavedField { field: field.to_owned(), elements: Vec::new() }
}

/// Describes rows of an array.
fn of_rows(arrays: &Arrays<'_>, field: &FieldDoc, rows: &[usize]) -> UnsavedField {
    let mut elements: Vec<String> = rows.iter().map(|&row| arrays.owner(field, row)).collect();
    elements.dedup();
    UnsavedField { field: field.name.to_owned(), elements }
}

#[cfg(test)]
mod tests {
    use std::mem::{align_of, size_of};

    use mujoco_sys::{mjOption, mjStatistic, mjVisual};

    use super::super::arrays::element_size;
    use super::{FRAME_FLAGS, MASSES, SIMPLE_BODY_FLAGS, SIX_DIGITS, lost};
    use crate::field_docs::FieldDoc;
    use crate::model::Model;

    /// A setting that the table lacks would not be compared.
    #[test]
    fn the_table_of_fields_has_every_byte_of_the_settings() {
        let bytes = |structure| -> usize {
            let length = |field: FieldDoc| field.rows.parse::<usize>().unwrap() * element_size(field.ctype);
            FieldDoc::all(structure).map(length).sum()
        };
        assert_eq!(bytes("Option").next_multiple_of(align_of::<mjOption>()), size_of::<mjOption>());
        assert_eq!(bytes("Visual"), size_of::<mjVisual>());
        assert_eq!(bytes("Statistic"), size_of::<mjStatistic>());
    }

    #[test]
    fn rules_name_arrays_of_the_engine() {
        for name in FRAME_FLAGS.iter().chain(SIMPLE_BODY_FLAGS).chain(&MASSES).chain(&SIX_DIGITS) {
            assert!(FieldDoc::all("Model").any(|field| field.is_array && field.name == *name), "{name}");
        }
    }

    /// Compares models whose texts differ in one attribute.
    #[test]
    fn the_fields_and_elements_of_a_difference_are_named() {
        let load = |edit: Option<(&str, &str)>| {
            let (attribute, newer) = edit.unwrap_or_default();
            let text = TEXT.replace(attribute, newer);
            assert_eq!(text == TEXT, edit.is_none(), "{attribute}");
            Model::from_xml_str(&text).unwrap()
        };
        let names =
            |edit| -> Vec<String> { lost(&load(None), &load(edit)).unwrap().iter().map(ToString::to_string).collect() };
        assert_eq!(names(None), [""; 0]);
        for (attribute, newer, expected) in EDITS {
            assert_eq!(names(Some((attribute, newer))), [*expected], "{newer}");
        }
        assert_eq!(names(Some(("<site/>", "<site/><site/>")))[0], "nsite");
    }

    const TEXT: &str = r#"<mujoco>
      <option timestep="0.001"/>
      <visual><global offwidth="640"/><rgba fog="0 0 0 1"/></visual>
      <asset><material name="metal"/><hfield name="hill" nrow="2" ncol="2" size="1 1 1 1"/></asset>
      <worldbody>
        <light diffuse="0.5 0.5 0.5"/>
        <camera name="eye"/>
        <body name="arm"><joint name="hinge" damping="1"/><geom name="link" size="0.1"/><site/></body>
      </worldbody>
      <actuator><general name="motor" joint="hinge"/></actuator>
      <sensor><jointpos name="angle" joint="hinge"/></sensor>
      <keyframe><key name="start" qpos="0.1"/></keyframe>
    </mujoco>"#;

    /// Edits of the text, and the fields that differ.
    const EDITS: &[(&str, &str, &str)] = &[
        (r#"timestep="0.001""#, r#"timestep="0.00100001""#, "opt.timestep"),
        (r#"offwidth="640""#, r#"offwidth="641""#, "vis.global.offwidth"),
        (r#"fog="0 0 0 1""#, r#"fog="0 0.1 0 1""#, "vis.rgba.fog"),
        (r#"damping="1""#, r#"damping="1.0000001""#, "dof_damping (hinge)"),
        (r#"diffuse="0.5 0.5 0.5""#, r#"diffuse="0.5 0.5 0.6""#, "light_diffuse (0)"),
        (r#"qpos="0.1""#, r#"qpos="0.2""#, "key_qpos (start)"),
        ("<jointpos name", r#"<jointpos cutoff="2" name"#, "sensor_cutoff (angle)"),
        #[cfg(engine_since = "3.5.0")]
        (r#"timestep="0.001""#, r#"timestep="0.001" ls_iterations="7""#, "opt.ls_iterations"),
        #[cfg(engine_since = "3.5.0")]
        (r#"offwidth="640""#, r#"offwidth="640" orthographic="true""#, "vis.global.orthographic"),
        #[cfg(engine_since = "3.5.0")]
        ("material name", r#"material metallic="0.3" name"#, "mat_metallic (metal)"),
        #[cfg(engine_since = "3.5.0")]
        ("body name", r#"body gravcomp="0.1" name"#, "ngravcomp"),
        #[cfg(engine_since = "3.5.0")]
        (r#"diffuse="0.5 0.5 0.5""#, r#"diffuse="0.5 0.5 0.5" intensity="3""#, "light_intensity (0)"),
        #[cfg(engine_since = "3.5.0")]
        ("camera name", r#"camera resolution="2 2" name"#, "cam_resolution (eye)"),
        #[cfg(engine_since = "3.5.0")]
        ("general name", r#"general actearly="true" name"#, "actuator_actearly (motor)"),
    ];
}
