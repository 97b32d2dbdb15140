//! Options of a viewer.

use std::path::{Path, PathBuf};

use super::input::Key;
use crate::error::{Error, InvalidKind};
use crate::macros::with_methods;
use crate::record::RecorderOptions;
use crate::render::Lighting;

/// Colours of the panels of a viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Theme {
    /// Light text on a dark background.
    #[default]
    Dark,
    /// Dark text on a light background.
    Light,
}

/// Options of a viewer.
///
/// ```
/// use mujoco_safe::viewer::{Theme, ViewerOptions};
///
/// let options = ViewerOptions::default().with_title("a robot").with_size([1280, 720]);
/// // For a projector.
/// let options = options.with_theme(Theme::Light).with_scale(1.5);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ViewerOptions {
    /// Title of the window, without NUL.
    pub title: String,
    /// Width and height of the window, in pixels, from 1 to 65,535. `None` for the size in the
    /// [layout](Self::layout), else 85 % of the monitor's width and height.
    pub size: Option<[usize; 2]>,
    /// Vertical synchronisation, which prevents tearing.
    pub vsync: bool,
    /// The side panels are open at the start, as in `simulate`, if the window has place for both
    /// beside the scene: 800 pixels at a scale of 1. `None` for the [layout](Self::layout), else
    /// `true`.
    pub panels: Option<bool>,
    /// Colours of the panels. `None` for the [layout](Self::layout), else dark.
    pub theme: Option<Theme>,
    /// Size of the panels and their text relative to the scale of the display. Values outside of
    /// 0.25 to 4 are limited to this range. `None` for the [layout](Self::layout), else 1.
    pub scale: Option<f64>,
    /// Text file in which the window remembers its layout for the next window: open panels and
    /// sections, widths, theme, scale and size, and recent model files. The default is
    /// `mujoco-safe/viewer.txt` in the user's configuration directory (`~/.config` on Linux).
    /// `None` to remember nothing. If the options set the size, the panels, the theme or the scale,
    /// the file is neither read nor written.
    pub layout: Option<PathBuf>,
    /// Frequency of the lighting computation of the scene, as in
    /// [`RendererOptions`](crate::render::RendererOptions::lighting).
    pub lighting: Lighting,
    /// File of the model, which Ctrl+L reloads.
    pub file: Option<PathBuf>,
    /// Shows changes of the model's file, and of the files that it includes or names, within a
    /// second: the simulation [adopts](crate::Data::adopt) the new model, and the camera stays. If
    /// a file has an error, the window shows it, and the previous model runs on. Changes of meshes
    /// with `package://` URIs and of more than 1000 files are not noticed. By default `true`.
    pub watch: bool,
    /// Path of the screenshots of Ctrl+P. If the file exists, it is not overwritten: a number is
    /// appended to the name.
    pub screenshots: PathBuf,
    /// Path of the recordings of Ctrl+V. If the file exists, it is not overwritten: a number is
    /// appended to the name. The extension selects the format: see
    /// [`Recorder::create`](crate::record::Recorder::create). `None` for `recording.mp4`, or
    /// `recording.gif` without `ffmpeg`.
    pub recordings: Option<PathBuf>,
    /// Directory of the model and of the listings that the panel "Simulation" saves: `model.xml`,
    /// `model.mjb`, `model.txt` and `data.txt`. An existing file is not overwritten: a number is
    /// appended to the name. By default the working directory.
    pub directory: PathBuf,
    /// Options of the recordings.
    pub recording: RecorderOptions,
    /// Keys that the program receives with [`ViewerHandle::keys`](super::ViewerHandle::keys)
    /// although the viewer has bindings for them, for example to control a robot. The bindings with
    /// Ctrl remain.
    pub released_keys: Vec<Key>,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            title: "MuJoCo".to_owned(),
            size: None,
            vsync: true,
            panels: None,
            theme: None,
            scale: None,
            layout: layout_file(),
            lighting: Lighting::default(),
            file: None,
            watch: true,
            screenshots: "screenshot.png".into(),
            recordings: None,
            directory: ".".into(),
            recording: RecorderOptions::default(),
            released_keys: Vec::new(),
        }
    }
}

impl ViewerOptions {
    /// Largest width and height of a window in the protocol of X.
    const MAX_SIZE: usize = u16::MAX as usize;

    /// Returns the file of the layout, unless the program sets the layout itself.
    pub(super) fn layout_file(&self) -> Option<&Path> {
        let is_set = self.size.is_some() || self.panels.is_some() || self.theme.is_some() || self.scale.is_some();
        self.layout.as_deref().filter(|_| !is_set)
    }

    /// Rejects values that the windowing system cannot represent.
    pub(super) fn check(&self) -> Result<(), Error> {
        if self.title.contains('\0') {
            return Err(Error::invalid(
                InvalidKind::Text,
                "the title of the window",
                format!("{:?}", self.title),
                "a text without NUL",
            ));
        }
        if let Some([width, height]) = self.size
            && ![width, height].iter().all(|pixels| (1..=Self::MAX_SIZE).contains(pixels))
        {
            let expected = format!("a width and a height from 1 to {} pixels", Self::MAX_SIZE);
            return Err(Error::out_of_range("the size of the window", format!("{width} × {height}"), expected));
        }
        Ok(())
    }
}

/// Returns the file of the layout in the user's configuration directory, if the system has one.
fn layout_file() -> Option<PathBuf> {
    let variable = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || variable("HOME");
    let directory = if cfg!(windows) {
        variable("APPDATA")
    } else if cfg!(target_os = "macos") {
        home().map(|home| home.join("Library/Application Support"))
    } else {
        variable("XDG_CONFIG_HOME").or_else(|| home().map(|home| home.join(".config")))
    };
    Some(directory?.join("mujoco-safe/viewer.txt"))
}

with_methods!(ViewerOptions {
    with_title(title: impl Into<String>) = title.into(),
    with_size(size: [usize; 2]) = Some(size),
    with_vsync(vsync: bool),
    with_panels(panels: bool) = Some(panels),
    with_theme(theme: Theme) = Some(theme),
    with_scale(scale: f64) = Some(scale),
    with_layout(layout: impl Into<Option<PathBuf>>) = layout.into(),
    with_lighting(lighting: Lighting),
    with_file(file: impl Into<PathBuf>) = Some(file.into()),
    with_watch(watch: bool),
    with_screenshots(screenshots: impl Into<PathBuf>) = screenshots.into(),
    with_recordings(recordings: impl Into<PathBuf>) = Some(recordings.into()),
    with_directory(directory: impl Into<PathBuf>) = directory.into(),
    with_recording(recording: RecorderOptions),
    with_released_keys(released_keys: impl IntoIterator<Item = Key>) = released_keys.into_iter().collect(),
});
