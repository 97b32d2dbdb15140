//! Drawing of a plot: title with the unit, names of the curves, axes with ticks, and lines.

use egui::{Color32, Label, Rangef, Rect, Response, RichText, Sense, Stroke, StrokeKind, Ui};
use egui_plot::{
    AxisHints, FilledArea, GridInput, GridMark, HoverPosition, Line, LineStyle, Plot as EguiPlot, PlotPoints, Points,
};

use super::curve::{Band, Curve};
use super::curves::Plot;
use super::style;

/// Maximum number of curves in a plot. More curves could not be distinguished.
const MAX_CURVES: usize = 16;
/// Width of the lines, points.
const LINE_WIDTH: f32 = 1.5;
/// Opacity of the ranges between the values of a curve.
const BAND_OPACITY: f32 = 0.6;
/// Minimum distances of the ticks of the time and of the values, points.
const TICK_SPACING: [f64; 2] = [64.0, 24.0];
/// Labels are shown at all ticks.
const LABEL_SPACING: Rangef = Rangef { min: 1.0, max: 2.0 };
/// Width of the labels of the values, points.
const VALUES_WIDTH: f32 = 38.0;

/// Shows a plot over simulated time in the available width. Returns `true` if the user clicks on
/// the button that shows it in a window, which is absent in a window.
pub(super) fn show(ui: &mut Ui, plot: &mut Plot, height: f32, is_window: bool) -> bool {
    let clicked = show_legend(ui, plot, is_window);
    let (width, grid) = (ui.available_width(), ui.visuals().weak_text_color().gamma_multiply(0.25));
    let (unit, is_log, is_over_iterations) = (plot.unit, plot.is_log, plot.is_over_iterations);
    let colors: Vec<Color32> = (0..MAX_CURVES).map(|index| style::curve_color(ui, index)).collect();
    let shown = || plot.curves.iter().filter(|curve| curve.is_found).take(MAX_CURVES).enumerate();
    let times = shown()
        .filter_map(|(_, curve)| curve.times())
        .reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])]);
    let [from, to] = times.unwrap_or([0.0; 2]);
    // A column of the lines is a point wide.
    let column = ((to - from) / f64::from((width - VALUES_WIDTH).max(1.0))).max(1e-9);
    EguiPlot::new("plot")
        .height(height)
        .width(width)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .show_background(false)
        .show_crosshair(false)
        .grid_color(grid)
        .grid_spacing(Rangef::new(1.0, 30.0))
        .set_margin_fraction(egui::vec2(0.0, 0.08))
        .x_grid_spacer(move |input| marks(&input, TICK_SPACING[0], if is_over_iterations { 1.0 } else { 0.0 }))
        .y_grid_spacer(move |input| marks(&input, TICK_SPACING[1], if is_log { 1.0 } else { 0.0 }))
        .custom_x_axes(vec![AxisHints::new_x().label_spacing(LABEL_SPACING).formatter(move |mark, _| {
            let number = number_text(mark.value, mark.step_size);
            if is_over_iterations { number } else { format!("{number} s") }
        })])
        .custom_y_axes(vec![AxisHints::new_y().min_thickness(VALUES_WIDTH).label_spacing(LABEL_SPACING).formatter(
            move |mark, range| {
                // A label at the lower end would touch the label of the first time.
                let margin = 0.06 * (range.end() - range.start());
                let is_apart = mark.value >= range.start() + margin;
                if is_apart { value_text(mark.value, mark.step_size, is_log) } else { String::new() }
            },
        )])
        .label_formatter(move |position| Some(pointer_text(position, unit, is_log, is_over_iterations)))
        .show(ui, |plot_ui| {
            // No band covers a line.
            for (index, curve) in shown().filter(|(_, curve)| !curve.is_hidden) {
                let color = colors[index].gamma_multiply(BAND_OPACITY);
                plot_ui.add(
                    area(&curve.bands(f64::from(LINE_WIDTH) * column), [from, to])
                        .fill_color(color)
                        .id((index, "bands"))
                        .allow_hover(false),
                );
            }
            for (index, curve) in shown().filter(|(_, curve)| !curve.is_hidden) {
                for (part, points) in curve.parts(column).into_iter().enumerate() {
                    if is_over_iterations {
                        // A single iteration is visible too.
                        let dots = Points::new(curve.name.clone(), PlotPoints::from(points.clone()));
                        plot_ui.points(dots.id((index, part, "dots")).color(colors[index]).radius(2.0));
                    }
                    let line = Line::new(curve.name.clone(), PlotPoints::from(points))
                        .id((index, part))
                        .color(colors[index])
                        .width(LINE_WIDTH)
                        // A band becomes thinner where a curve is steep.
                        .allow_band(false)
                        .style(if index < style::CURVE_COLORS { LineStyle::Solid } else { LineStyle::dashed_dense() });
                    plot_ui.line(line);
                }
            }
        });
    clicked
}

/// Returns the area of bands between two times. It has no height beside the bands.
fn area(bands: &[Band], [from, to]: [f64; 2]) -> FilledArea {
    let (mut times, mut lows, mut highs) = (Vec::new(), Vec::new(), Vec::new());
    for &Band { times: ends, range: [low, high] } in bands {
        let [start, end] = ends.map(|time| time.max(from).min(to));
        times.extend([start, start, end, end]);
        lows.extend([low; 4]);
        highs.extend([low, high, high, low]);
    }
    FilledArea::new("", &times, &lows, &highs)
}

/// Shows the title, the unit and the names of the curves. A click on a name hides or shows the
/// curve.
fn show_legend(ui: &mut Ui, plot: &mut Plot, is_window: bool) -> bool {
    let mut clicked = false;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(7.0, 1.0);
        if !is_window {
            clicked = window_button(ui).on_hover_text("shows this plot in a window").clicked();
            ui.label(RichText::new(&*plot.title).strong());
        }
        if !plot.unit.is_empty() {
            ui.label(RichText::new(plot.unit).weak());
        }
        let mut curves = plot.curves.iter_mut().filter(|curve| curve.is_found);
        for (index, curve) in curves.by_ref().take(MAX_CURVES).enumerate() {
            if show_name(ui, curve, index).clicked() {
                curve.is_hidden = !curve.is_hidden;
            }
        }
        let more = curves.count();
        if more > 0 {
            ui.label(RichText::new(format!("and {more} more")).small().weak());
        }
    });
    clicked
}

fn show_name(ui: &mut Ui, curve: &Curve, index: usize) -> Response {
    let text = RichText::new(curve.short_name()).small();
    let text = if curve.is_hidden { text.weak().strikethrough() } else { text.color(style::curve_color(ui, index)) };
    let label = ui.add(Label::new(text).sense(Sense::click()).selectable(false));
    if !curve.is_hidden && index >= style::CURVE_COLORS {
        // The line of the curve is dashed too.
        let (y, color) = (label.rect.bottom(), style::curve_color(ui, index));
        let line = [egui::pos2(label.rect.left(), y), egui::pos2(label.rect.right(), y)];
        ui.painter().extend(egui::Shape::dashed_line(&line, Stroke::new(1.0, color), 4.0, 2.5));
    }
    label.on_hover_text(format!("{}: a click {} it", curve.name, if curve.is_hidden { "shows" } else { "hides" }))
}

/// Shows a button with the picture of a window.
fn window_button(ui: &mut Ui) -> Response {
    let side = ui.spacing().interact_size.y - 4.0;
    let (rect, response) = ui.allocate_exact_size(egui::Vec2::splat(side), Sense::click());
    let stroke = Stroke::new(1.0, ui.style().interact(&response).fg_stroke.color.gamma_multiply(0.7));
    let frame = rect.shrink(1.5);
    ui.painter().rect_stroke(frame, 1.0, stroke, StrokeKind::Inside);
    let title = Rect::from_min_max(frame.min, egui::pos2(frame.right(), frame.top() + 3.0));
    ui.painter().rect_filled(title, 0.0, stroke.color);
    response
}

/// Returns the marks of an axis at multiples of 1, 2 or 5 times a power of ten, at least `spacing`
/// points and `min_step` apart.
fn marks(input: &GridInput, spacing: f64, min_step: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let step = nice_step(spacing * input.base_step_size).max(min_step);
    if !(step > 0.0 && step.is_finite()) {
        return Vec::new();
    }
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    // Beyond this range neighbouring multiples are the same number.
    if first.abs().max(last.abs()) > 1e15 || last - first > 100.0 {
        return Vec::new();
    }
    (first as i64..=last as i64).map(|index| GridMark { value: index as f64 * step, step_size: step }).collect()
}

/// Returns the smallest product of 1, 2 or 5 and a power of ten that is not smaller than a number.
fn nice_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].map(|factor| factor * power).into_iter().find(|step| *step >= least).unwrap_or(10.0 * power)
}

fn value_text(value: f64, step: f64, is_log: bool) -> String {
    if is_log { format!("1e{value:.0}") } else { number_text(value, step) }
}

/// Returns a number with the digits that distinguish it from other multiples of a step.
fn number_text(value: f64, step: f64) -> String {
    let size = value.abs().max(step);
    if step >= 1e-4 && size < 1e6 {
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        format!("{:.decimals$}", value + 0.0)
    } else if value == 0.0 {
        "0".to_owned()
    } else {
        let digits = (size.log10().floor() - step.log10().floor()).max(0.0) as usize;
        format!("{value:.digits$e}")
    }
}

/// Returns the text at the pointer: the curve, the time or the iteration, and the value.
fn pointer_text(position: &HoverPosition<'_>, unit: &str, is_log: bool, is_over_iterations: bool) -> String {
    let text = |[x, value]: [f64; 2]| {
        let value = if is_log { format!("{:.3e}", 10_f64.powf(value)) } else { significant(value) };
        let place = if is_over_iterations { format!("iteration {x:.0}") } else { format!("{x:.3} s") };
        format!("{place}\n{value} {unit}").trim_end().to_owned()
    };
    match position {
        HoverPosition::NearDataPoint { plot_name, position, .. } => {
            format!("{plot_name}\n{}", text([position.x, position.y]))
        }
        HoverPosition::Elsewhere { position } => text([position.x, position.y]),
    }
}

/// Returns a number with five significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let power = value.abs().log10().floor();
    if (-4.0..6.0).contains(&power) {
        format!("{value:.*}", (4.0 - power).max(0.0) as usize)
    } else {
        format!("{value:.4e}")
    }
}

#[cfg(test)]
mod tests {
    use egui_plot::GridInput;

    use super::{marks, number_text, significant};

    fn texts(bounds: (f64, f64), height: f64) -> Vec<String> {
        let input = GridInput { bounds, base_step_size: (bounds.1 - bounds.0) / height };
        marks(&input, 24.0, 0.0).into_iter().map(|mark| number_text(mark.value, mark.step_size)).collect()
    }

    #[test]
    fn axes_have_several_round_ticks() {
        assert_eq!(texts((-0.1, 1.1), 100.0), ["0.0", "0.5", "1.0"]);
        assert_eq!(texts((2.31, 2.39), 100.0), ["2.32", "2.34", "2.36", "2.38"]);
        assert_eq!(texts((-30.0, 1200.0), 100.0), ["0", "500", "1000"]);
        assert_eq!(texts((0.0, 5.2e-7), 100.0), ["0", "2e-7", "4e-7"]);
        assert_eq!(texts((0.0, 3.1e9), 100.0), ["0", "1e9", "2e9", "3e9"]);
        for exponent in -12..12 {
            for mantissa in [1.0, 1.7, 3.3, 4.9, 8.0] {
                let size = mantissa * 10_f64.powi(exponent);
                let ticks = texts((-0.3 * size, 0.7 * size), 100.0);
                assert!((2..=5).contains(&ticks.len()), "{size}: {ticks:?}");
                assert!(ticks.iter().all(|tick| tick.len() <= 7), "{size}: {ticks:?}");
            }
        }
    }

    #[test]
    fn axes_of_extreme_ranges_have_no_ticks() {
        assert!(texts((f64::NAN, 1.0), 100.0).is_empty());
        assert!(texts((0.0, 0.0), 100.0).is_empty());
        assert!(texts((1e300, 1e300 * (1.0 + 1e-15)), 100.0).is_empty());
    }

    #[test]
    fn values_have_five_significant_digits() {
        let numbers = [0.0, 1.0, -0.012_345_678, 123_456.789, 1_234_567.0, 1.5e-7];
        assert_eq!(numbers.map(significant), ["0", "1.0000", "-0.012346", "123457", "1.2346e6", "1.5000e-7"]);
    }
}
