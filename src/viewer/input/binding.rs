//! The table: which key does what, in which mode. Everything about keys comes from here: what a press does, the help on the
//! screen and on the terminal, and the tests.
//!
//! Where the programs that people know disagree, it goes by MuJoCo.jl's viewer, and has the keys of the engine's `simulate`
//! besides where they are free: `-` and `=` are labels, not speed, `[` and `]` frames, not cameras, Esc quits. The engine's own
//! table has the comma twice; here it is the activations, and with Shift the segments.

use super::{Action, Key, KeyPress, Modifiers, Panel, PlotKind, WindowAction};
use crate::scene::{RenderFlags, VisualFlags};
use crate::viewer::mode::Mode;

/// Under which heading of the help something stands.
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
    /// All of them, in the order of the help.
    pub const ALL: [Self; 6] =
        [Self::Standard, Self::Window, Self::Camera, Self::Visual, Self::Effects, Self::Trajectory];

    pub fn title(self) -> &'static str {
        match self {
            Self::Standard => "Simulation",
            Self::Window => "Window",
            Self::Camera => "Camera",
            Self::Visual => "What is shown",
            Self::Effects => "Effects",
            Self::Trajectory => "Trajectory",
        }
    }
}

/// A line of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Binding {
    pub key: Key,
    /// Exactly these.
    pub modifiers: Modifiers,
    /// Whether it is done again while the key is held.
    pub repeats: bool,
    /// In which mode only.
    pub mode: Option<Mode>,
    pub action: Action,
    pub section: Section,
    /// Neighbours with the same text are one line of the help.
    pub help: &'static str,
}

const fn on(section: Section, key: Key, action: Action, help: &'static str) -> Binding {
    Binding { key, modifiers: Modifiers::NONE, repeats: true, mode: None, action, section, help }
}

impl Binding {
    const fn with(self, modifiers: Modifiers) -> Self {
        Self { modifiers, ..self }
    }

    const fn once(self) -> Self {
        Self { repeats: false, ..self }
    }

    const fn only(self, mode: Mode) -> Self {
        Self { mode: Some(mode), ..self }
    }

    /// As help texts name what to press.
    pub fn press(&self) -> KeyPress {
        KeyPress { key: self.key, modifiers: self.modifiers, repeat: false }
    }
}

const fn visual(key: char, flag: VisualFlags, help: &'static str) -> Binding {
    on(Section::Visual, Key::Character(key), Action::Visual(flag), help)
}

const fn effect(key: char, flag: RenderFlags, help: &'static str) -> Binding {
    on(Section::Effects, Key::Character(key), Action::Render(flag), help)
}

const fn geoms(key: char, group: usize) -> Binding {
    on(Section::Visual, Key::Character(key), Action::GeomGroup(group), "Geoms of groups 0 to 5")
}

const fn sites(key: char, group: usize) -> Binding {
    on(Section::Visual, Key::Character(key), Action::SiteGroup(group), "Sites of groups 0 to 5").with(SHIFT)
}

const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND: Modifiers = Modifiers::COMMAND;

const fn standard(key: Key, action: Action, help: &'static str) -> Binding {
    on(Section::Standard, key, action, help)
}

const fn window(key: Key, action: WindowAction, help: &'static str) -> Binding {
    on(Section::Window, key, Action::Window(action), help).once()
}

const fn shown(key: Key, action: Action, help: &'static str) -> Binding {
    on(Section::Visual, key, action, help)
}

const fn trajectory(key: Key, action: Action, help: &'static str) -> Binding {
    on(Section::Trajectory, key, action, help).only(Mode::Trajectory)
}

const QUIT: WindowAction = WindowAction::Quit;
const FULL_SCREEN: &str = "Full screen, or back";
const STEP_50: &str = "Where paused: 50 steps forward";
const BACK_50: &str = "Where paused: 50 steps back";

pub(crate) static BINDINGS: &[Binding] = &[
    standard(Key::Space, Action::Pause, "Pause, or go on"),
    standard(Key::Backspace, Action::Reset, "Back to the start"),
    standard(Key::Right, Action::Step(1), "Where paused: a step forward"),
    standard(Key::Right, Action::Step(50), STEP_50).with(SHIFT),
    standard(Key::Left, Action::Step(-1), "Where paused: a step back"),
    standard(Key::Left, Action::Step(-50), BACK_50).with(SHIFT),
    standard(Key::Enter, Action::Speed, "Real time, or the speed that is set"),
    standard(Key::Up, Action::Faster, "Double the speed").with(SHIFT),
    standard(Key::Down, Action::Slower, "Halve the speed").with(SHIFT),
    standard(Key::Right, Action::Mode(1), "Next mode").with(COMMAND),
    standard(Key::Left, Action::Mode(-1), "Previous mode").with(COMMAND),
    standard(Key::PageUp, Action::SelectParent, "Select the parent of the selected body"),
    standard(Key::Backspace, Action::ClearControls, "Set all controls to zero").with(COMMAND),
    standard(Key::Character('s'), Action::SaveKey, "Keep the state as a keyframe").with(COMMAND).once(),
    standard(Key::Character('c'), Action::CopyState, "Copy the state as a <key> to the clipboard").with(COMMAND).once(),
    on(Section::Camera, Key::Character('c'), Action::CopyCamera, "Copy the camera as a <camera> to the clipboard")
        .with(COMMAND.and(SHIFT))
        .once(),
    on(Section::Window, Key::Escape, Action::Window(QUIT), "Quit"),
    on(Section::Window, Key::Character('q'), Action::Window(QUIT), "Quit").with(COMMAND),
    on(Section::Window, Key::Function(1), Action::Help, "Help, here and on the terminal"),
    on(Section::Window, Key::Function(2), Action::Info, "Info panel"),
    on(Section::Window, Key::Function(3), Action::Plot(PlotKind::Profile), "Plot of the solver and of computing times"),
    on(Section::Window, Key::Function(4), Action::Plot(PlotKind::Sensors), "Plot of the sensors"),
    on(Section::Window, Key::Character('1'), Action::Panel(Panel::Left), "Panel at the left").with(COMMAND),
    on(Section::Window, Key::Character('2'), Action::Panel(Panel::Right), "Panel at the right").with(COMMAND),
    window(Key::Function(8), WindowAction::Resize([1024, 768]), "1024 x 768 (XGA)"),
    window(Key::Function(8), WindowAction::Resize([1280, 1024]), "1280 x 1024 (SXGA)").with(SHIFT),
    window(Key::Function(9), WindowAction::Resize([1280, 720]), "1280 x 720 (HD)"),
    window(Key::Function(9), WindowAction::Resize([1920, 1080]), "1920 x 1080 (Full HD)").with(SHIFT),
    window(Key::Function(10), WindowAction::DefaultSize, "The size that the window had first"),
    window(Key::Function(11), WindowAction::FullScreen, FULL_SCREEN),
    window(Key::Function(5), WindowAction::FullScreen, FULL_SCREEN),
    window(Key::Character('v'), WindowAction::Record, "Start or end a video recording").with(COMMAND),
    window(Key::Character('p'), WindowAction::Screenshot, "Save a picture").with(COMMAND),
    window(Key::Character('l'), WindowAction::Reload, "Load the model's file anew").with(COMMAND),
    on(Section::Camera, Key::Character('a'), Action::Align, "Free camera on the middle of the model").with(COMMAND),
    on(Section::Camera, Key::Tab, Action::Camera(1), "Next camera").once(),
    on(Section::Camera, Key::Tab, Action::Camera(-1), "Previous camera").with(SHIFT).once(),
    shown(Key::Character('-'), Action::Label(-1), "Labels: previous kind"),
    shown(Key::Character('='), Action::Label(1), "Labels: next kind"),
    shown(Key::Function(7), Action::Label(1), "Labels: next kind"),
    shown(Key::Character('['), Action::Frame(-1), "Frames: previous kind"),
    shown(Key::Character(']'), Action::Frame(1), "Frames: next kind"),
    shown(Key::Function(6), Action::Frame(1), "Frames: next kind"),
    geoms('1', 0),
    geoms('2', 1),
    geoms('3', 2),
    geoms('4', 3),
    geoms('5', 4),
    geoms('6', 5),
    sites('1', 0),
    sites('2', 1),
    sites('3', 2),
    sites('4', 3),
    sites('5', 4),
    sites('6', 5),
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
    visual('\'', VisualFlags::SCLINERTIA, "Inertia boxes as large as water would be"),
    visual('b', VisualFlags::PERTFORCE, "Applied forces"),
    visual('o', VisualFlags::PERTOBJ, "Where a body is pulled to"),
    visual('c', VisualFlags::CONTACTPOINT, "Contact points"),
    visual('f', VisualFlags::CONTACTFORCE, "Contact forces"),
    visual('p', VisualFlags::CONTACTSPLIT, "Contact forces split into normal and friction"),
    visual('t', VisualFlags::TRANSPARENT, "Moving bodies transparent"),
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
    effect(',', RenderFlags::SEGMENT, "Segments").with(SHIFT),
    effect('.', RenderFlags::IDCOLOR, "Segments shaded by their number"),
    trajectory(Key::Character('r'), Action::Reverse, "In reverse, or forward again").with(COMMAND),
    trajectory(Key::Up, Action::Trajectory(1), "Next trajectory"),
    trajectory(Key::Down, Action::Trajectory(-1), "Previous trajectory"),
    trajectory(Key::Character('b'), Action::Burst, "Burst: other moments in the same picture").with(COMMAND),
    trajectory(Key::Character('d'), Action::Doppler, "Doppler: past moments red, future ones blue").with(COMMAND),
];

/// What a key does in a mode.
pub(crate) fn action(press: KeyPress, mode: Mode) -> Option<Action> {
    BINDINGS
        .iter()
        .find(|binding| {
            binding.key == press.key
                && binding.modifiers == press.modifiers
                && (binding.repeats || !press.repeat)
                && binding.mode.is_none_or(|only| only == mode)
        })
        .map(|binding| binding.action)
}
