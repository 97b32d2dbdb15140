//! Residuals of the positions and orientations of bodies and sites.

use super::{Needs, Residual, ResidualJacobian, subtract};
use crate::data::Data;
use crate::error::Result;
use crate::id::{BodyId, GeomId, IntoId, SiteId};
use crate::kind;
use crate::math::{mat2quat, sub_quat, sub_quat_derivative};
use crate::matrix::Matrix;
use crate::model::Model;

/// Frame that moves with a body, for residuals of poses.
///
/// ```
/// use mujoco_safe::control::residual::Frame;
/// use mujoco_safe::sample;
///
/// let model = sample::humanoid();
/// let (foot, hand) = (Frame::site(&model, "sole_left")?, Frame::body(&model, "hand_left")?);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Frame {
    /// Frame of a body.
    Body(BodyId),
    /// Frame of a site.
    Site(SiteId),
    /// Frame of a geom.
    Geom(GeomId),
}

impl Frame {
    /// Returns the frame of a body.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown body.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn body(model: &Model, body: impl IntoId<kind::Body>) -> Result<Self> {
        body.id_in(model).map(Self::Body)
    }

    /// Returns the frame of a site.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown site.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn site(model: &Model, site: impl IntoId<kind::Site>) -> Result<Self> {
        site.id_in(model).map(Self::Site)
    }

    /// Returns the frame of a geom. The compiler aligns the frames of meshes with their axes of
    /// inertia.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown geom.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn geom(model: &Model, geom: impl IntoId<kind::Geom>) -> Result<Self> {
        geom.id_in(model).map(Self::Geom)
    }

    pub(super) fn position(self, data: &Data) -> &[f64; 3] {
        match self {
            Self::Body(body) => data.body(body).xpos(),
            Self::Site(site) => data.site(site).xpos(),
            Self::Geom(geom) => data.geom(geom).xpos(),
        }
    }

    /// Returns the rotation matrix from the frame to the world, row-major.
    pub(super) fn rotation(self, data: &Data) -> &[f64; 9] {
        match self {
            Self::Body(body) => data.body(body).xmat(),
            Self::Site(site) => data.site(site).xmat(),
            Self::Geom(geom) => data.geom(geom).xmat(),
        }
    }

    pub(super) fn quaternion(self, data: &Data) -> [f64; 4] {
        match self {
            Self::Body(body) => *data.body(body).xquat(),
            Self::Site(site) => mat2quat(data.site(site).xmat()),
            Self::Geom(geom) => mat2quat(data.geom(geom).xmat()),
        }
    }

    pub(super) fn jacobian_into(
        self,
        data: &Data,
        linear: Option<&mut Matrix>,
        angular: Option<&mut Matrix>,
    ) -> Result<()> {
        match self {
            Self::Body(body) => data.jac_body_into(body, linear, angular),
            Self::Site(site) => data.jac_site_into(site, linear, angular),
            Self::Geom(geom) => data.jac_geom_into(geom, linear, angular),
        }
    }
}

/// Position of a body's or a site's frame relative to a target: three components in metres, world
/// frame.
///
/// ```
/// use mujoco_safe::control::residual::{FramePosition, Norm, ResidualCost, Term};
/// use mujoco_safe::sample;
///
/// // Move the left hand to a point. The cost grows linearly with the distance from about 0.1 m on.
/// let model = sample::humanoid();
/// let hand = FramePosition::body(&model, "hand_left")?.with_target([0.4, 0.3, 1.2]);
/// let reach = Term::new("reach", hand).with_norm(Norm::SmoothAbs { width: 0.1 });
/// let cost = ResidualCost::new(model, [reach])?;
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FramePosition {
    frame: Frame,
    target: [f64; 3],
}

impl FramePosition {
    /// Creates the residual of a body. The target is the origin of the world.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown body.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn body(model: &Model, body: impl IntoId<kind::Body>) -> Result<Self> {
        Ok(Self { frame: Frame::body(model, body)?, target: [0.0; 3] })
    }

    /// Creates the residual of a site. The target is the origin of the world.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown site.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn site(model: &Model, site: impl IntoId<kind::Site>) -> Result<Self> {
        Ok(Self { frame: Frame::site(model, site)?, target: [0.0; 3] })
    }

    /// Sets the target, in metres, world frame.
    #[must_use]
    pub fn with_target(mut self, target: [f64; 3]) -> Self {
        self.target = target;
        self
    }
}

impl Residual for FramePosition {
    fn size(&self) -> usize {
        3
    }

    fn needs(&self) -> Needs {
        Needs::Poses
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        subtract(self.frame.position(data), &self.target, residual);
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        self.frame.jacobian_into(data, Some(&mut jacobian.linear), None)?;
        jacobian.copy_linear();
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}

/// Orientation of a body or a site relative to a target: the rotation vector from the target to the
/// frame, three components in radians, in the axes of the target. Its length is the angle between
/// both, at most π.
///
/// The derivative is not defined for half a turn, where the shortest rotation changes.
#[derive(Clone, Debug)]
pub struct FrameOrientation {
    frame: Frame,
    target: [f64; 4],
}

impl FrameOrientation {
    /// Creates the residual of a body. The target is the orientation of the world.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown body.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn body(model: &Model, body: impl IntoId<kind::Body>) -> Result<Self> {
        Ok(Self { frame: Frame::body(model, body)?, target: [1.0, 0.0, 0.0, 0.0] })
    }

    /// Creates the residual of a site. The target is the orientation of the world.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown site.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn site(model: &Model, site: impl IntoId<kind::Site>) -> Result<Self> {
        Ok(Self { frame: Frame::site(model, site)?, target: [1.0, 0.0, 0.0, 0.0] })
    }

    /// Sets the target, a unit quaternion `[w, x, y, z]` from the target's axes to the world.
    #[must_use]
    pub fn with_target(mut self, target: [f64; 4]) -> Self {
        self.target = target;
        self
    }
}

impl Residual for FrameOrientation {
    fn size(&self) -> usize {
        3
    }

    fn needs(&self) -> Needs {
        Needs::Poses
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        residual.copy_from_slice(&sub_quat(&self.frame.quaternion(data), &self.target));
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        self.frame.jacobian_into(data, None, Some(&mut jacobian.angular))?;
        // The derivative refers to rotations in the axes of the frame, and the Jacobian to the axes
        // of the world.
        let derivative = sub_quat_derivative(&self.frame.quaternion(data), &self.target).da;
        let rotation = self.frame.rotation(data);
        for component in 0..3 {
            let factors: [f64; 3] = std::array::from_fn(|axis| {
                (0..3).map(|k| derivative[3 * component + k] * rotation[3 * axis + k]).sum()
            });
            jacobian.add_angular(component, factors);
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
