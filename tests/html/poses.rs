//! Poses, cameras and signals equal those of the engine within the stated errors.

use mujoco_safe::html::{HtmlOptions, Signal};
use mujoco_safe::{Data, Error, Model, RandomController, Trajectory, sample};

use crate::page::{Page, saved};

fn recorded(model: &Model, steps: usize) -> Trajectory {
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::with_sensordata(model);
    trajectory.record(&mut data, &mut RandomController::new(3), steps).unwrap();
    trajectory
}

fn distance<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Returns the angle between two orientations. The quaternion of the page has any length.
fn angle(page: [f64; 4], engine: [f64; 4]) -> f64 {
    let length = distance(page, [0.0; 4]);
    let unit = page.map(|part| part / length);
    let opposite = unit.map(|part| -part);
    // Of the half angle, by the chord, which is precise for small angles.
    4.0 * (0.5 * distance(unit, engine).min(distance(opposite, engine))).asin()
}

/// Compares the frames of a page with the poses that the engine computes.
fn largest_errors(page: &Page, model: &Model, trajectory: &Trajectory) -> [f64; 2] {
    let track = page.track(0);
    let mut data = Data::new(model.clone()).unwrap();
    let mut errors = [0.0_f64; 2];
    for (index, time) in track.times.iter().enumerate() {
        let record = trajectory.times().iter().position(|recorded| (recorded - time).abs() < 1e-6).unwrap();
        trajectory.apply(record, &mut data).unwrap();
        data.forward().unwrap();
        for (body, pose) in track.poses.iter().take(model.nbody()).enumerate() {
            let pose: [f64; 7] = std::array::from_fn(|part| pose[part][index]);
            let (pos, quat) = ([pose[0], pose[1], pose[2]], [pose[3], pose[4], pose[5], pose[6]]);
            errors[0] = errors[0].max(distance(pos, data.xpos()[body]));
            errors[1] = errors[1].max(angle(quat, data.xquat()[body]));
        }
    }
    errors
}

#[test]
fn poses_are_those_of_the_engine_within_the_stated_errors() {
    let model = sample::humanoid();
    let trajectory = recorded(&model, 300);
    for (position, rotation) in [(1e-4, 5e-4), (3e-3, 2e-2), (1e-7, 1e-6)] {
        let options = HtmlOptions::default().with_position_error(position).with_rotation_error(rotation);
        let page = saved(&model, &[("", &trajectory)], &options);
        let errors = largest_errors(&page, &model, &trajectory);
        assert!(errors[0] <= position && errors[1] <= rotation, "{errors:?} of {position}, {rotation}");
        // Errors far below the bound would waste space.
        assert!(errors[0] > 0.3 * position && errors[1] > 0.2 * rotation, "{errors:?} of {position}, {rotation}");
    }
}

#[test]
fn the_default_precision_follows_the_extent_of_small_models() {
    let xml = |size: f64| {
        format!(
            "<mujoco><statistic extent='{size}'/><worldbody><body><freejoint/><geom size='{size}'/></body></worldbody></mujoco>"
        )
    };
    for (size, expected) in [(1e-3, 1e-7), (1.0, 1e-4), (50.0, 1e-4)] {
        let model = Model::from_xml_str(&xml(size)).unwrap();
        let trajectory = recorded(&model, 50);
        let [error, _] =
            largest_errors(&saved(&model, &[("", &trajectory)], &HtmlOptions::default()), &model, &trajectory);
        assert!(error > 0.0 && error <= expected, "{error} of {expected}");
    }
}

#[test]
fn frames_have_the_times_of_records() {
    let model = sample::cartpole();
    let trajectory = recorded(&model, 200);
    let page = saved(&model, &[("", &trajectory)], &HtmlOptions::default().with_frames_per_second(25.0));
    let times = page.track(0).times;
    let duration = trajectory.times()[199] - trajectory.times()[0];
    assert!((times.len() as f64 - 25.0 * duration).abs() <= 2.0, "{} frames of {duration} s", times.len());
    for time in &times {
        assert!(trajectory.times().iter().any(|recorded| (recorded - time).abs() <= 5e-7), "{time}");
    }
    assert!((times[times.len() - 1] - trajectory.times()[199]).abs() <= 5e-7, "the last record is kept");
    let all = saved(&model, &[("", &trajectory)], &HtmlOptions::default().with_frames_per_second(f64::INFINITY));
    assert_eq!(all.track(0).times.len(), 200);
}

#[test]
fn signals_are_those_of_the_records_within_the_stated_error() {
    let model = sample::cartpole();
    let trajectory = recorded(&model, 100);
    let heights: Vec<f64> = (0..100).map(|record| f64::from(record).sqrt()).collect();
    let tip = model.sensor("tip_position").unwrap();
    let options = HtmlOptions::default().with_frames_per_second(f64::INFINITY).with_signals([
        Signal::Qpos("hinge".into()),
        Signal::Qvel("slider".into()),
        Signal::Ctrl(model.actuators().next().unwrap().name().unwrap().into()),
        Signal::Sensor("tip_position".into()),
        Signal::Values { name: "height".into(), values: heights.clone() },
    ]);
    let page = saved(&model, &[("", &trajectory)], &options);
    let [slider, hinge] = ["slider", "hinge"].map(|name| model.joint(name).unwrap());
    let mut expected: Vec<(String, Vec<f64>)> = Vec::new();
    let of = |value: &dyn Fn(usize) -> f64| (0..100).map(value).collect::<Vec<f64>>();
    expected.push(("qpos of hinge".into(), of(&|record| trajectory.qpos(record)[hinge.qpos_range().start])));
    expected.push(("qvel of slider".into(), of(&|record| trajectory.qvel(record)[slider.dofs().start])));
    let name = model.actuators().next().unwrap().name().unwrap();
    expected.push((format!("ctrl of {name}"), of(&|record| trajectory.ctrl(record)[0])));
    for (number, at) in tip.data_range().enumerate() {
        let name = if tip.data_range().len() == 1 { "tip_position".into() } else { format!("tip_position [{number}]") };
        expected.push((name, of(&|record| trajectory.sensordata(record)[at])));
    }
    expected.push(("height".into(), heights));
    for (index, (name, values)) in expected.iter().enumerate() {
        let (found, curve) = page.curve(index);
        let (low, high) =
            values.iter().fold((f64::MAX, f64::MIN), |(low, high), &value| (low.min(value), high.max(value)));
        assert_eq!(found, *name);
        for (a, b) in values.iter().zip(&curve) {
            assert!((a - b).abs() <= (high - low) / 131_000.0, "{name}: {a} {b}");
        }
    }
}

#[test]
fn signals_have_the_units_of_joints_and_sensors() {
    let model = Model::from_xml_str(
        "<mujoco><worldbody>
           <body name='free'><freejoint name='free'/><geom size='.1' contype='0' conaffinity='0'/><site name='site'/></body>
           <body><joint name='slide' type='slide'/><joint name='hinge' axis='1 0 0' pos='0 1 0'/><geom size='.1' contype='0'/></body>
           <body><joint name='ball' type='ball'/><geom size='.1' contype='0'/></body>
         </worldbody><actuator><motor name='motor' joint='hinge'/></actuator>
         <sensor><gyro name='gyro' site='site'/><force name='force' site='site'/><torque name='torque' site='site'/>
           <jointpos name='angle' joint='hinge'/></sensor></mujoco>",
    )
    .unwrap();
    for (signal, expected) in [
        (Signal::Qpos("free".into()), &["m", "m", "m", "", "", "", ""][..]),
        (Signal::Qvel("free".into()), &["m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s"]),
        (Signal::Qpos("slide".into()), &["m"]),
        (Signal::Qvel("slide".into()), &["m/s"]),
        (Signal::Qpos("hinge".into()), &["rad"]),
        (Signal::Qvel("ball".into()), &["rad/s"; 3]),
        // The effect of a control depends on the gains of the actuator.
        (Signal::Ctrl("motor".into()), &[""]),
        (Signal::Sensor("gyro".into()), &["rad/s"; 3]),
        (Signal::Sensor("force".into()), &["N"; 3]),
        (Signal::Sensor("torque".into()), &["N m"; 3]),
        (Signal::Sensor("angle".into()), &["rad"]),
    ] {
        let options = HtmlOptions::default().with_signals([signal.clone()]);
        let page = saved(&model, &[("", &recorded(&model, 3))], &options);
        let curves = page.description["tracks"][0]["curves"].as_array().unwrap();
        let units: Vec<&str> = curves.iter().map(|curve| curve["unit"].as_str().unwrap()).collect();
        assert_eq!(units, expected, "{signal:?}");
    }
}

#[test]
fn values_that_are_not_finite_have_gaps() {
    let model = sample::cartpole();
    let trajectory = recorded(&model, 3);
    let signal = Signal::Values { name: "gap".into(), values: vec![1.0, f64::NAN, 2.0] };
    let options = HtmlOptions::default().with_frames_per_second(f64::INFINITY).with_signals([signal]);
    let (_, curve) = saved(&model, &[("", &trajectory)], &options).curve(0);
    assert_eq!([curve[0], curve[2]], [1.0, 2.0]);
    assert!(curve[1].is_nan());
}

#[test]
fn a_camera_that_tracks_has_its_own_frame() {
    let model = Model::from_xml_str(
        "<mujoco><worldbody><camera name='watch' mode='targetbody' target='ball' pos='0 -3 1'/>
           <light name='spot' mode='targetbody' target='ball' pos='0 0 3'/>
           <body name='ball' pos='0 0 2'><freejoint/><geom size='.1'/></body></worldbody></mujoco>",
    )
    .unwrap();
    let trajectory = recorded(&model, 100);
    let page = saved(&model, &[("", &trajectory)], &HtmlOptions::default());
    let (track, frame) = (page.track(0), page.description["look"]["cameras"][0]["frame"].as_u64().unwrap() as usize);
    assert_eq!(frame, model.nbody());
    let mut data = Data::new(model.clone()).unwrap();
    trajectory.apply(99, &mut data).unwrap();
    data.forward().unwrap();
    let [w, x, y, z] = std::array::from_fn(|part| *track.poses[frame][3 + part].last().unwrap());
    // The third column of the rotation matrix: backwards along the view.
    let back = [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)];
    let mat = data.cam_xmat()[0];
    assert!(distance(back, [mat[2], mat[5], mat[8]]) < 1e-3, "{back:?} {mat:?}");
    let light = page.description["look"]["lights"].as_array().unwrap().iter().find(|light| !light["frame"].is_null());
    assert_eq!(light.unwrap()["frame"].as_u64().unwrap() as usize, model.nbody() + 1);
}

#[test]
fn what_cannot_be_shown_is_an_error() {
    let model = sample::cartpole();
    let trajectory = recorded(&model, 10);
    let path = std::env::temp_dir().join("mujoco_safe_never_written.html");
    let save = |trajectory: &Trajectory, options: &HtmlOptions| trajectory.save_html(model.clone(), &path, options);
    let good = HtmlOptions::default();
    let values = Signal::Values { name: "v".into(), values: vec![0.0; 9] };
    for options in [
        good.clone().with_position_error(0.0),
        good.clone().with_position_error(1e-300),
        good.clone().with_rotation_error(f64::NAN),
        good.clone().with_frames_per_second(-1.0),
        good.clone().with_mesh_error(-1.0),
        good.clone().with_mesh_error(f64::NAN),
        good.clone().with_spacing(0.0),
        good.clone().with_spacing(f64::INFINITY),
    ] {
        assert!(matches!(save(&trajectory, &options), Err(Error::Invalid { .. })), "{options:?}");
    }
    assert!(matches!(save(&trajectory, &good.clone().with_signals([values])), Err(Error::Shape { .. })));
    for options in [good.clone().with_camera("none"), good.clone().with_signals([Signal::Qpos("none".into())])] {
        assert!(matches!(save(&trajectory, &options), Err(Error::NoSuchName { .. })), "{options:?}");
    }
    assert!(matches!(save(&Trajectory::new(&model), &good), Err(Error::Invalid { .. })));
    assert!(save(&recorded(&sample::humanoid(), 2), &good).is_err());
    assert!(matches!(mujoco_safe::html::save(&path, model.clone(), [], &good), Err(Error::Invalid { .. })));
    assert!(!path.exists());
    let missing = std::env::temp_dir().join("mujoco_safe_no_folder").join("page.html");
    assert!(matches!(trajectory.save_html(model.clone(), missing, &good), Err(Error::File { .. })));
}
