//! Results of comparisons between edited and compiled models.

use std::collections::BTreeMap;

use mujoco_safe::id::GeomId;
use mujoco_safe::{Data, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub(super) enum Outcome {
    /// The models are equal after edits of these fields.
    Equal(Vec<&'static str>),
    /// The compiled model differs in fields that edits cannot set. The first list has those that they can set.
    Structure(Vec<&'static str>, Vec<&'static str>),
    /// The call of `update_constants` returned an error.
    Rejected(Vec<&'static str>, String),
    /// The models differ after edits of these fields.
    Differs(Vec<&'static str>, String),
}

/// Fields that differ without a difference in any result: flags by which the engine skips computations, which edits clear, and hierarchies
/// of boxes, in which an edited model keeps the order of the geoms.
pub(super) const WITHOUT_EFFECT: [&str; 15] = [
    "body_sameframe",
    "geom_sameframe",
    "site_sameframe",
    "body_simple",
    "dof_simplenum",
    "nbuffer",
    "nbvh",
    "nbvhstatic",
    "bvh_nodeid",
    "bvh_child",
    "bvh_depth",
    "body_bvhadr",
    "body_bvhnum",
    "mesh_graphadr",
    "mesh_bvhadr",
];

/// Returns the fields that differ, with their values.
pub(super) fn differing_arrays(
    edited: &BTreeMap<&'static str, Vec<f64>>,
    compiled: &BTreeMap<&'static str, Vec<f64>>,
) -> Vec<String> {
    let is_equal = |left: &[f64], right: &[f64]| {
        left.len() == right.len() && left.iter().zip(right).all(|(left, right)| is_close(*left, *right, 1e-9))
    };
    // If the compiler makes the same hierarchy, its boxes are the same. Boxes of planes are so large that rounding moves them.
    let same_hierarchy =
        ["bvh_nodeid", "bvh_child", "body_bvhadr"].iter().all(|field| edited.get(field) == compiled.get(field));
    let same_boxes = |edited: &[f64], compiled: &[f64]| {
        let mut boxes = edited.chunks_exact(6).zip(compiled.chunks_exact(6));
        let size = |aabb: &[f64]| aabb.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
        boxes.all(|(edited, compiled)| {
            edited.iter().zip(compiled).all(|(left, right)| (left - right).abs() <= 1e-9 * size(compiled))
        })
    };
    let differs = |(field, values): &(&&'static str, &Vec<f64>)| match **field {
        "bvh_aabb" => same_hierarchy && !same_boxes(values, &compiled["bvh_aabb"]),
        field => !WITHOUT_EFFECT.contains(&field) && compiled.get(field).is_some_and(|other| !is_equal(values, other)),
    };
    let fields = edited.iter().filter(differs);
    fields.map(|(field, values)| format!("{field}: {values:?} instead of {:?}", compiled[field])).collect()
}

/// Returns the pairs of geoms in contact, with their distances, in the order in which the engine found them.
fn ordered_contacts(data: &Data) -> Vec<(String, f64)> {
    let pair = |ids: Option<[GeomId; 2]>| format!("{:?}", ids.map(|ids| ids.map(|id| id.index())));
    data.contacts().map(|contact| (pair(contact.geoms()), contact.dist())).collect()
}

/// Returns the pairs of geoms in contact, with their distances.
pub(super) fn contacts(data: &Data) -> Vec<(String, f64)> {
    let mut contacts = ordered_contacts(data);
    contacts.sort_by(|left, right| left.partial_cmp(right).unwrap());
    contacts
}

/// Returns `true` if each of the second contacts is among the first ones, up to rounding.
pub(super) fn contains(all: &[(String, f64)], some: &[(String, f64)]) -> bool {
    some.iter().all(|(pair, dist)| all.iter().any(|(other, at)| other == pair && is_close(*at, *dist, 1e-9)))
}

pub(super) fn is_close(left: f64, right: f64, tolerance: f64) -> bool {
    left.to_bits() == right.to_bits() || (left - right).abs() <= tolerance * left.abs().max(right.abs()).max(1e-3)
}

/// Results of a simulation.
pub(super) struct Run {
    contacts: Vec<(String, f64)>,
    /// Pairs in the order in which the engine found them.
    order: Vec<String>,
    /// The solver of constraints ended before its last iteration in all steps.
    is_converged: bool,
    numbers: Vec<f64>,
}

/// Simulates a few steps from a random state.
pub(super) fn run(model: Model, seed: u64) -> Run {
    let mut data = Data::new(model).unwrap();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut contacts = Vec::new();
    let mut order = Vec::new();
    let mut numbers = Vec::new();
    let mut is_converged = true;
    for poses in 0..3 {
        data.reset().unwrap();
        data.qvel_mut().iter_mut().for_each(|value| *value = random.random_range(-0.5..0.5));
        data.ctrl_mut().iter_mut().for_each(|value| *value = random.random_range(-1.0..1.0));
        if poses > 0 {
            let (velocity, mut qpos) = (data.qvel().to_vec(), data.qpos().to_vec());
            data.model().integrate_pos(&mut qpos, &velocity, 1.0).unwrap();
            data.qpos_mut().copy_from_slice(&qpos);
        }
        let Ok(()) = data.forward() else { continue };
        contacts.extend(self::contacts(&data));
        order.extend(ordered_contacts(&data).into_iter().map(|(pair, _)| pair));
        let most = data.model().options().iterations;
        is_converged &= data.solver().len() < most;
        numbers.extend(data.energy());
        numbers.extend_from_slice(data.qacc());
        for _ in 0..4 {
            if data.step().is_err() {
                break;
            }
            is_converged &= data.solver().len() < most;
            numbers.extend_from_slice(data.qpos());
        }
        numbers.extend_from_slice(data.sensordata());
    }
    Run { contacts, order, is_converged, numbers }
}

/// Returns the first difference of two simulations.
pub(super) fn differing_runs(edited: &Run, compiled: &Run) -> Option<String> {
    let pairs = |run: &Run| run.contacts.iter().map(|(pair, _)| pair.clone()).collect::<Vec<_>>();
    if pairs(edited) != pairs(compiled) {
        return Some(format!("contacts {:?} instead of {:?}", pairs(edited), pairs(compiled)));
    }
    let distances = edited.contacts.iter().zip(&compiled.contacts);
    if let Some((left, right)) = distances.into_iter().find(|(left, right)| !is_close(left.1, right.1, 1e-6)) {
        return Some(format!("contact {left:?} instead of {right:?}"));
    }
    // The result of a solver that does not converge depends on the order of the constraints, and an edited model keeps its hierarchies.
    if edited.order != compiled.order && !(edited.is_converged && compiled.is_converged) {
        return None;
    }
    let mut numbers = edited.numbers.iter().zip(&compiled.numbers).enumerate();
    if edited.numbers.len() != compiled.numbers.len() {
        return Some("another number of steps".to_owned());
    }
    let different = numbers.find(|(_, (left, right))| !is_close(**left, **right, 1e-5));
    different.map(|(at, (left, right))| format!("number {at} is {left} instead of {right}"))
}
