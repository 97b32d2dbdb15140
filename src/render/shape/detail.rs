//! Into how many parts a shape is cut.

use crate::model::Model;

/// Into how many parts shapes are cut. More are rounder, and slower to draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Detail {
    /// Around the axis of a round shape: at least 3.
    pub(crate) slices: u32,
    /// Along it: at least 2.
    pub(crate) stacks: u32,
    /// Along each edge of a flat shape: at least 1.
    pub(crate) quads: u32,
}

impl Detail {
    /// Beyond so many parts nobody sees the difference: the edges of 256 slices are within 0.0001 radii of the circle.
    pub(crate) const MOST: u32 = 256;

    /// Numbers that are brought into range.
    pub(crate) fn new(slices: usize, stacks: usize, quads: usize) -> Self {
        let clamp = |count: usize, least: u32| (count.min(Self::MOST as usize) as u32).max(least);
        Self { slices: clamp(slices, 3), stacks: clamp(stacks, 2), quads: clamp(quads, 1) }
    }

    /// That which the model asks for in `visual/quality`. The engine's compiler takes any number there.
    pub(crate) fn of_model(model: &Model) -> Self {
        let quality = model.visual().quality;
        Self::new(quality.numslices, quality.numstacks, quality.numquads)
    }

    /// That with at most so many slices, for a shape that is small in the picture. Its other parts shrink with them.
    pub(crate) fn with_slices(self, slices: u32) -> Self {
        let slices = slices.clamp(3, self.slices);
        let shrunk = |count: u32| (u64::from(count) * u64::from(slices)).div_ceil(u64::from(self.slices)) as usize;
        Self::new(slices as usize, shrunk(self.stacks), shrunk(self.quads))
    }

    /// The farthest that the edges of a round shape are from the shape, in radii, for each of the directions that it is cut
    /// in: `1 - cos(π / slices)`. On a sphere, which is cut in two directions, the two add up.
    pub(crate) fn chord_error(parts_of_a_circle: u32) -> f64 {
        1.0 - (std::f64::consts::PI / f64::from(parts_of_a_circle)).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::Detail;

    #[test]
    fn any_number_is_brought_into_range() {
        assert_eq!(Detail::new(0, 0, 0), Detail { slices: 3, stacks: 2, quads: 1 });
        let most = Detail::MOST;
        assert_eq!(Detail::new(usize::MAX, 1 << 32, 1000), Detail { slices: most, stacks: most, quads: most });
        assert_eq!(Detail::new(28, 16, 4), Detail { slices: 28, stacks: 16, quads: 4 });
    }

    #[test]
    fn fewer_slices_mean_fewer_parts_everywhere_and_more_are_not_made_up() {
        let detail = Detail::new(28, 16, 4);
        assert_eq!(detail.with_slices(14), Detail { slices: 14, stacks: 8, quads: 2 });
        assert_eq!(detail.with_slices(0), Detail { slices: 3, stacks: 2, quads: 1 });
        assert_eq!(detail.with_slices(100), detail);
    }

    #[test]
    fn the_most_parts_are_as_round_as_promised() {
        assert!(Detail::chord_error(Detail::MOST) < 1e-4);
    }
}
