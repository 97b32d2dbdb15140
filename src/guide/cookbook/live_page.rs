//! A running simulation in a browser: a viewer over SSH.
//!
#![doc = include_str!("../../live/picture.html")]
//!
//! The program serves a page that shows its simulation. The page pauses, makes single steps,
//! resets, holds controls by sliders and pulls bodies: drag one with Ctrl, or press Pull. Needs the
//! feature `live`, and no display.
//!
#![cfg_attr(feature = "live", doc = "```")]
#![cfg_attr(not(feature = "live"), doc = "```ignore")]
//! use std::time::Duration;
//!
//! use mujoco_safe::html::HtmlOptions;
//! use mujoco_safe::live::{LiveOptions, LivePage};
//! use mujoco_safe::{Data, Lqr, LqrWeights, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//! let mut lqr = Lqr::at_present_state(&mut data, &weights)?;
//!
//! let page = HtmlOptions::default().with_title("Balance");
//! let options = LiveOptions::default().with_address("127.0.0.1:0").with_page(page);
//! let mut page = LivePage::bind(data.model(), &options)?;
//! println!("open {}", page.url());
//! // In real time. Duration::MAX runs without an end.
//! page.run_for(Duration::from_millis(100), &mut data, &mut lqr)?;
//! assert!(data.time() > 0.0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A program with a loop of its own calls [`LivePage::step`](crate::live::LivePage::step) instead
//! of [`Data::step`](crate::Data::step), or [`exchange`](crate::live::LivePage::exchange) before
//! it.
//!
//! [`exchange_batch`](crate::live::LivePage::exchange_batch) shows a whole [`Batch`](crate::Batch):
//! one simulation in full and the others as ghosts, or all side by side. The example `live` does it
//! with `--simulations 64`. [`set_ghosts`](crate::live::LivePage::set_ghosts) shows the plans of a
//! controller.
//!
//! For a program on the machine `robot` with the address `127.0.0.1:8000`, a tunnel leads there:
//!
//! ```text
//! ssh -L 8000:localhost:8000 robot
//! ```
//!
//! The printed address then works on this machine too. It has a random token, without which the
//! server answers nobody. A browser that is slow or does not read costs the simulation nothing: it
//! receives the latest state when it asks for one.
