//! Additions to the documentation of the accessors.

/// Additions to the header's one-line comments, for the most common fields.
pub(crate) const NOTES: [(&str, &str); 22] = [
    (
        "qpos",
        "In metres for slide joints and radians for hinge joints. A ball joint has a unit quaternion `[w, x, y, z]`, a free joint a position in the world frame followed by such a quaternion. `nq` equals `nv` only without ball and free joints.",
    ),
    (
        "qvel",
        "In m/s and rad/s. The linear velocity of a free joint is in the world frame. The angular velocity of a free or ball joint is in the body frame.",
    ),
    ("qacc", "In m/s² and rad/s², in the frames of `qvel`. Output of `forward`, input of `inverse`."),
    ("act", "State of the last `na` actuators; the others have no activation."),
    (
        "ctrl",
        "In the units of each actuator: for a motor, torque or force divided by the gear. Clamped to `actuator_ctrlrange` for actuators with limited control.",
    ),
    (
        "qfrc_applied",
        "In N and N·m, one value per degree of freedom. The values persist until the program changes them.",
    ),
    (
        "xfrc_applied",
        "Per body a force in N, then a torque in N·m, in the world frame, at the centre of mass of the body. The values persist until the program changes them.",
    ),
    ("mocap_pos", "In metres, in the world frame."),
    ("mocap_quat", "Unit quaternions `[w, x, y, z]`."),
    ("xpos", "In metres, in the world frame."),
    ("xquat", "Unit quaternions `[w, x, y, z]`, from the body frame to the world frame."),
    ("xmat", "Row-major 3 × 3 rotation matrices from the body frame to the world frame."),
    ("xipos", "In metres, in the world frame."),
    ("subtree_com", "In metres, in the world frame."),
    ("geom_xpos", "In metres, in the world frame."),
    ("site_xpos", "In metres, in the world frame."),
    ("sensordata", "Readings of all sensors, each at the address of its sensor."),
    ("qfrc_inverse", "In N and N·m. Output of `inverse`."),
    (
        "actuator_moment",
        "Row `i` is the derivative of the length of actuator `i` with respect to each degree of freedom, including the gear: `moment' · force` is `qfrc_actuator`.",
    ),
    ("qfrc_actuator", "In N and N·m."),
    ("body_mass", "In kilograms."),
    ("body_inertia", "In kg·m², about the centre of mass, along the axes of the inertial frame."),
];
