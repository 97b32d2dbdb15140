//! Numbers against independent sources: the engine called from C, the official Python bindings, and
//! published figures.

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/flags.rs"]
mod flags;
#[path = "../common/installed.rs"]
mod installed;
#[path = "../common/trouble.rs"]
mod trouble;
#[path = "../common/twins.rs"]
mod twins;

mod against_c;
mod against_python;
mod reference_numbers;
