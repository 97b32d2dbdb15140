//! Results of comparisons between edited and compiled models.

use std::collections::BTreeMap;

use mujoco_safe::id::GeomId;
use mujoco_safe::model::DisableFlags;
use mujoco_safe::{Data, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub(super) enum Outcome {
    /// The models are equal after edits of these fields.
    Equal(Vec<&'static str>),
    /// The compiled model differs in fields that edits cannot set. The first list has those that
    /// they can set.
    Structure(Vec<&'static str>, Vec<&'static str>),
    /// The call of `update_constants` returned an error.
    Rejected(Vec<&'static str>, String),
    /// The models are equal after edits of these fields, and simulations magnify rounding errors.
    Rounding(Vec<&'static str>),
    /// The models differ after edits of these fields.
    Differs(Vec<&'static str>, String),
}

/// Fields that edits do not restore and that change no result: the flags by which the engine skips
/// computations. Engines since 2.3 lay out the inertia matrix by `body_simple`, so that edits keep
/// it. Those from 2.3 to 3.10 do not compute the flags of frames in `mj_setConst`.
pub(super) const FLAGS: [&str; 5] =
    ["body_simple", "dof_simplenum", "body_sameframe", "geom_sameframe", "site_sameframe"];

/// Hierarchies of boxes: the compiler sorts the geoms of a body by their places, and an edited
/// model keeps their order.
pub(super) const HIERARCHY: [&str; 3] = ["bvh_nodeid", "bvh_child", "bvh_depth"];

/// Returns `true` for fields that an edit leaves at other values than the compiler, without a
/// difference in any result.
fn is_kept(field: &str) -> bool {
    let flags = match () {
        () if !cfg!(engine_since = "2.3.0") => 0,
        () if cfg!(engine_since = "3.11.0") => 2,
        () => FLAGS.len(),
    };
    FLAGS[..flags].contains(&field) || HIERARCHY.contains(&field)
}

/// Returns the fields that differ, with their first different values.
pub(super) fn differing_arrays(
    edited: &BTreeMap<&'static str, Vec<f64>>,
    compiled: &BTreeMap<&'static str, Vec<f64>>,
) -> Vec<String> {
    let is_equal = |left: &[f64], right: &[f64]| {
        left.len() == right.len() && left.iter().zip(right).all(|(left, right)| is_close(*left, *right, 1e-9))
    };
    let same_hierarchy = HIERARCHY.iter().all(|field| edited.get(field) == compiled.get(field));
    // Half the edges of boxes of planes are 1e10 m, at which a rounding error is 2e-6 m.
    let same_boxes = |edited: &[f64], compiled: &[f64]| {
        let mut boxes = edited.chunks_exact(6).zip(compiled.chunks_exact(6));
        let size = |aabb: &[f64]| aabb.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
        boxes.all(|(edited, compiled)| {
            edited.iter().zip(compiled).all(|(left, right)| (left - right).abs() <= 1e-12 + 1e-15 * size(compiled))
        })
    };
    let differs = |(field, values): &(&&'static str, &Vec<f64>)| match **field {
        "bvh_aabb" => same_hierarchy && !same_boxes(values, &compiled["bvh_aabb"]),
        field => !is_kept(field) && compiled.get(field).is_some_and(|other| !is_equal(values, other)),
    };
    let describe = |(field, values): (&&str, &Vec<f64>)| {
        let pairs = values.iter().zip(&compiled[field]).enumerate();
        let differing: Vec<_> = pairs.filter(|(_, (left, right))| !is_close(**left, **right, 1e-9)).take(3).collect();
        format!("{field}: {differing:?}")
    };
    edited.iter().filter(differs).map(describe).collect()
}

/// A contact: the indices of its geoms, and their distance.
pub(super) type Pair = (Option<[usize; 2]>, f64);

/// Returns the contacts in the order in which the engine found them.
fn ordered_contacts(data: &Data) -> Vec<Pair> {
    data.contacts().map(|contact| (contact.geoms().map(|ids| ids.map(GeomId::index)), contact.dist())).collect()
}

/// Returns the contacts in the order of the geoms.
pub(super) fn contacts(data: &Data) -> Vec<Pair> {
    let mut contacts = ordered_contacts(data);
    contacts.sort_by(|left, right| left.partial_cmp(right).unwrap());
    contacts
}

/// Returns `true` if this contact is among them, up to rounding.
pub(super) fn contains(all: &[Pair], (pair, dist): &Pair) -> bool {
    all.iter().any(|(other, at)| other == pair && is_close(*at, *dist, 1e-9))
}

pub(super) fn is_close(left: f64, right: f64, tolerance: f64) -> bool {
    left.to_bits() == right.to_bits() || (left - right).abs() <= tolerance * left.abs().max(right.abs()).max(1e-3)
}

/// Results of a simulation.
pub(super) struct Run {
    contacts: Vec<Pair>,
    /// Geoms in the order in which the engine found their contacts.
    order: Vec<Option<[usize; 2]>>,
    numbers: Vec<f64>,
}

/// Simulates a few steps from a random state, whose velocities are multiplied by a number.
fn run(model: &Model, seed: u64, velocities: f64) -> Run {
    let mut data = Data::new(model.clone()).unwrap();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut contacts = Vec::new();
    let mut order = Vec::new();
    let mut numbers = Vec::new();
    for poses in 0..3 {
        data.reset().unwrap();
        data.qvel_mut().iter_mut().for_each(|value| *value = velocities * random.random_range(-0.5..0.5));
        data.ctrl_mut().iter_mut().for_each(|value| *value = random.random_range(-1.0..1.0));
        if poses > 0 {
            let (velocity, mut qpos) = (data.qvel().to_vec(), data.qpos().to_vec());
            data.model().integrate_pos(&mut qpos, &velocity, 1.0).unwrap();
            data.qpos_mut().copy_from_slice(&qpos);
        }
        let Ok(()) = data.forward() else { continue };
        contacts.extend(self::contacts(&data));
        order.extend(ordered_contacts(&data).into_iter().map(|(pair, _)| pair));
        numbers.extend(data.energy());
        numbers.extend_from_slice(data.qacc());
        for _ in 0..4 {
            if data.step().is_err() {
                break;
            }
            numbers.extend_from_slice(data.qpos());
        }
        numbers.extend_from_slice(data.sensordata());
    }
    Run { contacts, order, numbers }
}

/// A difference between simulations of an edited and a compiled model.
pub(super) enum Difference {
    /// In contacts or numbers.
    Values(String),
    /// In numbers that change as much, within a factor of 100, if the velocities change in the 13th
    /// digit, or if the constants of the compiled model are updated. The arrays that
    /// `update_constants` computes have rounding errors, which a solver that does not converge or a
    /// simulation that diverges magnifies.
    Rounding,
}

/// Returns the first difference between simulations of an edited and a compiled model.
pub(super) fn differing_runs(edited: &Model, compiled: &Model, seed: u64) -> Option<Difference> {
    let mut models = [edited, compiled].map(Model::clone);
    let mut runs = models.each_ref().map(|model| run(model, seed, 1.0));
    let pairs = |run: &Run| run.contacts.iter().map(|(pair, _)| *pair).collect::<Vec<_>>();
    if pairs(&runs[0]) != pairs(&runs[1]) {
        let what = format!("contacts {:?} instead of {:?}", pairs(&runs[0]), pairs(&runs[1]));
        return Some(Difference::Values(what));
    }
    let mut distances = runs[0].contacts.iter().zip(&runs[1].contacts);
    if let Some((left, right)) = distances.find(|(left, right)| !is_close(left.1, right.1, 1e-6)) {
        return Some(Difference::Values(format!("contact {left:?} instead of {right:?}")));
    }
    // An edited model keeps the order of its hierarchies. The result of a solver that does not
    // converge depends on the order of the contacts, which is that of the geoms without
    // hierarchies.
    if runs[0].order != runs[1].order {
        for model in &mut models {
            model.edit().edit_options(|options| options.disable |= DisableFlags::MIDPHASE).unwrap();
        }
        runs = models.each_ref().map(|model| run(model, seed, 1.0));
    }
    let [edited, compiled] = runs;
    let (at, what) = first_difference(&edited.numbers, &compiled.numbers)?;
    let change = |run: &Run| match (run.numbers.get(at), compiled.numbers.get(at)) {
        (Some(left), Some(right)) if !(left - right).is_nan() => (left - right).abs(),
        _ => f64::INFINITY,
    };
    let velocities = [-1e-12, -1e-13, 1e-13, 1e-12].map(|error| change(&run(&models[1], seed, 1.0 + error)));
    let mut updated = models[1].clone();
    let constants = updated.edit().update_constants().map_or(0.0, |()| change(&run(&updated, seed, 1.0)));
    let is_rounding = change(&edited) <= 100.0 * velocities.into_iter().fold(constants, f64::max);
    Some(if is_rounding { Difference::Rounding } else { Difference::Values(what) })
}

/// Returns the first index at which the results of two simulations differ, and a description.
fn first_difference(left: &[f64], right: &[f64]) -> Option<(usize, String)> {
    let mut numbers = left.iter().zip(right).enumerate();
    let different = numbers.find(|(_, (left, right))| !is_close(**left, **right, 1e-5));
    let different = different.map(|(at, (left, right))| (at, format!("number {at} is {left} instead of {right}")));
    let shorter = left.len().min(right.len());
    different.or((left.len() != right.len()).then(|| (shorter, "another number of steps".to_owned())))
}
