//! Line charts in SVG.

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontFamily;

use super::axis::Axis;

/// Drawing area of a chart.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub const INK: RGBColor = RGBColor(40, 44, 52);
pub const GRID: RGBColor = RGBColor(226, 228, 232);

/// Scale factor. Plotters rounds coordinates to whole pixels, so charts are drawn large to keep
/// curves smooth.
const SCALE: u32 = 3;
const WIDTH: u32 = 760;
const LEGEND: u32 = 160;
/// Lengths of a dash and of a gap.
const DASH: [u32; 2] = [7, 5];

/// Palette suitable for colour blindness (Okabe and Ito, 2008).
pub const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(120, 120, 120),
];

/// Line of a chart.
pub struct Line {
    /// Legend entry; empty for none.
    pub label: String,
    pub points: Vec<(f64, f64)>,
    pub color: RGBColor,
    pub dashed: bool,
}

impl Line {
    pub fn new(label: &str, color: RGBColor, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self { label: label.to_owned(), points: points.into_iter().collect(), color, dashed: false }
    }

    pub fn dashed(label: &str, color: RGBColor, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self { dashed: true, ..Self::new(label, color, points) }
    }
}

/// Interval of the horizontal axis in which something happens, or a moment.
#[derive(Clone)]
pub struct Event {
    /// Legend entry.
    pub label: String,
    pub start: f64,
    pub end: f64,
}

impl Event {
    pub fn new(label: &str, start: f64, end: f64) -> Self {
        Self { label: label.to_owned(), start, end }
    }

    pub fn moment(label: &str, at: f64) -> Self {
        Self::new(label, at, at)
    }

    /// Returns the colour: pale behind the lines of an interval.
    fn color(&self) -> RGBColor {
        if self.start < self.end { RGBColor(214, 217, 222) } else { PALETTE[6] }
    }
}

/// Pair of axes with its lines.
pub struct Panel<'a> {
    title: &'a str,
    /// Quantity and unit of the horizontal and the vertical axis, such as `time (s)`.
    axes: [&'a str; 2],
    lines: Vec<Line>,
    events: Vec<Event>,
    /// Minimum range of the vertical axis.
    at_least: Option<(f64, f64)>,
    /// Scales of the axes: the logarithm with base 10 instead of linear.
    logarithmic: [bool; 2],
}

impl<'a> Panel<'a> {
    pub fn new(title: &'a str, axes: [&'a str; 2], lines: Vec<Line>) -> Self {
        Self { title, axes, lines, events: Vec::new(), at_least: None, logarithmic: [false; 2] }
    }

    /// Marks events.
    pub fn events(self, events: impl IntoIterator<Item = Event>) -> Self {
        Self { events: events.into_iter().collect(), ..self }
    }

    /// Sets the minimum range of the vertical axis, which must be linear.
    pub fn at_least(self, low: f64, high: f64) -> Self {
        Self { at_least: Some((low, high)), ..self }
    }

    /// Makes the scale of the horizontal and of the vertical axis logarithmic. The values there
    /// must be positive.
    pub fn logarithmic(self, logarithmic: [bool; 2]) -> Self {
        Self { logarithmic, ..self }
    }
}

/// Draws panels below each other, each `height` units high.
pub fn draw(path: &Path, height: u32, panels: &[Panel<'_>]) -> Result<(), Box<dyn Error>> {
    canvas(path, height * panels.len() as u32, |root| {
        for (area, panel) in root.split_evenly((panels.len(), 1)).iter().zip(panels) {
            draw_panel(area, panel)?;
        }
        Ok(())
    })
}

/// Draws panels to a file in a folder, which is created, and prints the path.
pub fn save(folder: &Path, name: &str, height: u32, panels: &[Panel<'_>]) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let path = folder.join(name);
    draw(&path, height, panels)?;
    println!("wrote {}", path.display());
    Ok(())
}

/// Creates a white image of this height and draws on it.
pub fn canvas(
    path: &Path,
    height: u32,
    draw: impl FnOnce(&Area<'_>) -> Result<(), Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (scaled(WIDTH), scaled(height))).into_drawing_area();
    root.fill(&WHITE)?;
    draw(&root)?;
    root.present().map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Returns the text style for a size.
pub fn font(size: u32) -> TextStyle<'static> {
    (FontFamily::SansSerif, scaled(size)).into_font().color(&INK)
}

/// Converts a length to pixels of the image.
pub fn scaled(length: u32) -> u32 {
    SCALE * length
}

fn draw_panel(area: &Area<'_>, panel: &Panel<'_>) -> Result<(), Box<dyn Error>> {
    let all = || panel.lines.iter().flat_map(|line| &line.points);
    let (x_low, x_high) = range(all().map(|point| point.0));
    let (mut low, mut high) = range(all().map(|point| point.1));
    if let Some((least, most)) = panel.at_least {
        (low, high) = (low.min(least), high.max(most));
    }
    let [x_logarithmic, y_logarithmic] = panel.logarithmic;
    let vertical = Axis::new(low, high, y_logarithmic).with_margin(0.06);
    let [bottom, top] = vertical.ends();
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, font(16))
        .margin(scaled(10))
        .margin_right(scaled(LEGEND))
        .x_label_area_size(scaled(40))
        .y_label_area_size(scaled(64))
        .build_cartesian_2d(Axis::new(x_low, x_high, x_logarithmic).with_round_ends(), vertical)?;
    for event in &panel.events {
        let (left, right) = (event.start, event.end);
        chart.draw_series([Rectangle::new([(left, bottom), (right, top)], event.color().filled())])?;
        let style = event.color().stroke_width(scaled(1));
        chart.draw_series([PathElement::new([(left, bottom), (left, top)], style)])?;
    }
    chart
        .configure_mesh()
        .x_desc(panel.axes[0])
        .y_desc(panel.axes[1])
        .axis_desc_style(font(14))
        .label_style(font(13))
        .axis_style(INK.stroke_width(SCALE))
        .bold_line_style(GRID.stroke_width(SCALE))
        .light_line_style(TRANSPARENT)
        .set_all_tick_mark_size(scaled(4))
        .x_labels(9)
        .y_labels(6)
        .draw()?;
    for line in &panel.lines {
        let style = line.color.stroke_width(scaled(2) * 3 / 4);
        let points = line.points.iter().copied();
        if line.dashed {
            chart.draw_series(DashedLineSeries::new(points, scaled(DASH[0]), scaled(DASH[1]), style))?;
        } else {
            chart.draw_series(LineSeries::new(points, style))?;
        }
    }
    legend(area, panel)
}

/// Draws the legend to the right of the chart: a sample of each line and of each event.
fn legend(area: &Area<'_>, panel: &Panel<'_>) -> Result<(), Box<dyn Error>> {
    let left = area.dim_in_pixel().0 as i32 - scaled(LEGEND - 12) as i32;
    let right = left + scaled(19) as i32;
    let middle = |row: usize| scaled(48 + 22 * row as u32) as i32;
    let write = |label: &str, row: usize| {
        let place = (right + scaled(6) as i32, middle(row) - scaled(7) as i32);
        area.draw(&Text::new(label.to_owned(), place, font(13)))
    };
    let lines: Vec<&Line> = panel.lines.iter().filter(|line| !line.label.is_empty()).collect();
    for (row, line) in lines.iter().enumerate() {
        let style = line.color.stroke_width(scaled(2));
        let half_gap = (scaled(DASH[1]) / 2) as i32;
        let half = i32::midpoint(left, right);
        let dashes =
            if line.dashed { vec![(left, half - half_gap), (half + half_gap, right)] } else { vec![(left, right)] };
        for (start, end) in dashes {
            area.draw(&PathElement::new([(start, middle(row)), (end, middle(row))], style))?;
        }
        write(&line.label, row)?;
    }
    for (row, event) in (lines.len()..).zip(&panel.events) {
        let (top, bottom) = (middle(row) - scaled(7) as i32, middle(row) + scaled(7) as i32);
        // A moment is a line.
        let half = i32::midpoint(left, right);
        let [start, end] = if event.start < event.end { [left, right] } else { [half, half + scaled(1) as i32] };
        area.draw(&Rectangle::new([(start, top), (end, bottom)], event.color().filled()))?;
        write(&event.label, row)?;
    }
    Ok(())
}

/// Returns the range of the finite values, never empty.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let widen = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    let (low, high) = values.filter(|value| value.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), widen);
    if low < high {
        (low, high)
    } else if low.is_finite() {
        (low - 1.0, high + 1.0)
    } else {
        (0.0, 1.0)
    }
}
