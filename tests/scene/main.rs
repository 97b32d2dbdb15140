//! Abstract scenes: each call is compared bit for bit with the same call in C.

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/installed.rs"]
mod installed;
#[path = "../common/scene_options.rs"]
mod scene_options;
#[path = "../common/twins.rs"]
#[allow(dead_code, reason = "the program `engine` uses the rest")]
mod twins;

mod boundary;
mod camera;
mod extreme_numbers;
mod geoms;
mod labels;
mod perturbation;
mod raw;
mod select;
