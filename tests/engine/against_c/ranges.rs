//! Length ranges of actuators.

use mujoco_safe::Model;
use mujoco_safe::model::{LengthRangeMode, LengthRangeOptions};
use mujoco_safe::sys::{self, mjLROpt};

use crate::twins::{assert_same, c};

const ARM: &str = r#"<mujoco>
    <option timestep="0.005"><flag gravity="disable" contact="disable"/></option>
    <worldbody>
      <site name="anchor" pos="-.1 0 .1"/>
      <body>
        <joint name="shoulder" axis="0 1 0" limited="true" range="-90 60" damping="1"/>
        <geom type="capsule" size=".04" fromto="0 0 0 .5 0 0"/>
        <site name="arm" pos=".3 0 .05"/>
        <body pos=".5 0 0">
          <joint name="elbow" axis="0 1 0" limited="true" range="0 120" damping="1"/>
          <geom type="capsule" size=".03" fromto="0 0 0 .4 0 0"/>
          <site name="forearm" pos=".1 0 .04"/>
        </body>
      </body>
    </worldbody>
    <tendon>
      <spatial name="long" limited="true" range="0 2"><site site="anchor"/><site site="arm"/><site site="forearm"/></spatial>
    </tendon>
    <actuator>
      <motor name="by tendon" tendon="long" gear="2"/>
      <motor name="by joint" joint="elbow"/>
    </actuator>
  </mujoco>"#;

#[test]
fn length_ranges_equal_c() {
    let original = Model::from_xml_str(ARM).unwrap();
    let mut ranges = Vec::new();
    for (mode, maxforce, uselimit) in [
        (LengthRangeMode::All, 0.0, false),
        (LengthRangeMode::All, 1.0, false),
        (LengthRangeMode::All, 0.0, true),
        (LengthRangeMode::Muscle, 0.0, false),
        (LengthRangeMode::MuscleUser, 0.0, false),
        (LengthRangeMode::None, 0.0, false),
    ] {
        for index in 0..2 {
            let mut model = original.clone();
            let options = LengthRangeOptions::default().with_mode(mode).with_maxforce(maxforce).with_uselimit(uselimit);
            let id = model.id(index).unwrap();
            let ours = model.edit().set_length_range(id, &options).expect("the length range converges");

            if uselimit && index == 1 {
                // For every actuator but the first, the engine uses the limits of another joint, or
                // none.
                assert_eq!(ours, model.jnt_range()[1]);
                continue;
            }

            // SAFETY: integers and numbers, all of which the engine initialises.
            let mut theirs: mjLROpt = unsafe { std::mem::zeroed() };
            c!(mj_defaultLROpt(&raw mut theirs));
            theirs.mode = match mode {
                LengthRangeMode::None => sys::mjLRMODE_NONE,
                LengthRangeMode::Muscle => sys::mjLRMODE_MUSCLE,
                LengthRangeMode::MuscleUser => sys::mjLRMODE_MUSCLEUSER,
                LengthRangeMode::All => sys::mjLRMODE_ALL,
            } as i32;
            (theirs.maxforce, theirs.uselimit) = (maxforce, uselimit.into());
            let copy = c!(mj_copyModel(std::ptr::null_mut(), original.as_ptr()));
            let data = c!(mj_makeData(copy));
            let mut error = [0; 200];
            let done = c!(mj_setLengthRange(copy, data, index as i32, &raw const theirs, error.as_mut_ptr(), 200));
            assert_eq!(done, 1);
            // SAFETY: the model has two actuators, each with a range.
            let range = unsafe {
                [*(*copy).actuator_lengthrange.add(2 * index), *(*copy).actuator_lengthrange.add(2 * index + 1)]
            };
            c!(mj_deleteData(data));
            c!(mj_deleteModel(copy));
            assert_same(&format!("{options:?}, actuator {index}"), &ours, &range);
            assert_same("the stored range", &model.actuator_lengthrange()[index], &range);
            ranges.push(ours);
        }
    }
    assert!(ranges.iter().filter(|[low, high]| low < high).count() == 5);
}

/// An actuator with four controls does not change the length range of the next.
#[cfg(engine_since = "3.17.0")]
#[test]
fn length_ranges_behind_an_actuator_with_several_lengths_equal_those_without_it() {
    let text = |first: &str| {
        format!(
            r#"<mujoco><option timestep="0.005"/><worldbody>
                 <body><joint name="b" type="ball"/><geom size=".1"/></body>
                 <body pos="1 0 0"><joint name="s" type="slide" axis="1 0 0" range="-1 2" limited="true" damping="1"/><geom size=".1"/></body>
               </worldbody><actuator>{first}<motor name="m" joint="s" gear="2"/></actuator></mujoco>"#
        )
    };
    let compute = |first: &str, uselimit| {
        let mut model = Model::from_xml_str(&text(first)).unwrap();
        let options = LengthRangeOptions::default().with_mode(LengthRangeMode::All).with_uselimit(uselimit);
        let id = model.actuator("m").unwrap().id();
        let range = model.edit().set_length_range(id, &options).unwrap();
        assert_same("the stored range", model.actuator("m").unwrap().lengthrange(), &range);
        assert_eq!(model.edit().set_length_range(id, &options.with_useexisting(true)).unwrap(), range);
        range
    };
    let orientation = r#"<orientation name="o" joint="b" kp="1"/>"#;
    assert_same("the limits of the joint", &compute(orientation, true), &[-1.0, 2.0]);
    // The engine computes the same without the first actuator (`length_ranges_equal_c`).
    assert_same("a simulated range", &compute(orientation, false), &compute("", false));
}

#[test]
fn the_default_options_equal_c() {
    let ours = LengthRangeOptions::default();
    // SAFETY: integers and numbers, all of which the engine initialises.
    let mut theirs: mjLROpt = unsafe { std::mem::zeroed() };
    c!(mj_defaultLROpt(&raw mut theirs));
    assert_eq!((theirs.mode, ours.mode), (sys::mjLRMODE_MUSCLE as i32, LengthRangeMode::Muscle));
    assert_eq!((theirs.useexisting, theirs.uselimit), (ours.useexisting.into(), ours.uselimit.into()));
    let numbers = [ours.accel, ours.maxforce, ours.timeconst, ours.inttotal, ours.inteval, ours.tolrange];
    #[cfg(engine_since = "2.3.7")]
    let interval = theirs.interval;
    #[cfg(not(engine_since = "2.3.7"))]
    let interval = theirs.inteval;
    let expected = [theirs.accel, theirs.maxforce, theirs.timeconst, theirs.inttotal, interval, theirs.tolrange];
    assert_same("defaults", &numbers, &expected);
}
