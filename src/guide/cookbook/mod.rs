//! Complete programs for common tasks, one page each, and the examples.
//!
//! The programs run as tests, except those that draw. A page names the crates that its program
//! needs beside this library. The [first page of the guide](crate::guide#recipes) lists the pages
//! by subject.
//!
//! # Examples
//!
//! The folder `examples/` of the repository has larger programs. `cargo run --release --example
//! NAME` runs one:
//!
//! | name | contents |
//! |---|---|
//! | `getting_started` | load, inspect, random control, reset, record |
//! | `contacts`, `tippe_top`, `pendulum_chaos` | the tutorials of the Python bindings |
//! | `cartpole_lqr -- --angle 0.3` | linearise, solve, balance |
//! | `humanoid_lqr -- --help` | balance a humanoid on one leg, step by step |
//! | `state_estimation` | the pose of a trotting quadruped from its IMU and joint encoders |
//! | `rollouts` | 256 pushes of a balanced pole, on all cores |
//! | `cartpole_swing_up` | iLQR within the motor's range, tracked by a table of gains |
//! | `humanoid_predictive` | predictive sampling recovers from pushes under which the LQR falls |
//! | `humanoid_stand_up`, `arm_tracking` | predictive control: from a squat to standing; an arm follows a target |
//! | `find_load` | the load of an arm is identified from a log, and compensated |
//! | `replay -- repeat FILE` | repeats and searches files of the flight recorder; compares two engines |
//! | `arm_obstacles` | inverse kinematics: an arm follows a target between two pillars |
//! | `retarget` | inverse kinematics: a person's motion is transferred to the humanoid |
//! | `learn_gait` | a half cheetah learns to run in minutes, by random search |
//!
//! With `--features renderer`:
//!
//! | name | contents |
//! |---|---|
//! | `assemble -- --out out` | a model in code: two arms on a table |
//! | `pick_and_place` | a scene that changes while it runs: grasp, adopt an edited model |
//! | `camera_sensor` | a rover steers by its depth camera |
//! | `record` | a humanoid is pushed and recovers, as a GIF |
//! | `trajectories` | several trajectories in one image |
//!
//! With `--features html`:
//!
//! | name | contents |
//! |---|---|
//! | `web_replay -- --model model.xml` | a motion as a page that a browser plays |
//!
//! With `--features live`:
//!
//! | name | contents |
//! |---|---|
//! | `live -- --address 127.0.0.1:8000` | a balancing humanoid in a browser, to be pulled |
//!
//! With `--features viewer`:
//!
//! | name | contents |
//! |---|---|
//! | `view -- model.xml` | any model in the viewer |
//! | `humanoid_predictive -- --view` | pull a humanoid, watch its plan, change the weights |

#[doc(alias("export", "gltf", "glb", "three.js", "unity", "godot", "3d model"))]
pub mod blender;
pub mod changing_model;
pub mod custom_fields;
#[doc(alias("domain randomisation", "domain randomization", "domain_randomization"))]
pub mod domain_randomisation;
#[doc(alias("flight recorder", "reproduce", "bug report", "crash"))]
pub mod failures;
#[doc(alias("contact forces", "apply force", "push"))]
pub mod forces;
#[doc(alias("gravity compensation", "gravcomp"))]
pub mod gravity_compensation;
#[doc(alias("grasp", "mocap"))]
pub mod gripper;
#[doc(alias(
    "headless",
    "headless render",
    "headless rendering",
    "offscreen",
    "offscreen rendering",
    "egl",
    "osmesa",
    "screenshot"
))]
pub mod headless_rendering;
#[doc(alias("system identification", "sysid", "parameter estimation", "least_squares"))]
pub mod identification;
#[doc(alias("inverse kinematics", "ik", "mink"))]
pub mod inverse_kinematics;
#[doc(alias("laser scanner"))]
pub mod lidar;
#[doc(alias("live", "websocket", "remote", "ssh", "interactive"))]
pub mod live_page;
#[doc(alias("csv", "logger", "mcap", "save data", "save results"))]
pub mod logging;
#[doc(alias("regressor", "sensitivity", "differentiable simulation", "adjoint", "backpropagation", "gradient"))]
pub mod parameter_derivatives;
#[doc(alias("plot", "plotting", "plotters", "matplotlib", "chart"))]
pub mod plots;
#[doc(alias("randomise", "randomize", "placement"))]
pub mod random_places;
#[doc(alias("real time", "real-time", "realtime", "wall clock"))]
pub mod real_time;
#[doc(alias("save state", "restore state", "checkpoint"))]
pub mod saved_state;
pub mod sensors;
#[doc(alias("kalman", "ekf", "imu", "odometry", "observer"))]
pub mod state_estimation;
#[doc(alias("operational space", "task space", "osc", "impedance"))]
pub mod task_space;
#[doc(alias("ci", "continuous integration", "unit test", "github actions"))]
pub mod testing;
#[doc(alias("multithreading", "thread"))]
pub mod threads;
#[doc(alias("upgrade", "regression", "new version", "migration"))]
pub mod upgrades;
pub mod variations;
#[doc(alias("save video", "mp4", "movie", "animation", "film"))]
pub mod video;
#[doc(alias("web", "browser", "html", "web viewer", "share"))]
pub mod web_page;
