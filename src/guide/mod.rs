//! Guide: one page per theme. All programs on these pages run as tests, except those that need a
//! graphics driver or a display.
//!
//! | page | contents |
//! |---|---|
//! | [`concepts`] | model and data, the pipeline, states, results and their age, names and ids, matrices, errors |
//! | [`python`] | coming from the `mujoco` package for Python: a table of calls, and idioms |
//! | [`julia`] | coming from MuJoCo.jl |
//! | [`control`] | controllers, set-points, linearisation, LQR, iLQR, predictive control, recorded trajectories |
//! | [`pictures`] | images, depth, segmentation, animations, the viewer |
//! | [`logs`] | logs for Foxglove and Rerun |
//! | [`parallel`] | threads, rollouts, batches, determinism |
//! | [`performance`] | allocation, shared models, build profiles, builds of the engine, measurements |
//! | [`errors`] | kinds of errors and their remedies, poisoning, panics, limits of the guarantees |
//! | [`urdf`] | from URDF to a scene: files, warnings, free bases, motors, saving as MJCF |
//! | [`engines`] | versions of the engine, the search at build time, deployment, platforms |
//! | [`troubleshooting`] | symptoms, causes and remedies |
//!
//! Start with [`concepts`], or with [`python`] or [`julia`] if you know MuJoCo from these
//! languages. [`promises`] lists the guarantees with their tests, and [`coverage`] lists every
//! function, field and kind of the engine with its counterpart.
//!
//! # Recipes
//!
//! The [`cookbook`] has a page for each, and lists the examples.
//!
//! | subject | programs |
//! |---|---|
//! | models | [variations of a model](cookbook::variations), [a model that changes while it runs](cookbook::changing_model), [objects at random places](cookbook::random_places), [custom fields](cookbook::custom_fields) |
//! | robots | [inverse kinematics](cookbook::inverse_kinematics), [gravity compensation](cookbook::gravity_compensation), [task-space control](cookbook::task_space), [a gripper](cookbook::gripper), [forces of contacts](cookbook::forces), [lidar](cookbook::lidar), [sensors](cookbook::sensors), [state estimation](cookbook::state_estimation) |
//! | running | [real time](cookbook::real_time), [saving a state](cookbook::saved_state), [threads](cookbook::threads), [domain randomisation](cookbook::domain_randomisation), [identification](cookbook::identification), [derivatives by parameters](cookbook::parameter_derivatives), [tests in continuous integration](cookbook::testing), [repeating a failure](cookbook::failures), [upgrading the engine](cookbook::upgrades) |
//! | results | [CSV, NumPy, MCAP and logging](cookbook::logging), [plots](cookbook::plots), [images without a display](cookbook::headless_rendering), [video](cookbook::video), [web pages](cookbook::web_page), [a running simulation in a browser](cookbook::live_page), [Blender](cookbook::blender) |

pub mod concepts;
pub mod control;
pub mod cookbook;
pub mod coverage;
pub mod engines;
pub mod errors;
#[doc(alias = "MuJoCo.jl")]
pub mod julia;
#[doc(alias("mcap", "foxglove", "rerun"))]
pub mod logs;
pub mod parallel;
pub mod performance;
pub mod pictures;
pub mod promises;
pub mod python;
pub mod troubleshooting;
pub mod urdf;
