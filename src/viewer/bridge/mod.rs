//! The physics' side: requests done, snapshots made.
