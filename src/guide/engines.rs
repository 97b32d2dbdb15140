//! Engines: versions of MuJoCo, search at build time, deployment, platforms.
//!
//! # Versions
//!
//! | MuJoCo | bindings | tests |
//! |---|---|---|
//! | 2.2.2 | committed | all |
//! | 3.5.0, 3.17.0, 4.0.1 | committed | all except the program `coverage`: `scripts/test --engine VERSION` |
//! | other releases up to 4.0.1 | those of the nearest, or generated | `mujoco-sys`, `smoke`: `scripts/releases` |
//! | newer ones | those of the nearest, or generated | none |
//!
//! [`promises`](super::promises) names the differences of engines other than 2.2.2, and
//! [`concepts`](super::concepts#fields-of-other-engines) those of their fields.
//!
//! Releases without committed bindings are for trials: the meaning of a value may have changed. The
//! build compares their headers with the nearest bindings by the C compiler. If the declarations
//! are the same, as of a patch release, it uses these bindings, without functions that the release
//! lacks. Otherwise it names the first difference and the command that generates bindings:
//! `pip install libclang && cargo build --features mujoco-safe/bindgen`. Such builds print a
//! warning. Versions before 2.2.2 are an error. The Newton solver of 4.0.0 may return wrong
//! accelerations with sparse matrices
//! ([#3767](https://github.com/google-deepmind/mujoco/issues/3767)); 4.0.1 corrects it.
//!
//! # Search at build time
//!
//! If `MUJOCO_DIR` is set, the build searches only there:
//!
//! | `MUJOCO_DIR` | engine |
//! |---|---|
//! | `/opt/mujoco-2.2.2` | an unpacked release archive, or the prefix of a build from source |
//! | `DIR` | the wheel: `pip install --target DIR --python-version 3.10 --only-binary :all: --no-deps mujoco==2.2.2` |
//! | `$(scripts/engine 4.0.1)` | in this repository: any release, from PyPI |
//! | `download` | the official library of the feature `download`, even if another is installed |
//!
//! A relative directory is relative to a directory above the target directory, such as the
//! workspace. The directory contains `include/mujoco/mujoco.h`, and the library in
//! `lib/<architecture>-linux-gnu`, `lib64`, `lib`, `bin` or itself; a link `libmujoco.so` is not
//! necessary.
//!
//! Otherwise it searches, in this order, and prefers 2.2.2, then committed bindings: the active
//! environments of Python (`$VIRTUAL_ENV`), conda (`$CONDA_PREFIX`) and ROS (`opt/mujoco_vendor` in
//! `$AMENT_PREFIX_PATH`), the prefix that `pkg-config` reports, `/usr`, `/usr/local` and
//! `/opt/mujoco`. A failure prints the reason for each place.
//!
//! # The feature `download`
//!
//! If the build finds no engine, this feature installs the wheel of MuJoCo 2.2.2 for the target
//! with pip or uv, which compares it with a committed SHA-256. The projects of a user share
//! the folder: `mujoco-safe` in `$XDG_CACHE_HOME`, `%LOCALAPPDATA%` or `~/.cache`. Later builds
//! need neither network nor pip. An engine that is installed later is found after
//! `cargo clean --package mujoco-safe-sys`.
//!
//! The official library steps the humanoid about 1.25 times as fast as Debian's of the same
//! version. If the build chooses Debian's and the official one is in the cache, it prints a hint.
//!
//! # Deployment
//!
//! `cargo run`, `cargo test` and `cargo bench` find every engine. If it is outside of the loader's
//! directories, the build places a link to the library in a folder `mujoco-lib` beside the programs
//! (on Windows a copy of `mujoco.dll` in their directory), in `target/<profile>` and its folders
//! `deps` and `examples`. With one line in its `build.rs`, a program starts directly and in a
//! debugger, without variables:
//!
//! ```
//! // Linux. macOS: @executable_path in place of $ORIGIN. Windows: no line.
//! println!("cargo::rustc-link-arg=-Wl,-rpath,$ORIGIN/mujoco-lib");
//! ```
//!
//! A folder with the program and the library then runs after being moved, also on machines without
//! engine and Rust:
//!
//! ```sh
//! cp -RL target/release/{program,mujoco-lib} FOLDER/    # Windows: program.exe and mujoco.dll
//! ```
//!
//! Debian's library is not linked there: install the package `libmujoco2.2.2` on the other machine.
//! Rendering also needs a driver, such as `libvulkan1 mesa-vulkan-drivers` in software.
//!
//! Without this line, and for programs of `cargo install`, set `LD_LIBRARY_PATH`, add the directory
//! to `/etc/ld.so.conf.d/`, or link with `RUSTFLAGS="-C link-arg=-Wl,-rpath,DIR"`. Without any of
//! these the loader takes Debian's library if it is installed. The first load of a model returns
//! [`Error::EngineVersion`](crate::Error::EngineVersion) if its version differs from that of the
//! headers ([`built_against`](crate::built_against)).
//!
//! # Platforms
//!
//! The README lists them. With MuJoCo 2.2.2, A and B of the cart-pole are the same bits on all
//! platforms that run it, and K agrees to 1e-12 (`tests/smoke/platforms.rs`).
//!
//! *Windows.* The build needs no import library. `mujoco.dll` needs Microsoft's Visual C++ runtime.
//! Model files with names beyond ASCII may not be found, because the engine's C library reads UTF-8
//! paths in the system's code page; `NUL` or `com1.stl` are devices in every directory. For
//! Microsoft's compiler, the shim is checked for extensions of GNU's only, and engines without
//! committed bindings cannot be used.
//!
//! *macOS.* The library is `mujoco.framework/Versions/A/libmujoco.X.Y.Z.dylib` in a directory of
//! the program's rpath.
//!
//! *Other systems than Linux.* Text that the engine prints to `stderr` is not captured, models with
//! some sensors of distances are rejected with engines since 3.3.0
//! ([`promises`](super::promises)), and no program starts with an engine that lacks a function of
//! its headers.
