//! Where a figure is looked at: a screen takes the width that the figure wants, a column of a paper has one.

use super::svg::{escape, number};

/// Points (1/72 inch) of a pixel of a drawing on paper: labels of 13 px are letters of 7.5 pt.
const POINTS: f64 = 0.58;
/// Points of a millimetre.
const POINTS_OF_MM: f64 = 72.0 / 25.4;
/// The smallest and the largest letters on paper (px): 7 and 8 pt.
const LETTERS: (f64, f64) = (12.1, 13.7);

/// What a figure is laid out for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Medium {
    /// A page on a screen.
    #[default]
    Screen,
    /// A column of a paper.
    Paper {
        /// Its width (mm).
        width_mm: f64,
    },
}

impl Medium {
    /// Returns the width that a figure must have (px); `None` where it has the one that it wants.
    pub(crate) fn width(self) -> Option<f64> {
        match self {
            Self::Screen => None,
            Self::Paper { width_mm } => Some(width_mm * POINTS_OF_MM / POINTS),
        }
    }
}

/// Gives the drawing `svg`, laid out for a column of `width_mm` mm, its size on paper, and all its letters 7 to 8 pt.
pub fn for_paper(svg: &str, width_mm: f64) -> String {
    let letters = replaced(svg, " font-size=\"", |size| {
        let size = size.parse::<f64>().unwrap_or(LETTERS.1);
        number(size.clamp(LETTERS.0, LETTERS.1))
    });
    let Some((root, rest)) = letters.split_once('>') else { return letters };
    let px: f64 = attribute(root, "width").and_then(|text| text.parse().ok()).unwrap_or(1.0);
    let millimetres = |text: &str| {
        let px_here: f64 = text.parse().unwrap_or(px);
        format!("{}mm", number(px_here / px * width_mm))
    };
    let sized = replaced(root, " width=\"", millimetres);
    // Letters of no stated size are those of labels.
    let sized = replaced(&sized, " height=\"", millimetres) + " font-size=\"13\"";
    format!("{sized}>{rest}")
}

/// Replaces what stands behind each `before` up to the next quotation mark.
fn replaced(text: &str, before: &str, with: impl Fn(&str) -> String) -> String {
    let mut parts = text.split(before);
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (value, rest) = part.split_once('"').unwrap_or((part, ""));
        out.push_str(&format!("{before}{}\"{rest}", escape(&with(value))));
    }
    out
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    tag.split_once(&format!(" {name}=\""))?.1.split_once('"').map(|(value, _)| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::svg::{Element, document};

    #[test]
    fn a_drawing_for_paper_has_its_size_there_and_letters_of_7_to_8_points() {
        let letter =
            |size: f64| Element::new("text").at("font-size", size).text("a font-size=\"9\"");
        let svg = document(430.0, 215.0, "A title", [letter(10.0), letter(13.0), letter(16.0)]);
        let paper = for_paper(&svg, 88.0);
        let parsed = roxmltree::Document::parse(&paper).unwrap();
        let root = parsed.root_element();
        assert_eq!(
            (root.attribute("width"), root.attribute("height")),
            (Some("88mm"), Some("44mm"))
        );
        assert_eq!(root.attribute("viewBox"), Some("0 0 430 215"));
        let sizes: Vec<_> = root.descendants().filter_map(|n| n.attribute("font-size")).collect();
        assert_eq!(sizes, ["13", "12.1", "13", "13.7"]);
        assert!(paper.contains("a font-size=&quot;9&quot;"), "text stays text");
        let points = |px: f64| px * POINTS;
        assert!(points(LETTERS.0) >= 7.0 && points(LETTERS.1) <= 8.0);
        let width = Medium::Paper { width_mm: 88.0 }.width().unwrap();
        assert!((width * POINTS - 88.0 * POINTS_OF_MM).abs() < 1e-9);
    }
}
