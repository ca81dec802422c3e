//! What a check found, on one line: the first thing said wherever something of a bundle is shown.

use super::{Finding, Level, Report, Severity, Verdict};
use crate::bundle::visible;

/// A check on one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Brief {
    /// The line.
    pub words: String,
    /// What must stand over whatever is shown of the bundle; `None` where it is what it says.
    pub banner: Option<String>,
    /// Whether it is shown only to whoever wants it unchecked.
    pub is_refused: bool,
}

impl Report {
    /// Says on one line what was found.
    pub fn in_brief(&self) -> Brief {
        let reached = self.reached_in_words();
        let verdict = self.verdict();
        let words = match verdict {
            Verdict::Holds => format!("checked to {reached}: the bundle is what it says"),
            Verdict::Unanswered => format!("checked to {reached}: {}", self.why_not_further()),
            _ => {
                let faults = self.of(Severity::Error).count();
                let faults = format!("{faults} fault{}", if faults == 1 { "" } else { "s" });
                let asked = self.asked;
                format!("NOT WHAT IT SAYS: {faults}, reached {reached} of level {asked}")
            }
        };
        let words = match &self.unchecked[..] {
            [] => words,
            parts => format!("{words}; {}", one_line(&parts.join(", "))),
        };
        let banner = (verdict != Verdict::Holds).then(|| words.clone());
        let is_refused = !matches!(verdict, Verdict::Holds | Verdict::Unanswered);
        Brief { words, banner, is_refused }
    }

    /// Says which level was reached.
    pub(crate) fn reached_in_words(&self) -> String {
        self.reached.map_or("no level".to_owned(), |level: Level| format!("level {level}"))
    }

    /// Returns the findings of that weight.
    pub(crate) fn of(&self, severity: Severity) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.severity == severity)
    }

    /// Says why this program could not judge the bundle to the end.
    fn why_not_further(&self) -> String {
        let engine = self.engine.as_deref().map(one_line).unwrap_or_default();
        match self.of(Severity::Obstacle).next() {
            Some(finding) if finding.found == format!("engine {engine}") => {
                format!("this program cannot derive the results of engine {engine}")
            }
            Some(finding) => {
                let (expected, found) = (one_line(&finding.expected), one_line(&finding.found));
                format!("this program cannot judge further (expected {expected}, found {found})")
            }
            None => "this program cannot judge further".to_owned(),
        }
    }
}

fn one_line(text: &str) -> String {
    visible(text).replace('\n', " ")
}
