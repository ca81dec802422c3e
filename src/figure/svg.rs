//! A small writer of SVG: elements with attributes, text escaped, numbers in one short form.

/// Writes a coordinate with two decimals: a hundredth of a pixel, the same text everywhere.
pub fn number(x: f64) -> String {
    let hundredths = (x * 100.0).round() / 100.0;
    format!("{}", if hundredths == 0.0 { 0.0 } else { hundredths })
}

/// Escapes the five characters of `text` that XML reserves.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&apos;")
}

/// One element under construction.
#[derive(Debug, Clone)]
pub struct Element {
    name: &'static str,
    attributes: String,
    content: String,
}

impl Element {
    /// Creates an empty element `name`.
    pub fn new(name: &'static str) -> Self {
        Self { name, attributes: String::new(), content: String::new() }
    }

    /// Sets the attribute `name` to a text.
    #[must_use]
    pub fn set(mut self, name: &str, value: impl std::fmt::Display) -> Self {
        self.attributes.push_str(&format!(" {name}=\"{}\"", escape(&value.to_string())));
        self
    }

    /// Sets the attribute `name` to a number.
    #[must_use]
    pub fn at(self, name: &str, value: f64) -> Self {
        self.set(name, number(value))
    }

    /// Appends escaped text.
    #[must_use]
    pub fn text(mut self, text: &str) -> Self {
        self.content.push_str(&escape(text));
        self
    }

    /// Appends a child.
    #[must_use]
    pub fn child(mut self, child: Self) -> Self {
        self.push(child);
        self
    }

    /// Appends a child in place.
    pub fn push(&mut self, child: Self) {
        if self.name != "text" && self.name != "title" {
            self.content.push('\n');
        }
        self.content.push_str(&child.into_string());
    }

    /// Writes the XML text.
    pub fn into_string(self) -> String {
        let Self { name, attributes, content } = self;
        if content.is_empty() {
            format!("<{name}{attributes}/>")
        } else {
            format!("<{name}{attributes}>{content}</{name}>")
        }
    }
}

/// Writes a whole drawing of `width` by `height` px with an accessible title, as a file.
pub fn document(
    width: f64,
    height: f64,
    title: &str,
    body: impl IntoIterator<Item = Element>,
) -> String {
    let mut root = Element::new("svg")
        .set("xmlns", "http://www.w3.org/2000/svg")
        .set("viewBox", format!("0 0 {} {}", number(width), number(height)))
        .at("width", width)
        .at("height", height)
        .set("role", "img")
        .set("font-family", "Helvetica, Arial, sans-serif")
        .child(Element::new("title").text(title));
    for element in body {
        root.push(element);
    }
    root.into_string() + "\n"
}

/// Writes the SVG path data of the polyline through `points` (px), closed where `closed`.
pub fn path_data(points: impl IntoIterator<Item = (f64, f64)>, closed: bool) -> String {
    let mut data = String::new();
    for (i, (x, y)) in points.into_iter().enumerate() {
        data.push_str(&format!("{}{} {}", if i == 0 { "M" } else { "L" }, number(x), number(y)));
    }
    if closed {
        data.push('Z');
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_is_well_formed_and_escaped() {
        let circle = Element::new("circle").at("cx", 1.005).at("r", -0.001).set("fill", "#000");
        let label = Element::new("text").text("a < b & \"c\"");
        let text = document(10.0, 20.0, "R&D", [circle, label]);
        let parsed = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(parsed.root_element().attribute("viewBox"), Some("0 0 10 20"));
        assert!(text.contains(r##"<circle cx="1" r="0" fill="#000"/>"##), "{text}");
        assert!(text.contains("a &lt; b &amp; &quot;c&quot;"));
        assert_eq!(path_data([(0.0, 1.0), (2.5, 3.0)], true), "M0 1L2.5 3Z");
    }
}
