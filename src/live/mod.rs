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
//! # Several simulations
//!
//! [`LivePage::exchange_batch`] shows a [`Batch`](crate::Batch), and [`LivePage::set_ghosts`]
//! further states beside a simulation. The page draws one in full and the others as ghosts, side by
//! side, or not at all. [`LiveOptions::ghosts`] limits their number and so the size of a state.
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
//! A state is copied only if a browser waits for one, at most 125 times per second for all browsers
//! together. The simulation never waits for a browser: there is one slot for the latest state and
//! one for merged requests, and no queue. If a browser is copying a slot, the simulation goes on,
//! and uses the slot in a later tick. A tick does not allocate, except for skins, flexes and
//! tendons. `cargo bench --features live --bench live` compares with a step without a page.
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
//! not shown. Ghosts have no skins, flexes and tendons.
//!
//! Requires the feature `live`.

mod batch;
mod hand;
mod http;
mod message;
mod options;
mod server;
mod slots;
mod state;
mod tick;

use std::fmt;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rand::TryRng;
use rand::rngs::SysRng;

use self::hand::Hand;
use self::http::Gate;
use self::message::Limits;
pub use self::options::LiveOptions;
use self::server::Site;
use self::slots::{Requests, Slots};
use self::state::StateWriter;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::html::{self, Live};
use crate::matrix::Matrix;
use crate::model::IntoModel;

/// Largest number of ghosts, so that the page of a browser remains small.
const MOST_GHOSTS: usize = 1000;

/// Page that shows a running simulation in browsers. See the [module](self).
///
/// The server and its threads end when the page is dropped.
pub struct LivePage {
    site: Arc<Site>,
    address: SocketAddr,
    /// Ends when the page is dropped.
    server: Option<JoinHandle<()>>,
    url: String,
    left_out: Vec<String>,
    states: StateWriter,
    hand: Hand,
    requests: Requests,
    is_paused: bool,
    /// Steps to take while paused.
    steps: u32,
    /// Failure of the simulation or its controller.
    problem: Option<String>,
    /// States that a reset restores, from the first tick: a row for each simulation.
    start: Matrix,
    /// Time of the last state.
    published: Instant,
    /// Buffer for a state.
    buffer: Vec<f64>,
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
    /// [`Error::Invalid`] for options beyond their limits, and the errors of [`Data::new`] and
    /// [`Data::forward`].
    pub fn bind(model: impl IntoModel, options: &LiveOptions) -> Result<Self> {
        let (ghosts, expected) = (options.ghosts, format_args!("at most {MOST_GHOSTS}"));
        Error::check_range(ghosts <= MOST_GHOSTS, "LiveOptions::ghosts", ghosts, expected)?;
        let mut data = Data::new(model)?;
        data.forward()?;
        let model = data.model().clone();
        let ranges: Vec<Option<[f64; 2]>> = (0..model.nu())
            .map(|index| (model.actuator_ctrllimited()[index] != 0).then(|| model.actuator_ctrlrange()[index]))
            .collect();
        let names = model.actuators().map(|actuator| actuator.name());
        let sliders: Vec<_> = names.zip(ranges.iter().map(|range| range.unwrap_or([-1.0, 1.0]))).collect();
        let live = Live { sliders: &sliders, ghosts };
        let (text, left_out, sampler) = html::live(&mut data, live, &options.page)?;
        let mut states = StateWriter::new(Data::new(&model)?, sampler, ghosts);
        states.collect(&mut data, true)?;

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
            slots: Slots::new(model.nu(), states.smallest()),
            most: options.clients,
            browsers: AtomicUsize::new(0),
        });
        let hand = Hand::new(&data)?;
        let address = listener.local_addr().map_err(failed)?;
        let server = server::start(listener, site.clone()).map_err(failed)?;
        let mut page = Self {
            states,
            hand,
            requests: Requests::new(model.nu()),
            is_paused: false,
            steps: 0,
            problem: None,
            start: Matrix::default(),
            published: Instant::now(),
            buffer: Vec::new(),
            site,
            address,
            server: Some(server),
            url: format!("http://{}/{token}", server::reachable(address)),
            left_out,
        };
        page.publish(0, None);
        Ok(page)
    }

    /// Returns the address of the page, with its token. Anyone who has it can control the
    /// simulation.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Returns the address of the server.
    pub fn address(&self) -> SocketAddr {
        self.address
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
}

impl Drop for LivePage {
    fn drop(&mut self) {
        self.site.slots.close();
        // Ends the wait for a connection. If the connection fails, others are waiting.
        let _ = TcpStream::connect_timeout(&server::reachable(self.address), Duration::from_secs(1));
        let _ = self.server.take().map(JoinHandle::join);
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
    let policy = "default-src 'none'; connect-src 'self'; img-src data:;";
    let page = page.replacen("default-src 'none';", policy, 1);
    page.replacen("<title>", "<link rel=\"icon\" href=\"data:,\">\n<title>", 1).into_bytes()
}
