//! Names that most programs need: `use mujoco_safe::prelude::*;`.
//!
//! ```
//! use mujoco_safe::prelude::*;
//!
//! let mut data = Data::new(mujoco_safe::sample::cartpole())?;
//! let hinge = data.model().joint("hinge")?.id();
//! data.joint_mut(hinge).qpos_mut()[0] = 0.1;
//! ZeroController.control(&mut data)?;
//! data.step()?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```

pub use crate::control::{Lqr, LqrWeights};
pub use crate::controller::{Controller, PdController, RandomController, ZeroController};
pub use crate::data::{Data, Stage, StateSpec};
pub use crate::derivative::{Differences, StateSpace};
pub use crate::error::Error;
pub use crate::id::{ActuatorId, BodyId, GeomId, JointId, SensorId, SiteId};
pub use crate::matrix::{Matrix, MatrixView, MatrixViewMut};
pub use crate::model::{Model, Options};
pub use crate::rollout::Rollout;
pub use crate::scene::Scene;
pub use crate::trajectory::Trajectory;
