//! Plot of the learning curves.

use std::error::Error;
use std::path::Path;

use crate::GOAL;
use crate::common::chart::{self, INK, Line, PALETTE, Panel};
use crate::search::EPISODES;

/// Number of iterations whose mean is plotted: one fall halves the return of an iteration.
const WINDOW: usize = 10;

/// Draws the return of each seed's policy over the number of episodes.
pub fn draw(path: &Path, curves: &[Vec<f64>]) -> Result<(), Box<dyn Error>> {
    let episodes = |iteration: usize| (iteration * EPISODES) as f64;
    let mut lines: Vec<Line> = (1..)
        .zip(curves)
        .map(|(seed, curve)| {
            let points = (0..curve.len()).map(|last| {
                let values = &curve[(last + 1).saturating_sub(WINDOW)..=last];
                (episodes(last), values.iter().sum::<f64>() / values.len() as f64)
            });
            Line::new(&format!("seed {seed}"), PALETTE[(seed - 1) % PALETTE.len()], points)
        })
        .collect();
    let last = episodes(curves.iter().map(Vec::len).max().unwrap_or(1).max(2) - 1);
    lines.push(Line::dashed("goal", INK, [(0.0, GOAL), (last, GOAL)]));
    let title = format!("Return of the policy during augmented random search, mean of {WINDOW} iterations");
    chart::draw(path, 320, &[Panel::new(&title, ["episodes (number)", "return (sum of rewards)"], lines)])
}
