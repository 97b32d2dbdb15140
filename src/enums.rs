//! The engine's enumerations. A C int is converted to an enum only by comparing it with each
//! constant.
//!
//! The enums are the same with every engine. A variant that the present engine lacks does not occur
//! in its models, and a setter returns [`Error::Unsupported`](crate::Error::Unsupported) for it,
//! with the versions that have it.

use mujoco_sys as sys;

use crate::macros::engine_enum;

engine_enum! {
    /// Numerical integrator of a step.
    #[doc(alias = "mjtIntegrator")]
    Integrator {
        /// Semi-implicit Euler, with implicit joint damping.
        Euler = mjINT_EULER,
        /// Runge–Kutta of fourth order.
        Rk4 = mjINT_RK4,
        /// Implicit in velocity.
        Implicit = mjINT_IMPLICIT,
        /// Implicit in velocity, without Coriolis and centrifugal forces. With engines from 2.3.3.
        ImplicitFast = mjINT_IMPLICITFAST,
        /// Constraint solve and implicit update of the velocity in one operation: `qacc` is the
        /// change of the velocity in a step divided by its duration. With engines from 3.13.0.
        Discrete = mjINT_DISCRETE,
    }
}
engine_enum! {
    /// Selection of the pairs of geoms that are tested for collision. Engines from 3.0.0 always use
    /// `All`.
    #[doc(alias = "mjtCollision")]
    Collision {
        /// Pairs that the model names, and pairs that `contype` and `conaffinity` select.
        All = mjCOL_ALL,
        /// Only pairs that the model names.
        Pair = mjCOL_PAIR,
        /// Only pairs that `contype` and `conaffinity` select.
        Dynamic = mjCOL_DYNAMIC,
    }
}
engine_enum! {
    /// Friction cone of contacts.
    #[doc(alias = "mjtCone")]
    Cone {
        /// Pyramid inscribed into the elliptic cone.
        Pyramidal = mjCONE_PYRAMIDAL,
        /// Elliptic cone.
        Elliptic = mjCONE_ELLIPTIC,
    }
}
engine_enum! {
    /// Storage of the constraint Jacobian.
    #[doc(alias = "mjtJacobian")]
    JacobianStorage {
        /// Dense matrix.
        Dense = mjJAC_DENSE,
        /// Compressed sparse rows.
        Sparse = mjJAC_SPARSE,
        /// Dense up to 60 degrees of freedom, sparse above.
        Auto = mjJAC_AUTO,
    }
}
engine_enum! {
    /// Constraint solver.
    #[doc(alias = "mjtSolver")]
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
    /// Type of a joint.
    #[doc(alias = "mjtJoint")]
    JointType {
        /// Free joint: six degrees of freedom, seven numbers in `qpos`.
        Free = mjJNT_FREE,
        /// Ball joint: three rotations, a quaternion in `qpos`.
        Ball = mjJNT_BALL,
        /// Slide joint: translation along an axis.
        Slide = mjJNT_SLIDE,
        /// Hinge joint: rotation about an axis.
        Hinge = mjJNT_HINGE,
    }
}
engine_enum! {
    /// Shape of a geom or a site.
    #[doc(alias = "mjtGeom")]
    GeomType {
        /// Plane, finite or infinite.
        Plane = mjGEOM_PLANE,
        /// Height field: heights over a grid.
        HeightField = mjGEOM_HFIELD,
        /// Sphere.
        Sphere = mjGEOM_SPHERE,
        /// Capsule: a cylinder with hemispherical ends.
        Capsule = mjGEOM_CAPSULE,
        /// Ellipsoid.
        Ellipsoid = mjGEOM_ELLIPSOID,
        /// Cylinder.
        Cylinder = mjGEOM_CYLINDER,
        /// Box.
        Box = mjGEOM_BOX,
        /// Triangle mesh. Collisions use its convex hull.
        Mesh = mjGEOM_MESH,
        /// Signed distance field, of a plugin or of a mesh. With engines from 3.0.
        Sdf = mjGEOM_SDF,
    }
}
engine_enum! {
    /// Tracking mode of a camera or a light.
    #[doc(alias = "mjtCamLight")]
    CameraMode {
        /// Fixed in the frame of its body.
        Fixed = mjCAMLIGHT_FIXED,
        /// The position follows the body, the orientation is constant.
        Track = mjCAMLIGHT_TRACK,
        /// The position follows the centre of mass of the body's subtree, the orientation is
        /// constant.
        TrackCom = mjCAMLIGHT_TRACKCOM,
        /// The position is fixed in the frame of its body, the orientation points at a target body.
        TargetBody = mjCAMLIGHT_TARGETBODY,
        /// The position is fixed in the frame of its body, the orientation points at the centre of
        /// mass of a target body's subtree.
        TargetBodyCom = mjCAMLIGHT_TARGETBODYCOM,
    }
}
engine_enum! {
    /// Type of a texture, which determines its mapping onto a surface.
    #[doc(alias = "mjtTexture")]
    TextureType {
        /// 2D texture.
        Flat = mjTEXTURE_2D,
        /// Cube map: the six faces of a cube, or one image for all of them.
        Cube = mjTEXTURE_CUBE,
        /// Skybox: a cube map around the whole scene.
        Skybox = mjTEXTURE_SKYBOX,
    }
}
engine_enum! {
    /// Type of an element of a tendon's path: see `element::Wrap`.
    #[doc(alias = "mjtWrap")]
    WrapType {
        /// Joint of a fixed tendon.
        Joint = mjWRAP_JOINT,
        /// Pulley.
        Pulley = mjWRAP_PULLEY,
        /// Site.
        Site = mjWRAP_SITE,
        /// Sphere.
        Sphere = mjWRAP_SPHERE,
        /// Cylinder.
        Cylinder = mjWRAP_CYLINDER,
    }
}
engine_enum! {
    /// Type of the transmission of an actuator: see `element::Transmission`.
    #[doc(alias = "mjtTrn")]
    TransmissionType {
        /// Joint.
        Joint = mjTRN_JOINT,
        /// Joint, in the frame of the parent body.
        JointInParent = mjTRN_JOINTINPARENT,
        /// Slider-crank.
        SliderCrank = mjTRN_SLIDERCRANK,
        /// Tendon.
        Tendon = mjTRN_TENDON,
        /// Site.
        Site = mjTRN_SITE,
        /// Contacts of a body (adhesion).
        Body = mjTRN_BODY,
        /// Orientation of a ball joint, or of a site relative to another one. With engines from
        /// 3.11.0.
        So3 = mjTRN_SO3,
    }
}
engine_enum! {
    /// Activation dynamics of an actuator.
    #[doc(alias = "mjtDyn")]
    ActuatorDynamics {
        /// No activation: the control is used directly.
        None = mjDYN_NONE,
        /// Integrator: the control is the time derivative of the activation.
        Integrator = mjDYN_INTEGRATOR,
        /// First-order filter of the control with a time constant.
        Filter = mjDYN_FILTER,
        /// Activation dynamics of a muscle, with two time constants.
        Muscle = mjDYN_MUSCLE,
        /// User-defined by a callback.
        User = mjDYN_USER,
        /// First-order filter, integrated exactly. With engines from 3.0.0.
        FilterExact = mjDYN_FILTEREXACT,
        /// Electrical dynamics of a DC motor. With engines from 3.7.0.
        DcMotor = mjDYN_DCMOTOR,
        /// States of a PID controller. With engines from 3.12.0.
        Pid = mjDYN_PID,
    }
}
engine_enum! {
    /// Gain of an actuator: the factor of its control or activation.
    #[doc(alias = "mjtGain")]
    ActuatorGain {
        /// Constant.
        Fixed = mjGAIN_FIXED,
        /// Affine function of length and velocity.
        Affine = mjGAIN_AFFINE,
        /// Active force of a muscle as a function of length and velocity.
        Muscle = mjGAIN_MUSCLE,
        /// Torque constant of a DC motor, or its quotient by the resistance. With engines from
        /// 3.7.0.
        DcMotor = mjGAIN_DCMOTOR,
        /// Servo of a relative orientation, along the geodesic to the desired one. With engines
        /// from 3.11.0.
        So3 = mjGAIN_SO3,
        /// PID controller with set points of position and velocity. With engines from 3.12.0.
        Pid = mjGAIN_PID,
        /// User-defined by a callback.
        User = mjGAIN_USER,
    }
}
engine_enum! {
    /// Bias of an actuator: the force that is added to the product of gain and control or
    /// activation.
    #[doc(alias = "mjtBias")]
    ActuatorBias {
        /// No bias.
        None = mjBIAS_NONE,
        /// Affine function of length and velocity.
        Affine = mjBIAS_AFFINE,
        /// Passive force of a muscle.
        Muscle = mjBIAS_MUSCLE,
        /// Back EMF, cogging and friction of a DC motor. With engines from 3.7.0.
        DcMotor = mjBIAS_DCMOTOR,
        /// Damping of a servo of a relative orientation. With engines from 3.11.0.
        So3 = mjBIAS_SO3,
        /// User-defined by a callback.
        User = mjBIAS_USER,
    }
}
engine_enum! {
    /// Type of an equality constraint.
    #[doc(alias = "mjtEq")]
    EqualityType {
        /// Couples a point of one body to a point of another, like a ball joint.
        Connect = mjEQ_CONNECT,
        /// Couples the position and orientation of two bodies.
        Weld = mjEQ_WELD,
        /// Couples the positions of two slide or hinge joints by a quartic polynomial.
        Joint = mjEQ_JOINT,
        /// Couples the lengths of two tendons by a quartic polynomial.
        Tendon = mjEQ_TENDON,
        /// Keeps the lengths of all edges of a flex. With engines from 3.0.
        Flex = mjEQ_FLEX,
        /// Keeps the shape of a flex at its vertices. With engines from 3.5.
        FlexVertex = mjEQ_FLEXVERT,
        /// Keeps the strain of the cells of a flex. With engines from 3.17.
        FlexStrain = mjEQ_FLEXSTRAIN,
    }
}
engine_enum! {
    /// Data type of the values of a sensor.
    #[doc(alias = "mjtDataType")]
    SensorDataType {
        /// Real numbers.
        Real = mjDATATYPE_REAL,
        /// Positive numbers. A number that is not positive means that the sensor has no
        /// measurement.
        Positive = mjDATATYPE_POSITIVE,
        /// Unit vector.
        Axis = mjDATATYPE_AXIS,
        /// Unit quaternion `[w, x, y, z]`.
        Quaternion = mjDATATYPE_QUATERNION,
    }
}
engine_enum! {
    /// Quantity that a sensor measures.
    #[doc(alias = "mjtSensor")]
    SensorType {
        /// Sum of the normal forces of the contacts inside a site's shape, N.
        Touch = mjSENS_TOUCH,
        /// Linear acceleration of a site, m/s², in the site's frame, including gravity.
        Accelerometer = mjSENS_ACCELEROMETER,
        /// Linear velocity of a site, m/s, in the site's frame.
        Velocimeter = mjSENS_VELOCIMETER,
        /// Angular velocity of a site, rad/s, in the site's frame.
        Gyro = mjSENS_GYRO,
        /// Force between a site's body and its parent, N, in the site's frame.
        Force = mjSENS_FORCE,
        /// Torque between a site's body and its parent, N·m, in the site's frame.
        Torque = mjSENS_TORQUE,
        /// Magnetic flux at a site, in the site's frame.
        Magnetometer = mjSENS_MAGNETOMETER,
        /// Distance to the nearest geom along a site's z axis, m.
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
        /// Distance of a joint to its limit, minus its margin.
        JointLimitPosition = mjSENS_JOINTLIMITPOS,
        /// Velocity of a joint at its limit.
        JointLimitVelocity = mjSENS_JOINTLIMITVEL,
        /// Force of a joint's limit.
        JointLimitForce = mjSENS_JOINTLIMITFRC,
        /// Distance of a tendon to its limit, minus its margin.
        TendonLimitPosition = mjSENS_TENDONLIMITPOS,
        /// Velocity of a tendon at its limit.
        TendonLimitVelocity = mjSENS_TENDONLIMITVEL,
        /// Force of a tendon's limit.
        TendonLimitForce = mjSENS_TENDONLIMITFRC,
        /// Position of an object's frame, m.
        FramePosition = mjSENS_FRAMEPOS,
        /// Orientation of an object's frame.
        FrameQuaternion = mjSENS_FRAMEQUAT,
        /// X axis of an object's frame.
        FrameXAxis = mjSENS_FRAMEXAXIS,
        /// Y axis of an object's frame.
        FrameYAxis = mjSENS_FRAMEYAXIS,
        /// Z axis of an object's frame.
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
        /// Simulation time, s.
        Clock = mjSENS_CLOCK,
        /// User-defined by a callback.
        User = mjSENS_USER,
        /// Sensor of an engine plugin. With engines from 2.3.0.
        Plugin = mjSENS_PLUGIN,
        /// Force of all actuators at a slide or hinge joint, N or N·m. With engines from 2.3.7.
        JointActuatorForce = mjSENS_JOINTACTFRC,
        /// Force of all actuators at a tendon, N. With engines from 3.3.1.
        TendonActuatorForce = mjSENS_TENDONACTFRC,
        /// Pixel coordinates of a site in the image of a camera. With engines from 3.0.0.
        CameraProjection = mjSENS_CAMPROJECTION,
        /// Signed distance between two geoms, or the geoms of two bodies, m. With engines from
        /// 3.1.6.
        GeomDistance = mjSENS_GEOMDIST,
        /// Direction from a geom to the nearest point of another one. With engines from 3.1.6.
        GeomNormal = mjSENS_GEOMNORMAL,
        /// The two nearest points of two geoms, m, in the world frame. With engines from 3.1.6.
        GeomFromTo = mjSENS_GEOMFROMTO,
        /// Potential energy, J. With engines from 3.3.0.
        PotentialEnergy = mjSENS_E_POTENTIAL,
        /// Kinetic energy, J. The engine evaluates it with the sensors of the position stage, so
        /// its own linearisation ([`Data::transition_fd`](crate::Data::transition_fd)) has no
        /// derivative with respect to velocities. With engines from 3.3.0.
        KineticEnergy = mjSENS_E_KINETIC,
        /// 1 for an object inside a site's shape, else 0. With engines from 3.3.5.
        InsideSite = mjSENS_INSIDESITE,
        /// Contacts between selected geoms: force, torque, distance, position and directions. With
        /// engines from 3.3.5.
        Contact = mjSENS_CONTACT,
        /// Penetration and sliding velocity at the vertices of a mesh. With engines from 3.3.5.
        Tactile = mjSENS_TACTILE,
    }
}

/// Coincidence of an attached frame with a frame of its body, which saves the engine its
/// computation.
#[doc(alias = "mjtSameFrame")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SameFrame {
    /// Differs from both frames of the body.
    None,
    /// Coincides with the body frame.
    Body,
    /// Coincides with the inertial frame of the body.
    Inertia,
    /// Has the orientation of the body frame, with engines from 3.2.3.
    BodyRotation,
    /// Has the orientation of the inertial frame of the body, with engines from 3.2.3.
    InertiaRotation,
}

impl SameFrame {
    /// Converts a flag of the engine. Returns `None` for an unknown value.
    pub(crate) fn from_raw(raw: u8) -> Option<Self> {
        Some(match u32::from(raw) {
            0 => Self::None,
            1 => Self::Body,
            2 => Self::Inertia,
            sys::mjSAMEFRAME_BODYROT => Self::BodyRotation,
            sys::mjSAMEFRAME_INERTIAROT => Self::InertiaRotation,
            _ => return None,
        })
    }

    /// Converts a byte that the loader has validated.
    pub(crate) fn of_field(raw: u8) -> Self {
        Self::from_raw(raw).unwrap_or_else(|| panic!("Bug: a model with sameframe {raw}"))
    }
}

impl JointType {
    /// Returns the number of values of the joint in `qpos`: 7, 4 or 1.
    #[inline]
    pub fn nq(self) -> usize {
        match self {
            Self::Free => 7,
            Self::Ball => 4,
            Self::Slide | Self::Hinge => 1,
        }
    }

    /// Returns the number of degrees of freedom of the joint: 6, 3 or 1.
    #[inline]
    pub fn nv(self) -> usize {
        match self {
            Self::Free => 6,
            Self::Ball => 3,
            Self::Slide | Self::Hinge => 1,
        }
    }
}
