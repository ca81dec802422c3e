//! The comparison for people: a summary first, then every difference, capped with counts.

use super::{Comparison, Row, Section};

/// Differences of one kind that are shown; the rest are counted.
const ROWS_SHOWN: usize = 12;

impl Comparison {
    /// Writes for people: who is compared, one line a kind of thing, the differences, and the answer last. `names` are what
    /// the sides are called.
    pub fn to_human(&self, names: [&str; 2]) -> String {
        let mut text = String::new();
        for (mark, name, party) in [("a", names[0], &self.a), ("b", names[1], &self.b)] {
            text.push_str(&format!(
                "{mark}  {name}: {}, engine {}, results sha256:{}{}\n",
                party.name,
                party.engine,
                party.results_digest.short(),
                if party.partial { ", partial" } else { "" },
            ));
        }
        if let Some(remark) = self.matching_in_words() {
            text.push_str(&format!("{remark}\n"));
        }
        text.push('\n');
        text.push_str(&self.details());
        text.push_str(&format!("{}\n", self.answer()));
        text
    }

    /// Writes the summary and the differences.
    pub(super) fn details(&self) -> String {
        let sections = self.sections();
        let mut text = String::new();
        for section in &sections {
            let state = match section.rows.len() {
                0 => "same".to_owned(),
                n => format!("{n} changed"),
            };
            let line = format!(
                "  {:<17}{:>6}  {state}{}",
                section.name,
                section.compared,
                if section.remark.is_empty() {
                    String::new()
                } else {
                    format!(", {}", section.remark)
                },
            );
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text.push('\n');
        for section in sections.iter().filter(|section| !section.rows.is_empty()) {
            text.push_str(&shown(section));
            text.push('\n');
        }
        text
    }

    /// Says how trials were paired, where that needs saying.
    pub fn matching_in_words(&self) -> Option<String> {
        let (by_key, by_number) = (self.matching.by_key, self.matching.by_number);
        match (by_key, by_number) {
            (_, 0) => None,
            (0, _) => Some(
                "no two trials have the same key (another engine, seed, input or setting): they are matched by \
                 condition and number"
                    .to_owned(),
            ),
            _ => Some(format!(
                "{by_key} trials are matched by key, {by_number} by condition and number, as their keys differ (another \
                 input or setting)"
            )),
        }
    }

    /// Says in one line what changed, counted.
    pub fn answer(&self) -> String {
        let changed: Vec<String> = self
            .sections()
            .iter()
            .filter(|section| !section.rows.is_empty())
            .map(|section| format!("{} ({})", section.name, section.rows.len()))
            .collect();
        if changed.is_empty() {
            "no change".to_owned()
        } else {
            format!("changed: {}", changed.join(", "))
        }
    }
}

fn shown(section: &Section) -> String {
    let mut text = format!("{}\n", section.name);
    for row in section.rows.iter().take(ROWS_SHOWN) {
        text.push_str(&format!("  {}\n", row.in_words()));
    }
    if section.rows.len() > ROWS_SHOWN {
        text.push_str(&format!("  ... and {} more\n", section.rows.len() - ROWS_SHOWN));
    }
    text
}

impl Row {
    /// Writes the line as people read it.
    pub fn in_words(&self) -> String {
        let Self { subject, from, to, note } = self;
        let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
        match (from.as_str(), to.as_str()) {
            ("", "") => format!("{subject}{note}"),
            ("", to) => format!("{subject}: new, {to}{note}"),
            (from, "") => format!("{subject}: gone, was {from}{note}"),
            (from, to) if from == to => format!("{subject}: {from}{note}"),
            (from, to) => format!("{subject}: {from} -> {to}{note}"),
        }
    }
}
