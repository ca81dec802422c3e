//! What a study compares and which side came out ahead, in the labels of its manifest: the claims that say so of one value against
//! others, the one that is borne out and the one that is not.

use super::statement::{Pins, Statement, said};
use super::verdict::{ClaimVerdict, ComparisonVerdict, Judgement};
use super::words::PaperTable;
use crate::labels::Labels;
use std::collections::BTreeSet;

/// Says of the paper's claims which value of a factor has the highest or lowest measure of those compared, or more of it than one
/// other: first one that holds here, then one that does not. `None` where no claim compares values so, or none is decided.
///
/// ```text
/// success is highest with random of the 5 compared, at start A, as printed (D1)
/// ```
pub fn compared(verdicts: &[ClaimVerdict], labels: &Labels) -> Option<String> {
    let of = |judgement| {
        let decided = verdicts
            .iter()
            .filter(move |verdict| verdict.says.is_some() && verdict.judgement == judgement);
        let contrasts = decided.filter_map(|verdict| Some((Contrast::of(verdict)?, verdict)));
        // One value above all others says more than one above another; of equals the first stands.
        let mut contrasts: Vec<_> = contrasts.collect();
        contrasts.sort_by_key(|(contrast, _)| contrast.others.len() < 2);
        contrasts.into_iter().next().map(|(contrast, verdict)| contrast.told(verdict, labels))
    };
    let told: Vec<String> =
        [Judgement::Supported, Judgement::Contradicted].into_iter().filter_map(of).collect();
    (!told.is_empty()).then(|| told.join("; "))
}

/// One value of a factor against others.
struct Contrast<'a> {
    metric: &'a str,
    factor: &'a str,
    /// The value that the claim is about.
    value: &'a str,
    /// Those that it is held against.
    others: BTreeSet<&'a str>,
    is_higher: bool,
    /// What holds on both sides: of each factor the values that the comparisons have, `680|477`.
    place: Vec<(&'a str, String)>,
}

/// A comparison's side, of which one value is apart from what both have.
struct Pair<'a> {
    metric: &'a str,
    factor: &'a str,
    higher: &'a str,
    lower: &'a str,
    shared: Pins<'a>,
    /// Whether the statement says that the first is the higher.
    is_higher: bool,
}

impl<'a> Pair<'a> {
    fn of(comparison: &'a ComparisonVerdict) -> Option<Self> {
        let Statement { metric, first, second, relation, tail } =
            Statement::read(&comparison.about)?;
        let second = second?;
        let is_higher = match relation {
            ">" => true,
            "<" => false,
            _ => return None,
        };
        let shared: Pins<'a> = first.iter().filter(|pin| second.contains(pin)).copied().collect();
        let apart = |pins: &Pins<'a>| {
            let mut apart = pins.iter().filter(|pin| !shared.contains(pin));
            let one = apart.next().copied();
            one.filter(|(_, value)| apart.next().is_none() && !value.contains('|'))
        };
        let ((factor, one), (same, other)) = (apart(&first)?, apart(&second)?);
        let (higher, lower) = if is_higher { (one, other) } else { (other, one) };
        // Numbers over or under others, and transformed ones, are no plain measure.
        let is_plain = tail.is_empty() && factor == same && !metric.contains(' ');
        is_plain.then_some(Self { metric, factor, higher, lower, shared, is_higher })
    }
}

impl<'a> Contrast<'a> {
    /// Returns what `verdict` holds against what; `None` where its comparisons have no value in common, or all of one.
    fn of(verdict: &'a ClaimVerdict) -> Option<Self> {
        let pairs: Vec<Pair<'a>> =
            verdict.comparisons.iter().map(Pair::of).collect::<Option<_>>()?;
        let first = pairs.first()?;
        let alike = pairs.iter().all(|p| p.metric == first.metric && p.factor == first.factor);
        // Where only some comparisons have to hold, the value is not above all of the others.
        let all = verdict.required == pairs.len();
        if !alike || (verdict.judgement == Judgement::Supported && !all) {
            return None;
        }
        let is_common = |of: fn(&Pair<'a>) -> &'a str| pairs.iter().all(|p| of(p) == of(first));
        let is_higher = match (is_common(|p| p.higher), is_common(|p| p.lower)) {
            (true, true) => first.is_higher,
            (true, false) => true,
            (false, true) => false,
            (false, false) => return None,
        };
        let (value, other): (_, fn(&Pair<'a>) -> &'a str) =
            if is_higher { (first.higher, |p| p.lower) } else { (first.lower, |p| p.higher) };
        let values = |factor: &str| {
            let mut values: Vec<&str> = Vec::new();
            for (_, value) in pairs.iter().flat_map(|p| &p.shared).filter(|(f, _)| *f == factor) {
                if !values.contains(value) {
                    values.push(value);
                }
            }
            values.join("|")
        };
        let factors = first.shared.iter().map(|(factor, _)| *factor);
        Some(Self {
            metric: first.metric,
            factor: first.factor,
            value,
            others: pairs.iter().map(other).collect(),
            is_higher,
            place: factors.map(|factor| (factor, values(factor))).collect(),
        })
    }

    fn told(&self, verdict: &ClaimVerdict, labels: &Labels) -> String {
        let holds = verdict.judgement == Judgement::Supported;
        let one = |value| labels.in_words(self.factor, value);
        let value = one(self.value);
        let metric = in_words(self.metric);
        let not = if holds { "" } else { " not" };
        let found = match (self.others.len(), self.others.first()) {
            (1, Some(other)) => {
                let word = if self.is_higher { "higher" } else { "lower" };
                format!("{metric} is{not} {word} with {value} than with {}", one(other))
            }
            (n, _) => {
                let word = if self.is_higher { "highest" } else { "lowest" };
                format!("{metric} is{not} {word} with {value} of the {} compared", n + 1)
            }
        };
        let place = if self.place.is_empty() {
            String::new()
        } else {
            let pin = |(factor, values): &(&str, String)| {
                if values.contains('|') {
                    said(&vec![(factor, values)], labels)
                } else {
                    labels.in_words(factor, values)
                }
            };
            format!(", at {}", self.place.iter().map(pin).collect::<Vec<_>>().join(", "))
        };
        let paper = match (holds, verdict.paper_table) {
            (true, PaperTable::Supports) => ", as printed",
            (true, PaperTable::Contradicts) => ", against the paper's own table",
            (true, PaperTable::Silent) => ", as the paper says",
            (false, PaperTable::Supports) => ", against what is printed",
            (false, PaperTable::Contradicts) => ", against the paper's text and with its own table",
            (false, PaperTable::Silent) => ", against what the paper says",
        };
        format!("{found}{place}{paper} ({})", verdict.id)
    }
}

/// Returns what people call the metric `name`: `time (s) at 90 %` for `time-s-at-90`.
fn in_words(name: &str) -> String {
    let (measure, level) = match name.split_once("-at-") {
        Some((measure, level)) => (measure, format!(" at {level} %")),
        None => (name, String::new()),
    };
    let units = [("-m2", " (m²)"), ("-m", " (m)"), ("-s", " (s)"), ("-percent", " (%)")];
    let unit = units.iter().find_map(|(end, unit)| Some((measure.strip_suffix(end)?, *unit)));
    let (measure, unit) = unit.unwrap_or((measure, ""));
    let words = measure.strip_prefix("outcome:").map(|outcomes| {
        format!("the share of trials that ended as {}", outcomes.replace('|', " or "))
    });
    format!("{}{unit}{level}", words.unwrap_or_else(|| measure.replace('-', " ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels::NONE;
    use serde_json::json;

    fn verdict(id: &str, found: &str, table: &str, abouts: &[&str]) -> ClaimVerdict {
        let comparisons: Vec<_> =
            abouts.iter().map(|about| json!({"about": about, "verdict": found})).collect();
        serde_json::from_value(json!({
            "id": id, "says": "it is so", "verdict": found, "paper-table": table,
            "required": abouts.len(), "comparisons": comparisons,
        }))
        .unwrap()
    }

    fn labels() -> Labels {
        serde_json::from_str(
            r#"{"strategy": {"values": {"random": "random"}}, "deadline-s": {"name": "deadline (s)"}}"#,
        )
        .unwrap()
    }

    const BEST: [&str; 3] = [
        "success: (start=A, strategy=random) > (start=A, strategy=frontier)",
        "success: (start=A, strategy=random) > (start=A, strategy=corridors)",
        "success: (start=A, strategy=random) > (start=A, strategy=nearest)",
    ];

    #[test]
    fn the_value_above_all_others_is_named_by_its_label() {
        let one = verdict("D1", "supported", "supports", &BEST);
        assert_eq!(
            compared(&[one], &labels()).unwrap(),
            "success is highest with random of the 4 compared, at start A, as printed (D1)"
        );
        // The worst is the second side of comparisons that say `higher`.
        let worst = [
            "time-s-at-90: (strategy=frontier) > (strategy=random)",
            "time-s-at-90: (strategy=corridors) > (strategy=random)",
        ];
        let one = verdict("D2", "supported", "silent", &worst);
        assert_eq!(
            compared(&[one], &NONE).unwrap(),
            "time (s) at 90 % is lowest with strategy random of the 3 compared, as the paper says (D2)"
        );
    }

    #[test]
    fn one_that_holds_comes_before_one_that_does_not() {
        let lower = ["distance-m: (prior=plan, world=a) < (prior=none, world=a)"];
        let verdicts = [
            verdict("P0", "inconclusive", "supports", &BEST),
            verdict("P1", "contradicted", "supports", &BEST),
            verdict("P2", "supported", "contradicts", &lower),
        ];
        assert_eq!(
            compared(&verdicts, &NONE).unwrap(),
            "distance (m) is lower with prior plan than with prior none, at world a, against the paper's own table (P2); \
             success is not highest with strategy random of the 4 compared, at start A, against what is printed (P1)"
        );
    }

    #[test]
    fn what_differs_between_comparisons_is_where_it_holds_too() {
        let several = [
            "success: (deadline-s=68, strategy=random) > (deadline-s=68, strategy=frontier)",
            "success: (deadline-s=90, strategy=random) > (deadline-s=90, strategy=frontier)",
        ];
        let one = verdict("D1", "supported", "supports", &several);
        assert_eq!(
            compared(&[one], &labels()).unwrap(),
            "success is higher with random than with frontier, at deadline (s) 68 or 90, as printed (D1)"
        );
    }

    #[test]
    fn nothing_is_said_of_claims_of_another_form() {
        let within = ["success: (a=1) = (a=2) within 0.1"];
        let level = ["success: (start=C) at most 0.15"];
        let apart = ["success: (a=1, b=1) > (a=2, b=2)"];
        let mixed = ["success: (a=1) > (a=2)", "success: (a=3) > (a=4)"];
        for abouts in [&within[..], &level, &apart, &mixed, &[]] {
            let one = verdict("D1", "supported", "supports", abouts);
            assert_eq!(compared(&[one], &NONE), None, "{abouts:?}");
        }
        let mut ours = verdict("O1", "supported", "supports", &BEST);
        (ours.ours, ours.says) = (ours.says, None);
        let mut some = verdict("D1", "supported", "supports", &BEST);
        some.required = 2;
        let open = verdict("D1", "inconclusive", "supports", &BEST);
        assert_eq!(compared(&[ours, some, open], &NONE), None);
    }
}
