//! What a comparison states, read from the words in which `claims.json` has it (`METRIC: (FACTOR=VALUE, ...) < (...) within X`),
//! and said as one would.

use crate::labels::Labels;

/// Factor values that name cells: `start=C, deadline-s=680|477`.
pub(crate) type Pins<'a> = Vec<(&'a str, &'a str)>;

/// A comparison's statement, taken apart.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Statement<'a> {
    /// What is compared: `success`, `log of distance-m-at-95 over distance-m-at-80`.
    pub(crate) metric: &'a str,
    /// The cells of the first side; none for all trials.
    pub(crate) first: Pins<'a>,
    /// Those of the second, where there are two sides.
    pub(crate) second: Option<Pins<'a>>,
    /// The word between the sides: `<`; empty where there is one.
    pub(crate) relation: &'a str,
    /// What follows: `within 0.1`, `at most 0.5`.
    pub(crate) tail: &'a str,
}

impl<'a> Statement<'a> {
    /// Takes `about` apart; `None` where it is of another form.
    pub(crate) fn read(about: &'a str) -> Option<Self> {
        let (metric, rest) = about.split_once(": (")?;
        let (first, rest) = rest.split_once(')')?;
        let first = pins(first)?;
        let (relation, second, tail) = match rest.split_once('(') {
            Some((relation, rest)) => {
                let (second, tail) = rest.split_once(')')?;
                (relation.trim(), Some(pins(second)?), tail.trim())
            }
            None => ("", None, rest.trim()),
        };
        (!tail.contains('(')).then_some(Self { metric, first, second, relation, tail })
    }

    /// Says it as one would: `success: strategy random higher than frontier, at start A and deadline-s 680`.
    pub(crate) fn in_words(&self, labels: &Labels) -> String {
        let said = |pins: &Pins<'a>| said(pins, labels);
        let metric = self.metric;
        let tail = if self.tail.is_empty() { String::new() } else { format!(" {}", self.tail) };
        let Some(second) = &self.second else {
            let cells = said(&self.first);
            return match (cells.is_empty(), self.tail.is_empty()) {
                (true, _) => format!("{metric} in all trials{}", separated(self.tail)),
                (false, _) => format!("{metric} at {cells}{}", separated(self.tail)),
            };
        };
        let shared: Pins<'_> =
            self.first.iter().filter(|pin| second.contains(pin)).copied().collect();
        let apart = |pins: &Pins<'a>| -> Pins<'a> {
            pins.iter().filter(|pin| !shared.contains(pin)).copied().collect()
        };
        let (one, other) = (apart(&self.first), apart(second));
        let between = match self.relation {
            "<" => "lower than",
            ">" => "higher than",
            "=" => "the same as",
            other => other,
        };
        // One factor on both sides is named once.
        let other = match (&one[..], &other[..]) {
            ([(factor, _)], [(same, value)]) if factor == same => either(factor, value, labels),
            _ => said(&other),
        };
        let place =
            if shared.is_empty() { String::new() } else { format!(", at {}", said(&shared)) };
        let all = |words: String| if words.is_empty() { "all trials".to_owned() } else { words };
        format!("{metric}: {} {between} {}{tail}{place}", all(said(&one)), all(other))
    }
}

fn separated(tail: &str) -> String {
    if tail.is_empty() { String::new() } else { format!(": {tail}") }
}

fn pins(text: &str) -> Option<Pins<'_>> {
    if text == "all trials" {
        return Some(Vec::new());
    }
    text.split(", ").map(|pin| pin.split_once('=')).collect()
}

fn either(factor: &str, values: &str, labels: &Labels) -> String {
    let values: Vec<&str> = values.split('|').map(|value| labels.value(factor, value)).collect();
    match values[..] {
        [.., last] if values.len() > 1 => {
            format!("{} or {last}", values[..values.len() - 1].join(", "))
        }
        _ => values.concat(),
    }
}

/// Names cells; a label says itself what it is, a value stands behind its factor.
pub(crate) fn said(pins: &Pins<'_>, labels: &Labels) -> String {
    let pin = |(factor, values): &(&str, &str)| {
        let either = either(factor, values, labels);
        let first = values.split('|').next().unwrap_or_default();
        match labels.label(factor, first) {
            Some(_) => either,
            None => format!("{} {either}", labels.factor(factor)),
        }
    };
    pins.iter().map(pin).collect::<Vec<_>>().join(", ")
}

/// Returns the cell that `text` names (`start=A, strategy=random`) as readers see it; of another form, as it is.
pub(crate) fn cell_in_words(text: &str, labels: &Labels) -> String {
    if labels.is_empty() {
        return text.to_owned();
    }
    match pins(text) {
        Some(pins) if !pins.is_empty() => said(&pins, labels),
        _ => text.to_owned(),
    }
}

/// Where an effect has to lie for a statement to hold, in the unit of the effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wanted {
    /// Above this; minus infinity where anything below will do.
    pub(crate) low: f64,
    /// Below this.
    pub(crate) high: f64,
}

impl Wanted {
    /// Returns what `about` asks of the effect `name`; `None` where it asks nothing that can be drawn on a line.
    pub(crate) fn read(about: &str, name: &str) -> Option<Self> {
        const ANY: f64 = f64::INFINITY;
        let after = |word: &str| -> Option<f64> {
            let (_, rest) = about.split_once(word)?;
            rest.split(|c: char| c.is_whitespace() || c == ';').next()?.parse().ok()
        };
        if let Some((_, rest)) = about.split_once(" between ")
            && let Some((low, high)) = rest.split_once(" and ")
            && let (Ok(low), Ok(high)) = (low.parse(), high.parse())
        {
            return Some(Self { low, high });
        }
        if let Some(margin) = after(" within ") {
            return Some(Self { low: -margin, high: margin });
        }
        if let Some(high) = after(" at most ") {
            return Some(Self { low: -ANY, high });
        }
        if let Some(low) = after(" at least ") {
            return Some(Self { low, high: ANY });
        }
        let centre = if name == "share-of-pairs" { 0.5 } else { 0.0 };
        let below = Self { low: -ANY, high: centre };
        let above = Self { low: centre, high: ANY };
        match () {
            () if name == "share-of-pairs" => Some(above),
            () if about.contains(" falls along ") || about.contains(" < ") => Some(below),
            () if about.contains(" rises along ") || about.contains(" > ") => Some(above),
            () => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels::NONE;

    #[test]
    fn labels_stand_for_factors_and_values() {
        let labels: Labels = serde_json::from_str(
            r#"{"furnished": {"values": {"true": "furnished", "false": "unfurnished"}}, "prior": {"name": "prior knowledge"}}"#,
        )
        .unwrap();
        let about = "time-s-at-70: (furnished=true, prior=none) > (furnished=false, prior=none)";
        assert_eq!(
            Statement::read(about).unwrap().in_words(&labels),
            "time-s-at-70: furnished higher than unfurnished, at prior knowledge none"
        );
        assert_eq!(
            cell_in_words("furnished=true|false, prior=none", &labels),
            "furnished or unfurnished, prior knowledge none"
        );
        assert_eq!(cell_in_words("all trials", &labels), "all trials");
        assert_eq!(cell_in_words("start=A", &NONE), "start=A");
    }

    #[test]
    fn what_is_compared_is_said_once_and_where_after_it() {
        let said = |about| Statement::read(about).map(|s| s.in_words(&NONE)).unwrap_or_default();
        for (about, words) in [
            (
                "success: (deadline-s=680, start=A, strategy=random) > (deadline-s=680, start=A, strategy=frontier)",
                "success: strategy random higher than frontier, at deadline-s 680, start A",
            ),
            (
                "success: (deadline-s=68|290|563, strategy=random) = (strategy=frontier) within 0.1",
                "success: deadline-s 68, 290 or 563, strategy random the same as strategy frontier within 0.1",
            ),
            (
                "success: (start=C, strategy=random) at most 0.15",
                "success at start C, strategy random: at most 0.15",
            ),
            ("success: (all trials) at most 0.5", "success in all trials: at most 0.5"),
            (
                "time-s-at-70: (furnished=true, prior=none) relative to (furnished=false, prior=none) between -0.1 and 0.1",
                "time-s-at-70: furnished true relative to false between -0.1 and 0.1, at prior none",
            ),
            ("outcome:late > outcome:collided in (start=A)", ""),
        ] {
            assert_eq!(said(about), words, "{about}");
        }
    }

    #[test]
    fn lines_are_those_of_the_statement() {
        let wanted = |about, name| Wanted::read(about, name).map(|w| (w.low, w.high));
        let (below, above) = (f64::NEG_INFINITY, f64::INFINITY);
        assert_eq!(wanted("success: (a=1) < (a=2)", "risk-difference"), Some((below, 0.0)));
        assert_eq!(wanted("x rises along 3 steps in (a=1)", "spearman"), Some((0.0, above)));
        assert_eq!(wanted("success: (a=1) at most 0.15", "share"), Some((below, 0.15)));
        assert_eq!(wanted("s: (a=1) = (a=2) within 0.1", "risk-difference"), Some((-0.1, 0.1)));
        let relative = "t: (a=1) relative to (a=2) between -0.45 and -0";
        assert_eq!(wanted(relative, "relative-difference"), Some((-0.45, 0.0)));
        assert_eq!(wanted("t: (a=1) < (a=2)", "share-of-pairs"), Some((0.5, above)));
        assert_eq!(wanted("every trial", "count"), None);
    }
}
