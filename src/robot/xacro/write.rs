//! The expanded description as text again, with where each element of it was written.

use super::tree::{Element, Node, Origin};
use crate::document::{Diagnostic, Source};
use std::rc::Rc;

/// Longest expanded description (bytes).
pub(in crate::robot) const MAX_BYTES: usize = 16 << 20;

/// An expanded description.
#[derive(Debug)]
pub(in crate::robot) struct Expanded {
    /// Its text, under the name of the file that was expanded.
    pub(in crate::robot) source: Source,
    /// What should be known.
    pub(in crate::robot) warnings: Vec<Diagnostic>,
    /// Where its elements begin, and where each was written.
    origins: Vec<(usize, Origin)>,
}

impl Expanded {
    /// Returns `fault` of the expanded text as one of the file in which that was written.
    pub(in crate::robot) fn told(&self, mut fault: Diagnostic) -> Diagnostic {
        if let Some((source, span)) = &fault.place
            && std::sync::Arc::ptr_eq(&source.text, &self.source.text)
        {
            let after = self.origins.partition_point(|(at, _)| *at <= span.start);
            if let Some((_, origin)) = self.origins.get(after.saturating_sub(1)) {
                fault.place = Some((Source::clone(&origin.source), origin.span.clone()));
            }
        }
        fault
    }
}

/// Writes the root of `source`, which is called `name`, with `nodes` in it.
///
/// # Errors
/// Where it is too large.
pub(super) fn write(
    source: &Source,
    root: &Element,
    name: &str,
    nodes: &[Node],
    warnings: Vec<Diagnostic>,
) -> Result<Expanded, Vec<Diagnostic>> {
    let mut writer = Writer { text: String::new(), origins: Vec::new() };
    let root = Rc::new(Element {
        name: root.name.clone(),
        is_xacro: false,
        attributes: match root.attribute("name") {
            Some(_) => vec![("name".to_owned(), name.to_owned())],
            None => Vec::new(),
        },
        children: nodes.to_vec(),
        origin: root.origin.clone(),
    });
    writer.element(&root);
    let length = writer.text.len();
    if length > MAX_BYTES {
        let message = format!(
            "`{}` is too large when expanded: expected at most {MAX_BYTES} bytes, found {length} or more",
            source.name
        );
        return Err(vec![Diagnostic::placeless(message)]);
    }
    let source = Source::new(source.name.clone(), writer.text);
    Ok(Expanded { source, warnings, origins: writer.origins })
}

struct Writer {
    text: String,
    origins: Vec<(usize, Origin)>,
}

impl Writer {
    fn element(&mut self, element: &Element) {
        if self.text.len() > MAX_BYTES {
            return;
        }
        self.origins.push((self.text.len(), element.origin.clone()));
        self.text.push('<');
        self.text.push_str(&element.name);
        for (name, value) in &element.attributes {
            self.text.push(' ');
            self.text.push_str(name);
            self.text.push_str("=\"");
            self.escaped(value);
            self.text.push('"');
        }
        self.text.push('>');
        for child in &element.children {
            match child {
                Node::Element(child) => self.element(child),
                Node::Text(text) => self.escaped(text),
            }
        }
        self.text.push_str("</");
        self.text.push_str(&element.name);
        self.text.push('>');
    }

    fn escaped(&mut self, text: &str) {
        for character in text.chars() {
            match character {
                '&' => self.text.push_str("&amp;"),
                '<' => self.text.push_str("&lt;"),
                '>' => self.text.push_str("&gt;"),
                '"' => self.text.push_str("&quot;"),
                other => self.text.push(other),
            }
        }
    }
}
