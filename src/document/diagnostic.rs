//! One fault in a document: what, where, expected and found, and what to do next.

use annotate_snippets::{AnnotationKind, Level, Origin, Renderer, Snippet};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// How many faults of one document are told, errors first; of the others there is a count. Whoever mends these sees the next
/// ones then, and no document can make us write a thousand times its own length.
pub const MOST_FAULTS: usize = 100;

/// Longest excerpt (bytes) that is shown: nobody reads a line of a megabyte.
const MOST_EXCERPT: usize = 2000;
/// Longest text (characters) of a message, a label or a help.
const MOST_TEXT: usize = 4000;
/// Longest name (characters) that a message quotes.
const MOST_QUOTED: usize = 80;
/// Of how many words the nearest is looked for.
const MOST_CANDIDATES: usize = 2000;

/// A text with the name people know it by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Path or name as the user wrote it.
    pub name: Arc<str>,
    /// The text.
    pub text: Arc<str>,
}

impl Source {
    /// Creates a source of the text `text`, known as `name`.
    pub fn new(name: impl Into<Arc<str>>, text: impl Into<Arc<str>>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// Returns one-based line and column (in characters) of the byte `offset`.
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
    /// How many faults this stands for: one, or as many as there are beyond those that are told.
    pub count: usize,
}

impl Diagnostic {
    /// Creates an error at `span` of `source`.
    pub fn error(source: &Source, span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            place: Some((source.clone(), span)),
            label: String::new(),
            help: None,
            count: 1,
        }
    }

    /// Creates an error that no place in a text can be shown for.
    pub fn placeless(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            place: None,
            label: String::new(),
            help: None,
            count: 1,
        }
    }

    /// Creates what stands for `count` faults beyond those that are listed.
    pub fn others(severity: Severity, count: usize) -> Self {
        let name = match severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let plural = if count == 1 { "" } else { "s" };
        let mut others = Self::placeless(format!("{count} more {name}{plural} like these"))
            .help("mend those above first: many may have one cause");
        others.severity = severity;
        others.count = count;
        others
    }

    /// Turns the fault into a warning.
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

    /// Writes the place as `file:line:column`, if there is one.
    pub fn location(&self) -> Option<String> {
        self.place.as_ref().map(|(source, span)| {
            let (line, column) = source.line_and_column(span.start);
            format!("{}:{line}:{column}", source.name)
        })
    }

    /// Writes the report with a source excerpt, ending in a line feed; with ANSI colours where `color`.
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
        self.render_with(color, &mut LineIndex::default())
    }

    fn render_with(&self, color: bool, index: &mut LineIndex) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let [message, label] = [&self.message, &self.label].map(|text| plain(text));
        let mut report = annotate_snippets::Group::with_title(level.primary_title(message));
        if let Some((source, span)) = &self.place {
            let end = span.end.clamp(span.start, source.text.len().max(span.start));
            // Only the lines that are shown: the renderer takes many times the memory of its text.
            let (first, number, lines) = index.lines_of(&source.text, span.start, end);
            if lines.len() <= MOST_EXCERPT {
                let mut annotation = AnnotationKind::Primary.span(span.start - first..end - first);
                if !label.is_empty() {
                    annotation = annotation.label(label);
                }
                let snippet = Snippet::source(lines).line_start(number).path(plain(&source.name));
                report = report.element(snippet.annotation(annotation));
            } else {
                let before = source.text.get(first..span.start).unwrap_or_default();
                let origin = Origin::path(plain(&source.name)).line(number);
                report = report.element(origin.char_column(before.chars().count() + 1));
                if !label.is_empty() {
                    report = report.element(Level::NOTE.message(label));
                }
            }
        }
        if let Some(help) = &self.help {
            report = report.element(Level::HELP.message(plain(help)));
        }
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let mut text = renderer.render(&[report]);
        text.push('\n');
        text
    }
}

/// Writes the reports of `faults`, each ending in a line feed: errors before warnings, and of more than [`MOST_FAULTS`]
/// the first ones and how many more there are.
pub fn reports(faults: &[Diagnostic], color: bool) -> Vec<String> {
    let mut index = LineIndex::default();
    let of = |severity| faults.iter().filter(move |fault| fault.severity == severity);
    let ordered = of(Severity::Error).chain(of(Severity::Warning));
    let told = ordered.filter(|fault| fault.count == 1).take(MOST_FAULTS);
    let told: Vec<&Diagnostic> = told.collect();
    let mut reports: Vec<String> =
        told.iter().map(|fault| fault.render_with(color, &mut index)).collect();
    for severity in [Severity::Error, Severity::Warning] {
        let all: usize = of(severity).map(|fault| fault.count).sum();
        let left = all - told.iter().filter(|fault| fault.severity == severity).count();
        if left > 0 {
            reports.push(Diagnostic::others(severity, left).render(color));
        }
    }
    reports
}

/// Faults as they are found: the first [`MOST_FAULTS`] of either severity are kept, the others counted.
#[derive(Debug, Clone, Default)]
pub struct FaultList {
    kept: Vec<Diagnostic>,
    errors: usize,
    warnings: usize,
}

impl FaultList {
    /// Takes `fault`, or counts it.
    pub fn push(&mut self, fault: Diagnostic) {
        let found = self.found_mut(fault.severity);
        let before = *found;
        *found += fault.count;
        if before < MOST_FAULTS && fault.count == 1 {
            self.kept.push(fault);
        }
    }

    /// Returns whether a further fault of this severity would only be counted: then it need not be put into words.
    pub fn is_full(&self, severity: Severity) -> bool {
        self.found(severity) >= MOST_FAULTS
    }

    /// Counts an error that need not be put into words.
    pub fn count_error(&mut self) {
        self.errors += 1;
    }

    /// Returns whether there is an error.
    pub fn any_error(&self) -> bool {
        self.errors > 0
    }

    /// Returns whether there is neither an error nor a warning.
    pub fn is_empty(&self) -> bool {
        self.errors + self.warnings == 0
    }

    /// Returns the faults that are kept.
    pub fn kept(&self) -> &[Diagnostic] {
        &self.kept
    }

    /// Returns the faults that are kept, and what stands for the others.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        for severity in [Severity::Error, Severity::Warning] {
            let kept = self.kept.iter().filter(|fault| fault.severity == severity).count();
            let left = self.found(severity) - kept;
            if left > 0 {
                self.kept.push(Diagnostic::others(severity, left));
            }
        }
        self.kept
    }

    fn found(&self, severity: Severity) -> usize {
        match severity {
            Severity::Error => self.errors,
            Severity::Warning => self.warnings,
        }
    }

    fn found_mut(&mut self, severity: Severity) -> &mut usize {
        match severity {
            Severity::Error => &mut self.errors,
            Severity::Warning => &mut self.warnings,
        }
    }
}

impl Extend<Diagnostic> for FaultList {
    fn extend<I: IntoIterator<Item = Diagnostic>>(&mut self, faults: I) {
        for fault in faults {
            self.push(fault);
        }
    }
}

/// Where the lines of texts begin, each text searched once.
#[derive(Default)]
struct LineIndex(Vec<(Arc<str>, Vec<usize>)>);

impl LineIndex {
    fn starts(&mut self, text: &Arc<str>) -> &[usize] {
        let known = self.0.iter().position(|(known, _)| Arc::ptr_eq(known, text));
        let at = known.unwrap_or_else(|| {
            let begins = text.match_indices('\n').map(|(at, _)| at + 1);
            self.0.push((Arc::clone(text), std::iter::once(0).chain(begins).collect()));
            self.0.len() - 1
        });
        &self.0[at].1
    }

    /// Returns the lines of `text` that hold `start..end`, where they begin (byte), and the number of the first, from
    /// 1.
    fn lines_of<'t>(
        &mut self,
        text: &'t Arc<str>,
        start: usize,
        end: usize,
    ) -> (usize, usize, &'t str) {
        let (Some(_), Some(after)) = (text.get(..start), text.get(end..)) else {
            return (0, 1, text);
        };
        let starts = self.starts(text);
        let number = starts.partition_point(|&begin| begin <= start);
        let first = starts[number - 1];
        let last = after.find('\n').map_or(text.len(), |at| end + at);
        (first, number, &text[first..last])
    }
}

/// Returns whether a terminal could take `c` for an order, or turn the direction of writing at it.
pub fn steers(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (c.is_control() && c != '\n')
}

/// Returns `text` cut where it is endless, with nothing in it that steers a terminal.
fn plain(text: &str) -> Cow<'_, str> {
    if text.len() <= MOST_TEXT && !text.chars().any(steers) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::new();
    for (i, c) in text.chars().enumerate() {
        if i == MOST_TEXT {
            shown.push_str("...");
            break;
        }
        if steers(c) { shown.extend(c.escape_unicode()) } else { shown.push(c) }
    }
    Cow::Owned(shown)
}

/// Writes `name` as a message quotes it: cut where it is endless.
pub fn quoted(name: &str) -> Cow<'_, str> {
    match name.char_indices().nth(MOST_QUOTED) {
        None => Cow::Borrowed(name),
        Some((end, _)) => Cow::Owned(format!("{}...", &name[..end])),
    }
}

/// Lists `names` in a row, so many of them that a person still reads them.
pub fn listed(names: &[&str]) -> String {
    const MOST: usize = 40;
    let told: Vec<_> = names.iter().take(MOST).map(|name| quoted(name)).collect();
    match names.len() - told.len() {
        0 => told.join(", "),
        more => format!("{} and {more} more", told.join(", ")),
    }
}

/// Returns the known word nearest to `word`, where one is near enough to be meant.
pub fn suggestion<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = word.chars().count();
    // A word of a page is a slip for nothing, and to compare takes time that grows with both.
    if length > MOST_QUOTED {
        return None;
    }
    known
        .into_iter()
        .take(MOST_CANDIDATES)
        .filter(|candidate| candidate.len() <= 4 * MOST_QUOTED)
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .filter(|(distance, candidate)| {
            // Begun and not ended; or near, with something of the word left: `D` is no slip for `A`.
            let is_begun = length >= 3 && candidate.starts_with(word);
            is_begun || (*distance <= 1 + candidate.chars().count() / 4 && *distance < length)
        })
        .min()
        .map(|(_, candidate)| candidate)
}

/// Says what may have been meant by `word`, which is none of `known`, and what is known.
pub fn known_or_near(word: &str, known: &[&str]) -> String {
    match suggestion(word, known.iter().copied()) {
        Some(near) => format!("did you mean `{}`? (known: {})", quoted(near), listed(known)),
        None if known.is_empty() => "there is none".to_owned(),
        None => format!("known: {}", listed(known)),
    }
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
