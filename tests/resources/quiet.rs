//! The engine prints nothing, writes no `MUJOCO_LOG.TXT` and does not wait for Enter: the test runs
//! in a child process in an empty folder, with an empty pipe as standard input. The parent checks
//! the output, the files and the exit status.

#![forbid(unsafe_code)]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::Stdio;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use mujoco_safe::data::Warning;
use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
use mujoco_safe::{Data, Error, Model, sample};

use crate::{child, lock_process, trouble};

/// Messages logged under the target `mujoco`.
static LOGGED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Number of engine errors in calls of the logger.
static ERRORS: AtomicUsize = AtomicUsize::new(0);

/// A logger that stores messages, calls the library, and panics.
struct Careless;

impl log::Log for Careless {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        let text = record.args().to_string();
        if record.target() == "mujoco" {
            LOGGED.lock().unwrap().push(text.clone());
        }
        if text.contains("NaN") {
            // During a load.
            let mut data = Data::new(sample::cartpole()).unwrap();
            data.step().unwrap();
            assert!(Model::from_xml_str("<mujoco><no/></mujoco>").is_err());
        }
        if text.contains("mixed solref") {
            // After a step. During the warning, engines since 3.10 would drop the error.
            let mut data = Data::new(trouble::overflowing()).unwrap();
            assert!((0..200).any(|_| data.step().is_err()));
            ERRORS.fetch_add(1, Ordering::Relaxed);
            panic!("a panic after a call of the engine");
        }
        assert!(!text.contains("contacts that nconmax allows"), "a panic outside of the engine");
    }

    fn flush(&self) {}
}

fn logged(part: &str) -> usize {
    LOGGED.lock().unwrap().iter().filter(|text| text.contains(part)).count()
}

/// Returns six balls on the floor, with small buffers for contacts and constraints.
fn crowded(size: &str) -> Data {
    let balls =
        [0, 1, 2, 3, 4, 5].map(|x| format!(r#"<body pos="{x} 0 .09"><freejoint/><geom size=".1"/></body>"#)).concat();
    let xml =
        format!(r#"<mujoco><size {size}/><worldbody><geom type="plane" size="9 9 1"/>{balls}</worldbody></mujoco>"#);
    Data::new(Model::from_xml_str(&xml).unwrap()).unwrap()
}

/// Loads meshes for which the convex hull library prints long errors, and a mesh for which it
/// prints a warning.
fn meshes_for_the_convex_hull_library() {
    for (heights, loads) in
        [(["0", "0", "0", "0"], false), (["1", "1", "1", "1"], false), (["0", "0", "0", "1e-7"], true)]
    {
        let [a, b, c, d] = heights;
        let result = Model::from_xml_str(&format!(
            "<mujoco><asset><mesh name='m' vertex='0 0 {a} 1 0 {b} 0 1 {c} 1 1 {d}'/></asset>
             <worldbody><geom type='mesh' mesh='m' mass='1'/></worldbody></mujoco>"
        ));
        match result {
            Ok(_) => assert!(loads),
            Err(error) => {
                let reason =
                    if cfg!(engine_since = "3.17.0") { "coplanar vertices" } else { "Initial simplex is flat" };
                assert!(!loads && error.to_string().contains(reason), "{error}");
            }
        }
    }
    // Newer compilers process several meshes in threads.
    let several = Model::from_xml_str(
        "<mujoco><asset><mesh name='a' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/><mesh name='b' vertex='0 0 0 .3 0 0 0 .3 1e13 0 0 .3'/></asset>
         <worldbody><geom type='mesh' mesh='a'/><geom type='mesh' mesh='b'/></worldbody></mujoco>",
    );
    assert!(several.is_err());
}

/// Exceeds the numbers of contacts and constraints, which newer engines do not limit. The warnings
/// are counted each time, and logged the first time, by a logger that panics at one of them.
fn warnings_of_full_arrays() {
    let mut data = crowded("nconmax='100' njmax='10'");
    for _ in 0..3 {
        data.step().unwrap();
    }
    assert_eq!(data.warning(Warning::ConstraintFull).number, 3);
    assert_eq!(data.warning(Warning::ConstraintFull).lastinfo, 10);
    assert_eq!(logged("constraints that njmax allows"), 1);
    let copy = data.clone();
    assert_eq!(copy.warning(Warning::ConstraintFull), data.warning(Warning::ConstraintFull));
    data.reset().unwrap();
    assert_eq!(data.warning(Warning::ConstraintFull).number, 0);
    data.forward().unwrap();
    assert_eq!(data.warning(Warning::ConstraintFull).number, 1);
    assert_eq!(logged("constraints that njmax allows"), 2);

    let mut data = crowded("nconmax='2' njmax='100'");
    let panic = catch_unwind(AssertUnwindSafe(|| data.step())).unwrap_err();
    assert!(panic.downcast_ref::<&str>().is_some_and(|text| text.contains("outside of the engine")));
    let counted = data.warning(Warning::ContactFull);
    assert!(counted.number >= 1 && counted.lastinfo == 2, "{counted:?}");
    data.step().unwrap();
    assert_eq!(data.warning(Warning::ContactFull).number, 2 * counted.number);
}

#[test]
fn everything_that_the_engine_would_print() {
    if !child::is_child() {
        return;
    }
    let print_panic = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // Except panics of the logger.
        if panic.payload_as_str().is_none_or(|text| !text.contains("of the engine")) {
            print_panic(panic);
        }
    }));
    log::set_logger(&Careless).unwrap();
    log::set_max_level(log::LevelFilter::Trace);

    // Failing loads, for each of which 2.2.2 prints.
    for xml in ["", "<mujoco", "<mujoco><no/></mujoco>", "<mujoco><include file=''/></mujoco>"] {
        assert!(Model::from_xml_str(xml).is_err());
    }
    assert!(Model::from_xml_path("missing.xml").is_err());
    assert!(Model::from_binary(b"not a model").is_err());
    assert!(Model::from_binary_path("missing.mjb").is_err());
    let stl = "<mujoco><asset><mesh name='m' file='missing.stl'/></asset></mujoco>";
    assert!(Model::from_xml_str(stl).is_err());
    assert!(trouble::with_stack(10).is_err());
    assert_eq!(LOGGED.lock().unwrap().len(), 0, "errors are not logged");

    meshes_for_the_convex_hull_library();

    // A warning of the compiler: stored in the model, and logged by a logger that loads models
    // itself.
    let model = Model::from_xml_str(
        "<mujoco><worldbody><body><joint/><geom size='.1' user='nan'/></body></worldbody></mujoco>",
    )
    .unwrap();
    assert!(model.compile_warnings()[0].contains("XML contains a 'NaN'"), "{:?}", model.compile_warnings());
    assert_eq!(logged("XML contains a 'NaN'"), 1);
    assert_eq!(model.clone().compile_warnings(), model.compile_warnings());
    assert!(sample::humanoid().compile_warnings().is_empty());

    if cfg!(not(engine_since = "2.3.0")) {
        warnings_of_full_arrays();
    }

    // A warning that the engine raises without a counter, during a step.
    let mut data = crowded("nconmax='100' njmax='100'");
    data.edit_model(|model| model.geom_solref_mut().as_flattened_mut().fill(-1.0)).unwrap();
    data.edit_model(|model| model.geom_solref_mut().iter_mut().for_each(|solref| *solref = [-1.0, 1.0])).unwrap();
    data.step().unwrap();
    assert!(logged("mixed solref") > 0);
    assert_eq!(ERRORS.load(Ordering::Relaxed), logged("mixed solref"));

    // A full scene, which is reported by the error.
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 3).unwrap();
    let mut camera = Camera::free(data.model());
    for _ in 0..2 {
        let updated = scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all());
        assert!(matches!(updated, Err(Error::SceneFull { .. })));
    }
    // Engines since 3.7 have no counter for it.
    let is_counted = mujoco_safe::sys::mjWARN_VGEOMFULL < mujoco_safe::sys::mjNWARNING;
    assert!(data.warning(Warning::VisualGeomFull).number >= 2 || !is_counted);
    assert_eq!(logged("room for"), 0);

    // Instability, to which the engine reacts with a reset and a line on standard output, and
    // engine errors.
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.qpos_mut()[0] = f64::NAN;
    assert!(matches!(data.step(), Err(Error::Unstable(_))));
    data.reset().unwrap();
    data.step().unwrap();
    data.qfrc_applied_mut()[0] = 1e300;
    assert!(matches!(data.step(), Err(Error::Unstable(_))));
    assert_eq!(data.warning(Warning::BadQacc).number, 1);
    assert!(matches!(data.step(), Err(Error::Poisoned { .. })));
    data.edit_model(|model| {
        model.body_mass_mut().fill(0.0);
        model.body_inertia_mut().as_flattened_mut().fill(0.0);
        model.dof_armature_mut().fill(0.0);
        model.dof_damping_mut().fill(0.0);
        let _ = model.update_constants();
        model.edit_options(|options| options.integrator = mujoco_safe::enums::Integrator::Implicit).unwrap();
    })
    .unwrap();
    data.reset().unwrap();
    let has_failed = data.step().is_err();
    // Newer engines only warn of the singular inertia matrix.
    assert!(has_failed || cfg!(engine_since = "2.3.0") && data.warning(Warning::Inertia).number > 0);

    assert!(sample::cartpole().save_xml("no/such/folder.xml").is_err());
    assert!(Path::new(".").read_dir().unwrap().next().is_none(), "a file was written");
    eprintln!("finished");
}

#[test]
fn the_engine_prints_writes_and_reads_nothing() {
    let folder = std::env::temp_dir().join(format!("mujoco_safe_quiet_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let _lock = lock_process();
    let mut child = child::command("quiet::everything_that_the_engine_would_print")
        .current_dir(&folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The pipe stays open, so that a process that reads from it blocks until the time limit.
    let stdin = child.stdin.take();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("the process is blocked");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let output = child.wait_with_output().unwrap();
    drop(stdin);
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{stdout}{stderr}");

    assert_eq!(child::printed(&stdout), Vec::<&str>::new());
    assert_eq!(stderr, "finished\n");
    let files: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(files, Vec::<std::ffi::OsString>::new());
    std::fs::remove_dir(&folder).unwrap();
}
