//! Troubleshooting: symptoms, causes and remedies.
//!
//! # Build and start
//!
//! | symptom | cause | remedy |
//! |---|---|---|
//! | `The MuJoCo physics engine was not found.` | no engine in the searched directories, which the message lists | `apt-get install libmujoco-dev`, or set `MUJOCO_DIR`: see [`engines`](super::engines) |
//! | `Its headers differ from those of all versions with committed bindings` | an engine of another version, with other structs or functions | set `MUJOCO_DIR` to an engine of a [listed](super::engines) version, or enable the feature `bindgen` |
//! | `headers found, but no library for … in …` | `MUJOCO_DIR` names the source tree or the `include` directory | name the directory that contains both |
//! | `error while loading shared libraries: libmujoco.so.2.2.2` | the program was started without Cargo, and the library is outside of the loader's path | one line in `build.rs`: see [`engines`](super::engines#deployment) |
//! | [`EngineVersion`](Error::EngineVersion) | the loader finds another release than the build script | rebuild, or correct `LD_LIBRARY_PATH` |
//! | `failed to find tool "c++"` | no C++ compiler for the shim | `apt-get install g++` |
//! | `requires rustc 1.95` | the viewer's dependencies need a newer Rust than the rest | update Rust, or build without the feature `viewer` |
//! | `cannot find render in mujoco_safe` | a feature is off | `cargo add mujoco-safe --features renderer` |
//! | the documentation has no `render`, `viewer` or `save_npz` | `cargo doc` without features | `cargo doc --open --features viewer,mjz,npz,mcap,live,gltf,serde` |
//! | a program of this documentation does not find a crate such as `tempfile` | its page names the crate | the command `cargo add` of the page |
//! | a simulation takes ten times as long as expected | a debug build of the program's own code | `cargo run --release`: see [`performance`](super::performance#build-profiles) |
//!
//! # Models
//!
//! | symptom | cause | remedy |
//! |---|---|---|
//! | `unrecognized element: 'frame'`, `'flexcomp'`, `'plugin'` | an element of newer engines | replace it: 2.2.2 has neither frames nor flexes nor plugins; or use a [newer engine](super::engines) |
//! | `unrecognized attribute: 'memory'`, `'kv'`, `'actuatorfrcrange'` | an attribute of newer engines | remove it; `memory` becomes `njmax`, `nconmax` and `nstack` |
//! | `invalid keyword: 'implicitfast'` | an integrator of newer engines | `integrator="implicit"` |
//! | `joint has range but not limited` | newer engines derive `limited` from `range` | `<compiler autolimits="true"/>` |
//! | `inertia must satisfy A + B >= C` | an inertia that no body can have, often in a URDF | `balanceinertia` of the compiler: see [`urdf`](super::urdf#inertias-that-are-rejected) |
//! | `XML_ERROR_PARSING_TEXT` in line 1 | [`from_xml_str`](Model::from_xml_str) was called with a path | [`from_xml_path`](Model::from_xml_path) |
//! | a mesh of a URDF is not found | `package://` URIs | [`LoadOptions::with_package_path`](crate::LoadOptions::with_package_path) |
//! | a mesh of a URDF is not found | a relative directory, which engines from 3.0 to 3.6 remove from the name | read it as a [`Spec`](super::urdf), or `<mujoco><compiler strippath="false"/></mujoco>` in the `robot` element |
//! | `Unknown mesh file type`, `no decoder` | a mesh that the engine does not read, such as Collada | read the URDF as a [`Spec`](super::urdf), which leaves the mesh out |
//! | a model of a URDF cannot be saved as XML | the engine writes the names of files without their directories | read the URDF as a [`Spec`](super::urdf), and save that |
//! | the base of a URDF does not move | no joint connects it with the world | [`Spec::add_free_base`](crate::spec::Spec::add_free_base) |
//! | bodies of a URDF are missing or merged | the compiler fuses static bodies of a URDF | `<mujoco><compiler fusestatic="false"/></mujoco>` in the `robot` element; see [`urdf`](super::urdf#fixed-links) |
//! | contacts are missing, and a warning mentions `nconmax` | the limit of contacts is reached | larger `nconmax` and `njmax` in the model's `size` |
//!
//! Convert a model of a newer release by hand: the compiler reports one problem at a time, with its
//! line.
//!
//! # Simulation
//!
//! | symptom | cause | remedy |
//! |---|---|---|
//! | [`NotComputed`](Error::NotComputed) | a reset or an edit discarded the results | the call in the message, usually [`Data::forward`] |
//! | [`NotComputed`](Error::NotComputed) for `cfrc_ext` or `cacc` | a step does not compute them | [`Data::rne_post_constraint`] after the step |
//! | [`Poisoned`](Error::Poisoned) | an earlier call failed; the message repeats its cause | handle the first error, then [`Data::reset`] |
//! | [`Unstable`](Error::Unstable) | the simulation diverges | a smaller time step, softer contacts (`solref`), more damping or armature; limited controls |
//! | [`NoSuchName`](Error::NoSuchName) | a misspelt name; names differ between bodies, joints and geoms | the message lists the names of this kind |
//! | [`Shape`](Error::Shape) | `nq` and `nv` differ | positions have `nq` numbers; velocities, forces and the rows of Jacobians have `nv` |
//! | poses lag one step behind `qpos` | [the age of results](super::concepts#age-of-results) | [`Data::forward`] |
//! | a joint's index addresses another joint in `qpos` | a free joint occupies 7 positions and 6 velocities | `qpos_range()` and `dofs()` of the joint |
//! | an edit has no effect, or the motion is implausible after one | derived quantities are out of date | [`update_constants`](crate::ModelMut::update_constants) |
//! | results differ in the last digits from Python, or between `cargo run` and the installed program | another build of the engine | use the same library: see [`engines`](super::engines#deployment) |
//! | a panic, or an error of a viewer's camera: `belongs to another model` | an id of a model that was loaded separately | take ids from the model of this simulation, `data.model()` |
//!
//! # Borrows
//!
//! **`cannot borrow data as mutable because it is also borrowed as immutable`.** A slice or a view
//! of the simulation is in use during a step or a write. Copy the values, or take an id:
//!
//! ```compile_fail,E0502
//! # use mujoco_safe::{Data, sample};
//! # let mut data = Data::new(sample::cartpole())?;
//! let before = data.qpos();
//! data.step()?;
//! println!("{before:?} to {:?}", data.qpos());
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! ```
//! # use mujoco_safe::{Data, sample};
//! # let mut data = Data::new(sample::cartpole())?;
//! let before = data.qpos().to_vec();
//! let pole = data.model().body("pole")?.id(); // an id borrows nothing
//! data.step()?;
//! println!("{before:?} to {:?}, {:?}", data.qpos(), data.body(pole).xpos());
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The model of a simulation is part of it, so a call on `data.model()` cannot write to `data`.
//! Clone the `Arc`, which copies no model:
//!
//! ```compile_fail,E0502
//! # use mujoco_safe::{Data, sample};
//! # let mut data = Data::new(sample::cartpole())?;
//! data.model().integrate_pos(data.qpos_mut(), &[0.1, 0.0], 1.0)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! ```
//! # use mujoco_safe::{Data, sample};
//! # let mut data = Data::new(sample::cartpole())?;
//! let model = data.model().clone();
//! model.integrate_pos(data.qpos_mut(), &[0.1, 0.0], 1.0)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! **`&Model is not a model that a simulation can share`.** [`Data::new`] takes a [`Model`], an
//! `Arc<Model>` or an `&Arc<Model>`. Put the model in an `Arc` once:
//! `let model = Arc::new(model);`, then `Data::new(&model)` shares it.
//!
//! **`type annotations needed`, or a closure is not a [`Controller`](crate::Controller).** Name the
//! type of the argument:
//!
//! ```
//! # use mujoco_safe::{Controller, Data, sample};
//! # let mut data = Data::new(sample::cartpole())?;
//! let mut push = |data: &mut Data| data.ctrl_mut()[0] = 0.1;
//! push.control(&mut data)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! **`Box<C>` of a type `C` is not a `Controller`.** `Box<dyn Controller>` is one:
//! `let mut controller: Box<dyn Controller> = Box::new(…);`, then
//! `trajectory.record(&mut data, &mut controller, steps)`.
//!
//! # Rendering and the viewer
//!
//! | symptom | cause | remedy |
//! |---|---|---|
//! | `no … was found. A software adapter is in …` (`RenderError::NoAdapter`) | no graphics driver | `apt-get install libvulkan1 mesa-vulkan-drivers` |
//! | `no display is available for a window` (`ViewerError::NoDisplay`) | no X server | render without a window, or `xvfb-run`, or `ssh -X` |
//! | the same although `DISPLAY` is set, or a message that names a library such as `libxkbcommon-x11` | libraries of the desktop are missing | `apt-get install libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0` |
//! | the first image takes long | shaders are compiled | keep the renderer for further images |
//! | an image shows only the background | the camera is far away, or inside a geom | [`Camera::free`](crate::scene::Camera::free) shows the complete model |
//! | a large floor is misplaced in the first image | the engine centres infinite planes at the previous viewpoint | [`Scene::update_camera`](crate::Scene::update_camera) before the first update |
//! | [`SceneFull`](Error::SceneFull) | more geoms than the scene has room for | a larger capacity in [`Scene::new`](crate::Scene::new) |
//! | an edited mesh or texture is drawn unchanged | the renderer keeps copies | `Renderer::update_mesh`, `update_texture`, `update_height_field` |
//!
//! # Further information
//!
//! The engine's warnings are log messages: install a logger (`env_logger`, for example) and set
//! `RUST_LOG=mujoco=warn`. [`Data::print_to`] writes all quantities of a simulation to a text file.
//! [`errors`](super::errors) explains the kinds of errors.

#[cfg(doc)]
use crate::{Data, Error, Model};
