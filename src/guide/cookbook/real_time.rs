//! A simulation in real time: a thread with deadlines.
//!
//! The thread owns the simulation. Each step has a deadline on the wall clock, and the thread
//! sleeps until then. A late step moves the deadlines, so the simulation does not hurry afterwards.
//! Commands arrive by a channel, whose end stops the thread.
//!
//! ```
//! use std::sync::mpsc::{self, TryRecvError};
//! use std::thread;
//! use std::time::{Duration, Instant};
//!
//! use mujoco_safe::{Data, Result, sample};
//!
//! fn run(mut data: Data, commands: mpsc::Receiver<f64>) -> Result<(Data, u32)> {
//!     let period = Duration::from_secs_f64(data.model().timestep());
//!     let (mut deadline, mut late) = (Instant::now(), 0);
//!     loop {
//!         match commands.try_recv() {
//!             Ok(force) => data.ctrl_mut()[0] = force,
//!             Err(TryRecvError::Empty) => {}
//!             Err(TryRecvError::Disconnected) => return Ok((data, late)),
//!         }
//!         data.step()?;
//!         deadline += period;
//!         match deadline.checked_duration_since(Instant::now()) {
//!             Some(rest) => thread::sleep(rest),
//!             None => (deadline, late) = (Instant::now(), late + 1),
//!         }
//!     }
//! }
//!
//! let (sender, commands) = mpsc::channel();
//! let start = Instant::now();
//! let data = Data::new(sample::cartpole())?;
//! let thread = thread::spawn(move || run(data, commands));
//! sender.send(0.2).expect("a running thread");
//! thread::sleep(Duration::from_millis(100));
//! drop(sender);
//! let (data, late) = thread.join().expect("no panic")?;
//! println!("{:.2} s of simulation, {late} late steps", data.time());
//! assert!(data.time() <= start.elapsed().as_secs_f64() + data.model().timestep());
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! `sleep` of an ordinary Linux wakes up about 0.1 ms late, which the next deadline makes good. A
//! model with small time steps takes several per period: [`step_n`](crate::Data::step_n). The
//! functions of a control loop do not allocate: see [`performance`](crate::guide::performance). The
//! viewer follows real time by itself.
