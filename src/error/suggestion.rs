//! Suggestions of similar names in errors about unknown names.

use crate::kind::Kind;

/// Returns the elements of other kinds that have the unknown name of an element.
pub(super) fn of_other_kinds(name: &str, others: &[Kind]) -> String {
    let list = others.iter().map(|kind| format!("{kind} '{name}'")).collect::<Vec<_>>().join(", ");
    if list.is_empty() { list } else { format!(" (there is {list})") }
}

/// Returns the end of the error about an unknown element: the most similar name, if one is similar
/// enough, and the known names.
pub(super) fn similar_and_known(name: &str, known: &[String]) -> String {
    const SHOWN: usize = 40;
    let suggestion = match nearest(name, known.iter().map(String::as_str)) {
        Some((distance, candidate)) if is_typo(distance, name) => format!(", did you mean '{candidate}'?"),
        _ => String::new(),
    };
    if known.is_empty() {
        return suggestion + " (none of this kind has a name)";
    }
    let list = known.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    let more = match known.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{suggestion} (known names: {list}{more})")
}

/// Returns the end of the error about an unknown field: the struct that has it, or the similar
/// names.
pub(super) fn field(owner: Option<&str>, near: &[String]) -> String {
    match owner {
        Some(owner) => {
            let rust_type = match owner {
                "Option" => "Options",
                "Statistic" => "Statistics",
                same => same,
            };
            format!(": it is a field of mj{owner}, see {rust_type}::field_docs")
        }
        None if near.is_empty() => String::new(),
        None => format!(", did you mean '{}'?", near.join("', '")),
    }
}

/// Returns at most eight names that differ little from `name`, contain it or are contained in it,
/// most similar first.
pub(crate) fn near_names<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<String> {
    const SHOWN: usize = 8;
    let mut near: Vec<(usize, &str)> = known
        .map(|candidate| (edit_distance(name, candidate), candidate))
        .filter(|&(distance, candidate)| {
            is_typo(distance, name) || (name.len() > 1 && (candidate.contains(name) || name.contains(candidate)))
        })
        .collect();
    near.sort_by_key(|&(distance, _)| distance);
    near.into_iter().take(SHOWN).map(|(_, candidate)| candidate.to_owned()).collect()
}

/// Returns the most similar name if at most every third letter differs.
pub(crate) fn nearest_name<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    nearest(name, known).filter(|&(distance, _)| 3 * distance <= name.len()).map(|(_, candidate)| candidate)
}

/// Returns the most similar name and its edit distance.
fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<(usize, &'a str)> {
    known.map(|candidate| (edit_distance(name, candidate), candidate)).min()
}

/// Returns `true` if `name` is likely to be a misspelling of a name at this edit distance.
fn is_typo(distance: usize, name: &str) -> bool {
    distance <= 1 + name.len() / 3
}

/// Computes the Levenshtein distance.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::{edit_distance, near_names, similar_and_known};

    #[test]
    fn edit_distance_counts_insertions_deletions_and_replacements() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("same", "same"), 0);
    }

    #[test]
    fn a_dissimilar_name_is_not_suggested_and_a_long_list_is_truncated() {
        let known: Vec<String> = (0..50).map(|index| format!("element_{index}")).collect();
        let text = similar_and_known("zzz", &known);
        assert!(!text.contains("did you mean"), "{text}");
        assert!(text.contains("and 10 more"), "{text}");
    }

    #[test]
    fn near_names_are_typos_and_substrings_sorted_by_similarity() {
        let known = ["qpos", "qvel", "xpos", "map.znear", "nstack", "maxuse_stack"];
        let near = |name| near_names(name, known.into_iter());
        assert_eq!(near("qpso"), ["qpos"]);
        assert_eq!(near("znear"), ["map.znear"]);
        assert_eq!(near("stack"), ["nstack", "maxuse_stack"]);
        assert_eq!(near("something else"), [""; 0]);
    }
}
