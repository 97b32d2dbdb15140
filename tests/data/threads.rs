//! One model in many threads.
#![forbid(unsafe_code)]

use std::sync::{Arc, Barrier};
use std::thread;

use mujoco_safe::data::Warning;
use mujoco_safe::{Data, Differences, Error, Model, RandomController, Trajectory, sample};

use crate::trouble;

fn is_send<T: Send>() {}
fn is_sync<T: Sync>() {}

#[test]
fn models_and_simulations_are_send_and_sync() {
    is_send::<Model>();
    is_sync::<Model>();
    is_send::<Data>();
    is_sync::<Data>();
    is_send::<Error>();
    is_sync::<Error>();
}

/// Records a second of random motion.
fn motion(model: &Arc<Model>, seed: u64) -> Trajectory {
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(model);
    trajectory.record(&mut data, &mut RandomController::new(seed), 200).unwrap();
    trajectory
}

#[test]
fn simulations_in_several_threads_equal_those_in_one_thread() {
    let model = Arc::new(sample::humanoid());
    let alone: Vec<Trajectory> = (0..8).map(|seed| motion(&model, seed)).collect();
    let together: Vec<Trajectory> = thread::scope(|scope| {
        let threads: Vec<_> = (0..8)
            .map(|seed| {
                scope.spawn({
                    let model = &model;
                    move || motion(model, seed)
                })
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert!(alone == together, "the same seeds gave different motions");
    assert!(alone[0] != alone[1], "different seeds gave the same motion");
}

#[test]
fn models_load_in_several_threads_and_errors_do_not_mix() {
    thread::scope(|scope| {
        for index in 0..4 {
            scope.spawn(move || {
                for _ in 0..20 {
                    let good = format!(r#"<mujoco><worldbody><geom name="g{index}" size=".1"/></worldbody></mujoco>"#);
                    let invalid = format!("<mujoco><worldbody><wrong{index}/></worldbody></mujoco>");
                    let model = Model::from_xml_str(&good).unwrap();
                    assert_eq!(model.geom(0).unwrap().name(), Some(&*format!("g{index}")));
                    let error = Model::from_xml_str(&invalid).unwrap_err().to_string();
                    assert!(error.contains(&format!("'wrong{index}'")), "{error}");
                }
            });
        }
    });
}

#[test]
fn several_threads_can_read_one_simulation() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    data.forward().unwrap();
    let torso = data.model().body("torso").unwrap().id();
    let expected = data.jac_body_com(torso).unwrap();
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(data.jac_body_com(torso).unwrap(), expected));
        }
    });
}

/// Models and a folder shared by all threads.
struct Shared {
    humanoid: Arc<Model>,
    overflowing: Arc<Model>,
    crowded: Arc<Model>,
    warning: (Arc<Model>, Warning),
    folder: tempfile::TempDir,
}

/// The result of a job: a text, and the bits of numbers.
type Outcome = (String, Vec<u64>);

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn motion_outcome(model: &Arc<Model>, seed: u64) -> Outcome {
    let trajectory = motion(model, seed);
    (format!("{} records", trajectory.len()), bits(trajectory.states()))
}

/// One job of each kind. The number distinguishes the models, seeds and errors of one thread from
/// those of another.
const JOBS: [fn(&Shared, u64) -> Outcome; 9] = [
    |shared, number| motion_outcome(&shared.humanoid, number),
    |_, number| motion_outcome(&Arc::new(Model::from_xml_str(&trouble::pendulum(number)).unwrap()), number),
    |_, number| {
        let invalid = format!("<mujoco><worldbody>\n<wrong{number}/></worldbody></mujoco>");
        (Model::from_xml_str(&invalid).unwrap_err().to_string(), vec![])
    },
    // The engine raises an error, and works after a reset.
    |shared, _| {
        let mut data = Data::new(shared.overflowing.clone()).unwrap();
        let failures = [(); 3].map(|()| {
            let steps = (0..200).take_while(|_| data.step().is_ok()).count();
            let error = data.step().unwrap_err();
            data.reset().unwrap();
            format!("{steps} steps, {error}")
        });
        data.step().unwrap();
        (failures.join("; "), bits(data.qpos()))
    },
    // The engine warns.
    |shared, _| {
        let (model, warning) = &shared.warning;
        let mut data = Data::new(model.clone()).unwrap();
        (0..20).for_each(|_| data.step().unwrap());
        (format!("{:?}", data.warning(*warning)), bits(&data.physics_state()))
    },
    // A NaN in one simulation only.
    |shared, number| {
        let mut data = Data::new(shared.humanoid.clone()).unwrap();
        data.qvel_mut()[number as usize] = f64::NAN;
        (data.step().unwrap_err().to_string(), vec![])
    },
    // Saves as XML. The engine keeps only the XML of the last model that the process loaded.
    |shared, number| {
        let path = shared.folder.path().join(format!("{number}.xml"));
        for _ in 0..10_000 {
            let model = Model::from_xml_str(&trouble::pendulum(number)).unwrap();
            match model.save_xml(&path) {
                Err(Error::XmlReplaced) => {}
                saved => {
                    saved.unwrap();
                    let bytes = model.to_binary().unwrap().into_iter().map(u64::from).collect();
                    return (std::fs::read_to_string(path).unwrap(), bytes);
                }
            }
        }
        panic!("other threads loaded a model between each load and save");
    },
    |shared, number| {
        let bytes = shared.crowded.to_binary().unwrap();
        let error = Model::from_binary(&bytes[..bytes.len() - 1 - number as usize]).unwrap_err().to_string();
        // Binary models load with 2.2.2 and 3.5.0 only.
        let model = match Model::from_binary(&bytes) {
            Err(Error::Unsupported(_)) if cfg!(not(validates_binaries)) => shared.crowded.clone(),
            loaded => Arc::new(loaded.unwrap()),
        };
        (error, motion_outcome(&model, number).1)
    },
    |_, number| {
        let mut data = Data::new(Model::from_xml_str(&trouble::pendulum(number)).unwrap()).unwrap();
        let system = data.transition_fd(1e-6, Differences::Central).unwrap();
        (String::new(), bits(system.b.as_slice()))
    },
];

#[test]
fn concurrent_jobs_give_the_results_of_sequential_jobs() {
    const THREADS: u64 = 6;
    let (warning_model, warning) = trouble::warning();
    let shared = Shared {
        humanoid: Arc::new(sample::humanoid()),
        overflowing: Arc::new(trouble::overflowing()),
        crowded: Arc::new(trouble::crowded()),
        warning: (Arc::new(warning_model), warning),
        folder: tempfile::tempdir().unwrap(),
    };
    let expected: Vec<Vec<Outcome>> =
        (0..THREADS).map(|number| JOBS.iter().map(|job| job(&shared, number)).collect()).collect();
    // The jobs have the intended results.
    let texts: Vec<&str> = expected[3].iter().map(|(text, _)| text.as_str()).collect();
    assert!(texts[2].contains("'wrong3'") && texts[2].contains("line 2"), "{}", texts[2]);
    assert!(texts[3].contains(trouble::STACK_OVERFLOW), "{}", texts[3]);
    assert!(!texts[4].contains("number: 0,"), "{}", texts[4]);
    assert!(cfg!(engine_since = "2.3.0") || texts[4].contains("number: 40, lastinfo: 2"), "{}", texts[4]);
    assert!(texts[6].contains("j3"), "{}", texts[6]);
    assert!(expected[3][8].1 != expected[4][8].1, "the models differ");

    let barrier = Barrier::new(THREADS as usize);
    thread::scope(|scope| {
        for number in 0..THREADS {
            let (shared, expected, barrier) = (&shared, &expected[number as usize], &barrier);
            scope.spawn(move || {
                barrier.wait();
                // Each thread starts with another job.
                for index in (0..2 * JOBS.len()).map(|index| (index + number as usize) % JOBS.len()) {
                    let (text, numbers) = JOBS[index](shared, number);
                    assert_eq!(text, expected[index].0, "job {index} of thread {number}");
                    assert!(numbers == expected[index].1, "job {index} of thread {number} gave different numbers");
                }
            });
        }
    });
}

/// A thread-local that loads and simulates in its destructor, after the thread's other
/// thread-locals.
struct Late(Option<Data>);

impl Drop for Late {
    fn drop(&mut self) {
        let model = Model::from_xml_str("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>").unwrap();
        let mut data = self.0.take().unwrap();
        data.step().unwrap();
        assert_eq!(model.ngeom(), 1);
    }
}

#[test]
fn a_thread_local_destructor_can_load_and_simulate() {
    thread_local! {
        static LATE: std::cell::RefCell<Option<Late>> = const { std::cell::RefCell::new(None) };
    }
    let ended = thread::spawn(|| {
        // Initialised first, so that it is dropped last.
        LATE.set(Some(Late(None)));
        LATE.with_borrow_mut(|late| late.as_mut().unwrap().0 = Some(Data::new(sample::cartpole()).unwrap()));
    });
    ended.join().unwrap();
}
