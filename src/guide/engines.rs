//! Engines and set-up: versions of MuJoCo, installation, and the search paths at build time and at
//! run time.
//!
//! This crate supports MuJoCo **2.2.2**, **3.5.0**, **3.17.0** and **4.0.1**;
//! [`promises`](crate::guide::promises) names what differs with the last three. Other versions are
//! for trials. The layout of the engine's structs changes with each release, so each version has
//! its own bindings:
//!
//! | MuJoCo | bindings | tests |
//! |---|---|---|
//! | 2.2.2 | committed | all |
//! | 3.5.0 | committed | all except the program `coverage`: `scripts/test --engine 3.5.0` |
//! | 3.17.0 | committed | all except the program `coverage`: `scripts/test --engine 3.17.0` |
//! | 4.0.1 | committed | all except the program `coverage`: `scripts/test --engine 4.0.1` |
//! | other releases up to 4.0.1 | those of the nearest if its headers declare the same, as of a patch release, else generated: feature `bindgen` | `mujoco-sys`, `smoke`: `scripts/releases` |
//! | newer ones | those of the nearest if its headers declare the same, as of a patch release, else generated: feature `bindgen` | none |
//!
//! The crate links the engine as a shared library, compiles a small shim with a C and a C++
//! compiler, and contains bindings, so it needs neither libclang nor Python. For another release,
//! the build compiles the declarations of the nearest bindings as C assertions against the headers
//! that it finds: sizes, offsets, types and lengths of fields, values of constants, types of
//! functions. If all hold, it uses these bindings without functions that the release lacks, which a
//! warning names, else it fails, names the first difference, and prints the command that generates
//! bindings: `pip install libclang && cargo build --features mujoco-safe/bindgen`, in any Python on
//! the path. `apt-get install libclang-dev` does as well. In both cases it prints a warning,
//! because few tests or none run with this engine: names and layout of fields are right by
//! construction, but the meaning of a value may have changed. Versions before 2.2.2 are an error.
//!
//! With **4.0.0** the build warns: its Newton solver with sparse matrices may return wrong
//! accelerations ([#3767](https://github.com/google-deepmind/mujoco/issues/3767)); 4.0.1 corrects
//! it.
//!
//! # Debian 12
//!
//! ```sh
//! apt-get install libmujoco-dev g++
//! apt-get install libmujoco-samples      # optional: the engine's sample models, for sample::system_models
//! ```
//!
//! No variable is necessary, and the dynamic loader finds the library.
//!
//! # Other builds: `MUJOCO_DIR`
//!
//! `MUJOCO_DIR` names a directory with `include/mujoco/mujoco.h` and the library. If it is set, the
//! build script searches nowhere else.
//!
//! | source | `MUJOCO_DIR` |
//! |---|---|
//! | release archive for Linux, unpacked in `/opt` | `/opt/mujoco-2.2.2` |
//! | wheel `mujoco==2.2.2` from PyPI | the directory of the package `mujoco` |
//! | a build from source, installed to a prefix | the prefix |
//!
//! The wheel is a convenient source of the official library without root permissions, on every
//! Linux distribution. It was built for Python 3.7 to 3.10, but any version of pip can download it:
//!
//! ```sh
//! pip install --target DIR --python-version 3.10 --only-binary :all: --no-deps mujoco==2.2.2
//! export MUJOCO_DIR=DIR/mujoco
//! cargo build
//! ```
//!
//! On a machine whose only engine is a wheel, one command suffices in an active Python environment
//! (`VIRTUAL_ENV`), because the build script searches it: `pip install mujoco-core==4.0.1`. In this
//! repository `scripts/engine VERSION` installs any released engine in `target/engines` and prints
//! its directory: `MUJOCO_DIR=$(scripts/engine 4.0.1) cargo run --example getting_started`.
//!
//! If a Python of these versions has the package installed,
//! `python3 -c "import mujoco; print(mujoco.__path__[0])"` prints the directory. The wheel's
//! library is named `libmujoco.so.2.2.2`, without a link `libmujoco.so`; the build script accepts
//! both names.
//!
//! Cargo runs the build script again when `MUJOCO_DIR` changes. To alternate between two engines
//! without recompilation, give each a target directory (`CARGO_TARGET_DIR`).
//!
//! # The feature `download`
//!
//! With this feature, which is off by default, the build needs no installed engine: if it finds
//! none and `MUJOCO_DIR` is not set, it installs the wheel of MuJoCo 2.2.2 for the target with pip
//! or uv, which compares it with the SHA-256 in this crate. The folder is `mujoco-safe` in
//! `$XDG_CACHE_HOME`, `%LOCALAPPDATA%` or `~/.cache`, and all projects of the user share it: a
//! later build needs neither network nor pip. An installed engine has precedence; one that is
//! installed later is found after `cargo clean --package mujoco-safe-sys`.
//!
//! ```sh
//! cargo add mujoco-safe --features download && cargo run
//! ```
//!
//! # Search at build time
//!
//! If `MUJOCO_DIR` is set and not empty, the build script searches only that directory. Otherwise
//! it searches, in this order:
//!
//! 1. the wheel in the active Python environment, `$VIRTUAL_ENV/lib/python*/site-packages/mujoco`
//!    (`Lib\site-packages\mujoco` on Windows),
//! 2. the active conda environment, `$CONDA_PREFIX` (and its directory `Library` on Windows),
//! 3. ROS's vendor package, `opt/mujoco_vendor` in each directory of `$AMENT_PREFIX_PATH`,
//! 4. the prefix that `pkg-config` reports for `mujoco`,
//! 5. `/usr`, `/usr/local` and `/opt/mujoco`.
//!
//! The headers are in `include/mujoco` of the directory. The library for the target (`libmujoco.so`
//! or `libmujoco.so.*`, `libmujoco.*dylib` on macOS, `mujoco.dll` on Windows) is in
//! `lib/<architecture>-linux-gnu`, `lib64`, `lib`, `bin`, or the directory itself. The script skips
//! engines of other versions if one of these places has 2.2.2, so `MUJOCO_DIR` selects another
//! version. A build of this repository prints a warning with the library's directory if the engine
//! is in one of the first four places.
//!
//! A failure prints the searched places and the reason for each. An engine of a version without
//! bindings is an error of the build. On docs.rs (`DOCS_RS` is set) a missing engine is not an
//! error, because documentation links nothing.
//!
//! # Search at run time
//!
//! | the library is in | `cargo run`, `cargo test`, `cargo bench` | an installed program |
//! |---|---|---|
//! | `/usr/lib` or its multiarch directory | found | found |
//! | another directory | found, through a link in Cargo's output directory | needs one of the following |
//!
//! Cargo does not pass a run-time search path from a dependency to the program. Choose one:
//!
//! - Set `LD_LIBRARY_PATH` to the directory of the library when the program starts.
//! - Build with `RUSTFLAGS="-C link-arg=-Wl,-rpath,DIR"`.
//! - Put the library beside the program, and build with
//!   `RUSTFLAGS='-C link-arg=-Wl,-rpath,$ORIGIN'`.
//! - Add the directory to `/etc/ld.so.conf.d/` and run `ldconfig`.
//!
//! The second and third need the library under its own name (`libmujoco.so.2.2.2`), which the
//! program records.
//!
//! If Debian's library is installed too, a program that starts without these settings runs with
//! Debian's library. It has the same name and the same version, so nothing fails; speed and last
//! bits of the results change. `/proc/PID/maps` or `ldd` show the library that a program uses.
//!
//! The first call that loads a model compares the version of the running library with the version
//! of the headers and returns [`Error::EngineVersion`](crate::Error::EngineVersion) if they differ:
//!
//! ```
//! use mujoco_safe::{built_against, engine_version};
//!
//! assert_eq!(engine_version(), built_against());
//! println!("MuJoCo {}", engine_version());
//! ```
//!
//! # Build scripts of dependants
//!
//! A crate that depends directly on `mujoco-safe-sys` receives `DEP_MUJOCO_INCLUDE`,
//! `DEP_MUJOCO_LIBDIR` and `DEP_MUJOCO_VERSION` in its build script, and `DEP_MUJOCO_RPATH` if the
//! library is outside of the loader's path. The build script of a program can set its own run-time
//! path:
//!
//! ```
//! // build.rs, with mujoco-safe-sys as a direct dependency
//! if let Ok(dir) = std::env::var("DEP_MUJOCO_RPATH") {
//!     println!("cargo::rustc-link-arg=-Wl,-rpath,{dir}");
//! }
//! ```
//!
//! # Containers
//!
//! A minimal image for a program without rendering, on Debian's library:
//!
//! ```text
//! FROM debian:12-slim
//! RUN apt-get update && apt-get install -y --no-install-recommends libmujoco2.2.2
//! COPY program /usr/local/bin/
//! CMD ["program"]
//! ```
//!
//! Rendering also needs a driver: `libvulkan1 mesa-vulkan-drivers` is a software driver.
//!
//! # Platforms
//!
//! | platform | `.ci/run` | `scripts/platform PLATFORM --slow` |
//! |---|---|---|
//! | Linux, x86-64 | runs all tests | |
//! | Linux, aarch64 | runs `mujoco-sys`, `smoke` and the cart-pole with 2.2.2, and `mujoco-sys` and the cart-pole with 4.0.1, under qemu | runs `engine`, `linearisation`, `data` and `model` too |
//! | Windows, x86-64, tools of GNU | runs the guard's tests, `smoke` and the cart-pole with 2.2.2, under Wine | runs the same programs as for aarch64, and with 4.0.1 |
//! | Windows, x86-64, tools of Microsoft | compiles the shim without extensions of GNU's compiler | |
//! | macOS, arm64 | links the library and the cart-pole with 4.0.1 | links all examples, runs `cargo check` with the viewer |
//!
//! The viewer and the renderer run on x86-64 Linux only, with X11 and Vulkan; elsewhere they are
//! compiled at most. With MuJoCo 2.2.2, A and B of the cart-pole are the same bits on all platforms
//! that run, and K agrees to 1e-12 (`tests/smoke/platforms.rs`).
//!
//! *Windows.* The build needs a C and a C++ compiler, but no import library: the Rust compiler
//! makes it from the bindings. A program needs `mujoco.dll` in its directory or in `PATH`, which
//! needs Microsoft's Visual C++ runtime, and no library of its own compiler. The engine opens files
//! of models by paths in UTF-8, which its C library reads in the system's code page, so it may not
//! find names with characters beyond ASCII. Names of devices, such as `NUL` and `com1.stl`, are
//! special files in every directory. With Microsoft's compiler only engines with committed bindings
//! can be used, because the comparison of headers uses extensions of GNU's.
//!
//! *macOS.* The official library records that it is in a framework. The build places a link to it
//! where a program searches it, in Cargo's output directory. An installed program needs the library
//! as `mujoco.framework/Versions/A/libmujoco.X.Y.Z.dylib` in a directory of its rpath.
//!
//! *Other systems than Linux.* Text that the engine prints to `stderr` is not captured, sensors of
//! distances with engines since 3.3.0 can differ from those of C, and a program does not start with
//! an engine that lacks a function of the headers.
//!
//! # Raw bindings
//!
//! [`sys`](crate::sys) has the raw bindings for calls that this crate does not wrap; their use is
//! `unsafe`. The feature `bindgen` of `mujoco-safe-sys` generates them from the installed headers
//! instead of using the committed ones, and needs libclang. CONTRIBUTING describes how to port the
//! crate to another version.
//!
//! # Access that differs between versions
//!
//! The generated accessors follow the engine: with 4.0.1 the inertia matrix is `Data::M`, not
//! `Data::qM`, and `cargo doc` with an engine shows its accessors. The hand-written interface is
//! the same with every engine. What an engine lacks is
//! [`Error::Unsupported`](crate::Error::Unsupported). So is
//! [`Model::from_binary`](crate::Model::from_binary) with newer engines except 3.5.0, because the
//! rules by which a binary model is safe to load are known for 2.2.2 and 3.5.0 only, and with 3.5.0
//! not for flexes, plugins, signed distance fields and tactile sensors. The unsafe
//! [`Model::from_binary_unchecked`](crate::Model::from_binary_unchecked) loads a trusted one.
//!
//! The enums are the same with every engine, and [`Options`](crate::Options) has the options of all
//! engines. A setter returns `Error::Unsupported` for a variant, a flag or an option that the
//! engine lacks, with the versions that have it.
//!
//! Functions that 2.2.2 lacks are implemented in Rust and used with every engine, so that they have
//! the same results: state vectors, keyframes, derivatives of inverse dynamics and quaternions,
//! several rays, distances of geoms, the matrix of angular momentum, box-constrained quadratic
//! programs and band matrices. `tests/smoke` compares each with the function of the engine from
//! 3.5.0. Three differ: `mj_multiRay` may return hits beyond its cutoff, `mju_cholFactorBand` of
//! 4.0 returns the square root of the smallest pivot, and `mj_geomDistance` of 3.5.0 is less
//! precise.
//!
//! Use these methods instead of arrays whose layout differs:
//!
//! | array | method |
//! |---|---|
//! | `actuator_moment` | [`Data::full_moment`](crate::Data::full_moment), [`ActuatorData::moment`](crate::element::ActuatorData) |
//! | `ten_J` | [`TendonData::J`](crate::element::TendonData) |
//! | `qM`, `M` | [`Data::full_m`](crate::Data::full_m), [`Data::mul_m_into`](crate::Data::mul_m_into) |
//! | `eq_active`, `eq_active0` | [`EqualityMut::set_active`](crate::element::EqualityMut) |
//! | `tex_rgb`, `tex_data` | [`Texture::rgb`](crate::element::Texture) |
//! | `light_directional`, `light_type` | [`Light::directional`](crate::element::Light) |
//! | `solver`, `solver_iter` | [`Data::solver`](crate::Data::solver) |
//! | `mesh_normal`, `mesh_texcoord` | [`Mesh::normal`](crate::element::Mesh) by [`Mesh::facenormal`](crate::element::Mesh), likewise `texcoord` |
//! | `contact.geom1`, `contact.geom` | [`Contact::geoms`](crate::data::Contact::geoms), [`Contact::sides`](crate::data::Contact::sides) |
//!
//! # Features of newer engines
//!
//! | feature | since | here |
//! |---|---|---|
//! | flexes: ropes, cloths, soft bodies | 3.0 | simulated, drawn and selected. [`Contact::geoms`](crate::data::Contact::geoms) is `None` for their contacts. With 3.3.4 to 3.5 their models have no islands ([`DisableFlags::ISLAND`](crate::model::DisableFlags::ISLAND)), because the engine writes out of bounds for islands of their contacts. With 3.0 to 3.10 the Jacobian is dense if their contacts have torsional friction ([`Options::jacobian`](crate::Options::jacobian)) |
//! | plugins, signed distance fields | 2.3.1, 3.0 | after [`load_plugins`](crate::load_plugins). With 3.6.0 the readers of OBJ and STL files are plugins too |
//! | other models as assets (`<model file>`, `<attach>`) | 3.2 | MJCF and URDF files, which pass the checks of the main file. Other formats are rejected |
//! | sleeping bodies (the option `sleep`) | 3.4 | simulated, except with `sleep="init"`, which is rejected. [`BodyData::is_asleep`](crate::element::BodyData::is_asleep) tells which bodies sleep. State vectors do not contain that: [`Data::set_state`](crate::Data::set_state) with positions or velocities wakes all bodies, as do changes of the model and inverse dynamics. With 3.5.0 a mocap body that touches a sleeping body does not wake it, as in C. Linearisations and [`Batch`](crate::Batch) are [`Error::Unsupported`](crate::Error::Unsupported) |
//! | delays of actuators and sensors | 3.5 | simulated. State vectors with [`StateSpec::HISTORY`](crate::StateSpec::HISTORY) contain their buffers, which `set_state` checks. Linearisations are `Error::Unsupported`, as in C |
//! | actuators with several controls, forces or activations (`pid`, `orientation`, `dcmotor` with temperature) | 3.11 | simulated. [`Actuator::controls`](crate::element::Actuator::controls), `outputs` and `activations` are their places in the arrays. Linearisations are the engine's, by differences; [`PdController`](crate::PdController) is `Error::Unsupported` |
//! | IPC contacts of flexes | 4.0 | rejected: no state vector contains the state of these contacts |
//!
//! A rejected model is an [`Error::Load`](crate::Error::Load) that names the feature.
