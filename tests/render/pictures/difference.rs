//! Difference of two images.

#![allow(dead_code, reason = "included by several programs, each of which uses some of it")]

use mujoco_safe::render::RgbImage;

/// Difference of a channel, of 255, above which a pixel is an outlier.
const OUTLIER: u8 = 8;

/// The difference between two images.
#[derive(Debug)]
pub struct Difference {
    /// Mean over all channels.
    pub mean: f64,
    /// Mean over all pixels of the largest difference of a channel.
    pub mean_largest: f64,
    /// Share of the pixels that are outliers.
    pub outliers: f64,
}

impl Difference {
    pub fn of(engine: &RgbImage, ours: &RgbImage) -> Self {
        assert_eq!((engine.width(), engine.height()), (ours.width(), ours.height()));
        let pixels = engine.as_bytes().chunks_exact(3).zip(ours.as_bytes().chunks_exact(3));
        // Loops over channels take a build without optimisation less time than iterators.
        let (mut sum, mut sum_largest, mut outliers) = (0_u32, 0_u32, 0_u32);
        for (engine, ours) in pixels {
            let mut largest = 0;
            for channel in 0..3 {
                let off = engine[channel].abs_diff(ours[channel]);
                sum += u32::from(off);
                largest = largest.max(off);
            }
            sum_largest += u32::from(largest);
            outliers += u32::from(largest > OUTLIER);
        }
        let [sum, sum_largest, outliers] = [sum, sum_largest, outliers].map(f64::from);
        let pixels = (engine.width() * engine.height()) as f64;
        Self { mean: sum / (3.0 * pixels), mean_largest: sum_largest / pixels, outliers: outliers / pixels }
    }
}

/// Returns the engine's image, ours, and their scaled difference side by side.
pub fn side_by_side(engine: &RgbImage, ours: &RgbImage) -> RgbImage {
    let (width, height) = (engine.width(), engine.height());
    let mut all = RgbImage::new(3 * width, height);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let pair = [engine.pixel(x, y), ours.pixel(x, y)];
        let difference = std::array::from_fn(|channel| pair[0][channel].abs_diff(pair[1][channel]).saturating_mul(8));
        for (part, pixel) in [pair[0], pair[1], difference].into_iter().enumerate() {
            all.set_pixel(part * width + x, y, pixel);
        }
    }
    all
}
