//! End-to-end tests of the viewer: keyboard and mouse input arrive through a virtual X server, and the feature `test-hooks` reports the
//! state of the window. Each case runs in a separate process, because a process has one event loop, on its main thread.
//!
//! ```text
//! cargo test --features viewer --test viewer              all of them
//! cargo test --features viewer --test viewer -- mouse     those whose names contain this text
//! cargo test --features viewer --test viewer -- pictures DIRECTORY     pictures of the panels, for inspection
//! ```

#![forbid(unsafe_code)]

mod display;
mod errors;
mod harness;
mod input;
mod keys;
mod launch;
mod leaks;
mod mouse;
mod panels;
mod pictures;
mod queued_events;
mod trajectories;
mod window;

use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use display::Display;

/// Name and function of a case.
type Case = (&'static str, fn());

const CASES: &[Case] = &[
    ("keys_of_the_simulation", keys::simulation),
    ("keys_of_what_is_shown", keys::shown),
    ("keys_of_the_window", window::keys),
    ("pictures_and_recordings", window::outputs),
    ("mouse", mouse::gestures),
    ("trajectories", trajectories::keys_and_wheel),
    ("panels", panels::panels),
    ("gestures_that_come_while_a_frame_is_drawn", queued_events::gestures),
    ("windows_one_after_another_in_one_thread", launch::one_after_another),
    ("windows_of_a_thread_of_their_own", launch::launched),
    ("a_process_has_one_thread_for_windows", launch::two_threads),
    ("an_interrupt_finishes_the_recording", errors::interrupt),
    ("a_controller_that_panics_is_shown", errors::panic),
    ("lost_surface_is_recreated", errors::lost_surface),
    ("a_simulation_at_rest_costs_nothing", errors::rest),
    ("nothing_leaks", leaks::nothing_leaks),
];

/// Cases without a display.
const WITHOUT_DISPLAY: &[Case] = &[("without_a_display_there_is_an_error", errors::no_display)];

/// Time limit of a case, generous for a loaded machine.
const TIMEOUT: Duration = Duration::from_secs(900);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["case", name] => {
            let case = CASES.iter().chain(WITHOUT_DISPLAY).find(|(known, _)| *known == name);
            case.expect("an unknown case").1();
            ExitCode::SUCCESS
        }
        ["draw", directory] => {
            pictures::draw(Path::new(directory));
            ExitCode::SUCCESS
        }
        ["pictures", directory] => {
            let display = Display::start();
            let framebuffer = display.framebuffer();
            let status =
                this(&["draw", directory]).env("DISPLAY", display.name()).env("FRAMEBUFFER", framebuffer).status();
            ExitCode::from(u8::from(!status.is_ok_and(|status| status.success())))
        }
        _ if words.contains(&"--list") => {
            CASES.iter().chain(WITHOUT_DISPLAY).for_each(|(name, _)| println!("{name}: test"));
            ExitCode::SUCCESS
        }
        _ => all(words.iter().copied().find(|word| !word.starts_with('-'))),
    }
}

fn this(arguments: &[&str]) -> Command {
    // Background jobs of a shell ignore SIGINT, and children inherit that. A case tests Ctrl-C.
    let mut command = Command::new("env");
    command.arg("--default-signal=INT").arg(std::env::current_exe().expect("the path of the test"));
    command.args(arguments).env_remove("WAYLAND_DISPLAY").env_remove("DISPLAY");
    command.env("RUST_BACKTRACE", "0");
    // Without this variable Mesa prints a warning.
    command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    command
}

fn all(filter: Option<&str>) -> ExitCode {
    let is_wanted = |case: &&Case| filter.is_none_or(|filter| case.0.contains(filter));
    let display = Display::start();
    let seeing = CASES.iter().filter(is_wanted).map(|case| (case, true));
    let blind = WITHOUT_DISPLAY.iter().filter(is_wanted).map(|case| (case, false));
    let mut failures = 0;
    for ((name, _), sees) in seeing.chain(blind) {
        let mut command = this(&["case", name]);
        if sees {
            command.env("DISPLAY", display.name()).env("FRAMEBUFFER", display.framebuffer());
        }
        let begin = Instant::now();
        let outcome = harness::run_with_timeout(&mut command, TIMEOUT);
        let seconds = begin.elapsed().as_secs_f64();
        match outcome {
            Ok(()) => println!("test {name} ... ok ({seconds:.1} s)"),
            Err(output) => {
                failures += 1;
                println!("test {name} ... FAILED ({seconds:.1} s)\n{output}");
            }
        }
    }
    ExitCode::from(u8::from(failures > 0))
}
