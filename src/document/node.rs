//! A YAML document as a tree that remembers where everything stands.

use super::reader::read_node;
use super::{Diagnostic, Source};
use std::ops::Range;

/// Where something is written: bytes of one of a tree's sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Index into [`Tree::sources`]: 0 is the document itself.
    pub source: u16,
    /// First byte.
    pub start: usize,
    /// Byte after the last one.
    pub end: usize,
}

/// One value and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where it stands, without its key.
    pub place: Place,
    /// What it is.
    pub content: Content,
}

/// What a node is, by the core schema of YAML 1.2 without its lossy and ambiguous forms.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// `null`, `~` or nothing at all.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A whole number within the range of `i64` or `u64`.
    Integer(i128),
    /// A finite number written with a point or an exponent.
    Float(f64),
    /// Text, quoted or plain.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// A mapping, in the order written; keys are unique.
    Map(Vec<Entry>),
}

/// One key of a mapping with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Where the key stands.
    pub key_place: Place,
    /// Its value.
    pub value: Node,
}

impl Node {
    /// Returns the value of `key`, where this is a mapping that has it.
    pub fn get(&self, key: &str) -> Option<&Self> {
        self.entry(key).map(|entry| &entry.value)
    }

    /// Returns the entry of `key`, where this is a mapping that has it.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries().iter().find(|entry| entry.key == key)
    }

    /// Returns the entries of a mapping; none for anything else.
    pub fn entries(&self) -> &[Entry] {
        match &self.content {
            Content::Map(entries) => entries,
            _ => &[],
        }
    }

    /// Returns the items of a list; none for anything else.
    pub fn items(&self) -> &[Self] {
        match &self.content {
            Content::List(items) => items,
            _ => &[],
        }
    }

    /// Returns this scalar as one text, the same in whichever form it is written (`0.50` is `0.5`); `None` for lists,
    /// mappings and nothing.
    pub fn scalar_text(&self) -> Option<String> {
        match &self.content {
            Content::Bool(value) => Some(value.to_string()),
            Content::Integer(value) => Some(value.to_string()),
            Content::Float(value) => Some(if *value == 0.0 { 0.0 } else { *value }.to_string()),
            Content::Text(text) => Some(text.clone()),
            Content::Null | Content::List(_) | Content::Map(_) => None,
        }
    }

    /// Says what this is, for messages: ``the text `ten` ``.
    pub fn found(&self) -> String {
        match &self.content {
            Content::Null => "nothing".to_owned(),
            Content::Bool(value) => format!("`{value}`"),
            Content::Integer(value) => format!("the number {value}"),
            Content::Float(value) => format!("the number {value}"),
            Content::Text(text) if text.chars().count() > 40 => {
                format!("the text `{}...`", text.chars().take(37).collect::<String>())
            }
            Content::Text(text) => format!("the text `{text}`"),
            Content::List(_) => "a list".to_owned(),
            Content::Map(_) => "a mapping".to_owned(),
        }
    }

    /// Returns the same value as JSON; the order of keys is lost.
    pub fn to_json(&self) -> serde_json::Value {
        use serde_json::Value;
        match &self.content {
            Content::Null => Value::Null,
            Content::Bool(value) => Value::Bool(*value),
            Content::Integer(value) => u64::try_from(*value)
                .map(Value::from)
                .or_else(|_| i64::try_from(*value).map(Value::from))
                .unwrap_or_default(),
            Content::Float(value) => Value::from(*value),
            Content::Text(text) => Value::String(text.clone()),
            Content::List(items) => Value::Array(items.iter().map(Self::to_json).collect()),
            Content::Map(entries) => {
                Value::Object(entries.iter().map(|e| (e.key.clone(), e.value.to_json())).collect())
            }
        }
    }
}

/// A document's tree with the texts its nodes come from.
#[derive(Debug, Clone)]
pub struct Tree {
    /// The document first, then every text that nodes were grafted from.
    pub sources: Vec<Source>,
    /// The whole document.
    pub root: Node,
}

impl Tree {
    /// Returns the node that the JSON pointer `pointer` (RFC 6901) names.
    pub fn node(&self, pointer: &str) -> Option<&Node> {
        match self.walk(pointer) {
            (node, _, true) => Some(node),
            _ => None,
        }
    }

    /// Returns where the value at `pointer` stands, or the nearest thing around it that is written.
    pub fn place(&self, pointer: &str) -> Place {
        match self.walk(pointer) {
            (node, _, true) => node.place,
            (node, key, false) => key.unwrap_or_else(|| start_of(node)),
        }
    }

    /// Returns where the key of the value at `pointer` stands; for items of lists, where the item does.
    pub fn key_place(&self, pointer: &str) -> Place {
        let (node, key, _) = self.walk(pointer);
        key.unwrap_or_else(|| start_of(node))
    }

    /// Creates an error that says `message` at `place`, cut to the line it begins on.
    pub fn fault(&self, place: Place, message: impl Into<String>) -> Diagnostic {
        let source = &self.sources[usize::from(place.source).min(self.sources.len() - 1)];
        Diagnostic::error(source, first_line(&source.text, place), message)
    }

    /// Puts the YAML value that `source` holds from byte `value_at` on where `path` leads; missing mappings along the
    /// path are made. Each step of the path comes with its bytes in `source`.
    ///
    /// # Errors
    /// Where the value is no YAML or the path leads through something that is neither a mapping nor a list.
    pub fn graft(
        &mut self,
        source: &Source,
        path: &[(&str, Range<usize>)],
        value_at: usize,
    ) -> Result<(), Vec<Diagnostic>> {
        let number = u16::try_from(self.sources.len()).unwrap_or(u16::MAX);
        let value = read_node(source, number, value_at)?;
        self.sources.push(source.clone());
        let mut node = &mut self.root;
        let mut walked = String::new();
        for (step, bytes) in path {
            let key_place = Place { source: number, start: bytes.start, end: bytes.end };
            if node.content == Content::Null {
                node.content = Content::Map(Vec::new());
            }
            let found = node.found();
            node = match &mut node.content {
                Content::Map(entries) => {
                    let at = entries.iter().position(|e| e.key == *step).unwrap_or_else(|| {
                        let value = Node { place: key_place, content: Content::Null };
                        entries.push(Entry { key: (*step).to_owned(), key_place, value });
                        entries.len() - 1
                    });
                    &mut entries[at].value
                }
                Content::List(items) => {
                    let count = items.len();
                    let Some(item) = step.parse::<usize>().ok().and_then(|i| items.get_mut(i))
                    else {
                        let message = format!("`{walked}` has no item {step}");
                        let fault = Diagnostic::error(source, bytes.clone(), message)
                            .label(format!("expected a number below {count}"));
                        return Err(vec![fault]);
                    };
                    item
                }
                _ => {
                    let message = format!("`{walked}` has no keys: it is {found}");
                    return Err(vec![Diagnostic::error(source, bytes.clone(), message)]);
                }
            };
            if !walked.is_empty() {
                walked.push('.');
            }
            walked.push_str(step);
        }
        *node = value;
        Ok(())
    }

    /// Lays what `source` has under `key` beneath what this tree has there: entries that the tree lacks are taken,
    /// mappings that both have are merged likewise, but for those that `is_value` calls values: there the tree's own
    /// stands.
    ///
    /// # Errors
    /// Where `source` is no YAML.
    pub fn underlay(
        &mut self,
        source: &Source,
        key: &str,
        is_value: &dyn Fn(&Node) -> bool,
    ) -> Result<(), Vec<Diagnostic>> {
        let base = self.take_in(source, key)?;
        merge(&mut self.root, base.into_iter().collect(), is_value);
        Ok(())
    }

    /// Does what [`Tree::underlay`] does with one source for each value of `factor`: what they have becomes
    /// `{by: factor, values: {LEVEL: ...}}`, value by value.
    ///
    /// # Errors
    /// Where a source is no YAML.
    pub fn underlay_by(
        &mut self,
        factor: &str,
        sources: &[(String, Source)],
        key: &str,
        is_value: &dyn Fn(&Node) -> bool,
    ) -> Result<(), Vec<Diagnostic>> {
        let mut levels = Vec::new();
        for (level, source) in sources {
            let entry = self.take_in(source, key)?;
            levels.extend(entry.map(|entry| (level.as_str(), entry)));
        }
        let base = side_by_side(factor, levels, is_value);
        merge(&mut self.root, base.into_iter().collect(), is_value);
        Ok(())
    }

    /// Adds `source` to those of this tree and returns its entry `key`.
    fn take_in(&mut self, source: &Source, key: &str) -> Result<Option<Entry>, Vec<Diagnostic>> {
        let number = u16::try_from(self.sources.len()).unwrap_or(u16::MAX);
        let base = read_node(source, number, 0)?;
        self.sources.push(source.clone());
        let Content::Map(base) = base.content else { return Ok(None) };
        Ok(base.into_iter().find(|entry| entry.key == key))
    }

    /// Finds the deepest node towards `pointer`, its key's place, and whether it is what the pointer names.
    fn walk(&self, pointer: &str) -> (&Node, Option<Place>, bool) {
        let (mut node, mut key_place) = (&self.root, None);
        for part in pointer.split('/').skip(1) {
            let part = part.replace("~1", "/").replace("~0", "~");
            let next = match &node.content {
                Content::Map(_) => node.entry(&part).map(|e| (&e.value, Some(e.key_place))),
                Content::List(items) => part
                    .parse::<usize>()
                    .ok()
                    .and_then(|i| items.get(i))
                    .map(|item| (item, Some(item.place))),
                _ => None,
            };
            let Some(found) = next else { return (node, key_place, false) };
            (node, key_place) = found;
        }
        (node, key_place, true)
    }
}

/// Adds `base`'s entries to the mapping `node`, where it is one and lacks them.
fn merge(node: &mut Node, base: Vec<Entry>, is_value: &dyn Fn(&Node) -> bool) {
    let Content::Map(entries) = &mut node.content else { return };
    for theirs in base {
        let Some(ours) = entries.iter_mut().find(|entry| entry.key == theirs.key) else {
            entries.push(theirs);
            continue;
        };
        if is_value(&ours.value) || is_value(&theirs.value) {
            continue;
        }
        if let Content::Map(base) = theirs.value.content {
            merge(&mut ours.value, base, is_value);
        }
    }
}

/// Makes one entry of what several levels of `factor` have under the same key: mappings are gone through, and what is a
/// value is written by the factor. `None` where there is none.
fn side_by_side(
    factor: &str,
    levels: Vec<(&str, Entry)>,
    is_value: &dyn Fn(&Node) -> bool,
) -> Option<Entry> {
    let (_, Entry { key, key_place, value: Node { place, .. } }) = levels.first()?;
    let (key, key_place, place) = (key.clone(), *key_place, *place);
    let is_group =
        |entry: &Entry| matches!(entry.value.content, Content::Map(_)) && !is_value(&entry.value);
    let entry = |key: &str, value: Content| Entry {
        key: key.to_owned(),
        key_place,
        value: Node { place, content: value },
    };
    let content = if levels.iter().all(|(_, entry)| is_group(entry)) {
        let mut keys: Vec<String> = Vec::new();
        for (_, group) in &levels {
            for inner in group.value.entries() {
                if !keys.contains(&inner.key) {
                    keys.push(inner.key.clone());
                }
            }
        }
        let of = |key: &str| {
            let having = levels.iter().filter_map(|(level, group)| {
                group.value.entry(key).map(|inner| (*level, inner.clone()))
            });
            side_by_side(factor, having.collect(), is_value)
        };
        Content::Map(keys.iter().filter_map(|key| of(key)).collect())
    } else {
        let values = levels.into_iter().map(|(level, own)| Entry { key: level.to_owned(), ..own });
        Content::Map(vec![
            entry("by", Content::Text(factor.to_owned())),
            entry("values", Content::Map(values.collect())),
        ])
    };
    Some(Entry { key, key_place, value: Node { place, content } })
}

/// Returns the place of a node as a whole: its first key, where it is a mapping.
pub(super) fn start_of(node: &Node) -> Place {
    node.entries().first().map_or(node.place, |entry| entry.key_place)
}

fn first_line(text: &str, place: Place) -> Range<usize> {
    let start = place.start.min(text.len());
    let end = place.end.clamp(start, text.len());
    let written = text.get(start..end).unwrap_or("");
    let line = written.find('\n').map_or(written.len(), |i| written[..i].trim_end().len());
    start..start + line
}
