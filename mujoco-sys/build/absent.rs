//! Constants of other versions that the engine does not have.

/// Constants that not all versions from 2.2.2 to 4.0.0 have, with the versions that have them. A
/// Rust enum over the engine's constants has a variant for each of them. The first has the value -1
/// as a C int, which the shim returns as the selection of collisions.
const CONSTANTS: [(&str, &str); 66] = [
    ("mjCOL_ALL", "2.2.2 to 2.3.7"),
    ("mjCOL_PAIR", "2.2.2 to 2.3.7"),
    ("mjCOL_DYNAMIC", "2.2.2 to 2.3.7"),
    ("mjINT_IMPLICITFAST", "2.3.3 and later"),
    ("mjINT_DISCRETE", "3.13.0 and later"),
    ("mjTRN_SO3", "3.11.0 and later"),
    ("mjDYN_FILTEREXACT", "3.0.0 and later"),
    ("mjDYN_DCMOTOR", "3.7.0 and later"),
    ("mjDYN_PID", "3.12.0 and later"),
    ("mjGAIN_DCMOTOR", "3.7.0 and later"),
    ("mjGAIN_SO3", "3.11.0 and later"),
    ("mjGAIN_PID", "3.12.0 and later"),
    ("mjBIAS_DCMOTOR", "3.7.0 and later"),
    ("mjBIAS_SO3", "3.11.0 and later"),
    ("mjGEOM_SDF", "3.0.0 and later"),
    ("mjGEOM_LINEBOX", "3.1.1 and later"),
    ("mjGEOM_FLEX", "3.0.0 and later"),
    ("mjGEOM_TRIANGLE", "3.0.0 and later"),
    ("mjEQ_FLEX", "3.0.0 and later"),
    ("mjEQ_FLEXVERT", "3.5.0 and later"),
    ("mjEQ_FLEXSTRAIN", "3.6.0 and later"),
    ("mjLABEL_FLEX", "3.0.0 and later"),
    ("mjLABEL_CONTACTPOINT", "2.3.3 and later"),
    ("mjLABEL_ISLAND", "3.0.0 and later"),
    ("mjVIS_FLEXVERT", "3.0.0 and later"),
    ("mjVIS_FLEXEDGE", "3.0.0 and later"),
    ("mjVIS_FLEXFACE", "3.0.0 and later"),
    ("mjVIS_FLEXSKIN", "3.0.0 and later"),
    ("mjVIS_ISLAND", "3.0.0 and later"),
    ("mjVIS_BODYBVH", "3.0.0 and later"),
    ("mjVIS_SDFITER", "3.0.0 and later"),
    ("mjVIS_MESHBVH", "2.3.6 and later"),
    ("mjSENS_PLUGIN", "2.3.0 and later"),
    ("mjSENS_JOINTACTFRC", "2.3.7 and later"),
    ("mjSENS_CAMPROJECTION", "3.0.0 and later"),
    ("mjSENS_GEOMDIST", "3.1.6 and later"),
    ("mjSENS_GEOMNORMAL", "3.1.6 and later"),
    ("mjSENS_GEOMFROMTO", "3.1.6 and later"),
    ("mjSENS_E_POTENTIAL", "3.3.0 and later"),
    ("mjSENS_E_KINETIC", "3.3.0 and later"),
    ("mjSENS_TENDONACTFRC", "3.3.1 and later"),
    ("mjSENS_INSIDESITE", "3.3.5 and later"),
    ("mjSENS_CONTACT", "3.3.5 and later"),
    ("mjSENS_TACTILE", "3.3.5 and later"),
    ("mjTIMER_ACCELERATION", "2.2.2 to 2.3.7"),
    ("mjWARN_VGEOMFULL", "2.2.2 to 3.6.0"),
    ("mjSAMEFRAME_BODYROT", "3.2.3 and later"),
    ("mjSAMEFRAME_INERTIAROT", "3.2.3 and later"),
    ("mjDSBL_PASSIVE", "2.2.2 to 3.3.5"),
    ("mjDSBL_MIDPHASE", "2.3.3 and later"),
    ("mjDSBL_EULERDAMP", "3.0.0 and later"),
    ("mjDSBL_NATIVECCD", "3.3.0 and later"),
    ("mjDSBL_SPRING", "3.3.6 and later"),
    ("mjDSBL_DAMPER", "3.3.6 and later"),
    ("mjDSBL_ISLAND", "3.3.6 and later"),
    ("mjDSBL_MULTICCD", "3.8.0 and later"),
    ("mjENBL_SENSORNOISE", "2.2.2 to 3.1.3"),
    ("mjENBL_MULTICCD", "2.2.2 to 3.7.0"),
    ("mjENBL_INVDISCRETE", "3.0.0 and later"),
    ("mjENBL_SLEEP", "3.4.0 and later"),
    ("mjENBL_DIAGEXACT", "3.9.0 and later"),
    ("mjENBL_IPC", "4.0.0 and later"),
    ("mjENBL_SPECULATIVE", "4.0.0 and later"),
    // Number of columns of `mat_texid`.
    ("mjNTEXROLE", "3.2.1 and later"),
    ("mjOBJ_FLEX", "3.0.0 and later"),
    ("mjOBJ_PLUGIN", "2.3.0 and later"),
];

/// Returns Rust definitions of the constants that are missing in the bindings, and of a function
/// that returns the versions with a missing constant. The value is one that does not occur in the
/// engine's enum, or a bit that is none of its flags.
pub(crate) fn definitions(bindings: &str) -> String {
    let mut text = String::new();
    let mut versions = String::new();
    for (index, (name, known)) in (0_u32..).zip(CONSTANTS) {
        if bindings.contains(&format!("pub const {name}:")) {
            continue;
        }
        let prefix = ["mjDSBL_", "mjENBL_", "mjVIS_"].into_iter().find(|prefix| name.starts_with(prefix));
        let value = match prefix {
            // The engine uses the low bits. The highest bit is the sign of a C int.
            Some(prefix) => {
                let of_the_kind = CONSTANTS.iter().filter(|(other, _)| other.starts_with(prefix));
                let position = of_the_kind.take_while(|(other, _)| *other != name).count() as u32;
                // The flags of the visualiser are indices of bits.
                if prefix == "mjVIS_" { 31 - position } else { 1_u32 << (30 - position) }
            }
            None => u32::MAX - index,
        };
        text.extend(["pub const ", name, ": ::core::ffi::c_uint = ", &value.to_string(), ";\n"]);
        versions.extend(["        \"", name, "\" => Some(\"", known, "\"),\n"]);
    }
    text + "/// Returns the versions that have a constant which this engine lacks, for example `3.0.0 and later`.\n"
        + "pub fn versions(constant: &str) -> Option<&'static str> {\n    match constant {\n"
        + &versions
        + "        _ => None,\n    }\n}\n"
}
