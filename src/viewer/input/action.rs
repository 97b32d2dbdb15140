//! What a key can do.

use crate::scene::{RenderFlags, VisualFlags};

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    /// Shows or hides the help, and prints it to the terminal when it shows it.
    Help,
    /// Shows or hides the info panel.
    Info,
    /// Shows or hides a panel.
    Panel(Panel),
    /// Shows or hides a plot.
    Plot(PlotKind),
    /// Something that only the window can do.
    Window(WindowAction),
    /// The free camera on the middle of the model.
    Align,
    /// The next or previous camera: free, then those of the model.
    Camera(i32),
    /// The next or previous kind of label.
    Label(i32),
    /// The next or previous kind of frame.
    Frame(i32),
    /// Switches a part of the scene on or off.
    Visual(VisualFlags),
    /// Switches an effect on or off.
    Render(RenderFlags),
    /// Shows or hides a group of geoms.
    GeomGroup(usize),
    /// Shows or hides a group of sites.
    SiteGroup(usize),
    /// Back to the start.
    Reset,
    /// Pauses or goes on.
    Pause,
    /// Steps forward or back, where paused.
    Step(i32),
    /// Switches between real time and the speed that is set.
    Speed,
    /// Doubles the speed that is set, and goes by it.
    Faster,
    /// Halves it.
    Slower,
    /// The next or previous mode.
    Mode(i32),
    /// Selects the parent of the selected body.
    SelectParent,
    /// Sets all controls to zero.
    ClearControls,
    /// Keeps the state as a keyframe.
    SaveKey,
    /// The state as a `<key>` to the clipboard.
    CopyState,
    /// The camera as a `<camera>` to the clipboard.
    CopyCamera,
    /// Plays trajectories in reverse, or forward again.
    Reverse,
    /// The next or previous trajectory.
    Trajectory(i32),
    /// Shows other moments of the trajectory too, or not.
    Burst,
    /// Shades past moments red and future ones blue, or not.
    Doppler,
}

/// What only the window can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WindowAction {
    /// Closes it.
    Quit,
    /// Gives it this size: width and height in pixels.
    Resize([u32; 2]),
    /// Gives it the size that it had first.
    DefaultSize,
    /// Full screen, or back.
    FullScreen,
    /// Starts or ends a recording.
    Record,
    /// Saves a picture.
    Screenshot,
    /// Loads the model's file anew.
    Reload,
    /// Prints the help to the terminal.
    PrintHelp,
}

/// A panel at a side of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Panel {
    Left,
    Right,
}

/// What is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PlotKind {
    /// The solver, and the time that each part of a step takes.
    Profile,
    /// Readings of the sensors.
    Sensors,
}
