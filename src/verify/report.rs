//! The report's three forms: for people, for programs, for CI.

use super::{Attestation, Finding, Level, Report, Severity, Verdict};
use crate::bundle::{Departure, visible};
use crate::figure::svg::escape;
use crate::json;
use serde_json::{Value, json};

impl Report {
    /// Writes the report for people: what it is, one line a level, every finding, and the answer last.
    pub fn to_human(&self) -> String {
        let mut text = String::new();
        let mut fact = |name: &str, value: Option<String>| {
            if let Some(value) = value {
                text.push_str(&format!("{name:<9}{}\n", plain(&value)));
            }
        };
        // One line each, whatever a stranger called them.
        let one_line = |text: &String| visible(text).replace('\n', " ");
        fact("study", self.name.as_ref().map(one_line).map(|name| self.with_departure(name)));
        fact("engine", self.engine.as_ref().map(one_line));
        fact("results", self.results_digest.map(|digest| format!("sha256:{digest}")));
        fact("bundle", self.bundle_id.map(|id| format!("sha256:{id}")));
        fact("signed", self.signed.as_ref().map(ToString::to_string));
        fact("attested", self.attested().map(ToString::to_string));
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
        for line in self.attestation_in_words() {
            text.push_str(&format!("{line}\n"));
        }
        if !self.circumstances.is_empty() {
            text.push_str(&format!("not checked: {}\n", self.circumstances.join("; ")));
        }
        let reached = self.reached_in_words();
        let answer = self.answer_with_limits();
        text.push_str(&format!("reached {reached} of level {}: {answer}\n", self.asked));
        text
    }

    /// Returns the answer, and what it does not speak of.
    fn answer_with_limits(&self) -> String {
        let limits = self.unchecked.iter().map(|what| format!("; {}", plain(what)));
        std::iter::once(self.answer().to_owned()).chain(limits).collect()
    }

    /// Writes the report for programs: one line of canonical JSON.
    pub fn to_json(&self) -> String {
        let mut value = json!({
            "asked": self.asked,
            "reached": self.reached,
            "verdict": self.verdict(),
            "name": self.name,
            "partial": self.departure.as_ref().map(|departure| departure.partial),
            "overrides": self.departure.as_ref().map(|departure| &departure.overrides),
            "selection": self.selection(),
            "engine": self.engine,
            "bundle_id": self.bundle_id.map(|id| format!("sha256:{id}")),
            "results_digest": self.results_digest.map(|digest| format!("sha256:{digest}")),
            "study_digest": self.study_digest.map(|digest| format!("sha256:{digest}")),
            "signed": self.signed,
            "attestation": match &self.attestation {
                Some(Ok(attestation)) => json!(attestation),
                Some(Err(fault)) => json!({"refused": fault.to_string()}),
                None => json!(null),
            },
            "levels": self.states(),
            "findings": self.findings,
            "sample": self.sample,
            "earlier": self.earlier,
            "unchecked": self.unchecked,
            "circumstances": self.circumstances,
            "replication": self.replication,
        });
        if let Some(sample) = &self.sample {
            value["sample"]["bound"] = json!(sample.bound());
            value["sample"]["in_words"] = json!(sample.in_words());
        }
        if let Some(replication) = &self.replication {
            value["replication"]["in_words"] = json!(replication.in_words());
        }
        json::canonical(&value)
    }

    /// Writes the report for CI: JUnit XML as Jenkins' `junit-10.xsd` has it, one test case a level.
    pub fn to_junit(&self) -> String {
        let levels = self.levels();
        let of = |level: Level| self.findings.iter().filter(move |finding| finding.level == level);
        let mut cases = String::new();
        let (mut failures, mut errors, mut skipped, mut total) = (0, 0, 0, 0.0);
        for level in &levels {
            let told = |wanted: fn(Severity) -> bool| -> Vec<String> {
                of(*level).filter(|f| wanted(f.severity)).map(Finding::to_string).collect()
            };
            let mut broken = told(|severity| severity == Severity::Error);
            if broken.is_empty() && self.state(*level) == "failed" {
                // All trials are a sample, too: where they fail, the sample says what failed.
                broken = self.sample.iter().map(super::Sample::in_words).collect();
            }
            let failed = told(|severity| severity == Severity::Failure);
            let mut body = String::new();
            let told_as = |element: &str, all: &[String]| {
                format!(
                    "<{element} message=\"{}\" type=\"{}\">{}</{element}>",
                    printable(all.first().map_or("", String::as_str)),
                    level.name(),
                    printable(&all.join("\n"))
                )
            };
            if !broken.is_empty() {
                failures += 1;
                body.push_str(&told_as("failure", &broken));
            } else if !failed.is_empty() {
                errors += 1;
                body.push_str(&told_as("error", &failed));
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
        let mut tests = levels.len();
        if let Some(attestation) = &self.attestation {
            tests += 1;
            let told =
                |element: &str, text: &str| format!("<{element}>{}</{element}>", printable(text));
            let body = match attestation {
                Ok(_) => told("system-out", &self.attestation_in_words().join("\n")),
                Err(fault) => {
                    failures += 1;
                    let text = printable(&fault.to_string());
                    format!("<failure message=\"{text}\" type=\"attestation\">{text}</failure>")
                }
            };
            cases.push_str(&format!(
                "    <testcase name=\"attestation\" classname=\"reenact.verify\" time=\"0.000\">{body}</testcase>\n"
            ));
        }
        let counts = format!("tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\"");
        let name = printable(self.name.as_deref().unwrap_or("bundle"));
        let facts = [
            ("bundle-id", self.bundle_id.map(|id| format!("sha256:{id}"))),
            ("results-digest", self.results_digest.map(|digest| format!("sha256:{digest}"))),
            ("engine", self.engine.clone()),
            ("partial", self.departure.as_ref().map(|departure| departure.partial.to_string())),
            ("departure", self.departure.as_ref().and_then(Departure::in_words)),
            ("signed", self.signed.as_ref().map(ToString::to_string)),
            ("attested", self.attested().map(ToString::to_string)),
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

    /// Returns the levels asked for, lowest first.
    fn levels(&self) -> Vec<Level> {
        Level::ALL.into_iter().filter(|level| *level <= self.asked).collect()
    }

    /// Says what was executed and what it shows, a line each.
    fn in_words(&self) -> Vec<String> {
        let sample = self.sample.as_ref().map(super::Sample::in_words);
        let replication = self.replication.as_ref().map(super::Replication::in_words);
        let earlier = self.earlier.iter().map(super::EarlierAgain::in_words);
        let lines = sample.into_iter().chain(earlier).chain(replication);
        lines.flat_map(|text| text.lines().map(plain).collect::<Vec<_>>()).collect()
    }

    /// Adds to a study's name how its run departs from the manifest.
    fn with_departure(&self, name: String) -> String {
        match self.departure.as_ref().and_then(Departure::in_words) {
            Some(words) => format!("{name} ({words})"),
            None => name,
        }
    }

    /// Returns which part was run, where it was a part.
    fn selection(&self) -> Option<Value> {
        let departure = self.departure.as_ref().filter(|departure| departure.partial)?;
        departure.selection.as_ref().map(json::value_of)
    }

    fn attested(&self) -> Option<&Attestation> {
        self.attestation.as_ref().and_then(|answer| answer.as_ref().ok())
    }

    /// Says what the attestation states besides the level, or why it is refused, a line each.
    fn attestation_in_words(&self) -> Vec<String> {
        let lines = match &self.attestation {
            None => Vec::new(),
            Some(Ok(attestation)) => attestation.in_words(),
            Some(Err(fault)) => vec![format!("attestation refused: {fault}")],
        };
        // One line each, whatever a stranger wrote.
        lines.iter().map(|line| visible(line).replace('\n', " ")).collect()
    }

    /// Lists every level asked for with what became of it, as programs read it.
    pub fn states(&self) -> Vec<Value> {
        let state = |level: Level| json!({"level": level, "name": level.name(), "state": self.state(level)});
        self.levels().into_iter().map(state).collect()
    }

    fn state(&self, level: Level) -> &'static str {
        let fails = |wanted: Level| {
            self.findings.iter().any(|f| f.level == wanted && f.severity == Severity::Error)
        };
        // A trial that differs fails the sample and the whole that it is of; above what failed nothing is passed.
        let of_all = level == Level::Full && self.judged.contains(&level) && fails(Level::Sampled);
        if fails(level) || of_all {
            "failed"
        } else if self.reached >= Some(level) {
            "passed"
        } else {
            "not judged"
        }
    }

    fn answer(&self) -> &'static str {
        match self.verdict() {
            Verdict::Holds => "the bundle is what it says",
            Verdict::Broken => "the bundle is not what it says",
            Verdict::NotReplicated => {
                "the bundle is what it says, but not every verdict holds with fresh seeds"
            }
            Verdict::NotAttested if self.reached == Some(self.asked) => {
                "the bundle is what it says, but the attestation is refused"
            }
            Verdict::NotAttested => {
                "this program cannot judge further, and the attestation is refused"
            }
            Verdict::Failed => "this program failed, which says nothing of the bundle",
            Verdict::Unanswered => "this program cannot judge further",
        }
    }
}

/// Writes `text` for a terminal: a hostile bundle's words may carry control characters, which could rewrite what is
/// shown.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect()
}

/// Writes `text` as XML can hold it.
pub(crate) fn printable(text: &str) -> String {
    // Two characters that are no control characters have no place in XML either.
    escape(&plain(text).replace(['\u{fffe}', '\u{ffff}'], "\u{fffd}"))
}
