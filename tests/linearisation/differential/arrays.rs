//! Each array of numbers of a model is changed, by whatever engine it was introduced.

use mujoco_safe::{MatrixView, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Tally, compare_model, features};

/// View of an array of numbers, or `None` for other values.
trait Numbers<'a> {
    fn numbers(self) -> Option<&'a [f64]>;
}

impl<'a> Numbers<'a> for &'a [f64] {
    fn numbers(self) -> Option<&'a [f64]> {
        Some(self)
    }
}

impl<'a, const N: usize> Numbers<'a> for &'a [[f64; N]] {
    fn numbers(self) -> Option<&'a [f64]> {
        Some(self.as_flattened())
    }
}

macro_rules! others {
    ($($type:ty),*) => {$(
        impl<'a> Numbers<'a> for $type {
            fn numbers(self) -> Option<&'a [f64]> {
                None
            }
        }
    )*};
}
others!(usize, &'a [i32], &'a [u8], &'a [f32], &'a [i64], MatrixView<'a>);

macro_rules! other_rows {
    ($($type:ty),*) => {$(
        impl<'a, const N: usize> Numbers<'a> for &'a [[$type; N]] {
            fn numbers(self) -> Option<&'a [f64]> {
                None
            }
        }
    )*};
}
other_rows!(i32, f32, u8);

/// Arrays that a change makes inconsistent: identifiers stored as numbers, shapes, bounding volumes
/// and quaternions.
const LEFT_OUT: [&str; 14] = [
    "wrap_prm",
    "hfield_size",
    "bvh_aabb",
    "oct_aabb",
    "geom_aabb",
    "geom_rbound",
    "body_quat",
    "body_iquat",
    "geom_quat",
    "site_quat",
    "cam_quat",
    "mesh_quat",
    "mesh_scale",
    "eq_data",
];

/// Changes the elements of the array with this number at random. Returns its name, or `None` if it
/// has no numbers.
fn change(model: &Model, number: usize, random: &mut Xoshiro256PlusPlus) -> Option<&'static str> {
    let mut arrays: Vec<(&'static str, Option<&[f64]>)> = Vec::new();
    macro_rules! list {
        ($($name:ident)*) => { $(arrays.push((stringify!($name), model.$name().numbers()));)* };
    }
    model_readers! { list }
    let (name, values) = *arrays.get(number)?;
    let values = values.filter(|values| !values.is_empty() && !LEFT_OUT.contains(&name))?;
    let (start, length) = (values.as_ptr().cast_mut(), values.len());
    for at in 0..length {
        // SAFETY: an element of the array. The model is not used while it changes, and no call of
        // the engine reads numbers of these arrays as indices.
        unsafe {
            let value = start.add(at);
            *value = if *value == 0.0 { random.random_range(0.0..0.2) } else { *value * random.random_range(0.9..1.1) };
        }
    }
    Some(name)
}

fn compare_arrays(states: usize, only_new: bool) -> Tally {
    let mut total = Tally::default();
    for (base, xml) in features::bases().into_iter().enumerate() {
        let unchanged = Model::from_xml_str(&xml).unwrap_or_else(|error| panic!("{error}: {xml}"));
        for number in 0.. {
            let model = unchanged.clone();
            let mut random = Xoshiro256PlusPlus::seed_from_u64(number as u64);
            let count = array_count();
            if number == count {
                break;
            }
            let Some(name) = change(&model, number, &mut random) else { continue };
            if only_new && !features::NEW_ARRAYS.contains(&name) {
                continue;
            }
            let mut tally = Tally::default();
            compare_model(model, number as u64, states, &mut tally);
            total.compared += tally.compared;
            total.noisy += tally.noisy;
            total.reported += tally.reported;
            total.failures.extend(tally.failures.iter().map(|failure| format!("base {base}, {name}: {failure}")));
        }
    }
    total
}

fn array_count() -> usize {
    let mut count = 0;
    macro_rules! list {
        ($($name:ident)*) => { $(let _ = stringify!($name); count += 1;)* };
    }
    model_readers! { list }
    count
}

#[test]
fn each_array_of_newer_engines_is_linearised() {
    let total = compare_arrays(1, true);
    assert!(total.failures.is_empty(), "{} of {}: {:#?}", total.failures.len(), total.compared, total.failures);
}

/// `STATES=5 cargo test --release --test linearisation -- --ignored --nocapture
/// each_array_is_linearised`
#[test]
#[ignore = "a campaign"]
fn each_array_is_linearised() {
    let states = std::env::var("STATES").map_or(5, |text| text.parse().expect("STATES is a number"));
    let total = compare_arrays(states, false);
    let Tally { compared, noisy, reported, failures, .. } = &total;
    println!("{compared} entries compared, {noisy} noisy, {reported} reported, {} blocks wrong", failures.len());
    assert!(total.failures.is_empty(), "{:#?}", total.failures);
}
