//! Constants of other versions that the engine does not have.

/// Constants of at least one supported version, with the value for engines without the constant: one that does not occur in their enum, or
/// a bit that is none of their flags.
const CONSTANTS: [(&str, u32); 17] = [
    ("mjINT_IMPLICITFAST", u32::MAX),
    ("mjDYN_FILTEREXACT", u32::MAX),
    ("mjCOL_ALL", u32::MAX),
    ("mjCOL_PAIR", u32::MAX - 1),
    ("mjCOL_DYNAMIC", u32::MAX - 2),
    ("mjGEOM_LINEBOX", u32::MAX),
    ("mjGEOM_FLEX", u32::MAX - 1),
    ("mjGEOM_TRIANGLE", u32::MAX - 2),
    ("mjTIMER_ACCELERATION", u32::MAX),
    ("mjWARN_VGEOMFULL", u32::MAX),
    ("mjSAMEFRAME_BODYROT", u32::MAX),
    ("mjSAMEFRAME_INERTIAROT", u32::MAX - 1),
    ("mjDSBL_SPRING", 1 << 30),
    ("mjDSBL_DAMPER", 1 << 29),
    ("mjDSBL_PASSIVE", 1 << 28),
    ("mjENBL_SENSORNOISE", 1 << 30),
    ("mjENBL_MULTICCD", 1 << 29),
];

/// Returns Rust definitions of the constants that are missing in the bindings.
pub(crate) fn definitions(bindings: &str) -> String {
    let is_absent = |name: &str| !bindings.contains(&format!("pub const {name}:"));
    let mut text = String::new();
    for (name, value) in CONSTANTS.into_iter().filter(|(name, _)| is_absent(name)) {
        text.extend(["pub const ", name, ": ::core::ffi::c_uint = ", &value.to_string(), ";\n"]);
    }
    text
}
