//! Chart of the ratios of run times: a bar for each comparison, in groups of equal tasks.

use std::error::Error;
use std::path::Path;

use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::axis::Axis;
use crate::chart::{Area, GRID, INK, PALETTE, canvas, font, scaled};

/// Colours of ratios above and below 1.
const FASTER: RGBColor = PALETTE[0];
const SLOWER: RGBColor = PALETTE[1];
/// Left and right ends of the bars' scale, the height of a row, and the space above the first.
const LEFT: u32 = 320;
const RIGHT: u32 = 700;
const ROW: u32 = 19;
const TOP: u32 = 62;
/// Space for the scale below the last row.
const BOTTOM: u32 = 52;

/// Speed of this library relative to a reference.
pub(crate) struct Bar<'a> {
    /// Name of the task: its group, and after the first comma the case.
    pub(crate) task: &'a str,
    pub(crate) reference: &'a str,
    /// Quartiles of the ratio.
    pub(crate) quartiles: [f64; 3],
}

impl Bar<'_> {
    /// Returns the group and the case.
    fn names(&self) -> (&str, &str) {
        self.task.split_once(", ").unwrap_or((self.task, ""))
    }
}

/// Draws the bars from 1 to the ratio, on a logarithmic scale. Groups appear in the order of their
/// first bars.
pub(crate) fn draw(path: &Path, bars: &[Bar<'_>]) -> Result<(), Box<dyn Error>> {
    let mut groups: Vec<&str> = Vec::new();
    for bar in bars {
        if !groups.contains(&bar.names().0) {
            groups.push(bar.names().0);
        }
    }
    let rows = (bars.len() + groups.len()) as u32;
    let low = bars.iter().map(|bar| bar.quartiles[0]).fold(0.5, f64::min);
    let high = bars.iter().map(|bar| bar.quartiles[2]).fold(10.0, f64::max);
    let axis = Axis::new(low, high, true);
    let place = |ratio: f64| axis.map(&ratio, (scaled(LEFT) as i32, scaled(RIGHT) as i32));
    canvas(path, TOP + ROW * rows + BOTTOM, |root| {
        let end = TOP + ROW * rows;
        draw_scale(root, &axis, &place, end)?;
        let mut top = TOP;
        for group in groups {
            write(root, group, (scaled(10) as i32, top), HPos::Left, 13)?;
            top += ROW;
            for bar in bars.iter().filter(|bar| bar.names().0 == group) {
                draw_bar(root, bar, &place, top)?;
                top += ROW;
            }
        }
        let line = [(place(1.0), scaled(TOP) as i32), (place(1.0), scaled(end) as i32)];
        root.draw(&PathElement::new(line, INK.stroke_width(scaled(1))))?;
        Ok(())
    })
}

/// Draws title, legend, and the scale with its lines.
fn draw_scale(root: &Area<'_>, axis: &Axis, place: &dyn Fn(f64) -> i32, end: u32) -> Result<(), Box<dyn Error>> {
    write(root, "Speed of this library relative to others", (scaled(10) as i32, 8), HPos::Left, 16)?;
    for (left, color, label) in [(LEFT, FASTER, "this library is faster"), (LEFT + 150, SLOWER, "the other is faster")]
    {
        let (x, y) = (scaled(left) as i32, scaled(36) as i32);
        root.draw(&Rectangle::new([(x, y), (x + scaled(14) as i32, y + scaled(11) as i32)], color.filled()))?;
        write(root, label, (x + scaled(19) as i32, 36), HPos::Left, 12)?;
    }
    let (x, y) = (scaled(LEFT + 290) as i32, scaled(41) as i32);
    root.draw(&PathElement::new([(x, y), (x + scaled(14) as i32, y)], INK.stroke_width(scaled(1))))?;
    write(root, "quartiles", (x + scaled(19) as i32, 36), HPos::Left, 12)?;
    for tick in axis.ticks(6) {
        let x = place(tick);
        let line = [(x, scaled(TOP) as i32), (x, scaled(end) as i32)];
        root.draw(&PathElement::new(line, GRID.stroke_width(scaled(1))))?;
        write(root, &axis.label(tick), (x, end + 4), HPos::Center, 12)?;
    }
    let middle = (scaled(LEFT + RIGHT) / 2) as i32;
    write(root, "time of the other / time of this library; more is better", (middle, end + 24), HPos::Center, 13)
}

/// Draws the name, the bar, the quartiles and the median of a ratio.
fn draw_bar(root: &Area<'_>, bar: &Bar<'_>, place: &dyn Fn(f64) -> i32, top: u32) -> Result<(), Box<dyn Error>> {
    let [low, median, high] = bar.quartiles;
    let (_, case) = bar.names();
    write(root, &format!("{case} / {}", bar.reference), (scaled(22) as i32, top + 1), HPos::Left, 12)?;
    let color = if median < 1.0 { SLOWER } else { FASTER };
    let ends = [(place(median.min(1.0)), scaled(top + 1) as i32), (place(median.max(1.0)), scaled(top + 14) as i32)];
    root.draw(&Rectangle::new(ends, color.filled()))?;
    let middle = scaled(top + 7) as i32;
    root.draw(&PathElement::new([(place(low), middle), (place(high), middle)], INK.stroke_width(scaled(1))))?;
    write(root, &significant(median), (place(high.max(1.0)) + scaled(5) as i32, top + 1), HPos::Left, 12)
}

/// Writes a text below a height, in units of the chart.
fn write(root: &Area<'_>, text: &str, (x, top): (i32, u32), anchor: HPos, size: u32) -> Result<(), Box<dyn Error>> {
    let style = font(size).pos(Pos::new(anchor, VPos::Top));
    root.draw(&Text::new(text.to_owned(), (x, scaled(top) as i32), style))?;
    Ok(())
}

/// Formats a positive number with three significant digits.
fn significant(value: f64) -> String {
    let decimals = (2 - value.log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}
