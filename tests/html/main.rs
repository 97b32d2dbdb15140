//! HTML pages of trajectories: contents, precision, sizes and safety. `scripts/try-html` tests them
//! in browsers.

#![cfg(feature = "html")]

mod contents;
mod deformables;
mod page;
mod pages_for_browsers;
mod poses;
mod sizes;
#[path = "../common/soft.rs"]
mod soft;
mod texts;
