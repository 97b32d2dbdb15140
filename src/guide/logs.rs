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
//! # Images
//!
//! With the feature `renderer` besides, a log has images of cameras. `write_camera` writes the pose
//! and the focal length, by which other programs place the image in the scene:
//!
#![cfg_attr(all(feature = "mcap", feature = "renderer"), doc = "```no_run")]
#![cfg_attr(not(all(feature = "mcap", feature = "renderer")), doc = "```ignore")]
//! use mujoco_safe::mcap::Log;
//! use mujoco_safe::render::{LogImage, Renderer};
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut renderer = Renderer::new(data.model(), 320, 240)?;
//! let mut log = Log::create("fall.mcap", data.model())?;
//! for step in 0..200 {
//!     if step % 8 == 0 {
//!         data.forward()?;
//!         let mut snapshot = renderer.snapshot(&mut data, "side")?;
//!         let (images, camera) = (snapshot.images()?, snapshot.pinhole_camera()?);
//!         log.write_camera("side", data.time(), &camera)?;
//!         log.write_image("side", data.time(), LogImage::Png(&images.rgb))?;
//!         log.write_image("side", data.time(), &images.depth)?;
//!     }
//!     log.step(&mut data)?;
//! }
//! log.finish()?;
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! # Foxglove
//!
//! The fields of all messages are those of Foxglove's package for Python (`foxglove-sdk` 0.30.3).
//! The following steps are taken from the documentation of the application.
//!
//! Choose *Open local file…*, and the file. Add these panels by *Add panel*; their settings are in
//! the sidebar:
//!
//! - *3D*: under *Topics* make `/scene` visible, and `/scene/deformable` for skins and flexes;
//!   under *Frame* select `world` as the *Display frame*. The shapes follow the frames of `/tf`. An
//!   image such as `/camera/side/png` is in front of its camera if `/camera/side/calibration` is
//!   visible, too.
//! - *Image*: select `/camera/side/png` as the *Topic* and `/camera/side/calibration` as the
//!   *Calibration*; if `/scene` is visible, its shapes are drawn over the image.
//!   `/camera/side/depth` has distances in metres, for which a *Color mode* with limits can be set.
//! - *Plot*: a series has a path of a message. `/state.qpos[2]` is the height of the humanoid,
//!   `/sensors.torso_gyro[0]` a reading, `/joints.joints[:]{name=="left_knee"}.position` a joint.
//! - *Raw Messages*: `/contacts`, the geoms and forces.
//!
//! # Rerun
//!
//! `pip install rerun-sdk` (tried with 0.41.0), then `rerun fall.mcap` opens the file. It shows
//! each image in a 2D view, and in a 3D view in front of its camera. It has no message for shapes
//! ([list](https://rerun.io/docs/reference/mcap/message-formats)), so `/scene` is not drawn. Frames
//! and plots need a layout, in Python:
//!
//! ```python
//! import rerun as rr
//! import rerun.blueprint as rrb
//! from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping
//!
//! def plot(topic, schema, *fields):
//!     def line(field):
//!         source = dict(source_component=f"{schema}:message", selector=field)
//!         kind = ComponentSourceKind.SourceComponent
//!         mapping = VisualizerComponentMapping("Scalars:scalars", kind, **source)
//!         return rr.SeriesLines(names=field).visualizer(mappings=[mapping])
//!     lines = [line(field) for field in fields]
//!     return rrb.TimeSeriesView(origin=topic, overrides={topic: lines})
//!
//! frames = rrb.Spatial3DView(
//!     spatial_information=rrb.SpatialInformation(target_frame="world"),
//!     overrides={"/tf": [rr.TransformAxes3D(0.2)]},
//! )
//! layout = rrb.Grid(
//!     frames,
//!     rrb.Spatial2DView(origin="/camera/side/png"),
//!     plot("/state", "mujoco.State", ".qpos[2]", ".qvel[2]"),
//!     plot("/sensors", "mujoco.Sensors", ".torso_gyro[0]"),
//! )
//! rr.init("fall", spawn=True)
//! rr.send_blueprint(rrb.Blueprint(layout))
//! rr.log_file_from_path("fall.mcap")
//! ```
//!
//! # LeRobot
//!
//! `examples/lerobot` writes episodes of a simulation as a dataset of [LeRobot], in its format
//! v3.0: Parquet files by the crate `parquet`, a video for each episode, and the metadata with the
//! statistics by which a policy normalises its inputs. It is a package of its own, because of the
//! many dependencies of `parquet`:
//!
//! ```text
//! cargo run --release --manifest-path examples/lerobot/Cargo.toml -- squats 3
//! ```
//!
//! `scripts/lerobot` loads the dataset with LeRobot's own package (tried with 0.6.1): rows, images,
//! statistics and batches for the training of a policy.
//!
//! [LeRobot]: https://github.com/huggingface/lerobot
