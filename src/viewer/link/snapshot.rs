//! State of a simulation as the window draws it and the panels show it.

use std::fmt::{self, Arguments, Write};
use std::sync::Arc;

use super::playback::PlaybackState;
use super::timeline::Timeline;
use crate::data::{Data, SolverIteration, Timer, TimerCount};
use crate::error::Result;
use crate::id::{BodyId, CameraId, GeomId};
use crate::model::{Model, Statistics, Visual};
use crate::scene::{Camera, Scene, Viewpoint};
use crate::viewer::endpoint::CapturedKey;
use crate::viewer::instruments::{Parameter, PlottedValue};
use crate::viewer::signal::{Signal, Signals};

/// Capacity of a scene, in geoms.
const MAX_GEOMS: usize = 10_000;

/// State of a simulation, triple-buffered: three snapshots circulate and reuse their memory.
#[derive(Debug)]
pub(crate) struct Snapshot {
    pub scene: Scene,
    /// A different `Arc` than in the last snapshot means that the model was edited. A different
    /// `generation` means that it was replaced.
    pub model: Arc<Model>,
    /// Number of times that the model was replaced.
    pub generation: u64,
    /// Camera of the scene. A tracking camera has moved with its body.
    pub camera: Camera,
    /// Sequence number of the snapshot.
    pub number: u64,
    /// Number of the last request that was executed.
    pub executed: u64,

    pub time: f64,
    pub qpos: Vec<f64>,
    pub qvel: Vec<f64>,
    pub ctrl: Vec<f64>,
    /// Positions of the bodies, geoms and sites, m, world frame.
    pub xpos: Vec<[f64; 3]>,
    pub geom_xpos: Vec<[f64; 3]>,
    pub site_xpos: Vec<[f64; 3]>,
    /// Solver iterations of the last step.
    pub solver: Vec<SolverIteration>,
    /// Accumulated since the last reset, in the order of [`Timer::ALL`].
    pub timers: [TimerCount; Timer::ALL.len()],
    pub signals: Signals,
    /// Values that the controller or the program plots.
    pub plotted: Vec<PlottedValue>,
    /// Parameters of the controller or the program.
    pub parameters: Vec<Parameter>,

    pub status: Status,
    /// Message of the last error, until the simulation resumes. Empty without an error.
    pub problem: String,
    pub speed: SimulationSpeed,
    pub noise: ControlNoise,
    /// Available modes.
    pub modes: Vec<Mode>,
    pub mode: Mode,
    /// Lines of the mode in the info panel.
    pub info: Vec<InfoLine>,
    /// `Some` in the trajectory mode.
    pub playback: Option<PlaybackState>,
    /// Number of states in the history.
    pub history_len: usize,
    /// Index of the current state in the history; `history_len` for the newest state, which the
    /// history does not contain.
    pub history_position: usize,
    /// States that the user can select: the records in the trajectory mode, else the history.
    pub timeline: Timeline,
    /// Names of the trajectories in the trajectory mode.
    pub trajectories: Arc<[String]>,
    /// Viewpoints of the cameras of panes.
    pub panes: Vec<PaneView>,
    pub selected: Option<SelectedBody>,
    /// Keyframes that the user has captured.
    pub captured: Arc<Vec<CapturedKey>>,
}

/// Source of the motion of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Mode {
    /// A controller sets the controls before each step.
    Controller,
    /// Recorded states are shown.
    Trajectory,
    /// Dynamics without a controller.
    Passive,
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Controller => "Controller",
            Self::Trajectory => "Trajectory",
            Self::Passive => "Passive Dynamics",
        })
    }
}

/// State of execution of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    Paused,
    Running,
    /// A trajectory is played in reverse.
    Reversed,
    /// The program steps the simulation.
    Program,
}

impl Status {
    /// Returns the text of the info panel.
    pub fn text(self) -> &'static str {
        match self {
            Self::Paused => "Paused",
            Self::Running => "Forward Simulation",
            Self::Reversed => "Reverse Simulation",
            Self::Program => "Program",
        }
    }
}

/// Settings of a model that determine its appearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Appearance {
    pub visual: Visual,
    pub statistics: Statistics,
}

impl Appearance {
    pub fn of(model: &Model) -> Self {
        Self { visual: model.visual(), statistics: model.statistics() }
    }
}

/// Noise on the controls: an Ornstein–Uhlenbeck process on each control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ControlNoise {
    /// Standard deviation in half ranges of the control, or in its unit if it has no limits. 0 for
    /// no noise.
    pub deviation: f64,
    /// Time in which the correlation falls to 1/e, s.
    pub correlation_time: f64,
}

impl Default for ControlNoise {
    fn default() -> Self {
        Self { deviation: 0.0, correlation_time: 0.1 }
    }
}

/// Simulated time relative to real time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SimulationSpeed {
    /// Speed factor, simulated over real time.
    pub factor: f64,
    /// `true` if the factor applies; `false` for real time.
    pub by_factor: bool,
    /// Measured over the last half second. Zero while nothing runs.
    pub measured: f64,
    /// Real time that was dropped since the start because the simulation could not keep up, s.
    pub dropped: f64,
}

impl SimulationSpeed {
    /// Returns the target: simulated over real time.
    pub fn target(&self) -> f64 {
        if self.by_factor { self.factor } else { 1.0 }
    }

    /// Returns the text of the info panel: `10x (slower)`, `2x (faster)`, `1`.
    pub fn text(&self) -> String {
        let target = self.target();
        if target > 1.0 {
            format!("{}x (faster)", rounded(target))
        } else if target < 1.0 {
            format!("{}x (slower)", rounded(1.0 / target))
        } else {
            "1".to_owned()
        }
    }
}

/// Rounds to two decimals.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// Selected body and its perturbation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SelectedBody {
    pub body: BodyId,
    /// Geom that the user has clicked on.
    pub geom: Option<GeomId>,
    /// Point that the user has clicked on, m, body frame.
    pub localpos: [f64; 3],
    /// `true` while the body is pulled or rotated.
    pub active: bool,
    /// Force, N, and torque, N m, on the centre of mass, world frame. Zero while paused, because
    /// the pose is set directly then.
    pub force: [f64; 6],
}

/// Viewpoint of a pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PaneView {
    pub camera: CameraId,
    /// Left and right eye.
    pub viewpoints: [Viewpoint; 2],
}

/// Line of the info panel.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub(crate) struct InfoLine {
    pub name: &'static str,
    pub value: String,
}

/// Writer that overwrites lines of the info panel and reuses their memory.
pub(crate) struct InfoLines<'l> {
    lines: &'l mut Vec<InfoLine>,
    used: usize,
}

impl<'l> InfoLines<'l> {
    pub fn new(lines: &'l mut Vec<InfoLine>) -> Self {
        Self { lines, used: 0 }
    }

    pub fn push(&mut self, name: &'static str, value: Arguments<'_>) {
        if self.used == self.lines.len() {
            self.lines.push(InfoLine::default());
        }
        let line = &mut self.lines[self.used];
        line.name = name;
        line.value.clear();
        // Writing to a string cannot fail.
        let _ = line.value.write_fmt(value);
        self.used += 1;
    }

    /// Removes the old lines that were not overwritten.
    pub fn finish(self) {
        self.lines.truncate(self.used);
    }
}

impl Snapshot {
    /// Creates an empty snapshot with the buffers that this model needs.
    pub fn new(model: &Arc<Model>) -> Result<Self> {
        Ok(Self {
            scene: Scene::new(model, MAX_GEOMS)?,
            model: model.clone(),
            generation: 0,
            camera: Camera::free(model),
            number: 0,
            executed: 0,
            time: 0.0,
            qpos: Vec::with_capacity(model.nq()),
            qvel: Vec::with_capacity(model.nv()),
            ctrl: Vec::with_capacity(model.nu()),
            xpos: Vec::with_capacity(model.nbody()),
            geom_xpos: Vec::with_capacity(model.ngeom()),
            site_xpos: Vec::with_capacity(model.nsite()),
            solver: Vec::new(),
            timers: [TimerCount::default(); Timer::ALL.len()],
            signals: Signals::default(),
            plotted: Vec::new(),
            parameters: Vec::new(),
            status: Status::Paused,
            problem: String::new(),
            speed: SimulationSpeed { factor: 1.0, by_factor: false, measured: 0.0, dropped: 0.0 },
            noise: ControlNoise::default(),
            modes: Vec::new(),
            mode: Mode::Passive,
            info: Vec::new(),
            playback: None,
            history_len: 0,
            history_position: 0,
            timeline: Timeline::default(),
            trajectories: Arc::default(),
            panes: Vec::new(),
            selected: None,
            captured: Arc::default(),
        })
    }

    /// Returns `true` if the controller or the program has plots or parameters.
    pub fn has_instruments(&self) -> bool {
        !(self.plotted.is_empty() && self.parameters.is_empty())
    }

    /// Extends the ranges of the signals by those of an older snapshot.
    pub fn add_ranges(&mut self, older: &Self) {
        // The sensors of another model are others.
        if self.generation != older.generation {
            return;
        }
        self.signals.add_ranges(&older.signals);
        for PlottedValue { plot, name, signal } in &mut self.plotted {
            if let Some(older) = older.plotted.iter().find(|older| older.plot == *plot && older.name == *name) {
                signal.add_range(older.signal.range);
            }
        }
    }

    /// Empties the ranges of the signals, after the plots have recorded them.
    pub fn clear_ranges(&mut self) {
        self.signals.clear_ranges();
        self.plotted.iter_mut().for_each(|value| value.signal.range = Signal::NO_RANGE);
    }

    /// Copies the values that the panels show.
    pub fn copy_values(&mut self, data: &Data) {
        self.time = data.time();
        for (to, from) in [(&mut self.qpos, data.qpos()), (&mut self.qvel, data.qvel()), (&mut self.ctrl, data.ctrl())]
        {
            to.clear();
            to.extend_from_slice(from);
        }
        for (to, from) in [
            (&mut self.xpos, data.xpos()),
            (&mut self.geom_xpos, data.geom_xpos()),
            (&mut self.site_xpos, data.site_xpos()),
        ] {
            to.clear();
            to.extend_from_slice(from);
        }
        self.solver.clear();
        self.solver.extend(data.solver());
        self.timers = Timer::ALL.map(|timer| data.timer(timer));
    }
}
