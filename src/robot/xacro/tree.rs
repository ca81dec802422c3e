//! A file as xacro sees it: elements that may be copied, each with where it is written.

use crate::document::xml;
use crate::document::{Diagnostic, Source};
use std::ops::Range;
use std::rc::Rc;

/// Longest file read (bytes).
const MAX_BYTES: usize = 1 << 20;

/// Where something is written.
#[derive(Debug, Clone)]
pub(super) struct Origin {
    pub(super) source: Rc<Source>,
    pub(super) span: Range<usize>,
}

impl Origin {
    /// Creates an error at this place.
    pub(super) fn fault(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(&self.source, self.span.clone(), message)
    }
}

/// An element.
#[derive(Debug)]
pub(super) struct Element {
    /// Its name without a prefix.
    pub(super) name: String,
    /// Whether its name is one of xacro's namespace.
    pub(super) is_xacro: bool,
    /// Names without prefixes, and values.
    pub(super) attributes: Vec<(String, String)>,
    pub(super) children: Vec<Node>,
    pub(super) origin: Origin,
}

/// What stands in an element.
#[derive(Debug, Clone)]
pub(super) enum Node {
    Element(Rc<Element>),
    Text(Rc<str>),
}

impl Element {
    /// Returns the attribute `name`.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }
}

/// Returns whether `uri` names xacro's namespace, of which there were several.
fn is_xacro(uri: Option<&str>) -> bool {
    uri.is_some_and(|uri| uri.contains("xacro"))
}

/// Reads a file.
///
/// # Errors
/// Where it is no XML.
pub(super) fn read(source: &Source) -> Result<Rc<Element>, Vec<Diagnostic>> {
    let declared = declared(source);
    let source = Rc::new(declared);
    let document = xml::parse(&source, MAX_BYTES)?;
    Ok(copy(document.root_element(), &source))
}

/// Returns the source with xacro's namespace declared: files that are included often leave that to the one that includes
/// them, and xacro itself does not mind.
fn declared(source: &Source) -> Source {
    let text = &*source.text;
    if text.contains("xmlns:xacro") || !text.contains("<xacro:") {
        return source.clone();
    }
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|n| at + n) {
        let rest = &text[start + 1..];
        if rest.starts_with("!--") {
            at = rest.find("-->").map_or(text.len(), |end| start + 1 + end);
        } else if rest.starts_with(['?', '!']) {
            at = start + 1;
        } else {
            let end = rest.find(|c: char| c.is_whitespace() || matches!(c, '>' | '/'));
            let end = start + 1 + end.unwrap_or(rest.len());
            let (head, tail) = text.split_at(end);
            let uri = "http://www.ros.org/wiki/xacro";
            return Source::new(source.name.clone(), format!("{head} xmlns:xacro=\"{uri}\"{tail}"));
        }
    }
    source.clone()
}

fn copy(node: roxmltree::Node<'_, '_>, source: &Rc<Source>) -> Rc<Element> {
    let children = node.children().filter_map(|child| {
        if child.is_element() {
            return Some(Node::Element(copy(child, source)));
        }
        child.is_text().then(|| Node::Text(child.text().unwrap_or_default().into()))
    });
    Rc::new(Element {
        name: node.tag_name().name().to_owned(),
        is_xacro: is_xacro(node.tag_name().namespace()),
        attributes: node
            .attributes()
            // SDF's own attributes with a prefix say nothing that is used.
            .filter(|attribute| attribute.namespace().is_none() || is_xacro(attribute.namespace()))
            .map(|attribute| (attribute.name().to_owned(), attribute.value().to_owned()))
            .collect(),
        children: children.collect(),
        origin: Origin { source: Rc::clone(source), span: xml::tag_span(node) },
    })
}
