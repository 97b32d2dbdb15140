//! Ways to show a window.

use std::path::PathBuf;
use std::thread;

use super::error::ViewerError;
use super::handle::Handle;
use super::simulation::Simulation;
use super::window::Asked;
use super::worker::Worker;
use crate::controller::Controller;
use crate::data::Data;
use crate::record::RecorderOptions;
use crate::trajectory::Trajectory;

/// How a viewer is set up.
///
/// ```
/// use mujoco_safe::viewer::ViewerOptions;
///
/// let options = ViewerOptions { title: "a robot".into(), size: Some([1280, 720]), ..Default::default() };
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ViewerOptions {
    /// What stands above the window.
    pub title: String,
    /// Width and height of the window, pixels. `None` for two thirds of the monitor.
    pub size: Option<[u32; 2]>,
    /// Whether frames wait for the screen, so that no picture is torn.
    pub vsync: bool,
    /// The file of the model, for Ctrl+L to load it anew.
    pub file: Option<PathBuf>,
    /// Where Ctrl+P saves a picture. A number is put behind the name where there is such a file already.
    pub screenshots: PathBuf,
    /// Where Ctrl+V records to; a number is put behind the name where there is such a file already. The extension says what it
    /// becomes: see [`Recorder::create`](crate::record::Recorder::create). `None` for `recording.mp4`, or `recording.gif` where
    /// there is no `ffmpeg`.
    pub recordings: Option<PathBuf>,
    /// How it is recorded.
    pub recording: RecorderOptions,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            title: "MuJoCo".to_owned(),
            size: None,
            vsync: true,
            file: None,
            screenshots: "screenshot.png".into(),
            recordings: None,
            recording: RecorderOptions::default(),
        }
    }
}

/// A window in which a simulation runs by itself: with a controller, played from recorded trajectories, or with nothing but its
/// dynamics.
///
/// ```no_run
/// use mujoco_safe::viewer::Viewer;
/// use mujoco_safe::{Data, sample};
///
/// let data = Data::new(sample::humanoid())?;
/// // Waits until the window is closed.
/// let data = Viewer::new().title("a humanoid that falls").run(data)?;
/// println!("it was looked at until {} s", data.time());
/// # Ok::<(), mujoco_safe::viewer::ViewerError>(())
/// ```
#[derive(Default)]
#[must_use]
pub struct Viewer {
    options: ViewerOptions,
    controller: Option<Box<dyn Controller + Send>>,
    trajectories: Vec<Trajectory>,
}

impl std::fmt::Debug for Viewer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Viewer")
            .field("options", &self.options)
            .field("controller", &self.controller.is_some())
            .field("trajectories", &self.trajectories.len())
            .finish()
    }
}

impl Viewer {
    /// One without controller and trajectories.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets all options.
    pub fn options(mut self, options: ViewerOptions) -> Self {
        self.options = options;
        self
    }

    /// Sets what stands above the window.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.options.title = title.into();
        self
    }

    /// Sets width and height of the window, in pixels.
    pub fn size(mut self, size: [u32; 2]) -> Self {
        self.options.size = Some(size);
        self
    }

    /// Names the file of the model, for Ctrl+L to load it anew.
    pub fn file(mut self, file: impl Into<PathBuf>) -> Self {
        self.options.file = Some(file.into());
        self
    }

    /// Sets what decides on the controls. It begins in this mode then.
    ///
    /// An error of the controller, or a panic in it, pauses the simulation, and the window says what happened. While it decides,
    /// the window is drawn, but waits for it to close.
    ///
    /// A reset, or a step back, changes the simulation and not what the controller itself remembers: one that has a memory can
    /// tell by [`Data::time`], which goes back too.
    pub fn controller(mut self, controller: impl Controller + Send + 'static) -> Self {
        self.controller = Some(Box::new(controller));
        self
    }

    /// Sets what has been recorded. Without a controller it begins in this mode. Their lengths may differ.
    pub fn trajectories(mut self, trajectories: impl IntoIterator<Item = Trajectory>) -> Self {
        self.trajectories = trajectories.into_iter().collect();
        self
    }

    /// Shows the window until it is closed. The simulation is paused at first, in the state that it has; that is also the one that
    /// a reset returns to. Returned is how it stands at the end.
    ///
    /// The windowing system gives a process one event loop, which stays with the thread that calls this first; on macOS that has
    /// to be the main thread.
    ///
    /// # Errors
    ///
    /// [`ViewerError::NoDisplay`], [`ViewerError::Render`], [`ViewerError::OtherThread`] and the others if there can be no window;
    /// [`ViewerError::Engine`] for a trajectory that is empty or of another model.
    pub fn run(self, data: Data) -> Result<Data, ViewerError> {
        let (asked, back) = Asked::here(self.options)?;
        let simulation = Simulation::new(data, self.controller, self.trajectories, back)?;
        let worker = Worker::start(simulation).map_err(ViewerError::Thread)?;
        let (place, opened) = asked.split();
        // A window elsewhere is waited for with its physics.
        place.map_or(Ok(()), |place| place.show())?;
        opened.wait()?;
        worker.join().ok_or_else(|| ViewerError::Window("the thread of the physics has panicked".to_owned()))
    }
}

/// Shows a window for a program that steps its simulation itself. The program runs on another thread, and this one shows the window:
/// the form that works on every platform. Where the program ends, so does the window.
///
/// A window that is closed does not end the program: [`Handle::is_running`] tells it.
///
/// # Errors
///
/// Those of the program, and as for [`Viewer::run`]: then the program is not begun.
///
/// ```no_run
/// use mujoco_safe::viewer::{self, ViewerError, ViewerOptions};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// viewer::run(ViewerOptions::default(), |handle| -> Result<(), ViewerError> {
///     while handle.is_running() {
///         data.step()?;
///         handle.sync(&mut data)?;
///     }
///     Ok(())
/// })?;
/// # Ok::<(), ViewerError>(())
/// ```
pub fn run<R, E>(options: ViewerOptions, program: impl FnOnce(&mut Handle) -> Result<R, E> + Send) -> Result<R, E>
where
    R: Send,
    E: From<ViewerError> + Send,
{
    let (asked, back) = Asked::here(options)?;
    let (place, opened) = asked.split();
    let program = move || {
        opened.wait()?;
        program(&mut Handle::new(back))
    };
    let Some(place) = place else { return program() };
    thread::scope(|scope| {
        let program = thread::Builder::new()
            .name("program".to_owned())
            .spawn_scoped(scope, program)
            .map_err(ViewerError::Thread)?;
        let shown = place.show();
        let outcome = program.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        shown?;
        outcome
    })
}

/// Opens a window for a program that steps its simulation itself, and returns at once. Any number of windows can be open, and any
/// thread can ask for them: the first that does starts a thread for all of them, which lives as long as the program. Not on
/// macOS, where windows belong to the main thread: [`run`] works there too.
///
/// # Errors
///
/// As for [`Viewer::run`].
///
/// ```no_run
/// use mujoco_safe::viewer::{self, ViewerError, ViewerOptions};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// let mut handle = viewer::launch(ViewerOptions::default())?;
/// while handle.is_running() && data.time() < 10.0 {
///     data.step()?;
///     handle.sync(&mut data)?;
/// }
/// // The window closes with the handle.
/// # Ok::<(), ViewerError>(())
/// ```
#[cfg(not(target_os = "macos"))]
pub fn launch(options: ViewerOptions) -> Result<Handle, ViewerError> {
    let (asked, back) = Asked::elsewhere(options)?;
    let (_, opened) = asked.split();
    opened.wait()?;
    Ok(Handle::new(back))
}
