//! Table of the calls that compute the fields of `mjData`, for the documentation of their getters.

/// Returns the documentation of the guarantee of a plain getter of `Data`: the call that computes
/// the values, and the absence of a check. Empty for arrays that programs set, and for arrays that
/// 2.2.2 does not have.
pub(super) fn guarantee(name: &str, kind: &str, is_in_default: bool) -> String {
    let fits = |fields: &[&str]| {
        fields.iter().any(|field| match field.strip_suffix('*') {
            Some(beginning) => name.starts_with(beginning),
            None => name == *field,
        })
    };
    let link = |method: &str| format!("[`{method}`](crate::Data::{method})");
    let (forward, step) = (link("forward"), link("step"));
    let (source, check) = if let Some(part) = PARTS.iter().find(|part| fits(part.fields)) {
        let methods: Vec<String> = part.methods.iter().map(|method| link(method)).collect();
        let calls = match &methods[..] {
            [method] => method.clone(),
            [first @ .., last] => format!("{} and {last}", first.join(", ")),
            [] => unreachable!("a part without a method"),
        };
        let in_forward = if part.in_forward {
            format!(", called directly or within {forward} or {step}")
        } else {
            format!(", which {forward} and {step} call only if a sensor or an option needs it")
        };
        let check = match part.needs {
            "" => String::new(),
            needs => format!(" [`require({needs})`](crate::Data::require) checks that it has been computed."),
        };
        (format!("{calls}{in_forward}"), check)
    } else if let Some((integrator, _)) = INTEGRATED.iter().find(|(_, fields)| fits(fields)) {
        (format!("{step} with {integrator}"), String::new())
    } else {
        let is_computed = is_in_default && kind == "array" && !SET_BY_PROGRAMS.contains(&name);
        assert!(!is_computed, "the table has no call that computes {name}");
        return String::new();
    };
    let validity = if kind == "arena" {
        "It is empty before the first such call, and after a change of the model or a call that recomputes its inputs."
    } else {
        "It is zero before the first such call, and changes of the state or the model do not update it."
    };
    format!("    ///\n    /// Result of the last {source}. {validity}{check}\n")
}

/// Arrays of a simulation that a program sets: state, inputs and user data.
const SET_BY_PROGRAMS: [&str; 10] = [
    "qpos",
    "qvel",
    "act",
    "qacc_warmstart",
    "ctrl",
    "qfrc_applied",
    "xfrc_applied",
    "mocap_pos",
    "mocap_quat",
    "userdata",
];

/// Part of the pipeline: methods and the quantities that they compute.
struct Part {
    methods: &'static [&'static str],
    /// `true` if `forward` and `step` perform the same computation.
    in_forward: bool,
    /// Argument of `Data::require` that checks for the quantities.
    needs: &'static str,
    /// Fields. A name that ends with `*` matches all fields with this prefix.
    fields: &'static [&'static str],
}

/// Parts of the pipeline. The first part that matches a field applies.
const PARTS: [Part; 23] = [
    part(
        &["kinematics"],
        POSITION,
        &["xpos", "xquat", "xmat", "xipos", "ximat", "xanchor", "xaxis", "geom_x*", "site_x*"],
    ),
    part(&["com_pos"], POSITION, &["subtree_com", "cdof", "cinert"]),
    part(&["camlight"], POSITION, &["cam_x*", "light_x*"]),
    part(&["compute_ten_velocity"], VELOCITY, &["ten_velocity"]),
    part(&["compute_tendon"], POSITION, &["ten_*", "wrap_*"]),
    part(&["transmission"], POSITION, &["actuator_length", "actuator_moment"]),
    part(&["compute_crb"], POSITION, &["crb", "qM"]),
    part(&["factor_m"], POSITION, &["qLD", "qLDiagInv", "qLDiagSqrtInv"]),
    part(&["collision"], POSITION, &["ncon"]),
    part(&["project_constraint"], POSITION, &["efc_AR*"]),
    part(&["reference_constraint"], VELOCITY, &["efc_vel", "efc_aref"]),
    part(
        &["fwd_constraint"],
        ACCELERATION,
        &["qacc", "efc_b", "efc_force", "efc_state", "qfrc_constraint", "solver_iter", "solver_nnz"],
    ),
    part(&["make_constraint"], POSITION, &["efc_*", "ne", "nf", "nefc"]),
    part(&["compute_actuator_velocity"], VELOCITY, &["actuator_velocity"]),
    part(&["com_vel"], VELOCITY, &["cvel", "cdof_dot"]),
    part(&["passive"], VELOCITY, &["qfrc_passive"]),
    part(&["compute_qfrc_bias"], VELOCITY, &["qfrc_bias"]),
    part(&["fwd_actuation"], ACCELERATION, &["act_dot", "actuator_force", "qfrc_actuator"]),
    part(&["fwd_acceleration"], ACCELERATION, &["qfrc_smooth", "qacc_smooth"]),
    Part {
        methods: &["sensor_pos", "sensor_vel", "sensor_acc"],
        in_forward: true,
        needs: "MissingResults::SENSORS",
        fields: &["sensordata"],
    },
    Part {
        methods: &["subtree_vel"],
        in_forward: false,
        needs: "MissingResults::SUBTREE_VELOCITIES",
        fields: &["subtree_linvel", "subtree_angmom"],
    },
    Part {
        methods: &["rne_post_constraint"],
        in_forward: false,
        needs: "MissingResults::BODY_FORCES",
        fields: &["cacc", "cfrc_int", "cfrc_ext"],
    },
    Part { methods: &["inverse"], in_forward: false, needs: "", fields: &["qfrc_inverse"] },
];

const POSITION: &str = "Stage::Position";
const VELOCITY: &str = "Stage::Velocity";
const ACCELERATION: &str = "Stage::Acceleration";

/// Returns a part of forward dynamics.
const fn part(methods: &'static [&'static str], needs: &'static str, fields: &'static [&'static str]) -> Part {
    Part { methods, in_forward: true, needs, fields }
}

/// Quantities that only the integrator of a step computes.
const INTEGRATED: [(&str, &[&str]); 2] = [
    ("the integrator [`Euler`](crate::enums::Integrator::Euler) with damping in joints", &["qH", "qHDiagInv"]),
    (
        "the integrator [`Implicit`](crate::enums::Integrator::Implicit)",
        &["D_rownnz", "D_rowadr", "D_colind", "qDeriv", "qLU"],
    ),
];
