//! Jacobians of the residuals in closed form, against central differences.

use mujoco_safe::control::residual::{
    Frame, FramePose, Gaze, JointCoupling, JointPosition, Residual, ResidualJacobian, Subtree,
};
use mujoco_safe::{Data, Model, sample};
use rand::RngExt;

use crate::{arm, random, randomise};

fn residuals(model: &Model) -> Vec<(&'static str, Box<dyn Residual>)> {
    let body = |name: &str| Frame::body(model, name).unwrap();
    let turned = [0.5_f64.sqrt(), 0.0, -(0.5_f64.sqrt()), 0.0];
    let pose = FramePose::new(body("hand_left")).with_target([0.1, 0.2, 0.9], turned);
    vec![
        ("pose", Box::new(pose.clone())),
        ("relative pose", Box::new(pose.relative_to(Frame::geom(model, "thigh_right").unwrap()))),
        ("pose relative to the same body", Box::new(FramePose::new(body("head")).relative_to(body("torso")))),
        ("pose of a site", Box::new(FramePose::new(Frame::site(model, "sole_left").unwrap()))),
        ("gaze", Box::new(Gaze::new(body("head"), [1.0, 0.2, 0.0]).unwrap().with_target([2.0, 0.4, 1.0]))),
        ("coupling", Box::new(JointCoupling::new(model, &[("left_knee", 1.0), ("right_elbow", -0.5)]).unwrap())),
        ("joints", Box::new(JointPosition::all(model))),
        ("centre of mass", Box::new(Subtree::com(model, "torso").unwrap())),
    ]
}

#[test]
fn jacobians_equal_differences() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let model = data.model().clone();
    let mut random = random(1);
    for _ in 0..5 {
        randomise(&mut data, &mut random);
        data.qpos_mut()[..7].iter_mut().for_each(|value| *value += random.random_range(-0.3..0.3));
        data.forward().unwrap();
        data.subtree_vel().unwrap();
        for (name, residual) in residuals(&model) {
            let size = residual.size();
            let mut closed = ResidualJacobian::zeros(&model, size);
            let mut differences = ResidualJacobian::zeros(&model, size);
            residual.differentiate(&mut data, &mut closed).unwrap();
            differences.difference(&*residual, &mut data).unwrap();
            for component in 0..size {
                for (ours, theirs) in closed.by_state(component).iter().zip(differences.by_state(component)) {
                    assert!((ours - theirs).abs() < 1e-8, "{name}, component {component}: {ours} and {theirs}");
                }
            }
        }
    }
}

#[test]
fn a_relative_pose_does_not_depend_on_the_base() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let model = data.model().clone();
    let frame = |name: &str| Frame::body(&model, name).unwrap();
    let relative = FramePose::new(frame("hand_left")).relative_to(frame("pelvis"));
    let mut values = [[0.0; 6]; 2];
    for value in &mut values {
        data.forward().unwrap();
        relative.evaluate(&mut data, value).unwrap();
        data.qpos_mut()[..7].copy_from_slice(&[3.0, -2.0, 1.0, 0.5, 0.5, -0.5, 0.5]);
    }
    for (before, after) in values[0].iter().zip(&values[1]) {
        assert!((before - after).abs() < 1e-12, "{before} and {after}");
    }
}

#[test]
fn residuals_reject_wrong_arguments() {
    let model = sample::humanoid();
    let head = Frame::body(&model, "head").unwrap();
    assert!(Frame::geom(&model, "no").is_err());
    for axis in [[0.0; 3], [f64::NAN, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
        assert!(Gaze::new(head, axis).is_err());
    }
    assert!(JointCoupling::new(&model, &[("root", 1.0)]).is_err());
    assert!(JointCoupling::new(&model, &[("left_knee", f64::NAN)]).is_err());
    let mut data = Data::new(model).unwrap();
    data.forward().unwrap();
    let mut values = [0.0; 6];
    let position = *data.body("head").unwrap().xpos();
    for quaternion in [[0.0; 4], [2.0, 0.0, 0.0, 0.0], [f64::NAN; 4]] {
        assert!(FramePose::new(head).with_target(position, quaternion).evaluate(&mut data, &mut values).is_err());
    }
    let here = Gaze::new(head, [1.0, 0.0, 0.0]).unwrap().with_target(position);
    assert!(here.evaluate(&mut data, &mut values[..3]).is_err());
    // A coupling of joints of another model.
    let coupling = JointCoupling::new(&arm(), &[("joint0", 1.0)]).unwrap();
    assert!(coupling.evaluate(&mut data, &mut values[..1]).is_err());
}
