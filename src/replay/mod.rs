//! Looks and motion of recorded trajectories, for the files that other programs show.

mod frame;
mod look;
mod motion;
mod texture;
mod texture_map;
mod view;

pub(crate) use self::frame::{Frame, Pose, all, pose};
pub(crate) use self::look::{Geom, Groups, Look, Shape, description, report};
pub(crate) use self::motion::{poses, records};
pub(crate) use self::texture::Texture;
pub(crate) use self::texture_map::TextureMap;
pub(crate) use self::view::{FreeCamera, Frustum, Light};
