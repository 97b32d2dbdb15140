//! States to go back to.
