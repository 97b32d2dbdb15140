//! The functions that open a window.

use std::thread;

use super::error::ViewerError;
use super::handle::ViewerHandle;
use super::instruments::{InstrumentedController, Instruments, WithInstruments};
use super::options::ViewerOptions;
use super::simulation::{PhysicsThread, Simulation};
use super::window::WindowRequest;
use crate::controller::Controller;
use crate::data::Data;
use crate::error::Outcome;
use crate::trajectory::Trajectory;

/// Window that steps a simulation itself: with a controller, by playing recorded trajectories, or
/// with passive dynamics.
///
/// ```no_run
/// use mujoco_safe::viewer::{Viewer, ViewerOptions};
/// use mujoco_safe::{Data, sample};
///
/// let data = Data::new(sample::humanoid())?;
/// // Blocks until the window is closed.
/// let data = Viewer::new().with_options(ViewerOptions::default().with_title("falling humanoid")).run(data)?;
/// println!("the simulation ended at {} s", data.time());
/// # Ok::<(), mujoco_safe::viewer::ViewerError>(())
/// ```
#[derive(Default)]
#[must_use]
pub struct Viewer {
    options: ViewerOptions,
    controller: Option<Box<dyn InstrumentedController>>,
    /// Names and trajectories.
    trajectories: Vec<(String, Trajectory)>,
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
    /// Creates a viewer with the default options, without a controller and without trajectories.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the options.
    pub fn with_options(mut self, options: ViewerOptions) -> Self {
        self.options = options;
        self
    }

    /// Sets the controller, which adds the controller mode and makes it the initial mode.
    ///
    /// An error or a panic of the controller pauses the simulation, and the window shows the
    /// message. While the controller computes, the window is still drawn, but can only close after
    /// the controller returns.
    ///
    /// A reset or a step back restores the simulation, not the internal state of the controller. A
    /// stateful controller can detect it by [`Data::time`], which decreases.
    pub fn with_controller(mut self, controller: impl Controller + Send + 'static) -> Self {
        let controller: Box<dyn Controller + Send> = Box::new(controller);
        self.controller = Some(Box::new(controller));
        self
    }

    /// As [`with_controller`](Self::with_controller), with a closure that declares the
    /// [`Instruments`] of the controller: plotted values, parameters with sliders, and geoms.
    /// [`Instruments`] has an example. The closure returns nothing or a [`Result`](crate::Result).
    ///
    /// In the controller mode, the viewer calls the closure in the thread of the controller: after
    /// the controller in each step, so that the plots show extremes between two images; before each
    /// image of the simulation; and immediately when the user moves a slider, so that the next step
    /// uses the new value. After a step, quantities of the data that depend on the state, such as
    /// poses, are those before the step. Geoms are only added for an image: otherwise
    /// [`Instruments::path`] does not compute its points.
    ///
    /// An error or a panic of the closure pauses the simulation, and the window shows the message.
    pub fn with_instrumented_controller<C, O>(
        mut self,
        controller: C,
        declare: impl FnMut(&mut C, &Data, &mut Instruments) -> O + Send + 'static,
    ) -> Self
    where
        C: Controller + Send + 'static,
        O: Outcome<Value = ()> + 'static,
    {
        self.controller = Some(Box::new(WithInstruments { controller, declare }));
        self
    }

    /// Sets recorded trajectories, which add the trajectory mode. It is the initial mode if there
    /// is no controller. The lengths may differ.
    pub fn with_trajectories(self, trajectories: impl IntoIterator<Item = Trajectory>) -> Self {
        let numbered = trajectories.into_iter().enumerate();
        self.with_named_trajectories(numbered.map(|(index, trajectory)| ((index + 1).to_string(), trajectory)))
    }

    /// As [`with_trajectories`](Self::with_trajectories), with names, which the window shows. The
    /// default names are numbers from 1.
    ///
    /// ```no_run
    /// use mujoco_safe::viewer::Viewer;
    /// # use mujoco_safe::{Data, Trajectory, sample};
    /// # let data = Data::new(sample::humanoid())?;
    /// # let [free, controlled] = [data.model(); 2].map(|model| Trajectory::new(model));
    ///
    /// Viewer::new().with_named_trajectories([("free", free), ("LQR", controlled)]).run(data)?;
    /// # Ok::<(), mujoco_safe::viewer::ViewerError>(())
    /// ```
    pub fn with_named_trajectories<N: Into<String>>(
        mut self,
        trajectories: impl IntoIterator<Item = (N, Trajectory)>,
    ) -> Self {
        self.trajectories = trajectories.into_iter().map(|(name, trajectory)| (name.into(), trajectory)).collect();
        self
    }

    /// Shows the window until the user closes it: for a program that closes it, see [`run`] and
    /// [`launch`]. The simulation starts paused in its current state,
    /// which is also the state that a reset restores. Returns the data in its final state.
    ///
    /// The windowing system allows one event loop per process, which stays with the thread that
    /// calls this function first. On macOS it must be the main thread.
    ///
    /// # Errors
    ///
    /// [`ViewerError::NoDisplay`], [`ViewerError::Render`], [`ViewerError::OtherThread`] and others
    /// if the window cannot be shown; [`ViewerError::Window`] if the window ends early, for example
    /// because the X server has ended, after which a running recording is complete and this process
    /// can show no more windows; [`ViewerError::Other`] for a title or a size that no window can
    /// have, and for a trajectory that is empty or of another model.
    pub fn run(self, data: Data) -> Result<Data, ViewerError> {
        let (request, link) = WindowRequest::on_this_thread(self.options)?;
        let simulation = Simulation::new(data, self.controller, self.trajectories, link)?;
        let physics = PhysicsThread::start(simulation).map_err(ViewerError::Thread)?;
        let (event_loop, opened) = request.split();
        // A window of the background thread needs no event loop here; the physics thread ends with
        // the window.
        event_loop.map_or(Ok(()), |event_loop| event_loop.run())?;
        opened.wait()?;
        let data = physics.join().ok_or_else(|| ViewerError::Window("the physics thread has panicked".to_owned()))?;
        opened.end()?;
        Ok(data)
    }
}

/// Shows a window for a program that steps its simulation itself. The program runs on another
/// thread, and the calling thread shows the window, which works on every platform. The window
/// closes when the program ends. The program starts when the window exists; its first image can
/// follow seconds later, if a graphics driver compiles shaders.
///
/// Closing the window does not end the program: [`ViewerHandle::is_running`] returns `false` then.
///
/// # Errors
///
/// Errors of the program, and errors of [`Viewer::run`]. If the window cannot be shown, the program
/// is not started.
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
pub fn run<R, E>(options: ViewerOptions, program: impl FnOnce(&mut ViewerHandle) -> Result<R, E> + Send) -> Result<R, E>
where
    R: Send,
    E: From<ViewerError> + Send,
{
    let (request, link) = WindowRequest::on_this_thread(options)?;
    let (event_loop, opened) = request.split();
    let program = move || {
        opened.wait()?;
        let result = program(&mut ViewerHandle::new(link))?;
        opened.end()?;
        Ok(result)
    };
    let Some(event_loop) = event_loop else { return program() };
    thread::scope(|scope| {
        let program = thread::Builder::new()
            .name("program".to_owned())
            .spawn_scoped(scope, program)
            .map_err(ViewerError::Thread)?;
        let shown = event_loop.run();
        let result = program.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        shown?;
        result
    })
}

/// Opens a window for a program that steps its simulation itself, and returns immediately. Any
/// thread can open any number of windows. The first call starts a background thread for all
/// windows, which lives as long as the process. Not available on macOS, where windows belong to the
/// main thread; [`run`] works there too.
///
/// # Errors
///
/// Errors of [`Viewer::run`].
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
/// // Dropping the handle closes the window.
/// # Ok::<(), ViewerError>(())
/// ```
#[cfg(not(target_os = "macos"))]
pub fn launch(options: ViewerOptions) -> Result<ViewerHandle, ViewerError> {
    let (request, link) = WindowRequest::on_window_thread(options)?;
    let (_, opened) = request.split();
    opened.wait()?;
    Ok(ViewerHandle::new(link))
}
