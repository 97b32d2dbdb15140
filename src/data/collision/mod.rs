//! Geometry between geoms: contacts, distances and rays.

mod contact;
mod distance;
mod flex_ray;
mod ray;

pub use self::contact::{Contact, ContactForce, ContactSide, NewContact};
// For the analytic linearisation, which is that of 2.2.2.
pub use self::distance::GeomDistance;
#[cfg_attr(engine_since = "2.3.0", allow(unused_imports))]
pub(crate) use self::distance::{CollisionFunction, FoundContact};
pub use self::flex_ray::{FlexHit, FlexRayOptions};
pub use self::ray::{RayHit, RayOptions};
