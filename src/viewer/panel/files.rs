//! Panel that opens a model file: a path with completion, the files in its directory, and recent
//! files.

use std::fs;
use std::path::{MAIN_SEPARATOR, Path, PathBuf, is_separator};

use egui::text::{CCursor, CCursorRange};
use egui::{Context, Key, RichText, ScrollArea, TextEdit, Ui};

use super::{PanelContext, layout};
use crate::viewer::input::Action;

/// Extensions of model files.
const EXTENSIONS: [&str; 3] = ["xml", "urdf", "mjb"];
/// Maximum number of recent files.
const MAX_RECENT: usize = 8;
/// Width of the panel and height of the list of files, points.
const SIZE: [f32; 2] = [420.0, 200.0];

/// Panel with a text field and the files whose names start with its text.
#[derive(Default)]
pub(super) struct FilesPanel {
    text: String,
    /// The panel was shown in the last pass.
    shown: bool,
    listing: Listing,
    /// Loaded files, the newest first.
    recent: Vec<PathBuf>,
}

/// Directories and model files in a directory.
#[derive(Default)]
struct Listing {
    /// Directory as typed.
    directory: String,
    /// Names of the entries, those of directories with a separator at the end.
    names: Vec<String>,
}

impl FilesPanel {
    /// Creates the panel with the recent files of an earlier window.
    pub fn new(mut recent: Vec<PathBuf>) -> Self {
        recent.truncate(MAX_RECENT);
        Self { recent, ..Self::default() }
    }

    pub fn recent(&self) -> &[PathBuf] {
        &self.recent
    }

    /// Adds a file to the recent files.
    pub fn loaded(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path);
        self.recent.truncate(MAX_RECENT);
    }

    pub fn show(&mut self, context: &Context, cx: &mut PanelContext<'_>) {
        let opened = cx.view.files && !self.shown;
        self.shown = cx.view.files;
        if opened {
            let directory = self.recent.first().and_then(|file| file.parent()).map(Path::to_owned);
            let directory = directory.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
            self.list(directory.display().to_string());
        }
        if self.shown {
            layout::center(context, "files", |ui| self.show_open(ui, cx, opened));
        }
    }

    fn show_open(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>, opened: bool) {
        ui.set_width(SIZE[0]);
        ui.horizontal(|ui| {
            ui.heading("Open a model");
            ui.label(RichText::new("Tab completes, Enter opens, Esc closes").small().weak());
        });
        let field = TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY).lock_focus(true);
        let field = ui.add(field.hint_text("path of an XML, URDF or MJB file"));
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        let (had_focus, lost_focus) = (field.has_focus(), field.lost_focus());
        let mut chosen = None;
        if opened {
            field.request_focus();
            move_cursor_to_end(ui, field.id, &self.text);
        } else if lost_focus && pressed(Key::Escape) {
            cx.view.files = false;
        } else if had_focus && pressed(Key::Tab) {
            self.text = completed(&self.text, &self.matching());
            move_cursor_to_end(ui, field.id, &self.text);
        } else if lost_focus && pressed(Key::Enter) {
            let matching = self.matching();
            let only = matching.first().filter(|_| matching.len() == 1);
            chosen = Some(only.map_or_else(|| self.text.clone(), |name| self.joined(name)));
        }
        if self.listing.directory != split(&self.text).0 {
            self.listing = Listing::of(&self.text);
        }
        ScrollArea::vertical().id_salt("files").max_height(SIZE[1]).auto_shrink([false, true]).show(ui, |ui| {
            for name in self.matching() {
                if ui.selectable_label(false, name).clicked() {
                    chosen = Some(self.joined(name));
                }
            }
        });
        if !self.recent.is_empty() {
            ui.separator();
            ui.label(RichText::new("recent files").small().weak());
        }
        for path in &self.recent {
            let text = path.display().to_string();
            if ui.selectable_label(false, &*layout::fit(ui, &text, SIZE[0])).clicked() {
                chosen = Some(text);
            }
        }
        if let Some(path) = chosen {
            self.choose(ui, cx, path, field.id);
        }
    }

    /// Lists a directory.
    fn list(&mut self, directory: String) {
        self.text = directory;
        if !self.text.ends_with(is_separator) {
            self.text.push(MAIN_SEPARATOR);
        }
        self.listing = Listing::of(&self.text);
    }

    /// Opens a file, or lists a directory.
    fn choose(&mut self, ui: &Ui, cx: &mut PanelContext<'_>, path: String, field: egui::Id) {
        let file = expanded(&path);
        if file.is_dir() {
            self.list(path);
            ui.memory_mut(|memory| memory.request_focus(field));
            move_cursor_to_end(ui, field, &self.text);
        } else {
            cx.view.files = false;
            cx.actions.push(Action::Open(file));
        }
    }

    /// Returns the names of the entries that start with the typed name.
    fn matching(&self) -> Vec<&str> {
        let wanted = split(&self.text).1.to_lowercase();
        let is_wanted = |name: &&String| {
            let is_hidden = name.starts_with('.') && !wanted.starts_with('.');
            !is_hidden && name.to_lowercase().starts_with(&wanted)
        };
        self.listing.names.iter().filter(is_wanted).map(String::as_str).collect()
    }

    /// Returns the path of an entry as the user would type it.
    fn joined(&self, name: &str) -> String {
        format!("{}{name}", split(&self.text).0)
    }
}

impl Listing {
    /// Lists the directory of a typed path: its directories, then its model files, by name.
    fn of(text: &str) -> Self {
        let directory = split(text).0.to_owned();
        let place = if directory.is_empty() { PathBuf::from(".") } else { expanded(&directory) };
        let entries = fs::read_dir(place).into_iter().flatten().flatten();
        let mut names: Vec<_> = entries.filter_map(|entry| name_of(&entry.path())).collect();
        names.sort_by_key(|name| (!name.ends_with(is_separator), name.to_lowercase()));
        Self { directory, names }
    }
}

/// Returns the name of a directory or of a model file.
fn name_of(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.to_owned();
    if path.is_dir() {
        return Some(format!("{name}{MAIN_SEPARATOR}"));
    }
    let extension = path.extension()?.to_str()?;
    EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(extension)).then_some(name)
}

/// Splits a typed path into the directory, with its separator, and the start of a name.
fn split(text: &str) -> (&str, &str) {
    text.split_at(text.rfind(is_separator).map_or(0, |at| at + 1))
}

/// Replaces `~` at the start of a path by the home directory.
fn expanded(text: &str) -> PathBuf {
    match text.strip_prefix('~').filter(|rest| rest.is_empty() || rest.starts_with(is_separator)) {
        Some(rest) => match std::env::home_dir() {
            Some(home) => home.join(rest.trim_start_matches(is_separator)),
            None => text.into(),
        },
        None => text.into(),
    }
}

/// Extends the start of a name by the letters that all matching names have.
fn completed(text: &str, matching: &[&str]) -> String {
    let Some((first, rest)) = matching.split_first() else { return text.to_owned() };
    let common = |length: usize, other: &&str| {
        let pairs = first.chars().zip(other.chars()).take(length);
        pairs.take_while(|(one, other)| one.to_lowercase().eq(other.to_lowercase())).count()
    };
    let length = rest.iter().fold(first.chars().count(), common);
    let name: String = first.chars().take(length).collect();
    format!("{}{name}", split(text).0)
}

fn move_cursor_to_end(ui: &Ui, field: egui::Id, text: &str) {
    let mut state = egui::text_edit::TextEditState::load(ui.ctx(), field).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::one(CCursor::new(text.chars().count()))));
    state.store(ui.ctx(), field);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_completed_as_far_as_they_agree() {
        assert_eq!(completed("a/hum", &["humanoid.xml", "humanoid_arms.xml"]), "a/humanoid");
        assert_eq!(completed("a/HUM", &["humanoid.xml"]), "a/humanoid.xml");
        assert_eq!(completed("a/", &["humanoid.xml", "arm.xml"]), "a/");
        assert_eq!(completed("a/x", &[]), "a/x");
        assert_eq!(completed("", &["größe1", "größe2"]), "größe");
    }

    #[test]
    fn directories_and_model_files_are_listed() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.xml", "A.MJB", "c.urdf", "mesh.stl", ".hidden.xml"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        fs::create_dir(folder.path().join("parts")).unwrap();
        let text = format!("{}{MAIN_SEPARATOR}", folder.path().display());
        let mut panel = FilesPanel { listing: Listing::of(&text), text, ..FilesPanel::default() };
        let parts = format!("parts{MAIN_SEPARATOR}");
        assert_eq!(panel.matching(), [&parts, "A.MJB", "b.xml", "c.urdf"]);
        panel.text.push('.');
        assert_eq!(panel.matching(), [".hidden.xml"]);
        assert_eq!(Listing::of("no such directory/").names, [""; 0]);
    }

    #[test]
    fn recent_files_are_absolute_and_unique() {
        let mut panel = FilesPanel::default();
        for name in ["a.xml", "b.xml", "a.xml"] {
            panel.loaded(Path::new(name));
        }
        let present = std::env::current_dir().unwrap();
        assert_eq!(panel.recent, [present.join("a.xml"), present.join("b.xml")]);
        (0..20).for_each(|number| panel.loaded(&present.join(number.to_string())));
        assert_eq!(panel.recent.len(), MAX_RECENT);
    }

    #[test]
    fn tilde_is_the_home_directory() {
        let home = std::env::home_dir().unwrap();
        assert_eq!(expanded("~/models"), home.join("models"));
        assert_eq!(expanded("~"), home);
        assert_eq!(expanded("a~/b"), Path::new("a~/b"));
        assert_eq!(expanded("~a/b"), Path::new("~a/b"));
    }
}
