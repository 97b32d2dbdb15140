//! Loops in real time.

use std::thread;
use std::time::{Duration, Instant};

use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Data, Error, ZeroController, sample};

use crate::browser::{Browser, State};

fn cartpole() -> (Data, LivePage) {
    let data = Data::new(sample::cartpole()).unwrap();
    let page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
    (data, page)
}

/// Waits for a state that fulfils a condition.
fn wait_for(browser: &mut Browser, condition: impl Fn(&State) -> bool) -> State {
    let start = Instant::now();
    loop {
        let state = browser.state();
        if condition(&state) {
            return state;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "{state:?}");
    }
}

#[test]
fn a_loop_is_not_faster_than_real_time() {
    let (mut data, mut page) = cartpole();
    let start = Instant::now();
    page.run_for(Duration::from_millis(200), &mut data, &mut ZeroController).unwrap();
    assert!(start.elapsed() >= Duration::from_millis(200));
    assert!(data.time() > 0.0 && data.time() <= start.elapsed().as_secs_f64() + data.model().timestep());
}

#[test]
fn a_browser_pauses_steps_resets_and_controls_a_loop() {
    let (mut data, mut page) = cartpole();
    let mut browser = Browser::open(&page, &data);
    thread::scope(|scope| {
        let (page, data) = (&mut page, &mut data);
        // Its end depends on no requirement of speed: the browser makes the controller fail.
        let mut controller = |data: &mut Data| {
            if data.qpos()[0] > 0.5 { Err(Error::Unsupported("the cart is too far".to_owned())) } else { Ok(()) }
        };
        let run = scope.spawn(move || page.run_for(Duration::from_secs(5), data, &mut controller));
        wait_for(&mut browser, |state| state.time > 0.0);
        browser.send(r#"{"pause":true}"#);
        let paused = wait_for(&mut browser, |state| state.is_paused).time;
        assert_eq!(browser.state().time, paused);
        browser.send(r#"{"step":3}"#);
        let timestep = sample::cartpole().timestep();
        let stepped = wait_for(&mut browser, |state| state.time > paused + 2.5 * timestep).time;
        assert!((stepped - paused - 3.0 * timestep).abs() < 1e-9);
        browser.send("\"reset\"");
        assert!(wait_for(&mut browser, |state| state.time < paused).is_paused, "a reset keeps the pause");
        browser.send(r#"{"pause":false}"#);
        browser.send(r#"{"hold":[0,1]}"#);
        let failed = wait_for(&mut browser, |state| !state.problem.is_empty());
        assert!(failed.problem.contains("the cart is too far"), "{failed:?}");
        assert_eq!((failed.ctrl[0], failed.held[0]), (1.0, 1));
        let error = run.join().unwrap().unwrap_err();
        assert!(error.to_string().contains("too far"), "{error}");
    });
}

#[test]
fn after_a_failure_a_reset_goes_on() {
    let (mut data, mut page) = cartpole();
    let mut browser = Browser::open(&page, &data);
    thread::scope(|scope| {
        let (page, data) = (&mut page, &mut data);
        let mut is_first = true;
        let mut controller = move |data: &mut Data| {
            if std::mem::take(&mut is_first) {
                data.ctrl_mut()[0] = f64::NAN;
            }
        };
        let run = scope.spawn(move || page.run_for(Duration::from_secs(3), data, &mut controller));
        let state = wait_for(&mut browser, |state| !state.problem.is_empty());
        assert!(state.problem.contains("NaN"), "{state:?}");
        browser.send("\"reset\"");
        wait_for(&mut browser, |state| state.time > 0.0 && state.problem.is_empty());
        run.join().unwrap().unwrap();
    });
}
