//! From where a picture is drawn, and in which light.
//!
//! | file | what is in it |
//! |---|---|
//! | `matrix.rs` | matrices of four by four |
//! | `eye.rs` | the frustum |
//! | `light.rs` | lights, and from where they cast shadows |
//! | `uniform.rs` | all of it as the graphics card reads it |

mod eye;
mod light;
pub(crate) mod matrix;
mod uniform;

pub(crate) use self::eye::Eye;
pub(crate) use self::light::{Lamp, LightKind, Lights, MOST_SHADOWS};
pub(crate) use self::uniform::{Uniform, View, Window};
