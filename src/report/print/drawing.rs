//! Our own drawings read back as what a page description needs: shapes with their paint, and texts.

use crate::math;
use roxmltree::{Document, Node};

/// Why a drawing cannot be put on paper: it holds what our figures do not.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the drawing holds {found}: expected what Reenact's figures are made of; please report it")]
pub struct Unprintable {
    found: String,
}

/// An affine map: x' = a x + c y + e, y' = b x + d y + f.
pub(super) type Matrix = [f64; 6];

/// A drawing, in px downwards from its upper left corner.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Drawing {
    pub(super) title: String,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) marks: Vec<Mark>,
}

/// One thing that is drawn, in the coordinates that `matrix` maps to those of the drawing.
#[derive(Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) matrix: Matrix,
    pub(super) paint: Paint,
    pub(super) shape: Shape,
}

/// How it is painted. Colours are red, green and blue from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Paint {
    pub(super) fill: Option<[f64; 3]>,
    pub(super) stroke: Option<[f64; 3]>,
    pub(super) fill_opacity: f64,
    pub(super) stroke_opacity: f64,
    pub(super) stroke_width: f64,
    pub(super) dash: Vec<f64>,
    pub(super) round: bool,
}

/// What it is.
#[derive(Debug, PartialEq)]
pub(super) enum Shape {
    Path(Vec<Step>),
    Text { at: (f64, f64), anchor: f64, size: f64, bold: bool, text: String },
}

/// A step of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    Move(f64, f64),
    Line(f64, f64),
    Curve([f64; 6]),
    Close,
}

/// What an element hands down to its children.
#[derive(Clone)]
struct Inherited {
    matrix: Matrix,
    paint: Paint,
    opacity: f64,
    size: f64,
    bold: bool,
    anchor: f64,
}

impl Drawing {
    /// Reads one of our figures.
    ///
    /// # Errors
    /// Where it holds elements, paths or colours that our figures do not.
    pub(super) fn read(svg: &str) -> Result<Self, Unprintable> {
        let document =
            Document::parse(svg).map_err(|error| unknown(&format!("XML with {error}")))?;
        let root = document.root_element();
        let view: Vec<f64> = numbers(root.attribute("viewBox").unwrap_or_default());
        let [_, _, width, height] = view[..] else { return Err(unknown("no view box")) };
        let paint = Paint {
            fill: Some([0.0; 3]),
            stroke: None,
            fill_opacity: 1.0,
            stroke_opacity: 1.0,
            stroke_width: 1.0,
            dash: Vec::new(),
            round: false,
        };
        let matrix = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let inherited =
            Inherited { matrix, paint, opacity: 1.0, size: 13.0, bold: false, anchor: 0.0 };
        let mut drawing = Self { width, height, ..Self::default() };
        drawing.children(root, &inherited.of(root)?)?;
        Ok(drawing)
    }

    fn children(&mut self, parent: Node<'_, '_>, inherited: &Inherited) -> Result<(), Unprintable> {
        for node in parent.children().filter(Node::is_element) {
            let own = inherited.of(node)?;
            let at = |name: &str| {
                node.attribute(name).and_then(|text| text.parse::<f64>().ok()).unwrap_or(0.0)
            };
            let shape = match node.tag_name().name() {
                "title" => {
                    if parent == parent.document().root_element() {
                        node.text().unwrap_or_default().clone_into(&mut self.title);
                    }
                    continue;
                }
                "g" => {
                    self.children(node, &own)?;
                    continue;
                }
                "rect" => rounded([at("x"), at("y"), at("width"), at("height")], at("rx")),
                "circle" => ellipse((at("cx"), at("cy")), at("r")),
                "line" => vec![Step::Move(at("x1"), at("y1")), Step::Line(at("x2"), at("y2"))],
                "path" => path(node.attribute("d").unwrap_or_default())?,
                "text" => {
                    let text = node.text().unwrap_or_default().to_owned();
                    let shape = Shape::Text {
                        at: (at("x"), at("y")),
                        anchor: own.anchor,
                        size: own.size,
                        bold: own.bold,
                        text,
                    };
                    self.marks.push(Mark { matrix: own.matrix, paint: own.painted(), shape });
                    continue;
                }
                other => return Err(unknown(&format!("an element `{other}`"))),
            };
            if !shape.is_empty() {
                let shape = Shape::Path(shape);
                self.marks.push(Mark { matrix: own.matrix, paint: own.painted(), shape });
            }
        }
        Ok(())
    }
}

impl Inherited {
    /// Returns what holds within `node`.
    fn of(&self, node: Node<'_, '_>) -> Result<Self, Unprintable> {
        let mut own = self.clone();
        for attribute in node.attributes() {
            let value = attribute.value();
            let number =
                || value.parse::<f64>().map_err(|_| unknown(&format!("the number `{value}`")));
            match attribute.name() {
                "fill" => own.paint.fill = colour(value)?,
                "stroke" => own.paint.stroke = colour(value)?,
                "fill-opacity" => own.paint.fill_opacity = number()?,
                "stroke-opacity" => own.paint.stroke_opacity = number()?,
                "opacity" => own.opacity *= number()?,
                "stroke-width" => own.paint.stroke_width = number()?,
                "stroke-dasharray" => own.paint.dash = numbers(value),
                "stroke-linejoin" => own.paint.round = value == "round",
                "font-size" => own.size = number()?,
                "font-weight" => own.bold = ["bold", "600", "700"].contains(&value),
                "text-anchor" => {
                    own.anchor = match value {
                        "middle" => 0.5,
                        "end" => 1.0,
                        _ => 0.0,
                    }
                }
                "transform" => own.matrix = times(own.matrix, transform(value)?),
                _ => {}
            }
        }
        Ok(own)
    }

    fn painted(&self) -> Paint {
        let mut paint = self.paint.clone();
        paint.fill_opacity *= self.opacity;
        paint.stroke_opacity *= self.opacity;
        paint
    }
}

fn unknown(found: &str) -> Unprintable {
    Unprintable { found: found.to_owned() }
}

fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
}

fn colour(text: &str) -> Result<Option<[f64; 3]>, Unprintable> {
    if text == "none" {
        return Ok(None);
    }
    let digits: Option<Vec<u32>> = text
        .strip_prefix('#')
        .and_then(|hex| hex.chars().map(|digit| digit.to_digit(16)).collect());
    let bytes = match digits.as_deref() {
        Some([r, g, b]) => [r * 17, g * 17, b * 17],
        Some([r, s, g, h, b, c]) => [r * 16 + s, g * 16 + h, b * 16 + c],
        _ => return Err(unknown(&format!("the colour `{text}`"))),
    };
    Ok(Some(bytes.map(|byte| f64::from(byte) / 255.0)))
}

/// Returns the map that does `inner` first.
pub(super) fn times(outer: Matrix, inner: Matrix) -> Matrix {
    let [a, b, c, d, e, f] = outer;
    let [p, q, r, s, t, u] = inner;
    [
        a * p + c * q,
        b * p + d * q,
        a * r + c * s,
        b * r + d * s,
        a * t + c * u + e,
        b * t + d * u + f,
    ]
}

fn transform(text: &str) -> Result<Matrix, Unprintable> {
    let mut matrix = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    for part in text.split(')').map(str::trim).filter(|part| !part.is_empty()) {
        let (name, inner) = part.split_once('(').unwrap_or((part, ""));
        let values = numbers(inner);
        let one = match (name, &values[..]) {
            ("translate", [x, y]) => [1.0, 0.0, 0.0, 1.0, *x, *y],
            ("scale", [s]) => [*s, 0.0, 0.0, *s, 0.0, 0.0],
            ("rotate", [degrees, x, y]) => {
                let (sin, cos) = (math::sin(degrees.to_radians()), math::cos(degrees.to_radians()));
                let turn = times([cos, sin, -sin, cos, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0, -x, -y]);
                times([1.0, 0.0, 0.0, 1.0, *x, *y], turn)
            }
            _ => return Err(unknown(&format!("the transform `{part})`"))),
        };
        matrix = times(matrix, one);
    }
    Ok(matrix)
}

/// How far from its ends a quarter of a circle of radius 1 is pulled by a curve of third degree.
const PULL: f64 = 0.552_284_75;

fn ellipse((x, y): (f64, f64), r: f64) -> Vec<Step> {
    rounded([x - r, y - r, 2.0 * r, 2.0 * r], r)
}

/// Returns the rectangle of `[x, y, width, height]` with corners of radius `r`.
fn rounded([x, y, width, height]: [f64; 4], r: f64) -> Vec<Step> {
    let (right, bottom) = (x + width, y + height);
    if width <= 0.0 || height <= 0.0 {
        return Vec::new();
    }
    let r = r.min(width / 2.0).min(height / 2.0);
    if r <= 0.0 {
        let corners = [Step::Line(right, y), Step::Line(right, bottom), Step::Line(x, bottom)];
        return [Step::Move(x, y)].into_iter().chain(corners).chain([Step::Close]).collect();
    }
    let k = r * (1.0 - PULL);
    vec![
        Step::Move(x + r, y),
        Step::Line(right - r, y),
        Step::Curve([right - k, y, right, y + k, right, y + r]),
        Step::Line(right, bottom - r),
        Step::Curve([right, bottom - k, right - k, bottom, right - r, bottom]),
        Step::Line(x + r, bottom),
        Step::Curve([x + k, bottom, x, bottom - k, x, bottom - r]),
        Step::Line(x, y + r),
        Step::Curve([x, y + k, x + k, y, x + r, y]),
        Step::Close,
    ]
}

/// Reads the data of a path: absolute moves and lines, relative ones along the axes, and ends.
fn path(data: &str) -> Result<Vec<Step>, Unprintable> {
    let mut steps = Vec::new();
    let (mut x, mut y) = (0.0, 0.0);
    let mut rest = data.trim_start();
    while let Some(command) = rest.chars().next() {
        let after = &rest[command.len_utf8()..];
        let length = after.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(after.len());
        let values = numbers(after[..length].trim());
        rest = &after[length..];
        let begun = if steps.is_empty() || steps.last() == Some(&Step::Close) { 'M' } else { 'L' };
        match (command, &values[..]) {
            ('M', [u, v]) => {
                (x, y) = (*u, *v);
                steps.push(Step::Move(x, y));
            }
            ('L', [u, v]) if begun == 'L' => {
                (x, y) = (*u, *v);
                steps.push(Step::Line(x, y));
            }
            ('h', [u]) => {
                x += u;
                steps.push(Step::Line(x, y));
            }
            ('v', [v]) => {
                y += v;
                steps.push(Step::Line(x, y));
            }
            ('Z' | 'z', []) => steps.push(Step::Close),
            _ => return Err(unknown(&format!("the path `{command}{}`", &after[..length]))),
        }
    }
    Ok(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn only(body: &str) -> Result<Vec<Mark>, Unprintable> {
        let svg = format!("<svg viewBox=\"0 0 10 20\"><title>T</title>{body}</svg>");
        Drawing::read(&svg).map(|drawing| drawing.marks)
    }

    #[test]
    fn groups_hand_down_where_they_stand_and_how_they_are_painted() {
        let marks = only(
            "<g transform=\"translate(1 2)\" fill=\"#f00\" opacity=\"0.5\"><path d=\"M1 2L3 4Z\" fill-opacity=\"0.5\"/></g>",
        );
        let mark = &marks.unwrap()[0];
        assert_eq!(mark.matrix, [1.0, 0.0, 0.0, 1.0, 1.0, 2.0]);
        assert_eq!(mark.paint.fill, Some([1.0, 0.0, 0.0]));
        assert_eq!((mark.paint.fill_opacity, mark.paint.stroke), (0.25, None));
        let steps = vec![Step::Move(1.0, 2.0), Step::Line(3.0, 4.0), Step::Close];
        assert_eq!(mark.shape, Shape::Path(steps));
    }

    #[test]
    fn runs_of_cells_and_turned_texts_are_read() {
        let cells = &only("<path d=\"M0 3h2v1h-2z\"/>").unwrap()[0].shape;
        let corners = [Step::Line(2.0, 3.0), Step::Line(2.0, 4.0), Step::Line(0.0, 4.0)];
        let expected = [Step::Move(0.0, 3.0)].into_iter().chain(corners).chain([Step::Close]);
        assert_eq!(*cells, Shape::Path(expected.collect()));
        let marks = only(
            "<text x=\"16\" y=\"9\" font-weight=\"bold\" transform=\"rotate(-90 16 9)\">a &lt; b</text>",
        );
        let Mark { matrix, shape, .. } = &marks.unwrap()[0];
        let moved = [matrix[0] * 16.0 + matrix[2] * 9.0 + matrix[4], matrix[1]];
        assert!((moved[0] - 16.0).abs() < 1e-9 && (moved[1] + 1.0).abs() < 1e-9, "{matrix:?}");
        assert!(matches!(shape, Shape::Text { bold: true, text, .. } if text == "a < b"));
    }

    #[test]
    fn what_no_figure_holds_is_refused() {
        let refused = |body: &str| only(body).unwrap_err().to_string();
        let expected = |found: &str| {
            format!(
                "the drawing holds {found}: expected what Reenact's figures are made of; please report it"
            )
        };
        assert_eq!(refused("<image/>"), expected("an element `image`"));
        assert_eq!(refused("<path d=\"M0 0C1 2 3 4 5 6\"/>"), expected("the path `C1 2 3 4 5 6`"));
        assert_eq!(refused("<rect fill=\"red\"/>"), expected("the colour `red`"));
        assert_eq!(refused("<g transform=\"skewX(3)\"/>"), expected("the transform `skewX(3)`"));
    }
}
