//! One cell or pool against another: what `less` and `greater` say, and how they are judged. Tests: `fisher-exact`,
//! `chi-square` (shares); `welch`, `anova`, `mann-whitney`, `brown-forsythe` (measures).

use super::declare::form;
use super::difference::compare;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cells::{ForEach, Than, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft};
use crate::claims::metric::Metric;
use crate::claims::terms::{PerRun, Side, Terms, Test};

form! {
    /// `less`, `greater`.
    #[schemars(rename = "Comparison")]
    pub struct Contrast {
        /// What is measured; several metrics are several comparisons, unless `per-run` makes one number of them.
        pub metric: Values,
        /// How the metrics of one run become one number: coverages of one run are no independent measurements.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub per_run: Option<PerRun>,
        /// The first cell or pool.
        #[serde(default)]
        pub r#where: Where,
        /// The other side.
        pub than: Than,
        /// Repeated over these, on both sides.
        #[serde(default)]
        pub for_each: ForEach,
    }
    terms {
        /// Default: `fisher-exact` for shares, `welch` for measures.
        test,
        /// Tails that count; `anova` and `chi-square` know both only.
        sides,
        alpha, correction, at_least,
        /// Runs per cell (that reached the measure) without which nothing is judged.
        minimum_n,
        also_at_n, censored,
    }
}

/// A comparison that says which side its first cell lies on.
pub(super) trait Directed {
    const SIDE: Side;

    fn contrast(&self) -> &Contrast;
}

impl<F: Directed> Form for F {
    fn terms(&self) -> Terms {
        self.contrast().shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        let form = self.contrast();
        let named = [("/where", &form.r#where), ("/than/where", &form.than.r#where)];
        Scope::two_cells(&form.metric, named, &form.for_each)
    }

    fn ranks(&self) -> bool {
        self.contrast().test == Some(Test::MannWhitney)
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        let form = self.contrast();
        faults.each("/than/each", &form.than);
        check_per_run(form, faults);
        faults.unless(form.also_at_n.is_none_or(|n| n >= 2), "/also-at-n", || {
            "expected at least 2: fewer trials have no spread".to_owned()
        });
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let form = self.contrast();
        let mut drafts = Vec::new();
        for metric in Metric::of_run(&form.metric.0, form.per_run) {
            for pins in form.for_each.combinations() {
                for other in form.than.cells() {
                    let cells = [form.r#where.pinned(&pins), other.pinned(&pins)];
                    drafts.push(compare(bench, &metric, &cells, Self::SIDE));
                }
            }
        }
        drafts
    }
}

fn check_per_run(form: &Contrast, faults: &mut Faults<'_>) {
    let Some(per_run) = form.per_run else { return };
    let share = form.metric.0.iter().find(|name| Metric::named(name).is_share());
    faults.unless(share.is_none(), "/per-run", || {
        let share = share.map_or("", String::as_str);
        format!("`{share}` is a share of runs; only measures have logarithms")
    });
    let found = form.metric.0.len();
    let (fits, expected) = match per_run {
        PerRun::MeanLog => (found >= 2, "two metrics or more"),
        PerRun::LogRatio => (found == 2, "two metrics"),
    };
    faults.unless(fits, "/per-run", || format!("expected {expected}, found {found}"));
}
