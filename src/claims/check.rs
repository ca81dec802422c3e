//! The faults of claims, found before anything runs.

use super::assume::Assume;
use super::claim::Claim;
use super::faults::{ClaimFault, Faults, Known};
use super::forms::Form;
use super::metric::{Metric, WALL_TIME};
use super::terms::{Censored, Sides, Test};
use crate::document::quoted;
use std::collections::BTreeSet;

/// Returns the faults of a manifest's claims, by the claim's number: those of each ([`Claim::check`]) and ids used twice.
pub fn check_all<'a>(
    claims: &'a [Claim],
    known: Known<'a>,
) -> impl Iterator<Item = (usize, ClaimFault<'a>)> + 'a {
    let mut ids = BTreeSet::new();
    claims.iter().enumerate().flat_map(move |(i, claim)| {
        let twice = (!ids.insert(claim.id.as_str())).then(|| {
            ClaimFault::new("/id", format!("the id `{}` is used twice", quoted(&claim.id)))
        });
        twice.into_iter().chain(claim.check(known)).map(move |fault| (i, fault))
    })
}

impl Claim {
    /// Returns the faults of this claim in a study where this is `known`. Empty where it can be judged.
    pub fn check<'a>(&'a self, known: Known<'a>) -> Vec<ClaimFault<'a>> {
        let mut faults = Faults::new(known);
        if self.id.is_empty() {
            faults.add("/id", "expected a name, found nothing".to_owned());
        }
        self.check_words(&mut faults);
        let form = self.expect.as_form();
        faults.base = format!("/expect/{}", self.expect.form());
        self.check_circumstance(&mut faults);
        for (path, selection) in form.scope().selections {
            faults.selection(&path, selection);
        }
        check_names(form, &mut faults);
        check_terms(form, &mut faults);
        form.check(&mut faults);
        faults.base = String::new();
        faults.selection("/only", &self.only);
        check_assumption(self.power.as_ref(), &mut faults);
        faults.found
    }

    /// Checks the words, the paper's or ours: one of the two, and not empty.
    fn check_words(&self, faults: &mut Faults<'_>) {
        match (&self.says, &self.ours) {
            (Some(_), Some(_)) => faults.add(
                "",
                "expected `says` or `ours`, found both; keep `says` where the words are the paper's, `ours` where they are your \
                 own"
                    .to_owned(),
            ),
            (None, None) => faults.add(
                "",
                "expected `says` with the paper's words, or `ours` with a check of your own, found neither".to_owned(),
            ),
            _ => {}
        }
        for (key, words) in [("/says", &self.says), ("/ours", &self.ours)] {
            let said = words.as_ref().is_none_or(|words| !words.trim().is_empty());
            faults.unless(said, key, || "expected words, found none".to_owned());
        }
    }

    fn check_circumstance(&self, faults: &mut Faults<'_>) {
        for (path, metric) in self.expect.as_form().scope().measured {
            let wall = metric.starts_with(WALL_TIME);
            let metric = quoted(metric);
            if wall && !self.circumstance {
                faults.add(
                    &path,
                    format!(
                        "`{metric}` depends on the machine and belongs to the circumstance half of a bundle; mark the claim \
                         `circumstance: true` or measure simulated time"
                    ),
                );
            } else if !wall && self.circumstance {
                let message = format!(
                    "`{metric}` is a result of the study; only claims on {WALL_TIME} metrics are circumstance"
                );
                faults.found.push(ClaimFault::new("/circumstance", message));
            }
        }
    }
}

/// Checks the metrics and the published table that a form names.
fn check_names<'a>(form: &'a dyn Form, faults: &mut Faults<'a>) {
    let scope = form.scope();
    let named = scope.measured;
    faults.unless(!named.is_empty() || !form.needs_metric(), "/metric", || {
        "expected a metric, found none".to_owned()
    });
    for (path, metric) in named {
        // Outcomes that count together are known where each of them is.
        let parts: Vec<String> = match Metric::named(metric) {
            Metric::Outcome(names) => names.iter().map(|n| format!("outcome:{n}")).collect(),
            _ => vec![metric.to_owned()],
        };
        for part in &parts {
            faults.metric(&path, part);
        }
    }
    if let Some(table) = scope.published {
        faults.table("/published", table);
    }
}

fn check_terms(form: &dyn Form, faults: &mut Faults<'_>) {
    let terms = form.terms();
    faults.unless(terms.alpha > 0.0 && terms.alpha < 0.5, "/alpha", || {
        format!("expected a level between 0 and 0.5, found {}", terms.alpha)
    });
    faults.unless(terms.minimum_n > 0, "/minimum-n", || "expected at least 1, found 0".to_owned());
    faults.unless(terms.at_least != Some(0), "/at-least", || {
        "expected at least 1, found 0: every verdict would be supported".to_owned()
    });
    if let Some(test) = terms.test {
        let allowed = form.has_test(test);
        faults.unless(allowed, "/test", || format!("{} is no test of this form", test.name()));
        let mut measured = form.scope().measured.into_iter();
        let fits = measured.all(|(_, name)| Metric::named(name).is_share() == test.is_of_shares());
        faults.unless(!allowed || fits, "/test", || {
            let kind =
                if test.is_of_shares() { "shares (success, outcome:...)" } else { "measures" };
            format!("{} is a test of {kind}", test.name())
        });
        let both = matches!(test, Test::Anova | Test::ChiSquare);
        faults.unless(!both || terms.sides == Sides::Two, "/sides", || {
            format!("{} has two sides; say `sides: two`", test.name())
        });
    }
    faults.unless(form.ranks() || terms.censored != Censored::Worst, "/censored", || {
        "`worst` has a rank and no value: it needs mann-whitney, spearman, median, p95 or pairs of trials".to_owned()
    });
}

fn check_assumption(power: Option<&Assume>, faults: &mut Faults<'_>) {
    match power {
        None => {}
        Some(Assume::Published { table, scale }) => {
            faults.table("/power/published/table", table);
            faults.margin("/power/published/scale", *scale);
        }
        Some(Assume::Cells(cells)) => {
            for (i, cell) in cells.iter().enumerate() {
                faults.selection(&format!("/power/cells/{i}/where"), &cell.r#where);
            }
        }
    }
}
