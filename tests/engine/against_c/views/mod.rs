//! Views: every field of every element equals the engine's value at its documented address.

mod assets;
mod body_parts;
mod constraints;
mod custom;
mod driven;
mod enums;
mod names;
mod simulation;

use std::fmt::Debug;
use std::sync::{Arc, OnceLock};

use mujoco_safe::id::Id;
use mujoco_safe::sys::{mjData, mjModel};
use mujoco_safe::{Data, Model};

use crate::cases::cases;
use crate::twins::{Subject, subjects};

/// Returns the usual models, every other one unless all cases run, and a model with every kind of
/// element in every variant.
fn models() -> impl Iterator<Item = &'static Subject> {
    subjects().iter().step_by(cases(2, 1)).chain([every_element()])
}

fn every_element() -> &'static Subject {
    static SUBJECT: OnceLock<Subject> = OnceLock::new();
    SUBJECT.get_or_init(|| {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
        let model = Arc::new(Model::from_xml_path(path).unwrap());
        Subject { name: "every_element.xml".to_owned(), model }
    })
}

/// The bits of a field's value, so that −0 differs from 0 and NaN equals itself.
trait Bits {
    fn push_bits(&self, bits: &mut Vec<u64>);

    fn bits(&self) -> Vec<u64> {
        let mut bits = Vec::new();
        self.push_bits(&mut bits);
        bits
    }
}

macro_rules! scalar_bits {
    ($($type:ty => |$value:ident| $bits:expr),*) => {$(
        impl Bits for $type {
            fn push_bits(&self, bits: &mut Vec<u64>) {
                let $value = *self;
                bits.push(u64::from($bits));
            }
        }
    )*};
}
scalar_bits!(u8 => |value| value, bool => |value| value, f64 => |value| value.to_bits(), f32 => |value| value.to_bits(), i32 => |value| value.cast_unsigned());

impl<T: Bits> Bits for [T] {
    fn push_bits(&self, bits: &mut Vec<u64>) {
        for value in self {
            value.push_bits(bits);
        }
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn push_bits(&self, bits: &mut Vec<u64>) {
        self.as_slice().push_bits(bits);
    }
}

impl<T: Bits + ?Sized> Bits for &T {
    fn push_bits(&self, bits: &mut Vec<u64>) {
        (**self).push_bits(bits);
    }
}

impl<T: Bits> Bits for Vec<T> {
    fn push_bits(&self, bits: &mut Vec<u64>) {
        self.as_slice().push_bits(bits);
    }
}

/// Asserts that a field, which views return by value or by reference, has the engine's bits.
#[track_caller]
fn assert_same_bits<T: Bits + Debug, U: Bits + Debug>(name: &str, view: &dyn Debug, field: &str, ours: T, theirs: U) {
    assert!(ours.bits() == theirs.bits(), "{name}, {view:?}: {field} is {ours:?}, not {theirs:?}");
}

/// A function takes less time to compile than `assert_eq!` in the macro.
#[track_caller]
fn assert_equal<T: PartialEq + Debug>(name: &str, view: &dyn Debug, field: &str, ours: &T, theirs: &T) {
    assert!(ours == theirs, "{name}, {view:?}: {field} is {ours:?}, not {theirs:?}");
}

/// Compares each field of each view with `array[start; length]` of the engine, or with an
/// expression, and asserts that every listed field of the view is compared.
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
                $crate::against_c::views::assert_same_bits($name, &$view, stringify!($field), $view.$field(), theirs);
            )*
            $($crate::against_c::views::assert_equal($name, &$view, stringify!($special), &$ours, &$theirs);)*
            let mut checked = vec![$(stringify!($field),)* $(stringify!($special),)*];
            let text = $view.to_string();
            let mut listed: Vec<&str> = text.lines().skip(3).filter_map(|line| line.split(':').next()).collect();
            checked.sort_unstable();
            listed.sort_unstable();
            // Those that only newer engines have are checked by `newer_fields` of the program
            // smoke.
            if cfg!(engine_since = "2.3.0") {
                listed.retain(|field| checked.binary_search(field).is_ok());
            }
            assert_eq!(listed, checked, "the fields of {:?}", $view);
        }
    };
}
use check_fields;

/// Returns an index from an engine array of integers, some of which are wide in newer engines.
fn int<T: Copy + TryInto<usize, Error: std::fmt::Debug>>(array: *const T, index: usize) -> usize {
    // SAFETY: as for the other arrays.
    unsafe { *array.add(index) }.try_into().unwrap()
}

/// Returns an integer from an engine array.
fn raw(array: *const i32, index: usize) -> i32 {
    // SAFETY: as for the other arrays.
    unsafe { *array.add(index) }
}

/// Returns an optional id in the engine's representation.
fn optional<K>(id: Option<Id<K>>) -> i32 {
    id.map_or(-1, |id| id.index() as i32)
}

/// Returns an optional address in the engine's representation.
fn start(addresses: *const i32, index: usize) -> usize {
    usize::try_from(raw(addresses, index)).unwrap_or(0)
}

/// Returns a range of the engine, which is empty if its address is -1.
fn span(addresses: *const i32, counts: *const i32, index: usize) -> std::ops::Range<usize> {
    match usize::try_from(raw(addresses, index)) {
        Ok(start) => start..start + int(counts, index),
        Err(_) => 0..0,
    }
}

/// Returns the numbers of entries of a joint in `qpos` and `qvel`.
fn joint_sizes(m: &mjModel, joint: usize) -> (usize, usize) {
    match int(m.jnt_type, joint) as u32 {
        mujoco_safe::sys::mjJNT_FREE => (7, 6),
        mujoco_safe::sys::mjJNT_BALL => (4, 3),
        _ => (1, 1),
    }
}

fn on_model(model: &Model) -> &mjModel {
    // SAFETY: valid as long as the model, and nothing writes to it during the borrow.
    unsafe { &*model.as_ptr() }
}

fn on_data(data: &Data) -> &mjData {
    // SAFETY: valid as long as the data, and nothing writes to it during the borrow.
    unsafe { &*data.as_ptr() }
}
