//! Contents of the panels: names, rates, the search, saved files, control noise and the appearance
//! of the model.

use std::path::PathBuf;
use std::time::Duration;

use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Data, Model, sample};

use crate::display::Screen;
use crate::harness::{press, settle, show_sized, show_window, state};
use crate::input::{Input, wait_until};

/// A window of this size shows all headings of the left panel.
const SIZE: [u32; 2] = [900, 1100];

/// Returns the centre of the first text for which `is_wanted` is true.
fn position(is_wanted: impl Fn(&str) -> bool) -> Option<[i32; 2]> {
    let texts = state().texts;
    let (_, centre) = texts.iter().find(|(text, _)| is_wanted(text))?;
    Some(centre.map(|part| part as i32))
}

fn is_shown(text: &str) -> bool {
    position(|shown| shown == text).is_some()
}

/// Clicks on a text.
pub fn click(input: &Input, text: &str) {
    input.click(place(input, text), 1, 1);
}

/// Returns the centre of a text. Waits until it stays in one place, because sections open
/// gradually.
pub fn place(input: &Input, text: &str) -> [i32; 2] {
    let mut before = None;
    wait_until(&format!("the text {text} is shown"), || {
        settle(input);
        let now = position(|shown| shown == text);
        now.is_some() && std::mem::replace(&mut before, now) == now
    });
    before.expect("the text is shown")
}

/// Returns the texts after this one, in the order of the panel.
fn texts_after(text: &str) -> Vec<(String, [f32; 2])> {
    state().texts.into_iter().skip_while(|(shown, _)| shown != text).skip(1).collect()
}

/// Replaces the number beside a label.
fn set_number(input: &Input, label: &str, number: &str) {
    wait_until(&format!("the label {label} is shown"), || {
        settle(input);
        is_shown(label)
    });
    let (_, at) = texts_after(label)[0].clone();
    input.click(at.map(|part| part as i32), 1, 1);
    wait_until("the number is edited", || state().editing);
    input.key("ctrl+a");
    input.write(number);
    input.key("Return");
    wait_until("the number is set", || !state().editing);
    settle(input);
}

/// Waits for the side panels, which are open from the start in a window with place for them.
fn open_panels(input: &Input) {
    wait_until("the side panels are open", || state().panels[2] && state().panels[3]);
    // Makes space for the other sections.
    click(input, "Visualisation");
}

pub fn names() {
    let text = r#"<mujoco><option timestep="1"/><worldbody>
          <body name="arm"><joint name="the_right_shoulder_joint_1"/><geom size=".1"/></body>
          <body name="cup"><joint name="the_right_shoulder_joint_2"/><geom size=".1"/></body>
        </worldbody>
        <equality><weld body1="arm" body2="cup"/></equality></mujoco>"#;
    show_sized(SIZE, Data::new(Model::from_xml_str(text).unwrap()).unwrap(), |input| {
        open_panels(input);
        click(input, "Equality constraints");
        wait_until("the constraint has the names of its bodies", || is_shown("arm, cup (Weld)"));

        wait_until("the names have no common words", || is_shown("1") && is_shown("2"));
        let mut step = 0;
        wait_until("a tooltip shows the complete name", || {
            // A click hides tooltips until the pointer moves more than a tenth of a second later.
            step = 1 - step;
            let [x, y] = position(|text| text == "2").expect("the name is shown");
            input.move_to([x + step, y]);
            std::thread::sleep(Duration::from_secs(1));
            is_shown("the_right_shoulder_joint_2")
        });

        press(input, "F2", "the details are open", |state| state.panels[1]);
        // The state changes once per second, less often than the window counts as idle.
        let rate = || texts_after("Refresh Rate").first().map(|(text, _)| text.clone()).unwrap_or_default();
        wait_until("the window is idle", || rate() == "idle");
        press(input, "space", "the simulation runs", |state| state.time > 0.0);
        let time = state().time;
        wait_until("the simulation runs for three seconds", || {
            let now = state();
            let is_running = now.texts.iter().any(|(text, _)| text == "Forward Simulation");
            let is_idle = now.texts.iter().any(|(text, _)| text == "idle");
            assert!(!(is_running && is_idle), "the info panel shows a running simulation and an idle window");
            now.time >= time + 3.0
        });
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        wait_until("the window is idle", || rate() == "idle");
    });
}

pub fn search() {
    show_sized(SIZE, Data::new(sample::humanoid()).unwrap(), |input| {
        open_panels(input);
        click(input, "name of an element");
        wait_until("the search is edited", || state().editing);
        input.write("LEFT_KN");
        // The results for a part of the text are more, and in other places.
        let found = || texts_after("LEFT_KN").iter().find(|(text, _)| text == "left_knee").map(|(_, centre)| *centre);
        wait_until("the joint is found", || found().is_some());
        input.click(found().unwrap().map(|part| part as i32), 1, 1);
        let knee = sample::humanoid().joint("left_knee").unwrap().body().index();
        wait_until("the body of the joint is selected", || state().selected.is_some_and(|(body, _)| body == knee));
    });
}

pub fn saved_files() {
    let folder = tempfile::tempdir().unwrap();
    let options = ViewerOptions::default().with_directory(folder.path());
    show_window(SIZE, options, Viewer::new(), Data::new(sample::humanoid()).unwrap(), |input| {
        open_panels(input);
        for (button, name) in [("XML", "model.xml"), ("MJB", "model.mjb"), ("Model", "model.txt"), ("Data", "data.txt")]
        {
            click(input, button);
            let notice = format!("saved {}", folder.path().join(name).display());
            wait_until("a notice shows the path", || state().messages.contains(&notice));
        }
    });
    let path = |name: &str| folder.path().join(name);
    let saved = Model::from_xml_path(path("model.xml")).unwrap();
    assert_eq!(saved.body_mass(), sample::humanoid().body_mass());
    assert_eq!(std::fs::read(path("model.mjb")).unwrap(), sample::humanoid().to_binary().unwrap());
    assert!(std::fs::read_to_string(path("model.txt")).unwrap().contains("left_knee"));
    assert!(std::fs::read_to_string(path("data.txt")).unwrap().contains("QPOS"));
}

/// Clicks on the buttons for a screenshot and for a recording save the files that the notices name.
pub fn captured_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let options = ViewerOptions::default().with_screenshots(path("image.png")).with_recordings(path("film.gif"));
    let mut size = [0; 2];
    show_window(SIZE, options, Viewer::new(), Data::new(sample::cartpole()).unwrap(), |input| {
        open_panels(input);
        let is_noticed = |start: String| state().messages.iter().any(|message| message.starts_with(&start));
        click(input, "Screenshot");
        wait_until("a notice shows the path", || is_noticed(format!("saved {}", path("image.png").display())));
        size = state().picture[1];
        click(input, "Record");
        wait_until("a notice shows the path", || is_noticed(format!("recording to {}", path("film.gif").display())));
        click(input, "Stop");
        wait_until("a notice shows the length", || is_noticed(format!("{}: ", path("film.gif").display())));
    });
    let png = std::fs::read(path("image.png")).unwrap();
    let [width, height] = size.map(u32::to_be_bytes);
    assert_eq!(png[1..4], *b"PNG");
    assert_eq!(
        (&png[16..20], &png[20..24]),
        (&width[..], &height[..]),
        "the image shows the picture without the panels"
    );
    let film = std::fs::read(path("film.gif")).unwrap();
    assert!(film.starts_with(b"GIF89a") && film.ends_with(b";"), "the recording is complete");
}

pub fn noise() {
    let mut quiet = Data::new(sample::cartpole()).unwrap();
    for _ in 0..50 {
        quiet.step().unwrap();
    }
    show_sized(SIZE, Data::new(sample::cartpole()).unwrap(), |input| {
        open_panels(input);
        press(input, "shift+Right", "fifty steps", |state| state.qpos == quiet.qpos());
        press(input, "BackSpace", "the start state is restored", |state| state.time == 0.0);
        set_number(input, "noise", "0.5");
        press(input, "shift+Right", "fifty steps", |state| (state.time - quiet.time()).abs() < 1e-9);
        assert_ne!(state().qpos, quiet.qpos(), "the noise acts on the simulation");
        assert_eq!(state().ctrl, quiet.ctrl(), "the noise does not edit the controls");
    });
}

pub fn appearance() {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    let text = r#"<mujoco><visual><headlight ambient="0 0 0" diffuse="0 0 0" specular="0 0 0"/></visual>
        <worldbody><geom type="sphere" size="1" rgba="1 1 1 1"/></worldbody></mujoco>"#;
    show_sized(SIZE, Data::new(Model::from_xml_str(text).unwrap()).unwrap(), |input| {
        open_panels(input);
        let middle = || {
            let [[left, top], [width, height]] = state().picture.map(|part| part.map(|pixels| pixels as usize));
            Screen::read(&framebuffer).pixel([left + width / 2, top + height / 2])
        };
        assert_eq!(middle(), [0; 3], "the scene is dark");
        click(input, "Appearance");
        for group in ["global", "quality", "headlight", "map", "scale", "rgba", "statistic"] {
            wait_until("the group is shown", || is_shown(group));
        }
        click(input, "headlight");
        set_number(input, "ambient", "0.8");
        wait_until("the red part of the headlight is on", || middle()[0] > 150 && middle()[1..] == [0; 2]);
    });
}
