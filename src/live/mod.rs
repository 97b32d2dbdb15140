//! A running simulation in a browser: the program serves a page, which shows the simulation and
//! pauses, steps, resets and controls it.
//!
#![doc = include_str!("picture.html")]
//!
//! ```
//! use mujoco_safe::live::{LiveOptions, LivePage};
//! use mujoco_safe::{Data, RandomController, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut controller = RandomController::new(1);
//! let mut page = LivePage::bind(data.model(), &LiveOptions::default())?;
//! println!("open {}", page.url());
//! for _ in 0..100 {
//!     page.step(&mut data, &mut controller)?;
//! }
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! [`LivePage::run_for`] runs a loop in real time. [`LivePage::step`] makes a step unless the user
//! has paused. [`LivePage::exchange`] is for programs that step by themselves.
//!
//! # On another machine
//!
//! The server listens to its own machine only. A tunnel of SSH leads there:
//!
//! ```text
//! ssh -L 8000:localhost:8000 robot
//! ```
//!
//! Open the address that the program prints; the first part may be `http://localhost:8000`.
//! [`LiveOptions::address`] sets the port.
//!
//! # Cost
//!
//! A state is copied only if a browser waits for one, which is at most 125 times per second. The
//! simulation never waits for a browser: there is one slot for the latest state and one for merged
//! requests, and no queue. If a browser is copying a slot, the simulation goes on, and uses the
//! slot in its next tick. A tick does not allocate. `cargo bench --features live --bench live`
//! compares with a step without a page.
//!
//! # Safety of the server
//!
//! - The address has a random token of 128 bits, which is compared in constant time. Without it
//!   there is neither a page nor a connection.
//! - The `Host` of a request must be `localhost`, an address in digits, or one of
//!   [`LiveOptions::hosts`], so that no other name leads to the server (DNS rebinding).
//! - A connection needs an `Origin` that is the page itself, which other pages cannot have.
//! - Messages have at most 1 kB. An unknown or wrong one ends its connection, and has no effect: a
//!   number that is not finite, a control outside of its range, an index that does not exist. A
//!   pull reaches at most two extents of the model, so its force is limited.
//! - The numbers of browsers and of other connections are limited, and so are the times in which a
//!   request must arrive and a browser must read. A browser that sends nothing for 30 s is
//!   disconnected; the page connects again when it is visible.
//! - Names of a model are data, as in [`html`](crate::html). The content security policy allows
//!   only the page's program, and connections to its own server.
//!
//! The connection is not encrypted.
//!
//! # Contents
//!
//! As of [`html`](crate::html), in single precision. Later edits of the model, such as colours, are
//! not shown.
//!
//! Requires the feature `live`.

mod hand;
mod http;
mod message;
mod options;
mod server;
mod slots;

use std::fmt;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rand::TryRng;
use rand::rngs::SysRng;

use self::hand::Hand;
use self::http::Gate;
use self::message::Limits;
pub use self::options::LiveOptions;
use self::server::{Server, Site};
use self::slots::{Grip, Requests, Setting, Slots};
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::html::{self, Slider};
use crate::model::{IntoModel, Model};
use crate::replay::{self, Frame};

/// Longest text of a problem in a state, bytes.
const LONGEST_PROBLEM: usize = 500;

/// Time of a tick while the simulation is paused.
const PAUSED_TICK: Duration = Duration::from_millis(20);

/// Delay from which a simulation in real time does not catch up.
const LARGEST_DELAY: Duration = Duration::from_millis(100);

/// Page that shows a running simulation in browsers. See the [module](self).
///
/// The server and its threads end when the page is dropped.
pub struct LivePage {
    model: Arc<Model>,
    site: Arc<Site>,
    server: Server,
    url: String,
    left_out: Vec<String>,
    frames: Vec<Frame>,
    hand: Hand,
    /// Values of the controls that users hold.
    held: Vec<Option<f64>>,
    requests: Requests,
    is_paused: bool,
    /// Steps to take while paused.
    steps: u32,
    /// Failure of the simulation or its controller.
    problem: Option<String>,
    /// State that a reset restores, from the first tick.
    start: Vec<f64>,
    /// Buffer for a state.
    state: Vec<f64>,
}

/// Decisions of the users for a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Tick {
    /// The simulation runs, or is paused and a user requests a step. `false` also while the data is
    /// unusable.
    pub advance: bool,
    /// A user has reset the simulation: a controller with a memory should clear it.
    pub reset: bool,
}

impl LivePage {
    /// Starts a server of a page for simulations of this model, its clones and edits. The page
    /// shows the initial state until the first [`exchange`](Self::exchange).
    ///
    /// # Errors
    ///
    /// [`Error::Serve`] if the address is not one of this machine or in use, or if there is no
    /// thread or no random number. [`Error::NoSuchName`] for a camera that the model does not have,
    /// and the errors of [`Data::new`] and [`Data::forward`].
    pub fn bind(model: impl IntoModel, options: &LiveOptions) -> Result<Self> {
        let mut data = Data::new(model)?;
        data.forward()?;
        let model = data.model().clone();
        let ranges: Vec<Option<[f64; 2]>> = (0..model.nu())
            .map(|index| (model.actuator_ctrllimited()[index] != 0).then(|| model.actuator_ctrlrange()[index]))
            .collect();
        let sliders: Vec<Slider<'_>> = model
            .actuators()
            .zip(&ranges)
            .map(|(actuator, range)| Slider { name: actuator.name(), range: range.unwrap_or([-1.0, 1.0]) })
            .collect();
        let frames = replay::all(&model);
        let (text, left_out) = html::live(&mut data, &frames, &sliders, &options.page)?;

        let failed = |source| Error::Serve { address: options.address.clone(), source };
        let mut token = [0; 16];
        SysRng.try_fill_bytes(&mut token).map_err(|error| failed(std::io::Error::other(error)))?;
        let token = format!("{:032x}", u128::from_ne_bytes(token));
        let listener = TcpListener::bind(&options.address).map_err(failed)?;
        let site = Arc::new(Site {
            page: connecting(&text),
            gate: Gate { token: token.clone(), hosts: options.hosts.clone() },
            limits: Limits {
                bodies: model.nbody(),
                controls: ranges.iter().map(|range| range.unwrap_or(Limits::UNLIMITED)).collect(),
            },
            slots: Slots::new(model.nu()),
            most: options.clients,
            browsers: AtomicUsize::new(0),
        });
        let server = Server::start(listener, site.clone()).map_err(failed)?;
        let url = format!("http://{}/{token}", server::reachable(server.address()));
        let page = Self {
            hand: Hand::new(&data)?,
            held: vec![None; model.nu()],
            requests: Requests::new(model.nu()),
            is_paused: false,
            steps: 0,
            problem: None,
            start: Vec::new(),
            state: Vec::new(),
            model,
            site,
            server,
            url,
            left_out,
            frames,
        };
        page.site.slots.publish(|bytes| {
            // So that no later state allocates.
            bytes.reserve_exact(16 + 28 * page.frames.len() + 5 * page.held.len() + LONGEST_PROBLEM);
            page.write(&data, None, bytes);
        });
        Ok(page)
    }

    /// Returns the address of the page, with its token. Anyone who has it can control the
    /// simulation.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Returns the address of the server.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Returns descriptions of what the page does not draw.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// Returns the number of connected browsers.
    pub fn browsers(&self) -> usize {
        self.site.browsers.load(Ordering::Acquire)
    }

    /// Returns `true` while the simulation is paused.
    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// Pauses or resumes the simulation, as a user does.
    pub fn set_paused(&mut self, paused: bool) {
        self.is_paused = paused;
    }

    /// Shows the state of the simulation, and carries out the users' requests. Call it before each
    /// step. It never waits for a browser, and does not allocate after the first call, unless the
    /// simulation fails.
    ///
    /// - A reset restores the state of the first call.
    /// - A held control has the user's value from this call on; call this after the controller.
    /// - A pull adds to [`xfrc_applied`](Data::xfrc_applied) until the next call. It sets the pose
    ///   of a mocap body, and of a free body while paused.
    ///
    /// The poses are those of the last step, as [`Data::step`] leaves them. If the data is
    /// unusable, the page shows the error, and the user can reset the simulation.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for data of another model.
    pub fn exchange(&mut self, data: &mut Data) -> Result<Tick> {
        if !self.model.is_same_structure(data.model()) {
            return Err(Error::OtherModel { what: "the data of a live page" });
        }
        if self.start.is_empty() {
            self.start = data.state(StateSpec::INTEGRATION);
        }
        let mut reset = false;
        let mut result = Ok(());
        if self.site.slots.take(&mut self.requests) {
            reset = self.requests.reset;
            result = self.carry_out(data);
            self.requests.clear();
        }
        let mut usable = result.and_then(|()| data.check_usable());
        if usable.is_ok() && self.hand.is_pulling() {
            usable = self.pull(data);
        }
        self.hold(data);
        let is_fine = usable.is_ok() && self.problem.is_none();
        let advance = is_fine && (!self.is_paused || self.steps > 0);
        self.steps = if advance && self.is_paused { self.steps - 1 } else { 0 };
        if self.site.slots.is_wanted() {
            let refreshed = usable.and_then(|()| hand::refresh(data, &mut self.state));
            let text = refreshed.err().map(|error| error.to_string());
            let problem = text.as_deref().or(self.problem.as_deref());
            self.site.slots.publish(|bytes| self.write(data, problem, bytes));
        }
        Ok(Tick { advance, reset })
    }

    /// Carries out the requests, except pulls.
    fn carry_out(&mut self, data: &mut Data) -> Result<()> {
        if self.requests.reset {
            self.let_go(data);
            self.problem = None;
            data.reset()?;
            data.set_state(StateSpec::INTEGRATION, &self.start)?;
            data.forward_between_steps(&mut self.state)?;
        }
        self.is_paused = self.requests.pause.unwrap_or(self.is_paused);
        self.steps = self.steps.saturating_add(self.requests.steps);
        for (held, request) in self.held.iter_mut().zip(&self.requests.controls) {
            match request {
                Some(Setting::Held(value)) => *held = Some(*value),
                Some(Setting::Released) => *held = None,
                None => {}
            }
        }
        match self.requests.pull {
            Some(Grip::Held(pull)) => {
                hand::refresh(data, &mut self.state)?;
                self.hand.pull(data, pull)
            }
            Some(Grip::Released) => {
                self.hand.let_go(data);
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Applies the pull for the next step, or moves the body while paused.
    fn pull(&mut self, data: &mut Data) -> Result<()> {
        hand::refresh(data, &mut self.state)?;
        if !self.is_paused || self.steps > 0 {
            return self.hand.apply(data);
        }
        if self.hand.drag(data)? { data.forward_between_steps(&mut self.state) } else { Ok(()) }
    }

    /// Sets the held controls.
    fn hold(&self, data: &mut Data) {
        for (ctrl, held) in data.ctrl_mut().iter_mut().zip(&self.held) {
            *ctrl = held.unwrap_or(*ctrl);
        }
    }

    /// Ends a pull, removes its force, and releases the held controls, which keep their values.
    /// Call it before a simulation continues without the page.
    ///
    /// # Panics
    ///
    /// If a pull is active and the data belongs to another model.
    pub fn let_go(&mut self, data: &mut Data) {
        self.hand.let_go(data);
        self.held.fill(None);
    }

    /// Makes a tick of a simulation: exchanges with the browsers, and unless the simulation is
    /// paused, calls the controller, sets the held controls and makes a step. Returns `true` if it
    /// has made a step.
    ///
    /// # Errors
    ///
    /// As for [`exchange`](Self::exchange), those of the controller, and those of [`Data::step`].
    pub fn step(&mut self, data: &mut Data, controller: &mut impl Controller) -> Result<bool> {
        let tick = self.exchange(data)?;
        if tick.advance {
            controller.control(data)?;
            self.hold(data);
            data.step()?;
        }
        Ok(tick.advance)
    }

    /// Runs a simulation in real time for this duration of the wall clock, without an end for
    /// [`Duration::MAX`]. If the simulation cannot keep up, it is slower than real time.
    ///
    /// If the controller or a step fails, the page shows the error, and the simulation stops until
    /// a user resets it. Pulls and held controls last beyond the end: see [`let_go`](Self::let_go).
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for data of another model. The error of the controller or the step, if
    /// there is one at the end.
    pub fn run_for(&mut self, duration: Duration, data: &mut Data, controller: &mut impl Controller) -> Result<()> {
        let end = Instant::now().checked_add(duration);
        // Times of the wall clock and of the simulation.
        let mut origin = (Instant::now(), data.time());
        let mut failure = None;
        while end.is_none_or(|end| Instant::now() < end) {
            let was_failed = self.problem.is_some();
            match self.step(data, controller) {
                Ok(false) => {
                    self.site.slots.wait(PAUSED_TICK);
                    origin = (Instant::now(), data.time());
                }
                Ok(true) => {
                    let simulated = Duration::try_from_secs_f64(data.time() - origin.1).unwrap_or_default();
                    let (real, now) = (origin.0.elapsed(), Instant::now());
                    match simulated.checked_sub(real) {
                        Some(early) => std::thread::sleep(early.min(LARGEST_DELAY)),
                        None if real.saturating_sub(simulated) > LARGEST_DELAY => origin = (now, data.time()),
                        None => {}
                    }
                }
                Err(error @ Error::OtherModel { .. }) => return Err(error),
                Err(error) => {
                    log::warn!("the simulation of a live page stops: {error}");
                    self.problem = Some(error.to_string());
                    failure = Some(error);
                }
            }
            if was_failed && self.problem.is_none() {
                failure = None;
            }
        }
        failure.map_or(Ok(()), Err)
    }

    /// Waits until a user makes a request, or the timeout passes. For loops of programs while the
    /// simulation is paused.
    pub fn wait(&self, timeout: Duration) {
        self.site.slots.wait(timeout);
    }

    /// Writes a state: the time, flags, the poses, the controls, which of them are held, and the
    /// text of a problem. `html/src/live.js` reads it.
    fn write(&self, data: &Data, problem: Option<&str>, bytes: &mut Vec<u8>) {
        bytes.clear();
        bytes.extend_from_slice(&data.time().to_le_bytes());
        bytes.extend_from_slice(&u32::from(self.is_paused).to_le_bytes());
        for &frame in &self.frames {
            let pose = replay::pose(data, frame);
            for number in pose.pos.iter().chain(&pose.quat) {
                bytes.extend_from_slice(&(*number as f32).to_le_bytes());
            }
        }
        for &ctrl in data.ctrl() {
            bytes.extend_from_slice(&(ctrl as f32).to_le_bytes());
        }
        bytes.extend(self.held.iter().map(|held| u8::from(held.is_some())));
        let problem = problem.unwrap_or_default();
        let end = (0..=LONGEST_PROBLEM).rev().find(|&at| problem.is_char_boundary(at)).unwrap_or(0);
        bytes.extend_from_slice(&problem.as_bytes()[..end]);
    }
}

impl fmt::Debug for LivePage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Without the token.
        f.debug_struct("LivePage")
            .field("address", &self.address())
            .field("browsers", &self.browsers())
            .field("is_paused", &self.is_paused)
            .finish_non_exhaustive()
    }
}

/// Returns a page that may connect to its own server. Its empty icon keeps browsers from a request
/// for one.
fn connecting(page: &str) -> Vec<u8> {
    let mut page = page.to_owned();
    for (before, after) in [
        ("default-src 'none';", "default-src 'none'; connect-src 'self'; img-src data:;"),
        ("<title>", "<link rel=\"icon\" href=\"data:,\">\n<title>"),
    ] {
        assert!(page.contains(before), "Bug: page.html has no {before}");
        page = page.replacen(before, after, 1);
    }
    page.into_bytes()
}
