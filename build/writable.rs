//! Decisions which arrays of floating-point numbers safe code may write, for each version of the
//! engine.
//!
//! `knowledge/writable.tsv` has a line for each array, or several for ranges of versions. The
//! decisions come from experiments that write hostile values to each array in front of a guard
//! page, and run steps and other functions of the engine. An array without a line is read-only, so
//! that a field of a new engine is read-only until its use has been examined.

/// Access of safe code to an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Access {
    ReadOnly,
    /// Writable: no value leads outside of the engine's memory.
    Free,
    /// Writable, and checked before a simulation uses the edited model.
    Checked,
}

const TABLE: &str = include_str!("knowledge/writable.tsv");

/// Returns the access to an array, or `None` without a decision. `version` is the engine's
/// `mjVERSION_HEADER`.
fn decision(owner: &str, name: &str, ctype: &str, version: u32) -> Option<Access> {
    let version = parts(version);
    TABLE.lines().skip(1).find_map(|line| {
        let cells: Vec<&str> = line.split('\t').collect();
        let [of, field, of_type, access, since, before, _] = cells[..] else {
            panic!("not a line of the table of writable arrays: {line}")
        };
        let is_since = since == "-" || version >= parse(since);
        let is_before = before == "-" || version < parse(before);
        ([of, field, of_type] == [owner, name, ctype] && is_since && is_before).then(|| match access {
            "free" => Access::Free,
            "checked" => Access::Checked,
            "read-only" => Access::ReadOnly,
            other => panic!("the table of writable arrays has the unknown access {other}"),
        })
    })
}

/// Returns the access to an array, which is read-only without a decision.
pub(crate) fn access(owner: &str, name: &str, ctype: &str, version: u32) -> Access {
    decision(owner, name, ctype, version).unwrap_or(Access::ReadOnly)
}

/// Splits an `mjVERSION_HEADER`, which has one digit for each part up to 3.4.0 and three for the
/// minor and patch version from 3.5.0.
fn parts(version: u32) -> [u32; 3] {
    let base = if version < 1000 { 10 } else { 1000 };
    [version / (base * base), version / base % base, version % base]
}

fn parse(version: &str) -> [u32; 3] {
    let parts: Vec<u32> = version.split('.').map(|part| part.parse().expect("a version has three numbers")).collect();
    parts.try_into().expect("a version has three numbers")
}

#[cfg(test)]
mod tests {
    use super::{Access, access, decision};
    use crate::accessors;

    /// Versions with a committed field table.
    const COMMITTED: [(&str, u32); 7] = [
        (include_str!("../mujoco-sys/fields/v2_2_2.tsv"), 222),
        (include_str!("../mujoco-sys/fields/v2_3_7.tsv"), 237),
        (include_str!("../mujoco-sys/fields/v3_0_1.tsv"), 301),
        (include_str!("../mujoco-sys/fields/v3_3_7.tsv"), 337),
        (include_str!("../mujoco-sys/fields/v3_5_0.tsv"), 3_005_000),
        (include_str!("../mujoco-sys/fields/v3_17_0.tsv"), 3_017_000),
        (include_str!("../mujoco-sys/fields/v4_0_1.tsv"), 4_000_001),
    ];

    /// Returns the name, the kind and the type of each array of floating-point numbers in a field
    /// table.
    fn arrays(table: &str) -> impl Iterator<Item = [&str; 3]> {
        table.lines().skip(1).filter_map(|line| {
            let cells: Vec<&str> = line.split('\t').collect();
            let is_array = matches!(cells[0], "Model" | "Data") && matches!(cells[1], "array" | "arena");
            (is_array && matches!(cells[2], "mjtNum" | "float")).then(|| [cells[0], cells[3], cells[2]])
        })
    }

    #[test]
    fn every_array_of_every_engine_is_decided() {
        for (table, version) in COMMITTED {
            let undecided: Vec<_> =
                arrays(table).filter(|[owner, name, ctype]| decision(owner, name, ctype, version).is_none()).collect();
            assert!(undecided.is_empty(), "engine {version}: decide in build/knowledge/writable.tsv: {undecided:?}");
        }
    }

    #[test]
    fn an_array_that_nobody_has_examined_is_read_only() {
        let (newest, version) = COMMITTED[6];
        let table = |line: &str| format!("{newest}{line}\n");
        let invented = table("Model\tarray\tmjtNum\tbody_magic\tnbody\t1\tmagic (nbody x 1)");
        let other_type = newest.replace("Model\tarray\tmjtNum\tbody_mass\t", "Model\tarray\tfloat\tbody_mass\t");
        let text = |table: &str| accessors::generate(table, COMMITTED[0].0, version).map(|(_, text)| text).concat();
        assert!(text(&invented).contains("fn body_magic(") && !text(&invented).contains("body_magic_mut"));
        assert!(text(newest).contains("body_mass_mut") && !text(&other_type).contains("body_mass_mut"));
    }

    #[test]
    fn decisions_depend_on_the_version() {
        for (version, expected) in
            [(222, Access::Free), (337, Access::Free), (3_005_000, Access::Free), (3_006_000, Access::Checked)]
        {
            assert_eq!(access("Model", "eq_data", "mjtNum", version), expected, "{version}");
        }
        assert_eq!(access("Model", "wrap_prm", "mjtNum", 4_000_001), Access::ReadOnly);
        assert_eq!(access("Model", "actuator_gainprm", "mjtNum", 3_017_000), Access::Checked);
    }
}
