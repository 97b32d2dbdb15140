//! Flight recorder: repetition bit for bit, in the same and in another process.

use std::path::{Path, PathBuf};

use mujoco_safe::callback::Callbacks;
use mujoco_safe::enums::Integrator;
use mujoco_safe::flight::{FlightRecorder, Recording};
use mujoco_safe::{Controller, Data, Error, Model, RandomController, sample};

use crate::cases::cases;
use crate::child;

/// Variable with the directory of the files that the child process repeats.
const FILES: &str = "MUJOCO_SAFE_FLIGHT_FILES";

/// Asserts that a recording is repeated bit for bit, and ends in the state of a simulation.
#[track_caller]
fn assert_repeats(recording: &Recording, data: &Data) {
    let repeat = recording.repeat().unwrap();
    let calls = recording.calls();
    assert_eq!((repeat.difference, repeat.calls), (None, calls.end - calls.start));
    let end = recording.data_after(calls.end - 1).unwrap();
    let bits = |data: &Data| data.physics_state().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&end), bits(data));
    assert_eq!(end.time().to_bits(), data.time().to_bits());
}

fn scene() -> Model {
    Model::from_xml_str(
        r#"<mujoco><size nuserdata="3"/><worldbody><geom type="plane" size="5 5 .1"/>
             <body name="hand" mocap="true" pos="0 0 .5"/>
             <body name="cube" pos="0 0 .2"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
             <body name="arm" pos="1 0 1"><joint name="j" axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 .4 0 0"/></body>
           </worldbody>
           <equality><weld name="grasp" body1="hand" body2="cube" active="false"/></equality>
           <actuator><general joint="j" dyntype="filter" dynprm=".1" gainprm="5"/></actuator>
           <keyframe><key name="k" qpos="0 0 1 1 0 0 0 .3"/></keyframe></mujoco>"#,
    )
    .unwrap()
}

#[test]
fn changes_of_every_kind_are_repeated() {
    let mut data = Data::new(scene()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_memory(1 << 20);
    let changes: [fn(&mut Data); 20] = [
        |data| data.ctrl_mut()[0] = 0.7,
        |data| data.qpos_mut()[7] = 0.2,
        |data| data.qvel_mut()[3] = -0.0,
        |data| data.act_mut()[0] = 0.1,
        |data| data.qfrc_applied_mut()[6] = 0.3,
        |data| data.xfrc_applied_mut()[2][1] = 4.0,
        |data| data.mocap_pos_mut()[0][2] += 0.01,
        |data| data.mocap_quat_mut()[0] = [0.8, 0.6, 0.0, 0.0],
        |data| data.userdata_mut()[1] = 3.0,
        |data| data.qacc_warmstart_mut()[2] = 9.0,
        |data| data.set_time(100.0),
        |data| data.weld_at_present_pose("grasp").unwrap(),
        |data| data.set_equality_active("grasp", false).unwrap(),
        |data| data.edit_model(|model| model.body_mass_mut()[2] *= 2.0).unwrap(),
        |data| data.edit_model(|model| model.edit_options(|options| options.integrator = Integrator::Rk4)).unwrap(),
        |data| data.edit_model(|model| model.update_constants()).unwrap(),
        |data| data.step().unwrap(), // not recorded
        |data| data.inverse().unwrap(),
        |data| data.reset_to_key("k").unwrap(),
        |data| data.reset().unwrap(),
    ];
    for (index, change) in changes.iter().enumerate() {
        change(&mut data);
        for _ in 0..3 {
            recorder.step(&mut data).unwrap();
        }
        if index % 2 == 0 {
            recorder.step1(&mut data).unwrap();
            data.ctrl_mut()[0] += 0.1;
            recorder.step2(&mut data).unwrap();
        } else {
            recorder.forward(&mut data).unwrap();
        }
    }
    data.ctrl_mut()[0] = f64::NAN;
    recorder.step(&mut data).unwrap_err();
    data.ctrl_mut()[0] = 0.0;
    recorder.step(&mut data).unwrap();
    data.adopt(sample::cartpole()).unwrap();
    recorder.step(&mut data).unwrap();
    let recording = recorder.recording();
    assert_eq!(recording.calls(), 0..recorder.calls());
    assert_repeats(&recording, &data);
}

#[test]
fn the_ring_keeps_the_last_calls_within_its_memory() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_memory(300_000);
    let (mut random, steps) = (RandomController::new(3), 3000);
    for _ in 0..steps {
        random.control(&mut data).unwrap();
        recorder.step(&mut data).unwrap();
    }
    let recording = recorder.recording();
    let calls = recording.calls();
    assert_eq!(calls.end, steps);
    assert!(calls.start > 0 && calls.end - calls.start > 500, "{calls:?}");
    let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    recorder.write(&path).unwrap();
    let model = data.model().to_binary().unwrap().len() as u64;
    assert!(std::fs::metadata(&path).unwrap().len() < 300_000 + model + 1000);
    assert_repeats(&Recording::read(&path).unwrap(), &data);
}

#[test]
fn edits_in_each_step_are_within_the_memory() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_memory(100_000);
    for step in 0..500 {
        data.edit_model(|model| model.body_mass_mut()[1] = 1.0 + 0.01 * f64::from(step)).unwrap();
        recorder.step(&mut data).unwrap();
    }
    let recording = recorder.recording();
    assert!(recording.calls().start > 0 && recording.calls().end - recording.calls().start > 50, "{recording:?}");
    assert_repeats(&recording, &data);
}

#[test]
fn a_call_is_found_and_continued() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap();
    let mut heights = Vec::new();
    for _ in 0..200 {
        recorder.step(&mut data).unwrap();
        heights.push(data.qpos()[2]);
    }
    let recording = recorder.recording();
    let limit = heights[120];
    let fallen = heights.iter().position(|&height| height <= limit).unwrap() as u64;
    assert_eq!(recording.first(|data| data.qpos()[2] <= limit).unwrap(), Some(fallen));
    assert_eq!(recording.first(|data| data.qpos()[2] > 9.0).unwrap(), None);
    let mut before = recording.data_before(fallen).unwrap();
    before.step().unwrap();
    assert_eq!(before.qpos(), recording.data_after(fallen).unwrap().qpos());
    assert_eq!(before.qpos()[2], heights[fallen as usize]);
}

#[test]
fn bisection_finds_the_same_call_with_fewer_steps() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_memory(300_000);
    let mut random = RandomController::new(3);
    for _ in 0..2000 {
        random.control(&mut data).unwrap();
        recorder.step(&mut data).unwrap();
    }
    let recording = recorder.recording();
    let (calls, all) = (recording.calls(), recording.calls().end - recording.calls().start);
    let timestep = data.model().timestep();
    for call in [calls.start, calls.start + 1, calls.start + all / 2, calls.end - 1] {
        let (is_past, mut tests) = (|data: &Data| data.time() > (call as f64 + 0.5) * timestep, 0);
        let found = recording.first_by_bisection(|data| {
            tests += 1;
            is_past(data)
        });
        assert_eq!(found.unwrap(), Some(call));
        assert!(tests < all / 5, "{tests} of {all} calls");
        assert_eq!(recording.first(is_past).unwrap(), Some(call));
    }
    assert_eq!(recording.first_by_bisection(|_| false).unwrap(), None);
    // The segments of an edited model.
    let mut recorder = FlightRecorder::new(&data).unwrap();
    for step in 0..20 {
        data.edit_model(|model| model.body_mass_mut()[1] = 9.0 + 0.1 * f64::from(step)).unwrap();
        recorder.step(&mut data).unwrap();
    }
    let found = recorder.recording().first_by_bisection(|data| data.model().body_mass()[1] > 9.95);
    assert_eq!(found.unwrap(), Some(10));
}

#[test]
fn the_file_is_written_after_an_error_and_during_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let [error, panic] = ["error", "panic"].map(|name| folder.path().join(name));
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_file(&error).with_note("seed 7");
    recorder.step(&mut data).unwrap();
    assert!(!error.exists());
    data.set_callbacks(Callbacks::new().with_passive(|_| panic!("on purpose")));
    let failure = recorder.step(&mut data).unwrap_err();
    let recording = Recording::read(&error).unwrap();
    assert_eq!((recording.note(), recording.reason()), ("seed 7", &*failure.to_string()));
    assert_eq!(recording.calls(), 0..2);

    let path = panic.clone();
    let thread = std::thread::spawn(move || {
        let mut data = Data::new(sample::cartpole()).unwrap();
        let mut recorder = FlightRecorder::new(&data).unwrap().with_file(path);
        (0..5).for_each(|_| recorder.step(&mut data).unwrap());
        panic!("on purpose");
    });
    thread.join().unwrap_err();
    let recording = Recording::read(&panic).unwrap();
    assert_eq!((recording.reason(), recording.calls()), ("the thread panicked", 0..5));
    assert_eq!(recording.repeat().unwrap().difference, None);
}

#[test]
fn a_control_closure_is_repeated_without_it() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.set_callbacks(Callbacks::new().with_control(|control| {
        let value = control.qvel()[0].sin();
        control.ctrl_mut().fill(value);
        control.qfrc_applied_mut()[1] = 10.0 * value;
    }));
    let mut recorder = FlightRecorder::new(&data).unwrap();
    data.qvel_mut()[0] = 0.3;
    (0..50).for_each(|_| recorder.step(&mut data).unwrap());
    assert_repeats(&recorder.recording(), &data);

    // The Runge-Kutta integrator calls the closure four times.
    data.edit_model(|model| model.edit_options(|options| options.integrator = Integrator::Rk4)).unwrap();
    recorder.step(&mut data).unwrap();
    let difference = recorder.recording().repeat().unwrap().difference.unwrap();
    assert!(difference.call == 50 && difference.reason.contains("callbacks"), "{difference}");
}

#[test]
fn what_was_not_recorded_is_detected() {
    // The recorder misses the first half of a step.
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap();
    data.step1().unwrap();
    recorder.step2(&mut data).unwrap();
    let recording = recorder.recording();
    let difference = recording.repeat().unwrap().difference.unwrap();
    assert!(difference.reason.contains("succeeded when recorded, but failed"), "{difference}");
    let error = recording.data_after(0).unwrap_err();
    assert!(matches!(error, Error::NotRepeated { call: 0, .. }), "{error}");

    // Other arithmetic, as of another processor: a bit of the recorded checksum.
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap();
    (0..3).for_each(|_| recorder.step(&mut data).unwrap());
    let recording = recorder.recording();
    let mut lies = 0;
    let repeat = recording.repeat_with(|data| {
        lies += 1;
        data.set_callbacks(Callbacks::new().with_passive(|passive| passive.qfrc_passive_mut()[0] += 1e-15));
    });
    assert_eq!((lies, repeat.unwrap().difference.unwrap().call), (1, 0));
}

/// Random simulation that fails: huge or invalid controls, forces, velocities, or a small stack.
fn fail(seed: u64, file: &Path) {
    let models = [sample::cartpole, sample::hopper, sample::half_cheetah, scene];
    let mut data = Data::new(models[seed as usize % models.len()]()).unwrap();
    let mut recorder = FlightRecorder::new(&data).unwrap().with_memory(1 << 18).with_file(file);
    let mut random = RandomController::new(seed);
    let trouble = [1e3, -1e9, 1e12, f64::NAN, f64::INFINITY][seed as usize / 4 % 5];
    let begin = seed % 17;
    for step in 0..400 {
        random.control(&mut data).unwrap();
        if step % 5 == 4 {
            data.edit_model(|model| model.dof_damping_mut()[0] += 0.01).unwrap();
        }
        if step >= begin {
            match seed / 20 % 4 {
                0 => data.ctrl_mut()[0] = trouble,
                1 => data.qfrc_applied_mut()[0] = 100.0 * trouble,
                2 => data.qvel_mut()[1] = trouble,
                _ => data.xfrc_applied_mut()[1] = [trouble; 6],
            }
        }
        if recorder.step(&mut data).is_err() {
            return;
        }
    }
    // Forces that the simulation bears.
    data.qpos_mut()[0] = f64::NAN;
    recorder.step(&mut data).unwrap_err();
}

fn files(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn failures_are_repeated_in_another_process() {
    let folder = tempfile::tempdir().unwrap();
    let count = std::env::var("FAILURES").map_or(cases(80, 200), |number| number.parse().unwrap());
    (0..count).for_each(|seed| fail(seed, &folder.path().join(seed.to_string())));
    assert_eq!(files(folder.path()).len() as u64, count);
    let output = child::command("flight::repeats_the_files").env(FILES, folder.path()).output().unwrap();
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{stdout}{}", String::from_utf8_lossy(&output.stderr));
    assert!(stdout.contains(&format!("{count} repeated")), "{stdout}");
}

#[test]
fn repeats_the_files() {
    let Some(folder) = std::env::var_os(FILES) else { return };
    let files = files(folder.as_ref());
    let mut kinds = std::collections::BTreeSet::new();
    for file in &files {
        let recording = Recording::read(file).unwrap();
        let repeat = recording.repeat().unwrap();
        assert_eq!(repeat.difference, None, "{}", file.display());
        let calls = recording.calls();
        assert_eq!(repeat.calls, calls.end - calls.start);
        let failed = recording.data_before(calls.end - 1).unwrap().step().unwrap_err();
        assert_eq!(failed.to_string(), recording.reason());
        kinds.insert(recording.reason().split([' ', '[']).next().unwrap_or_default().to_owned());
    }
    assert!(kinds.len() >= 2, "{kinds:?}");
    println!("{} repeated", files.len());
}
