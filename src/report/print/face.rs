//! The one face that printed figures are set in, embedded in every file: the same letters everywhere.

use ttf_parser::{Face, GlyphId};

/// Regular and bold; `OFL.txt` beside them says where they are from.
const FILES: [&[u8]; 2] =
    [include_bytes!("ReenactSans-Regular.ttf"), include_bytes!("ReenactSans-Bold.ttf")];
const NAMES: [&str; 2] = ["ReenactSans-Regular", "ReenactSans-Bold"];

/// A weight of the face.
pub(super) struct Weight {
    face: Face<'static>,
    /// Its name in PDF.
    pub(super) name: &'static str,
    /// Its file.
    pub(super) file: &'static [u8],
}

/// A glyph: its number, how far the next stands from it in thousandths of the size, and what it says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Glyph {
    pub(super) number: u16,
    pub(super) advance: f64,
    pub(super) says: char,
}

impl Weight {
    /// Returns the regular weight, or the bold one.
    pub(super) fn of(bold: bool) -> Self {
        let i = usize::from(bold);
        let face = Face::parse(FILES[i], 0).expect("the face of this program is one");
        Self { face, name: NAMES[i], file: FILES[i] }
    }

    /// Returns the glyphs of `text`; a question mark stands for a letter that the face does not have.
    pub(super) fn glyphs(&self, text: &str) -> Vec<Glyph> {
        let of = |c: char| Some((self.face.glyph_index(c)?, c));
        // Spaces of all widths are spaces.
        let plain = |c: char| if c.is_whitespace() { ' ' } else { c };
        let found = text.chars().map(plain).filter_map(|c| of(c).or_else(|| of('?')));
        found
            .map(|(GlyphId(number), says)| Glyph { number, advance: self.advance(number), says })
            .collect()
    }

    fn advance(&self, number: u16) -> f64 {
        self.thousandths(self.face.glyph_hor_advance(GlyphId(number)).unwrap_or(0))
    }

    /// Returns the advances of all glyphs (thousandths of the size).
    pub(super) fn advances(&self) -> impl Iterator<Item = f64> {
        (0..self.face.number_of_glyphs()).map(|number| self.advance(number))
    }

    /// Returns the corners of the box of all glyphs, ascent, descent and height of capitals (thousandths of the size).
    pub(super) fn measures(&self) -> ([f64; 4], [f64; 3]) {
        let face = &self.face;
        let bounds = face.global_bounding_box();
        (
            [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|x| self.thousandths(x)),
            [face.ascender(), face.descender(), face.capital_height().unwrap_or(0)]
                .map(|x| self.thousandths(x)),
        )
    }

    fn thousandths(&self, units: impl Into<f64>) -> f64 {
        1000.0 * units.into() / f64::from(self.face.units_per_em())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_weights_have_what_figures_say() {
        for bold in [false, true] {
            let weight = Weight::of(bold);
            for c in "ours ≤ 95 % ± σ − – “Zürich” ½ m² → ×".chars() {
                assert_eq!(weight.glyphs(&c.to_string())[0].says, c, "{c}");
            }
            assert_eq!(weight.glyphs("漢")[0].says, '?');
            assert_eq!(weight.glyphs("\u{2003}")[0].says, ' ');
            let width: f64 = weight.glyphs("reenact").iter().map(|glyph| glyph.advance).sum();
            assert!((3000.0..4000.0).contains(&width), "{width}");
            assert!(weight.advances().count() < 600);
        }
    }
}
