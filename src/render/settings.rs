//! What of the model's visual settings pictures are drawn with.

use crate::model::Model;

/// Numbers beyond this are nowhere: their squares are still numbers in single precision.
pub(crate) const FARTHEST: f32 = 1e15;

/// Whether a number is one that can be drawn with.
pub(crate) fn is_drawable(number: f32) -> bool {
    number.abs() <= FARTHEST
}

/// What of the model's visual settings pictures are drawn with. The engine's compiler takes any number there.
#[derive(Debug, Clone)]
pub(crate) struct Settings {
    /// Half the width of what a directional light casts shadows on, m.
    pub(crate) shadow_clip: f64,
    /// Share of a spot light's cone in which it casts shadows.
    pub(crate) shadow_scale: f64,
    /// Where fog begins and where it hides everything, m.
    pub(crate) fog: [f32; 2],
    pub(crate) fog_color: [f32; 4],
    pub(crate) haze_color: [f32; 4],
    /// Share of the way to the horizon that haze covers.
    pub(crate) haze: f32,
    /// Width of the edges of a wire frame, pixels.
    pub(crate) line_width: f32,
    /// The far side of the model's own frustum, m.
    pub(crate) far: f64,
}

impl Settings {
    pub(crate) fn new(model: &Model) -> Self {
        let visual = model.visual();
        let extent = model.statistics().extent;
        let map = visual.map;
        let metres = |share: f32| {
            let metres = f64::from(share) * extent;
            if is_drawable(metres as f32) { metres } else { 0.0 }
        };
        let color = |rgba: [f32; 4]| rgba.map(|number| if number.is_finite() { number.clamp(0.0, 1.0) } else { 0.0 });
        let share = |number: f32| if number.is_finite() { number.clamp(0.0, 1.0) } else { 0.0 };
        Self {
            shadow_clip: metres(map.shadowclip),
            shadow_scale: f64::from(map.shadowscale),
            fog: [metres(map.fogstart) as f32, metres(map.fogend) as f32],
            fog_color: color(visual.rgba.fog),
            haze_color: color(visual.rgba.haze),
            haze: share(map.haze),
            line_width: if visual.global.linewidth.is_finite() {
                visual.global.linewidth.clamp(0.1, 100.0)
            } else {
                1.0
            },
            far: metres(map.zfar),
        }
    }
}
