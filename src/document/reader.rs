//! Reads YAML into a tree, refusing what is lossy, ambiguous between YAML 1.1 and 1.2, or a trap: duplicate
//! keys, merge keys, tags, directives, `yes`/`no`, octal-looking and non-finite numbers, alias bombs.

mod scalar;

use super::node::{Content, Entry, Node, Place, Tree};
use super::{Diagnostic, FaultList, Severity, Source, quoted, secret};
use scalar::plain_scalar;
use serde_yaml::granit_parser::{Event, Parser, ScalarStyle, Span, StrInput, options};
use std::collections::BTreeMap;

/// More nodes than any manifest or world has; stops alias bombs.
const MOST_NODES: usize = 250_000;
/// Most text (bytes) that anchors and aliases may repeat.
const MOST_REPEATED: usize = 1 << 22;
/// Deeper than any document we define; keeps every recursion over a tree shallow.
const MOST_NESTING: usize = 48;
/// What some editors put before a text.
const BYTE_ORDER_MARK: char = '\u{feff}';
/// How faults of the syntax begin.
const INVALID: &str = "not valid YAML: ";

/// Reads the tree of `source`, or every fault in its text.
///
/// # Errors
/// All scalars and keys that are refused, or the first fault of the syntax.
pub fn read(source: &Source) -> Result<Tree, Vec<Diagnostic>> {
    if let Some(found) = secret(&source.text) {
        let message = format!("`{}`: expected a YAML mapping, found {found}", source.name);
        return Err(vec![Diagnostic::placeless(message)]);
    }
    // Editors of some systems begin a file with a byte order mark, which is no part of the text.
    let begins =
        if source.text.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len_utf8() } else { 0 };
    let mut reader = Reader::new(source, 0, begins);
    let root = reader.document();
    match reader.finish(root) {
        Ok(root) => Ok(Tree { sources: vec![source.clone()], root }),
        // Of what is no document of ours nothing is quoted: it may be a key or a list of passwords, named by a slip.
        Err((faults, false)) => {
            let why = faults.iter().find_map(|fault| {
                let (source, span) = fault.place.as_ref()?;
                let (line, _) = source.line_and_column(span.start);
                // The parser's own words quote nothing; all others do.
                Some(match fault.message.strip_prefix(INVALID) {
                    Some(info) => format!(" (line {line}: {info})"),
                    None => format!(" (line {line})"),
                })
            });
            Err(vec![Diagnostic::placeless(format!(
                "`{}`: expected a YAML mapping, found text that is none{}",
                source.name,
                why.unwrap_or_default()
            ))])
        }
        Err((faults, true)) => Err(faults),
    }
}

/// Reads the node that the text of `source` from byte `offset` on holds, its places in source number `number`.
pub(super) fn read_node(
    source: &Source,
    number: u16,
    offset: usize,
) -> Result<Node, Vec<Diagnostic>> {
    let mut reader = Reader::new(source, number, offset);
    let node = reader.document();
    reader.finish(node).map_err(|(faults, _)| faults)
}

/// A fault after which nothing more can be read.
type Stop = Box<Diagnostic>;

struct Reader<'a> {
    events: Parser<'a, StrInput<'a>>,
    source: &'a Source,
    number: u16,
    /// Where in the source the parsed text begins.
    offset: usize,
    /// Line of the source on which it begins, from 0.
    line: usize,
    /// Finished anchored nodes, with how large each is.
    anchors: BTreeMap<usize, (Node, Extent)>,
    nodes: usize,
    /// Nodes and bytes that were copied for anchors and aliases.
    copied: (usize, usize),
    /// Whether the document is a mapping, as far as it was read.
    is_map: bool,
    faults: FaultList,
}

/// How large a node is with all that it holds.
#[derive(Debug, Clone, Copy, Default)]
struct Extent {
    nodes: usize,
    height: usize,
    bytes: usize,
}

impl Extent {
    fn of(node: &Node) -> Self {
        let text = match &node.content {
            Content::Text(text) => text.len(),
            _ => 0,
        };
        let keys: usize = node.entries().iter().map(|entry| entry.key.len()).sum();
        let mut extent = Self { nodes: 1, height: 0, bytes: text + keys };
        let values = node.entries().iter().map(|entry| &entry.value);
        for inner in node.items().iter().chain(values).map(Self::of) {
            extent.nodes += inner.nodes;
            extent.bytes += inner.bytes;
            extent.height = extent.height.max(inner.height + 1);
        }
        extent
    }
}

impl<'a> Reader<'a> {
    /// Creates a reader of the text of `source` from byte `offset` on, whose places are in source number `number`.
    fn new(source: &'a Source, number: u16, offset: usize) -> Self {
        let options = options! { disallow_directives: true, emit_comments: false };
        Self {
            events: Parser::new_from_str_with_options(&source.text[offset..], options),
            source,
            number,
            offset,
            line: source.text[..offset].matches('\n').count(),
            anchors: BTreeMap::new(),
            nodes: 0,
            copied: (0, 0),
            is_map: false,
            faults: FaultList::default(),
        }
    }

    /// Returns what was read, or every fault and whether the document is a mapping at all.
    fn finish(mut self, node: Result<Node, Stop>) -> Result<Node, (Vec<Diagnostic>, bool)> {
        match node {
            Ok(node) if self.faults.is_empty() => return Ok(node),
            Ok(_) => {}
            Err(fault) => self.faults.push(*fault),
        }
        Err((self.faults.finish(), self.is_map))
    }

    fn document(&mut self) -> Result<Node, Stop> {
        let mut root = None;
        while let Some((event, span)) = self.next()? {
            match event {
                Event::StreamEnd => break,
                Event::DocumentStart(..) if root.is_some() => {
                    let place = self.place(&span);
                    return Err(Box::new(
                        self.fault(place, "a second document begins here")
                            .label("expected the end of the file")
                            .help("keep one document per file and remove the `---` line"),
                    ));
                }
                event if event.is_node() => {
                    self.is_map = matches!(event, Event::MappingStart(..));
                    root = Some(self.node(event, &span, 0)?);
                }
                _ => {}
            }
        }
        let nothing = Place { source: self.number, start: self.offset, end: self.offset };
        Ok(root.unwrap_or(Node { place: nothing, content: Content::Null }))
    }

    fn next(&mut self) -> Result<Option<(Event<'a>, Span)>, Stop> {
        match self.events.next() {
            None => Ok(None),
            Some(Ok(next)) => Ok(Some(next)),
            Some(Err(error)) => {
                let length = self.source.text.len();
                let at = error.marker().byte_offset().map_or(length, |b| b + self.offset);
                let next = self.source.text.get(at..).and_then(|rest| rest.chars().next());
                let end = next.map_or(at, |c| at + c.len_utf8());
                let place = Place { source: self.number, start: at, end };
                let info = error.info();
                Err(Box::new(self.fault(place, format!("{INVALID}{info}"))))
            }
        }
    }

    /// Reads the node that begins with `event`.
    fn node(&mut self, event: Event<'a>, span: &Span, depth: usize) -> Result<Node, Stop> {
        let place = self.place(span);
        self.nodes += 1;
        if self.nodes > MOST_NODES {
            return Err(Box::new(
                self.fault(place, format!("the document has more than {MOST_NODES} values"))
                    .help("aliases (`*name`) multiply what they stand for: use fewer"),
            ));
        }
        if depth > MOST_NESTING {
            return Err(Box::new(self.too_deep(place)));
        }
        if event.tag().is_some() {
            let tag = span.tag_span().map_or(place, |tag| self.place(&tag));
            let fault = self
                .fault(tag, "tags (`!name`) are not used here")
                .help("remove the tag; a choice is written as `{name: settings}`");
            self.faults.push(fault);
        }
        let anchor = event.anchor_id();
        let node = match event {
            Event::Scalar(text, style, ..) => {
                let plain = style == ScalarStyle::Plain;
                Node { place, content: self.scalar(&text, plain, place) }
            }
            Event::SequenceStart(..) => {
                let mut items = Vec::new();
                let mut end = place.end;
                while let Some((event, span)) = self.next()? {
                    if matches!(event, Event::SequenceEnd) {
                        end = self.end_of(&span, end);
                        break;
                    }
                    if event.is_node() {
                        let item = self.node(event, &span, depth + 1)?;
                        end = end.max(item.place.end);
                        items.push(item);
                    }
                }
                Node { place: Place { end, ..place }, content: Content::List(items) }
            }
            Event::MappingStart(..) => self.map(place, depth)?,
            Event::Alias(id) => {
                let Some((_, extent)) = self.anchors.get(&id) else {
                    return Err(Box::new(self.fault(place, "an alias cannot stand inside itself")));
                };
                let extent = *extent;
                self.nodes += extent.nodes;
                if depth + extent.height > MOST_NESTING {
                    return Err(Box::new(self.too_deep(place)));
                }
                self.copy(extent, place)?;
                self.anchors[&id].0.clone()
            }
            _ => Node { place, content: Content::Null },
        };
        if let Some(id) = anchor {
            let extent = Extent::of(&node);
            self.copy(extent, place)?;
            self.anchors.insert(id, (node.clone(), extent));
        }
        Ok(node)
    }

    /// Accounts for a copy of what is so large, made at `place`.
    fn copy(&mut self, extent: Extent, place: Place) -> Result<(), Stop> {
        self.copied.0 += extent.nodes;
        self.copied.1 += extent.bytes;
        if self.copied.0 <= MOST_NODES && self.copied.1 <= MOST_REPEATED {
            return Ok(());
        }
        let message = format!(
            "aliases repeat more than {MOST_NODES} values or {MOST_REPEATED} bytes of the document"
        );
        let fault = self.fault(place, message);
        Err(Box::new(fault.help("write less under anchors (`&name`), or repeat it less often")))
    }

    fn map(&mut self, place: Place, depth: usize) -> Result<Node, Stop> {
        let mut entries: Vec<Entry> = Vec::new();
        // With the line of each.
        let mut known: BTreeMap<String, usize> = BTreeMap::new();
        let mut end = place.end;
        while let Some((event, span)) = self.next()? {
            if matches!(event, Event::MappingEnd) {
                end = self.end_of(&span, end);
                break;
            }
            if !event.is_node() {
                continue;
            }
            let key_place = self.place(&span);
            let line = self.line + span.start.line();
            let plain = matches!(&event, Event::Scalar(_, ScalarStyle::Plain, ..));
            let text = event.scalar().map(|(text, _)| text.to_owned());
            let Some(text) = text else {
                let fault = self
                    .fault(key_place, "a key must be a plain name")
                    .label("found an alias, a list or a mapping");
                self.faults.push(fault);
                // Read on, so that the rest of the document keeps its structure.
                self.node(event, &span, depth + 1)?;
                if let Some((event, span)) = self.next()? {
                    self.node(event, &span, depth + 1)?;
                }
                continue;
            };
            let key = self.key(&text, plain, event.tag().is_some(), key_place);
            let Some((event, span)) = self.next()? else { break };
            let value = self.node(event, &span, depth + 1)?;
            end = end.max(value.place.end);
            if let Some(line) = known.insert(key.clone(), line) {
                let quoted = quoted(&key);
                self.note(|reader| {
                    reader
                        .fault(key_place, format!("duplicate key `{quoted}`"))
                        .label(format!("already written on line {line}"))
                        .help("remove one of the two")
                });
            }
            entries.push(Entry { key, key_place, value });
        }
        Ok(Node { place: Place { end, ..place }, content: Content::Map(entries) })
    }

    /// Returns the name of a key; a number has one, however it is written: `0.50` and `0.5` are the same key.
    fn key(&mut self, text: &str, plain: bool, tagged: bool, place: Place) -> String {
        if plain && text == "<<" {
            let fault =
                self.fault(place, "merge keys (`<<`) are not used here").help("write the keys out");
            self.faults.push(fault);
        }
        if tagged {
            self.faults.push(self.fault(place, "a key cannot have a tag"));
        }
        let content = self.scalar(text, plain, place);
        Node { place, content }.scalar_text().unwrap_or_else(|| {
            self.faults.push(self.fault(place, "a key must have a name"));
            String::new()
        })
    }

    /// Reads what the scalar `text` is; what is refused is noted and read as text.
    fn scalar(&mut self, text: &str, plain: bool, place: Place) -> Content {
        if !plain {
            return Content::Text(text.to_owned());
        }
        let (message, help) = match plain_scalar(text) {
            Ok(content) => return content,
            Err(refused) => refused,
        };
        self.note(|reader| reader.fault(place, message).help(help));
        Content::Text(text.to_owned())
    }

    fn place(&self, span: &Span) -> Place {
        let length = self.source.text.len() - self.offset;
        let range = span.byte_range().unwrap_or(length..length);
        let (start, end) = (range.start + self.offset, range.end + self.offset);
        Place { source: self.number, start, end: end.max(start) }
    }

    /// Returns where a collection ends: at its closing bracket; a block's end event lies behind it.
    fn end_of(&self, span: &Span, last: usize) -> usize {
        let place = self.place(span);
        if place.end > place.start { place.end } else { last }
    }

    /// Collects the fault that `made` puts into words, or only counts it where the list is full.
    fn note(&mut self, made: impl FnOnce(&Self) -> Diagnostic) {
        if self.faults.is_full(Severity::Error) {
            self.faults.count_error();
        } else {
            let fault = made(self);
            self.faults.push(fault);
        }
    }

    fn fault(&self, place: Place, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(self.source, place.start..place.end, message)
    }

    fn too_deep(&self, place: Place) -> Diagnostic {
        self.fault(place, format!("nested more than {MOST_NESTING} levels deep"))
    }
}
