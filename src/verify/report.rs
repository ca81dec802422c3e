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
                text.push_str(&format!("{name:<9}{value}\n"));
            }
        };
        // One line each, whatever a stranger called them.
        let one_line = |text: &String| visible(text).replace('\n', " ");
        fact("study", self.name.as_ref().map(one_line));
        fact("engine", self.engine.as_ref().map(one_line));
        fact("results", self.results_digest.map(|digest| format!("sha256:{digest}")));
        fact("bundle", self.bundle_id.map(|id| format!("sha256:{id}")));
        for level in Level::ALL.into_iter().filter(|level| *level <= self.asked) {
            text.push_str(&format!(
                "  {} {:<9} {}\n",
                level.number(),
                level.name(),
                self.state(level)
            ));
        }
        for finding in &self.findings {
            // Further lines are set in, so that none can pass for one of ours.
            text.push_str(&format!("{}\n", finding.to_string().trim_end().replace('\n', "\n    ")));
        }
        if let Some(sample) = &self.sample {
            text.push_str(&format!("{}\n", sample.in_words()));
        }
        let reached = self.reached.map_or("no level".to_owned(), |level| format!("level {level}"));
        text.push_str(&format!("reached {reached} of level {}: {}\n", self.asked, self.answer()));
        text
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
            "levels": Level::ALL
                .into_iter()
                .filter(|level| *level <= self.asked)
                .map(|level| json!({"level": level, "name": level.name(), "state": self.state(level)}))
                .collect::<Vec<_>>(),
            "findings": self.findings,
            "sample": self.sample,
        });
        if let Some(sample) = &self.sample {
            value["sample"]["bound"] = json!(sample.bound());
            value["sample"]["in-words"] = json!(sample.in_words());
        }
        json::canonical(&value)
    }

    /// For CI: JUnit XML, one test case a level.
    pub fn to_junit(&self) -> String {
        let levels: Vec<Level> =
            Level::ALL.into_iter().filter(|level| *level <= self.asked).collect();
        let of = |level: Level| self.findings.iter().filter(move |finding| finding.level == level);
        let mut cases = String::new();
        let (mut failures, mut skipped) = (0, 0);
        for level in &levels {
            let broken: Vec<String> = of(*level)
                .filter(|finding| finding.severity == Severity::Error)
                .map(Finding::to_string)
                .collect();
            let name = escape(&format!("level {level}"));
            let body = if let Some(first) = broken.first() {
                failures += 1;
                format!(
                    "<failure message=\"{}\">{}</failure>",
                    printable(first),
                    printable(&broken.join("\n"))
                )
            } else if self.state(*level) == "passed" {
                String::new()
            } else {
                skipped += 1;
                let why = of(*level).next().map_or("not judged".to_owned(), Finding::to_string);
                format!("<skipped message=\"{}\"/>", printable(&why))
            };
            cases.push_str(&format!(
                "    <testcase classname=\"reenact.verify\" name=\"{name}\">{body}</testcase>\n"
            ));
        }
        let counts =
            format!("tests=\"{}\" failures=\"{failures}\" skipped=\"{skipped}\"", levels.len());
        let name = printable(self.name.as_deref().unwrap_or("bundle"));
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {counts}>\n  <testsuite name=\"{name}\" {counts} \
             errors=\"0\">\n{cases}  </testsuite>\n</testsuites>\n"
        )
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
            Verdict::Unanswered => "this program cannot judge further",
        }
    }
}

/// `text` as XML can hold it: hostile names may carry control characters.
fn printable(text: &str) -> String {
    let text: String =
        text.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect();
    escape(&text)
}
