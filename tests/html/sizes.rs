//! Sizes of pages.

use std::fmt::Write;

use mujoco_safe::html::HtmlOptions;
use mujoco_safe::rollout::Rollout;
use mujoco_safe::{Data, Model, RandomController, StateSpec, Trajectory, sample};

use crate::page::saved;

#[test]
fn ten_seconds_of_the_humanoid_need_at_most_400_kb() {
    let model = sample::humanoid();
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(&model);
    let steps = (10.0 / model.options().timestep).round() as usize;
    trajectory.record(&mut data, &mut RandomController::new(0), steps).unwrap();
    let size = saved(&model, &[("", &trajectory)], &HtmlOptions::default()).text.len();
    println!("10 s of the humanoid: {} kB", size / 1000);
    assert!(size <= 400_000, "{size}");
}

/// Returns 64 rollouts of the humanoid under random control, each of 3 s.
pub fn rollouts(model: &Model) -> Vec<(String, Trajectory)> {
    let steps = (3.0 / model.options().timestep).round() as usize;
    let rollouts = Rollout::new(model.clone(), 64, steps)
        .with_controllers(|rollout| RandomController::new(rollout as u64))
        .with_recorded_states(StateSpec::INTEGRATION)
        .run()
        .unwrap();
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = |rollout: usize| {
        let mut trajectory = Trajectory::new(model);
        for state in rollouts.states_of(rollout).rows() {
            data.set_state(StateSpec::INTEGRATION, state).unwrap();
            trajectory.push(&data).unwrap();
        }
        (format!("rollout {rollout}"), trajectory)
    };
    (0..64).map(&mut trajectory).collect()
}

#[test]
fn sixty_four_rollouts_of_the_humanoid_need_at_most_5_mb() {
    let model = sample::humanoid();
    let rollouts = rollouts(&model);
    let shown: Vec<_> = rollouts.iter().map(|(label, trajectory)| (&**label, trajectory)).collect();
    let size = saved(&model, &shown, &HtmlOptions::default()).text.len();
    println!("64 rollouts of the humanoid, 3 s each: {} kB", size / 1000);
    assert!(size <= 5_000_000, "{size}");
}

/// Returns a chain of 20 links with dents, of 10,000 triangles each.
pub fn large_robot() -> Model {
    const PARTS: usize = 20;
    let (rings, slices) = (51_usize, 100_usize);
    let mut assets = String::new();
    for part in 0..PARTS {
        write!(assets, "<mesh name='part{part}' vertex='").unwrap();
        for ring in 0..rings {
            for slice in 0..slices {
                let (along, around) =
                    (ring as f64 / (rings - 1) as f64, std::f64::consts::TAU * slice as f64 / slices as f64);
                let dent = 1.0
                    + 0.1 * ((7.0 * along + part as f64).sin() * (3.0 * around).cos() + (31.0 * around).sin() / 9.0);
                let radius = dent * (0.002 + (std::f64::consts::PI * along).sin()) * 0.05;
                write!(assets, "{:.6} {:.6} {:.6} ", radius * around.cos(), radius * around.sin(), 0.2 * along)
                    .unwrap();
            }
        }
        assets.push_str("' face='");
        for ring in 0..rings - 1 {
            for slice in 0..slices {
                let next = (slice + 1) % slices;
                let [a, b, c, d] =
                    [(ring, slice), (ring, next), (ring + 1, next), (ring + 1, slice)].map(|(r, s)| r * slices + s);
                write!(assets, "{a} {b} {c} {a} {c} {d} ").unwrap();
            }
        }
        assets.push_str("'/>");
    }
    let mut bodies = String::new();
    for part in 0..PARTS {
        let tone = part as f64 / PARTS as f64;
        write!(
            bodies,
            "<body name='link{part}' pos='{} 0 .2'><joint axis='{} {} 0' damping='1' armature='.1'/>
             <geom type='mesh' mesh='part{part}' contype='0' conaffinity='0' rgba='{tone:.2} .5 {:.2} 1'/>",
            if part == 0 { 0.0 } else { 0.02 },
            part % 2,
            1 - part % 2,
            1.0 - tone,
        )
        .unwrap();
    }
    Model::from_xml_str(&format!(
        "<mujoco><statistic center='0 0 2' extent='3'/><asset>{assets}</asset><worldbody><light pos='2 -2 8' dir='-.2 .2 -1' castshadow='true'/>
         <geom name='floor' type='plane' size='3 3 .1' rgba='.8 .8 .8 1'/>{bodies}{}</worldbody></mujoco>",
        "</body>".repeat(PARTS)
    ))
    .unwrap()
}

#[test]
fn a_robot_of_200_000_triangles_needs_at_most_3_mb() {
    let model = large_robot();
    assert_eq!(model.nmeshface(), 200_000);
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(&model);
    trajectory.record(&mut data, &mut RandomController::new(0), 2000).unwrap();
    let size = saved(&model, &[("", &trajectory)], &HtmlOptions::default()).text.len();
    println!("a robot of 200,000 triangles: {} kB", size / 1000);
    let exact = HtmlOptions::default().with_mesh_error(0.0);
    let exact = saved(&model, &[("", &trajectory)], &exact).text.len();
    println!("with all triangles: {} kB", exact / 1000);
    assert!(size <= 1_500_000 && exact <= 3_000_000, "{size} {exact}");
}
