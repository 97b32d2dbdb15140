//! Looks and motion of recorded trajectories, for the files that other programs show.

mod look;
mod motion;
mod names;
mod texture;
mod view;

pub(crate) use self::look::{Geom, Look, Shape, Surface, report};
pub(crate) use self::motion::{Frame, all, pose, poses, records};
pub(crate) use self::names::{decoration, label};
pub(crate) use self::texture::{Texture, TextureMap};
pub(crate) use self::view::{CameraLook, Light};
