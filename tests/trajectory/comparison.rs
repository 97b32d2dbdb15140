//! Comparison of engines: differences planted in a model are found at their step, stage and
//! element; the same engine has none; damaged traces are errors.

use mujoco_safe::enums::Integrator;
use mujoco_safe::flight::{Comparison, Divergence, Tracer};
use mujoco_safe::{Controller, Data, Error, Model, ModelMut, RandomController, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

const SCENE: &str = r#"<mujoco><worldbody><geom name="floor" type="plane" size="5 5 .1"/>
     <body name="cube" pos="0 0 .1"><freejoint/><geom name="box" type="box" size=".1 .1 .1"/></body>
     <body name="ball" pos="1 0 .2"><freejoint/><geom name="sphere" size=".2"/></body>
     <body name="arm" pos="0 2 1"><joint name="shoulder" axis="0 1 0" limited="false"/>
       <geom name="link" type="capsule" size=".05" fromto="0 0 0 .4 0 0"/><site name="tip" pos=".4 0 0"/></body>
   </worldbody>
   <tendon><fixed name="cord"><joint joint="shoulder" coef="2"/></fixed></tendon>
   <actuator><motor name="motor" joint="shoulder" gear="3"/><general name="servo" joint="shoulder" dyntype="filter"
     dynprm=".1" gainprm="5"/></actuator>
   <sensor><framepos name="place" objtype="site" objname="tip"/><gyro name="turn" site="tip"/>
     <accelerometer name="push" site="tip" cutoff="1000"/></sensor></mujoco>"#;

fn scene() -> Model {
    Model::from_xml_str(SCENE).unwrap()
}

/// Returns a trace of ten steps with random controls, and an edit before one of them.
fn trace(model: Model, edit: impl Fn(u32, &mut Data)) -> Vec<u8> {
    let mut data = Data::new(model).unwrap();
    *data.qvel_mut().last_mut().unwrap() = 0.3;
    let mut tracer = Tracer::new(Vec::new(), Some(SCENE)).unwrap();
    let mut random = RandomController::new(1);
    for step in 0..10 {
        edit(step, &mut data);
        random.control(&mut data).unwrap();
        tracer.step(&mut data).unwrap();
    }
    tracer.finish().unwrap()
}

/// Compares a trace, in which an edit precedes call 4, with the model without it.
fn planted(edit: impl Fn(&mut ModelMut<'_>)) -> Vec<Divergence> {
    let edit = |step, data: &mut Data| {
        if step == 4 {
            data.edit_model(|model| edit(model)).unwrap();
        }
    };
    let comparison = Comparison::new(&trace(scene(), edit)[..], Some(&scene())).unwrap();
    assert_eq!(comparison.calls, 10);
    assert!(comparison.divergences.iter().all(|divergence| divergence.call >= 4), "{comparison}");
    comparison.divergences
}

#[track_caller]
fn assert_found(divergences: &[Divergence], stage: &str, field: &str, element: &str, values: Option<[f64; 2]>) {
    let of_stage = |divergence: &&Divergence| (divergence.stage == "model") == (stage == "model");
    let first = divergences.iter().find(of_stage).expect("a difference");
    assert_eq!(
        (first.call, first.stage, &*first.field, &*first.element),
        (4, stage, field, element),
        "{divergences:#?}"
    );
    if let Some(values) = values {
        assert_eq!([first.there, first.here], values);
    }
}

#[test]
fn a_changed_mass_is_found() {
    let heavier = planted(|model| {
        let ball = model.body("ball").unwrap().index();
        model.body_mass_mut()[ball] *= 1.001;
    });
    let mass = scene().body_mass()[2];
    assert_found(&heavier, "model", "body_mass", "body 'ball'", Some([mass * 1.001, mass]));
    let first = heavier.iter().find(|divergence| divergence.stage != "model").unwrap();
    assert_eq!((first.call, first.stage), (4, "com_pos"), "{heavier:#?}");
    let inertia = heavier.iter().find(|divergence| divergence.field == "cinert").unwrap();
    assert!(inertia.element.starts_with("body 'ball'"), "{inertia}");
}

#[test]
fn changed_friction_is_found() {
    let slippery = planted(|model| {
        for geom in ["floor", "box"] {
            let geom = model.geom(geom).unwrap().index();
            model.geom_friction_mut()[geom][0] = 0.9;
        }
    });
    assert_eq!(slippery[0].field, "geom_friction");
    let first = slippery.iter().find(|divergence| divergence.stage != "model").unwrap();
    assert_eq!((first.call, first.stage, &*first.field), (4, "collision", "contact.friction"));
    assert!(first.element.contains("of geom 'floor' and geom 'box'"), "{first}");
    assert_eq!([first.there, first.here], [0.9, 1.0]);
}

#[test]
fn changes_of_actuators_sensors_and_sites_are_found() {
    let weaker = planted(|model| model.actuator_gainprm_mut()[1][0] = 4.9);
    assert_found(&weaker, "model", "actuator_gainprm", "actuator 'servo'[0]", Some([4.9, 5.0]));
    assert_found(&weaker, "fwd_actuation", "actuator_force", "actuator 'servo'", None);
    let geared = planted(|model| model.actuator_gear_mut()[0][0] = 3.001);
    assert_found(&geared, "transmission", "actuator_length", "actuator 'motor'", None);
    let limited = planted(|model| model.sensor_cutoff_mut()[2] = 0.5);
    assert_found(&limited, "sensors", "sensordata", "sensor 'push'", None);
    let moved = planted(|model| model.site_pos_mut()[0][0] += 1e-6);
    assert_found(&moved, "kinematics", "site_xpos", "site 'tip'[0]", None);
}

#[test]
fn a_changed_option_is_found() {
    let integrated = planted(|model| model.edit_options(|options| options.integrator = Integrator::Rk4).unwrap());
    assert_found(&integrated, "model", "opt.integrator", "the model", None);
    let first = integrated.iter().find(|divergence| divergence.stage != "model").unwrap();
    assert_eq!((first.call, first.stage), (4, "integration"), "{integrated:#?}");
    let loose = planted(|model| model.edit_options(|options| options.tolerance = 1e-3).unwrap());
    // Only the tolerance differs: the solver explains the rest.
    assert_eq!(loose.len(), 1, "{loose:#?}");
}

#[test]
fn the_same_engine_has_no_difference() {
    for model in [sample::cartpole(), sample::humanoid(), scene()] {
        let comparison = Comparison::new(&trace(model.clone(), |_, _| ())[..], Some(&model)).unwrap();
        assert_eq!((comparison.calls, comparison.identical), (10, 10), "{comparison}");
        assert!(comparison.divergences.is_empty() && comparison.convergence.is_empty(), "{comparison}");
        assert!(comparison.other_fields.is_empty(), "{comparison}");
    }
}

/// The last bits of the inertia of a body are another compiler's.
#[test]
fn rounding_is_no_difference() {
    let edit = |step: u32, data: &mut Data| {
        if step == 4 {
            data.edit_model(|model| {
                for mass in model.body_mass_mut() {
                    *mass *= 1.0 + 2.0 * f64::EPSILON;
                }
            })
            .unwrap();
        }
    };
    let comparison = Comparison::new(&trace(scene(), edit)[..], Some(&scene())).unwrap();
    assert!(comparison.divergences.is_empty(), "{comparison}");
    assert_eq!(comparison.identical, 4);
}

#[test]
fn the_model_of_the_trace_and_its_edits_are_used() {
    let edit = |step: u32, data: &mut Data| {
        if step == 4 {
            data.edit_model(|model| model.geom_friction_mut()[0][0] = 2.0).unwrap();
        }
    };
    let comparison = Comparison::new(&trace(scene(), edit)[..], None).unwrap();
    assert_eq!((comparison.calls, comparison.identical), (10, 10), "{comparison}");
}

#[test]
#[cfg(validates_binaries)]
fn a_recording_is_traced() {
    let mut data = Data::new(scene()).unwrap();
    let mut recorder = mujoco_safe::flight::FlightRecorder::new(&data).unwrap();
    let mut random = RandomController::new(2);
    for step in 0..10 {
        if step == 6 {
            data.edit_model(|model| model.edit_options(|options| options.integrator = Integrator::Rk4)).unwrap();
        }
        random.control(&mut data).unwrap();
        recorder.step(&mut data).unwrap();
    }
    let trace = recorder.recording().trace(Vec::new()).unwrap();
    let own = Comparison::new(&trace[..], None).unwrap();
    assert_eq!((own.calls, own.identical), (10, 10), "{own}");
    let without = Comparison::new(&trace[..], Some(&scene())).unwrap();
    assert_eq!((&*without.divergences[0].field, without.divergences[0].call), ("opt.integrator", 6), "{without}");
    assert_eq!(without.identical, 6);
}

#[test]
fn errors_of_a_step_are_compared() {
    let mut data = Data::new(scene()).unwrap();
    let mut tracer = Tracer::new(Vec::new(), None).unwrap();
    tracer.step(&mut data).unwrap();
    data.qvel_mut()[0] = f64::NAN;
    tracer.step(&mut data).unwrap_err();
    let trace = tracer.finish().unwrap();
    let comparison = Comparison::new(&trace[..], Some(&scene())).unwrap();
    assert_eq!((comparison.calls, comparison.identical), (2, 2), "{comparison}");
}

#[test]
fn another_structure_is_an_error_that_names_the_input() {
    let trace = trace(scene(), |_, _| ());
    let error = Comparison::new(&trace[..], Some(&sample::cartpole())).unwrap_err();
    assert!(matches!(&error, Error::NotRepeated { reason, .. } if reason.contains("qpos")), "{error}");
}

/// A stranger can compute the checksums, so half of the cases correct them.
#[test]
fn damaged_traces_are_errors() {
    let model = Model::from_xml_str("<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>");
    let model = model.unwrap();
    let file = trace(model.clone(), |_, _| ());
    for length in (0..300).chain((0..file.len()).step_by(997)) {
        let error = Comparison::new(&file[..length], Some(&model)).unwrap_err();
        assert!(matches!(error, Error::InvalidRecording { .. }), "{length}: {error}");
    }
    let records = records(&file);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut rejected = 0;
    for case in 0..300 {
        let mut hostile = file.clone();
        let (start, end) = records[random.random_range(0..records.len())];
        for _ in 0..=case % 3 {
            let place = random.random_range(start - 8..end);
            match random.random_range(0..3) {
                0 => hostile[place] = random.random(),
                1 => hostile[place] = u8::MAX,
                _ => hostile[place..(place + 8).min(end)].fill([0, u8::MAX][case % 2]),
            }
        }
        if case % 2 == 0 {
            let checksum = checksum(&hostile[start..end]);
            hostile[end..end + 8].copy_from_slice(&checksum.to_le_bytes());
        }
        let given = (case % 4 < 2).then_some(&model);
        match Comparison::new(&hostile[..], given) {
            Ok(comparison) => drop(comparison.to_string()),
            Err(_) => rejected += 1,
        }
    }
    assert!(rejected > 150, "{rejected}");
}

/// Returns the places of the contents of the records.
fn records(file: &[u8]) -> Vec<(usize, usize)> {
    let (mut records, mut place) = (Vec::new(), 8 + 4);
    while place < file.len() {
        let length = u64::from_le_bytes(file[place..place + 8].try_into().unwrap()) as usize;
        records.push((place + 8, place + 8 + length));
        place += 8 + length + 8;
    }
    records
}

/// The checksum of the format.
fn checksum(bytes: &[u8]) -> u64 {
    let mix = |lane: u64, word: u64| (lane ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    let (words, rest) = bytes.as_chunks::<8>();
    let mut lanes = [1, 2, 3, 4];
    let mut add = |index: usize, word: u64| lanes[index % 4] = mix(lanes[index % 4], word);
    words.iter().enumerate().for_each(|(index, word)| add(index, u64::from_le_bytes(*word)));
    rest.iter().enumerate().for_each(|(index, &byte)| add(index, byte.into()));
    let all = lanes.iter().fold((words.len() + rest.len()) as u64, |all, &lane| mix(all, lane));
    all ^ (all >> 32)
}
