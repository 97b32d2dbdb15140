//! What fails is told, and does not end the viewer.

use super::Bench;
use crate::viewer::request::Request;
use crate::viewer::snapshot::Status;
use crate::{Data, Error, Model, sample};

fn cartpole(controller: impl FnMut(&mut Data) -> crate::Result<()> + Send + 'static) -> Bench {
    Bench::with(Data::new(sample::cartpole()).unwrap(), Some(Box::new(controller)), Vec::new())
}

#[test]
fn an_error_of_a_controller_pauses_and_is_told_until_it_goes_on() {
    let mut calls = 0;
    let mut bench = cartpole(move |data| {
        calls += 1;
        data.ctrl_mut()[0] = f64::from(calls);
        if calls == 6 { Err(Error::Unsupported("no solution".to_owned())) } else { Ok(()) }
    });
    bench.ask(Request::Pause(false));
    bench.pass(1.0);
    assert_eq!(bench.shown().status, Status::Paused);
    assert_eq!(bench.shown().problem, "no solution");
    let timestep = bench.shown().model.timestep();
    assert!((bench.shown().time - 5.0 * timestep).abs() < 1e-12, "it stands as before the step that failed");
    assert_eq!(bench.shown().ctrl, [5.0]);
    bench.ask(Request::Pause(false));
    bench.pass(0.1);
    assert_eq!((bench.shown().status, bench.shown().problem.as_str()), (Status::Running, ""));
}

#[test]
fn a_panic_of_a_controller_is_an_error_like_another() {
    for (index, expected) in
        ["the controller panicked: at once", "the controller panicked: number 7"].iter().enumerate()
    {
        let mut bench = cartpole(move |_| if index == 0 { panic!("at once") } else { panic!("number {}", 6 + index) });
        bench.ask(Request::Step(3));
        assert_eq!(bench.shown().problem, *expected);
        assert_eq!((bench.shown().time, bench.shown().status), (0.0, Status::Paused));
    }
}

#[test]
fn controls_that_are_no_numbers_are_told_and_taken_back() {
    let mut bench = cartpole(|data| {
        data.ctrl_mut()[0] = f64::NAN;
        Ok(())
    });
    bench.ask(Request::Pause(false));
    bench.pass(0.1);
    assert!(bench.shown().problem.contains("ctrl[0]"), "{}", bench.shown().problem);
    assert_eq!(bench.shown().ctrl, [0.0]);
    assert_eq!(bench.shown().status, Status::Paused);
    bench.ask(Request::Reset);
    assert_eq!(bench.shown().problem, "");
}

/// A spring so stiff that the simulation explodes after some steps.
const UNSTABLE: &str = r#"<mujoco>
    <option timestep="0.1"/>
    <worldbody><body><joint name="slide" type="slide" stiffness="1e6"/><geom size="0.1"/></body></worldbody>
    <keyframe><key qpos="1"/></keyframe>
  </mujoco>"#;

#[test]
fn a_simulation_that_explodes_stands_before_the_explosion_and_can_be_reset() {
    let mut data = Data::new(Model::from_xml_str(UNSTABLE).unwrap()).unwrap();
    data.reset_to_key(0).unwrap();
    let start = data.qpos().to_vec();
    let mut bench = Bench::new(data);
    bench.ask(Request::SetSpeed(100.0));
    bench.ask(Request::Pause(false));
    bench.pass(20.0);
    assert_eq!(bench.shown().status, Status::Paused);
    assert!(bench.shown().problem.contains("unstable"), "{}", bench.shown().problem);
    let (time, qpos) = (bench.shown().time, bench.shown().qpos[0]);
    assert!(time > 0.0 && qpos.abs() > 10.0 && qpos.is_finite(), "{qpos} at {time}");
    bench.ask(Request::Pause(false));
    bench.pass(1.0);
    assert_eq!((bench.shown().status, bench.shown().time), (Status::Paused, time), "it explodes again");
    bench.ask(Request::Step(-2));
    assert!(bench.shown().time < time);
    bench.ask(Request::Reset);
    assert_eq!((bench.shown().qpos.clone(), bench.shown().problem.as_str()), (start, ""));
}

#[test]
fn a_data_that_had_failed_before_it_was_shown_can_be_reset() {
    let mut data = Data::new(Model::from_xml_str(UNSTABLE).unwrap()).unwrap();
    data.reset_to_key(0).unwrap();
    while data.step().is_ok() {}
    assert!(data.forward().is_err());
    let mut bench = Bench::new(data);
    bench.ask(Request::Pause(false));
    bench.pass(0.1);
    assert_eq!(bench.shown().status, Status::Paused);
    assert!(!bench.shown().problem.is_empty());
    let model = bench.shown().model.clone();
    for request in [Request::Step(1), Request::Step(-1), Request::Scrub(0), Request::CopyState, Request::SelectParent] {
        bench.ask(request);
    }
    bench.ask(Request::LoadKey(model.keyframe(0).unwrap().id()));
    assert_eq!(bench.shown().qpos, [1.0]);
    bench.ask(Request::Step(1));
    assert!(bench.shown().time > 0.0);
}

#[test]
fn a_controller_that_replaces_the_simulation_is_followed() {
    let mut bench = cartpole(|data| {
        if data.model().nq() != 28 {
            *data = Data::new(sample::humanoid())?;
        }
        Ok(())
    });
    bench.ask(Request::SelectBody(bench.front.drawn().map(|snapshot| snapshot.model.body(1).unwrap().id())));
    bench.ask(Request::StartPerturbation(crate::scene::PerturbationFlags::TRANSLATE));
    bench.ask(Request::Pause(false));
    bench.pass(0.2);
    bench.ask(Request::Pause(false));
    bench.pass(0.2);
    assert_eq!(bench.shown().model.nq(), 28);
    bench.ask(Request::Step(-1));
    bench.ask(Request::Reset);
}
