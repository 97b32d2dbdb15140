//! Pages of running simulations: states, requests, refused connections and slow browsers.
//! `scripts/try-html` tests the page in browsers.

#![cfg(feature = "live")]
#![forbid(unsafe_code)]

mod browser;
mod pages_for_browsers;
mod pulls;
mod refused;
mod requests;
mod run;
mod several;
mod slow;
#[path = "../common/soft.rs"]
mod soft;
