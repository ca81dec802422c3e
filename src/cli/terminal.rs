//! Where words go: results to stdout, everything else to stderr; colour only where a person looks.

use crate::document::{Diagnostic, Severity, reports, steers};
use crate::provenance::Environment;
use crate::store::reason;
use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a result could not be written.
static LOST: AtomicBool = AtomicBool::new(false);

/// The two streams of the process.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact of its own about whoever reads")]
pub(super) struct Terminal {
    color: bool,
    watched: bool,
    utf8: bool,
    /// Whether a program reads progress from stderr.
    heard: bool,
}

impl Terminal {
    pub(super) fn new(environment: &Environment) -> Self {
        let heard = environment.progress_as_json;
        let watched = std::io::stderr().is_terminal() && !heard;
        Self { color: watched && !environment.no_color, watched, utf8: environment.utf8, heard }
    }

    pub(super) fn plain() -> Self {
        Self { color: false, watched: false, utf8: false, heard: false }
    }

    /// Returns whether a person watches stderr: bars are drawn for people only.
    pub(super) fn is_watched(self) -> bool {
        self.watched
    }

    /// Returns whether a program reads progress from stderr: then it is told in lines of JSON.
    pub(super) fn is_heard(self) -> bool {
        self.heard
    }

    /// Returns whether the terminal's character set has more than ASCII.
    pub(super) fn utf8(self) -> bool {
        self.utf8
    }

    /// Returns how many characters fit on a line of stdout: those of the terminal, 80 where it is none. Less than 40 is
    /// legible to nobody.
    #[expect(clippy::unused_self, reason = "whoever writes asks the terminal")]
    pub(super) fn columns(self) -> usize {
        let size = console::Term::stdout().size_checked();
        size.map_or(80, |(_, columns)| usize::from(columns)).max(40)
    }

    pub(super) fn color(self) -> bool {
        self.color
    }

    /// Writes a result. A reader who has gone away (a closed pipe) is no fault of ours.
    pub(super) fn result(self, text: &str) {
        let text = plain(text);
        let mut out = std::io::stdout().lock();
        let end = if text.ends_with('\n') { "" } else { "\n" };
        let written = out
            .write_all(text.as_bytes())
            .and_then(|()| out.write_all(end.as_bytes()))
            .and_then(|()| out.flush());
        if let Err(error) = written.or_else(|e| match e.kind() {
            ErrorKind::BrokenPipe => Ok(()),
            _ => Err(e),
        }) {
            self.error(&format!("cannot write the result: {}", reason(&error)));
            LOST.store(true, Ordering::Relaxed);
        }
    }

    /// Returns whether a result could not be written: then the command has failed, whatever it found.
    pub(super) fn has_lost_results() -> bool {
        LOST.load(Ordering::Relaxed)
    }

    /// Writes a note to stderr.
    pub(super) fn note(self, text: &str) {
        self.styled(&plain(text));
    }

    /// Writes what may have colours of ours to stderr.
    #[expect(clippy::unused_self, reason = "all output goes through the terminal")]
    fn styled(self, text: &str) {
        let _ = writeln!(std::io::stderr().lock(), "{}", text.trim_end_matches('\n'));
    }

    pub(super) fn error(self, message: &str) {
        self.told("error", "31", message);
    }

    pub(super) fn warning(self, message: &str) {
        self.told("warning", "33", message);
    }

    fn told(self, kind: &str, color: &str, message: &str) {
        let message = plain(message);
        if self.color {
            self.styled(&format!("\u{1b}[1;{color}m{kind}\u{1b}[0m: {message}"));
        } else {
            self.styled(&format!("{kind}: {message}"));
        }
    }

    /// Writes why a command gave up: whole reports as they are, a bare sentence as an error.
    pub(super) fn failure(self, message: &str) {
        if message.contains('\n') { self.note(message) } else { self.error(message) }
    }

    /// Writes reports, separated by empty lines.
    pub(super) fn diagnostics(self, diagnostics: &[Diagnostic]) {
        for report in reports(diagnostics, self.color) {
            // A report has nothing in it that steers a terminal but its colours.
            self.styled(&report);
            let _ = writeln!(std::io::stderr().lock());
        }
    }

    /// Counts errors and warnings in words: `2 errors, 1 warning`.
    pub(super) fn count(diagnostics: &[Diagnostic]) -> String {
        let of = |severity| diagnostics.iter().filter(move |d| d.severity == severity);
        let count = |severity| of(severity).map(|d| d.count).sum();
        let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
        let mut parts = Vec::new();
        if errors > 0 {
            parts.push(counted(errors, "error"));
        }
        if warnings > 0 {
            parts.push(counted(warnings, "warning"));
        }
        parts.join(", ")
    }
}

/// Returns `text` with nothing in it by which a stranger's words could steer a terminal; in JSON it means the same as
/// before.
fn plain(text: &str) -> Cow<'_, str> {
    let is_told = |c: char| c == '\t' || !steers(c);
    if text.chars().all(is_told) {
        return Cow::Borrowed(text);
    }
    let is_json = text.starts_with(['{', '[']);
    let mut shown = String::new();
    for c in text.chars() {
        match c {
            c if is_told(c) => shown.push(c),
            c if is_json => shown.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => shown.extend(c.escape_unicode()),
        }
    }
    Cow::Owned(shown)
}

/// Counts things in words: `1 trial`, `2 trials`.
pub(super) fn counted(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn nothing_that_a_stranger_wrote_steers_the_terminal() {
        let title = "A\u{1b}[2J study\u{202e}yduts\u{9b}31m\tof\nlines";
        assert_eq!(plain(title), "A\\u{1b}[2J study\\u{202e}yduts\\u{9b}31m\tof\nlines");
        let json = "{\"title\":\"a\u{202e}b\"}";
        assert_eq!(plain(json), r#"{"title":"a\u202eb"}"#);
        let value: serde_json::Value = serde_json::from_str(&plain(json)).unwrap();
        assert_eq!(value["title"], "a\u{202e}b");
    }
}
