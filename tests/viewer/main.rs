//! The window, used as a person uses it: keys and mouse come through an X server of the test's own, and what they do is looked for
//! in how the viewer stands. Each case is a process of its own, since a process has one event loop, whose thread is the main one.
//!
//! ```text
//! cargo test --features viewer --test viewer              all of them
//! cargo test --features viewer --test viewer -- mouse     those whose names have this in them
//! cargo test --features viewer --test viewer -- pictures DIRECTORY     pictures of the panels, to be looked at
//! ```

#![forbid(unsafe_code)]

mod busy;
mod case;
mod display;
mod ends;
mod forms;
mod hand;
mod keys;
mod leaks;
mod mouse;
mod panels;
mod pictures;
mod trajectories;
mod window;

use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use display::Display;

/// A case: its name, and what it does.
type Case = (&'static str, fn());

const CASES: &[Case] = &[
    ("keys_of_the_simulation", keys::simulation),
    ("keys_of_what_is_shown", keys::shown),
    ("keys_of_the_window", window::keys),
    ("pictures_and_recordings", window::outputs),
    ("mouse", mouse::gestures),
    ("trajectories", trajectories::keys_and_wheel),
    ("panels", panels::panels),
    ("gestures_that_come_while_a_frame_is_drawn", busy::gestures),
    ("windows_one_after_another_in_one_thread", forms::one_after_another),
    ("windows_of_a_thread_of_their_own", forms::launched),
    ("a_process_has_one_thread_for_windows", forms::two_threads),
    ("an_interrupt_finishes_the_recording", ends::interrupt),
    ("a_controller_that_panics_is_shown", ends::panic),
    ("a_lost_surface_is_made_anew", ends::lost_surface),
    ("a_simulation_at_rest_costs_nothing", ends::rest),
    ("nothing_leaks", leaks::nothing_leaks),
];

/// Cases that have no display.
const BLIND: &[Case] = &[("without_a_display_there_is_an_error", ends::no_display)];

/// A case that takes longer hangs, even on a machine that other programs keep busy.
const MOST: Duration = Duration::from_secs(900);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["case", name] => {
            let case = CASES.iter().chain(BLIND).find(|(known, _)| *known == name);
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
            CASES.iter().chain(BLIND).for_each(|(name, _)| println!("{name}: test"));
            ExitCode::SUCCESS
        }
        _ => all(words.iter().copied().find(|word| !word.starts_with('-'))),
    }
}

fn this(arguments: &[&str]) -> Command {
    // What runs in a shell's background ignores Ctrl-C, and hands that down; a case wants to see what Ctrl-C does.
    let mut command = Command::new("env");
    command.arg("--default-signal=INT").arg(std::env::current_exe().expect("the test's own path"));
    command.args(arguments).env_remove("WAYLAND_DISPLAY").env_remove("DISPLAY");
    command.env("RUST_BACKTRACE", "0");
    // Mesa complains where there is none.
    command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    command
}

fn all(filter: Option<&str>) -> ExitCode {
    let is_wanted = |case: &&Case| filter.is_none_or(|filter| case.0.contains(filter));
    let display = Display::start();
    let seeing = CASES.iter().filter(is_wanted).map(|case| (case, true));
    let blind = BLIND.iter().filter(is_wanted).map(|case| (case, false));
    let mut failures = 0;
    for ((name, _), sees) in seeing.chain(blind) {
        let mut command = this(&["case", name]);
        if sees {
            command.env("DISPLAY", display.name()).env("FRAMEBUFFER", display.framebuffer());
        }
        let begin = Instant::now();
        let outcome = case::limited(&mut command, MOST);
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
