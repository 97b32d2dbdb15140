//! One model, any number of threads.
#![forbid(unsafe_code)]

use std::sync::{Arc, Barrier};
use std::thread;

use mujoco_safe::{Data, Differences, Error, Model, RandomController, Trajectory, Warning, sample};

use crate::trouble;

fn is_send<T: Send>() {}
fn is_sync<T: Sync>() {}

#[test]
fn models_are_shared_and_simulations_are_sent_between_threads() {
    is_send::<Model>();
    is_sync::<Model>();
    is_send::<Data>();
    is_sync::<Data>();
    is_send::<Error>();
    is_sync::<Error>();
}

/// A second of random motion.
fn motion(model: &Arc<Model>, seed: u64) -> Trajectory {
    let mut data = Data::new(model.clone()).expect("there is memory");
    let mut trajectory = Trajectory::new(model);
    trajectory.record(&mut data, &mut RandomController::new(seed), 200).expect("it is stable");
    trajectory
}

#[test]
fn simulations_of_one_model_in_several_threads_are_those_of_one_thread() {
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
        threads.into_iter().map(|thread| thread.join().expect("it does not panic")).collect()
    });
    assert!(alone == together, "the same seeds gave other motions");
    assert!(alone[0] != alone[1], "different seeds gave the same motion");
}

#[test]
fn models_load_in_several_threads_at_once_and_each_error_stays_in_its_own() {
    thread::scope(|scope| {
        for index in 0..4 {
            scope.spawn(move || {
                for _ in 0..20 {
                    let good = format!(r#"<mujoco><worldbody><geom name="g{index}" size=".1"/></worldbody></mujoco>"#);
                    let bad = format!("<mujoco><worldbody><wrong{index}/></worldbody></mujoco>");
                    let model = Model::from_xml_str(&good).expect("it is valid");
                    assert_eq!(model.geom(0).expect("there is one").name(), Some(&*format!("g{index}")));
                    let error = Model::from_xml_str(&bad).expect_err("it is not valid").to_string();
                    assert!(error.contains(&format!("'wrong{index}'")), "{error}");
                }
            });
        }
    });
}

#[test]
fn a_simulation_is_read_by_several_threads_at_once() {
    let mut data = Data::new(sample::humanoid()).expect("there is memory");
    data.reset_to_key("stand").expect("it has this keyframe");
    data.forward().expect("the engine computes");
    let torso = data.model().body("torso").expect("it has a torso").id();
    let expected = data.jac_body_com(torso).expect("positions are computed");
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(data.jac_body_com(torso).expect("positions are computed"), expected));
        }
    });
}

/// What all threads of a storm share.
struct Shared {
    humanoid: Arc<Model>,
    overflowing: Arc<Model>,
    crowded: Arc<Model>,
    folder: tempfile::TempDir,
}

/// What a job came to: a text, and the bits of numbers.
type Outcome = (String, Vec<u64>);

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn moved(model: &Arc<Model>, seed: u64) -> Outcome {
    let trajectory = motion(model, seed);
    (format!("{} records", trajectory.len()), bits(trajectory.states()))
}

/// One of each kind of work. A number tells the models, the seeds and the errors of one thread from those of another.
const JOBS: [fn(&Shared, u64) -> Outcome; 9] = [
    |shared, number| moved(&shared.humanoid, number),
    |_, number| moved(&Arc::new(Model::from_xml_str(&trouble::pendulum(number)).unwrap()), number),
    |_, number| {
        let bad = format!("<mujoco><worldbody>\n<wrong{number}/></worldbody></mujoco>");
        (Model::from_xml_str(&bad).unwrap_err().to_string(), vec![])
    },
    // The engine raises an error, and goes on after a reset.
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
        let mut data = Data::new(shared.crowded.clone()).unwrap();
        (0..20).for_each(|_| data.step().unwrap());
        (format!("{:?}", data.warning(Warning::ContactFull)), bits(&data.physics_state()))
    },
    // A number that is none, in one of the simulations only.
    |shared, number| {
        let mut data = Data::new(shared.humanoid.clone()).unwrap();
        data.qvel_mut()[number as usize] = f64::NAN;
        (data.step().unwrap_err().to_string(), vec![])
    },
    // Saving. The engine keeps the XML of the last model of the whole process only.
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
        panic!("other threads loaded a model in between, every time");
    },
    |shared, number| {
        let bytes = shared.crowded.to_binary().unwrap();
        let error = Model::from_binary(&bytes[..bytes.len() - 1 - number as usize]).unwrap_err().to_string();
        (error, moved(&Arc::new(Model::from_binary(&bytes).unwrap()), number).1)
    },
    |_, number| {
        let mut data = Data::new(Model::from_xml_str(&trouble::pendulum(number)).unwrap()).unwrap();
        let system = data.transition_fd(1e-6, Differences::Central).unwrap();
        (String::new(), bits(system.b.as_slice()))
    },
];

#[test]
fn everything_at_once_in_many_threads_is_what_it_is_in_one() {
    const THREADS: u64 = 6;
    let shared = Shared {
        humanoid: Arc::new(sample::humanoid()),
        overflowing: Arc::new(trouble::overflowing()),
        crowded: Arc::new(trouble::crowded()),
        folder: tempfile::tempdir().unwrap(),
    };
    let expected: Vec<Vec<Outcome>> =
        (0..THREADS).map(|number| JOBS.iter().map(|job| job(&shared, number)).collect()).collect();
    // The jobs do what they are here for.
    let texts: Vec<&str> = expected[3].iter().map(|(text, _)| text.as_str()).collect();
    assert!(texts[2].contains("'wrong3'") && texts[2].contains("line 2"), "{}", texts[2]);
    assert!(texts[3].contains("Stack overflow"), "{}", texts[3]);
    assert!(texts[4].contains("number: 40, last_info: 2"), "{}", texts[4]);
    assert!(texts[6].contains("j3"), "{}", texts[6]);
    assert!(expected[3][8].1 != expected[4][8].1, "the models differ");

    let barrier = Barrier::new(THREADS as usize);
    thread::scope(|scope| {
        for number in 0..THREADS {
            let (shared, expected, barrier) = (&shared, &expected[number as usize], &barrier);
            scope.spawn(move || {
                barrier.wait();
                // Each begins with another job.
                for index in (0..2 * JOBS.len()).map(|index| (index + number as usize) % JOBS.len()) {
                    let (text, numbers) = JOBS[index](shared, number);
                    assert_eq!(text, expected[index].0, "job {index} of thread {number}");
                    assert!(numbers == expected[index].1, "job {index} of thread {number} gave other numbers");
                }
            });
        }
    });
}

/// Something of a thread that loads and simulates when the thread has ended, and its other thread-locals with it.
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
fn a_thread_that_is_ending_can_still_load_and_simulate() {
    thread_local! {
        static LATE: std::cell::RefCell<Option<Late>> = const { std::cell::RefCell::new(None) };
    }
    let ended = thread::spawn(|| {
        // First of all, so that it is dropped last.
        LATE.set(Some(Late(None)));
        LATE.with_borrow_mut(|late| late.as_mut().unwrap().0 = Some(Data::new(sample::cartpole()).unwrap()));
    });
    ended.join().unwrap();
}
