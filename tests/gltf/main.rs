//! glTF files of trajectories, read back with the crate `gltf`: motion, shapes, looks and errors.
//! `scripts/try-html` also checks them with the validator of the Khronos Group, and in a browser.

#![cfg(feature = "gltf")]

mod errors;
mod file;
mod files_for_the_validator;
mod looks;
mod motion;
mod shapes;
mod sizes;
mod skins;
