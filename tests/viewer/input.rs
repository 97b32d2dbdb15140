//! Keyboard and mouse input through the X server, with xdotool.

use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use mujoco_safe::viewer::test_hooks;

/// Time limit of a wait, which only a window that hangs reaches, also on a loaded machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Input for one window.
pub struct Input {
    window: String,
}

fn xdotool(arguments: &[&str]) -> Option<String> {
    let output = Command::new("xdotool").args(arguments).output().expect("xdotool is installed");
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn run_xdotool(arguments: &[&str]) {
    assert!(xdotool(arguments).is_some(), "xdotool {arguments:?} failed");
}

#[allow(clippy::unused_self, reason = "input goes to the focused window")]
impl Input {
    /// Waits for the window with this title and focuses it, because there is no window manager.
    pub fn at(title: &str) -> Self {
        let deadline = Instant::now() + TIMEOUT;
        loop {
            let found = xdotool(&["search", "--onlyvisible", "--name", &format!("^{title}$")]).unwrap_or_default();
            if let Some(window) = found.lines().next()
                && xdotool(&["windowfocus", "--sync", window]).is_some()
            {
                return Self { window: window.to_owned() };
            }
            assert!(Instant::now() < deadline, "no window with the title {title}");
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses and releases a key, with modifiers as in `ctrl+Right`.
    pub fn key(&self, name: &str) {
        run_xdotool(&["key", name]);
    }

    pub fn keys(&self, names: &[&str]) {
        run_xdotool(&[&["key", "--delay", "30"], names].concat());
    }

    pub fn write(&self, text: &str) {
        run_xdotool(&["type", "--delay", "15", text]);
    }

    pub fn move_to(&self, [x, y]: [i32; 2]) {
        run_xdotool(&["mousemove", "--window", &self.window, &x.to_string(), &y.to_string()]);
    }

    /// Clicks several times in quick succession: 1 left, 2 middle, 3 right, 4 wheel up, 5 wheel
    /// down.
    pub fn click(&self, at: [i32; 2], button: u8, times: u8) {
        self.move_to(at);
        run_xdotool(&["click", "--repeat", &times.to_string(), "--delay", "40", &button.to_string()]);
    }

    pub fn double_click(&self, at: [i32; 2], button: u8) {
        self.click(at, button, 2);
    }

    /// Drags with a button while modifiers such as `ctrl` are held, and then releases the button
    /// and the modifiers.
    pub fn drag(&self, from: [i32; 2], by: [i32; 2], button: u8, modifiers: &[&str]) {
        self.press(from, button, modifiers);
        self.move_by(by);
        self.release(button, modifiers);
    }

    /// Holds modifiers.
    pub fn hold(&self, modifiers: &[&str]) {
        for modifier in modifiers {
            run_xdotool(&["keydown", modifier]);
        }
    }

    pub fn release_modifiers(&self, modifiers: &[&str]) {
        for modifier in modifiers {
            run_xdotool(&["keyup", modifier]);
        }
    }

    pub fn press(&self, at: [i32; 2], button: u8, modifiers: &[&str]) {
        self.move_to(at);
        self.hold(modifiers);
        run_xdotool(&["mousedown", &button.to_string()]);
    }

    /// Moves the pointer by this number of pixels in a few steps.
    pub fn move_by(&self, by: [i32; 2]) {
        const STEPS: i32 = 5;
        for _ in 0..STEPS {
            run_xdotool(&["mousemove_relative", "--", &(by[0] / STEPS).to_string(), &(by[1] / STEPS).to_string()]);
            thread::sleep(Duration::from_millis(15));
        }
    }

    /// Moves the pointer along points with this delay, in s.
    pub fn move_along(&self, points: impl IntoIterator<Item = [i32; 2]>, delay: f64) {
        let mut arguments = Vec::new();
        for [x, y] in points {
            arguments.extend(["mousemove", "--window", &self.window].map(str::to_owned));
            arguments.extend([x.to_string(), y.to_string(), "sleep".to_owned(), delay.to_string()]);
        }
        run_xdotool(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    }

    pub fn release(&self, button: u8, modifiers: &[&str]) {
        run_xdotool(&["mouseup", &button.to_string()]);
        self.release_modifiers(modifiers);
    }

    pub fn resize(&self, [width, height]: [u32; 2]) {
        run_xdotool(&["windowsize", &self.window, &width.to_string(), &height.to_string()]);
    }
}

/// Waits for a condition, and panics with its description and the state of the last frame after the
/// time limit.
pub fn wait_until(description: &str, mut condition: impl FnMut() -> bool) {
    let deadline = Instant::now() + TIMEOUT;
    while !condition() {
        assert!(
            Instant::now() < deadline,
            "timeout after {TIMEOUT:?} while waiting for: {description}. State of the last frame: {:#?}",
            test_hooks::latest()
        );
        thread::sleep(Duration::from_millis(10));
    }
}
