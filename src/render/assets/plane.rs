//! Grids of the model's planes.
//!
//! The engine evaluates lighting at the vertices of a plane, so the edge of a spot light follows
//! the grid. The grid lines here are the engine's.

use crate::render::Lighting;
use crate::render::settings::{VisualSettings, is_drawable};
use crate::shape;

/// Maximum number of cells of a plane along each axis; infinite planes have this many. Equal to the
/// engine's limit.
const MAX_CELLS: u32 = 200;

/// Maximum number of cells with per-pixel lighting, sufficient for the precision of depth.
const PER_PIXEL_CELLS: u32 = 64;

/// Plane of the model.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) shape: u32,
    /// Half-lengths in x and y, m; of an infinite plane those that are rendered.
    pub(crate) half: [f32; 2],
}

/// Extent and grid of a plane along x or y.
#[derive(Debug)]
pub(crate) struct Axis {
    /// Half-length, m.
    pub(crate) half: f32,
    /// Grid lines from -1 to 1, relative to the half-length.
    pub(crate) lines: Vec<f32>,
}

impl Axis {
    /// Returns the grid of a plane that is finite along this axis: an even number of cells of twice
    /// the spacing, and a cell at each end for the rest.
    pub(crate) fn finite(half: f64, spacing: f64) -> Self {
        let half = half.min(f64::MAX);
        // `clamp` would keep NaN.
        let spacing = spacing.max(half / f64::from(MAX_CELLS - 2)).min(half);
        let inner = (half / spacing) as u32 / 2 * 2;
        let border = half - f64::from(inner) * spacing;
        let first_inner = border / half - 1.0;
        let inner = (0..=inner).map(|line| first_inner + 2.0 * f64::from(line) * (spacing / half));
        let mut lines: Vec<f32> =
            std::iter::once(-1.0).chain(inner).chain([1.0]).map(|line| line.clamp(-1.0, 1.0) as f32).collect();
        // Border cells of no width.
        lines.dedup();
        Self { half: half as f32, lines }
    }

    /// Returns the grid of a plane that is infinite along this axis: it ends beyond the skybox by
    /// two texture periods. `repeat` is the number of texture periods per two metres; 0 without a
    /// texture.
    pub(crate) fn infinite(settings: &VisualSettings, repeat: f32) -> Self {
        let sky = 2.1 * settings.far;
        let is_repeated = repeat > 0.0 && repeat.is_finite();
        let period = if is_repeated { 2.0 / f64::from(repeat) } else { sky / f64::from(MAX_CELLS - 2) };
        let half = (0.5 * (sky + 2.0 * period)) as f32;
        Self { half: if is_drawable(half) { half } else { 0.0 }, lines: shape::uniform_lines(MAX_CELLS) }
    }

    /// Limits the number of cells for per-pixel lighting, which does not depend on the grid.
    pub(crate) fn limited(self, lighting: Lighting) -> Self {
        if lighting == Lighting::PerVertex || self.lines.len() as u32 <= PER_PIXEL_CELLS + 1 {
            return self;
        }
        Self { lines: shape::uniform_lines(PER_PIXEL_CELLS), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::{Axis, MAX_CELLS};

    /// Returns the widths of the cells, m, without the ones that vanish by rounding.
    fn widths(half: f64, spacing: f64) -> Vec<f64> {
        let lines = Axis::finite(half, spacing).lines;
        lines.windows(2).map(|pair| f64::from(pair[1] - pair[0]) * half).filter(|width| *width > 1e-6).collect()
    }

    fn assert_close(widths: &[f64], expected: &[f64]) {
        assert_eq!(widths.len(), expected.len(), "{widths:?}");
        assert!(widths.iter().zip(expected).all(|(width, expected)| (width - expected).abs() < 1e-6), "{widths:?}");
    }

    /// The cells were counted in images of the engine's renderer, seen from above in wireframe
    /// mode.
    #[test]
    fn a_finite_plane_has_the_cells_of_the_engine() {
        assert_close(&widths(2.0, 0.1), &[0.2; 20]);
        assert_close(&widths(3.0, 0.1), &[0.2; 30]);
        let mut expected = vec![0.1];
        expected.extend([0.2; 14]);
        expected.push(0.1);
        assert_close(&widths(1.5, 0.1), &expected);
    }

    #[test]
    fn lines_of_any_size_and_spacing_ascend_from_minus_one_to_one() {
        let sizes = [f64::MIN_POSITIVE, 1e-9, 0.03, 1.0, 7.7, 1e30, f64::MAX, f64::INFINITY];
        let spacings = [-1.0, 0.0, 1e-12, 0.1, 0.3, 5.0, f64::INFINITY, f64::NAN];
        for (half, spacing) in sizes.iter().flat_map(|half| spacings.map(|spacing| (*half, spacing))) {
            let lines = Axis::finite(half, spacing).lines;
            assert!(lines.is_sorted(), "{half}, {spacing}: {lines:?}");
            assert_eq!((lines.first(), lines.last()), (Some(&-1.0), Some(&1.0)), "{half}, {spacing}");
            assert!((3..=MAX_CELLS as usize + 1).contains(&lines.len()), "{half}, {spacing}: {}", lines.len());
        }
    }
}
