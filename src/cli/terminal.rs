//! Where words go: results to stdout, everything else to stderr; colour only where a person looks.

use crate::document::{Diagnostic, Severity};
use crate::provenance::Environment;
use crate::store::reason;
use std::io::{ErrorKind, IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a result could not be written.
static LOST: AtomicBool = AtomicBool::new(false);

/// The two streams of the process.
#[derive(Debug, Clone, Copy)]
pub(super) struct Terminal {
    color: bool,
    watched: bool,
    utf8: bool,
}

impl Terminal {
    pub(super) fn new(environment: &Environment) -> Self {
        let watched = std::io::stderr().is_terminal();
        Self { color: watched && !environment.no_color, watched, utf8: environment.utf8 }
    }

    pub(super) fn plain() -> Self {
        Self { color: false, watched: false, utf8: false }
    }

    /// Whether a person watches stderr: bars are drawn for people only.
    pub(super) fn is_watched(self) -> bool {
        self.watched
    }

    /// Whether the terminal's character set has more than ASCII.
    pub(super) fn utf8(self) -> bool {
        self.utf8
    }

    /// How many characters fit on a line of stdout: those of the terminal, 80 where it is none. Less than 40 is legible to
    /// nobody.
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

    /// Whether a result could not be written: then the command has failed, whatever it found.
    pub(super) fn has_lost_results() -> bool {
        LOST.load(Ordering::Relaxed)
    }

    /// Writes a note to stderr.
    #[expect(clippy::unused_self, reason = "all output goes through the terminal")]
    pub(super) fn note(self, text: &str) {
        let _ = writeln!(std::io::stderr().lock(), "{}", text.trim_end_matches('\n'));
    }

    pub(super) fn error(self, message: &str) {
        if self.color {
            self.note(&format!("\u{1b}[1;31merror\u{1b}[0m: {message}"));
        } else {
            self.note(&format!("error: {message}"));
        }
    }

    /// Writes why a command gave up: whole reports as they are, a bare sentence as an error.
    pub(super) fn failure(self, message: &str) {
        if message.contains('\n') { self.note(message) } else { self.error(message) }
    }

    /// Writes reports, separated by empty lines.
    pub(super) fn diagnostics(self, diagnostics: &[Diagnostic]) {
        for diagnostic in diagnostics {
            self.note(&format!("{}\n", diagnostic.render(self.color)));
            let _ = writeln!(std::io::stderr().lock());
        }
    }

    /// `2 errors, 1 warning`.
    pub(super) fn count(diagnostics: &[Diagnostic]) -> String {
        let count = |severity| diagnostics.iter().filter(|d| d.severity == severity).count();
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

/// `1 trial`, `2 trials`.
pub(super) fn counted(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}
