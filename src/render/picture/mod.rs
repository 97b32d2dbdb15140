//! Pictures: arrays of pixels, and PNG files of them.
//!
//! | file | what is in it |
//! |---|---|
//! | `rgb.rs` | [`Picture`]: what an eye sees |
//! | `depth.rs` | [`DepthPicture`]: how far away everything is |
//! | `segmentation.rs` | [`SegmentationPicture`]: which thing is where |
//! | `png.rs` | files of them |
//!
//! All of them are row-major from the top: the pixel in column `x` of row `y` is at `y * width + x`, both counted from 0.

mod depth;
mod png;
mod rgb;
mod segmentation;

pub use self::depth::DepthPicture;
pub use self::rgb::Picture;
pub use self::segmentation::{Segment, SegmentationPicture};
use crate::error::{Error, Result};

/// The number of pixels of a picture of this size, if it can be counted.
fn area(width: usize, height: usize) -> Option<usize> {
    // Sizes of a PNG file, and of textures, are 32 bits; bytes are counted too, of which there are up to eight for a pixel.
    let is_size = |length| u32::try_from(length).is_ok();
    let area = width
        .checked_mul(height)
        .filter(|&area| area.checked_mul(8).is_some_and(|bytes| isize::try_from(bytes).is_ok()))?;
    (is_size(width) && is_size(height)).then_some(area)
}

/// A check that there are so many numbers for each pixel.
fn check(what: &'static str, [width, height]: [usize; 2], each: usize, found: usize) -> Result<()> {
    let Some(area) = area(width, height) else {
        return Err(Error::invalid(
            "the size of a picture",
            format!("{width} x {height} pixels"),
            "one that fits into memory",
        ));
    };
    Error::check_length(what, found, each * area)
}

/// Where a pixel is.
#[track_caller]
fn index([width, height]: [usize; 2], x: usize, y: usize) -> usize {
    assert!(x < width && y < height, "there is no pixel ({x}, {y}) in a picture of {width} x {height} pixels");
    y * width + x
}
