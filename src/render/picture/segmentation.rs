//! Which thing is where.

use std::fmt;
use std::path::Path;

use super::{Picture, index};
use crate::error::Result;
use crate::math;
use crate::scene::{Scene, SceneObject};

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Segment {
    /// Which geom of the scene: its index there.
    pub geom: usize,
    /// The element of the model that the geom stands for; none for decoration and for what the user added.
    pub object: Option<SceneObject>,
}

/// Which thing is where: for each pixel the geom of the scene that is seen there, and the element of the model that it stands
/// for.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct SegmentationPicture {
    width: usize,
    height: usize,
    /// For each pixel 0 for nothing, or one more than the geom's index in the scene.
    numbers: Vec<u32>,
    /// For each geom of the scene what it stands for.
    objects: Vec<Option<SceneObject>>,
}

impl SegmentationPicture {
    /// Its width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Its height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// What is seen in column `x` from the left, of row `y` from the top.
    ///
    /// # Panics
    ///
    /// If there is no such pixel.
    #[track_caller]
    pub fn pixel(&self, x: usize, y: usize) -> Option<Segment> {
        self.segment(self.numbers[index([self.width, self.height], x, y)])
    }

    /// What is seen at each pixel, row by row from the top.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = Option<Segment>> + '_ {
        self.numbers.iter().map(|&number| self.segment(number))
    }

    /// What is seen at all, each thing once, by its index in the scene, with the number of its pixels.
    pub fn segments(&self) -> Vec<(Segment, usize)> {
        let mut counts = vec![0; self.objects.len()];
        for segment in self.pixels().flatten() {
            counts[segment.geom] += 1;
        }
        let counted = counts.into_iter().enumerate().filter(|&(_, count)| count > 0);
        counted.map(|(geom, count)| (Segment { geom, object: self.objects[geom] }, count)).collect()
    }

    /// For each pixel, row-major from the top, `(height, width)`: 0 where nothing is, or one more than the geom's index in the
    /// scene.
    pub fn as_slice(&self) -> &[u32] {
        &self.numbers
    }

    /// A picture to look at, in which each thing has a colour of its own, the same whenever it has the same index; black where
    /// nothing is.
    pub fn to_picture(&self) -> Picture {
        let mut picture = Picture::new(self.width, self.height);
        for (pixel, &number) in picture.as_bytes_mut().as_chunks_mut::<3>().0.iter_mut().zip(&self.numbers) {
            if number != 0 {
                *pixel = rgb(number);
            }
        }
        picture
    }

    /// Writes the [picture](Self::to_picture) as a PNG file.
    ///
    /// # Errors
    ///
    /// [`Error::File`](crate::Error::File) if the file cannot be written; one that was there before is as it was. A picture
    /// without pixels has no file.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<()> {
        self.to_picture().save_png(path)
    }

    fn segment(&self, number: u32) -> Option<Segment> {
        let geom = usize::try_from(number.checked_sub(1)?).ok()?;
        Some(Segment { geom, object: *self.objects.get(geom)? })
    }

    /// Makes it one of another size and of another scene, of which the numbers are anything, to be filled.
    pub(crate) fn resize(&mut self, width: usize, height: usize, scene: &Scene) -> &mut [u32] {
        let area = super::area(width, height).expect("Bug: a size that was not checked");
        (self.width, self.height) = (width, height);
        self.objects.clear();
        self.objects.extend(scene.geoms().map(|geom| geom.object()));
        self.numbers.resize(area, 0);
        &mut self.numbers
    }
}

impl fmt::Debug for SegmentationPicture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SegmentationPicture({} x {}, {} geoms)", self.width, self.height, self.objects.len())
    }
}

/// A colour for a number: those of near numbers are far from each other, and none is as dark as the background. The engine's
/// own choice for its segmentation flag: Halton sequences of bases 2, 3 and 5.
fn rgb(number: u32) -> [u8; 3] {
    const SKIPPED: u32 = 9;
    let index = number.saturating_add(SKIPPED);
    // There is no such number for the last of the indices.
    [2, 3, 5].map(|base| (255.0 * (0.1 + 0.8 * math::halton(index, base).unwrap_or_default())).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::{Segment, SegmentationPicture};
    use crate::scene::{Camera, Categories, NewGeom, Scene, SceneObject, SceneOptions};
    use crate::{Data, sample};

    fn picture() -> (SegmentationPicture, usize) {
        let mut data = Data::new(sample::cartpole()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 100).unwrap();
        let mut camera = Camera::free(data.model());
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        let added = scene.push(&NewGeom::sphere(1.0)).unwrap();
        let mut picture = SegmentationPicture::default();
        picture.resize(3, 2, &scene).copy_from_slice(&[0, 1, 1, added as u32 + 1, 2, u32::MAX]);
        (picture, added)
    }

    #[test]
    fn each_pixel_knows_its_geom_and_what_it_stands_for() {
        let (picture, added) = picture();
        assert_eq!(picture.pixel(0, 0), None);
        let segment = picture.pixel(1, 0).unwrap();
        assert_eq!(segment.geom, 0);
        assert!(matches!(segment.object, Some(SceneObject::Geom(geom)) if geom.index() == 0));
        assert_eq!(picture.pixel(0, 1), Some(Segment { geom: added, object: None }));
        assert_eq!(picture.pixel(2, 1), None, "a number of no geom");
        assert_eq!(picture.pixels().len(), 6);
    }

    #[test]
    fn what_is_seen_is_counted() {
        let (picture, added) = picture();
        let counts: Vec<_> = picture.segments().into_iter().map(|(segment, count)| (segment.geom, count)).collect();
        assert_eq!(counts, [(0, 2), (1, 1), (added, 1)]);
    }

    #[test]
    fn to_look_at_each_thing_has_its_own_bright_colour() {
        let (picture, _) = picture();
        let shown = picture.to_picture();
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
