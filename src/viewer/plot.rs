//! Numbers over time, for plots.
