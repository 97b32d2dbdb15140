//! Arrays that newer engines allocate in an arena during each computation of the constraints.
//! Before the engine has written an array, its memory is uninitialised or belongs to another array
//! of an earlier computation, so its accessor is empty until the call that writes it.

/// Returns the constant of `PipelineFlags` for the results with which the engine writes an array.
/// `None` for copies that the solver sorts by island and for its workspace: whether it writes them
/// depends on the solver and the version, so they have no accessor.
pub(super) fn written_with(name: &str) -> Option<&'static str> {
    let fits = |names: &[&str]| {
        names.iter().any(|known| match known.strip_suffix('*') {
            Some(beginning) => name.starts_with(beginning),
            None => name == *known,
        })
    };
    WRITTEN.iter().find(|(_, names)| fits(names)).map(|&(results, _)| results)
}

/// Returns `true` for the indices of a sparse constraint Jacobian, which the engine allocates but
/// does not write if it is dense.
pub(super) fn is_of_sparse_jacobian(name: &str) -> bool {
    matches!(name, "efc_J_rownnz" | "efc_J_rowadr" | "efc_J_rowsuper" | "efc_J_colind")
}

/// Results, and the arrays that the engine writes with them. A name that ends with `*` matches all
/// arrays with this prefix. The first match applies.
const WRITTEN: [(&str, &[&str]); 6] = [
    ("PROJECTION", &["efc_Y*", "efc_AR*"]),
    ("REFERENCE", &["efc_vel", "efc_aref"]),
    ("SOLVER_COST", &["efc_b"]),
    ("CONSTRAINT_STATE", &["efc_state"]),
    ("FORCE", &["efc_force"]),
    ("CONSTRAINT", &["efc_*", "tendon_efcadr", "tree_island", "dof_island", "island_*", "map_*"]),
];
