//! End-to-end tests of the viewer: keyboard and mouse input arrive through a virtual X server, and
//! the feature `_test-hooks` reports the state of the window. Each case runs in a separate process,
//! because a process has one event loop, on its main thread.
//!
//! ```text
//! cargo test --features viewer --test viewer                  all cases except slow ones
//! cargo test --features viewer --test viewer -- --ignored     slow cases
//! cargo test --features viewer --test viewer -- mouse         cases whose names contain this text
//! cargo test --features viewer --test viewer -- screenshots DIRECTORY     screenshots of the panels, for visual inspection
//! cargo test --features viewer --test viewer -- screenshots DIRECTORY sizes     a group of them
//! cargo test --features viewer --test viewer -- processor                 processor time while paused, with a moving pointer, and running
//! ```

#![forbid(unsafe_code)]

#[allow(dead_code, reason = "the example `humanoid_lqr` uses more of it")]
#[path = "../../examples/common/balance.rs"]
mod balance;
#[path = "../common/cases.rs"]
mod cases;
mod contents;
mod display;
mod errors;
#[path = "../common/example.rs"]
mod example;
mod examples;
mod harness;
mod input;
mod instruments;
mod keys;
mod launch;
mod leaks;
mod mouse;
mod panels;
mod processor;
mod queued_events;
mod screenshots;
mod server;
mod trajectories;
mod window;

use std::num::NonZero;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use display::Display;

/// Name and function of a case.
type Case = (&'static str, fn());

/// The longest first, so that no worker waits for it at the end.
const CASES: &[Case] = &[
    ("frames_follow_the_state_and_the_display", processor::frames),
    ("panels_are_redrawn_without_the_scene", panels::redraws),
    ("simulation_keys", keys::simulation),
    ("visualisation_keys", keys::visualisation),
    ("window_keys", window::keys),
    ("screenshots_and_recordings", window::outputs),
    ("changes_of_the_file", window::changes_of_the_file),
    ("mouse_gestures", mouse::gestures),
    ("trajectory_keys_and_wheel", trajectories::keys_and_wheel),
    ("panels_are_open_at_the_start_of_a_wide_window", panels::start),
    ("panels_receive_their_input", panels::panels),
    ("layout_is_remembered", panels::remembered),
    ("panels_do_not_cover_the_picture", panels::layout),
    ("panels_do_not_edit_the_state", panels::no_edits),
    ("panels_change_their_theme_and_scale", panels::style),
    ("panels_show_names_and_rates", contents::names),
    ("search_selects_bodies", contents::search),
    ("panels_save_files", contents::saved_files),
    ("panels_save_pictures_and_recordings", contents::captured_files),
    ("panels_set_control_noise", contents::noise),
    ("panels_set_the_appearance", contents::appearance),
    ("examples_show_windows", examples::windows),
    ("instruments_show_and_change_a_controller", instruments::instruments),
    ("gestures_during_a_slow_frame", queued_events::gestures),
    ("consecutive_windows_on_one_thread", launch::consecutive),
    ("windows_on_the_background_thread", launch::launched),
    ("exit_waits_for_the_frame", launch::exit),
    ("second_thread_cannot_show_windows", launch::two_threads),
    ("signals_finish_the_recording", errors::signals),
    ("controller_failure_is_shown", errors::controller_failure),
    ("lost_surface_is_recreated", errors::lost_surface),
    ("options_that_no_window_can_have_are_errors", errors::options),
    ("panic_of_the_window_thread_ends_one_window", errors::panic),
    ("end_of_the_x_server_is_an_error", server::end),
    ("idle_window_uses_no_processor_time", errors::idle),
];

/// Cases that take a minute: `scripts/test --slow`.
const SLOW: &[Case] = &[("memory_does_not_leak", leaks::memory_does_not_leak)];

/// Cases without a display.
const WITHOUT_DISPLAY: &[Case] = &[("missing_display_is_an_error", errors::no_display)];

/// Time limit of a case, generous for a loaded machine.
const TIMEOUT: Duration = Duration::from_secs(900);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["case", name] => {
            let case = CASES.iter().chain(SLOW).chain(WITHOUT_DISPLAY).find(|(known, _)| *known == name);
            case.expect("a known case").1();
            ExitCode::SUCCESS
        }
        ["exit"] => {
            launch::exit_while_drawing();
            ExitCode::FAILURE
        }
        ["draw", directory, ref groups @ ..] => {
            screenshots::draw(Path::new(directory), groups);
            ExitCode::SUCCESS
        }
        ["lose", function, server, directory] => {
            server::lose(function, server, Path::new(directory));
            ExitCode::SUCCESS
        }
        ["measure"] => {
            processor::measure();
            ExitCode::SUCCESS
        }
        ["screenshots", directory, ref groups @ ..] => run_on_display(&[&["draw", directory], groups].concat()),
        ["processor"] => run_on_display(&["measure"]),
        _ if words.contains(&"--list") => {
            CASES.iter().chain(SLOW).chain(WITHOUT_DISPLAY).for_each(|(name, _)| println!("{name}: test"));
            ExitCode::SUCCESS
        }
        _ => {
            let filter = words.iter().copied().find(|word| !word.starts_with('-'));
            if words.contains(&"--ignored") {
                run_cases(SLOW, &[], filter)
            } else {
                for (name, _) in SLOW {
                    println!("test {name} ... ignored, takes a minute");
                }
                run_cases(CASES, WITHOUT_DISPLAY, filter)
            }
        }
    }
}

/// Runs this program with other arguments on a virtual display.
fn run_on_display(arguments: &[&str]) -> ExitCode {
    let display = Display::start();
    let mut command = child(arguments);
    let status = command.env("DISPLAY", display.name()).env("FRAMEBUFFER", display.framebuffer()).status();
    ExitCode::from(u8::from(!status.is_ok_and(|status| status.success())))
}

/// Returns a command that runs this program with other arguments.
fn child(arguments: &[&str]) -> Command {
    // Background jobs of a shell ignore SIGINT, jobs under `nohup` SIGHUP, and their children
    // inherit this. One case tests the signals.
    let mut command = Command::new("env");
    command.arg("--default-signal=INT,TERM,HUP").arg(std::env::current_exe().expect("the path of the test"));
    command.args(arguments).env_remove("WAYLAND_DISPLAY").env_remove("DISPLAY");
    command.env("RUST_BACKTRACE", "0");
    // No test uses or changes the user's configuration: this folder cannot be created.
    command.env("XDG_CONFIG_HOME", "/dev/null/none");
    // Without this variable Mesa prints a warning.
    command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    command
}

/// Runs the cases whose names contain the filter, as many at a time as there are processors, each
/// worker with its own display.
fn run_cases(cases: &[Case], without_display: &[Case], filter: Option<&str>) -> ExitCode {
    let is_selected = |case: &&Case| filter.is_none_or(|filter| case.0.contains(filter));
    let with_display = cases.iter().filter(is_selected).map(|case| (case.0, true));
    let without_display = without_display.iter().filter(is_selected).map(|case| (case.0, false));
    let queue = Mutex::new(with_display.chain(without_display));
    let has_failed = AtomicBool::new(false);
    let work = || {
        let display = Display::start();
        loop {
            // The lock ends with this statement.
            let next = queue.lock().expect("no worker panics").next();
            let Some((name, needs_display)) = next else { return };
            if !run_case(name, needs_display.then_some(&display)) {
                has_failed.store(true, Ordering::Relaxed);
            }
        }
    };
    let workers = thread::available_parallelism().map_or(1, NonZero::get);
    thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    ExitCode::from(u8::from(has_failed.into_inner()))
}

/// Runs a case in a process, and prints its result. Returns `true` if it passes.
fn run_case(name: &str, display: Option<&Display>) -> bool {
    let mut command = child(&["case", name]);
    if let Some(display) = display {
        command.env("DISPLAY", display.name()).env("FRAMEBUFFER", display.framebuffer());
    }
    let start = Instant::now();
    let outcome = harness::run_with_timeout(&mut command, TIMEOUT);
    let seconds = start.elapsed().as_secs_f64();
    match &outcome {
        Ok(()) => println!("test {name} ... ok ({seconds:.1} s)"),
        Err(output) => println!("test {name} ... FAILED ({seconds:.1} s)\n{output}"),
    }
    outcome.is_ok()
}
