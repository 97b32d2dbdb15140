//! Glyphs of texts: DejaVu Sans, and the fonts of the system for scripts that it lacks.
//!
//! Each character is one glyph. Scripts whose letters depend on their neighbours, such as Arabic,
//! have their isolated forms, from left to right.

#[cfg(feature = "viewer")]
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, PoisonError};

use ab_glyph_rasterizer::{Point, Rasterizer, point};
use fontdb::{Database, FaceInfo, ID, Style};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::prelude::{FontRef, GlyphId, LocationRef, MetadataProvider, Size};

/// Image of a glyph.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Glyph {
    /// Upper left pixel, from the position of the pen on the base line.
    pub(crate) origin: [i32; 2],
    /// Width and height, pixels. Zero for a space.
    pub(crate) size: [u32; 2],
    /// Coverage of the pixels, row-major.
    pub(crate) coverage: Vec<u8>,
    /// Distance of the pen to the next glyph, pixels.
    pub(crate) advance: f32,
}

/// Font file, or a face of a collection of fonts.
#[cfg(feature = "viewer")]
pub(crate) struct FontFile {
    pub(crate) bytes: Cow<'static, [u8]>,
    /// Index of the face in a collection.
    pub(crate) index: u32,
    pub(crate) name: String,
}

/// Returns the image of a character at a size of the em square, pixels: of a box if neither DejaVu
/// Sans nor a font of the system has the character.
pub(crate) fn glyph(character: char, em: f32) -> Glyph {
    let (own, of_system) = (dejavu(), || SystemFonts::lock().glyph(character, em));
    let found = own.charmap().map(character).and_then(|id| draw(&own, id, em)).or_else(of_system);
    found.or_else(|| draw(&own, GlyphId::NOTDEF, em)).expect("DejaVu Sans has a box for missing glyphs")
}

/// Returns the font that shows a character: DejaVu Sans or a font of the system.
#[cfg(feature = "viewer")]
pub(crate) fn font_for(character: char) -> Option<FontFile> {
    if dejavu().charmap().map(character).is_some() {
        return Some(FontFile { bytes: dejavu::sans::regular().into(), index: 0, name: "DejaVuSans".to_owned() });
    }
    SystemFonts::lock().font_for(character)
}

/// Returns DejaVu Sans.
fn dejavu() -> FontRef<'static> {
    FontRef::new(dejavu::sans::regular()).expect("DejaVu Sans is a font")
}

/// Fonts of the system, which are listed on first use.
struct SystemFonts {
    database: Database,
    /// Faces, the most legible in labels first.
    faces: Vec<ID>,
    /// Faces that were found, or `None` for characters that no face has.
    found: HashMap<char, Option<ID>>,
}

impl SystemFonts {
    /// Returns the fonts of the system.
    fn lock() -> std::sync::MutexGuard<'static, Self> {
        static FONTS: LazyLock<Mutex<SystemFonts>> = LazyLock::new(|| {
            let mut database = Database::new();
            database.load_system_fonts();
            Mutex::new(SystemFonts::new(database))
        });
        FONTS.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn new(database: Database) -> Self {
        let distance = |face: &FaceInfo| {
            let has_serifs = face.families.first().is_some_and(|(name, _)| name.contains("Serif"));
            let width = face.stretch.to_number().abs_diff(fontdb::Stretch::Normal.to_number());
            (face.style != Style::Normal, width, face.weight.0.abs_diff(400), has_serifs, face.monospaced)
        };
        let mut faces: Vec<_> = database.faces().collect();
        faces.sort_by_cached_key(|face| (distance(face), face.post_script_name.clone()));
        let faces = faces.into_iter().map(|face| face.id).collect();
        Self { database, faces, found: HashMap::new() }
    }

    /// Returns the first face with the outline of a character.
    fn find(&mut self, character: char) -> Option<ID> {
        if let Some(found) = self.found.get(&character) {
            return *found;
        }
        let has_outline = |data: &[u8], index| {
            let font = FontRef::from_index(data, index).ok()?;
            let id = font.charmap().map(character)?;
            draw(&font, id, 16.0)
        };
        let has_glyph = |id: &&ID| self.database.with_face_data(**id, has_outline).flatten().is_some();
        let found = self.faces.iter().find(has_glyph).copied();
        self.found.insert(character, found);
        found
    }

    fn glyph(&mut self, character: char, em: f32) -> Option<Glyph> {
        let id = self.find(character)?;
        let draw = |data: &[u8], index| {
            let font = FontRef::from_index(data, index).ok()?;
            draw(&font, font.charmap().map(character)?, em)
        };
        self.database.with_face_data(id, draw)?
    }

    #[cfg(feature = "viewer")]
    fn font_for(&mut self, character: char) -> Option<FontFile> {
        let id = self.find(character)?;
        let name = self.database.face(id)?.post_script_name.clone();
        let copy = |data: &[u8], index| FontFile { bytes: Cow::Owned(data.to_owned()), index, name };
        self.database.with_face_data(id, copy)
    }
}

/// Draws a glyph. Returns `None` if the font has no outline of it.
fn draw(font: &FontRef<'_>, id: GlyphId, em: f32) -> Option<Glyph> {
    let (size, location) = (Size::new(em), LocationRef::default());
    let advance = font.glyph_metrics(size, location).advance_width(id)?;
    let mut outline = Outline::default();
    font.outline_glyphs().get(id)?.draw(DrawSettings::unhinted(size, location), &mut outline).ok()?;
    Some(outline.rasterise(advance))
}

/// Outline of a glyph in pixels, with y upwards.
#[derive(Default)]
struct Outline {
    curves: Vec<Curve>,
    start: Point,
    pen: Point,
}

enum Curve {
    Line([Point; 2]),
    Quadratic([Point; 3]),
    Cubic([Point; 4]),
}

impl Curve {
    /// Returns the end points and the control points, whose bounding box contains the curve.
    fn points(&self) -> &[Point] {
        match self {
            Self::Line(points) => points,
            Self::Quadratic(points) => points,
            Self::Cubic(points) => points,
        }
    }
}

impl Outline {
    /// Largest width and height of a glyph, pixels. A damaged font may have larger ones.
    const MAX_SIZE: f32 = 1024.0;

    fn rasterise(&self, advance: f32) -> Glyph {
        let points = || self.curves.iter().flat_map(Curve::points);
        let extreme = |of: fn(f32, f32) -> f32, start| {
            [points().map(|at| at.x).fold(start, of), points().map(|at| at.y).fold(start, of)]
        };
        let (min, max) = (extreme(f32::min, f32::INFINITY), extreme(f32::max, f32::NEG_INFINITY));
        let (left, top) = (min[0].floor(), max[1].ceil());
        let [width, height] = [max[0].ceil() - left, top - min[1].floor()];
        let is_drawn = (1.0..=Self::MAX_SIZE).contains(&width) && (1.0..=Self::MAX_SIZE).contains(&height);
        if !is_drawn {
            return Glyph { origin: [0; 2], size: [0; 2], coverage: Vec::new(), advance };
        }
        let (width, height) = (width as usize, height as usize);
        let mut rasteriser = Rasterizer::new(width, height);
        let pixel = |at: Point| point(at.x - left, top - at.y);
        for curve in &self.curves {
            match *curve {
                Curve::Line([a, b]) => rasteriser.draw_line(pixel(a), pixel(b)),
                Curve::Quadratic([a, b, c]) => rasteriser.draw_quad(pixel(a), pixel(b), pixel(c)),
                Curve::Cubic([a, b, c, d]) => rasteriser.draw_cubic(pixel(a), pixel(b), pixel(c), pixel(d)),
            }
        }
        let mut coverage = vec![0; width * height];
        rasteriser.for_each_pixel(|index, part| coverage[index] = (255.0 * part.clamp(0.0, 1.0)).round() as u8);
        Glyph { origin: [left as i32, -top as i32], size: [width as u32, height as u32], coverage, advance }
    }

    fn add(&mut self, curve: Curve, end: Point) {
        self.curves.push(curve);
        self.pen = end;
    }
}

impl OutlinePen for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        (self.start, self.pen) = (point(x, y), point(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.add(Curve::Line([self.pen, point(x, y)]), point(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.add(Curve::Quadratic([self.pen, point(cx, cy), point(x, y)]), point(x, y));
    }

    fn curve_to(&mut self, fx: f32, fy: f32, sx: f32, sy: f32, x: f32, y: f32) {
        self.add(Curve::Cubic([self.pen, point(fx, fy), point(sx, sy), point(x, y)]), point(x, y));
    }

    fn close(&mut self) {
        self.add(Curve::Line([self.pen, self.start]), self.start);
    }
}

#[cfg(test)]
mod tests {
    use super::{Glyph, SystemFonts, dejavu, glyph};
    use fontdb::Database;

    const EM: f32 = 16.0;
    /// Character that no font has.
    const MISSING: char = char::MAX;

    /// Returns the covered area, pixels.
    fn ink(glyph: &Glyph) -> f32 {
        glyph.coverage.iter().map(|&part| f32::from(part) / 255.0).sum()
    }

    #[test]
    fn letters_of_several_scripts_are_distinct() {
        let letters: Vec<char> = ('!'..='~').chain("äöüßéñšłΩλπЖшйא→²×".chars()).collect();
        let glyphs: Vec<_> = letters.iter().map(|&letter| glyph(letter, EM)).collect();
        for (index, (letter, one)) in letters.iter().zip(&glyphs).enumerate() {
            assert!(ink(one) > 1.0 && *one != glyph(MISSING, EM), "{letter} is missing");
            assert!(glyphs[..index].iter().all(|other| other != one), "{letter} looks like another letter");
        }
    }

    #[test]
    fn accents_lie_above_their_letters() {
        for [accented, base] in [['é', 'e'], ['ö', 'o'], ['Å', 'A'], ['й', 'и'], ['ά', 'α']] {
            let [accented, base] = [accented, base].map(|letter| glyph(letter, EM));
            assert!(ink(&accented) > ink(&base) && accented.origin[1] < base.origin[1]);
            assert_eq!(accented.advance, base.advance);
        }
    }

    #[test]
    fn size_of_a_glyph_is_proportional_to_the_em_square() {
        let (small, large) = (glyph('g', EM), glyph('g', 4.0 * EM));
        assert!((ink(&large) / ink(&small) - 16.0).abs() < 0.5, "{} and {}", ink(&large), ink(&small));
        assert!((large.advance / small.advance - 4.0).abs() < 1e-3);
        // The pen is on the base line, below which is the descender.
        assert!(large.origin[1] < 0 && large.origin[1] + large.size[1] as i32 > 0);
        assert_eq!(glyph('H', EM).origin[1] + glyph('H', EM).size[1] as i32, 0);
    }

    #[test]
    fn spaces_have_a_width_and_no_pixels() {
        for space in [' ', '\u{a0}'] {
            let glyph = glyph(space, EM);
            assert!(glyph.coverage.is_empty() && glyph.advance > 2.0);
        }
    }

    #[test]
    fn fonts_of_the_system_are_searched_for_a_regular_face_with_the_character() {
        let mut database = Database::new();
        for font in
            [dejavu::sans::bold(), dejavu::sans::oblique(), dejavu::sans::regular(), dejavu::sans_mono::regular()]
        {
            database.load_font_data(font.to_vec());
        }
        let mut fonts = SystemFonts::new(database);
        assert_eq!(fonts.glyph('א', EM).unwrap(), glyph('א', EM));
        assert_eq!(fonts.glyph(MISSING, EM), None);
        let id = fonts.find('א').unwrap();
        assert_eq!(fonts.database.face(id).unwrap().post_script_name, "DejaVuSans");
    }

    #[test]
    fn damaged_fonts_have_no_glyphs() {
        let mut bytes = dejavu::sans::regular().to_vec();
        // Leaves the directory of the tables.
        bytes[1000..].iter_mut().for_each(|byte| *byte = 0xff);
        let font = skrifa::FontRef::new(&bytes).unwrap();
        for id in 0..100 {
            let _ = super::draw(&font, skrifa::GlyphId::new(id), EM);
        }
        assert!(super::draw(&dejavu(), skrifa::GlyphId::new(u32::MAX), EM).is_none());
    }
}
