//! Options, visual settings and statistics: field by field, read and written.

use std::mem::MaybeUninit;

use mujoco_safe::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use mujoco_safe::model::{DisableFlags, EnableFlags, Statistics, Visual};
use mujoco_safe::sys::{self, mjModel, mjOption, mjVisual};
use mujoco_safe::{Error, Model, Options, sample};

use crate::twins::{c, differing, subjects};

/// A field as numbers.
trait Numbers {
    fn numbers(&self) -> Vec<f64>;
}

macro_rules! numbers {
    ($($type:ty => |$value:ident| $number:expr;)*) => {$(
        impl Numbers for $type {
            fn numbers(&self) -> Vec<f64> {
                let $value = *self;
                vec![$number]
            }
        }
    )*};
}
numbers! {
    f64 => |value| value;
    f32 => |value| value.into();
    i32 => |value| value.into();
    usize => |value| value as f64;
    bool => |value| value.into();
    Integrator => |value| (value as i32).into();
    Collision => |value| (value as i32).into();
    Cone => |value| (value as i32).into();
    JacobianStorage => |value| (value as i32).into();
    Solver => |value| (value as i32).into();
    DisableFlags => |value| value.bits().into();
    EnableFlags => |value| value.bits().into();
}

impl<T: Numbers, const N: usize> Numbers for [T; N] {
    fn numbers(&self) -> Vec<f64> {
        self.iter().flat_map(Numbers::numbers).collect()
    }
}

/// Changes a value to another valid value, for positive numbers and fractions.
trait Change {
    fn change(&mut self);
}

macro_rules! change {
    ($($type:ty => |$value:ident| $other:expr;)*) => {$(
        impl Change for $type {
            fn change(&mut self) {
                let $value = *self;
                *self = $other;
            }
        }
    )*};
}
change! {
    f64 => |value| value * 0.75 + 0.001;
    f32 => |value| value * 0.75 + 0.001;
    usize => |value| value + 7;
    bool => |value| !value;
    Integrator => |_value| Integrator::Implicit;
    Collision => |_value| Collision::Dynamic;
    Cone => |_value| Cone::Elliptic;
    JacobianStorage => |_value| JacobianStorage::Sparse;
    Solver => |_value| Solver::Cg;
    DisableFlags => |_value| DisableFlags::SENSOR;
    EnableFlags => |_value| EnableFlags::ENERGY;
}

impl<T: Change, const N: usize> Change for [T; N] {
    fn change(&mut self) {
        self.iter_mut().for_each(Change::change);
    }
}

/// An option of the engine, by the name of 2.2.2.
macro_rules! raw_option {
    ($raw:ident apirate) => {
        differing::options($raw)[0]
    };
    ($raw:ident mpr_tolerance) => {
        differing::options($raw)[1]
    };
    ($raw:ident mpr_iterations) => {
        differing::options($raw)[2]
    };
    ($raw:ident collision) => {
        differing::options($raw)[3]
    };
    ($raw:ident $field:ident) => {
        $raw.$field
    };
}

/// A field of `Options`, by the engine's name.
macro_rules! option {
    ($options:ident disableflags) => {
        $options.disable
    };
    ($options:ident enableflags) => {
        $options.enable
    };
    ($options:ident $field:ident) => {
        $options.$field
    };
}

macro_rules! compare_options {
    ($ours:ident, $raw:ident, $what:expr, $($field:ident)*) => {
        $(assert_eq!(
            option!($ours $field).numbers(), raw_option!($raw $field).numbers(), "{}: {}", $what, stringify!($field)
        );)*
    };
}

macro_rules! compare {
    ($ours:ident, $raw:expr, $what:expr, $($($field:ident).+)*) => {
        $(assert_eq!($ours.$($field).+.numbers(), $raw.$($field).+.numbers(), "{}: {}", $what, stringify!($($field).+));)*
    };
}

fn compare_options(what: &str, ours: &Options, raw: &mjOption) {
    option_fields! { compare_options ours, raw, what, }
}

fn compare_visual(what: &str, ours: &Visual, raw: &mjVisual) {
    // SAFETY: numbers only.
    let mut seen = unsafe { std::ptr::read(raw) };
    // Newer engines have a third value for a light that is on if the scene has no other light.
    seen.headlight.active = seen.headlight.active.min(1);
    let raw = &seen;
    visual_fields! { compare ours, raw, what, }
}

fn compare_statistics(what: &str, ours: Statistics, raw: &sys::mjStatistic) {
    statistic_fields! { compare ours, raw, what, }
}

fn raw(model: &Model) -> &mjModel {
    // SAFETY: valid as long as the model, and nothing writes to it during the borrow.
    unsafe { &*model.as_ptr() }
}

fn compare_all(what: &str, model: &Model) {
    compare_options(what, &model.options(), &raw(model).opt);
    compare_visual(what, &model.visual(), &raw(model).vis);
    compare_statistics(what, model.statistics(), &raw(model).stat);
}

fn every_element() -> Model {
    Model::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml")).unwrap()
}

#[test]
fn settings_of_every_model_equal_c_and_are_valid() {
    let mut models: Vec<(String, Model)> =
        subjects().iter().map(|subject| (subject.name.clone(), subject.model.try_clone().unwrap())).collect();
    models.push(("every_element".to_owned(), every_element()));
    for (name, model) in &mut models {
        compare_all(name, model);
        let before = (model.options(), model.visual(), model.statistics());
        model.edit().edit_options(|_| ()).unwrap_or_else(|error| panic!("{name}: {error}"));
        model.edit().edit_visual(|_| ()).unwrap_or_else(|error| panic!("{name}: {error}"));
        model.edit().edit_statistics(|_| ()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((model.options(), model.visual(), model.statistics()), before, "{name}");
        compare_all(name, model);
    }
}

#[test]
fn defaults_equal_c() {
    let mut option = MaybeUninit::<mjOption>::zeroed();
    c!(mj_defaultOption(option.as_mut_ptr()));
    // SAFETY: numbers that the engine has initialised.
    compare_options("the default", &Options::default(), unsafe { option.assume_init_ref() });

    let mut visual = MaybeUninit::<mjVisual>::zeroed();
    c!(mj_defaultVisual(visual.as_mut_ptr()));
    // SAFETY: as above.
    compare_visual("the default", &Visual::default(), unsafe { visual.assume_init_ref() });

    // The engine returns these defaults only with a model from which it cannot compute them.
    let empty = Model::from_xml_str("<mujoco/>").unwrap();
    let (default, empty) = (Statistics::default(), empty.statistics());
    assert_eq!((default.meaninertia, default.meanmass), (empty.meaninertia, empty.meanmass));
    assert_eq!((default.meansize, default.extent), (empty.meansize, empty.extent));
}

macro_rules! change_options {
    ($options:ident, $($field:ident)*) => { $(option!($options $field).change();)* };
}

macro_rules! all_options_differ {
    ($before:ident, $after:ident, $($field:ident)*) => {
        $(assert!(
            raw_option!($before $field).numbers() != raw_option!($after $field).numbers()
                || (cfg!(engine_since = "3.5.0") && ["apirate", "collision"].contains(&stringify!($field))),
            "{}", stringify!($field)
        );)*
    };
}

macro_rules! change_fields {
    ($of:ident, $($($field:ident).+)*) => { $($of.$($field).+.change();)* };
}

macro_rules! all_differ {
    ($before:expr, $after:expr, $($($field:ident).+)*) => {
        $(assert_ne!($before.$($field).+.numbers(), $after.$($field).+.numbers(), "{}", stringify!($($field).+));)*
    };
}

#[test]
fn every_setting_is_written_to_the_engines_field() {
    let mut model = sample::cartpole();
    // SAFETY: numbers and addresses, of which only the numbers are used.
    let before = unsafe { std::ptr::read(raw(&model)) };
    let (mut options, mut visual, mut statistics) = (model.options(), model.visual(), model.statistics());
    option_fields! { change_options options, }
    // Options that newer engines lack cannot be changed.
    if cfg!(engine_since = "3.5.0") {
        (options.apirate, options.collision) = (model.options().apirate, model.options().collision);
    }
    visual_fields! { change_fields visual, }
    statistic_fields! { change_fields statistics, }
    model.edit().edit_options(|model| *model = options).unwrap();
    model.edit().edit_visual(|model| *model = visual).unwrap();
    model.edit().edit_statistics(|model| *model = statistics).unwrap();

    assert_eq!((model.options(), model.visual(), model.statistics()), (options, visual, statistics));
    compare_all("changed", &model);
    let after = raw(&model);
    let (options_before, options_after) = (&before.opt, &after.opt);
    option_fields! { all_options_differ options_before, options_after, }
    visual_fields! { all_differ before.vis, after.vis, }
    statistic_fields! { all_differ before.stat, after.stat, }
}

/// Makes one setting invalid, and expects an error that names it and leaves the model unchanged.
macro_rules! assert_rejected {
    ($model:ident.$read:ident, $edit:ident, $what:literal: $($($field:ident).+ = $value:expr;)*) => {$(
        let before = $model.$read();
        let error = $model.edit().$edit(|settings| settings.$($field).+ = $value).unwrap_err();
        let Error::Invalid { what, .. } = &error else { panic!("{error}") };
        assert_eq!(*what, [$what, stringify!($($field).+)].concat(), "{}", stringify!($value));
        assert_eq!($model.$read(), before);
    )*};
}

#[test]
fn invalid_visual_settings_are_rejected() {
    let mut model = sample::cartpole();
    assert_rejected! { model.visual, edit_visual, "visual.":
        global.fovy = 0.0; global.fovy = 180.0; global.fovy = f32::NAN;
        global.ipd = f32::INFINITY;
        global.azimuth = f32::NAN;
        global.elevation = f32::NEG_INFINITY;
        global.linewidth = 0.0; global.linewidth = f32::INFINITY;
        global.glow = -0.1; global.glow = f32::NAN;
        global.offwidth = 0; global.offwidth = 32_769; global.offwidth = usize::MAX;
        global.offheight = 0; global.offheight = 1 << 32;
        quality.shadowsize = 32_769;
        quality.offsamples = 65;
        quality.numslices = 0; quality.numslices = 1001;
        quality.numstacks = 0; quality.numstacks = 1001;
        quality.numquads = 0; quality.numquads = 1001;
        headlight.ambient = [0.0, -0.1, 0.0];
        headlight.diffuse = [0.0, 0.0, f32::NAN];
        headlight.specular = [f32::INFINITY, 0.0, 0.0];
        map.stiffness = -1.0;
        map.stiffnessrot = 0.0;
        map.force = f32::NAN;
        map.torque = -1.0;
        map.alpha = 1.1; map.alpha = f32::NAN;
        map.fogstart = -1.0;
        map.fogend = 3.0; map.fogend = f32::INFINITY;
        map.znear = 0.0; map.znear = 50.0; map.znear = f32::NAN; map.znear = 1e-7;
        map.zfar = f32::INFINITY; map.zfar = f32::NAN; map.zfar = -1.0;
        map.haze = -0.1;
        map.shadowclip = 0.0;
        map.shadowscale = f32::NAN;
        map.actuatortendon = -1.0;
        scale.forcewidth = -1.0;
        scale.slidercrank = f32::NAN;
        rgba.fog = [0.0, 0.0, 0.0, 1.1];
        rgba.crankbroken = [f32::NAN, 0.0, 0.0, 1.0];
    }
    assert_rejected! { model.statistics, edit_statistics, "the statistic ":
        meaninertia = 0.0; meaninertia = -1.0; meaninertia = f64::NAN; meaninertia = f64::INFINITY;
        meanmass = -1.0; meanmass = f64::NAN;
        meansize = 0.0; meansize = f64::INFINITY;
        extent = 0.0; extent = 1e11; extent = f64::NAN;
        center = [0.0, f64::NAN, 0.0];
    }
    assert_rejected! { model.options, edit_options, "the option ":
        apirate = -1.0; apirate = f64::NAN;
    }
}

#[test]
fn negative_counts_of_a_model_read_as_zero() {
    let xml = r#"<mujoco><visual><quality shadowsize="-1"/><global offwidth="-5"/></visual></mujoco>"#;
    let mut model = Model::from_xml_str(xml).unwrap();
    assert_eq!((model.visual().quality.shadowsize, model.visual().global.offwidth), (0, 0));
    // The invalid width is rejected until it is corrected.
    assert!(model.edit().edit_visual(|visual| visual.map.zfar = 40.0).is_err());
    model.edit().edit_visual(|visual| (visual.map.zfar, visual.global.offwidth) = (40.0, 100)).unwrap();
    assert_eq!(raw(&model).vis.quality.shadowsize, 0);
}
