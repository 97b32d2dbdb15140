//! Windows of the examples.

use std::ops::Range;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use crate::cases::cases;
use crate::display::Screen;
use crate::example;
use crate::input::{Input, wait_until};
use mujoco_safe::flight::FlightRecorder;
use mujoco_safe::{Data, sample};

pub fn windows() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("box.xml");
    std::fs::write(
        &model,
        r#"<mujoco><worldbody><light pos="0 0 3"/><body pos="0 0 1"><freejoint/><geom type="box" size=".2 .2 .2"/></body></worldbody>
        <keyframe><key name="high" qpos="0 0 2 1 0 0 0"/></keyframe></mujoco>"#,
    )
    .unwrap();
    let model = model.to_str().unwrap();
    // Narrow windows start without side panels. The picture of the others begins at the end of the
    // left panel.
    let (narrow, wide) = (100..400, 300..500);
    show("view", &[model, "--size", "500x300", "--keyframe", "high"], model, narrow.clone());
    show("view", &["--size", "500x300"], "MuJoCo", narrow);
    let out = folder.path().to_str().unwrap();
    show("humanoid_lqr", &["--view", "--out", out], "Humanoid on one leg", wide.clone());
    let recording = folder.path().join("steps.flight");
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap();
    (0..20).for_each(|_| recorder.step(&mut data).unwrap());
    recorder.write(&recording).unwrap();
    show("replay", &["show", recording.to_str().unwrap()], "MuJoCo", wide.clone());
    if cases(false, true) {
        show("humanoid_predictive", &["--view"], "Humanoid with predictive control", wide.clone());
        show("cartpole_lqr", &["--view"], "Cart-pole under LQR", wide.clone());
        show("arm_tracking", &["--view", "--seconds", "0.1", "--out", out], "Arm that follows a target", wide.clone());
        show("humanoid_stand_up", &["--view", "--seconds", "0.1", "--out", out], "Humanoid that gets up", wide);
    }

    // A wrong argument is an error before a window opens.
    let output = command("view", &[model, "--keyframe", "low"]).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && error.contains("low") && error.contains("high"), "{error}");
}

/// Returns a command that runs an example.
fn command(name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(example::build(name));
    command.args(arguments);
    command
}

/// Process that ends with this value.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs an example, waits until its window with this title shows a scene in these columns, and
/// closes it.
fn show(name: &str, arguments: &[&str], title: &str, columns: Range<usize>) {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    let mut process = Process(command(name, arguments).stdout(Stdio::null()).spawn().unwrap());
    let input = Input::at(title);
    wait_until(&format!("{name} {arguments:?} draws its window"), || {
        let ended = process.0.try_wait().unwrap();
        assert!(ended.is_none(), "{name} {arguments:?} ended with {ended:?}");
        let screen = Screen::read(&framebuffer);
        // The model, or the line about its state at the lower edge of a window of 300 pixels.
        [150, 275]
            .into_iter()
            .any(|row| columns.clone().any(|column| screen.pixel([column, row]) != screen.pixel([columns.start, row])))
    });
    input.key("ctrl+q");
    let mut status = None;
    wait_until(&format!("{name} {arguments:?} ends"), || {
        status = process.0.try_wait().unwrap();
        status.is_some()
    });
    assert!(status.unwrap().success(), "{name} {arguments:?}: {status:?}");
}
