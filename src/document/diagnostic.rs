//! One fault in a document: what, where, expected and found, and what to do next.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::ops::Range;
use std::sync::Arc;

/// A text with the name people know it by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Path or name as the user wrote it.
    pub name: Arc<str>,
    /// The text.
    pub text: Arc<str>,
}

impl Source {
    /// The text `text`, known as `name`.
    pub fn new(name: impl Into<Arc<str>>, text: impl Into<Arc<str>>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// One-based line and column (in characters) of the byte `offset`.
    pub fn line_and_column(&self, offset: usize) -> (usize, usize) {
        let mut end = offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Work goes on, but the user should know.
    Warning,
    /// The document cannot be used.
    Error,
}

/// A fault, as a rustc-like report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Whether the document can still be used.
    pub severity: Severity,
    /// What is wrong: a lower-case fragment without a full stop.
    pub message: String,
    /// The text and the bytes of it that are at fault; `None` where a whole file is.
    pub place: Option<(Source, Range<usize>)>,
    /// Said right at the place: expected and found.
    pub label: String,
    /// What to do next.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at `span` of `source`.
    pub fn error(source: &Source, span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            place: Some((source.clone(), span)),
            label: String::new(),
            help: None,
        }
    }

    /// An error that no place in a text can be shown for.
    pub fn placeless(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            place: None,
            label: String::new(),
            help: None,
        }
    }

    /// The same fault as a warning.
    #[must_use]
    pub fn warning(mut self) -> Self {
        self.severity = Severity::Warning;
        self
    }

    /// Says `label` at the place.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Says what to do next.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// `file:line:column` of the place, if there is one.
    pub fn location(&self) -> Option<String> {
        self.place.as_ref().map(|(source, span)| {
            let (line, column) = source.line_and_column(span.start);
            format!("{}:{line}:{column}", source.name)
        })
    }

    /// The report with a source excerpt, ending in a line feed; with ANSI colours where `color`.
    ///
    /// ```text
    /// error: unknown key `trails`
    ///  --> manifests/quickstart.yaml:7:1
    ///   |
    /// 7 | trails: 10
    ///   | ^^^^^^ expected one of the keys of a manifest
    ///   |
    ///   = help: did you mean `trials`?
    /// ```
    pub fn render(&self, color: bool) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level.primary_title(self.message.as_str());
        let mut report = if let Some((source, span)) = &self.place {
            let end = span.end.clamp(span.start, source.text.len().max(span.start));
            // Only the lines that are shown: the renderer takes many times the memory of its text.
            let (first, number, lines) = lines_of(&source.text, span.start, end);
            let mut annotation = AnnotationKind::Primary.span(span.start - first..end - first);
            if !self.label.is_empty() {
                annotation = annotation.label(self.label.as_str());
            }
            let snippet = Snippet::source(lines).line_start(number).path(&*source.name);
            title.element(snippet.annotation(annotation))
        } else {
            annotate_snippets::Group::with_title(title)
        };
        if let Some(help) = &self.help {
            report = report.element(Level::HELP.message(help.as_str()));
        }
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let mut text = renderer.render(&[report]);
        text.push('\n');
        text
    }
}

/// The lines of `text` that hold `start..end`, where they begin (byte), and the number of the first, from 1.
fn lines_of(text: &str, start: usize, end: usize) -> (usize, usize, &str) {
    match (text.get(..start), text.get(end..)) {
        (Some(before), Some(after)) => {
            let first = before.rfind('\n').map_or(0, |at| at + 1);
            let last = after.find('\n').map_or(text.len(), |at| end + at);
            (first, before.matches('\n').count() + 1, &text[first..last])
        }
        _ => (0, 1, text),
    }
}

/// The known word nearest to `word`, where one is near enough to be meant.
pub fn suggestion<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .filter(|(distance, candidate)| {
            let length = word.chars().count();
            // Begun and not ended; or near, with something of the word left: `D` is no slip for `A`.
            let is_begun = length >= 3 && candidate.starts_with(word);
            is_begun || (*distance <= 1 + candidate.chars().count() / 4 && *distance < length)
        })
        .min()
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_shown_where_it_is() {
        let source = Source::new("manifests/a.yaml", "reenact: 1\ntrails: 10\n");
        let fault = Diagnostic::error(&source, 11..17, "unknown key `trails`")
            .label("not a key of a manifest")
            .help("did you mean `trials`?");
        assert_eq!(fault.location().as_deref(), Some("manifests/a.yaml:2:1"));
        assert_eq!(
            fault.render(false),
            "\
error: unknown key `trails`
 --> manifests/a.yaml:2:1
  |
2 | trails: 10
  | ^^^^^^ not a key of a manifest
  |
  = help: did you mean `trials`?
"
        );
    }

    #[test]
    fn a_fault_without_a_place_has_no_excerpt() {
        let fault =
            Diagnostic::placeless("cannot read `a.yaml`: no such file").help("check the path");
        assert_eq!(
            fault.render(false),
            "error: cannot read `a.yaml`: no such file\n |\n = help: check the path\n"
        );
    }

    #[test]
    fn spans_beyond_the_text_do_not_panic() {
        let source = Source::new("é.yaml", "é");
        assert!(Diagnostic::error(&source, 1..99, "x").location().is_some());
        let _ = Diagnostic::error(&source, 2..99, "x").render(false);
    }

    #[test]
    fn near_words_are_suggested_and_far_ones_are_not() {
        assert_eq!(suggestion("footprnt", ["floor-plan", "footprint"]), Some("footprint"));
        assert_eq!(suggestion("zebra", ["floor-plan", "footprint"]), None);
        assert_eq!(suggestion("D", ["A", "B"]), None);
        assert_eq!(suggestion("succes", ["success-percent"]), Some("success-percent"));
    }
}
