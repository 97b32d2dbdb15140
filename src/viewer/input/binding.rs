//! Table of the key bindings, the single source for key presses, the help on the screen and on the
//! terminal, and the tests.
//!
//! The bindings follow the engine's `simulate`. Keys of MuJoCo.jl's viewer are added if `simulate`
//! does not use them: arrows and Enter for steps and speed, F8 to F11 for the size, and the keys of
//! trajectories. The engine's own table assigns the comma twice; here it toggles activations, and
//! segmentation with Shift.

use std::path::PathBuf;

use super::{Key, KeyPress, Modifiers};
use crate::scene::{RenderFlags, VisualFlags};
use crate::viewer::link::{EndpointRequest, Mode, PlaybackRequest, Request, SavedFile, SimulationRequest};

/// Effect of a key or a button of a panel.
#[derive(Clone, Debug)]
pub(crate) enum Action {
    /// Modifies the view.
    View(ViewAction),
    /// Affects the window or its files.
    Window(WindowAction),
    /// Loads a model file.
    Open(PathBuf),
    /// Sends a request to the physics.
    Send(Request),
}

/// Action on the view of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ViewAction {
    /// Toggles the help, and prints it to the terminal when it opens.
    Help,
    /// Toggles the panel that opens a model file.
    Files,
    /// Toggles the details of the info panel.
    Details,
    /// Toggles the timeline.
    Timeline,
    /// Toggles a side panel.
    Panel(Panel),
    /// Toggles a plot.
    Plot(PlotKind),
    /// Centres the free camera on the model.
    Align,
    /// Switches from a tracking or fixed camera to the free camera.
    FreeCamera,
    /// Advances by this number of cameras: the free camera, then the cameras of the model.
    Camera(i32),
    /// Advances by this number of kinds of labels.
    Label(i32),
    /// Advances by this number of kinds of frames.
    Frame(i32),
    /// Toggles a part of the scene.
    Visual(VisualFlags),
    /// Toggles a rendering effect.
    Render(RenderFlags),
    /// Toggles a group of geoms.
    GeomGroup(usize),
    /// Toggles a group of sites.
    SiteGroup(usize),
}

/// Action on the window or its files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WindowAction {
    /// Closes the window.
    Quit,
    /// Sets the width and the height in pixels.
    Resize([u32; 2]),
    /// Restores the initial size.
    DefaultSize,
    /// Toggles full screen.
    FullScreen,
    /// Starts or stops a recording.
    Record,
    /// Saves a screenshot.
    Screenshot,
    /// Saves a file about the model.
    Save(SavedFile),
    /// Reloads the model's file.
    Reload,
    /// Prints the help to the terminal.
    PrintHelp,
    /// Enables or disables vertical synchronisation.
    SetVsync(bool),
}

/// Panel at a side of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Panel {
    Left,
    Right,
}

/// Kind of plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PlotKind {
    /// Solver statistics and computing times.
    Profile,
    /// Sensor readings.
    Sensors,
    /// Values and parameters of a controller or program.
    Instruments,
}

/// Section of the help.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Section {
    Standard,
    Window,
    Camera,
    Visual,
    Effects,
    Trajectory,
}

impl Section {
    /// All sections, in the order of the help.
    pub const ALL: [Self; 6] =
        [Self::Standard, Self::Window, Self::Camera, Self::Visual, Self::Effects, Self::Trajectory];

    pub fn title(self) -> &'static str {
        match self {
            Self::Standard => "Simulation",
            Self::Window => "Window",
            Self::Camera => "Camera",
            Self::Visual => "Visualisation",
            Self::Effects => "Effects",
            Self::Trajectory => "Trajectory",
        }
    }
}

/// Entry of the table.
#[derive(Clone, Debug)]
pub(crate) struct Binding {
    pub key: Key,
    /// Required modifiers. No other modifier may be held.
    pub modifiers: Modifiers,
    /// The action repeats while the key is held.
    pub repeats: bool,
    /// Mode to which the binding is limited.
    pub mode: Option<Mode>,
    pub action: Action,
    pub section: Section,
    /// Text of the help. Adjacent entries with the same text share a line.
    pub help: &'static str,
}

const fn on(section: Section, key: Key, action: Action, help: &'static str) -> Binding {
    Binding { key, modifiers: Modifiers::NONE, repeats: true, mode: None, action, section, help }
}

impl Binding {
    const fn with(mut self, modifiers: Modifiers) -> Self {
        self.modifiers = modifiers;
        self
    }

    const fn once(mut self) -> Self {
        self.repeats = false;
        self
    }

    /// Returns `true` if the binding has one of the keys that a program has released.
    pub fn is_released(&self, released: &[Key]) -> bool {
        released.contains(&self.key) && !self.modifiers.contains(COMMAND)
    }

    /// Returns the key press that triggers the binding.
    pub fn press(&self) -> KeyPress {
        KeyPress { key: self.key, modifiers: self.modifiers, repeat: false }
    }
}

const fn visual(key: char, flag: VisualFlags, help: &'static str) -> Binding {
    shown(Key::Character(key), ViewAction::Visual(flag), help)
}

const fn effect(key: char, flag: RenderFlags, help: &'static str) -> Binding {
    on(Section::Effects, Key::Character(key), Action::View(ViewAction::Render(flag)), help)
}

const fn geoms(key: char, group: usize) -> Binding {
    shown(Key::Character(key), ViewAction::GeomGroup(group), "Geoms of groups 0 to 5")
}

const fn sites(key: char, group: usize) -> Binding {
    shown(Key::Character(key), ViewAction::SiteGroup(group), "Sites of groups 0 to 5").with(SHIFT)
}

const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND: Modifiers = Modifiers::COMMAND;

const fn standard(key: Key, request: Request, help: &'static str) -> Binding {
    on(Section::Standard, key, Action::Send(request), help)
}

const fn simulation(key: Key, request: SimulationRequest, help: &'static str) -> Binding {
    standard(key, Request::Simulation(request), help)
}

const fn endpoint(key: Key, request: EndpointRequest, help: &'static str) -> Binding {
    standard(key, Request::Endpoint(request), help)
}

const fn window(key: Key, action: WindowAction, help: &'static str) -> Binding {
    on(Section::Window, key, Action::Window(action), help)
}

const fn panel(key: Key, action: ViewAction, help: &'static str) -> Binding {
    on(Section::Window, key, Action::View(action), help)
}

const fn camera(key: Key, action: ViewAction, help: &'static str) -> Binding {
    on(Section::Camera, key, Action::View(action), help)
}

const fn shown(key: Key, action: ViewAction, help: &'static str) -> Binding {
    on(Section::Visual, key, Action::View(action), help)
}

const fn trajectory(key: Key, request: PlaybackRequest, help: &'static str) -> Binding {
    let mut binding = on(Section::Trajectory, key, Action::Send(Request::Playback(request)), help);
    binding.mode = Some(Mode::Trajectory);
    binding
}

const FULL_SCREEN: &str = "Full screen on or off";
const FASTER: &str = "Double the speed factor";
const SLOWER: &str = "Halve the speed factor";
const LEFT_PANEL: &str = "Left panel";
const RIGHT_PANEL: &str = "Right panel";
const STEP_50: &str = "While paused: 50 steps forward";
const BACK_50: &str = "While paused: 50 steps back";

pub(crate) static BINDINGS: &[Binding] = &[
    standard(Key::Space, Request::TogglePause, "Pause or resume"),
    standard(Key::Backspace, Request::Reset, "Reset to the start"),
    simulation(Key::Right, SimulationRequest::Step(1), "While paused: one step forward"),
    simulation(Key::Right, SimulationRequest::Step(50), STEP_50).with(SHIFT),
    simulation(Key::Left, SimulationRequest::Step(-1), "While paused: one step back"),
    simulation(Key::Left, SimulationRequest::Step(-50), BACK_50).with(SHIFT),
    simulation(Key::Enter, SimulationRequest::ToggleSpeed, "Real time or the speed factor"),
    simulation(Key::Character('='), SimulationRequest::Faster, FASTER),
    simulation(Key::Up, SimulationRequest::Faster, FASTER).with(SHIFT),
    simulation(Key::Character('-'), SimulationRequest::Slower, SLOWER),
    simulation(Key::Down, SimulationRequest::Slower, SLOWER).with(SHIFT),
    simulation(Key::Right, SimulationRequest::CycleMode(1), "Next mode").with(COMMAND),
    simulation(Key::Left, SimulationRequest::CycleMode(-1), "Previous mode").with(COMMAND),
    endpoint(Key::PageUp, EndpointRequest::SelectParent, "Select the parent of the selected body"),
    endpoint(Key::Backspace, EndpointRequest::ClearControls, "Set all controls to zero").with(COMMAND),
    endpoint(Key::Character('s'), EndpointRequest::SaveKey(None), "Capture the state as a keyframe")
        .with(COMMAND)
        .once(),
    endpoint(Key::Character('c'), EndpointRequest::CopyState, "Copy the state as a <key> to the clipboard")
        .with(COMMAND)
        .once(),
    on(
        Section::Camera,
        Key::Character('c'),
        Action::Send(Request::Endpoint(EndpointRequest::CopyCamera)),
        "Copy the camera as a <camera> to the clipboard",
    )
    .with(COMMAND.and(SHIFT))
    .once(),
    window(Key::Character('q'), WindowAction::Quit, "Quit").with(COMMAND),
    panel(Key::Function(1), ViewAction::Help, "Help, here and on the terminal"),
    panel(Key::Function(2), ViewAction::Details, "Details of the info panel"),
    panel(Key::Function(2), ViewAction::Timeline, "Timeline").with(SHIFT),
    panel(Key::Function(3), ViewAction::Plot(PlotKind::Profile), "Plots of the solver and of computing times"),
    panel(Key::Function(4), ViewAction::Plot(PlotKind::Sensors), "Plot of the sensors"),
    panel(Key::Function(3), ViewAction::Plot(PlotKind::Instruments), "Plots and parameters of the controller")
        .with(SHIFT),
    panel(Key::Tab, ViewAction::Panel(Panel::Left), LEFT_PANEL).once(),
    panel(Key::Character('1'), ViewAction::Panel(Panel::Left), LEFT_PANEL).with(COMMAND).once(),
    panel(Key::Tab, ViewAction::Panel(Panel::Right), RIGHT_PANEL).with(SHIFT).once(),
    panel(Key::Character('2'), ViewAction::Panel(Panel::Right), RIGHT_PANEL).with(COMMAND).once(),
    window(Key::Function(8), WindowAction::Resize([1024, 768]), "1024 x 768 (XGA)").once(),
    window(Key::Function(8), WindowAction::Resize([1280, 1024]), "1280 x 1024 (SXGA)").with(SHIFT).once(),
    window(Key::Function(9), WindowAction::Resize([1280, 720]), "1280 x 720 (HD)").once(),
    window(Key::Function(9), WindowAction::Resize([1920, 1080]), "1920 x 1080 (Full HD)").with(SHIFT).once(),
    window(Key::Function(10), WindowAction::DefaultSize, "Initial size of the window").once(),
    window(Key::Function(11), WindowAction::FullScreen, FULL_SCREEN).once(),
    window(Key::Function(5), WindowAction::FullScreen, FULL_SCREEN).once(),
    window(Key::Character('v'), WindowAction::Record, "Start or stop a video recording").with(COMMAND).once(),
    window(Key::Character('p'), WindowAction::Screenshot, "Save a screenshot").with(COMMAND).once(),
    panel(Key::Character('o'), ViewAction::Files, "Open a model file").with(COMMAND).once(),
    window(Key::Character('l'), WindowAction::Reload, "Reload the model's file").with(COMMAND).once(),
    camera(Key::Character('a'), ViewAction::Align, "Free camera, centred on the model").with(COMMAND),
    camera(Key::Escape, ViewAction::FreeCamera, "Free camera"),
    camera(Key::Character(']'), ViewAction::Camera(1), "Next camera"),
    camera(Key::Character('['), ViewAction::Camera(-1), "Previous camera"),
    shown(Key::Function(6), ViewAction::Frame(1), "Frames: next kind"),
    shown(Key::Function(6), ViewAction::Frame(-1), "Frames: previous kind").with(SHIFT),
    shown(Key::Function(7), ViewAction::Label(1), "Labels: next kind"),
    shown(Key::Function(7), ViewAction::Label(-1), "Labels: previous kind").with(SHIFT),
    geoms('0', 0),
    geoms('1', 1),
    geoms('2', 2),
    geoms('3', 3),
    geoms('4', 4),
    geoms('5', 5),
    sites('0', 0),
    sites('1', 1),
    sites('2', 2),
    sites('3', 3),
    sites('4', 4),
    sites('5', 5),
    visual('h', VisualFlags::CONVEXHULL, "Convex hulls"),
    visual('x', VisualFlags::TEXTURE, "Textures"),
    visual('j', VisualFlags::JOINT, "Joints"),
    visual('q', VisualFlags::CAMERA, "Cameras"),
    visual('u', VisualFlags::ACTUATOR, "Actuators"),
    visual(',', VisualFlags::ACTIVATION, "Activations"),
    visual('z', VisualFlags::LIGHT, "Lights"),
    visual('v', VisualFlags::TENDON, "Tendons"),
    visual('y', VisualFlags::RANGEFINDER, "Rangefinders"),
    visual('n', VisualFlags::CONSTRAINT, "Equality constraints"),
    visual('i', VisualFlags::INERTIA, "Inertia boxes"),
    visual('\'', VisualFlags::SCLINERTIA, "Inertia boxes at the density of water"),
    visual('b', VisualFlags::PERTFORCE, "Applied forces"),
    visual('o', VisualFlags::PERTOBJ, "Target of the pull"),
    visual('c', VisualFlags::CONTACTPOINT, "Contact points"),
    visual('f', VisualFlags::CONTACTFORCE, "Contact forces"),
    visual('p', VisualFlags::CONTACTSPLIT, "Contact forces split into normal and friction"),
    visual('t', VisualFlags::TRANSPARENT, "Transparent moving bodies"),
    visual('a', VisualFlags::AUTOCONNECT, "Lines from bodies to joints and parents"),
    visual('m', VisualFlags::COM, "Centres of mass"),
    visual('e', VisualFlags::SELECT, "The selected point"),
    visual('d', VisualFlags::STATIC, "Static bodies"),
    visual(';', VisualFlags::SKIN, "Skins"),
    effect('s', RenderFlags::SHADOW, "Shadows"),
    effect('w', RenderFlags::WIREFRAME, "Wireframe"),
    effect('r', RenderFlags::REFLECTION, "Reflections"),
    effect('l', RenderFlags::ADDITIVE, "Additive transparency"),
    effect('k', RenderFlags::SKYBOX, "Sky"),
    effect('g', RenderFlags::FOG, "Fog"),
    effect('/', RenderFlags::HAZE, "Haze"),
    effect(',', RenderFlags::SEGMENT, "Segmentation").with(SHIFT),
    effect('.', RenderFlags::IDCOLOR, "Segmentation, shaded by index"),
    trajectory(Key::Character('r'), PlaybackRequest::ToggleReverse, "Reverse or forward playback").with(COMMAND),
    trajectory(Key::Up, PlaybackRequest::CycleTrajectory(1), "Next trajectory"),
    trajectory(Key::Down, PlaybackRequest::CycleTrajectory(-1), "Previous trajectory"),
    trajectory(Key::Character('b'), PlaybackRequest::ToggleBurst, "Burst: several records in one frame").with(COMMAND),
    trajectory(Key::Character('d'), PlaybackRequest::ToggleDoppler, "Doppler: past records red, future records blue")
        .with(COMMAND),
];

/// Returns the action of a key press in a mode. The program receives the presses of released keys,
/// except with Ctrl.
pub(crate) fn find_action(press: KeyPress, mode: Mode, released: &[Key]) -> Option<&'static Action> {
    BINDINGS
        .iter()
        .find(|binding| {
            !binding.is_released(released)
                && binding.key == press.key
                && binding.modifiers == press.modifiers
                && (binding.repeats || !press.repeat)
                && binding.mode.is_none_or(|only| only == mode)
        })
        .map(|binding| &binding.action)
}
