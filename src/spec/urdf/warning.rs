//! Parts of a URDF that a spec does not have.

use std::fmt;

use super::element::number;

/// Part of a URDF that the spec does not have, or that acts otherwise than it seems:
/// [`Spec::urdf_warnings`](crate::spec::Spec::urdf_warnings).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum UrdfWarning {
    /// A root link is fixed to the world, because no joint says otherwise. The compiler fuses it,
    /// and the links that are fixed to it, with the world, and their mass is lost.
    /// [`Spec::add_free_base`](crate::spec::Spec::add_free_base) lets the robot float.
    FixedMass {
        /// Name of the root link.
        link: String,
        /// Sum of the masses that its inertias and those of the links fixed to it state, in kg.
        mass: f64,
    },
    /// A link has a mass and no moments of inertia, which are 0 then. The compiler rejects this
    /// for a link that moves, unless `boundinertia` of `compiler` is set.
    NoInertia {
        /// Name of the link.
        link: String,
    },
    /// A link that moves has collision geometry and no `<inertial>`. The compiler computes its mass
    /// from the geometry, with the density of water.
    Density {
        /// Name of the link.
        link: String,
    },
    /// The velocity of a joint is not limited: the engine has no such limit.
    VelocityLimit {
        /// Name of the joint.
        joint: String,
        /// The limit in rad/s or m/s.
        velocity: f64,
    },
    /// The force of a joint is not limited: the engine has no such limit before 3.0, nor for a
    /// `floating` or `spherical` joint. [`Spec::add_motors`](crate::spec::Spec::add_motors) limits
    /// the force of the motor of a joint.
    EffortLimit {
        /// Name of the joint.
        joint: String,
        /// The limit in N m or N.
        effort: f64,
    },
    /// The range of a joint is not limited.
    Range {
        /// Name of the joint.
        joint: String,
        /// The reason.
        reason: String,
    },
    /// A joint does not follow another one (`mimic`).
    Mimic {
        /// Name of the joint.
        joint: String,
        /// The reason.
        reason: String,
    },
    /// A mesh, and the geom with it, is left out.
    Mesh {
        /// Name of the link.
        link: String,
        /// Name of the file in the URDF.
        file: String,
        /// The reason.
        reason: String,
    },
    /// The visual geometry is left out, as the engine does:
    /// [`LoadOptions::with_visuals`](crate::LoadOptions::with_visuals) keeps it.
    Visuals {
        /// Number of `visual` elements.
        count: usize,
    },
    /// Elements, or a setting in `mujoco`, that have no meaning for the engine.
    Ignored {
        /// The tag and the one around it, or the setting.
        what: String,
        /// Number of them.
        count: usize,
    },
}

impl fmt::Display for UrdfWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FixedMass { link, mass } => {
                write!(
                    f,
                    "link '{link}' is fixed to the world, in which {} kg are lost: add_free_base lets it float",
                    number(*mass)
                )
            }
            Self::NoInertia { link } => write!(f, "link '{link}' has no <inertia>: its moments of inertia are 0"),
            Self::Density { link } => {
                write!(f, "link '{link}' has no <inertial>: its mass is that of its geometry with 1000 kg/m³")
            }
            Self::VelocityLimit { joint, velocity } => {
                write!(f, "joint '{joint}': the velocity limit {} is ignored", number(*velocity))
            }
            Self::EffortLimit { joint, effort } => {
                write!(f, "joint '{joint}': the effort limit {} is ignored", number(*effort))
            }
            Self::Range { joint, reason } => write!(f, "joint '{joint}' has no limits: {reason}"),
            Self::Mimic { joint, reason } => write!(f, "joint '{joint}': <mimic> is ignored: {reason}"),
            Self::Mesh { link, file, reason } => write!(f, "link '{link}': the mesh '{file}' is left out: {reason}"),
            Self::Visuals { count } => write!(f, "{count} <visual> elements are left out"),
            Self::Ignored { what, count: 1 } => write!(f, "{what} is ignored"),
            Self::Ignored { what, count } => write!(f, "{what} is ignored ({count} times)"),
        }
    }
}
