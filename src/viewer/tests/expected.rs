//! Keys, buttons and edits that come before the simulation has answered the ones before them.

use super::{Bench, trajectories};
use crate::viewer::expected::Expected;
use crate::viewer::mode::Mode;
use crate::viewer::request::Request;
use crate::{Data, sample};

/// Asks as the window does, without a turn of the simulation.
fn ask(bench: &Bench, expected: &mut Expected, request: Request) {
    expected.note(&request, bench.front.next_number(&request), bench.front.drawn().unwrap());
    bench.front.ask(request);
}

#[test]
fn a_button_after_a_selection_that_is_not_answered_yet_pulls() {
    let (mut bench, mut expected) = (Bench::humanoid(), Expected::default());
    let torso = bench.shown().model.body("torso").unwrap().id();
    assert!(!expected.is_selected(bench.shown()));
    ask(&bench, &mut expected, Request::SelectBody(Some(torso)));
    assert!(expected.is_selected(bench.shown()));
    bench.turn();
    assert!(expected.is_selected(bench.shown()));
    bench.ask(Request::SelectBody(None));
    assert!(!expected.is_selected(bench.shown()), "the answer counts");
}

#[test]
fn a_key_after_a_change_of_mode_that_is_not_answered_yet_is_one_of_the_new_mode() {
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    let mut expected = Expected::default();
    assert_eq!(expected.mode(bench.shown()), Mode::Trajectory);
    for mode in [Mode::Passive, Mode::Trajectory, Mode::Passive] {
        ask(&bench, &mut expected, Request::CycleMode(1));
        assert_eq!(expected.mode(bench.shown()), mode);
    }
    ask(&bench, &mut expected, Request::SetMode(Mode::Controller));
    assert_eq!(expected.mode(bench.shown()), Mode::Passive, "there is no controller");
    bench.turn();
    assert_eq!((bench.mode(), expected.mode(bench.front.drawn().unwrap())), (Mode::Passive, Mode::Passive));
    bench.ask(Request::SetMode(Mode::Trajectory));
    assert_eq!(expected.mode(bench.shown()), Mode::Trajectory, "the answer counts");
}

#[test]
fn two_edits_of_the_physics_options_before_an_answer_are_both_done() {
    let (mut bench, mut expected) = (Bench::humanoid(), Expected::default());
    let mut options = expected.options(bench.shown());
    options.gravity = [0.0, 0.0, -1.0];
    ask(&bench, &mut expected, Request::SetOptions(Box::new(options)));
    let mut options = expected.options(bench.shown());
    options.iterations = 7;
    ask(&bench, &mut expected, Request::SetOptions(Box::new(options)));
    bench.turn();
    let model = bench.shown().model.clone();
    assert_eq!((model.options().gravity, model.options().iterations), ([0.0, 0.0, -1.0], 7));
    // Options that are refused are not where the next edit starts.
    let mut options = expected.options(bench.shown());
    options.timestep = -1.0;
    ask(&bench, &mut expected, Request::SetOptions(Box::new(options)));
    bench.turn();
    assert_eq!(expected.options(bench.shown()), model.options());
}
