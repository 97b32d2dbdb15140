//! Code shared by the examples: command line, charts, the viewer window, plans in the viewer, a
//! balancing humanoid, a quadruped, the cost of standing, and parts of scenes.

#![allow(dead_code, reason = "each example uses a part of it")]

pub mod axis;
pub mod balance;
pub mod chart;
pub mod command_line;
pub mod live_plan;
pub mod parts;
pub mod quadruped;
pub mod standing;
pub mod window;
