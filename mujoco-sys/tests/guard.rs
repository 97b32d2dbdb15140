//! The guard: an error of the engine comes back as a return code with its text, and the engine goes on working.

use std::cell::Cell;
use std::ffi::{CStr, CString};
use std::fs;
use std::os::raw::{c_char, c_int};
use std::path::Path;
use std::process::Command;
use std::ptr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Barrier, OnceLock};
use std::thread;

use mujoco_sys::guard::{self, ERROR, OK};
use mujoco_sys::{mjData, mjModel, stderr};

/// A ball that lies on the floor (so that the solver has work) and a hinge with a motor. The engine's stack is smaller than the
/// number of errors that a test makes it survive.
const MODEL: &str = r#"
<mujoco>
  <size nstack="5000"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="0 0 0.099"><freejoint/><geom size="0.1"/></body>
    <body pos="0 0 1"><joint name="hinge" axis="0 1 0"/><geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/></body>
  </worldbody>
  <actuator><motor joint="hinge"/></actuator>
</mujoco>"#;

/// A number that no enum of the engine has.
const UNKNOWN: c_int = 99;

/// A compiled model and one data of it, for one thread.
struct Simulation {
    model: *mut mjModel,
    data: *mut mjData,
}

impl Simulation {
    fn new() -> Self {
        install();
        let model = load(MODEL).expect("the model is valid");
        let mut data = ptr::null_mut();
        // SAFETY: the model was loaded just now and the result goes to a local variable.
        let code = unsafe { guard::mj_make_data(model, &raw mut data) };
        assert_eq!(code, OK);
        assert!(!data.is_null());
        Self { model, data }
    }

    fn step(&self) -> Result<(), String> {
        // SAFETY: both live as long as `self`, the data was made for this model, and no other thread has them.
        result(unsafe { guard::mj_step(self.model, self.data) })
    }

    fn set_integrator(&self, integrator: c_int) {
        // SAFETY: the model lives as long as `self`.
        unsafe { (*self.model).opt.integrator = integrator };
    }

    fn set_solver(&self, solver: c_int) {
        // SAFETY: the model lives as long as `self`.
        unsafe { (*self.model).opt.solver = solver };
    }

    /// Makes the computation of the motor's transmission fail, in the middle of work on the engine's stack.
    fn set_transmission(&self, transmission: c_int) {
        // SAFETY: the model lives as long as `self` and has one actuator.
        unsafe { *(*self.model).actuator_trntype = transmission };
    }

    fn stack_mark(&self) -> usize {
        // SAFETY: the data lives as long as `self`.
        unsafe { (*self.data).pstack as usize }
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        // SAFETY: both came from the engine and are freed once.
        unsafe {
            mujoco_sys::mj_deleteData(self.data);
            mujoco_sys::mj_deleteModel(self.model);
        }
    }
}

/// Installs the guards' handler and the callback of this file, once and before any engine is at work.
fn install() {
    static INSTALLED: OnceLock<()> = OnceLock::new();
    INSTALLED.get_or_init(|| {
        // SAFETY: every test comes here before it lets the engine work, so that nobody reads the two global pointers now.
        unsafe {
            guard::install(None);
            mujoco_sys::mjcb_control = Some(control);
        }
    });
}

/// Loads a model from a file that holds `xml`.
fn load(xml: &str) -> Result<*mut mjModel, String> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let file = directory.join(format!("guard-{}-{number}.xml", std::process::id()));
    fs::write(&file, xml).expect("the directory for tests' files can be written to");
    let name = CString::new(file.to_str().expect("a path of UTF-8")).expect("a path without NUL");
    let mut error = [0 as c_char; 300];
    let mut model = ptr::null_mut();
    // SAFETY: the name and the buffer, whose length is given, outlive the call; without a virtual file system the engine reads
    // the file.
    let code = unsafe {
        guard::mj_load_xml(name.as_ptr(), ptr::null(), error.as_mut_ptr(), error.len() as c_int, &raw mut model)
    };
    fs::remove_file(&file).expect("the file was written above");
    result(code)?;
    if model.is_null() {
        // SAFETY: the engine ends its text with NUL, within the length it was given.
        let text = unsafe { CStr::from_ptr(error.as_ptr()) };
        return Err(text.to_string_lossy().into_owned());
    }
    Ok(model)
}

/// A guarded call's code, with the text of the error.
fn result(code: c_int) -> Result<(), String> {
    match code {
        OK => Ok(()),
        ERROR => Err(message()),
        other => Err(format!("code {other}: {}", message())),
    }
}

fn message() -> String {
    // SAFETY: the text belongs to this thread and is copied before the next guarded call.
    unsafe { CStr::from_ptr(guard::message()) }.to_string_lossy().into_owned()
}

fn error(text: &str) -> Result<(), String> {
    Err(text.to_owned())
}

thread_local! {
    /// What the callback does in this thread, and what came of it.
    static CALLBACK: Cell<Callback> = const { Cell::new(Callback::Idle) };
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Callback {
    Idle,
    /// Step this simulation, whose model is broken.
    Step(*mut mjModel, *mut mjData),
    /// Compute the forward dynamics of the data that the outer call works on, with this broken model.
    ForwardOuterData(*mut mjModel),
    /// The code of the inner call, and the outer data's stack mark before and after it.
    Done {
        code: c_int,
        before: usize,
        after: usize,
    },
}

unsafe extern "C" fn control(_: *const mjModel, data: *mut mjData) {
    // The inner call comes here too, and then finds nothing to do.
    let task = CALLBACK.replace(Callback::Idle);
    // SAFETY: the engine calls with the data it works on.
    let mark = || unsafe { (*data).pstack as usize };
    let before = mark();
    let code = match task {
        Callback::Idle | Callback::Done { .. } => return,
        // SAFETY: the test that set the task keeps model and data alive during its step.
        Callback::Step(model, inner) => unsafe { guard::mj_step(model, inner) },
        // SAFETY: the model is that of the outer call or has its sizes, and lives during the step.
        Callback::ForwardOuterData(model) => unsafe { guard::mj_forward(model, data) },
    };
    CALLBACK.set(Callback::Done { code, before, after: mark() });
}

#[test]
fn the_engine_that_runs_is_the_version_of_the_header() {
    install();
    let mut version = 0;
    // SAFETY: the result goes to a local variable.
    let code = unsafe { guard::mj_version(&raw mut version) };
    assert_eq!((code, version), (OK, mujoco_sys::mjVERSION_HEADER as c_int));
}

#[test]
fn an_engine_error_comes_back_with_its_text() {
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert_eq!(simulation.step(), error("Invalid integrator"));
}

#[test]
fn once_its_cause_is_gone_the_engine_works_again() {
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert!(simulation.step().is_err());
    simulation.set_integrator(mujoco_sys::mjINT_EULER as c_int);
    assert_eq!(simulation.step(), Ok(()));
}

#[test]
fn a_mistake_in_a_model_is_told_by_the_loader_and_is_no_engine_error() {
    install();
    let told = load("<mujoco><worldbody><body/><geom/></worldbody></mujoco>").expect_err("a geom without a size");
    assert!(told.contains("size"), "{told}");
}

#[test]
fn an_engine_error_inside_the_loader_leaves_the_thread_able_to_load_and_to_step() {
    install();
    // The stack is too small for the first forward computation, which the compiler makes.
    let told = load(&MODEL.replace("5000", "1")).expect_err("too small a stack");
    assert!(told.contains("Stack overflow"), "{told}");
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert_eq!(simulation.step(), error("Invalid integrator"));
}

#[test]
fn out_of_memory_in_the_loader_is_a_code_and_leaves_the_thread_able_to_load_and_to_step() {
    const LIMITED: &str = "MUJOCO_SYS_TEST_LIMITED";
    if std::env::var_os(LIMITED).is_none() {
        // Without a limit of its own, the process would take all memory there is: this test alone, again, in a process with one.
        let output = Command::new("sh")
            .args(["-c", r#"ulimit -v 4000000 && exec "$0" --exact "$1""#])
            .arg(std::env::current_exe().expect("a test is a program"))
            .arg("out_of_memory_in_the_loader_is_a_code_and_leaves_the_thread_able_to_load_and_to_step")
            .env(LIMITED, "1")
            .output()
            .expect("there is a shell");
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.contains("1 passed"), "{output:?}");
        return;
    }
    install();
    let told = load(&MODEL.replace("<worldbody>", r#"<size nuser_body="2147483647"/><worldbody>"#));
    assert_eq!(told, Err("code 2: out of memory".to_owned()));
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert_eq!(simulation.step(), error("Invalid integrator"));
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[test]
fn a_capture_keeps_what_its_thread_prints_and_other_threads_print_as_before() {
    unsafe extern "C" {
        #[link_name = "stderr"]
        static STDERR: *mut std::ffi::c_void;
        fn fputs(text: *const c_char, file: *mut std::ffi::c_void) -> c_int;
    }
    const CHILD: &str = "MUJOCO_SYS_TEST_PRINTS";
    const LINES: usize = 20_000;
    // The convex hull library prints 28 lines about it.
    const FLAT: &str = "<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 1 1 0'/></asset>
        <worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>";
    if std::env::var_os(CHILD).is_none() {
        let output = Command::new(std::env::current_exe().expect("a test is a program"))
            .args([
                "--exact",
                "--nocapture",
                "a_capture_keeps_what_its_thread_prints_and_other_threads_print_as_before",
            ])
            .env(CHILD, "1")
            .output()
            .expect("the program runs");
        assert!(output.status.success(), "{output:?}");
        assert!(output.stderr == "printed\n".repeat(LINES).as_bytes(), "{}", String::from_utf8_lossy(&output.stderr));
        return;
    }
    install();
    let lines = AtomicU32::new(0);
    thread::scope(|scope| {
        scope.spawn(|| {
            for _ in 0..LINES {
                // SAFETY: a string that ends with NUL, and the stream that the C library's variable has at the moment.
                unsafe { fputs(c"printed\n".as_ptr(), ptr::read_volatile(&raw const STDERR)) };
                lines.fetch_add(1, Ordering::Relaxed);
            }
        });
        for _ in 0..2 {
            scope.spawn(|| {
                let mut loads = 0;
                while loads < 20 || lines.load(Ordering::Relaxed) < LINES as u32 {
                    let (told, printed) = stderr::captured(|| load(FLAT).expect_err("a flat mesh has no convex hull"));
                    assert!(
                        told.contains("qhull error") && printed.contains("Initial simplex is flat"),
                        "{told} {printed}"
                    );
                    assert!(!printed.contains("printed"));
                    loads += 1;
                }
            });
        }
    });
}

#[test]
fn after_an_error_the_stack_mark_is_where_it_was() {
    let simulation = Simulation::new();
    simulation.set_transmission(UNKNOWN);
    let before = simulation.stack_mark();
    assert!(simulation.step().is_err());
    assert_eq!(simulation.stack_mark(), before);
}

/// Each of these errors is raised while the engine's stack holds something: with the mark left there, the stack would be full
/// before the end.
#[test]
fn ten_thousand_errors_do_not_fill_the_engines_stack() {
    let simulation = Simulation::new();
    simulation.set_transmission(UNKNOWN);
    let first = simulation.step();
    assert!(first.as_ref().is_err_and(|text| text.contains("Unknown transmission type")), "{first:?}");
    for count in 1..10_000 {
        assert_eq!(simulation.step(), first, "error {count}");
    }
}

#[test]
fn two_threads_that_fail_at_once_each_keep_their_own_text() {
    install();
    let start = Barrier::new(2);
    let fail = |expected: &str, break_it: fn(&Simulation)| {
        let simulation = Simulation::new();
        break_it(&simulation);
        start.wait();
        for count in 0..1000 {
            assert_eq!(simulation.step(), error(expected), "error {count}");
        }
    };
    thread::scope(|scope| {
        scope.spawn(|| fail("Invalid integrator", |simulation| simulation.set_integrator(UNKNOWN)));
        scope.spawn(|| fail("Unknown solver type 99", |simulation| simulation.set_solver(UNKNOWN)));
    });
}

#[test]
fn an_error_inside_a_callback_ends_the_inner_call_and_not_the_outer_one() {
    let (outer, inner) = (Simulation::new(), Simulation::new());
    inner.set_integrator(UNKNOWN);
    CALLBACK.set(Callback::Step(inner.model, inner.data));
    assert_eq!(outer.step(), Ok(()));
    assert!(matches!(CALLBACK.get(), Callback::Done { code: ERROR, .. }), "{:?}", CALLBACK.get());
    assert_eq!(message(), "Invalid integrator");
    // The outer guard is out of the chain again: the next error goes to its own call.
    outer.set_integrator(UNKNOWN);
    assert_eq!(outer.step(), error("Invalid integrator"));
}

#[test]
fn an_error_inside_a_callback_restores_the_mark_of_its_own_entry() {
    let (outer, broken) = (Simulation::new(), Simulation::new());
    broken.set_transmission(UNKNOWN);
    CALLBACK.set(Callback::ForwardOuterData(broken.model));
    // The outer call has work on the stack when it comes to the callback.
    let none = ptr::null_mut();
    // SAFETY: both live as long as `outer`, and matrices that are null are not asked for.
    let code = unsafe { guard::mjd_transition_fd(outer.model, outer.data, 1e-6, 0, none, none, none, none) };
    assert_eq!(result(code), Ok(()));
    let Callback::Done { code, before, after } = CALLBACK.get() else { panic!("the callback was not called") };
    assert!(before > 0);
    assert_eq!((code, after), (ERROR, before));
    assert!(message().contains("Unknown transmission type"), "{}", message());
}

#[test]
fn after_an_inner_error_an_error_of_the_outer_call_reaches_the_outer_guard() {
    let (outer, inner) = (Simulation::new(), Simulation::new());
    inner.set_transmission(UNKNOWN);
    // The callback runs before the solver does.
    outer.set_solver(UNKNOWN);
    CALLBACK.set(Callback::Step(inner.model, inner.data));
    assert_eq!(outer.step(), error("Unknown solver type 99"));
    assert!(matches!(CALLBACK.get(), Callback::Done { code: ERROR, .. }), "{:?}", CALLBACK.get());
}
