//! Tests of the guard: an engine error becomes a return code with the error's text, and the engine
//! remains usable.

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
use mujoco_sys::{mjData, mjModel};

/// A ball on the floor, which gives the solver a contact, and a hinge with a motor. The engine's
/// stack has fewer bytes than one test raises errors.
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

/// True for the engines whose bindings are committed beside those of 2.2.2.
const NEWER: bool = mujoco_sys::mjVERSION_HEADER > 222;

/// An invalid value of every enum of the engine.
const UNKNOWN: c_int = 99;

/// A compiled model and its data, used by one thread.
struct Simulation {
    model: *mut mjModel,
    data: *mut mjData,
}

impl Simulation {
    fn new() -> Self {
        install();
        let model = load(MODEL).expect("the model is valid");
        let mut data = ptr::null_mut();
        // SAFETY: the model is loaded, and the result is written to a local variable.
        let code = unsafe { guard::mj_make_data(model, &raw mut data) };
        assert_eq!(code, OK);
        assert!(!data.is_null());
        Self { model, data }
    }

    fn step(&self) -> Result<(), String> {
        // SAFETY: both live as long as `self`, the data belongs to this model, and no other thread
        // uses them.
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

    /// Makes the computation of the motor's transmission fail while the engine's stack is in use.
    fn set_transmission(&self, transmission: c_int) {
        // SAFETY: the model lives as long as `self` and has one actuator.
        unsafe { *(*self.model).actuator_trntype = transmission };
    }

    fn stack_top(&self) -> usize {
        // SAFETY: the data lives as long as `self`.
        unsafe { (*self.data).pstack as usize }
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        // SAFETY: the engine allocated both, and they are freed once.
        unsafe {
            mujoco_sys::mj_deleteData(self.data);
            mujoco_sys::mj_deleteModel(self.model);
        }
    }
}

/// Installs the guards' handler and this file's callback, once, before the first engine call.
fn install() {
    static INSTALLED: OnceLock<()> = OnceLock::new();
    INSTALLED.get_or_init(|| {
        // SAFETY: every test calls this function before its first engine call, so no thread reads
        // the two global pointers now.
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
    fs::write(&file, xml).expect("the test directory is writable");
    let name = CString::new(file.to_str().expect("a path of UTF-8")).expect("a path without NUL");
    let mut error = [0 as c_char; 300];
    let mut model = ptr::null_mut();
    // SAFETY: the name and the buffer of the given length outlive the call. A null virtual file
    // system makes the engine read the file.
    let code = unsafe {
        guard::mj_load_xml(name.as_ptr(), ptr::null(), error.as_mut_ptr(), error.len() as c_int, &raw mut model)
    };
    fs::remove_file(&file).expect("the file was written above");
    result(code)?;
    if model.is_null() {
        // SAFETY: the engine terminates its text with NUL within the given length.
        let text = unsafe { CStr::from_ptr(error.as_ptr()) };
        return Err(text.to_string_lossy().into_owned());
    }
    Ok(model)
}

/// Converts a return code into a result with the error's text.
fn result(code: c_int) -> Result<(), String> {
    match code {
        OK => Ok(()),
        ERROR => Err(message()),
        other => Err(format!("code {other}: {}", message())),
    }
}

fn message() -> String {
    // SAFETY: the text belongs to this thread and is copied before this thread's next guarded call.
    unsafe { CStr::from_ptr(guard::message()) }.to_string_lossy().into_owned()
}

/// Asserts that a call failed with an error that contains `text`. Newer engines name the function
/// first, and use small letters.
#[track_caller]
fn assert_error(outcome: &Result<(), String>, text: &str) {
    assert!(outcome.as_ref().is_err_and(|error| error.to_lowercase().contains(text)), "{text}: {outcome:?}");
}

thread_local! {
    /// Task of this thread's callback, and its outcome.
    static CALLBACK: Cell<Callback> = const { Cell::new(Callback::Idle) };
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Callback {
    Idle,
    /// Step this simulation, whose model is invalid.
    Step(*mut mjModel, *mut mjData),
    /// Compute the forward dynamics of the outer call's data with this invalid model.
    ForwardOuterData(*mut mjModel),
    /// Return code of the inner call, and the stack top of the outer data before and after it.
    Done {
        code: c_int,
        before: usize,
        after: usize,
    },
}

unsafe extern "C" fn control(_: *const mjModel, data: *mut mjData) {
    // The inner call invokes this callback too, with nothing left to do.
    let task = CALLBACK.replace(Callback::Idle);
    // SAFETY: the engine passes the data of the current call.
    let top = || unsafe { (*data).pstack as usize };
    let before = top();
    let code = match task {
        Callback::Idle | Callback::Done { .. } => return,
        // SAFETY: the test that set the task keeps model and data alive during the step.
        Callback::Step(model, inner) => unsafe { guard::mj_step(model, inner) },
        // SAFETY: the model has the sizes of the outer call's model and lives during the step.
        Callback::ForwardOuterData(model) => unsafe { guard::mj_forward(model, data) },
    };
    CALLBACK.set(Callback::Done { code, before, after: top() });
}

#[test]
fn the_loaded_engine_has_the_version_of_the_headers() {
    install();
    let mut version = 0;
    // SAFETY: the result is written to a local variable.
    let code = unsafe { guard::mj_version(&raw mut version) };
    assert_eq!((code, version), (OK, mujoco_sys::mjVERSION_HEADER as c_int));
}

#[test]
fn an_engine_error_is_returned_with_its_text() {
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert_error(&simulation.step(), "invalid integrator");
}

#[test]
fn the_engine_works_again_after_the_cause_of_an_error_is_removed() {
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert!(simulation.step().is_err());
    simulation.set_integrator(mujoco_sys::mjINT_EULER as c_int);
    assert_eq!(simulation.step(), Ok(()));
}

#[test]
fn an_invalid_model_is_a_loader_message_and_not_an_engine_error() {
    install();
    let message = load("<mujoco><worldbody><body/><geom/></worldbody></mujoco>").expect_err("a geom without a size");
    assert!(message.contains("size"), "{message}");
}

#[test]
fn an_engine_error_inside_the_loader_leaves_the_thread_able_to_load_and_to_step() {
    install();
    // The stack is too small for the forward computation during compilation.
    let (stack, small) = (r#"nstack="5000""#, if NEWER { r#"memory="1""# } else { r#"nstack="1""# });
    let loaded = load(&MODEL.replace(stack, small)).map(drop);
    // The text of 3.0.0 to 3.2.6 differs.
    let text =
        if (300..327).contains(&mujoco_sys::mjVERSION_HEADER) { "insufficient memory" } else { "stack overflow" };
    assert_error(&loaded, text);
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert_error(&simulation.step(), "invalid integrator");
}

#[test]
fn out_of_memory_in_the_loader_is_a_code_and_leaves_the_thread_able_to_load_and_to_step() {
    const LIMITED: &str = "MUJOCO_SYS_TEST_LIMITED";
    if !env!("MUJOCO_SYS_INCLUDE").starts_with("/usr/include") {
        // The C++ runtime inside the official libraries ends the process instead of throwing
        // std::bad_alloc.
        return;
    }
    if std::env::var_os(LIMITED).is_none() {
        // Runs this test again in a child process with a memory limit; without one, the test would
        // exhaust the machine's memory.
        let output = Command::new("sh")
            .args(["-c", r#"ulimit -v 4000000 && exec "$0" --exact "$1""#])
            .arg(std::env::current_exe().expect("a test is a program"))
            .arg("out_of_memory_in_the_loader_is_a_code_and_leaves_the_thread_able_to_load_and_to_step")
            .env(LIMITED, "1")
            .output()
            .expect("the shell runs");
        let stdout = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && stdout.contains("1 passed"), "{output:?}");
        return;
    }
    install();
    let outcome = load(&MODEL.replace("<worldbody>", r#"<size nuser_body="2147483647"/><worldbody>"#));
    assert_eq!(outcome, Err("code 2: out of memory".to_owned()));
    let simulation = Simulation::new();
    simulation.set_integrator(UNKNOWN);
    assert_error(&simulation.step(), "invalid integrator");
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[test]
fn a_capture_stores_the_output_of_its_thread_and_forwards_that_of_others() {
    unsafe extern "C" {
        #[link_name = "stderr"]
        static STDERR: *mut std::ffi::c_void;
        fn fputs(text: *const c_char, file: *mut std::ffi::c_void) -> c_int;
    }
    const CHILD: &str = "MUJOCO_SYS_TEST_PRINTS";
    const LINES: usize = 20_000;
    // The convex hull library prints 28 lines about this mesh.
    const FLAT: &str = "<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 1 1 0'/></asset>
        <worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>";
    if std::env::var_os(CHILD).is_none() {
        let output = Command::new(std::env::current_exe().expect("a test is a program"))
            .args(["--exact", "--nocapture", "a_capture_stores_the_output_of_its_thread_and_forwards_that_of_others"])
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
                // SAFETY: the string is terminated by NUL, and the stream is the current value of
                // the C library's variable.
                unsafe { fputs(c"printed\n".as_ptr(), ptr::read_volatile(&raw const STDERR)) };
                lines.fetch_add(1, Ordering::Relaxed);
            }
        });
        for _ in 0..2 {
            scope.spawn(|| {
                let mut loads = 0;
                while loads < 20 || lines.load(Ordering::Relaxed) < LINES as u32 {
                    let (message, printed) =
                        mujoco_sys::stderr::captured(|| load(FLAT).expect_err("a flat mesh has no convex hull"));
                    // Newer engines find the flat mesh before they call the library.
                    let is_from_library =
                        message.contains("qhull error") && printed.contains("Initial simplex is flat");
                    assert!(is_from_library || message.contains("coplanar"), "{message} {printed}");
                    assert!(!printed.contains("printed"));
                    loads += 1;
                }
            });
        }
    });
}

#[test]
fn an_error_restores_the_stack_top() {
    let simulation = Simulation::new();
    simulation.set_transmission(UNKNOWN);
    let before = simulation.stack_top();
    assert!(simulation.step().is_err());
    assert_eq!(simulation.stack_top(), before);
}

#[test]
fn after_an_error_no_count_exceeds_its_array() {
    let simulation = Simulation::new();
    assert_eq!(simulation.step(), Ok(()));
    // SAFETY: the data lives as long as `simulation`, and no other thread uses it.
    let data = unsafe { &mut *simulation.data };
    assert!(data.ncon > 0 && data.nefc > 0, "the sphere touches the plane");
    simulation.set_transmission(UNKNOWN);
    assert!(simulation.step().is_err());
    assert!(data.ncon == 0 || !data.contact.is_null());
    assert!(data.nefc == 0 || !(data.efc_J.is_null() || data.efc_force.is_null()));
    simulation.set_transmission(mujoco_sys::mjTRN_JOINT as c_int);
    assert_eq!(simulation.step(), Ok(()));
    assert!(data.ncon > 0 && data.nefc > 0 && !data.contact.is_null() && !data.efc_J.is_null());
}

/// Each of these errors is raised while the engine's stack is in use. Without the restoration the
/// stack would overflow.
#[test]
fn ten_thousand_errors_do_not_fill_the_engines_stack() {
    let simulation = Simulation::new();
    simulation.set_transmission(UNKNOWN);
    let first = simulation.step();
    assert_error(&first, "unknown transmission type");
    for count in 1..10_000 {
        assert_eq!(simulation.step(), first, "error {count}");
    }
}

#[test]
fn each_thread_keeps_its_own_error_text() {
    install();
    let start = Barrier::new(2);
    let fail = |expected: &str, invalidate: fn(&Simulation)| {
        let simulation = Simulation::new();
        invalidate(&simulation);
        start.wait();
        for _ in 0..1000 {
            assert_error(&simulation.step(), expected);
        }
    };
    thread::scope(|scope| {
        scope.spawn(|| fail("invalid integrator", |simulation| simulation.set_integrator(UNKNOWN)));
        scope.spawn(|| fail("unknown solver type 99", |simulation| simulation.set_solver(UNKNOWN)));
    });
}

#[test]
fn an_error_inside_a_callback_ends_the_inner_call_and_not_the_outer_one() {
    let (outer, inner) = (Simulation::new(), Simulation::new());
    inner.set_integrator(UNKNOWN);
    CALLBACK.set(Callback::Step(inner.model, inner.data));
    assert_eq!(outer.step(), Ok(()));
    assert!(matches!(CALLBACK.get(), Callback::Done { code: ERROR, .. }), "{:?}", CALLBACK.get());
    assert_error(&Err(message()), "invalid integrator");
    // The outer guard has left the chain: the next error returns from its own call.
    outer.set_integrator(UNKNOWN);
    assert_error(&outer.step(), "invalid integrator");
}

#[test]
fn an_error_inside_a_callback_restores_the_stack_top_at_its_own_entry() {
    let (outer, invalid) = (Simulation::new(), Simulation::new());
    invalid.set_transmission(UNKNOWN);
    CALLBACK.set(Callback::ForwardOuterData(invalid.model));
    // The outer call uses the stack when it reaches the callback.
    let none = ptr::null_mut();
    // SAFETY: both live as long as `outer`, and null matrices are not computed.
    let code = unsafe { guard::mjd_transition_fd(outer.model, outer.data, 1e-6, 0, none, none, none, none) };
    assert_eq!(result(code), Ok(()));
    let Callback::Done { code, before, after } = CALLBACK.get() else { panic!("the callback was not called") };
    assert!(before > 0);
    assert_eq!((code, after), (ERROR, before));
    assert_error(&Err(message()), "unknown transmission type");
}

#[test]
fn after_an_inner_error_an_error_of_the_outer_call_reaches_the_outer_guard() {
    let (outer, inner) = (Simulation::new(), Simulation::new());
    inner.set_transmission(UNKNOWN);
    // The callback runs before the solver.
    outer.set_solver(UNKNOWN);
    CALLBACK.set(Callback::Step(inner.model, inner.data));
    assert_error(&outer.step(), "unknown solver type 99");
    assert!(matches!(CALLBACK.get(), Callback::Done { code: ERROR, .. }), "{:?}", CALLBACK.get());
}
