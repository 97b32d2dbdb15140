//! Results of operations that two libraries perform.

#![allow(clippy::disallowed_methods, reason = "the engine's arrays are read without the library")]

use std::collections::BTreeMap;

use mujoco_safe::{Error, Model, Result};

use super::engine_spec::RawModel;

/// Results of operations.
#[derive(Default)]
pub(super) struct Counts {
    pub(super) operations: usize,
    /// Operations that both libraries perform with equal results.
    pub(super) same: usize,
    /// Messages of operations that this library does not perform.
    refused: BTreeMap<String, usize>,
    /// Messages of operations that only this library performs.
    pub(super) only_ours: BTreeMap<String, usize>,
    pub(super) differ: Vec<String>,
    /// Messages of the compiler about elements that refer to one that `mjs_delete` has removed.
    pub(super) dangling: BTreeMap<String, usize>,
}

impl Counts {
    pub(super) fn compare(
        &mut self,
        what: &str,
        ours: Result<Model>,
        theirs: &RawModel,
        tolerance: f64,
        except: &[&str],
    ) {
        self.operations += 1;
        let ours = match ours {
            Ok(model) => model,
            Err(error) => return self.refuse(what, &error),
        };
        let mut found = theirs.differences(&ours, tolerance, except);
        if tolerance > 0.0 {
            // The principal axes of equal inertias, and the inverse of a singular inertia, are
            // those of rounding errors. Older engines divide by 0.
            let is_singular = ours.dof_invweight0().iter().any(|weight| weight.is_nan() || weight.abs() > 1e8)
                || found.iter().any(|field| field.contains("NaN"));
            let arbitrary: &[&str] = if is_singular { &ROUNDED } else { &ROUNDED[..2] };
            let is_of =
                |field: &String, names: &[&str]| names.iter().any(|name| field.starts_with(&format!("{name}[")));
            found.retain(|field| !is_of(field, arbitrary));
            // Rounding decides the order of boxes in a hierarchy whose centres are equal in one
            // direction.
            if found.iter().all(|field| is_of(field, &HIERARCHY))
                && found.iter().any(|field| is_of(field, &HIERARCHY[..2]))
            {
                found.clear();
            }
        }
        if found.is_empty() {
            self.same += 1;
        } else {
            let found: Vec<String> = found.into_iter().take(6).collect();
            self.differ.push(format!("{found:?} {what}"));
        }
    }

    /// Counts an error by the words of its message that are not names.
    pub(super) fn refuse(&mut self, what: &str, error: &Error) {
        let message: String = error.to_string().split('\'').step_by(2).collect::<Vec<_>>().join("…");
        let message: String = message.chars().filter(|character| !character.is_ascii_digit()).take(150).collect();
        let known = self.refused.entry(message).or_default();
        *known += 1;
        if *known == 1 {
            println!("refused: {error} ({})", what.chars().take(100).collect::<String>());
        }
    }

    /// Prints the results, and panics if some differ, or if an operation that only the engine
    /// performs has another reason than the known ones.
    pub(super) fn finish(&self, models: usize) {
        println!(
            "{models} models, {} operations: {} equal, {} differ, {} refused, {} performed here only",
            self.operations,
            self.same,
            self.differ.len(),
            self.refused.values().sum::<usize>(),
            self.only_ours.values().sum::<usize>()
        );
        println!(
            "refused: {:#?}\nonly here: {:#?}\nreferences to removed elements: {:#?}",
            self.refused, self.only_ours, self.dangling
        );
        let length = if std::env::var_os("VERBOSE").is_some() { 5000 } else { 300 };
        for difference in &self.differ {
            println!("DIFFERS {}", difference.chars().take(length).collect::<String>());
        }
        assert!(self.differ.is_empty(), "{} differences", self.differ.len());
        let is_known = |message: &str| REFUSED.iter().any(|known| message.contains(known));
        let others: Vec<_> = self.refused.keys().filter(|message| !is_known(message)).collect();
        assert!(others.is_empty(), "refused for other reasons: {others:#?}");
    }
}

/// Parts of the messages of operations that this library does not perform.
const REFUSED: [&str; 7] = [
    // A rule of the engine's compiler, for a model in a body.
    "free joint can only be used on top level",
    // Files of skins contain the names of bodies, which the engine has read before the operation.
    "in skin",
    "in the file of skin",
    // A class can be used by elements whose angles have another order or unit.
    "a spec with Euler angles in a class of",
    // Elements of the world have no body that carries the pose.
    "at a pose; put it into a body of its spec",
    // Ranges that only the compiler knows: those of joints, by `inheritrange`.
    "set the autolimits=",
    // A setting of a model as a whole.
    "of <compiler> in the attached spec is",
];

const ROUNDED: [&str; 6] =
    ["body_iquat", "body_sameframe", "dof_invweight0", "body_invweight0", "tendon_invweight0", "actuator_acc0"];

const HIERARCHY: [&str; 4] = ["bvh_nodeid", "bvh_child", "bvh_depth", "bvh_aabb"];
