//! XML documents read strictly: bounded in size, depth and attributes, every fault with its line.
//!
//! URDF and SDF share this: elements whose text or attributes hold numbers separated by blanks.

use super::{Diagnostic, FaultList, Source, quoted};
use roxmltree::{Document, Node, ParsingOptions};
use std::ops::Range;

/// How deep elements may nest; real descriptions stay below 20.
pub const MAX_DEPTH: usize = 64;

/// How many attributes a tag may have: the parser compares each with each.
const MAX_ATTRIBUTES: usize = 1000;

/// How many nodes a document may have.
const MAX_NODES: u32 = 2_000_000;

/// Parses `source` where it is no longer than `max_bytes`.
///
/// # Errors
/// A document that is too large, too deep or not well-formed; document type definitions are refused.
pub fn parse(source: &Source, max_bytes: usize) -> Result<Document<'_>, Vec<Diagnostic>> {
    let text = &*source.text;
    if text.len() > max_bytes {
        return Err(vec![Diagnostic::placeless(format!(
            "`{}` is too large: expected at most {max_bytes} bytes, found {}",
            source.name,
            text.len()
        ))]);
    }
    if !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        // Nothing of it is quoted: it may be any file, named by a slip.
        let found = if text.trim().is_empty() { "nothing" } else { "text that is none" };
        let message = format!("`{}`: expected XML, found {found}", source.name);
        return Err(vec![Diagnostic::placeless(message)]);
    }
    if let Some(start) = crowded_tag(text) {
        return Err(vec![
            Diagnostic::error(source, start..start + 1, "tag with too many attributes")
                .label(format!("expected at most {MAX_ATTRIBUTES}")),
        ]);
    }
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|fault| {
        let at = offset_of(text, fault.pos());
        let end = text[at..].chars().next().map_or(at, |c| at + c.len_utf8());
        let diagnostic = Diagnostic::error(source, at..end, "not well-formed XML")
            .label(fault.to_string().to_lowercase());
        if matches!(&fault, roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro") {
            return vec![
                diagnostic.help("expand the macros first: `xacro robot.urdf.xacro > robot.urdf`"),
            ];
        }
        vec![diagnostic]
    })?;
    check_depth(source, &document)?;
    Ok(document)
}

/// Returns where a tag begins that has more than [`MAX_ATTRIBUTES`] attributes.
fn crowded_tag(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut start, mut count) = (0, 0);
    for (i, &byte) in bytes.iter().enumerate() {
        match byte {
            b'<' => (start, count) = (i, 0),
            b'"' | b'\'' => {
                let before = bytes[start..i].iter().rev().find(|b| !b.is_ascii_whitespace());
                count += usize::from(before == Some(&b'='));
                if count > MAX_ATTRIBUTES {
                    return Some(start);
                }
            }
            _ => {}
        }
    }
    None
}

fn check_depth(source: &Source, document: &Document<'_>) -> Result<(), Vec<Diagnostic>> {
    // Parents come before their children, so their depth is known.
    let mut depths: Vec<usize> = Vec::new();
    for node in document.descendants() {
        let depth = node.parent().map_or(0, |parent| depths[parent.id().get_usize()] + 1);
        depths.push(depth);
        if depth > MAX_DEPTH {
            return Err(vec![
                Diagnostic::error(source, tag_span(node), "elements nested too deeply")
                    .label(format!("expected at most {MAX_DEPTH} levels")),
            ]);
        }
    }
    Ok(())
}

fn offset_of(text: &str, position: roxmltree::TextPos) -> usize {
    let row = usize::try_from(position.row).unwrap_or(1).max(1) - 1;
    let column = usize::try_from(position.col).unwrap_or(1).max(1) - 1;
    let start: usize = text.split_inclusive('\n').take(row).map(str::len).sum();
    text[start..].char_indices().nth(column).map_or(text.len(), |(i, _)| start + i)
}

/// Returns the bytes of `<name`, so that a report points at one line.
pub fn tag_span(node: Node<'_, '_>) -> Range<usize> {
    let range = node.range();
    let text = &node.document().input_text()[range.clone()];
    let end = text
        .char_indices()
        .skip(1)
        .find(|(_, c)| c.is_whitespace() || matches!(c, '>' | '/'))
        .map_or(text.len(), |(i, _)| i);
    range.start..range.start + end
}

/// Returns the child elements of `node`.
pub fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

/// Returns the first child element called `name`, whatever its namespace.
pub fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    elements(node).find(|child| child.tag_name().name() == name)
}

/// Returns the first child element along `path` (`"ray/scan"`).
pub fn descend<'a, 'i>(node: Node<'a, 'i>, path: &str) -> Option<Node<'a, 'i>> {
    path.split('/').try_fold(node, child)
}

/// Returns the text of `node` without blanks around it; empty where it has none.
pub fn text<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or("").trim()
}

/// Collects every fault of one document.
#[derive(Debug)]
pub struct Faults<'s> {
    source: &'s Source,
    list: FaultList,
}

impl<'s> Faults<'s> {
    /// Creates a list without faults, of `source`.
    pub fn new(source: &'s Source) -> Self {
        Self { source, list: FaultList::default() }
    }

    /// Returns the document that they are of.
    pub fn source(&self) -> &'s Source {
        self.source
    }

    /// Returns whether one of the faults makes the document unusable.
    pub fn any_error(&self) -> bool {
        self.list.any_error()
    }

    /// Returns those of the faults found so far that are kept.
    pub fn kept(&self) -> &[Diagnostic] {
        self.list.kept()
    }

    /// Returns the faults found so far, in the order of the reading.
    pub fn finish(self) -> Vec<Diagnostic> {
        self.list.finish()
    }

    /// Creates a fault of `node`, to be completed and pushed.
    pub fn at(&self, node: Node<'_, '_>, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(self.source, tag_span(node), message)
    }

    /// Records a fault.
    pub fn push(&mut self, fault: Diagnostic) {
        self.list.push(fault);
    }

    /// Reads the text of `node` as exactly `N` finite numbers, or notes a fault.
    pub fn numbers<const N: usize>(&mut self, node: Node<'_, '_>) -> Option<[f64; N]> {
        let span = node
            .first_child()
            .filter(|child| child.is_text() && !text(node).is_empty())
            .map_or_else(|| tag_span(node), |child| trimmed(self.source, child.range()));
        self.parse(text(node), span, &format!("<{}>", node.tag_name().name()))
    }

    /// Reads the text of `node` as a finite number, or notes a fault.
    pub fn number(&mut self, node: Node<'_, '_>) -> Option<f64> {
        self.numbers::<1>(node).map(|[number]| number)
    }

    /// Reads the attribute `name` as exactly `N` finite numbers, or notes a fault; `None` without a fault where absent.
    pub fn attribute<const N: usize>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
    ) -> Option<[f64; N]> {
        let attribute = node.attribute_node(name)?;
        self.parse(attribute.value(), attribute.range_value(), name)
    }

    /// Reads the finite number in the child element `name`; notes a fault where it is missing or malformed.
    pub fn required(&mut self, node: Node<'_, '_>, name: &str, what: &str) -> Option<f64> {
        let Some(found) = child(node, name) else {
            let fault = self
                .at(node, format!("<{}> has no <{name}>", node.tag_name().name()))
                .label(format!("expected {what}"));
            self.push(fault);
            return None;
        };
        self.number(found)
    }

    fn parse<const N: usize>(
        &mut self,
        text: &str,
        span: Range<usize>,
        what: &str,
    ) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        let mut count = 0;
        for token in text.split_whitespace() {
            match token.parse::<f64>() {
                Ok(number) if number.is_finite() => {
                    if let Some(slot) = numbers.get_mut(count) {
                        *slot = number;
                    }
                    count += 1;
                }
                _ => {
                    self.list.push(
                        Diagnostic::error(self.source, span, format!("malformed number in {what}"))
                            .label(format!("expected a finite number, found `{}`", quoted(token))),
                    );
                    return None;
                }
            }
        }
        if count == N {
            return Some(numbers);
        }
        let expected = if N == 1 { "1 number".to_owned() } else { format!("{N} numbers") };
        self.list.push(
            Diagnostic::error(self.source, span, format!("wrong count of numbers in {what}"))
                .label(format!("expected {expected}, found {count}")),
        );
        None
    }
}

fn trimmed(source: &Source, range: Range<usize>) -> Range<usize> {
    let text = &source.text[range.clone()];
    let start = range.start + (text.len() - text.trim_start().len());
    start..start + text.trim().len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> String {
        parse(&Source::new("a.urdf", text), 100_000).unwrap_err()[0].render(false)
    }

    #[test]
    fn what_is_not_xml_says_where() {
        assert_eq!(
            fault("<robot>\n  <link name=\"a\">\n</robot>\n"),
            "\
error: not well-formed XML
 --> a.urdf:3:1
  |
3 | </robot>
  | ^ expected 'link' tag, not 'robot' at 3:1
"
        );
        assert!(fault("<robot><xacro:if/></robot>").contains("expand the macros first"));
        assert!(fault("<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>").contains("not well-formed"));
    }

    #[test]
    fn bombs_are_refused_before_they_cost_time() {
        let deep = "<a>".repeat(1000) + &"</a>".repeat(1000);
        assert!(fault(&deep).contains("nested too deeply"));
        let crowded = " a=''".repeat(2000);
        assert!(fault(&format!("<a{crowded}/>")).contains("too many attributes"));
        assert_eq!(
            fault(&" ".repeat(100_001)),
            "error: `a.urdf` is too large: expected at most 100000 bytes, found 100001\n"
        );
    }

    #[test]
    fn numbers_are_finite_and_as_many_as_expected() {
        let source = Source::new("a.sdf", "<pose>\n 1 2 nan\n</pose>");
        let document = parse(&source, 1000).unwrap();
        let mut faults = Faults::new(&source);
        assert_eq!(faults.numbers::<3>(document.root_element()), None);
        assert_eq!(
            faults.list.kept()[0].render(false),
            "\
error: malformed number in <pose>
 --> a.sdf:2:2
  |
2 |  1 2 nan
  |  ^^^^^^^ expected a finite number, found `nan`
"
        );
        let source = Source::new("a.sdf", "<size>1 2</size>");
        let document = parse(&source, 1000).unwrap();
        let mut faults = Faults::new(&source);
        assert_eq!(faults.numbers::<2>(document.root_element()), Some([1.0, 2.0]));
        assert_eq!(faults.numbers::<3>(document.root_element()), None);
        assert_eq!(faults.list.kept()[0].label, "expected 3 numbers, found 2");
    }
}
