//! Line plots in SVG.

use std::io;
use std::ops::Range;

use plotters::prelude::*;

/// Factor of the image. Plotters rounds coordinates to whole pixels, so plots are drawn large.
const SCALE: u32 = 3;
/// Size before the factor.
const SIZE: [u32; 2] = [520, 210];
/// Number of intervals of which a long curve shows the least and the greatest value.
const INTERVALS: usize = 500;
/// Greatest magnitude of a plotted value.
const LARGEST: f64 = 1e100;
/// Least length of an axis relative to its values, so that ticks differ in spite of rounding.
const SHORTEST: f64 = 1e-9;

/// Curve of a plot. Points that are not finite interrupt it.
pub(super) struct Curve {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) color: [u8; 3],
    pub(super) width: u32,
}

/// Returns a plot as an SVG element, given the labels of the axes.
pub(super) fn plot([x, y]: [&str; 2], curves: &[Curve]) -> io::Result<String> {
    let mut svg = String::new();
    draw(&mut svg, [x, y], curves).map_err(|error| io::Error::other(error.to_string()))?;
    Ok(svg)
}

fn draw(svg: &mut String, [x, y]: [&str; 2], curves: &[Curve]) -> Result<(), DrawingAreaErrorKind<io::Error>> {
    let curves: Vec<(Vec<[f64; 2]>, &Curve)> = curves.iter().map(|curve| (reduced(&curve.points), curve)).collect();
    let all =
        || curves.iter().flat_map(|(points, _)| points).filter(|point| point[0].is_finite() && point[1].is_finite());
    let [horizontal, vertical] = [0, 1].map(|axis| range(all().map(|point| point[axis]), [0.0, 0.05][axis]));
    let [x_length, y_length] = [&horizontal, &vertical].map(|range| range.end - range.start);
    let root = SVGBackend::with_string(svg, (SCALE * SIZE[0], SCALE * SIZE[1])).into_drawing_area();
    let style = |size: u32| ("sans-serif", SCALE * size).into_font().color(&RGBColor(40, 44, 52));
    let mut chart = ChartBuilder::on(&root)
        .margin(SCALE * 8)
        .x_label_area_size(SCALE * 34)
        .y_label_area_size(SCALE * 62)
        .build_cartesian_2d(horizontal, vertical)?;
    chart
        .configure_mesh()
        .x_desc(x)
        .y_desc(y)
        .axis_desc_style(style(13))
        .label_style(style(12))
        .axis_style(RGBColor(120, 120, 120).stroke_width(SCALE))
        .bold_line_style(RGBColor(226, 228, 232).stroke_width(SCALE))
        .light_line_style(TRANSPARENT)
        .x_labels(7)
        .y_labels(6)
        .x_label_formatter(&|value| label(*value, x_length))
        .y_label_formatter(&|value| label(*value, y_length))
        .draw()?;
    for (points, Curve { color: [red, green, blue], width, .. }) in &curves {
        let style = RGBColor(*red, *green, *blue).stroke_width(SCALE * width / 2);
        for run in points.split(|[x, y]| !(x.is_finite() && y.is_finite())) {
            chart.draw_series(LineSeries::new(run.iter().map(|&[x, y]| (x, y)), style))?;
        }
    }
    root.present()
}

/// Returns a number on an axis of a length as a short text.
fn label(value: f64, length: f64) -> String {
    let size = value.abs();
    if size < 1e-6 * length {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = (2.0 - length.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if digits == 0 { text } else { text.trim_end_matches('0').trim_end_matches('.').to_owned() }
}

/// Returns the points of a curve that differ in the plot: of each of many intervals the least and
/// the greatest, and whether there are gaps.
fn reduced(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let limited = |value: f64| if value.is_finite() { value.clamp(-LARGEST, LARGEST) } else { f64::NAN };
    let points: Vec<[f64; 2]> = points.iter().map(|point| point.map(limited)).collect();
    if points.len() <= 4 * INTERVALS {
        return points;
    }
    let length = points.len().div_ceil(INTERVALS);
    let mut result = Vec::new();
    for part in points.chunks(length) {
        if let Some(gap) = part.iter().find(|point| !point[1].is_finite()) {
            result.push(*gap);
        }
        let finite = || part.iter().filter(|point| point[1].is_finite());
        let by_value = |one: &&[f64; 2], other: &&[f64; 2]| one[1].total_cmp(&other[1]);
        if let (Some(least), Some(greatest)) = (finite().min_by(by_value), finite().max_by(by_value)) {
            let mut ends = [*least, *greatest];
            ends.sort_by(|one, other| one[0].total_cmp(&other[0]));
            result.extend(ends);
        }
    }
    result
}

/// Returns the range of values, which is long enough for ticks, with a margin relative to it.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let widen = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], widen);
    if low > high {
        return 0.0..1.0;
    }
    let least = SHORTEST * low.abs().max(high.abs());
    let length = high - low;
    let by = if length > least {
        margin * length
    } else if least > 0.0 {
        least
    } else {
        1.0
    };
    low - by..high + by
}
