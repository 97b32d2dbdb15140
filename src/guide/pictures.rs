//! Images and the viewer: colour, depth, segmentation, animations, windows.
//!
//! The feature `renderer` adds rendering without a window or a display, the feature `viewer` also
//! the window. Both need a Vulkan, Metal, Direct3D 12 or OpenGL driver; a software driver suffices.
//! The first build takes some minutes. See
//! [troubleshooting](super::troubleshooting#rendering-and-the-viewer).
//!
//! # From a simulation to an image
//!
//! [`Data::forward`] computes the poses. A [`Renderer`][renderer] takes a snapshot of the
//! simulation from a camera: a name, an index, an id, or a `&mut` [`Camera`]. One snapshot gives an
//! [`RgbImage`][rgb-image], a [`DepthImage`][depth-image] and a
//! [`SegmentationImage`][segmentation-image] of the same moment.
//!
#![cfg_attr(feature = "renderer", doc = "```no_run")]
#![cfg_attr(not(feature = "renderer"), doc = "```ignore")]
//! use mujoco_safe::render::Renderer;
//! use mujoco_safe::scene::Camera;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.reset_to_key("squat")?;
//! data.forward()?;
//! let mut renderer = Renderer::new(data.model(), 640, 480)?; // width, height
//! renderer.snapshot(&mut data, "side")?.rgb()?.save_png("side.png")?;
//!
//! let mut camera = Camera { azimuth: 120.0, elevation: -15.0, ..Camera::free(data.model()) };
//! let mut snapshot = renderer.snapshot(&mut data, &mut camera)?;
//! snapshot.depth()?.save_png("depth.png")?; // 16 bits, millimetres
//! for (segment, pixels) in snapshot.segmentation()?.segments() {
//!     println!("{:?}: {pixels} pixels", segment.object);
//! }
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! `images` returns all three images for little more than the cost of the colours. Keep the
//! renderer for further images: the first image compiles shaders and uploads textures. `rgb_into`,
//! `depth_into`, `segmentation_into` and `images_into` write to existing images. A program that
//! restricts [categories](crate::scene::Categories), shows a perturbation or draws several
//! simulations in one image updates a [`Scene`] itself and passes it to the renderer.
//!
//! # Cameras
//!
//! | camera | view |
//! |---|---|
//! | [`Camera::free(&model)`](Camera::free) | the complete model; `lookat`, `distance`, `azimuth` and `elevation` can be changed |
//! | [`Camera::tracking(&model, "torso")?`](Camera::tracking) | follows a body |
//! | [`Camera::fixed(&model, "eye")?`](Camera::fixed) | a camera that the model defines |
//! | [`Scene::set_viewpoints`] | any pose and frustum |
//!
//! # Contents of a scene
//!
//! - [`SceneOptions`]: geom groups, labels, frames, and [`VisualFlags`](crate::scene::VisualFlags)
//!   such as contact forces, joints and centres of mass.
//! - [`Categories`](crate::scene::Categories): static geoms, moving geoms, decoration.
//! - [`RenderFlags`](crate::scene::RenderFlags): shadows, reflections, fog, wireframe
//!   ([`Scene::set_render_flags`]).
//! - [`NewGeom`](crate::scene::NewGeom): additional shapes, arrows and labels, which
//!   [`Scene::add_geom`] appends after each update.
//! - [`Visual`](crate::model::Visual) of the model: light of the camera, image size, shadow
//!   resolution, colours. [`ModelMut::edit_visual`](crate::ModelMut::edit_visual) edits it before
//!   the renderer is created.
//!
//! ```
//! use mujoco_safe::scene::{Camera, Categories, Connector, NewGeom, SceneOptions, VisualFlags};
//! use mujoco_safe::{Data, Scene, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.reset_to_key("stand")?;
//! data.forward()?;
//! let mut options = SceneOptions::default();
//! options.flags |= VisualFlags::CONTACTFORCE | VisualFlags::COM;
//! options.geomgroup[2] = false; // hides the geoms of group 2
//! let (mut scene, mut camera) = (Scene::new(data.model(), 1000)?, Camera::free(data.model()));
//! scene.update(&mut data, &options, None, &mut camera, Categories::all())?;
//! let arrow = NewGeom::connector(Connector::Arrow, 0.02, [0.0, 0.0, 1.0], [0.5, 0.0, 1.0]);
//! scene.add_geom(&arrow.with_rgba([1.0, 0.0, 0.0, 1.0]).with_label("goal")?)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Points from a depth image
//!
//! The depth is measured along the optical axis, in metres. The snapshot has the focal lengths, the
//! principal point and the pose of its camera, so a depth image becomes a point cloud in the world
//! frame:
//!
#![cfg_attr(feature = "renderer", doc = "```no_run")]
#![cfg_attr(not(feature = "renderer"), doc = "```ignore")]
//! use mujoco_safe::render::Renderer;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! data.forward()?;
//! let mut renderer = Renderer::new(data.model(), 640, 480)?;
//! let mut snapshot = renderer.snapshot(&mut data, "fixed")?;
//! let (colours, depth, camera) = (snapshot.rgb()?, snapshot.depth()?, snapshot.pinhole_camera()?);
//! for ([x, y], point) in depth.points(&camera) {
//!     println!("{point:?} {:?}", colours.pixel(x, y));
//! }
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! [`PinholeCamera`](crate::scene::PinholeCamera) documents the formulas, and also converts single
//! pixels and points.
//!
//! # Animations
//!
//! A [`Recorder`][recorder] selects frames by simulated time. The extension of the path selects the
//! format: GIF, animated PNG, numbered PNG files, or video through the program `ffmpeg`.
//!
#![cfg_attr(feature = "renderer", doc = "```no_run")]
#![cfg_attr(not(feature = "renderer"), doc = "```ignore")]
//! use mujoco_safe::record::{Recorder, RecorderOptions};
//! use mujoco_safe::render::{Renderer, RgbImage};
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut renderer = Renderer::new(data.model(), 480, 360)?;
//! let mut image = RgbImage::default();
//! let mut recorder = Recorder::create("fall.gif", RecorderOptions::default().with_frames_per_second(25.0))?;
//! while data.time() < 2.0 {
//!     if recorder.is_due(data.time()) {
//!         data.forward()?; // the poses of the present state
//!         renderer.snapshot(&mut data, "side")?.rgb_into(&mut image)?;
//!         recorder.push(&image, data.time())?;
//!     }
//!     data.step()?;
//! }
//! println!("{} frames", recorder.finish()?.frames);
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! # The viewer
//!
//! | function | steps the simulation | shows the window |
//! |---|---|---|
//! | [`Viewer::run`][viewer] | the viewer, under a controller or by playing trajectories | the calling thread |
//! | [`viewer::run`][run] | the program, in a new thread | the calling thread |
//! | [`viewer::launch`][launch] | the program, in the calling thread | a background thread; not on macOS |
//!
//! F1 lists all keys and mouse gestures. They are the same as in the engine's `simulate`. A
//! double-click selects a body, Ctrl with the right button pulls it, Tab and Shift+Tab open the
//! side panels, and Ctrl+Q closes the window (Esc selects the free camera).
//!
#![cfg_attr(feature = "viewer", doc = "```no_run")]
#![cfg_attr(not(feature = "viewer"), doc = "```ignore")]
//! use std::time::Duration;
//! use mujoco_safe::scene::NewGeom;
//! use mujoco_safe::viewer::{self, Viewer, ViewerError, ViewerOptions};
//! use mujoco_safe::{Data, RandomController, sample};
//!
//! // The viewer steps. It returns the simulation in its final state.
//! let mut data = Viewer::new().with_controller(RandomController::new(1)).run(Data::new(sample::humanoid())?)?;
//!
//! // The program steps, and shows a goal.
//! data.reset()?;
//! viewer::run(ViewerOptions::default().with_title("goal"), |handle| -> Result<(), ViewerError> {
//!     handle.geoms_mut().push(NewGeom::sphere(0.05).with_pos([1.0, 0.0, 0.5]));
//!     while handle.is_running() {
//!         if handle.is_paused() {
//!             handle.wait(Duration::from_millis(20));
//!         } else {
//!             data.step()?;
//!         }
//!         handle.sync(&mut data)?; // shows the state, and applies the user's pulls and edits
//!     }
//!     Ok(())
//! })?;
//! # Ok::<(), ViewerError>(())
//! ```
//!
//! The loop above runs as fast as it can. To follow real time, give each step a
//! [deadline](super::cookbook::real_time).
//!
//! [`Viewer::with_instrumented_controller`][instrumented] shows the [`Instruments`][instruments] of
//! a controller: plots of its values, sliders for its parameters, and paths or other geoms in the
//! scene. [`ViewerHandle::instruments`][handle_instruments] does so for a program. See
//! [control](super::control#predictive-control-in-the-viewer).
//!
#![cfg_attr(feature = "viewer", doc = include_str!("links/with_viewer.md"))]
#![cfg_attr(not(feature = "viewer"), doc = include_str!("links/without_viewer.md"))]

#[cfg(doc)]
use crate::{
    Data, Scene,
    scene::{Camera, SceneOptions},
};
