//! Segmentation images.

use std::fmt;
use std::path::Path;

use super::{RgbImage, index};
use crate::element::Object;
use crate::error::Result;
use crate::math;
use crate::scene::Scene;

/// Geom that is visible at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Segment {
    /// Index of the geom in the scene.
    pub geom: usize,
    /// Model element that the geom represents; `None` for decoration and for geoms added by the
    /// user.
    pub object: Option<Object>,
}

/// Segmentation image: for each pixel the visible geom of the scene, and the model element that it
/// represents.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct SegmentationImage {
    width: usize,
    height: usize,
    /// For each pixel 0 for the background, or the geom's index in the scene plus 1.
    ids: Vec<u32>,
    /// Model element of each geom of the scene.
    objects: Vec<Option<Object>>,
}

impl SegmentationImage {
    /// Returns the width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the segment at column `x` from the left and row `y` from the top; `None` for the
    /// background.
    ///
    /// # Panics
    ///
    /// If the pixel is outside of the image.
    #[track_caller]
    pub fn pixel(&self, x: usize, y: usize) -> Option<Segment> {
        self.segment(self.ids[index([self.width, self.height], x, y)])
    }

    /// Iterates over the segments of all pixels, row by row from the top.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = Option<Segment>> + '_ {
        self.ids.iter().map(|&id| self.segment(id))
    }

    /// Returns the index of the model's geom at each pixel, row by row from the top; −1 for the
    /// background and for what is no geom of the model.
    #[doc(alias = "segid")]
    pub fn geom_ids(&self) -> Vec<i32> {
        let index = |segment: Option<Segment>| match segment?.object? {
            Object::Geom(geom) => Some(geom.index() as i32),
            _ => None,
        };
        self.pixels().map(|segment| index(segment).unwrap_or(-1)).collect()
    }

    /// Returns every visible segment with its number of pixels, ordered by the geom's index in the
    /// scene.
    pub fn segments(&self) -> Vec<(Segment, usize)> {
        let mut counts = vec![0; self.objects.len()];
        for segment in self.pixels().flatten() {
            counts[segment.geom] += 1;
        }
        let counted = counts.into_iter().enumerate().filter(|&(_, count)| count > 0);
        counted.map(|(geom, count)| (Segment { geom, object: self.objects[geom] }, count)).collect()
    }

    /// Returns the ids of all pixels `(height, width)`, row-major from the top: 0 for the
    /// background, or the geom's index in the scene plus 1.
    pub fn as_slice(&self) -> &[u32] {
        &self.ids
    }

    /// Converts the ids to an image for display, with a distinct colour for each geom that depends
    /// on its index only; black for the background.
    pub fn to_rgb(&self) -> RgbImage {
        let mut picture = RgbImage::new(self.width, self.height);
        for (pixel, &id) in picture.as_bytes_mut().as_chunks_mut::<3>().0.iter_mut().zip(&self.ids) {
            if id != 0 {
                *pixel = rgb(id);
            }
        }
        picture
    }

    /// Writes the [colour image](Self::to_rgb) as a PNG file.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written or the image is empty. An
    /// existing file is then unchanged.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<()> {
        self.to_rgb().save_png(path)
    }

    fn segment(&self, id: u32) -> Option<Segment> {
        let geom = usize::try_from(id.checked_sub(1)?).ok()?;
        Some(Segment { geom, object: *self.objects.get(geom)? })
    }

    /// Changes the size and the scene, and returns the ids, whose values are unspecified.
    pub(crate) fn resize(&mut self, width: usize, height: usize, scene: &Scene) -> &mut [u32] {
        let area = super::area(width, height).expect("Bug: unchecked image size");
        (self.width, self.height) = (width, height);
        self.objects.clear();
        self.objects.extend(scene.geoms().map(|geom| geom.object()));
        self.ids.resize(area, 0);
        &mut self.ids
    }
}

impl fmt::Debug for SegmentationImage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SegmentationImage({} x {}, {} geoms)", self.width, self.height, self.objects.len())
    }
}

/// Returns the colour of an id. Consecutive ids have dissimilar colours, and no colour is as dark
/// as the background. These are the colours of the engine's segmentation flag: Halton sequences
/// with bases 2, 3 and 5.
fn rgb(id: u32) -> [u8; 3] {
    const SKIPPED: u32 = 9;
    let index = id.saturating_add(SKIPPED);
    // The engine's sequence is undefined for indices that exceed a C int.
    [2, 3, 5].map(|base| (255.0 * (0.1 + 0.8 * math::halton(index, base).unwrap_or_default())).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::{Segment, SegmentationImage};
    use crate::element::Object;
    use crate::scene::{Camera, Categories, NewGeom, Scene, SceneOptions};
    use crate::{Data, sample};

    fn picture() -> (SegmentationImage, usize) {
        let mut data = Data::new(sample::cartpole()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 100).unwrap();
        let mut camera = Camera::free(data.model());
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        let added = scene.add_geom(&NewGeom::sphere(1.0)).unwrap();
        let mut picture = SegmentationImage::default();
        picture.resize(3, 2, &scene).copy_from_slice(&[0, 1, 1, added as u32 + 1, 2, u32::MAX]);
        (picture, added)
    }

    #[test]
    fn pixels_map_to_geoms_and_model_elements() {
        let (picture, added) = picture();
        assert_eq!(picture.pixel(0, 0), None);
        let segment = picture.pixel(1, 0).unwrap();
        assert_eq!(segment.geom, 0);
        assert!(matches!(segment.object, Some(Object::Geom(geom)) if geom.index() == 0));
        assert_eq!(picture.pixel(0, 1), Some(Segment { geom: added, object: None }));
        assert_eq!(picture.pixel(2, 1), None, "id of no geom");
        assert_eq!(picture.pixels().len(), 6);
        assert_eq!(picture.geom_ids(), [-1, 0, 0, -1, 1, -1]);
    }

    #[test]
    fn visible_segments_are_counted() {
        let (picture, added) = picture();
        let counts: Vec<_> = picture.segments().into_iter().map(|(segment, count)| (segment.geom, count)).collect();
        assert_eq!(counts, [(0, 2), (1, 1), (added, 1)]);
    }

    #[test]
    fn colours_are_distinct_and_bright() {
        let (picture, _) = picture();
        let shown = picture.to_rgb();
        assert_eq!(shown.pixel(0, 0), [0; 3]);
        assert_eq!(shown.pixel(1, 0), shown.pixel(2, 0));
        assert_ne!(shown.pixel(1, 0), shown.pixel(1, 1));
        let mut seen: Vec<_> = (1..500).map(super::rgb).collect();
        assert!(seen.iter().flatten().all(|&byte| byte >= 25));
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 499);
    }
}
