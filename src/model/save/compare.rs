//! Comparison of a model with the model that is loaded from its saved text.
//!
//! Arrays are read from the binary form of both models, in the order of the engine's table of fields. The three structs of
//! settings are read from the engine's memory.

use std::collections::HashMap;

use mujoco_sys::{mjMINVAL, mjOption, mjStatistic, mjVisual};

use crate::error::{Error, Result, UnsavedField};
use crate::field_docs::FieldDoc;
use crate::kind::Kind;
use crate::model::Model;

/// Largest difference between two values that are considered equal, relative to the largest value of their row. The text has 17
/// digits, so differences are rounding errors of derived fields, whose condition numbers are far below 1e8.
const RELATIVE: f64 = 1e-8;
/// Relative tolerance for arrays that the engine always writes with six digits: the rounding error is up to 5e-6.
const RELATIVE_OF_SIX_DIGITS: f64 = 1e-5;
/// Relative tolerance for all arrays, if the text has only six digits of numbers from which others are derived: the vertices of a
/// mesh without a file, or every number with an engine whose precision cannot be set. Moments of inertia scale with the fifth
/// power of a length, which multiplies its relative error by five, and their axes are less exact than the moments.
const RELATIVE_OF_DERIVED: f64 = 1e-4;
/// Absolute tolerance: the writer prints numbers that are this close to an integer as that integer.
const ABSOLUTE: f64 = 1e-12;
/// Absolute tolerance for masses and moments of inertia: the engine treats smaller values as zero.
const ABSOLUTE_OF_MASS: f64 = mjMINVAL;

/// Arrays of skins, which the engine always writes with six digits if the skin has no file.
const SIX_DIGITS: [&str; 3] = ["skin_vert", "skin_texcoord", "skin_bonevertweight"];

/// Flags of the compiler for frames that coincide and bodies that move independently. An edit clears them, which slows the engine
/// down but does not change results.
const CACHED_FLAGS: [&str; 5] = ["body_simple", "body_sameframe", "geom_sameframe", "site_sameframe", "dof_simplenum"];

/// Returns an error if the comparison is not supported.
#[allow(clippy::unnecessary_wraps, reason = "an error with other engines")]
pub(super) fn check_supported() -> Result<()> {
    Ok(())
}

/// Returns the fields of `model` whose values differ in `reloaded`.
pub(super) fn lost(model: &Model, reloaded: &Model) -> Result<Vec<UnsavedField>> {
    let relative = relative_tolerance(model, reloaded);
    let sizes = sizes(model).zip(sizes(reloaded));
    let mut lost: Vec<UnsavedField> =
        sizes.filter(|(own, other)| own != other).map(|((name, _), _)| of_setting(name)).collect();
    settings(model, reloaded, relative, &mut lost);
    // Arrays can be compared only if they have the same shapes.
    if have_same_sizes(model, reloaded) {
        arrays(model, reloaded, relative, &mut lost)?;
    }
    Ok(lost)
}

/// Returns `true` if all sizes agree, and with them the shapes of all arrays.
pub(super) fn have_same_sizes(a: &Model, b: &Model) -> bool {
    sizes(a).eq(sizes(b))
}

/// Returns the names and values of the model's sizes.
fn sizes(model: &Model) -> impl Iterator<Item = (&'static str, i32)> {
    macro_rules! sizes {
        ($($name:ident)*) => { [$((stringify!($name), model.raw().$name)),*] };
    }
    // `nbuffer` is the size of all arrays together.
    let sizes = sizes! {
        nq nv nu na nbody njnt ngeom nsite ncam nlight nmesh nmeshvert nmeshtexvert nmeshface nmeshgraph nskin nskinvert
        nskintexvert nskinface nskinbone nskinbonevert nhfield nhfielddata ntex ntexdata nmat npair nexclude neq ntendon nwrap
        nsensor nnumeric nnumericdata ntext ntextdata ntuple ntupledata nkey nmocap nuser_body nuser_jnt nuser_geom nuser_site
        nuser_cam nuser_tendon nuser_actuator nuser_sensor nnames nM nD nemax njmax nconmax nstack nuserdata nsensordata nbuffer
    };
    sizes.into_iter()
}

/// Returns the relative tolerance for all numbers. The vertices of meshes cannot be edited, so if they differ, they were rounded.
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

/// Compares a struct field by field. A field that is missing in the list is a compile error.
macro_rules! compare {
    ($lost:ident, $relative:ident, $prefix:literal, $type:ident, $own:expr, $other:expr; $($field:ident)*) => {{
        let $type { $($field),* } = $own;
        $(if !agree(&$field.numbers(), &$other.$field.numbers(), $relative, ABSOLUTE) {
            $lost.push(of_setting(concat!($prefix, stringify!($field))));
        })*
    }};
}

/// Compares options, statistics and visualiser settings.
fn settings(model: &Model, reloaded: &Model, relative: f64, lost: &mut Vec<UnsavedField>) {
    use mujoco_sys::{
        mjVisual___bindgen_ty_1 as Global, mjVisual___bindgen_ty_2 as Quality, mjVisual___bindgen_ty_3 as Headlight,
        mjVisual___bindgen_ty_4 as Map, mjVisual___bindgen_ty_5 as Scale, mjVisual___bindgen_ty_6 as Rgba,
    };
    let (own, other) = (model.raw(), reloaded.raw());
    compare! { lost, relative, "opt.", mjOption, &own.opt, &other.opt;
        timestep apirate impratio tolerance noslip_tolerance mpr_tolerance gravity wind magnetic density viscosity o_margin
        o_solref o_solimp integrator collision cone jacobian solver iterations noslip_iterations mpr_iterations disableflags
        enableflags
    }
    compare! { lost, relative, "stat.", mjStatistic, &own.stat, &other.stat; meaninertia meanmass meansize extent center }
    let mjVisual { global, quality, headlight, map, scale, rgba } = &own.vis;
    let vis = &other.vis;
    compare! { lost, relative, "vis.global.", Global, global, vis.global;
        fovy ipd azimuth elevation linewidth glow offwidth offheight
    }
    compare! { lost, relative, "vis.quality.", Quality, quality, vis.quality;
        shadowsize offsamples numslices numstacks numquads
    }
    compare! { lost, relative, "vis.headlight.", Headlight, headlight, vis.headlight; ambient diffuse specular active }
    compare! { lost, relative, "vis.map.", Map, map, vis.map;
        stiffness stiffnessrot force torque alpha fogstart fogend znear zfar haze shadowclip shadowscale actuatortendon
    }
    compare! { lost, relative, "vis.scale.", Scale, scale, vis.scale;
        forcewidth contactwidth contactheight connect com camera light selectpoint jointlength jointwidth actuatorlength
        actuatorwidth framelength framewidth constraint slidercrank
    }
    compare! { lost, relative, "vis.rgba.", Rgba, rgba, vis.rgba;
        fog haze force inertia joint actuator actuatornegative actuatorpositive com camera light selectpoint connect
        contactpoint contactforce contactfriction contacttorque contactgap rangefinder constraint slidercrank crankbroken
    }
}

/// Compares all arrays of two models with the same sizes.
fn arrays(model: &Model, reloaded: &Model, relative: f64, lost: &mut Vec<UnsavedField>) -> Result<()> {
    let sizes: HashMap<&str, usize> = sizes(model).map(|(name, value)| (name, value.try_into().unwrap_or(0))).collect();
    let extent = |text: &str| -> usize {
        text.split('*').map(|factor| factor.parse().unwrap_or_else(|_| sizes[factor])).product()
    };
    let (own, other) = (model.to_binary()?, reloaded.to_binary()?);
    let fields: Vec<FieldDoc> = Model::fields().filter(|field| field.is_array).collect();
    let length: usize =
        fields.iter().map(|field| extent(field.rows) * extent(field.columns) * element_size(field.ctype)).sum();
    // Both binary models end with the arrays.
    let bug = || Error::Unsupported("Bug: a binary model is shorter than its arrays".to_owned());
    let start = |bytes: &[u8]| bytes.len().checked_sub(length).ok_or_else(bug);
    let (mut own, mut other) = (&own[start(&own)?..], &other[start(&other)?..]);
    for field in fields {
        let (rows, row) = (extent(field.rows), extent(field.columns) * element_size(field.ctype));
        let (own_field, own_rest) = own.split_at(rows * row);
        let (other_field, other_rest) = other.split_at(rows * row);
        (own, other) = (own_rest, other_rest);
        if own_field == other_field || CACHED_FLAGS.contains(&field.name) {
            continue;
        }
        let is_mass = ["body_mass", "body_inertia"].contains(&field.name);
        let absolute = if is_mass { ABSOLUTE_OF_MASS } else { ABSOLUTE };
        let relative = if SIX_DIGITS.contains(&field.name) { relative.max(RELATIVE_OF_SIX_DIGITS) } else { relative };
        let differ = own_field.chunks_exact(row).zip(other_field.chunks_exact(row)).map(|(own, other)| {
            own != other && !agree(&decode(field.ctype, own), &decode(field.ctype, other), relative, absolute)
        });
        let rows: Vec<usize> = differ.enumerate().filter_map(|(row, differs)| differs.then_some(row)).collect();
        if !rows.is_empty() {
            lost.push(of_rows(model, &field, &rows));
        }
    }
    Ok(())
}

/// Returns the size of one element in bytes.
fn element_size(ctype: &str) -> usize {
    match ctype {
        "mjtNum" => 8,
        "float" | "int" => 4,
        _ => 1,
    }
}

/// Decodes the numbers of a row.
fn decode(ctype: &str, bytes: &[u8]) -> Vec<f64> {
    let (words, _) = bytes.as_chunks::<4>();
    match ctype {
        "mjtNum" => bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect(),
        "float" => words.iter().map(|bytes| f32::from_ne_bytes(*bytes).into()).collect(),
        "int" => words.iter().map(|bytes| i32::from_ne_bytes(*bytes).into()).collect(),
        _ => bytes.iter().map(|&byte| byte.into()).collect(),
    }
}

/// Describes a field that has one value for the whole model.
fn of_setting(field: &str) -> UnsavedField {
    UnsavedField { field: field.to_owned(), elements: Vec::new() }
}

/// Describes rows of an array.
fn of_rows(model: &Model, field: &FieldDoc, rows: &[usize]) -> UnsavedField {
    let mut elements: Vec<String> = rows.iter().map(|&row| owner_of_row(model, field.rows, row)).collect();
    elements.dedup();
    UnsavedField { field: field.name.to_owned(), elements }
}

/// Returns the name or index of the element to which a row of an array belongs. `rows` is the size that counts the rows.
fn owner_of_row(model: &Model, rows: &str, row: usize) -> String {
    let (kind, index) = match rows {
        "nbody" => (Kind::Body, row),
        "njnt" => (Kind::Joint, row),
        "nq" => (Kind::Joint, owner(model.jnt_qposadr(), row)),
        "nv" => (Kind::Joint, owner(model.jnt_dofadr(), row)),
        "ngeom" => (Kind::Geom, row),
        "nsite" => (Kind::Site, row),
        "ncam" => (Kind::Camera, row),
        "nlight" => (Kind::Light, row),
        "nmesh" => (Kind::Mesh, row),
        "nmeshvert" => (Kind::Mesh, owner(model.mesh_vertadr(), row)),
        "nmeshtexvert" => (Kind::Mesh, owner(model.mesh_texcoordadr(), row)),
        "nmeshface" => (Kind::Mesh, owner(model.mesh_faceadr(), row)),
        "nmeshgraph" => (Kind::Mesh, owner(model.mesh_graphadr(), row)),
        "nskin" => (Kind::Skin, row),
        "nskinvert" => (Kind::Skin, owner(model.skin_vertadr(), row)),
        "nskintexvert" => (Kind::Skin, owner(model.skin_texcoordadr(), row)),
        "nskinface" => (Kind::Skin, owner(model.skin_faceadr(), row)),
        "nskinbone" => (Kind::Skin, owner(model.skin_boneadr(), row)),
        "nskinbonevert" => (Kind::Skin, owner(model.skin_boneadr(), owner(model.skin_bonevertadr(), row))),
        "nhfield" => (Kind::HeightField, row),
        "nhfielddata" => (Kind::HeightField, owner(model.hfield_adr(), row)),
        "ntex" => (Kind::Texture, row),
        "ntexdata" => (Kind::Texture, owner(model.tex_adr(), row)),
        "nmat" => (Kind::Material, row),
        "npair" => (Kind::Pair, row),
        "nexclude" => (Kind::Exclude, row),
        "neq" => (Kind::Equality, row),
        "ntendon" => (Kind::Tendon, row),
        "nwrap" => (Kind::Tendon, owner(model.tendon_adr(), row)),
        "nu" => (Kind::Actuator, row),
        "nsensor" => (Kind::Sensor, row),
        "nnumeric" => (Kind::Numeric, row),
        "nnumericdata" => (Kind::Numeric, owner(model.numeric_adr(), row)),
        "ntext" => (Kind::Text, row),
        "ntextdata" => (Kind::Text, owner(model.text_adr(), row)),
        "ntuple" => (Kind::Tuple, row),
        "ntupledata" => (Kind::Tuple, owner(model.tuple_adr(), row)),
        "nkey" => (Kind::Keyframe, row),
        _ => return row.to_string(),
    };
    model.name_at(kind, index).map_or_else(|| index.to_string(), str::to_owned)
}

/// Returns the element whose data contain a row: the last element that starts at or before it. The start of an element without
/// data is -1.
fn owner(starts: &[i32], row: usize) -> usize {
    starts.iter().rposition(|&start| usize::try_from(start).is_ok_and(|start| start <= row)).unwrap_or(0)
}
