//! The engine writes the valid file for a model with every kind of element, so the tests also show
//! that each rule accepts valid elements. Each invalid file differs from the valid file in one
//! value.

use std::ffi::CString;
use std::path::Path;
use std::sync::OnceLock;

use mujoco_sys::guard;

use super::check;
use super::layout::{Array, Element, Field, MODEL_ARRAYS, SIZE_NAMES, Size, field, size};
use super::view::{SIZE_BYTES, SIZES_AT, SizeInt, View};

/// Compiles an XML file with the engine and returns the binary model that the engine saves; `None`
/// if it does not compile.
pub(super) fn compile(path: &Path) -> Option<Vec<u8>> {
    static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let saved = std::env::temp_dir().join(format!("mujoco-safe-{}-{count}.mjb", std::process::id()));
    let [from, to] = [path, &saved].map(|path| CString::new(path.to_str().unwrap()).unwrap());
    let mut error = [0; 500];
    let mut model = std::ptr::null_mut();
    // SAFETY: the guards' handler is installed first; both strings are NUL-terminated and the
    // buffer has the given size; the model is used only if it is not NULL, and deleted once.
    unsafe {
        guard::install(None);
        guard::mj_load_xml(from.as_ptr(), std::ptr::null(), error.as_mut_ptr(), 500, &raw mut model);
        if model.is_null() {
            return None;
        }
        assert_eq!(guard::mj_save_model(model, to.as_ptr(), std::ptr::null_mut(), 0), guard::OK);
        mujoco_sys::mj_deleteModel(model);
    }
    let bytes = std::fs::read(&saved).unwrap();
    std::fs::remove_file(&saved).unwrap();
    Some(bytes)
}

fn every_element() -> &'static [u8] {
    static FILE: OnceLock<Vec<u8>> = OnceLock::new();
    FILE.get_or_init(|| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/every_element.xml");
        #[cfg(not(engine_since = "3.5.0"))]
        return compile(&path).expect("every_element.xml compiles");
        #[cfg(engine_since = "3.5.0")]
        super::newer::tests::every_element(&std::fs::read_to_string(path).unwrap())
    })
}

/// Returns the view of the valid file.
fn valid() -> View<'static> {
    View::new(every_element()).unwrap()
}

/// Returns the error for the file with some bytes replaced.
#[track_caller]
fn rejection(changes: &[(usize, &[u8])]) -> String {
    let mut file = every_element().to_vec();
    for (at, bytes) in changes {
        file[*at..at + bytes.len()].copy_from_slice(bytes);
    }
    let bytes: Vec<_> = changes.iter().map(|(at, bytes)| (at, bytes.to_vec())).collect();
    check(&file).err().unwrap_or_else(|| panic!("the check accepted the file with {bytes:?}")).to_string()
}

/// Returns the error for the file with one integer replaced.
#[track_caller]
fn with(field: Field<i32>, index: usize, value: i32) -> String {
    rejection(&[(valid().position(field, index), &value.to_ne_bytes())])
}

#[track_caller]
fn with_real(field: Field<f64>, index: usize, value: f64) -> String {
    rejection(&[(valid().position(field, index), &value.to_ne_bytes())])
}

#[track_caller]
fn with_size(size: Size, value: i32) -> String {
    rejection(&[(SIZES_AT + SIZE_BYTES * size.0, &SizeInt::from(value).to_ne_bytes())])
}

/// Returns the index of the first element with the value.
fn find<T: Element + PartialEq>(field: Field<T>, value: T) -> usize {
    valid().values(field).position(|other| other == value).unwrap()
}

#[test]
fn files_that_the_engine_saves_are_accepted() {
    assert_eq!(check(every_element()), Ok(()));
}

#[test]
fn the_engines_example_models_are_accepted() {
    let root = Path::new("/usr/share/mujoco/model");
    if !root.exists() {
        return; // Debian has a separate package for the example models.
    }
    let mut accepted = 0;
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "xml")
                && let Some(file) = compile(&path)
            {
                assert_eq!(check(&file), Ok(()), "{}", path.display());
                accepted += 1;
            }
        }
    }
    // Newer compilers reject the other models.
    assert_eq!(accepted, if cfg!(engine_since = "3.5.0") { 9 } else { 18 });
}

#[test]
fn a_file_of_the_wrong_length_is_rejected_with_both_lengths() {
    let file = every_element();
    let length = file.len();
    for end in [length - 1, length / 2, 2000] {
        let message = check(&file[..end]).unwrap_err().to_string();
        assert_eq!(message, format!("the file has {end} bytes; its sizes require {length}"));
    }
    let longer = [file, &[0]].concat();
    let message = check(&longer).unwrap_err().to_string();
    assert_eq!(message, format!("the file has {} bytes; its sizes require {length}", length + 1));
    for end in [0, 3, 4, 247, 248, 1103] {
        let message = check(&file[..end]).unwrap_err().to_string();
        let needed = if cfg!(engine_since = "3.5.0") { 1724 } else { 1104 };
        assert_eq!(
            message,
            format!("the file has {end} bytes; the header, sizes and options of a model need {needed}")
        );
    }
}

#[test]
#[cfg(not(engine_since = "3.5.0"))]
fn a_file_of_another_kind_is_rejected_by_its_header() {
    assert_eq!(rejection(&[(0, &7_i32.to_ne_bytes())]), "the header's magic number is 7; MuJoCo 2.2.2 writes 54321");
    assert_eq!(rejection(&[(4, &4_i32.to_ne_bytes())]), "the header's size of mjtNum is 4; MuJoCo 2.2.2 writes 8");
    assert_eq!(rejection(&[(8, &65_i32.to_ne_bytes())]), "the header's number of sizes is 65; MuJoCo 2.2.2 writes 58");
    assert_eq!(
        rejection(&[(12, &303_i32.to_ne_bytes())]),
        "the header's number of arrays is 303; MuJoCo 2.2.2 writes 273"
    );
}

/// Sizes that may have one of the values below. The engine 3.5.0 allocates constraints and contacts
/// in an arena.
const UNRESTRICTED_SIZES: &[&str] =
    if cfg!(engine_since = "3.5.0") { &["nuserdata", "njmax", "nconmax", "narena"] } else { &["nuserdata"] };

#[test]
fn sizes_of_any_value_do_not_overflow() {
    for i in 0..SIZE_NAMES.len() {
        for value in [i32::MAX, i32::MIN, -1, 1 << 30] {
            if !UNRESTRICTED_SIZES.contains(&Size(i).name()) {
                with_size(Size(i), value);
            }
        }
    }
    let all = vec![0x7F; SIZE_BYTES * SIZE_NAMES.len()];
    rejection(&[(SIZES_AT, &all)]);
    assert_eq!(with_size(size::nq, -5), "nq is -5; a size must not be negative");
}

#[test]
#[cfg(not(engine_since = "3.5.0"))]
fn simulation_data_that_would_not_fit_is_rejected() {
    let message = with_size(size::njmax, 20_000);
    assert!(message.starts_with("the simulation data would have ") && message.contains("njmax 20000"), "{message}");
    assert!(with_size(size::nconmax, 1 << 23).starts_with("the simulation data would have "));
    assert!(with_size(size::nuserdata, i32::MAX).starts_with("the simulation data would have "));
    assert_eq!(
        with_size(size::nstack, i32::MAX),
        "nstack is 2147483647; it must be at most 1073741823 numbers, which is 8 GiB"
    );
    let nbuffer = valid().size(size::nbuffer);
    let message = with_size(size::nbuffer, nbuffer as i32 + 1);
    assert!(message.contains(&format!("it must be {nbuffer}, the bytes of its arrays in memory")), "{message}");
}

#[test]
#[cfg(not(engine_since = "3.5.0"))]
fn options_outside_their_enums_and_ranges_are_rejected() {
    use std::mem::offset_of;

    use super::view::OPTION_AT;
    use mujoco_sys::mjOption;

    let option = |offset: usize, value: i32| rejection(&[(OPTION_AT + offset, &value.to_ne_bytes())]);
    assert_eq!(option(offset_of!(mjOption, integrator), 3), "opt.integrator is 3; it must be from 0 to 2");
    assert_eq!(option(offset_of!(mjOption, cone), -1), "opt.cone is -1; it must be from 0 to 1");
    assert_eq!(option(offset_of!(mjOption, solver), 3), "opt.solver is 3; it must be from 0 to 2");
    assert_eq!(
        option(offset_of!(mjOption, iterations), 1_000_001),
        "opt.iterations is 1000001; it must be from -2147483648 to 1000000"
    );
    assert_eq!(
        option(offset_of!(mjOption, mpr_iterations), -1),
        "opt.mpr_iterations is -1; it must be from 0 to 1000000"
    );
    assert_eq!(option(offset_of!(mjOption, enableflags), 32), "opt.enableflags is 32; it must be from 0 to 31");
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(rejection(&[(OPTION_AT, &value.to_ne_bytes())]).contains("it must be finite and positive"));
    }
}

#[cfg(not(engine_since = "3.5.0"))]
const FIELDS: &str = include_str!("../../../mujoco-sys/fields/v2_2_2.tsv");
#[cfg(engine_since = "3.5.0")]
const FIELDS: &str = include_str!("../../../mujoco-sys/fields/v3_5_0.tsv");

/// The integer fields that are masks, priorities and groups, of which every value is valid.
const UNRESTRICTED: &[&str] = &[
    "jnt_group",
    "geom_contype",
    "geom_conaffinity",
    "geom_group",
    "geom_priority",
    "site_group",
    "tendon_group",
    "actuator_group",
    #[cfg(engine_since = "3.5.0")]
    "body_contype",
    #[cfg(engine_since = "3.5.0")]
    "body_conaffinity",
    #[cfg(engine_since = "3.5.0")]
    "skin_group",
    // The resolutions of cameras with a rangefinder are restricted.
    #[cfg(engine_since = "3.5.0")]
    "cam_resolution",
];

#[test]
fn every_restricted_integer_is_checked() {
    each_array(|array, at, count| {
        if array.element != 4 || !is_integer(array) || UNRESTRICTED.contains(&array.name) {
            return;
        }
        assert!(count > 0 || is_absent(array), "every_element.xml has no {}", array.name);
        for i in 0..count {
            for value in [i32::MAX, i32::MIN, -2, 1 << 20] {
                let message = rejection(&[(at + 4 * i, &value.to_ne_bytes())]);
                assert!(message.contains(" is ") && message.contains("; "), "{message}");
            }
        }
    });
}

#[test]
fn every_flag_is_checked() {
    each_array(|array, at, count| {
        // Newer engines have the flags 3 and 4 for frames.
        let invalid = if cfg!(engine_since = "3.5.0") { 5 } else { 3 };
        if array.element == 1 && !["tex_rgb", "tex_data", "names", "paths", "text_data"].contains(&array.name) {
            assert!(count > 0 || is_absent(array), "every_element.xml has no {}", array.name);
            for i in 0..count {
                let expected = format!("{}[{i}] is {invalid}; it must be", array.name);
                assert!(rejection(&[(at + i, &[invalid])]).starts_with(&expected));
            }
        }
    });
}

/// Returns the valid file.
#[cfg(engine_since = "3.5.0")]
pub(super) fn every_element_file() -> &'static [u8] {
    every_element()
}

/// Calls `visit` with each array of `int`, its offset and its length.
#[cfg(engine_since = "3.5.0")]
pub(super) fn each_integer_array(mut visit: impl FnMut(&Array, usize, usize)) {
    each_array(|array, at, count| {
        if array.element == 4 && is_integer(array) {
            visit(array, at, count);
        }
    });
}

/// Calls `visit` with each array, its offset and its length.
fn each_array(mut visit: impl FnMut(&Array, usize, usize)) {
    let view = valid();
    let mut at = view.position(field::qpos0, 0);
    for array in MODEL_ARRAYS {
        let bytes = super::view::array_bytes(array, view.sizes()) as usize;
        visit(array, at, bytes / array.element);
        at += bytes;
    }
}

/// Returns `true` if an array belongs to a feature that binary models must not have.
fn is_absent(array: &Array) -> bool {
    #[cfg(engine_since = "3.5.0")]
    let absent = array.rows.size.is_some_and(super::newer::is_absent);
    #[cfg(not(engine_since = "3.5.0"))]
    let absent = array.name.is_empty();
    absent
}

/// Returns `true` if an array of four-byte elements has integers. The other such arrays in the file
/// have floats.
fn is_integer(array: &Array) -> bool {
    let row = FIELDS.lines().find_map(|line| {
        let row: Vec<&str> = line.split('\t').collect();
        (row[0] == "Model" && row[3] == array.name).then(|| row[2].to_owned())
    });
    row.as_deref() == Some("int")
}

#[test]
fn the_kinematic_tree_follows_from_the_parents() {
    assert_eq!(with(field::body_parentid, 3, 3), "body_parentid[3] is 3; it must be from 0 to 2");
    assert_eq!(with(field::body_parentid, 0, 1), "body_parentid[0] is 1; it must be 0, which is the world itself");
    // Body 4 is a child of body 3. Body 5 is a child of body 1, so no later body can be a child of
    // body 3.
    assert!(with(field::body_parentid, 5, 0).contains("body_rootid[5]"));
    assert!(with(field::body_parentid, 6, 3).contains("bodies must be in depth-first order"));
    assert!(with(field::body_weldid, 4, 4).contains("it must be 3, the next body towards the world that has joints"));
    assert_eq!(with(field::body_jntnum, 1, 2), "jnt_bodyid[1] is 2; it must be 1, the body of the joint");
    assert!(with(field::jnt_type, 1, 0).contains("a free joint must be the only joint"));
    assert_eq!(with(field::jnt_type, 0, 1), "dof_bodyid[1] is 2; it must be 1, the body of its joint");
    assert!(with(field::dof_Madr, 5, 1).contains("the end of the previous row"));
    assert!(with(field::dof_simplenum, 0, 1).contains("dof_simplenum[0] is 1; it must be 0"));
}

#[test]
fn a_body_that_is_coupled_to_another_is_never_simple() {
    let view = valid();
    let body = 1;
    assert_eq!(
        rejection(&[(view.position(field::body_simple, body), &[1])]),
        "body_simple[1] is 1; it must be 0, because the body is coupled to another moving body"
    );
}

#[test]
fn a_geom_has_the_data_that_its_type_requires() {
    assert_eq!(with(field::geom_type, 3, 7_000_000), "geom_type[3] is 7000000; it must be from 0 to 7");
    let mesh = find(field::geom_type, 7);
    assert_eq!(with(field::geom_dataid, mesh, -1), format!("geom_dataid[{mesh}] is -1; it must be from 0 to 3"));
    let sphere = find(field::geom_type, 2);
    if cfg!(not(engine_since = "3.5.0")) {
        assert!(with(field::geom_dataid, sphere, 0).contains("because only meshes and height fields have data"));
    }
    assert!(with(field::geom_type, sphere, 0).contains("planes and height fields cannot"));
    assert_eq!(with(field::geom_condim, 0, 2), "geom_condim[0] is 2; it must be 1, 3, 4 or 6");
    assert_eq!(with(field::site_type, 0, 7), "site_type[0] is 7; it must be from 2 to 6");
}

#[test]
fn a_convex_hull_refers_to_its_mesh_and_is_terminated() {
    assert!(with(field::mesh_graph, 0, 0).contains("mesh_graph[0] is 0; it must be from 1 to 6"));
    assert!(with(field::mesh_graph, 1, 1_000_000).contains("the hull of mesh 0 needs 6000020 from 0 on"));
    // Six vertices and eight faces: addresses at 2, ids at 8, lists at 14, faces at 44.
    assert_eq!(with(field::mesh_graph, 2, 30), "mesh_graph[2] is 30; it must be from 0 to 29");
    assert_eq!(with(field::mesh_graph, 8, 6), "mesh_graph[8] is 6; it must be from 0 to 5");
    assert_eq!(
        with(field::mesh_graph, 43, 0),
        "mesh_graph[43] is 0; it must be -1, the end of the last list of neighbours"
    );
    assert_eq!(with(field::mesh_graph, 44, -1), "mesh_graph[44] is -1; it must be from 0 to 5");
}

#[test]
fn a_vertex_that_is_never_the_support_point_is_rejected() {
    let at = valid().position(field::mesh_vert, 7);
    assert_eq!(
        rejection(&[(at, &f32::NAN.to_ne_bytes())]),
        "mesh_vert[7] is NaN; it must be within 1000000000 of zero"
    );
}

#[test]
fn a_tendons_path_follows_the_compilers_grammar() {
    let view = valid();
    let (site, pulley, sphere) = (3, 2, 4);
    // The cable: site, cylinder, site, pulley, site, sphere, site, site.
    let cable = (0..view.len(field::tendon_num)).find(|&i| view.get(field::tendon_num, i) == 8).unwrap();
    let start = view.get(field::tendon_adr, cable) as usize;
    assert!(with(field::wrap_type, start + 3, site).contains("wrap_objid"));
    let at = |i: usize| view.position(field::wrap_type, start + i);
    let object = |i: usize| view.position(field::wrap_objid, start + i);
    let make_pulley = |i: usize| rejection(&[(at(i), &i32::to_ne_bytes(pulley)), (object(i), &(-1_i32).to_ne_bytes())]);
    assert!(make_pulley(7).contains("a pulley must be followed by a site"));
    assert!(make_pulley(2).contains("a geom must have sites on both sides"));
    assert!(make_pulley(0).contains("a geom must have sites on both sides"));
    let ball = view.get(field::wrap_objid, start + 5);
    let geom_at_end = rejection(&[(at(7), &i32::to_ne_bytes(sphere)), (object(7), &ball.to_ne_bytes())]);
    assert!(geom_at_end.contains("wrap_prm") || geom_at_end.contains("on both sides"), "{geom_at_end}");
    for side in [0.5, -2.0, 1e9, f64::NAN] {
        assert!(with_real(field::wrap_prm, start + 1, side).contains("it must be -1 or the id of one of"));
    }
}

#[test]
fn a_joint_that_is_twice_in_a_fixed_tendon_is_rejected() {
    let view = valid();
    let first = find(field::wrap_type, 1);
    let joint = view.get(field::wrap_objid, first);
    let message = with(field::wrap_objid, first + 1, joint);
    assert!(message.ends_with("already contains that joint"), "{message}");
}

#[test]
#[cfg(not(engine_since = "3.5.0"))]
fn actuators_with_an_activation_are_the_last_ones() {
    assert!(with(field::actuator_dyntype, 0, 1).contains("exactly the last 5 of 15 actuators have an activation"));
    assert!(with(field::actuator_dyntype, 14, 0).contains("exactly the last 5 of 15 actuators have an activation"));
    assert_eq!(
        with(field::actuator_trnid, 1, 3),
        "actuator_trnid[1] is 3; it must be -1, because only slider-cranks and sites have a second site"
    );
}

#[test]
#[cfg(not(engine_since = "3.5.0"))]
fn an_adhesive_actuator_needs_room_for_constraints() {
    assert_eq!(with_size(size::njmax, 0), "njmax is 0; actuator 9 is adhesive and needs the constraints of contacts");
}

#[test]
fn a_sensor_agrees_with_its_type() {
    let touch = find(field::sensor_type, 0);
    assert_eq!(
        with(field::sensor_dim, touch, 2),
        format!("sensor_dim[{touch}] is 2; it must be 1, as for all sensors of type 0")
    );
    assert!(with(field::sensor_needstage, touch, 1).contains("it must be 3"));
    assert!(with(field::sensor_objtype, touch, 5).contains("it must be 6, the type of object"));
    let scalar = find(field::sensor_type, mujoco_sys::mjSENS_JOINTPOS as i32);
    let ball = find(field::jnt_type, 1) as i32;
    assert!(with(field::sensor_objid, scalar, ball).contains("it must be a slide or hinge joint"));
    // The engine normalises four values of a quaternion sensor, regardless of their number.
    let user = valid().values(field::sensor_type).rposition(|kind| kind == mujoco_sys::mjSENS_USER as i32).unwrap();
    assert!(with(field::sensor_datatype, user, 3).contains("it must be 4, because it is a quaternion"));
    assert!(with_size(size::nsensordata, 90).contains("nsensordata"));
}

#[test]
fn texts_and_names_are_terminated() {
    let view = valid();
    let text = view.position(field::text_data, 0);
    assert_eq!(rejection(&[(text + 21, b"x")]), "text[0] is 22 bytes long; it has no terminating NUL");
    assert_eq!(rejection(&[(text + 3, b"\0")]), "text[0] is 22 bytes long; it has a NUL after 3 bytes");
    let names = view.position(field::names, 0);
    let last = view.size(size::nnames) - 1;
    assert_eq!(rejection(&[(names + last, b"x")]), format!("nnames is {}; the names do not end with a NUL", last + 1));
    assert!(rejection(&[(names + 3, b"\0")]).contains("it must be 4, the end of the previous name"));
}
