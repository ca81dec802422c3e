//! What names stand for while a file is expanded: properties and blocks, in a scope for every macro that is open.

use super::tree::Node;
use super::value::Value;
use std::collections::BTreeMap;
use std::rc::Rc;

/// What a property holds.
#[derive(Debug, Clone)]
pub(super) enum Property {
    Value(Value),
    /// Text that is worked out when it is first asked for.
    Written(Rc<str>),
    /// It is being worked out: whoever asks for it now is part of it.
    Open,
}

/// Elements with a name.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) nodes: Rc<[Node]>,
    /// Whether they are expanded: those handed to a macro are, those of a property are not.
    pub(super) is_expanded: bool,
}

/// The names of one macro, or of the file.
#[derive(Debug, Default)]
struct Scope {
    properties: BTreeMap<String, Property>,
    blocks: BTreeMap<String, Block>,
}

/// All scopes, the file's first. As in xacro, a macro sees what its caller sees.
#[derive(Debug)]
pub(super) struct Scopes(Vec<Scope>);

impl Scopes {
    pub(super) fn new() -> Self {
        Self(vec![Scope::default()])
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn open(&mut self) {
        self.0.push(Scope::default());
    }

    pub(super) fn close(&mut self) {
        self.0.pop();
    }

    /// Returns the property `name` that the scopes below `top` see, and in which of them it is.
    pub(super) fn property(&self, name: &str, top: usize) -> Option<(usize, &Property)> {
        let mut scopes = self.0[..top].iter().enumerate().rev();
        scopes.find_map(|(at, scope)| Some((at, scope.properties.get(name)?)))
    }

    /// Sets the property `name` in the scope `at`.
    pub(super) fn set(&mut self, at: usize, name: &str, property: Property) {
        self.0[at].properties.insert(name.to_owned(), property);
    }

    /// Returns the block `name`.
    pub(super) fn block(&self, name: &str) -> Option<Block> {
        self.0.iter().rev().find_map(|scope| scope.blocks.get(name)).cloned()
    }

    /// Sets the block `name` in the scope `at`.
    pub(super) fn set_block(&mut self, at: usize, name: &str, block: Block) {
        self.0[at].blocks.insert(name.to_owned(), block);
    }
}
