//! Drawings embedded in a page: only drawing elements survive.
//!
//! A bundle may come from a stranger. Its figures are parsed and written anew from a closed list of elements
//! and attributes, so that no script, link, style sheet or external picture can ride along.

use crate::figure::svg::escape;
use roxmltree::{Document, Node};

const ELEMENTS: [&str; 11] =
    ["svg", "g", "path", "rect", "circle", "line", "polyline", "polygon", "text", "tspan", "title"];

const ATTRIBUTES: [&str; 37] = [
    "viewBox",
    "transform",
    "class",
    "d",
    "x",
    "y",
    "x1",
    "y1",
    "x2",
    "y2",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "dx",
    "dy",
    "points",
    "width",
    "height",
    "fill",
    "fill-opacity",
    "fill-rule",
    "opacity",
    "stroke",
    "stroke-width",
    "stroke-opacity",
    "stroke-dasharray",
    "stroke-linejoin",
    "stroke-linecap",
    "font-size",
    "font-family",
    "font-weight",
    "font-style",
    "text-anchor",
    "dominant-baseline",
    "shape-rendering",
];

/// Rewrites `text` as an element for a page, named `alt`; `None` where it is not SVG.
///
/// Size comes from the view box alone: the page decides how wide a figure is.
pub(super) fn inline_svg(text: &str, alt: &str) -> Option<String> {
    let document = Document::parse(text).ok()?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return None;
    }
    let mut out = String::new();
    write(root, Some(alt), &mut out);
    Some(out)
}

fn write(node: Node, alt: Option<&str>, out: &mut String) {
    let name = node.tag_name().name();
    if !ELEMENTS.contains(&name) || alt.is_some() != (name == "svg") {
        return;
    }
    out.push('<');
    out.push_str(name);
    for attribute in node.attributes() {
        let (key, value) = (attribute.name(), attribute.value());
        let sized = alt.is_some() && matches!(key, "width" | "height");
        // `url(...)` could fetch; nothing we draw refers to anything.
        let refers = value.to_ascii_lowercase().contains("url");
        if ATTRIBUTES.contains(&key) && attribute.namespace().is_none() && !sized && !refers {
            out.push_str(&format!(" {key}=\"{}\"", escape(value)));
        }
    }
    if let Some(alt) = alt {
        out.push_str(&format!(" role=\"img\" aria-label=\"{}\"", escape(alt)));
        if let Some(width) = node.attribute("width").and_then(|w| w.parse::<f64>().ok()) {
            // Never blown up: text in figures is as large as the page's own.
            out.push_str(&format!(" style=\"max-width:{}px\"", width.clamp(100.0, 2000.0)));
        }
    }
    out.push('>');
    for child in node.children() {
        if child.is_text() && matches!(name, "text" | "tspan" | "title") {
            out.push_str(&escape(child.text().unwrap_or_default()));
        } else if child.is_element() && !(alt.is_some() && child.tag_name().name() == "title") {
            write(child, None, out);
        }
    }
    out.push_str(&format!("</{name}>"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_draws_survives() {
        let hostile = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9" width="9" onload="a()">
            <script>alert(1)</script><style>@import "x"</style><image href="http://x/"/>
            <a href="javascript:a()"><rect/></a><foreignObject/><svg/>
            <g onclick="a()"><rect x="1" fill="url(http://x)" style="y"/><text>a &lt; b</text></g></svg>"#;
        assert_eq!(
            inline_svg(hostile, "a \"figure\"").unwrap(),
            "<svg viewBox=\"0 0 9 9\" role=\"img\" aria-label=\"a &quot;figure&quot;\" \
             style=\"max-width:100px\"><g><rect x=\"1\"></rect><text>a &lt; b</text></g></svg>"
        );
        assert_eq!(inline_svg("<svg", "x"), None);
        assert_eq!(inline_svg("<html/>", "x"), None);
    }
}
