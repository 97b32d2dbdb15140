//! How the frame of what a body carries lies to the body's own.

/// Whether a frame coincides with one of its body's, so that the engine need not compute it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SameFrame {
    /// It is a frame of its own.
    Neither,
    /// It is the body's own frame.
    Body,
    /// It is the body's inertial frame.
    Inertia,
}

impl SameFrame {
    /// The meaning of a byte that loading has validated.
    pub(super) fn of_field(raw: u8) -> Self {
        match raw {
            0 => Self::Neither,
            1 => Self::Body,
            2 => Self::Inertia,
            other => panic!("Bug: a model with sameframe {other}"),
        }
    }
}
