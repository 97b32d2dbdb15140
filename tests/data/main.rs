//! Simulations: the pipeline, callbacks, errors, threads, and every kind of misuse.

#[path = "../common/arbitrary.rs"]
mod arbitrary;
#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/child.rs"]
mod child;
#[path = "../common/flags.rs"]
mod flags;
#[path = "../common/random_text.rs"]
mod random_text;
#[path = "../common/touch_all.rs"]
mod touch_all;
#[path = "../common/trouble.rs"]
mod trouble;

mod adopt;
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
