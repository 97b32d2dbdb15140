//! Named access: every field of every element is what the engine has at the address that its documentation gives.

mod assets;
mod body_parts;
mod constraints;
mod custom;
mod driven;
mod names;
mod simulation;

use std::sync::{Arc, OnceLock};

use mujoco_safe::sys::{mjData, mjModel};
use mujoco_safe::{Data, Id, Model};

use crate::twins::{Subject, subjects};

/// The usual models, and one that has each case of every kind of element.
fn models() -> impl Iterator<Item = &'static Subject> {
    subjects().iter().chain([every_element()])
}

fn every_element() -> &'static Subject {
    static SUBJECT: OnceLock<Subject> = OnceLock::new();
    SUBJECT.get_or_init(|| {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
        let model = Arc::new(Model::from_xml_path(path).unwrap());
        Subject { name: "every_element.xml".to_owned(), model }
    })
}

/// What a field returns, as bits.
trait Bits {
    fn bits(&self) -> Vec<u64>;
}

macro_rules! scalar_bits {
    ($($type:ty => |$value:ident| $bits:expr),*) => {$(
        impl Bits for $type {
            fn bits(&self) -> Vec<u64> {
                let $value = *self;
                vec![u64::from($bits)]
            }
        }
    )*};
}
scalar_bits!(u8 => |value| value, bool => |value| value, f64 => |value| value.to_bits(), f32 => |value| value.to_bits(), i32 => |value| value.cast_unsigned());

impl<T: Bits> Bits for [T] {
    fn bits(&self) -> Vec<u64> {
        self.iter().flat_map(Bits::bits).collect()
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn bits(&self) -> Vec<u64> {
        self.as_slice().bits()
    }
}

/// The bits of a field, which views hand out as a value or as a reference.
fn bits<T: Bits + ?Sized>(value: &T) -> Vec<u64> {
    value.bits()
}

impl<T: Bits + ?Sized> Bits for &T {
    fn bits(&self) -> Vec<u64> {
        (**self).bits()
    }
}

impl<T: Bits> Bits for Vec<T> {
    fn bits(&self) -> Vec<u64> {
        self.as_slice().bits()
    }
}

/// Compares each field of each view with `array[start; length]` of the engine, or with an expression, and makes sure that no
/// field that a view lists is left out.
macro_rules! check_fields {
    ($name:expr, $views:expr, |$view:ident, $i:ident| {
        $($field:ident: $array:expr, [$start:expr; $length:expr];)*
        $(=> $special:ident: $ours:expr, $theirs:expr;)*
    }) => {
        for $view in $views {
            let $i = $view.index();
            $(
                // SAFETY: the engine's arrays have a row for each element.
                let theirs = unsafe { crate::twins::read($array, $start, $length) };
                assert_eq!(
                    $crate::against_c::views::bits(&$view.$field()), $crate::against_c::views::bits(&theirs),
                    "{}, {:?}: {} is {:?}, not {:?}", $name, $view, stringify!($field), $view.$field(), theirs
                );
            )*
            $(assert_eq!($ours, $theirs, "{}, {:?}: {}", $name, $view, stringify!($special));)*
            let mut checked = vec![$(stringify!($field),)* $(stringify!($special),)*];
            let text = $view.to_string();
            let mut listed: Vec<&str> = text.lines().skip(3).filter_map(|line| line.split(':').next()).collect();
            checked.sort_unstable();
            listed.sort_unstable();
            assert_eq!(listed, checked, "the fields of {:?}", $view);
        }
    };
}
use check_fields;

/// An index of the engine's.
fn int(array: *const i32, index: usize) -> usize {
    // SAFETY: as for the other arrays.
    usize::try_from(unsafe { *array.add(index) }).unwrap()
}

/// An integer of the engine's.
fn raw(array: *const i32, index: usize) -> i32 {
    // SAFETY: as for the other arrays.
    unsafe { *array.add(index) }
}

/// As the engine writes an id that may be missing.
fn optional<K>(id: Option<Id<K>>) -> i32 {
    id.map_or(-1, |id| id.index() as i32)
}

/// As the engine writes where something begins that may be missing.
fn start(addresses: *const i32, index: usize) -> usize {
    usize::try_from(raw(addresses, index)).unwrap_or(0)
}

/// A range of the engine's, empty where its address is -1.
fn span(addresses: *const i32, counts: *const i32, index: usize) -> std::ops::Range<usize> {
    match usize::try_from(raw(addresses, index)) {
        Ok(start) => start..start + int(counts, index),
        Err(_) => 0..0,
    }
}

/// How many numbers in `qpos` and `qvel` a joint has.
fn joint_sizes(m: &mjModel, joint: usize) -> (usize, usize) {
    match int(m.jnt_type, joint) as u32 {
        mujoco_safe::sys::mjJNT_FREE => (7, 6),
        mujoco_safe::sys::mjJNT_BALL => (4, 3),
        _ => (1, 1),
    }
}

fn on_model(model: &Model) -> &mjModel {
    // SAFETY: valid as long as the model, which nothing writes to meanwhile.
    unsafe { &*model.as_ptr() }
}

fn on_data(data: &Data) -> &mjData {
    // SAFETY: valid as long as the data, which nothing writes to meanwhile.
    unsafe { &*data.as_ptr() }
}
