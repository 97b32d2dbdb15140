//! Pages, and pictures of the renderer, for the tests of `scripts/try-html`.

use std::path::PathBuf;

use mujoco_safe::html::{self, HtmlOptions, Signal};
use mujoco_safe::{Data, Model, RandomController, Trajectory, sample};

use crate::{contents, sizes, soft, texts};

/// Records a motion under random control.
fn recorded(data: &mut Data, seed: u64, seconds: f64) -> Trajectory {
    data.reset().unwrap();
    let mut trajectory = Trajectory::with_sensordata(data.model());
    let steps = (seconds / data.model().options().timestep).round() as usize;
    trajectory.record(data, &mut RandomController::new(seed), steps).unwrap();
    trajectory
}

fn save(name: &str, model: &Model, trajectories: &[(&str, &Trajectory)], options: &HtmlOptions) {
    let folder = PathBuf::from(std::env::var_os("HTML_PAGES").expect("HTML_PAGES is the folder for the pages"));
    html::save(folder.join(name), model.clone(), trajectories.iter().copied(), options).unwrap();
}

#[test]
#[ignore = "scripts/try-html runs it"]
fn pages_are_written() {
    let model = sample::humanoid();
    let mut data = Data::new(model.clone()).unwrap();
    let [first, second, third] = [1, 2, 3].map(|seed| recorded(&mut data, seed, 3.0));
    let options = HtmlOptions::default()
        .with_title("Humanoid, random control")
        .with_camera("side")
        .with_notes([(0.5, "falls".into())])
        .with_signals([Signal::Qpos("left_knee".into()), Signal::Ctrl("left_knee".into())]);
    save("humanoid.html", &model, &[("seed 1", &first)], &options);
    let ghosts = [("seed 1", &first), ("seed 2", &second), ("seed 3", &third)];
    save("ghosts.html", &model, &ghosts, &HtmlOptions::default().with_title("Three seeds"));
    picture("humanoid.png", &first, &model, "side");
    let rollouts = sizes::rollouts(&model);
    let rollouts: Vec<_> = rollouts.iter().map(|(label, trajectory)| (&**label, trajectory)).collect();
    save("rollouts.html", &model, &rollouts, &HtmlOptions::default().with_title("64 rollouts"));
    save(
        "side_by_side.html",
        &model,
        &rollouts[..4],
        &HtmlOptions::default().with_title("Side by side").with_spacing(1.5),
    );

    let mut model = Model::from_xml_str(contents::SHAPES).unwrap();
    for (index, elevation) in model.edit().height_field_mut("hill").unwrap().data_mut().iter_mut().enumerate() {
        *elevation = (index as f32).sin().abs();
    }
    let mut data = Data::new(model.clone()).unwrap();
    let shapes = recorded(&mut data, 0, 0.1);
    save("shapes.html", &model, &[("", &shapes)], &HtmlOptions::default().with_title("Shapes").with_camera("front"));
    picture("shapes.png", &shapes, &model, "front");

    let model = Model::from_xml_str(soft::SOFT).unwrap();
    let mut data = Data::new(model.clone()).unwrap();
    let soft = recorded(&mut data, 0, 1.0);
    save("soft.html", &model, &[("", &soft)], &HtmlOptions::default().with_title("Soft").with_camera("front"));
    picture("soft.png", &soft, &model, "front");

    let model = sizes::large_robot();
    let mut data = Data::new(model.clone()).unwrap();
    let trajectory = recorded(&mut data, 0, 2.0);
    save("robot.html", &model, &[("", &trajectory)], &HtmlOptions::default().with_title("200,000 triangles"));

    let (model, trajectory, options) = texts::hostile();
    let labels = texts::HOSTILE;
    save("hostile.html", &model, &[(labels[0], &trajectory), (labels[1], &trajectory)], &options);
}

/// Draws the first record as the page shows it, 640 by 480 pixels.
#[cfg(feature = "renderer")]
fn picture(name: &str, trajectory: &Trajectory, model: &Model, camera: &str) {
    let mut data = Data::new(model.clone()).unwrap();
    trajectory.apply(0, &mut data).unwrap();
    data.forward().unwrap();
    let mut renderer = mujoco_safe::render::Renderer::new(data.model(), 640, 480).unwrap();
    let folder = PathBuf::from(std::env::var_os("HTML_PAGES").unwrap());
    renderer.snapshot(&mut data, camera).unwrap().rgb().unwrap().save_png(folder.join(name)).unwrap();
}

#[cfg(not(feature = "renderer"))]
fn picture(_: &str, _: &Trajectory, _: &Model, _: &str) {}
