//! Line charts in SVG.

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::FontFamily;

/// Drawing area of a chart.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(226, 228, 232);

/// Scale factor. Plotters rounds coordinates to whole pixels, so charts are drawn large to keep
/// curves smooth.
const SCALE: u32 = 3;
const WIDTH: u32 = 760;
const LEGEND: u32 = 150;

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
}

/// Pair of axes with its lines.
pub struct Panel<'a> {
    title: &'a str,
    /// Names of the horizontal and the vertical axis.
    axes: [&'a str; 2],
    lines: Vec<Line>,
    /// Minimum range of the vertical axis.
    at_least: Option<(f64, f64)>,
}

impl<'a> Panel<'a> {
    pub fn new(title: &'a str, axes: [&'a str; 2], lines: Vec<Line>) -> Self {
        Self { title, axes, lines, at_least: None }
    }

    /// Sets the minimum range of the vertical axis.
    pub fn at_least(self, low: f64, high: f64) -> Self {
        Self { at_least: Some((low, high)), ..self }
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
    let margin = 0.06 * (high - low);
    let mut chart: ChartContext<'_, _, Cartesian2d<RangedCoordf64, RangedCoordf64>> = ChartBuilder::on(area)
        .caption(panel.title, font(16))
        .margin(scaled(10))
        .margin_right(scaled(LEGEND))
        .x_label_area_size(scaled(40))
        .y_label_area_size(scaled(64))
        .build_cartesian_2d(x_low..x_high, low - margin..high + margin)?;
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
        .x_label_formatter(&|value| short(*value))
        .y_label_formatter(&|value| short(*value))
        .draw()?;
    for line in &panel.lines {
        let style = line.color.stroke_width(scaled(2) * 3 / 4);
        let points = line.points.iter().copied();
        if line.dashed {
            chart.draw_series(DashedLineSeries::new(points, scaled(7), scaled(5), style))?;
        } else {
            chart.draw_series(LineSeries::new(points, style))?;
        }
    }
    legend(area, &panel.lines)
}

/// Draws the legend to the right of the chart.
fn legend(area: &Area<'_>, lines: &[Line]) -> Result<(), Box<dyn Error>> {
    let left = area.dim_in_pixel().0 as i32 - scaled(LEGEND - 12) as i32;
    for (index, line) in lines.iter().filter(|line| !line.label.is_empty()).enumerate() {
        let middle = scaled(48 + 22 * index as u32) as i32;
        let style = line.color.stroke_width(scaled(2));
        area.draw(&PathElement::new([(left, middle), (left + scaled(18) as i32, middle)], style))?;
        area.draw(&Text::new(line.label.clone(), (left + scaled(24) as i32, middle - scaled(7) as i32), font(13)))?;
    }
    Ok(())
}

/// Formats an axis label.
fn short(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    // Adding zero turns a negative zero into zero.
    (rounded + 0.0).to_string()
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
