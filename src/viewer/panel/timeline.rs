//! Timeline at the bottom of the window: the history of the simulation, or the records of a
//! trajectory.
//!
//! It takes no keyboard focus, so that keys act on the simulation after a click.

use egui::{Align2, Area, ComboBox, Context, CornerRadius, Id, Order, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui};

use super::{PanelContext, style};
use crate::viewer::link::{PlaybackRequest, SimulationRequest, Snapshot, Timeline};
use crate::viewer::view::View;

/// Height of the timeline, points.
pub(super) const HEIGHT: f32 = 34.0;
/// Height of the smallest window with a timeline, points.
const MIN_WINDOW: f32 = 300.0;
/// Margin at the ends, points.
const MARGIN: f32 = 12.0;
/// Width of the time beside the track and of the choice of the trajectory, points.
const TIME_WIDTH: f32 = 118.0;
const CHOICE_WIDTH: f32 = 130.0;
/// Height of the track, points.
const TRACK: f32 = 4.0;
/// Smallest distance of two labels, points.
const TICK_DISTANCE: f32 = 64.0;

/// Returns the height of the timeline in a window of this height, in points: zero without one. The
/// simulation of a program has no history.
pub fn timeline_height(view: &View, snapshot: &Snapshot, window: f32) -> f32 {
    if view.timeline && !snapshot.modes.is_empty() && window >= MIN_WINDOW { HEIGHT } else { 0.0 }
}

/// Shows the timeline below the panels and the scene.
pub(super) fn show(context: &Context, cx: &mut PanelContext<'_>) {
    let window = context.viewport_rect();
    if timeline_height(cx.view, cx.snapshot, window.height()) == 0.0 {
        return;
    }
    let bar = Rect::from_min_max(egui::pos2(window.left(), window.bottom() - HEIGHT), window.max);
    let area =
        Area::new(Id::unique("timeline")).fixed_pos(bar.min).constrain_to(window).constrain(false).order(Order::Middle);
    area.show(context, |ui| {
        ui.allocate_rect(bar, Sense::hover());
        let (mut left, right) = (bar.left() + MARGIN, bar.right() - MARGIN - TIME_WIDTH);
        if cx.snapshot.trajectories.len() > 1 {
            let place = Rect::from_min_size(egui::pos2(left, bar.top() + 6.0), egui::vec2(CHOICE_WIDTH, HEIGHT - 6.0));
            ui.scope_builder(egui::UiBuilder::new().max_rect(place), |ui| choose_trajectory(ui, cx));
            left += CHOICE_WIDTH + MARGIN;
        }
        let track = Rect::from_min_max(egui::pos2(left, bar.top()), egui::pos2(right.max(left + 1.0), bar.bottom()));
        track_of(ui, cx, track);
    });
}

fn choose_trajectory(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let names = cx.snapshot.trajectories.clone();
    let Some(playback) = cx.snapshot.playback else { return };
    let present = cx.predicted.trajectory(cx.snapshot).unwrap_or(playback.trajectory);
    let text = names.get(present).map_or("", String::as_str);
    let mut chosen = present;
    ComboBox::from_id_salt("trajectory").width(CHOICE_WIDTH - 8.0).truncate().selected_text(text).show_ui(ui, |ui| {
        for (index, name) in names.iter().enumerate() {
            ui.selectable_value(&mut chosen, index, name);
        }
    });
    if chosen != present {
        cx.send(PlaybackRequest::SetTrajectory(chosen));
    }
}

/// Shows the track with its marks, and the time of the current state.
fn track_of(ui: &mut Ui, cx: &mut PanelContext<'_>, bar: Rect) {
    let (snapshot, timeline) = (cx.snapshot, &cx.snapshot.timeline);
    let is_trajectory = snapshot.playback.is_some();
    let index = match snapshot.playback {
        Some(playback) => cx.predicted.record(snapshot).unwrap_or(playback.frame),
        None => cx.predicted.history_position(snapshot),
    };
    // Not `Sense::click_and_drag`, which takes the keyboard focus.
    let response = ui.interact(bar, Id::unique("track"), Sense::CLICK | Sense::DRAG);
    let x = |position: f64| bar.left() + position as f32 * bar.width();
    let position = |pointer: Pos2| f64::from((pointer.x - bar.left()) / bar.width()).clamp(0.0, 1.0);
    let track = Rect::from_x_y_ranges(bar.x_range(), bar.top() + 8.0..=bar.top() + 8.0 + TRACK);
    let present = x(timeline.position(index));
    let painter = ui.painter();
    let (visuals, font) = (ui.visuals(), TextStyle::Small.resolve(ui.style()));
    let (rail, weak) = (visuals.widgets.inactive.bg_fill, visuals.weak_text_color());
    let rounding = CornerRadius::same(2);
    painter.rect_filled(track, rounding, rail);
    painter.rect_filled(Rect::from_x_y_ranges(track.left()..=present, track.y_range()), rounding, style::accent(ui));

    let interval = tick_interval(timeline.duration(), bar.width());
    let mut free = bar.left() - TICK_DISTANCE;
    for tick in timeline.ticks(interval) {
        let at = x(tick.position);
        painter.vline(at, track.bottom() + 2.0..=track.bottom() + 5.0, Stroke::new(1.0, weak));
        if at - free >= TICK_DISTANCE {
            let label = painter.layout_no_wrap(seconds(tick.time, interval), font.clone(), weak);
            // The first label stays in the window.
            let left = (at - label.size().x / 2.0).max(bar.left() - MARGIN);
            painter.galley(egui::pos2(left, track.bottom() + 5.0), label, weak);
            free = at;
        }
    }
    for reset in timeline.resets() {
        painter.vline(x(reset.position), track.expand(3.0).y_range(), Stroke::new(1.5, style::warning(ui)));
    }
    for key in snapshot.captured.iter() {
        if let Some(at) = timeline.find(key.time) {
            let top = egui::pos2(x(at), track.top() - 1.0);
            let corners = vec![top, top + egui::vec2(-4.0, -6.0), top + egui::vec2(4.0, -6.0)];
            painter.add(Shape::convex_polygon(corners, style::accent(ui), Stroke::NONE));
        }
    }
    painter.circle_filled(egui::pos2(present, track.center().y), 5.0, visuals.strong_text_color());
    let time = format!("{:.3} s", snapshot.time);
    let place = egui::pos2(bar.right() + MARGIN, track.center().y);
    painter.text(place, Align2::LEFT_CENTER, time, TextStyle::Monospace.resolve(ui.style()), visuals.text_color());

    let pointer = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked());
    if let Some(pointer) = pointer.filter(|_| timeline.len() > 1) {
        let wanted = timeline.index(position(pointer));
        if wanted != index {
            if is_trajectory {
                cx.send(PlaybackRequest::SetFrame(wanted));
            } else {
                cx.send(SimulationRequest::Scrub(wanted));
            }
        }
    } else if let Some(pointer) = response.hover_pos() {
        let text = hover_text(snapshot, timeline, position(pointer));
        response.on_hover_text_at_pointer(text);
    }
}

fn hover_text(snapshot: &Snapshot, timeline: &Timeline, position: f64) -> String {
    let near = |other: f64| (other - position).abs() < 0.005;
    let key = snapshot.captured.iter().find(|key| timeline.find(key.time).is_some_and(near));
    match (timeline.time(position), key) {
        (_, Some(key)) => format!("{}: {:.3} s", key.name, key.time),
        (Some(_), None) if timeline.resets().any(|reset| near(reset.position)) => "reset".to_owned(),
        (Some(time), None) => format!("{time:.3} s"),
        (None, None) => "the states so far, after the first step".to_owned(),
    }
}

/// Returns the interval of the ticks on a track of this width, in points: 1, 2 or 5 times a power
/// of ten, s.
fn tick_interval(duration: f64, width: f32) -> f64 {
    let wanted = duration * f64::from(TICK_DISTANCE) / f64::from(width.max(1.0));
    if !(wanted > 0.0 && wanted.is_finite()) {
        return 1.0;
    }
    let power = 10.0_f64.powf(wanted.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|interval| *interval >= wanted)
        .unwrap_or(wanted)
}

/// Formats a multiple of an interval, with its unit.
fn seconds(time: f64, interval: f64) -> String {
    let decimals = (-interval.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{time:.decimals$} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tick_intervals_are_round_and_leave_space_for_labels() {
        let intervals = [0.0, 0.03, 1.0, 7.0, 40.0, f64::INFINITY].map(|duration| tick_interval(duration, 640.0));
        assert_eq!(intervals, [1.0, 0.005, 0.1, 1.0, 5.0, 1.0]);
        assert_eq!(["0.005 s", "0.1 s", "2 s"], [[0.005, 0.005], [0.1, 0.1], [2.0, 1.0]].map(|[a, b]| seconds(a, b)));
    }
}
