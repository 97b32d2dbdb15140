//! Contents of the panels.

use std::f64::consts::PI;

use egui::{Key, vec2};

use super::Bench;
use super::screen::Screen;
use crate::viewer::instruments::{Instruments, WithInstruments};
use crate::{Data, Model, ZeroController, sample};

/// Returns a model with these names of joints and of their motors.
fn robot(names: &[&str]) -> Data {
    let each = |text: fn(&str) -> String| names.iter().map(|name| text(name)).collect::<Vec<_>>().concat();
    let bodies = each(|name| format!("<body><joint name='joint_{name}_end'/><geom size='.1'/></body>"));
    let motors = each(|name| format!("<motor name='motor_{name}_name' joint='joint_{name}_end'/>"));
    let text = format!("<mujoco><worldbody>{bodies}</worldbody><actuator>{motors}</actuator></mujoco>");
    Data::new(Model::from_xml_str(&text).unwrap()).unwrap()
}

/// Shows the right panel.
fn right(data: Data) -> Screen {
    let mut bench = Bench::new(data);
    bench.view.right_panel = true;
    Screen::new(bench)
}

#[test]
fn lists_of_controls_and_joints_are_filtered_by_name() {
    let mut screen = right(robot(&["left_hip", "left_knee", "left_ankle", "right_hip", "right_knee", "right_ankle"]));
    // The controls come first.
    let count = |screen: &Screen, name: &str| screen.texts().iter().filter(|text| *text == name).count();
    assert_eq!((count(&screen, "left_hip"), count(&screen, "right_knee")), (2, 2));
    screen.edit("filter");
    screen.write("LEFT");
    screen.settle();
    assert_eq!((count(&screen, "left_hip"), count(&screen, "right_knee")), (2, 1));
    screen.key(Key::Escape);
    assert_eq!(count(&screen, "right_knee"), 2, "Esc clears the filter");
    screen.edit("filter");
    screen.write("motor_l");
    screen.settle();
    assert_eq!((count(&screen, "left_hip"), count(&screen, "right_knee")), (2, 1), "the full name is searched");
    screen.click("×");
    assert_eq!(count(&screen, "right_knee"), 2, "the button clears the filter");
    // Few names need no filter.
    assert_eq!(count(&right(robot(&["hip", "knee"])), "filter"), 0);
}

#[test]
fn side_panels_are_resized_at_their_edge() {
    let mut bench = Bench::humanoid();
    (bench.view.left_panel, bench.view.right_panel) = (true, true);
    let mut screen = Screen::new(bench);
    assert_eq!(screen.bench.view.side_widths, [286.0; 2]);
    screen.drag([284.0, 400.0], [350.0, 410.0]);
    assert_eq!(screen.bench.view.side_widths, [350.0, 286.0]);
    screen.drag([1200.0 - 284.0, 400.0], [1000.0, 400.0]);
    assert_eq!(screen.bench.view.side_widths, [350.0, 200.0]);
    // The picture keeps two fifths of the window.
    screen.drag([348.0, 400.0], [900.0, 400.0]);
    assert_eq!(screen.bench.view.side_widths, [520.0, 200.0]);
}

/// Runs a humanoid with an open plot of its sensors.
fn running() -> Screen {
    let mut bench = Bench::humanoid();
    bench.view.sensors = true;
    let mut screen = Screen::new(bench);
    screen.run(0.2);
    screen
}

#[test]
fn plots_have_one_unit_each_and_ticks_at_both_axes() {
    let screen = running();
    let texts = screen.texts();
    for (title, unit) in [("acceleration", "m/s²"), ("angular velocity", "rad/s"), ("position", "m"), ("force", "N")] {
        let title = texts.iter().position(|text| text == title).expect(title);
        assert_eq!(texts[title + 1], unit);
    }
    assert!(texts.iter().any(|text| text == "0.1 s"), "{texts:?}");
    let is_number = |text: &&String| text.parse::<f64>().is_ok();
    let plots = 5;
    assert!(texts.iter().filter(is_number).count() >= 2 * plots, "each axis has two ticks: {texts:?}");
}

#[test]
fn fast_signal_is_a_filled_band_and_slow_signal_a_line() {
    let areas = |period: f64| {
        let declare = move |_: &mut ZeroController, data: &Data, instruments: &mut Instruments| {
            instruments.value("plot", "x", (2.0 * PI * data.time() / period).sin());
        };
        let controller = WithInstruments { controller: ZeroController, declare };
        let mut screen = Screen::new(Bench::instrumented(Data::new(sample::cartpole()).unwrap(), controller));
        screen.run(2.0);
        assert_eq!(screen.curves(), 1);
        screen.areas()
    };
    let [(place, covered)] = areas(0.05)[..] else { panic!("one band") };
    assert!(place.width() > 200.0 && place.height() > 50.0, "it fills the plot: {place}");
    assert!((covered - 1.0).abs() < 0.01, "{covered}");
    let slow = areas(4.0);
    assert!(slow.iter().all(|(place, _)| place.height() < 1.0), "{slow:?}");
}

#[test]
fn curves_are_hidden_and_filtered() {
    let mut screen = running();
    let all = screen.bench.snapshot().model.nsensordata();
    assert_eq!(screen.curves(), all);
    screen.click("left");
    assert_eq!(screen.curves(), all - 1);
    screen.click("left");
    assert_eq!(screen.curves(), all);
    screen.edit("filter of the sensors");
    screen.write("GYRO");
    screen.settle();
    assert_eq!(screen.curves(), 3);
}

#[test]
fn plot_is_shown_in_a_window() {
    let mut screen = running();
    let (before, title) = (screen.curves(), screen.find("force").unwrap());
    screen.click_at(title.left_center() - vec2(14.0, 0.0));
    screen.settle();
    assert_eq!(screen.curves(), before);
    let window = screen.find("force").unwrap();
    assert!(window.right() < title.left() - 50.0, "the window is beside the panel: {window}");
    // The window does not depend on the panel.
    screen.bench.view.sensors = false;
    screen.settle();
    assert_eq!(screen.curves(), 2);
}

#[test]
fn values_are_watched_by_index_and_by_name() {
    let mut bench = Bench::humanoid();
    bench.view.left_panel = true;
    let mut screen = Screen::new(bench);
    screen.click("Visualisation");
    screen.click("Watch");
    screen.settle();
    screen.edit("qpos[2] or joint knee");
    screen.enter("qpos[99]");
    assert!(screen.texts().iter().any(|text| text.contains("0 to 27")), "{:?}", screen.texts());
    screen.click("×");
    screen.edit("qpos[2] or joint knee");
    screen.enter("joint left_knee");
    let snapshot = screen.bench.tick();
    let knee = snapshot.model.joint("left_knee").unwrap().qpos_range();
    let watched: Vec<f64> = snapshot.signals.watched.iter().map(|watched| watched.signal.value).collect();
    assert_eq!(watched, snapshot.qpos[knee]);
    screen.settle();
    assert!(screen.find("joint left_knee").is_some());
    assert!(!screen.texts().iter().any(|text| text.contains("0 to 27")), "the message is gone");
}

#[test]
fn enter_selects_the_body_of_the_first_result() {
    let mut screen = right(Data::new(sample::humanoid()).unwrap());
    screen.edit("name of an element");
    screen.write("left_foot_t");
    screen.settle();
    assert!(screen.find("left_foot_touch").is_some() && screen.find("sensor").is_some());
    screen.key(Key::Enter);
    let foot = screen.bench.snapshot().model.site("sole_left").map(|site| site.body());
    let selected = screen.bench.tick().selected.map(|selected| selected.body);
    assert!(selected.is_some() && foot.is_ok_and(|foot| Some(foot) == selected), "{selected:?}");
}

#[test]
fn tree_shows_the_bodies_with_their_elements_and_values() {
    let text = r#"<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
        <body name="arm" pos="0 0 1.5"><joint name="elbow"/><geom name="bone" size=".1" pos=".25 0 0"/>
          <body name="hand" pos="1 0 0"><joint name="finger" type="slide"/><geom size=".1"/><site name="tip"/></body></body>
      </worldbody></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    data.qpos_mut().copy_from_slice(&[0.0, 0.125]);
    data.forward().unwrap();
    let mut screen = right(data);
    screen.click("Joints");
    screen.click("Model");
    screen.settle();
    for shown in ["world", "floor", "arm", "0.00 0.00 1.50"] {
        assert!(screen.find(shown).is_some(), "{shown}: {:?}", screen.texts());
    }
    assert!(screen.find("hand").is_none(), "closed bodies show no children");
    let open = |screen: &mut Screen, name: &str| {
        let name = screen.find(name).unwrap();
        screen.click_at(name.left_center() - vec2(14.0, 0.0));
        screen.settle();
    };
    open(&mut screen, "arm");
    open(&mut screen, "hand");
    for shown in ["elbow", "0.000 rad 0.00 rad/s", "bone", "0.25 0.00 1.50", "0.125 m 0.00 m/s", "tip"] {
        assert!(screen.find(shown).is_some(), "{shown}: {:?}", screen.texts());
    }
    screen.click("hand");
    let hand = screen.bench.snapshot().model.body("hand").unwrap().id();
    assert_eq!(screen.bench.tick().selected.unwrap().body, hand);
}
