//! A window to look at a simulation, and to work on it while it runs.

#![forbid(unsafe_code)]
