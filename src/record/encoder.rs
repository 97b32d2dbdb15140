//! Common interface and tools of the encoders: changed regions and frame delays.

use crate::error::Result;

/// Writes images of constant size: RGB, rows from top to bottom.
pub(super) trait Encoder: Send {
    /// Encodes an image that is shown for `frames` frames, at least one.
    fn write(&mut self, rgb: &[u8], frames: u64) -> Result<()>;

    /// Completes the file and moves it to its final path.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// Rectangular region of an image, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Rectangle {
    /// Returns the bounding rectangle of all pixels for which `differs` returns `true`, or one
    /// pixel if there are none.
    pub(super) fn bounding(width: usize, height: usize, differs: impl Fn(usize) -> bool) -> Self {
        let (mut left, mut right, mut top, mut bottom) = (width, 0, height, 0);
        for row in 0..height {
            let differs = |column: &usize| differs(row * width + column);
            let Some(first) = (0..width).find(differs) else { continue };
            let last = (first..width).rev().find(differs).unwrap_or(first);
            (left, right) = (left.min(first), right.max(last));
            (top, bottom) = (top.min(row), row);
        }
        if left == width {
            return Self { left: 0, top: 0, width: 1, height: 1 };
        }
        Self { left, top, width: right - left + 1, height: bottom - top + 1 }
    }

    /// Iterates over the rows of the region, as index ranges into the pixels of an image of this
    /// width.
    pub(super) fn rows(self, image_width: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
        (self.top..self.top + self.height).map(move |row| {
            let start = row * image_width + self.left;
            start..start + self.width
        })
    }
}

/// Converts frame counts to the time unit of a file format, such as hundredths of a second. The
/// rounding error of each delay is carried over to the next.
#[derive(Debug)]
pub(super) struct Delays {
    ticks_per_frame: f64,
    frames: u64,
    ticks: u64,
}

impl Delays {
    pub(super) fn new(ticks_per_second: f64, frames_per_second: f64) -> Self {
        Self { ticks_per_frame: ticks_per_second / frames_per_second, frames: 0, ticks: 0 }
    }

    /// Returns the delay for `frames` more frames, in ticks, split into parts that fit into 16
    /// bits.
    pub(super) fn next(&mut self, frames: u64) -> impl Iterator<Item = u16> + use<> {
        self.frames += frames;
        let until = (self.frames as f64 * self.ticks_per_frame).round() as u64;
        let mut left = until - self.ticks;
        self.ticks = until;
        std::iter::from_fn(move || {
            let part = u16::try_from(left).unwrap_or(u16::MAX);
            left -= u64::from(part);
            (part > 0).then_some(part)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Delays, Rectangle};

    #[test]
    fn a_rectangle_bounds_all_changed_pixels() {
        let bounding = |changed: &[usize]| {
            let Rectangle { left, top, width, height } = Rectangle::bounding(4, 3, |pixel| changed.contains(&pixel));
            [left, top, width, height]
        };
        assert_eq!(bounding(&[]), [0, 0, 1, 1]);
        assert_eq!(bounding(&[6]), [2, 1, 1, 1]);
        assert_eq!(bounding(&[1, 11]), [1, 0, 3, 3]);
        assert_eq!(bounding(&[0, 3, 8]), [0, 0, 4, 3]);
        let rows: Vec<_> = Rectangle::bounding(4, 3, |pixel| [5, 10].contains(&pixel)).rows(4).collect();
        assert_eq!(rows, [5..7, 9..11]);
    }

    #[test]
    fn rounded_delays_sum_to_the_exact_duration() {
        let mut delays = Delays::new(100.0, 30.0);
        let parts: Vec<u16> = (0..300).flat_map(|_| delays.next(1)).collect();
        assert_eq!(parts.iter().map(|&part| u32::from(part)).sum::<u32>(), 1000);
        assert!(parts.iter().all(|part| (3..=4).contains(part)));
        assert_eq!(delays.next(30_000).collect::<Vec<_>>(), [u16::MAX, 34_465]);
    }
}
