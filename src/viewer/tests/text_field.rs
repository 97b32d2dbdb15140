//! Numbers that the user types into the panels while the simulation is busy, so that the newest
//! snapshot is older than the last key.

use super::Bench;
use super::screen::Screen;
use crate::viewer::instruments::{Instruments, WithInstruments};
use crate::viewer::link::Request;
use crate::{Data, ZeroController, sample};

#[test]
fn typed_parameter_is_received_after_the_last_key() {
    let mut force = 0.125;
    let declare = move |_: &mut ZeroController, _: &Data, instruments: &mut Instruments| {
        instruments.parameter("force", &mut force, -1.0..=1.0);
    };
    let controller = WithInstruments { controller: ZeroController, declare };
    let mut screen = Screen::new(Bench::instrumented(Data::new(sample::cartpole()).unwrap(), controller));
    screen.edit("0.125");
    screen.enter("0.375");
    assert_eq!(screen.bench.snapshot().parameters[0].value, 0.125, "the simulation is busy");
    assert_eq!(screen.bench.tick().parameters[0].value, 0.375);
}

#[test]
fn typed_controls_positions_and_speeds_are_received_after_the_last_key() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.ctrl_mut()[0] = 0.25;
    data.qpos_mut()[0] = 0.125;
    let mut bench = Bench::new(data);
    (bench.view.left_panel, bench.view.right_panel) = (true, true);
    let mut screen = Screen::new(bench);
    screen.edit("0.25");
    screen.enter("-0.75");
    screen.edit("0.125");
    screen.enter("0.625");
    screen.edit("1.00x");
    screen.enter("3.5");
    assert_eq!(screen.bench.snapshot().ctrl, [0.25], "the simulation is busy");
    let snapshot = screen.bench.tick();
    assert_eq!((snapshot.ctrl[0], snapshot.qpos[0], snapshot.speed.target()), (-0.75, 0.625, 3.5));
}

#[test]
fn buttons_toggle_the_state_after_the_pending_requests() {
    let mut screen = Screen::new(Bench::new(Data::new(sample::cartpole()).unwrap()));
    for paused in [false, true, false] {
        let request = Request::Pause(paused);
        let number = screen.bench.window.send(request.clone()).unwrap();
        screen.predicted.update(request, number, screen.bench.window.current().unwrap());
        assert_eq!(screen.predicted.is_paused(screen.bench.window.current().unwrap()), paused);
    }
}
