//! Unknown names and options out of range.

use mujoco_safe::enums::Integrator;
use mujoco_safe::{Data, Differences, sample};

use super::text_of;

#[test]
fn an_unknown_name_is_an_error_that_lists_the_known_names() {
    let model = sample::humanoid();
    let text =
        text_of(model.joint("left_kne"), &["no joint named 'left_kne'", "did you mean 'left_knee'", "right_knee"]);
    assert!(!text.contains("torso"), "only joints: {text}");
    text_of(model.body("left_knee"), &["no body named 'left_knee'"]);
    text_of(model.tendon("t"), &["no tendon named 't'"]);
    text_of(model.light("x\0y"), &["no light named"]);
    text_of(sample::cartpole().tendon("s"), &["none of this kind has a name"]);
    text_of(model.geom(1000), &["no geom 1000", "counted from 0"]);
    let data = Data::new(model).unwrap();
    text_of(data.site("site"), &["no site named 'site'"]);
}

#[test]
fn an_unknown_keyframe_is_an_error_without_a_reset() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.set_time(1.0);
    text_of(data.reset_to_key("squatt"), &["no keyframe named 'squatt'", "did you mean 'squat'", "stand_on_left_leg"]);
    text_of(data.reset_to_key(99), &["no keyframe 99", "the model has 3"]);
    assert_eq!(data.time(), 1.0);
}

#[test]
fn an_option_out_of_range_is_an_error_that_changes_nothing() {
    type Change = fn(&mut mujoco_safe::Options);
    let mut model = sample::cartpole();
    let before = model.options();
    let changes: [(Change, &[&str]); 9] = [
        (|options| options.timestep = -1.0, &["the option timestep is -1", "positive and finite"]),
        (|options| options.timestep = f64::NAN, &["timestep is NaN"]),
        (|options| options.impratio = 0.0, &["impratio is 0"]),
        (|options| options.tolerance = -1.0, &["tolerance is -1", "not negative"]),
        (|options| options.gravity[1] = f64::INFINITY, &["gravity", "inf", "finite"]),
        (|options| options.iterations = usize::MAX, &["iterations", "a million"]),
        (|options| options.density = f64::NAN, &["density is NaN"]),
        (|options| options.o_solimp[4] = f64::NAN, &["o_solimp"]),
        (|options| options.mpr_iterations = 1 << 32, &["mpr_iterations is 4294967296"]),
    ];
    for (change, parts) in changes {
        text_of(model.edit().edit_options(change), parts);
        assert_eq!(model.options(), before);
    }
    text_of(model.edit().set_timestep(0.0), &["timestep is 0"]);
}

#[test]
fn linearising_runge_kutta_is_an_error() {
    let mut model = sample::cartpole();
    model.edit().edit_options(|options| options.integrator = Integrator::Rk4).unwrap();
    let mut data = Data::new(model).unwrap();
    text_of(data.transition_fd(1e-6, Differences::Central), &["transition_fd", "Euler", "Implicit", "Rk4"]);
    data.step().unwrap();
}
