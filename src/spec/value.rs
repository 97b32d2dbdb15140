//! Values of attributes.

use std::borrow::Cow;
use std::fmt::Debug;

use crate::enums::{CameraMode, Cone, GeomType, Integrator, JacobianStorage, JointType, Solver, TextureType};
use crate::kind::sealed::Sealed;

/// Value of an attribute: text, a number, a flag, an array of numbers, or an enum of the engine.
///
/// Numbers are written with the digits that restore the same value.
pub trait Value: Sealed {
    /// Returns the text of the attribute.
    #[doc(hidden)]
    fn text(&self) -> Cow<'_, str>;
}

impl Value for &str {
    fn text(&self) -> Cow<'_, str> {
        Cow::Borrowed(self)
    }
}

impl Sealed for String {}
impl Value for String {
    fn text(&self) -> Cow<'_, str> {
        Cow::Borrowed(self)
    }
}

impl Sealed for bool {}
impl Value for bool {
    fn text(&self) -> Cow<'_, str> {
        Cow::Borrowed(if *self { "true" } else { "false" })
    }
}

/// Implements [`Value`] for a number and for arrays of it.
macro_rules! numbers {
    ($($number:ty)*) => {
        $(
            impl Value for $number {
                fn text(&self) -> Cow<'_, str> {
                    Cow::Owned(number(self))
                }
            }

            impl Sealed for &[$number] {}
            impl Value for &[$number] {
                fn text(&self) -> Cow<'_, str> {
                    Cow::Owned(self.iter().map(number).collect::<Vec<_>>().join(" "))
                }
            }

            impl<const N: usize> Sealed for [$number; N] {}
            impl<const N: usize> Value for [$number; N] {
                fn text(&self) -> Cow<'_, str> {
                    Cow::Owned((&self[..]).text().into_owned())
                }
            }
        )*
    };
}

impl Sealed for f64 {}
impl Sealed for f32 {}
impl Sealed for i32 {}
impl Sealed for u32 {}
numbers!(f64 f32 i32 u32);

/// Writes a number: integers without a fraction, others with the fewest digits that restore the
/// value.
fn number(value: impl Debug) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// Parses the numbers of an attribute, which are separated by spaces.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split_ascii_whitespace().map(|word| word.parse().ok()).collect()
}

/// Generated pattern of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum TexturePattern {
    /// Gradient from the first colour to the second: downwards in a cube map or a skybox, outwards
    /// in a 2D texture.
    Gradient,
    /// Two by two squares in both colours.
    Checker,
    /// The first colour.
    Flat,
}

/// Frame that a sensor of a frame measures: the cases of [`FrameId`](crate::data::FrameId).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SensorFrame {
    /// Frame of a body, relative to which its joints are defined: `xbody` in MJCF.
    Body,
    /// Inertial frame of a body, at its centre of mass: `body` in MJCF.
    BodyInertia,
    /// Frame of a geom.
    Geom,
    /// Frame of a site.
    Site,
    /// Frame of a camera.
    Camera,
}

/// Implements [`Value`] for an enum by the words of MJCF for its variants.
macro_rules! keywords {
    ($($name:ident { $($variant:ident = $word:literal)* })*) => {
        $(
            impl Sealed for $name {}
            impl Value for $name {
                fn text(&self) -> Cow<'_, str> {
                    Cow::Borrowed(match self {
                        $(Self::$variant => $word,)*
                    })
                }
            }
        )*
    };
}

keywords! {
    GeomType {
        Plane = "plane" HeightField = "hfield" Sphere = "sphere" Capsule = "capsule" Ellipsoid = "ellipsoid" Cylinder = "cylinder"
        Box = "box" Mesh = "mesh" Sdf = "sdf"
    }
    JointType { Free = "free" Ball = "ball" Slide = "slide" Hinge = "hinge" }
    Integrator { Euler = "Euler" Rk4 = "RK4" Implicit = "implicit" ImplicitFast = "implicitfast" Discrete = "discrete" }
    Solver { Pgs = "PGS" Cg = "CG" Newton = "Newton" }
    Cone { Pyramidal = "pyramidal" Elliptic = "elliptic" }
    JacobianStorage { Dense = "dense" Sparse = "sparse" Auto = "auto" }
    CameraMode {
        Fixed = "fixed" Track = "track" TrackCom = "trackcom" TargetBody = "targetbody" TargetBodyCom = "targetbodycom"
    }
    TextureType { Flat = "2d" Cube = "cube" Skybox = "skybox" }
    SensorFrame { Body = "xbody" BodyInertia = "body" Geom = "geom" Site = "site" Camera = "camera" }
    TexturePattern { Gradient = "gradient" Checker = "checker" Flat = "flat" }
}

#[cfg(test)]
mod tests {
    use super::{SensorFrame, Value, number, numbers};

    #[test]
    fn the_frame_of_a_body_is_not_its_inertial_frame() {
        assert_eq!(
            [SensorFrame::Body, SensorFrame::BodyInertia].map(|frame| frame.text().into_owned()),
            ["xbody", "body"]
        );
    }

    #[test]
    fn numbers_restore_their_values() {
        for value in [0.1, -0.0, 1.0, 1e-300, 1.0 / 3.0, 123_456_789.5, 1e22, f64::MAX, f64::MIN_POSITIVE] {
            assert_eq!(number(value).parse::<f64>().unwrap().to_bits(), value.to_bits(), "{value:?}");
        }
        assert_eq!([1.0, 0.5, -2.0].text(), "1 0.5 -2");
        assert_eq!(0.1_f32.text(), "0.1");
        assert_eq!(numbers(" 1 0.5\t-2\n"), Some(vec![1.0, 0.5, -2.0]));
        assert_eq!(numbers("1 a"), None);
    }
}
