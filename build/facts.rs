//! Facts about fields that the field table does not have.

/// Fields with a hand-written accessor: `Model::name`, `Model::text_data`, `Data::contacts`,
/// `Data::warning`, `Data::timer`, `Data::solver`, `Data::solver_fwdinv`, `Data::energy`.
pub(crate) const BY_HAND: [&str; 8] =
    ["names", "text_data", "contact", "warning", "timer", "solver", "solver_fwdinv", "energy"];

/// C types without an accessor: addresses for the engine's own use, and text.
pub(crate) const WITHOUT_ACCESSOR: [&str; 2] = ["uintptr_t", "char"];

/// Floating-point arrays from which the compiler has derived flags that let the engine skip
/// computations, and the method that clears the flags before mutable access.
pub(crate) const FLAGGED: [(&str, &str); 14] = [
    ("geom_size", "loosen_bounds"),
    ("geom_margin", "loosen_boxes"),
    ("geom_gap", "loosen_boxes"),
    ("geom_pos", "clear_geom_frame_flags"),
    ("geom_quat", "clear_geom_frame_flags"),
    ("site_pos", "clear_site_frame_flags"),
    ("site_quat", "clear_site_frame_flags"),
    ("body_ipos", "clear_inertial_frame_flags"),
    ("body_iquat", "clear_inertial_frame_flags"),
    ("body_mass", "clear_simple_body_flags"),
    ("body_inertia", "clear_simple_body_flags"),
    ("jnt_pos", "clear_simple_body_flags"),
    ("jnt_axis", "clear_simple_body_flags"),
    ("dof_armature", "clear_simple_body_flags"),
];

/// Long arrays that cannot change in a compiled model. All other arrays are restored, including
/// short constant ones, because their copy costs less than a longer list would.
pub(crate) const CONSTANT: [&str; 5] = ["mesh_vert", "mesh_face", "mesh_graph", "skin_face", "skin_bonevertid"];

/// Sizes that are -1 since 2.3 if there is no limit.
pub(crate) const LIMITS: [&str; 2] = ["njmax", "nconmax"];

/// Integer arrays with the values of an engine's enum that has no counterpart in Rust.
pub(crate) const ENUMS: [(&str, &str); 2] = [("efc_type", "mjtConstraint"), ("efc_state", "mjtConstraintState")];
