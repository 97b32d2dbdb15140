//! The engine's enumerations. A C int becomes one of these only after it was compared with each constant.

use mujoco_sys as sys;

/// Declares an enum over the engine's constants.
macro_rules! engine_enum {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $constant:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[non_exhaustive]
        pub enum $name {
            $($(#[$variant_doc])* #[doc = concat!("\n\nEngine constant `", stringify!($constant), "`.")] $variant),*
        }

        impl $name {
            /// The variant of an engine constant, if there is one.
            #[allow(dead_code, reason = "not every enum is read back from the engine")]
            #[inline]
            pub(crate) fn from_raw(raw: i32) -> Option<Self> {
                match raw {
                    $(raw if raw == sys::$constant as i32 => Some(Self::$variant),)*
                    _ => None,
                }
            }

            /// The engine constant.
            #[allow(dead_code, reason = "not every enum is handed to the engine")]
            pub(crate) fn raw(self) -> i32 {
                (match self {
                    $(Self::$variant => sys::$constant,)*
                }) as i32
            }

            /// The variant of a field that loading has validated.
            #[allow(dead_code, reason = "idem")]
            #[inline]
            pub(crate) fn of_field(raw: i32) -> Self {
                Self::from_raw(raw).unwrap_or_else(|| panic!(concat!("Bug: a model with ", stringify!($name), " {}"), raw))
            }
        }
    };
}
pub(crate) use engine_enum;

engine_enum! {
    /// How a step advances the state in time.
    Integrator {
        /// Semi-implicit Euler, with implicit joint damping.
        Euler = mjINT_EULER,
        /// Runge–Kutta of fourth order.
        Rk4 = mjINT_RK4,
        /// Implicit in velocity.
        Implicit = mjINT_IMPLICIT,
    }
}
engine_enum! {
    /// Which pairs of geoms are tested for collision.
    Collision {
        /// Pairs that the model names, and those that `contype` and `conaffinity` select.
        All = mjCOL_ALL,
        /// Only those that the model names.
        Pair = mjCOL_PAIR,
        /// Only those that `contype` and `conaffinity` select.
        Dynamic = mjCOL_DYNAMIC,
    }
}
engine_enum! {
    /// The friction cone of contacts.
    Cone {
        /// A pyramid inscribed into the cone.
        Pyramidal = mjCONE_PYRAMIDAL,
        /// The cone itself.
        Elliptic = mjCONE_ELLIPTIC,
    }
}
engine_enum! {
    /// How the constraint Jacobian is stored.
    JacobianStorage {
        /// Dense rows.
        Dense = mjJAC_DENSE,
        /// Compressed rows.
        Sparse = mjJAC_SPARSE,
        /// Dense up to 60 degrees of freedom.
        Auto = mjJAC_AUTO,
    }
}
engine_enum! {
    /// The constraint solver.
    Solver {
        /// Projected Gauss–Seidel, on the dual problem.
        Pgs = mjSOL_PGS,
        /// Conjugate gradients, on the primal problem.
        Cg = mjSOL_CG,
        /// Newton's method, on the primal problem.
        Newton = mjSOL_NEWTON,
    }
}
engine_enum! {
    /// The type of a joint.
    JointType {
        /// Six degrees of freedom; seven numbers in `qpos`.
        Free = mjJNT_FREE,
        /// Three rotations; a quaternion in `qpos`.
        Ball = mjJNT_BALL,
        /// A translation along an axis.
        Slide = mjJNT_SLIDE,
        /// A rotation about an axis.
        Hinge = mjJNT_HINGE,
    }
}
engine_enum! {
    /// The shape of a geom or a site.
    GeomType {
        /// A plane, finite or infinite.
        Plane = mjGEOM_PLANE,
        /// A field of heights over a grid.
        HeightField = mjGEOM_HFIELD,
        /// A sphere.
        Sphere = mjGEOM_SPHERE,
        /// A cylinder with two half spheres.
        Capsule = mjGEOM_CAPSULE,
        /// An ellipsoid.
        Ellipsoid = mjGEOM_ELLIPSOID,
        /// A cylinder.
        Cylinder = mjGEOM_CYLINDER,
        /// A box.
        Box = mjGEOM_BOX,
        /// A mesh of triangles, which collides as its convex hull.
        Mesh = mjGEOM_MESH,
    }
}

impl JointType {
    /// The joint's numbers in `qpos`: 7, 4 or 1.
    #[inline]
    pub fn nq(self) -> usize {
        match self {
            Self::Free => 7,
            Self::Ball => 4,
            Self::Slide | Self::Hinge => 1,
        }
    }

    /// The joint's degrees of freedom: 6, 3 or 1.
    #[inline]
    pub fn nv(self) -> usize {
        match self {
            Self::Free => 6,
            Self::Ball => 3,
            Self::Slide | Self::Hinge => 1,
        }
    }
}
