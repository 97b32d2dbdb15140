//! Errors and panics pause the simulation and do not end the viewer.

use super::Bench;
use crate::viewer::link::{EndpointRequest, Request, SimulationRequest, Status};
use crate::{Data, Error, Model, sample};

fn cartpole(controller: impl FnMut(&mut Data) -> crate::error::Result<()> + Send + 'static) -> Bench {
    Bench::with(Data::new(sample::cartpole()).unwrap(), Some(Box::new(controller)), Vec::new())
}

#[test]
fn controller_error_pauses_and_is_shown_until_resumed() {
    let mut calls = 0;
    let mut bench = cartpole(move |data| {
        calls += 1;
        data.ctrl_mut()[0] = f64::from(calls);
        if calls == 6 { Err(Error::Unsupported("no solution".to_owned())) } else { Ok(()) }
    });
    bench.send(Request::Pause(false));
    bench.pass(1.0);
    assert_eq!(bench.snapshot().status, Status::Paused);
    assert_eq!(bench.snapshot().problem, "no solution");
    let timestep = bench.snapshot().model.timestep();
    assert!((bench.snapshot().time - 5.0 * timestep).abs() < 1e-12, "the state before the failed step is restored");
    assert_eq!(bench.snapshot().ctrl, [5.0]);
    bench.send(Request::Pause(false));
    bench.pass(0.1);
    assert_eq!((bench.snapshot().status, bench.snapshot().problem.as_str()), (Status::Running, ""));
}

#[test]
fn controller_panic_is_an_error() {
    for (index, expected) in
        ["the controller panicked: at once", "the controller panicked: number 7"].iter().enumerate()
    {
        let mut bench = cartpole(move |_| if index == 0 { panic!("at once") } else { panic!("number {}", 6 + index) });
        bench.send(SimulationRequest::Step(3));
        assert_eq!(bench.snapshot().problem, *expected);
        assert_eq!((bench.snapshot().time, bench.snapshot().status), (0.0, Status::Paused));
    }
}

#[test]
fn nan_controls_are_reported_and_reverted() {
    let mut bench = cartpole(|data| {
        data.ctrl_mut()[0] = f64::NAN;
        Ok(())
    });
    bench.send(Request::Pause(false));
    bench.pass(0.1);
    assert!(bench.snapshot().problem.contains("ctrl[0]"), "{}", bench.snapshot().problem);
    assert_eq!(bench.snapshot().ctrl, [0.0]);
    assert_eq!(bench.snapshot().status, Status::Paused);
    bench.send(Request::Reset);
    assert_eq!(bench.snapshot().problem, "");
}

/// Spring so stiff that the simulation becomes unstable after a few steps.
const UNSTABLE: &str = r#"<mujoco>
    <option timestep="0.1"/>
    <worldbody><body><joint name="slide" type="slide" stiffness="1e6"/><geom size="0.1"/></body></worldbody>
    <keyframe><key qpos="1"/></keyframe>
  </mujoco>"#;

#[test]
fn unstable_simulation_pauses_before_the_failed_step_and_can_be_reset() {
    let mut data = Data::new(Model::from_xml_str(UNSTABLE).unwrap()).unwrap();
    data.reset_to_key(0).unwrap();
    let start = data.qpos().to_vec();
    let mut bench = Bench::new(data);
    bench.send(SimulationRequest::SetSpeed(100.0));
    bench.send(Request::Pause(false));
    bench.pass(20.0);
    assert_eq!(bench.snapshot().status, Status::Paused);
    assert!(bench.snapshot().problem.contains("unstable"), "{}", bench.snapshot().problem);
    let (time, qpos) = (bench.snapshot().time, bench.snapshot().qpos[0]);
    assert!(time > 0.0 && qpos.abs() > 10.0 && qpos.is_finite(), "{qpos} at {time}");
    bench.send(Request::Pause(false));
    bench.pass(1.0);
    assert_eq!((bench.snapshot().status, bench.snapshot().time), (Status::Paused, time), "the same step fails again");
    bench.send(SimulationRequest::Step(-2));
    assert!(bench.snapshot().time < time);
    bench.send(Request::Reset);
    assert_eq!((bench.snapshot().qpos.clone(), bench.snapshot().problem.as_str()), (start, ""));
}

#[test]
fn data_that_failed_before_it_was_shown_can_be_reset() {
    let mut data = Data::new(Model::from_xml_str(UNSTABLE).unwrap()).unwrap();
    data.reset_to_key(0).unwrap();
    while data.step().is_ok() {}
    assert!(data.forward().is_err());
    let mut bench = Bench::new(data);
    bench.send(Request::Pause(false));
    bench.pass(0.1);
    assert_eq!(bench.snapshot().status, Status::Paused);
    assert!(!bench.snapshot().problem.is_empty());
    let model = bench.snapshot().model.clone();
    for request in [SimulationRequest::Step(1), SimulationRequest::Step(-1), SimulationRequest::Scrub(0)] {
        bench.send(request);
    }
    for request in [EndpointRequest::CopyState, EndpointRequest::SelectParent] {
        bench.send(request);
    }
    bench.send(EndpointRequest::LoadKey(model.keyframe(0).unwrap().id()));
    assert_eq!(bench.snapshot().qpos, [1.0]);
    bench.send(SimulationRequest::Step(1));
    assert!(bench.snapshot().time > 0.0);
}

#[test]
fn controller_may_replace_the_data() {
    let mut bench = cartpole(|data| {
        if data.model().nq() != 28 {
            *data = Data::new(sample::humanoid())?;
        }
        Ok(())
    });
    bench
        .send(EndpointRequest::SelectBody(bench.window.current().map(|snapshot| snapshot.model.body(1).unwrap().id())));
    bench.send(EndpointRequest::StartPerturbation(crate::scene::PerturbationFlags::TRANSLATE));
    bench.send(Request::Pause(false));
    bench.pass(0.2);
    bench.send(Request::Pause(false));
    bench.pass(0.2);
    assert_eq!(bench.snapshot().model.nq(), 28);
    bench.send(SimulationRequest::Step(-1));
    bench.send(Request::Reset);
}
