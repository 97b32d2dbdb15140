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
engine_enum! {
    /// What a camera or a light does while its body moves.
    #[doc(alias = "mjtCamLight")]
    CameraMode {
        /// It is fixed to its body.
        Fixed = mjCAMLIGHT_FIXED,
        /// Its position follows its body, its orientation stays.
        Track = mjCAMLIGHT_TRACK,
        /// Its position follows the centre of mass of its body's subtree, its orientation stays.
        TrackCom = mjCAMLIGHT_TRACKCOM,
        /// It is fixed to its body, and turns to a target body.
        TargetBody = mjCAMLIGHT_TARGETBODY,
        /// It is fixed to its body, and turns to the centre of mass of a target body's subtree.
        TargetBodyCom = mjCAMLIGHT_TARGETBODYCOM,
    }
}
engine_enum! {
    /// How a texture is put onto a surface.
    #[doc(alias = "mjtTexture")]
    TextureType {
        /// One image.
        Flat = mjTEXTURE_2D,
        /// The six faces of a cube, or one image for all of them.
        Cube = mjTEXTURE_CUBE,
        /// The six faces of a cube around the whole scene.
        Skybox = mjTEXTURE_SKYBOX,
    }
}
engine_enum! {
    /// Type of an element of a tendon's path: see `element::Wrap`.
    WrapType {
        /// A joint of a fixed tendon.
        Joint = mjWRAP_JOINT,
        /// A pulley.
        Pulley = mjWRAP_PULLEY,
        /// A site.
        Site = mjWRAP_SITE,
        /// A sphere.
        Sphere = mjWRAP_SPHERE,
        /// A cylinder.
        Cylinder = mjWRAP_CYLINDER,
    }
}
engine_enum! {
    /// Type of element that an actuator acts on: see `element::Transmission`.
    TransmissionType {
        /// A joint.
        Joint = mjTRN_JOINT,
        /// A joint, in the frame of the parent body.
        JointInParent = mjTRN_JOINTINPARENT,
        /// A slider-crank.
        SliderCrank = mjTRN_SLIDERCRANK,
        /// A tendon.
        Tendon = mjTRN_TENDON,
        /// A site.
        Site = mjTRN_SITE,
        /// The contacts of a body.
        Body = mjTRN_BODY,
    }
}
engine_enum! {
    /// How an actuator's activation follows its control.
    #[doc(alias = "mjtDyn")]
    ActuatorDynamics {
        /// It has no activation: the control is used as it is.
        None = mjDYN_NONE,
        /// The control is the activation's rate.
        Integrator = mjDYN_INTEGRATOR,
        /// The activation approaches the control with a time constant.
        Filter = mjDYN_FILTER,
        /// As a muscle is excited, with two time constants.
        Muscle = mjDYN_MUSCLE,
        /// As a callback says.
        User = mjDYN_USER,
    }
}
engine_enum! {
    /// What an actuator's control or activation is multiplied by.
    #[doc(alias = "mjtGain")]
    ActuatorGain {
        /// A number.
        Fixed = mjGAIN_FIXED,
        /// A number, plus multiples of length and velocity.
        Affine = mjGAIN_AFFINE,
        /// The active force of a muscle by its length and velocity.
        Muscle = mjGAIN_MUSCLE,
        /// What a callback says.
        User = mjGAIN_USER,
    }
}
engine_enum! {
    /// What is added to an actuator's force.
    #[doc(alias = "mjtBias")]
    ActuatorBias {
        /// Nothing.
        None = mjBIAS_NONE,
        /// A number, plus multiples of length and velocity.
        Affine = mjBIAS_AFFINE,
        /// The passive force of a muscle.
        Muscle = mjBIAS_MUSCLE,
        /// What a callback says.
        User = mjBIAS_USER,
    }
}
engine_enum! {
    /// What an equality constraint ties together.
    #[doc(alias = "mjtEq")]
    EqualityType {
        /// A point of one body to a point of another: a ball joint.
        Connect = mjEQ_CONNECT,
        /// A body to another, position and orientation.
        Weld = mjEQ_WELD,
        /// The position of a slide or hinge joint to that of another, by a polynomial of fourth degree.
        Joint = mjEQ_JOINT,
        /// The length of a tendon to that of another, by a polynomial of fourth degree.
        Tendon = mjEQ_TENDON,
    }
}
engine_enum! {
    /// What the numbers of a sensor are.
    #[doc(alias = "mjtDataType")]
    SensorDataType {
        /// Real numbers.
        Real = mjDATATYPE_REAL,
        /// Numbers that are positive, or else say that there is nothing to measure.
        Positive = mjDATATYPE_POSITIVE,
        /// A unit vector.
        Axis = mjDATATYPE_AXIS,
        /// A unit quaternion `[w, x, y, z]`.
        Quaternion = mjDATATYPE_QUATERNION,
    }
}
engine_enum! {
    /// What a sensor measures.
    #[doc(alias = "mjtSensor")]
    SensorType {
        /// Normal forces of the contacts inside a site's shape, N, summed.
        Touch = mjSENS_TOUCH,
        /// Linear acceleration of a site, m/s², in its own frame, gravity included.
        Accelerometer = mjSENS_ACCELEROMETER,
        /// Linear velocity of a site, m/s, in its own frame.
        Velocimeter = mjSENS_VELOCIMETER,
        /// Angular velocity of a site, rad/s, in its own frame.
        Gyro = mjSENS_GYRO,
        /// Force between a site's body and its parent, N, in the site's frame.
        Force = mjSENS_FORCE,
        /// Torque between a site's body and its parent, N·m, in the site's frame.
        Torque = mjSENS_TORQUE,
        /// Magnetic flux at a site, in its own frame.
        Magnetometer = mjSENS_MAGNETOMETER,
        /// Distance to what is next along a site's z axis, m.
        Rangefinder = mjSENS_RANGEFINDER,
        /// Position of a slide or hinge joint, m or rad.
        JointPosition = mjSENS_JOINTPOS,
        /// Velocity of a slide or hinge joint, m/s or rad/s.
        JointVelocity = mjSENS_JOINTVEL,
        /// Length of a tendon, m.
        TendonPosition = mjSENS_TENDONPOS,
        /// Velocity of a tendon, m/s.
        TendonVelocity = mjSENS_TENDONVEL,
        /// Length of an actuator.
        ActuatorPosition = mjSENS_ACTUATORPOS,
        /// Velocity of an actuator.
        ActuatorVelocity = mjSENS_ACTUATORVEL,
        /// Force of an actuator, N or N·m.
        ActuatorForce = mjSENS_ACTUATORFRC,
        /// Orientation of a ball joint.
        BallQuaternion = mjSENS_BALLQUAT,
        /// Angular velocity of a ball joint, rad/s.
        BallAngularVelocity = mjSENS_BALLANGVEL,
        /// Distance of a joint to its limit, less its margin.
        JointLimitPosition = mjSENS_JOINTLIMITPOS,
        /// Velocity of a joint at its limit.
        JointLimitVelocity = mjSENS_JOINTLIMITVEL,
        /// Force of a joint's limit.
        JointLimitForce = mjSENS_JOINTLIMITFRC,
        /// Distance of a tendon to its limit, less its margin.
        TendonLimitPosition = mjSENS_TENDONLIMITPOS,
        /// Velocity of a tendon at its limit.
        TendonLimitVelocity = mjSENS_TENDONLIMITVEL,
        /// Force of a tendon's limit.
        TendonLimitForce = mjSENS_TENDONLIMITFRC,
        /// Position of an object's frame, m.
        FramePosition = mjSENS_FRAMEPOS,
        /// Orientation of an object's frame.
        FrameQuaternion = mjSENS_FRAMEQUAT,
        /// The x axis of an object's frame.
        FrameXAxis = mjSENS_FRAMEXAXIS,
        /// The y axis of an object's frame.
        FrameYAxis = mjSENS_FRAMEYAXIS,
        /// The z axis of an object's frame.
        FrameZAxis = mjSENS_FRAMEZAXIS,
        /// Linear velocity of an object's frame, m/s.
        FrameLinearVelocity = mjSENS_FRAMELINVEL,
        /// Angular velocity of an object's frame, rad/s.
        FrameAngularVelocity = mjSENS_FRAMEANGVEL,
        /// Linear acceleration of an object's frame, m/s².
        FrameLinearAcceleration = mjSENS_FRAMELINACC,
        /// Angular acceleration of an object's frame, rad/s².
        FrameAngularAcceleration = mjSENS_FRAMEANGACC,
        /// Centre of mass of a body's subtree, m.
        SubtreeCom = mjSENS_SUBTREECOM,
        /// Linear velocity of a body's subtree, m/s.
        SubtreeLinearVelocity = mjSENS_SUBTREELINVEL,
        /// Angular momentum of a body's subtree, kg·m²/s.
        SubtreeAngularMomentum = mjSENS_SUBTREEANGMOM,
        /// The time, s.
        Clock = mjSENS_CLOCK,
        /// What a callback says.
        User = mjSENS_USER,
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
