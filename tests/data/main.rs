//! Simulations: the pipeline, callbacks, errors, threads, and every kind of misuse.

#[path = "../common/arbitrary.rs"]
mod arbitrary;
#[path = "../common/child.rs"]
mod child;
#[path = "../common/flags.rs"]
mod flags;
#[path = "../common/touch_all.rs"]
mod touch_all;
#[path = "../common/trouble.rs"]
mod trouble;

mod boundary;
mod callbacks;
mod contact_filter;
mod errors;
mod extreme_numbers;
mod function_arguments;
mod geometry;
mod misuse;
mod persistent_callbacks;
mod pipeline;
mod shared_model;
mod soundness;
mod state;
mod threads;

use std::path::Path;

use mujoco_safe::model::{SaveXmlOptions, XmlCheck};
use mujoco_safe::{Model, Result};

/// Saves a model as XML, with the check of the text if the engine under test has it: the check compares the arrays of 2.2.2.
fn save_xml(model: &Model, path: impl AsRef<Path>) -> Result<()> {
    let check = if cfg!(engine_since = "2.3.0") { XmlCheck::Skip } else { XmlCheck::Require };
    model.save_xml_with(path, &SaveXmlOptions::default().with_check(check)).map(drop)
}
