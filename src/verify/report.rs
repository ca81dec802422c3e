//! The report's three forms: for people, for programs, for CI.

use super::{Finding, Level, Report, Severity, Verdict};
use crate::bundle::visible;
use crate::figure::svg::escape;
use crate::json;
use serde_json::json;

impl Report {
    /// For people: what it is, one line a level, every finding, and the answer last.
    pub fn to_human(&self) -> String {
        let mut text = String::new();
        let mut fact = |name: &str, value: Option<String>| {
            if let Some(value) = value {
                text.push_str(&format!("{name:<9}{}\n", plain(&value)));
            }
        };
        // One line each, whatever a stranger called them.
        let one_line = |text: &String| visible(text).replace('\n', " ");
        fact("study", self.name.as_ref().map(one_line));
        fact("engine", self.engine.as_ref().map(one_line));
        fact("results", self.results_digest.map(|digest| format!("sha256:{digest}")));
        fact("bundle", self.bundle_id.map(|id| format!("sha256:{id}")));
        fact("signed", self.signed.as_ref().map(ToString::to_string));
        let levels = self.levels();
        let width = levels.iter().map(|level| level.name().len()).max().unwrap_or(0).max(9);
        for level in levels {
            text.push_str(&format!(
                "  {} {:<width$} {}\n",
                level.number(),
                level.name(),
                self.state(level)
            ));
        }
        for finding in &self.findings {
            // Further lines are set in, so that none can pass for one of ours.
            let finding = plain(finding.to_string().trim_end());
            text.push_str(&format!("{}\n", finding.replace('\n', "\n    ")));
        }
        for line in self.in_words() {
            text.push_str(&format!("{line}\n"));
        }
        if !self.circumstances.is_empty() {
            text.push_str(&format!("not checked: {}\n", self.circumstances.join("; ")));
        }
        let reached = self.reached.map_or("no level".to_owned(), |level| format!("level {level}"));
        let answer = self.answer_with_limits();
        text.push_str(&format!("reached {reached} of level {}: {answer}\n", self.asked));
        text
    }

    /// The answer, and what it does not speak of.
    fn answer_with_limits(&self) -> String {
        let limits = self.unchecked.iter().map(|what| format!("; {}", plain(what)));
        std::iter::once(self.answer().to_owned()).chain(limits).collect()
    }

    /// For programs: one line of canonical JSON.
    pub fn to_json(&self) -> String {
        let mut value = json!({
            "asked": self.asked,
            "reached": self.reached,
            "verdict": self.verdict(),
            "name": self.name,
            "engine": self.engine,
            "bundle-id": self.bundle_id,
            "results-digest": self.results_digest.map(|digest| format!("sha256:{digest}")),
            "study-digest": self.study_digest,
            "signed": self.signed,
            "levels": self
                .levels()
                .into_iter()
                .map(|level| json!({"level": level, "name": level.name(), "state": self.state(level)}))
                .collect::<Vec<_>>(),
            "findings": self.findings,
            "sample": self.sample,
            "earlier": self.earlier,
            "unchecked": self.unchecked,
            "circumstances": self.circumstances,
            "replication": self.replication,
        });
        if let Some(sample) = &self.sample {
            value["sample"]["bound"] = json!(sample.bound());
            value["sample"]["in-words"] = json!(sample.in_words());
        }
        if let Some(replication) = &self.replication {
            value["replication"]["in-words"] = json!(replication.in_words());
        }
        json::canonical(&value)
    }

    /// For CI: JUnit XML as Jenkins' `junit-10.xsd` has it, one test case a level.
    pub fn to_junit(&self) -> String {
        let levels = self.levels();
        let of = |level: Level| self.findings.iter().filter(move |finding| finding.level == level);
        let mut cases = String::new();
        let (mut failures, mut skipped, mut total) = (0, 0, 0.0);
        for level in &levels {
            let told = |wanted: fn(Severity) -> bool| -> Vec<String> {
                of(*level).filter(|f| wanted(f.severity)).map(Finding::to_string).collect()
            };
            let broken = told(|severity| severity == Severity::Error);
            let mut body = String::new();
            if let Some(first) = broken.first() {
                failures += 1;
                body.push_str(&format!(
                    "<failure message=\"{}\" type=\"{}\">{}</failure>",
                    printable(first),
                    level.name(),
                    printable(&broken.join("\n"))
                ));
            } else if self.state(*level) != "passed" {
                skipped += 1;
                let why = told(|severity| severity == Severity::Obstacle);
                let why = why.first().map_or("not judged", String::as_str);
                body.push_str(&format!("<skipped message=\"{}\"/>", printable(why)));
            }
            let notes = told(|severity| severity == Severity::Note);
            if !notes.is_empty() {
                body.push_str(&format!(
                    "<system-out>{}</system-out>",
                    printable(&notes.join("\n"))
                ));
            }
            let seconds =
                self.seconds.iter().find(|(known, _)| known == level).map_or(0.0, |(_, s)| *s);
            total += seconds;
            cases.push_str(&format!(
                "    <testcase name=\"level {level}\" classname=\"reenact.verify\" time=\"{seconds:.3}\">{body}</testcase>\n"
            ));
        }
        let counts = format!("tests=\"{}\" failures=\"{failures}\" errors=\"0\"", levels.len());
        let name = printable(self.name.as_deref().unwrap_or("bundle"));
        let facts = [
            ("bundle-id", self.bundle_id.map(|id| format!("sha256:{id}"))),
            ("results-digest", self.results_digest.map(|digest| format!("sha256:{digest}"))),
            ("engine", self.engine.clone()),
            ("signed", self.signed.as_ref().map(ToString::to_string)),
            ("answer", Some(self.answer_with_limits())),
        ];
        let mut properties = String::new();
        for (fact, value) in facts.into_iter().filter_map(|(fact, value)| Some((fact, value?))) {
            let value = printable(&value);
            properties.push_str(&format!("      <property name=\"{fact}\" value=\"{value}\"/>\n"));
        }
        let words = printable(&self.in_words().join("\n"));
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"reenact verify\" {counts} \
             time=\"{total:.3}\">\n  <testsuite name=\"{name}\" {counts} skipped=\"{skipped}\" time=\"{total:.3}\">\n    \
             <properties>\n{properties}    </properties>\n{cases}    <system-out>{words}</system-out>\n  </testsuite>\n\
             </testsuites>\n"
        )
    }

    /// The levels asked for, lowest first.
    fn levels(&self) -> Vec<Level> {
        Level::ALL.into_iter().filter(|level| *level <= self.asked).collect()
    }

    /// What was executed and what it shows, a line each.
    fn in_words(&self) -> Vec<String> {
        let sample = self.sample.as_ref().map(super::Sample::in_words);
        let replication = self.replication.as_ref().map(super::Replication::in_words);
        let earlier = self.earlier.iter().map(super::EarlierAgain::in_words);
        let lines = sample.into_iter().chain(earlier).chain(replication);
        lines.flat_map(|text| text.lines().map(plain).collect::<Vec<_>>()).collect()
    }

    fn state(&self, level: Level) -> &'static str {
        let weighs =
            |severity| self.findings.iter().any(|f| f.level == level && f.severity == severity);
        if weighs(Severity::Error) {
            "failed"
        } else if weighs(Severity::Obstacle) || !self.judged.contains(&level) {
            "not judged"
        } else {
            "passed"
        }
    }

    fn answer(&self) -> &'static str {
        match self.verdict() {
            Verdict::Holds => "the bundle is what it says",
            Verdict::Broken => "the bundle is not what it says",
            Verdict::NotReplicated => {
                "the bundle is what it says, but not every verdict holds with fresh seeds"
            }
            Verdict::Unanswered => "this program cannot judge further",
        }
    }
}

/// `text` for a terminal: a hostile bundle's words may carry control characters, which could rewrite what is shown.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect()
}

/// `text` as XML can hold it.
fn printable(text: &str) -> String {
    // Two characters that are no control characters have no place in XML either.
    escape(&plain(text).replace(['\u{fffe}', '\u{ffff}'], "\u{fffd}"))
}
