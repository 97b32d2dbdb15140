//! Ghosts, batches, and deformable shapes.

use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Batch, Data, Error, Matrix, MatrixView, Model, StateSpec, sample};

use crate::browser::{Browser, ask, ask_in};
use crate::requests::humanoid;

/// Poses of the bodies that the engine computes.
fn poses(data: &mut Data) -> Vec<[f32; 7]> {
    data.forward().unwrap();
    let pose = |(pos, quat): (&[f64; 3], &[f64; 4])| {
        let numbers = [&pos[..], &quat[..]].concat();
        std::array::from_fn(|part| numbers[part] as f32)
    };
    data.xpos().iter().zip(data.xquat()).map(pose).collect()
}

#[test]
fn ghosts_have_the_poses_of_their_states() {
    let (mut data, _) = humanoid();
    let mut page = LivePage::bind(data.model(), &LiveOptions::default().with_ghosts(3)).unwrap();
    let mut browser = Browser::open(&page, &data);
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert!(state.ghosts.is_empty());
    let nq = data.model().nq();
    let mut states = Matrix::zeros(5, nq);
    for ghost in 0..5 {
        states.row_mut(ghost).copy_from_slice(data.qpos());
        states.row_mut(ghost)[2] += ghost as f64;
        states.row_mut(ghost)[10] = 0.3;
    }
    states.row_mut(1)[0] = f64::NAN;
    page.set_ghosts(StateSpec::QPOS, states.view()).unwrap();
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert_eq!(state.ghosts.len(), 3, "the limit of the options");
    let mut other = data.clone();
    let bodies = data.model().nbody();
    for ghost in [0, 2] {
        other.qpos_mut().copy_from_slice(states.row(ghost));
        assert_eq!(state.ghosts[ghost].1[..bodies], poses(&mut other));
    }
    assert!(state.ghosts[1].1.as_flattened().iter().all(|number| number.is_nan()), "NaN is not drawn");
    assert_eq!(state.poses[..bodies], poses(&mut data.clone()), "the simulation itself is as before");
    // With times, and then none.
    let full = data.state(StateSpec::INTEGRATION);
    let width = full.len();
    page.set_ghosts(StateSpec::INTEGRATION, MatrixView::from_row_major(1, width, &full)).unwrap();
    data.step_n(10).unwrap();
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert_eq!((state.time, state.ghosts.len(), state.ghosts[0].0), (data.time(), 1, 0.0));
    page.set_ghosts(StateSpec::QPOS, MatrixView::from_row_major(0, nq, &[])).unwrap();
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert!(state.ghosts.is_empty());
}

#[test]
fn states_that_are_no_states_of_ghosts_are_errors() {
    let (data, mut page) = humanoid();
    let numbers = vec![0.0; 100];
    let nq = data.model().nq();
    let error = page.set_ghosts(StateSpec::QPOS, MatrixView::from_row_major(2, nq + 1, &numbers[..2 * nq + 2]));
    assert!(matches!(error, Err(Error::Shape { .. })), "{error:?}");
    let error = page.set_ghosts(StateSpec::QVEL, MatrixView::from_row_major(1, data.model().nv(), &numbers[..27]));
    assert!(error.unwrap_err().to_string().contains("QPOS"));
    let error = LivePage::bind(data.model(), &LiveOptions::default().with_ghosts(usize::MAX)).unwrap_err();
    assert!(error.to_string().contains("at most 1000"), "{error}");
}

#[test]
fn a_batch_is_shown_paused_stepped_and_reset() {
    let mut batch = Batch::new(sample::cartpole(), 6).unwrap();
    batch.reset_where(|_| true, |index, _, data| data.qpos_mut()[0] = 0.1 * index as f64).unwrap();
    let mut page = LivePage::bind(batch.model(), &LiveOptions::default().with_ghosts(4)).unwrap();
    let mut data = batch.data(0).unwrap();
    let mut browser = Browser::open(&page, &data);
    let start = batch.states().to_matrix();
    let mut exchange = |page: &mut LivePage, batch: &mut Batch<'_>, messages: &[&str]| {
        ask_in(&mut browser, messages, || {
            let tick = page.exchange_batch(batch).unwrap();
            if tick.advance {
                batch.step(|_, controls| controls.as_mut_slice().fill(0.5)).unwrap();
            }
            tick
        })
    };
    exchange(&mut page, &mut batch, &[]);
    let (state, _) = exchange(&mut page, &mut batch, &[r#"{"pause":true}"#]);
    assert!(state.is_paused && state.is_batch && state.problem.is_empty());
    assert_eq!(state.ghosts.len(), 4);
    let bodies = data.model().nbody();
    for index in 0..5 {
        batch.load(index, &mut data).unwrap();
        let (time, found) = if index == 0 {
            (state.time, &state.poses)
        } else {
            (state.ghosts[index - 1].0, &state.ghosts[index - 1].1)
        };
        assert_eq!((time, &found[..bodies]), (data.time(), &poses(&mut data)[..]), "simulation {index}");
    }
    assert_eq!(state.ctrl, [0.5]);
    // Neither holds nor pulls have an effect.
    let before = batch.states().to_matrix();
    let pull = r#"{"pull":{"body":1,"point":[0,0,0],"target":[1,1,1]}}"#;
    let (state, ticks) = exchange(&mut page, &mut batch, &[r#"{"hold":[0,1]}"#, pull]);
    assert!(ticks.iter().all(|tick| !tick.advance) && state.held == [0]);
    assert_eq!(batch.states().to_matrix(), before);
    let (_, ticks) = exchange(&mut page, &mut batch, &[r#"{"step":2}"#]);
    let steps = ticks.iter().filter(|tick| tick.advance).count()
        + (0..5).filter(|_| page.exchange_batch(&mut batch).unwrap().advance).count();
    assert_eq!(steps, 2);
    let episode = batch.episode(5);
    let (_, ticks) = exchange(&mut page, &mut batch, &["\"reset\""]);
    assert_eq!(ticks.iter().filter(|tick| tick.reset).count(), 1);
    assert_eq!(batch.states().to_matrix(), start);
    assert_eq!(batch.episode(5), episode + 1);

    let mut other = Batch::new(sample::cartpole(), 1).unwrap();
    assert!(matches!(page.exchange_batch(&mut other), Err(Error::OtherModel { .. })));
}

#[test]
fn a_failed_simulation_of_a_batch_is_named_and_an_empty_batch_has_a_page() {
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    let mut page = LivePage::bind(batch.model(), &LiveOptions::default()).unwrap();
    let data = batch.data(0).unwrap();
    let mut browser = Browser::open(&page, &data);
    batch.step(|_, controls| controls.as_mut_slice()[1] = f64::NAN).unwrap();
    let (state, _) = ask_in(&mut browser, &[], || page.exchange_batch(&mut batch).unwrap());
    assert!(state.problem.starts_with("simulation 1: ") && state.problem.contains("NaN"), "{}", state.problem);
    let mut empty = Batch::new(batch.model(), 0).unwrap();
    page.exchange_batch(&mut empty).unwrap();
}

/// A tendon between two sites, and a skin of one triangle.
const SOFT: &str = "<mujoco><asset>
    <skin name='skin' vertex='0 0 0  0 0 .2  .3 0 0' face='0 1 2'>
      <bone body='arm' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 1 1'/></skin></asset>
  <worldbody><site name='anchor' pos='.5 0 .6'/>
    <body name='arm'><joint axis='0 1 0'/><geom size='.04' pos='.2 0 0'/><site name='tip' pos='.25 0 0'/></body></worldbody>
  <tendon><spatial><site site='anchor'/><site site='tip'/></spatial></tendon></mujoco>";

#[test]
fn vertices_of_tendons_and_skins_are_those_of_the_engine() {
    let mut data = Data::new(Model::from_xml_str(SOFT).unwrap()).unwrap();
    let mut page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
    assert!(page.left_out().is_empty(), "{:?}", page.left_out());
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[]);
    data.step_n(100).unwrap();
    data.forward().unwrap();
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    let close = |found: [f32; 3], expected: [f64; 3]| {
        let error = found.iter().zip(expected).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "{found:?} {expected:?}");
    };
    let mut shapes = state.vertices;
    shapes.sort_by_key(Vec::len);
    let [rope, skin] = &shapes[..] else { panic!("{shapes:?}") };
    for (found, site) in rope.iter().zip(data.site_xpos()) {
        close(*found, *site);
    }
    let angle = -data.qpos()[0];
    assert!(angle.abs() > 0.1, "the arm has moved: {angle}");
    let (sin, cos) = angle.sin_cos();
    for (found, [x, z]) in skin.iter().zip([[0.0, 0.0], [0.0, 0.2], [0.3, 0.0]]) {
        close(*found, [x * cos - z * sin, 0.0, x * sin + z * cos]);
    }
}

#[test]
fn a_batch_with_a_tendon_and_a_rangefinder_has_no_problem() {
    let rays = "<sensor><rangefinder site='tip'/></sensor></mujoco>";
    let model = Model::from_xml_str(&SOFT.replace("</mujoco>", rays)).unwrap();
    let mut batch = Batch::new(model, 2).unwrap();
    let mut page = LivePage::bind(batch.model(), &LiveOptions::default()).unwrap();
    let data = batch.data(0).unwrap();
    let mut browser = Browser::open(&page, &data);
    for _ in 0..2 {
        batch.step(|_, _| ()).unwrap();
        let (state, _) = ask_in(&mut browser, &[], || page.exchange_batch(&mut batch).unwrap());
        assert_eq!(state.problem, "");
        assert!(state.vertices.iter().flatten().flatten().all(|number| number.is_finite()));
    }
}
