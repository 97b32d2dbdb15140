//! Layout of a window that the next window has too: open panels and sections, widths, theme, scale
//! and size, in a small text file of the user. It also has the recent model files.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::options::Theme;
use super::view::View;
use crate::error::Result;
use crate::file;

/// Largest size of the file that is read, bytes.
const MAX_BYTES: usize = 64 << 10;

/// Layout of a window. A part that is `None` has its initial value.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Layout {
    pub theme: Option<Theme>,
    pub scale: Option<f64>,
    /// Width and height of the window, pixels.
    pub size: Option<[usize; 2]>,
    /// Open panels: left, right, details of the info panel, profile, sensors, instruments.
    pub open: [Option<bool>; 6],
    /// Widths of the left and right side panels, points.
    pub widths: Option<[f32; 2]>,
    /// Sections that the user has opened or closed, by title.
    pub sections: BTreeMap<String, bool>,
    /// Recent model files, the newest first.
    pub recent: Vec<PathBuf>,
}

/// Names of the panels in the file.
const PANELS: [&str; 6] = ["left", "right", "details", "profile", "sensors", "instruments"];

impl Layout {
    /// Reads a file. A file that does not exist or has other contents has no layout.
    pub fn read(path: &Path) -> Self {
        let bytes = file::read_regular(path).ok().filter(|bytes| bytes.len() <= MAX_BYTES);
        bytes.and_then(|bytes| String::from_utf8(bytes).ok()).map_or_else(Self::default, |text| Self::parse(&text))
    }

    /// Writes a file, and creates its folder.
    ///
    /// # Errors
    ///
    /// If the folder or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        if let Some(folder) = path.parent() {
            // The replacement reports the error.
            let _ = std::fs::create_dir_all(folder);
        }
        file::replace(path, |out| out.write_all(self.to_string().as_bytes()))
    }

    /// Returns the layout of a view.
    pub fn with_view(mut self, view: &View) -> Self {
        let open = [view.left_panel, view.right_panel, view.details, view.profile, view.sensors, view.instruments];
        (self.open, self.widths) = (open.map(Some), Some(view.side_widths));
        self
    }

    /// Applies the layout to a view.
    pub fn apply(&self, view: &mut View) {
        let parts = [
            &mut view.left_panel,
            &mut view.right_panel,
            &mut view.details,
            &mut view.profile,
            &mut view.sensors,
            &mut view.instruments,
        ];
        for (part, open) in parts.into_iter().zip(self.open) {
            *part = open.unwrap_or(*part);
        }
        view.side_widths = self.widths.unwrap_or(view.side_widths);
    }

    /// Returns this layout with what differs between the start and the end of a window.
    pub fn changed(&self, start: &Self, end: Self) -> Self {
        fn part<T: Copy + PartialEq>(before: Option<T>, start: Option<T>, end: Option<T>) -> Option<T> {
            if end.is_some() && end != start { end } else { before }
        }
        let open = std::array::from_fn(|panel| part(self.open[panel], start.open[panel], end.open[panel]));
        Self {
            theme: part(self.theme, start.theme, end.theme),
            scale: part(self.scale, start.scale, end.scale),
            size: part(self.size, start.size, end.size),
            open,
            widths: part(self.widths, start.widths, end.widths),
            sections: end.sections,
            recent: end.recent,
        }
    }

    /// Parses the text of a file. Ignores lines that it does not understand.
    fn parse(text: &str) -> Self {
        let mut layout = Self::default();
        for line in text.lines() {
            let Some((key, value)) = line.split_once('=').map(|(key, value)| (key.trim(), value.trim())) else {
                continue;
            };
            let open = match value {
                "open" => Some(true),
                "closed" => Some(false),
                _ => None,
            };
            match key {
                "theme" => {
                    layout.theme = match value {
                        "dark" => Some(Theme::Dark),
                        "light" => Some(Theme::Light),
                        _ => None,
                    }
                }
                "scale" => layout.scale = value.parse().ok().filter(|scale: &f64| scale.is_finite()),
                "size" => {
                    layout.size = pair(value).filter(|size| size.iter().all(|length| (1..=1 << 14).contains(length)));
                }
                "widths" => {
                    layout.widths =
                        pair(value).filter(|widths: &[f32; 2]| widths.iter().all(|width| width.is_finite()));
                }
                "recent" => layout.recent.push(value.into()),
                _ => match (PANELS.iter().position(|panel| *panel == key), key.strip_prefix("section ")) {
                    (Some(panel), _) => layout.open[panel] = open,
                    (None, Some(section)) => layout.sections.extend(open.map(|open| (section.to_owned(), open))),
                    (None, None) => {}
                },
            }
        }
        layout
    }
}

/// Parses two numbers.
fn pair<N: FromStr>(text: &str) -> Option<[N; 2]> {
    let (one, other) = text.split_once(' ')?;
    Some([one.parse().ok()?, other.trim().parse().ok()?])
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text =
            String::from("# Layout of the viewer of mujoco-safe. It writes this file when a window closes.\n");
        let mut line =
            |key: &str, value: Option<String>| value.map_or(Ok(()), |value| writeln!(text, "{key} = {value}"));
        let state = |open: bool| if open { "open".to_owned() } else { "closed".to_owned() };
        line(
            "theme",
            self.theme.map(|theme| if theme == Theme::Dark { "dark".to_owned() } else { "light".to_owned() }),
        )?;
        line("scale", self.scale.map(|scale| scale.to_string()))?;
        line("size", self.size.map(|[width, height]| format!("{width} {height}")))?;
        line("widths", self.widths.map(|[left, right]| format!("{left} {right}")))?;
        for (panel, open) in PANELS.into_iter().zip(self.open) {
            line(panel, open.map(state))?;
        }
        for (section, open) in &self.sections {
            line(&format!("section {section}"), Some(state(*open)))?;
        }
        // A path that is no line of text is not remembered.
        let texts = self.recent.iter().filter_map(|path| path.to_str());
        for path in texts.filter(|path| path.trim() == *path && !path.contains(['\n', '\r'])) {
            line("recent", Some(path.to_owned()))?;
        }
        f.write_str(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::Layout;
    use crate::sample;
    use crate::viewer::Theme;
    use crate::viewer::view::View;

    #[test]
    fn layout_is_the_same_after_writing_and_reading() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/viewer.txt");
        assert_eq!(Layout::read(&path), Layout::default(), "the file does not exist");
        let mut view = View::new(&sample::cartpole());
        (view.left_panel, view.sensors, view.instruments) = (true, true, false);
        view.side_widths = [301.5, 240.0];
        let layout = Layout {
            theme: Some(Theme::Light),
            scale: Some(1.1 * 1.1),
            size: Some([1280, 720]),
            sections: [("Physics".to_owned(), true), ("Equality constraints".to_owned(), false)].into(),
            recent: vec!["/models/a = b.xml".into(), "/models/arm.xml".into()],
            ..Layout::default()
        }
        .with_view(&view);
        layout.write(&path).unwrap();
        assert_eq!(Layout::read(&path), layout);
        let other = Layout { recent: vec!["/a\nscale = 3".into(), "/b ".into()], ..Layout::default() };
        assert_eq!(Layout::parse(&other.to_string()), Layout::default());
        let mut other = View::new(&sample::cartpole());
        layout.apply(&mut other);
        assert_eq!(other, view);
    }

    #[test]
    fn only_changes_of_the_user_are_remembered() {
        let layout = |left: bool, size: [usize; 2]| Layout {
            size: Some(size),
            open: [Some(left), Some(false), None, None, None, None],
            ..Layout::default()
        };
        let before = Layout { theme: Some(Theme::Light), ..Layout::default() };
        let start = layout(false, [800, 600]);
        // A narrow window starts without side panels.
        assert_eq!(before.changed(&start, start.clone()), before);
        let after = before.changed(&start, layout(true, [800, 600]));
        assert_eq!((after.theme, after.size, after.open[..2].to_vec()), (before.theme, None, vec![Some(true), None]));
        // A full screen has no size.
        let end = Layout { size: None, ..layout(false, [0; 2]) };
        assert_eq!(before.changed(&start, end).size, None);
        assert_eq!(before.changed(&start, layout(false, [700, 500])).size, Some([700, 500]));
    }

    #[test]
    fn file_with_other_contents_is_ignored() {
        let text =
            "theme = purple\nscale = NaN\nsize = 0 -3\nwidths = inf 3\nleft = ajar\n\u{0}=\n= =\nsection = x\nsize";
        assert_eq!(Layout::parse(text), Layout::default());
        assert_eq!(Layout::parse("new = 3\nright = closed\n").open[1], Some(false));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("viewer.txt");
        std::fs::write(&path, [0xff; 10]).unwrap();
        assert_eq!(Layout::read(&path), Layout::default());
        assert_eq!(Layout::read(folder.path()), Layout::default());
    }
}
