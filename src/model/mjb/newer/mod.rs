//! Rules for values that newer engines add to binary models. The other modules of the validator
//! call them in their order.

mod bounding_volume;
mod feature;
mod history;
mod kinematic_tree;
mod mesh;
mod name_map;
mod sensor;
mod sparsity;

pub(super) use bounding_volume::check as check_bounding_volumes;
pub(super) use feature::check as check_features;
#[cfg(test)]
pub(super) use feature::is_absent;
pub(super) use history::check as check_histories;
pub(super) use kinematic_tree::{check as check_trees, check_simple, check_tendons as check_trees_of_tendons};
pub(super) use mesh::check as check_meshes;
pub(super) use name_map::check as check_name_map;
pub(super) use sensor::check as check_sensor;

#[cfg(test)]
pub(super) mod tests;
