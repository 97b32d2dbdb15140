//! The humanoid on one leg under iLQR over a receding horizon, in the viewer.

use std::error::Error;

use mujoco_safe::Data;

use crate::common::live_plan::{LivePlan, Point};
use crate::common::window;
use crate::pushes::Scenario;

/// Shows the humanoid until the window is closed. The user can pull it and change the weights of
/// the cost.
pub fn run(threads: usize) -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::new()?;
    let model = &scenario.model;
    let mut data = Data::new(model.clone())?;
    scenario.set_point.apply(&mut data)?;
    let torso = model.body("torso")?.index();
    let sole = model.site("sole_right")?.index();
    let points = vec![
        Point { position: Box::new(move |data| data.subtree_com()[torso]), rgba: [0.9, 0.55, 0.1, 1.0] },
        Point { position: Box::new(move |data| data.site_xpos()[sole]), rgba: [0.1, 0.45, 0.8, 1.0] },
    ];
    let controller = scenario.controller(&data, threads)?;
    let plan = LivePlan::new(&data, controller, points, |_| ())?;
    window::show_plan("Humanoid with predictive control", data, plan, Vec::new())
}
