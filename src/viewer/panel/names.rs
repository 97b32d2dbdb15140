//! Names of the elements of a list, without what all of them have in common, and the filter of the
//! list.

use std::ops::Range;

use egui::Ui;

use super::layout;

/// A list with fewer elements has no filter.
const MIN_FILTERED: usize = 6;

/// Characters between the words of a name.
const SEPARATORS: [char; 6] = ['_', '-', '/', '.', ':', ' '];

/// Name of an element.
struct Name {
    full: String,
    /// Part of the name that differs from the other names.
    short: Range<usize>,
    /// The name contains the text of the filter.
    is_shown: bool,
}

/// Names of the elements of a list, and the text that the shown names contain, in upper or lower
/// case.
#[derive(Default)]
pub(super) struct NameList {
    /// Generation of the model of the names.
    generation: Option<u64>,
    names: Vec<Name>,
    filter: String,
}

impl NameList {
    /// Replaces the names if the model has been replaced.
    pub fn update(&mut self, generation: u64, names: impl FnOnce() -> Vec<String>) {
        if self.generation == Some(generation) {
            return;
        }
        self.generation = Some(generation);
        let names = names();
        let [start, end] = common(&names);
        self.names =
            names.into_iter().map(|full| Name { short: start..full.len() - end, is_shown: true, full }).collect();
        if self.names.len() < MIN_FILTERED {
            self.filter.clear();
        }
        self.apply_filter();
    }

    /// Shows the filter of a long list.
    pub fn show_filter(&mut self, ui: &mut Ui) {
        if self.names.len() >= MIN_FILTERED {
            let width = ui.available_width();
            if layout::text_field(ui, &mut self.filter, "filter", width).changed() {
                self.apply_filter();
            }
        }
    }

    /// Returns the short and the full name of an element. `None` if the filter hides it.
    pub fn get(&self, index: usize) -> Option<[&str; 2]> {
        let name = self.names.get(index).filter(|name| name.is_shown)?;
        Some([&name.full[name.short.clone()], &name.full])
    }

    fn apply_filter(&mut self) {
        let wanted = self.filter.to_lowercase();
        for name in &mut self.names {
            name.is_shown = wanted.is_empty() || name.full.to_lowercase().contains(&wanted);
        }
    }
}

/// Returns the lengths of the beginning and of the end that all names have in common, each with a
/// separator at the inner side. Zero for fewer than two names, and if nothing would be left of a
/// name.
pub(super) fn common(names: &[impl AsRef<str>]) -> [usize; 2] {
    let mut names = names.iter().map(AsRef::as_ref);
    let Some(first) = names.next().filter(|_| names.len() > 0) else { return [0; 2] };
    let mut start = first;
    for name in names.clone() {
        let same = start.chars().zip(name.chars()).take_while(|(one, other)| one == other);
        start = &start[..same.map(|(one, _)| one.len_utf8()).sum()];
    }
    let start = start.rfind(SEPARATORS).map_or(0, |separator| separator + 1);
    let mut end = &first[start..];
    for name in names.clone() {
        let same = end.chars().rev().zip(name[start..].chars().rev()).take_while(|(one, other)| one == other);
        end = &end[end.len() - same.map(|(one, _)| one.len_utf8()).sum::<usize>()..];
    }
    let end = end.find(SEPARATORS).map_or(0, |separator| end.len() - separator);
    if names.chain([first]).all(|name| name.len() > start + end) { [start, end] } else { [0; 2] }
}

#[cfg(test)]
mod tests {
    use super::NameList;

    fn shown(names: &[&str], filter: &str) -> Vec<String> {
        let mut list = NameList::default();
        list.update(0, || names.iter().map(|&name| name.to_owned()).collect());
        list.filter = filter.to_owned();
        list.apply_filter();
        (0..names.len()).filter_map(|index| list.get(index)).map(|[short, _]| short.to_owned()).collect()
    }

    #[test]
    fn names_are_shown_without_the_words_that_all_have_in_common() {
        for (names, expected) in [
            (&["motor_left_hip_name", "motor_right_knee_name"][..], &["left_hip", "right_knee"][..]),
            (&["robot/hip_x", "robot/hip_y"], &["x", "y"]),
            (&["left_hip_joint", "left_knee_joint", "right_hip_joint"], &["left_hip", "left_knee", "right_hip"]),
            // Words are not split.
            (&["motor1", "motor12"], &["motor1", "motor12"]),
            (&["hipjoint", "kneejoint"], &["hipjoint", "kneejoint"]),
            // Nothing is left of a name.
            (&["arm_", "arm_x"], &["arm_", "arm_x"]),
            (&["a_b", "a_x_b"], &["b", "x_b"]),
            (&["größe_ä_maß", "größe_ö_maß"], &["ä", "ö"]),
            (&["left_hip"], &["left_hip"]),
            (&[], &[]),
        ] {
            assert_eq!(shown(names, ""), expected);
        }
    }

    #[test]
    fn filter_compares_full_names_in_any_case() {
        let names = ["motor_left_hip", "motor_left_knee", "motor_Right_hip"];
        assert_eq!(shown(&names, "HIP"), ["left_hip", "Right_hip"]);
        assert_eq!(shown(&names, "motor_l"), ["left_hip", "left_knee"]);
        assert!(shown(&names, "ankle").is_empty());
    }
}
