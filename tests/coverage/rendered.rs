//! The pages that `cargo doc` writes: the search finds every name of the C API, and the essential
//! methods come first. The tests are ignored by default, because they need these pages:
//!
//! ```sh
//! rm -rf target/doc    # rustdoc would add to the search index
//! cargo doc --workspace --features viewer,mjz,npz,mcap,live,gltf,serde --no-deps
//! cargo test --features viewer,mjz,npz,mcap,live,gltf,serde --test coverage rendered -- --ignored
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::functions::{family, rows};
use crate::{root, search_index};

/// Structs and enums that this library does not need, and the reasons. Families are in
/// `functions.rs`.
const UNUSED_TYPES: [(&str, &str); 9] = [
    ("mjtButton", "mouse of the engine's user interface"),
    ("mjtEvent", "events of the engine's user interface"),
    ("mjtItem", "items of the engine's user interface"),
    ("mjtGridPos", "drawing with OpenGL"),
    ("mjtFramebuffer", "drawing with OpenGL"),
    ("mjtFont", "drawing with OpenGL"),
    ("mjtFontScale", "drawing with OpenGL"),
    ("mjtStereo", "drawing with OpenGL"),
    ("mjvFigure", "drawing with OpenGL"),
];

/// Words that users search for: tasks, in British and American spelling, and names of MuJoCo.jl and
/// of the Python bindings that differ from those of the C API.
const WORDS: [&str; 109] = [
    // Tasks.
    "gravity compensation",
    "operational space",
    "task space",
    "impedance",
    "contact pair",
    "inverse kinematics",
    "forward kinematics",
    "inverse dynamics",
    "forward dynamics",
    "mass matrix",
    "linearise",
    "linearize",
    "linearisation",
    "linearization",
    "optimal control",
    "linear quadratic regulator",
    "lqr",
    "dlqr",
    "ilqr",
    "ddp",
    "mpc",
    "model predictive control",
    "mppi",
    "receding horizon",
    "trajectory optimisation",
    "trajectory optimization",
    "pid",
    "domain randomisation",
    "domain randomization",
    "identification",
    "system identification",
    "gymnasium",
    "gym",
    "reinforcement learning",
    "headless",
    "headless render",
    "headless rendering",
    "offscreen",
    "screenshot",
    "save video",
    "video",
    "mp4",
    "movie",
    "animation",
    "plot",
    "plots",
    "plotting",
    "csv",
    "numpy",
    "logging",
    "save state",
    "urdf",
    "real time",
    "real-time",
    "continuous integration",
    "visualise",
    "visualize",
    "visualiser",
    "visualizer",
    "gui",
    "viewer",
    "lidar",
    "grasp",
    "contact forces",
    "point_cloud",
    // MuJoCo.jl, and MatrixEquations.jl.
    "load_model",
    "init_data",
    "sample_model_and_data",
    "example_model_files",
    "example_model_files_directory",
    "step!",
    "forward!",
    "reset!",
    "resetkey!",
    "get_physics_state",
    "set_physics_state!",
    "timestep",
    "show_docs",
    "mj_zeros",
    "mj_array",
    "visualise!",
    "init_visualiser",
    "install_visualiser",
    "random_controller!",
    "LibMuJoCo",
    "MuJoCo.jl",
    "ared",
    // The Python bindings, and SciPy.
    "from_xml_path",
    "from_xml_string",
    "from_binary_path",
    "launch",
    "launch_passive",
    "launch_from_path",
    "update_scene",
    "read_pixels",
    "enable_depth_rendering",
    "enable_segmentation_rendering",
    "GLContext",
    "from_file",
    "from_string",
    "from_zip",
    "to_file",
    "to_xml",
    "to_zip",
    "set_mjcb_control",
    "rollout",
    "least_squares",
    "savez",
    "solve_discrete_are",
];

fn documentation() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("the target directory contains tmp");
    target.join("doc")
}

fn page(path: &str) -> String {
    let path = documentation().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}; run cargo doc first", path.display()))
}

/// Returns the number of items of each name in the raw bindings. The search finds these too.
fn items_of_bindings() -> BTreeMap<String, usize> {
    let mut items = BTreeMap::new();
    for link in page("mujoco_sys/all.html").split("<a href=\"").skip(1) {
        let page = link.split(".html\"").next().unwrap();
        if let Some((_, name)) = page.split('/').next_back().and_then(|page| page.split_once('.')) {
            *items.entry(name.to_owned()).or_insert(0) += 1;
        }
    }
    assert!(items.contains_key("mj_step"), "the bindings have no page for mj_step");
    items
}

/// Returns the names that the search finds, each with the number of items in this library that it
/// finds.
fn found() -> BTreeMap<String, usize> {
    let mut names = search_index::names(&documentation());
    assert_eq!(
        names["from_binary_unchecked"],
        1,
        "rustdoc has added to the index of an earlier build; remove {} and run cargo doc",
        documentation().display()
    );
    for (name, count) in items_of_bindings() {
        let found = names.get_mut(&name).unwrap_or_else(|| panic!("the search does not find mujoco_sys::{name}"));
        *found -= count;
    }
    names
}

/// Returns the structs and enums of the header, without those of families that have no equivalents.
fn types() -> Vec<String> {
    let bindings = fs::read_to_string(root().join("mujoco-sys/src/bindings/v2_2_2.rs")).unwrap();
    let declared = bindings.lines().filter_map(|line| {
        let name = line.strip_prefix("pub type ").or_else(|| line.strip_prefix("pub struct "))?;
        name.split([' ', ':']).next()?.strip_suffix('_')
    });
    declared
        .filter(|name| name.starts_with("mj") && !["mjr", "mjui", "mjUI"].iter().any(|family| name.starts_with(family)))
        .map(str::to_owned)
        .collect()
}

#[test]
#[ignore = "reads the output of cargo doc"]
fn the_search_finds_every_function_at_each_of_its_equivalents() {
    let found = found();
    let missing: Vec<String> = rows()
        .iter()
        .filter(|row| family(row.name).is_none())
        // A function without an equivalent is found at the page that has the reason.
        .map(|row| (row, row.here.len().max(usize::from(!row.is_newer())), found.get(row.name).copied().unwrap_or(0)))
        .filter(|(_, needed, found)| found < needed)
        .map(|(row, needed, found)| format!("{}: {found} of {needed}, for {:?}", row.name, row.here))
        .collect();
    assert!(missing.is_empty(), "without #[doc(alias)]: {missing:#?}");
}

#[test]
#[ignore = "reads the output of cargo doc"]
fn the_search_finds_every_struct_and_enum() {
    let found = found();
    let types = types();
    assert!(types.len() > 50, "{types:?}");
    for (name, reason) in UNUSED_TYPES {
        assert!(types.iter().any(|known| known == name), "{name} ({reason}) is not a type of the header");
    }
    let missing: Vec<&String> = types
        .iter()
        .filter(|name| UNUSED_TYPES.iter().all(|(unused, _)| unused != name))
        .filter(|&name| found.get(name).is_none_or(|&count| count == 0))
        .collect();
    assert!(missing.is_empty(), "without #[doc(alias)]: {missing:#?}");
}

#[test]
#[ignore = "reads the output of cargo doc"]
fn the_search_finds_the_words_of_tasks_and_of_other_bindings() {
    let found: BTreeSet<String> = found().into_keys().map(|name| name.to_lowercase()).collect();
    let missing: Vec<&&str> = WORDS.iter().filter(|word| !found.contains(&word.to_lowercase())).collect();
    assert!(missing.is_empty(), "without #[doc(alias)]: {missing:#?}");
}

/// Returns the inherent methods on the page of a type, in the order of the page.
fn methods(page: &str) -> Vec<&str> {
    let inherent = page.split("id=\"trait-implementations\"").next().unwrap();
    inherent.split("<section id=\"method.").skip(1).map(|rest| rest.split('"').next().unwrap()).collect()
}

fn position(methods: &[&str], name: &str) -> usize {
    methods.iter().position(|method| *method == name).unwrap_or_else(|| panic!("no method {name}"))
}

#[test]
#[ignore = "reads the output of cargo doc"]
fn the_essential_methods_come_first_and_the_accessors_last() {
    let model = page("mujoco_safe/model/struct.Model.html");
    let model = methods(&model);
    assert_eq!(model[0], "from_xml_path");
    assert!(model[..6].iter().all(|method| method.starts_with("from_")), "{:?}", &model[..6]);
    assert!(position(&model, "edit") < 30);
    assert!(position(&model, "nq") > position(&model, "tuples"), "the generated accessors are not last");

    let data = page("mujoco_safe/data/struct.Data.html");
    let data = methods(&data);
    assert_eq!(data[0], "new");
    for essential in ["step", "forward", "reset", "reset_to_key", "state", "require"] {
        assert!(position(&data, essential) < 30, "{essential}");
    }
    assert!(position(&data, "qpos") > position(&data, "transition_fd_into"), "the generated accessors are not last");
}

#[test]
#[ignore = "reads the output of cargo doc"]
fn the_views_have_at_most_two_blocks_per_kind() {
    for name in ["View", "ViewMut"] {
        let page = page(&format!("mujoco_safe/element/struct.{name}.html"));
        let inherent = page.split("id=\"trait-implementations\"").next().unwrap();
        let mut blocks = BTreeMap::new();
        for rest in inherent.split("<section id=\"impl-").skip(1) {
            let id = rest.split('"').next().unwrap();
            // rustdoc numbers the second and each further block of the same type.
            let of = id.rsplit_once('-').filter(|(_, number)| number.parse::<u32>().is_ok()).map_or(id, |(of, _)| of);
            *blocks.entry(of).or_insert(0) += 1;
        }
        // The generic block, and one or two blocks for each kind with methods.
        assert!(blocks.len() > 20, "{blocks:?}");
        assert!(blocks.values().all(|&count| count <= 2), "{blocks:?}");
    }
}

#[test]
fn the_diagrams_of_the_overview_fit_into_the_page() {
    let overview = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let mut diagrams = 0;
    for diagram in overview.split("//! ```text\n").skip(1).filter_map(|rest| rest.split("//! ```").next()) {
        diagrams += 1;
        for line in diagram.lines().filter_map(|line| line.strip_prefix("//! ")) {
            assert!(line.chars().count() <= 90, "rustdoc's page has about 90 columns: {line}");
        }
    }
    assert!(diagrams > 0);
}
