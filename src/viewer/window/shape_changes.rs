//! Comparison of the shapes of two passes of the panels, and selection of the shapes in parts of
//! the window.

use egui::Rect;
use egui::epaint::ClippedShape;

use super::pixel_rect::PixelRect;

/// Distance by which anti-aliasing and the rounding of positions move the edge of a shape, pixels.
const MARGIN: f32 = 2.0;

/// Returns rectangles, in points, that contain all differences between the shapes of two passes.
pub(super) fn changed_rects(old: &[ClippedShape], new: &[ClippedShape]) -> Vec<Rect> {
    if old.len() == new.len() {
        let changed = old.iter().zip(new).filter(|(old, new)| old != new);
        return changed
            .flat_map(|(old, new)| [visible_rect(old), visible_rect(new)])
            .filter(Rect::is_positive)
            .collect();
    }
    let head = old.iter().zip(new).take_while(|(old, new)| old == new).count();
    let (old, new) = (&old[head..], &new[head..]);
    let tail = old.iter().rev().zip(new.iter().rev()).take_while(|(old, new)| old == new).count();
    let changed = old[..old.len() - tail].iter().chain(&new[..new.len() - tail]);
    changed.map(visible_rect).filter(Rect::is_positive).collect()
}

/// Returns the rectangle that contains the visible part of a shape, points.
fn visible_rect(shape: &ClippedShape) -> Rect {
    (shape.transform_after_tessellation * shape.shape.visual_bounding_rect()).expand(MARGIN).intersect(shape.clip_rect)
}

/// Returns the pixels of a window that a rectangle in points may cover.
pub(super) fn covered_pixels(rect: Rect, scale: f32, window: [u32; 2]) -> PixelRect {
    let start = [rect.min.x, rect.min.y].map(|part| (part * scale - MARGIN).floor() as u32);
    let end = [rect.max.x, rect.max.y].map(|part| (part * scale + MARGIN).ceil() as u32);
    PixelRect::between(start, [0, 1].map(|axis| end[axis].min(window[axis])))
}

/// Returns the shapes that are visible in parts of the window, clipped to these parts.
pub(super) fn clip(shapes: &[ClippedShape], parts: &[PixelRect], scale: f32) -> Vec<ClippedShape> {
    let corner = |pixels: [u32; 2]| egui::pos2(pixels[0] as f32 / scale, pixels[1] as f32 / scale);
    let mut clipped = Vec::new();
    for part in parts {
        let part = Rect::from_min_max(corner(part.origin), corner(part.end()));
        for shape in shapes.iter().filter(|shape| visible_rect(shape).intersects(part)) {
            clipped.push(ClippedShape { clip_rect: shape.clip_rect.intersect(part), ..shape.clone() });
        }
    }
    clipped
}

#[cfg(test)]
mod tests {
    use egui::{Color32, CornerRadius, Shape, pos2};

    use super::*;

    const CLIP: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(100.0, 100.0) };

    fn square(x: f32, color: Color32) -> ClippedShape {
        let rect = Rect::from_min_max(pos2(x, 10.0), pos2(x + 10.0, 20.0));
        let shape = Shape::rect_filled(rect, CornerRadius::ZERO, color);
        ClippedShape::new(CLIP, shape)
    }

    fn is_covered(rects: &[Rect], x: f32) -> bool {
        rects.iter().any(|rect| rect.contains(pos2(x, 15.0)))
    }

    #[test]
    fn changed_rects_contain_the_changed_shapes_only() {
        let old = [square(0.0, Color32::RED), square(40.0, Color32::RED), square(80.0, Color32::RED)];
        assert!(changed_rects(&old, &old).is_empty());
        let mut new = old.clone();
        new[1] = square(45.0, Color32::RED);
        let changed = changed_rects(&old, &new);
        assert!(is_covered(&changed, 41.0) && is_covered(&changed, 54.0), "the old and the new place");
        assert!(!is_covered(&changed, 5.0) && !is_covered(&changed, 85.0));

        // A shape is added between two others, and removed again.
        let two = [old[0].clone(), old[2].clone()];
        for changed in [changed_rects(&two, &old), changed_rects(&old, &two)] {
            assert!(is_covered(&changed, 45.0) && !is_covered(&changed, 5.0) && !is_covered(&changed, 85.0));
        }
        // A shape outside its clip rectangle is invisible.
        assert!(changed_rects(&two, &[two.as_slice(), &[square(200.0, Color32::RED)]].concat()).is_empty());
    }

    #[test]
    fn shapes_are_clipped_to_the_parts_in_which_they_are_visible() {
        let shapes = [square(0.0, Color32::RED), square(40.0, Color32::RED), square(80.0, Color32::RED)];
        let parts = [PixelRect::between([0, 0], [20, 40]), PixelRect::between([84, 0], [200, 40])];
        let clipped = clip(&shapes, &parts, 2.0);
        let shown: Vec<(Rect, Rect)> =
            clipped.iter().map(|shape| (shape.shape.visual_bounding_rect(), shape.clip_rect)).collect();
        let rect = |left, top, right, bottom| Rect::from_min_max(pos2(left, top), pos2(right, bottom));
        let squares = shapes.map(|shape| shape.shape.visual_bounding_rect());
        let right = rect(42.0, 0.0, 100.0, 20.0);
        assert_eq!(shown, [(squares[0], rect(0.0, 0.0, 10.0, 20.0)), (squares[1], right), (squares[2], right)]);
    }

    #[test]
    fn covered_pixels_are_in_the_window() {
        let rect = Rect::from_min_max(pos2(10.2, -5.0), pos2(20.1, 500.0));
        let covered = covered_pixels(rect, 2.0, [64, 48]);
        assert_eq!(covered, PixelRect::between([18, 0], [43, 48]));
        assert_eq!(covered_pixels(Rect::EVERYTHING, 1.5, [64, 48]), PixelRect::between([0, 0], [64, 48]));
        assert!(covered_pixels(Rect::NOTHING, 1.0, [64, 48]).is_empty());
    }
}
