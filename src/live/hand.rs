//! The spring by which a browser pulls a body.

use super::message::Pull;
use crate::data::{Data, Stage};
use crate::error::Result;
use crate::math::{norm, trn_vec_pose};
use crate::replay::{self, Frame};
use crate::scene::{Camera, MovableBodies, Perturbation, PerturbationFlags, Scene, Selection};

/// Spring between a point of a body and its target.
#[derive(Debug)]
pub(super) struct Hand {
    /// Only for the engine, which computes the scale of mouse motions from its camera.
    scene: Scene,
    perturbation: Perturbation,
    held: Option<Pull>,
    /// Target position of the centre of mass, and the point, m, world frame, at the start.
    start: [[f64; 3]; 2],
    /// The target has moved since the pose was last applied.
    is_new: bool,
    /// Largest distance to the target, m.
    reach: f64,
}

impl Hand {
    /// `data` has positions.
    pub(super) fn new(data: &Data) -> Result<Self> {
        let model = data.model();
        let mut scene = Scene::new(model, 1)?;
        scene.update_camera(data, &mut Camera::free(model))?;
        let extent = model.statistics().extent;
        Ok(Self {
            scene,
            perturbation: Perturbation::default(),
            held: None,
            start: [[0.0; 3]; 2],
            is_new: false,
            reach: if extent.is_finite() { 2.0 * extent } else { 1.0 },
        })
    }

    /// Moves the target, and grips the point first if it is another one. Needs velocities.
    pub(super) fn pull(&mut self, data: &mut Data, pull: Pull) -> Result<()> {
        if self.held == Some(pull) {
            return Ok(());
        }
        let is_same = |held: Pull| (held.body, held.point) == (pull.body, pull.point);
        if !self.held.is_some_and(is_same) {
            self.grip(data, pull)?;
        }
        self.held = Some(pull);
        let [start, from] = self.start;
        let way: [f64; 3] = std::array::from_fn(|axis| pull.target[axis] - from[axis]);
        // Without a way and an extent, the quotient is NaN, which `min` ignores.
        let scale = (self.reach / norm(&way)).min(1.0);
        self.perturbation.refpos = std::array::from_fn(|axis| start[axis] + scale * way[axis]);
        self.is_new = true;
        Ok(())
    }

    fn grip(&mut self, data: &mut Data, pull: Pull) -> Result<()> {
        self.let_go(data);
        let body = data.model().body(pull.body)?.id();
        let point = trn_vec_pose(&replay::pose(data, Frame::Body(pull.body)), &pull.point);
        let selection = Selection { body, geom: None, skin: None, flex: None, point };
        self.perturbation.select(data, &selection)?;
        self.perturbation.start(data, &self.scene)?;
        self.perturbation.active = PerturbationFlags::TRANSLATE;
        self.start = [self.perturbation.refpos, point];
        Ok(())
    }

    /// Ends the pull and removes its force.
    pub(super) fn let_go(&mut self, data: &mut Data) {
        if self.held.take().is_some() {
            self.perturbation.remove_force(data);
            self.perturbation.unselect();
        }
    }

    /// Applies the force for the next step, or moves a mocap body.
    pub(super) fn apply(&mut self, data: &mut Data) -> Result<()> {
        self.perturbation.apply_pose(data, MovableBodies::Mocap)?;
        self.perturbation.apply_force(data)
    }

    /// Moves a body that can move freely, for a paused simulation. Returns `true` if the state may
    /// have changed.
    pub(super) fn drag(&mut self, data: &mut Data) -> Result<bool> {
        self.perturbation.remove_force(data);
        if !std::mem::take(&mut self.is_new) {
            return Ok(false);
        }
        self.perturbation.apply_pose(data, MovableBodies::MocapAndFree)?;
        Ok(true)
    }
}

/// Computes the quantities that a pull needs, unless they have been computed. The state remains.
pub(super) fn refresh(data: &mut Data, state: &mut Vec<f64>) -> Result<()> {
    if data.stage() < Stage::Velocity { data.forward_between_steps(state) } else { Ok(()) }
}
