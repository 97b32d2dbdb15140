//! How a simulation stands: what the window draws and the panels show.

use std::sync::Arc;

use super::capture::CapturedKey;
use super::mode::{InfoLine, Mode, Playback};
use crate::data::{Data, SolverIteration, Timer, TimerCount};
use crate::error::Result;
use crate::id::{BodyId, GeomId, SkinId};
use crate::model::Model;
use crate::scene::{Camera, Scene};

/// How many geoms a scene has room for.
pub(crate) const MOST_GEOMS: usize = 10_000;

/// How a simulation stands. Three of them go round, so that their memory is used again.
#[derive(Debug)]
pub(crate) struct Snapshot {
    /// What is to be drawn.
    pub scene: Scene,
    /// The model. Another `Arc` than before means that it was edited, another `generation` that it is another one.
    pub model: Arc<Model>,
    /// How often the model was replaced by another.
    pub generation: u64,
    /// From where the scene is seen. A tracking camera has moved along.
    pub camera: Camera,
    /// Counts the snapshots.
    pub number: u64,
    /// The number of the last request that was executed.
    pub executed: u64,

    pub time: f64,
    pub qpos: Vec<f64>,
    pub qvel: Vec<f64>,
    pub act: Vec<f64>,
    pub ctrl: Vec<f64>,
    pub sensordata: Vec<f64>,
    /// Potential and kinetic, J, if they are computed.
    pub energy: [f64; 2],
    /// Where the memory for contacts and constraints stands.
    pub ncon: usize,
    pub nefc: usize,
    /// The solver's iterations of the last step.
    pub solver: Vec<SolverIteration>,
    /// In the order of [`Timer::ALL`], summed up since the last reset.
    pub timers: [TimerCount; Timer::ALL.len()],
    /// The numbers that are watched, in the order of the request. Not a number for one that there is not.
    pub watched: Vec<f64>,

    pub status: Status,
    /// What went wrong, until something goes on. Empty if nothing did.
    pub problem: String,
    pub pace: Pace,
    /// The modes that there are, in their order.
    pub modes: Vec<Mode>,
    pub mode: Mode,
    /// What the mode has to say, for the info panel.
    pub info: Vec<InfoLine>,
    /// How trajectories are played, in their mode.
    pub playback: Option<Playback>,
    /// How many states there are to go back to.
    pub history: usize,
    /// At which of them it stands: `history` for the newest state, which is not among them.
    pub moment: usize,
    pub selected: Option<Selected>,
    /// The keyframes that were kept.
    pub captured: Arc<Vec<CapturedKey>>,
}

/// What a simulation does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    /// It stands still.
    Paused,
    /// It runs.
    Running,
    /// It runs backwards.
    Reversed,
    /// The program steps it.
    Program,
}

impl Status {
    /// For the info panel.
    pub fn text(self) -> &'static str {
        match self {
            Self::Paused => "Paused",
            Self::Running => "Forward Simulation",
            Self::Reversed => "Reverse Simulation",
            Self::Program => "Program",
        }
    }
}

/// How fast a simulation goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pace {
    /// The factor that is set.
    pub factor: f64,
    /// Whether it goes by that factor; in real time otherwise.
    pub by_factor: bool,
    /// Simulated time over real time, as measured in the last second or so. Zero where nothing runs.
    pub measured: f64,
    /// How much real time was given up since the start because the simulation could not keep up, s.
    pub dropped: f64,
}

impl Pace {
    /// Simulated time over real time, as wanted.
    pub fn wanted(&self) -> f64 {
        if self.by_factor { self.factor } else { 1.0 }
    }

    /// For the info panel: `10x (slower)`, `2x (faster)`, `1`.
    pub fn text(&self) -> String {
        let wanted = self.wanted();
        if wanted > 1.0 {
            format!("{}x (faster)", rounded(wanted))
        } else if wanted < 1.0 {
            format!("{}x (slower)", rounded(1.0 / wanted))
        } else {
            "1".to_owned()
        }
    }
}

/// At most two decimals.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// What is selected, and how it is pulled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Selected {
    pub body: BodyId,
    /// What was clicked on.
    pub geom: Option<GeomId>,
    pub skin: Option<SkinId>,
    /// The point that was clicked on, m, in the body's frame.
    pub localpos: [f64; 3],
    /// Whether it is pulled or turned.
    pub active: bool,
    /// Force, N, and torque, N m, on its centre of mass, world frame. Zero while paused, for then its pose is set.
    pub force: [f64; 6],
}

impl Snapshot {
    /// An empty one.
    pub(super) fn new(model: &Arc<Model>) -> Result<Self> {
        Ok(Self {
            scene: Scene::new(model, MOST_GEOMS)?,
            model: model.clone(),
            generation: 0,
            camera: Camera::free(model),
            number: 0,
            executed: 0,
            time: 0.0,
            qpos: Vec::with_capacity(model.nq()),
            qvel: Vec::with_capacity(model.nv()),
            act: Vec::with_capacity(model.na()),
            ctrl: Vec::with_capacity(model.nu()),
            sensordata: Vec::with_capacity(model.nsensordata()),
            energy: [0.0; 2],
            ncon: 0,
            nefc: 0,
            solver: Vec::new(),
            timers: [TimerCount::default(); Timer::ALL.len()],
            watched: Vec::new(),
            status: Status::Paused,
            problem: String::new(),
            pace: Pace { factor: 1.0, by_factor: false, measured: 0.0, dropped: 0.0 },
            modes: Vec::new(),
            mode: Mode::Passive,
            info: Vec::new(),
            playback: None,
            history: 0,
            moment: 0,
            selected: None,
            captured: Arc::default(),
        })
    }

    /// Copies what the panels show.
    pub(super) fn take_numbers(&mut self, data: &Data) {
        self.time = data.time();
        for (to, from) in [
            (&mut self.qpos, data.qpos()),
            (&mut self.qvel, data.qvel()),
            (&mut self.act, data.act()),
            (&mut self.ctrl, data.ctrl()),
            (&mut self.sensordata, data.sensordata()),
        ] {
            to.clear();
            to.extend_from_slice(from);
        }
        self.energy = data.energy();
        (self.ncon, self.nefc) = (data.ncon(), data.nefc());
        self.solver.clear();
        self.solver.extend(data.solver());
        self.timers = Timer::ALL.map(|timer| data.timer(timer));
    }
}
