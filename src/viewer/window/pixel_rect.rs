//! Rectangles of pixels.

/// Rectangle of pixels of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PixelRect {
    /// Upper left corner.
    pub origin: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

impl PixelRect {
    /// Returns the rectangle between two corners. It is empty unless `end` exceeds `start` in both
    /// coordinates.
    pub fn between(start: [u32; 2], end: [u32; 2]) -> Self {
        Self { origin: start, size: [0, 1].map(|axis| end[axis].saturating_sub(start[axis])) }
    }

    /// Returns the lower right corner.
    pub fn end(self) -> [u32; 2] {
        [0, 1].map(|axis| self.origin[axis] + self.size[axis])
    }

    pub fn is_empty(self) -> bool {
        self.size.contains(&0)
    }

    /// Returns the number of pixels.
    #[cfg(feature = "_test-hooks")]
    pub fn pixels(self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    pub fn intersection(self, other: Self) -> Self {
        let [end, other_end] = [self.end(), other.end()];
        Self::between(
            [0, 1].map(|axis| self.origin[axis].max(other.origin[axis])),
            [0, 1].map(|axis| end[axis].min(other_end[axis])),
        )
    }

    /// Returns the smallest rectangle that contains both.
    pub fn union(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        }
        if other.is_empty() {
            return self;
        }
        let [end, other_end] = [self.end(), other.end()];
        Self::between(
            [0, 1].map(|axis| self.origin[axis].min(other.origin[axis])),
            [0, 1].map(|axis| end[axis].max(other_end[axis])),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::PixelRect;

    /// Returns the pixels of a rectangle in a window of 6 × 6 pixels.
    fn pixels(rect: PixelRect) -> Vec<[u32; 2]> {
        let all = (0..36).map(|index| [index % 6, index / 6]);
        all.filter(|pixel| [0, 1].iter().all(|&axis| (rect.origin[axis]..rect.end()[axis]).contains(&pixel[axis])))
            .collect()
    }

    #[test]
    fn intersection_and_union_contain_the_pixels_of_the_definition() {
        let rects = [[0, 0, 6, 6], [1, 2, 3, 4], [3, 0, 5, 3], [4, 4, 6, 6], [2, 2, 2, 5]]
            .map(|[left, top, right, bottom]| PixelRect::between([left, top], [right, bottom]));
        for (one, other) in rects.iter().flat_map(|one| rects.map(|other| (*one, other))) {
            let both: Vec<_> = pixels(one).into_iter().filter(|pixel| pixels(other).contains(pixel)).collect();
            assert_eq!(pixels(one.intersection(other)), both);
            assert_eq!(one.intersection(other).is_empty(), both.is_empty());
            let union = pixels(one.union(other));
            let any: Vec<_> = pixels(one).into_iter().chain(pixels(other)).collect();
            assert!(any.iter().all(|pixel| union.contains(pixel)));
            for axis in [0, 1] {
                let range = |pixels: &[[u32; 2]]| {
                    (pixels.iter().map(|pixel| pixel[axis]).min(), pixels.iter().map(|pixel| pixel[axis]).max())
                };
                assert_eq!(range(&union), range(&any), "{one:?} {other:?}");
            }
        }
    }
}
