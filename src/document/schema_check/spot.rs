//! Where in a document a check is.

use super::faults::Fault;
use crate::document::node::{Content, Entry, Node, Place, start_of};
use crate::document::quoted;

/// A node, how it is reached and where to point when something is missing from it.
#[derive(Clone, Copy)]
pub(super) struct Spot<'a> {
    pub(super) node: &'a Node,
    /// Where its key stands, or the node itself.
    pub(super) key: Place,
    pub(super) above: Option<&'a Spot<'a>>,
    pub(super) step: Step<'a>,
}

#[derive(Clone, Copy)]
pub(super) enum Step<'a> {
    Root,
    Key(&'a str),
    Item(usize),
}

impl<'a> Spot<'a> {
    pub(super) fn root(node: &'a Node) -> Self {
        Self { node, key: start_of(node), above: None, step: Step::Root }
    }

    pub(super) fn entry(&'a self, entry: &'a Entry) -> Self {
        Self {
            node: &entry.value,
            key: entry.key_place,
            above: Some(self),
            step: Step::Key(&entry.key),
        }
    }

    pub(super) fn item(&'a self, number: usize, node: &'a Node) -> Self {
        Self { node, key: start_of(node), above: Some(self), step: Step::Item(number) }
    }

    /// Writes the path as `--set` takes it, such as `parameters.sensing.range-m`; empty for the whole document.
    pub(super) fn path(&self) -> String {
        let above = self.above.map_or_else(String::new, Spot::path);
        match self.step {
            Step::Root => above,
            Step::Key(key) if above.is_empty() => quoted(key).into_owned(),
            Step::Key(key) => format!("{above}.{}", quoted(key)),
            Step::Item(number) => format!("{above}[{number}]"),
        }
    }

    /// Returns the path in backquotes, or words for the whole document.
    pub(super) fn name(&self) -> String {
        let path = self.path();
        if path.is_empty() { "the document".to_owned() } else { format!("`{path}`") }
    }

    pub(super) fn fault(&self, message: impl Into<String>, label: impl Into<String>) -> Fault {
        Fault {
            // What is not written can only be shown by its key.
            place: if self.node.content == Content::Null { self.key } else { self.node.place },
            message: message.into(),
            label: label.into(),
            help: None,
        }
    }
}
