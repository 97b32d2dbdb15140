//! What writes pictures to a file.

use crate::error::Result;

/// Writes pictures of one size, rows from the top, RGB.
pub(super) trait Encoder: Send {
    /// A picture, and for how many frames it is shown: at least one.
    fn picture(&mut self, rgb: &[u8], shown: u64) -> Result<()>;

    /// Completes the file, which only then is there.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// A part of a picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Rectangle {
    /// The smallest that has all pixels in it for which `differs` holds; one pixel if there are none.
    pub(super) fn of_changes(width: usize, height: usize, differs: impl Fn(usize) -> bool) -> Self {
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

    /// Where its rows are, as pixels of a picture of this width.
    pub(super) fn rows(self, picture_width: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
        (self.top..self.top + self.height).map(move |row| {
            let start = row * picture_width + self.left;
            start..start + self.width
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Rectangle;

    #[test]
    fn a_rectangle_is_the_smallest_around_what_changed() {
        let around = |changed: &[usize]| {
            let Rectangle { left, top, width, height } = Rectangle::of_changes(4, 3, |pixel| changed.contains(&pixel));
            [left, top, width, height]
        };
        assert_eq!(around(&[]), [0, 0, 1, 1]);
        assert_eq!(around(&[6]), [2, 1, 1, 1]);
        assert_eq!(around(&[1, 11]), [1, 0, 3, 3]);
        assert_eq!(around(&[0, 3, 8]), [0, 0, 4, 3]);
        let rows: Vec<_> = Rectangle::of_changes(4, 3, |pixel| [5, 10].contains(&pixel)).rows(4).collect();
        assert_eq!(rows, [5..7, 9..11]);
    }
}
