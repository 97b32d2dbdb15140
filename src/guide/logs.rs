//! Logs of simulations for Foxglove and Rerun.
//!
//! With the feature `mcap`, a `Log` writes a simulation while it runs:
//!
#![cfg_attr(feature = "mcap", doc = "```")]
#![cfg_attr(not(feature = "mcap"), doc = "```ignore")]
//! use mujoco_safe::mcap::Log;
//! use mujoco_safe::{Controller, Data, PdController, Trajectory, sample};
//!
//! let path = std::env::temp_dir().join("mujoco_safe_squat.mcap");
//! let mut data = Data::new(sample::humanoid())?;
//! data.reset_to_key("squat")?;
//! let mut controller = PdController::new(data.model(), 1.0, 0.1);
//! controller.hold(&mut data)?;
//!
//! let mut log = Log::create(&path, data.model())?;
//! for _ in 0..100 {
//!     controller.control(&mut data)?;
//!     log.step(&mut data)?; // in place of data.step()
//! }
//! log.finish()?;
//!
//! // The states, bit for bit, also from a log of a failed run.
//! let trajectory = Trajectory::load_mcap(data.model(), &path)?;
//! assert_eq!(trajectory.len(), 100);
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A [`Trajectory`](crate::Trajectory) that has been recorded before becomes such a file by
//! `trajectory.save_mcap(&model, "squat.mcap")?`. `log.write(&data)?` writes a state without a
//! step, for example in a controller, or the poses of an inverse kinematics after
//! [`Data::forward`](crate::Data::forward).
//!
//! The module `mcap` lists the topics. The file contains the schemas of all messages, so other
//! programs need nothing of this crate. In Python:
//!
//! ```python
//! from mcap.reader import make_reader                      # pip install mcap-protobuf-support
//! from mcap_protobuf.decoder import DecoderFactory
//!
//! with open("squat.mcap", "rb") as file:
//!     reader = make_reader(file, decoder_factories=[DecoderFactory()])
//!     for schema, channel, message, state in reader.iter_decoded_messages(topics=["/state"]):
//!         print(state.time, state.qpos[2])
//! ```
//!
//! # Foxglove
//!
//! Open the file by *Open local file*. Add these panels:
//!
//! - *3D*: select the topic `/scene` in its settings, and `world` as the display frame. The shapes
//!   follow the frames of `/tf`.
//! - *Plot*: a series has a path of a message. `/state.qpos[2]` is the height of the humanoid,
//!   `/sensors.torso_gyro[0]` a reading, `/joints.joints[:]{name=="left_knee"}.position` a joint.
//! - *Raw Messages*: `/contacts`, the geoms and forces.
//!
//! # Rerun
//!
//! `rerun squat.mcap` opens the file. It shows the frames of `/tf` in a 3D view, and plots the
//! numbers of all messages. Its [list of messages] has no `SceneUpdate`, so it does not show the
//! shapes.
//!
//! [list of messages]: https://rerun.io/docs/reference/mcap/message-formats
