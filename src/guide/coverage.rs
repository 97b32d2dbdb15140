//! Tables of the engine's functions, struct fields and element kinds, with the corresponding items
//! of this crate and of MuJoCo.jl. The tables are generated from the engine's own lists, and a test
//! checks that they are complete.

/// Functions of `mujoco.h`.
#[doc = include_str!("../../docs/coverage/functions.md")]
// A search for a function without an equivalent finds the page that has the reason.
#[doc(alias(
    "mj_freeLastXML",
    "mj_findFileVFS",
    "mj_deleteFileVFS",
    "mj_resetDataDebug",
    "mj_defaultSolRefImp",
    "mj_stackAlloc",
    "mj_activate",
    "mj_deactivate",
    "mju_str2Type",
    "mj_resetCallbacks",
    "mju_error",
    "mju_error_i",
    "mju_error_s",
    "mju_warning",
    "mju_warning_i",
    "mju_warning_s",
    "mj_warning",
    "mju_warningText",
    "mju_clearHandlers",
    "mju_writeLog",
    "mju_malloc",
    "mju_free",
    "mju_strncpy",
    "mj_printFormattedModel",
    "mj_printFormattedData",
    "mju_printMatSparse",
    "mju_zero3",
    "mju_copy3",
    "mju_scl3",
    "mju_add3",
    "mju_sub3",
    "mju_addTo3",
    "mju_subFrom3",
    "mju_addToScl3",
    "mju_addScl3",
    "mju_dist3",
    "mju_zero4",
    "mju_unit4",
    "mju_copy4",
    "mju_min",
    "mju_max",
    "mju_clip",
    "mju_sign",
    "mju_round",
    "mju_standardNormal",
    "mjv_updateSkin",
    "mjv_defaultFigure",
))]
pub mod functions {}

/// Fields of the engine's structs.
#[doc = include_str!("../../docs/coverage/fields.md")]
pub mod fields {}

/// Kinds of elements, and the fields of each.
#[doc = include_str!("../../docs/coverage/kinds.md")]
pub mod kinds {}
