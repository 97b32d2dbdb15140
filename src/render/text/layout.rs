//! Where the letters of a text are.

use super::atlas::{Atlas, CELL};

/// How a text is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Style {
    /// Red, green, blue and opacity of the letters.
    pub(crate) rgba: [f32; 4],
    /// Those of the halo behind them; none if it is transparent.
    pub(crate) halo: [f32; 4],
    /// By how much the letters are larger than those of the font.
    pub(crate) scale: f32,
}

impl Style {
    /// That of labels: white, with a halo of black that lets half of what is behind through.
    pub(crate) const LABEL: Self = Self { rgba: [1.0; 4], halo: [0.0, 0.0, 0.0, 0.5], scale: 1.0 };
}

/// A rectangle of the picture that shows a piece of the atlas.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Quad {
    /// Left, top, right and bottom, pixels from the upper left corner of the picture.
    pub(crate) rect: [f32; 4],
    /// The same of the piece of the atlas, as fractions of it.
    pub(crate) texcoords: [f32; 4],
    /// Red, green, blue and opacity.
    pub(crate) rgba: [f32; 4],
    /// How much the two bytes of the atlas count: `[1, 0]` for letters, `[0, 1]` for halos.
    pub(crate) channel: [f32; 2],
}

/// The rectangles of a text of which the upper left corner is at `at`, pixels, in the order in which they are to be drawn: first
/// all halos, then all letters. A line feed begins a new line; what the font has not is a box.
pub(crate) fn quads(text: &str, at: [f32; 2], style: Style) -> impl Iterator<Item = Quad> + '_ {
    let halos =
        (style.halo[3] > 0.0).then(|| layer(text, at, style.scale, style.halo, [0.0, 1.0])).into_iter().flatten();
    halos.chain(layer(text, at, style.scale, style.rgba, [1.0, 0.0]))
}

fn layer(text: &str, at: [f32; 2], scale: f32, rgba: [f32; 4], channel: [f32; 2]) -> impl Iterator<Item = Quad> + '_ {
    // Letters too have a border, in which nothing is, so that they do not end abruptly where they are enlarged.
    const BORDER: u32 = 1;
    letters(text).map(move |(letter, [column, row])| {
        let place = |axis: usize, cells: u32| at[axis] + scale * (cells * CELL[axis]) as f32;
        let (left, top) = (place(0, column) - scale * BORDER as f32, place(1, row) - scale * BORDER as f32);
        let size = CELL.map(|length| scale * (length + 2 * BORDER) as f32);
        Quad {
            rect: [left, top, left + size[0], top + size[1]],
            texcoords: Atlas::get().texcoords(letter, BORDER),
            rgba,
            channel,
        }
    })
}

/// The letters that are to be drawn, and their columns and rows.
fn letters(text: &str) -> impl Iterator<Item = (char, [u32; 2])> + '_ {
    let mut next = [0, 0];
    text.chars().filter_map(move |letter| {
        let place = next;
        next = if letter == '\n' { [0, place[1] + 1] } else { [place[0] + 1, place[1]] };
        // A tab is as wide as a space, and as empty.
        (!matches!(letter, '\n' | ' ' | '\t' | '\r')).then_some((letter, place))
    })
}

#[cfg(test)]
mod tests {
    use super::super::CELL;
    use super::{Style, quads};

    #[test]
    fn letters_stand_side_by_side_and_lines_below_each_other() {
        let style = Style { halo: [0.0; 4], ..Style::LABEL };
        let [width, height] = CELL.map(|length| length as f32);
        let quads: Vec<_> = quads("ab c\nd", [10.0, 20.0], style).collect();
        let places: Vec<_> = quads.iter().map(|quad| [quad.rect[0] + 1.0 - 10.0, quad.rect[1] + 1.0 - 20.0]).collect();
        assert_eq!(places, [[0.0, 0.0], [width, 0.0], [3.0 * width, 0.0], [0.0, height]]);
    }

    #[test]
    fn halos_are_behind_all_letters() {
        let quads: Vec<_> = quads("äb", [0.0; 2], Style::LABEL).collect();
        assert_eq!(quads.len(), 4);
        assert!(quads[..2].iter().all(|quad| quad.channel == [0.0, 1.0] && quad.rgba == Style::LABEL.halo));
        assert!(quads[2..].iter().all(|quad| quad.channel == [1.0, 0.0] && quad.rgba == Style::LABEL.rgba));
    }

    #[test]
    fn a_text_is_as_large_as_its_style_says() {
        for scale in [0.5, 1.0, 3.0] {
            let quad = quads("x", [0.0; 2], Style { scale, ..Style::LABEL }).next().unwrap();
            assert_eq!(quad.rect[2] - quad.rect[0], scale * (CELL[0] + 2) as f32);
            assert_eq!(quad.rect[3] - quad.rect[1], scale * (CELL[1] + 2) as f32);
        }
    }
}
