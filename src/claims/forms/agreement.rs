//! Our cells beside the paper's: what `correlation-with-published` and `rmse-with-published` have in common.

use super::pairing::{Pair, Point, log_ratios, pair_up};
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence};

/// More cells than any paper prints; a bound on what a verdict lists.
const MOST_CELLS: usize = 1000;

/// Cells to compare, without which no agreement is one.
const FEWEST_CELLS: u64 = 4;

/// Which of our cells are held against which of the paper's.
pub(super) struct Compared<'a> {
    pub(super) metric: &'a Values,
    pub(super) published: &'a str,
    pub(super) scale: f64,
    pub(super) only: &'a Where,
    pub(super) ratio_to: Option<&'a Where>,
    pub(super) minimum_n: u64,
}

/// Makes [`Compared`] of a form, which has the terms of the comparison among its own.
macro_rules! compared {
    ($form:expr) => {
        Compared {
            metric: &$form.metric,
            published: &$form.published,
            scale: $form.scale,
            only: &$form.r#where,
            ratio_to: $form.ratio_to.as_ref(),
            minimum_n: $form.minimum_n,
        }
    };
}
pub(super) use compared;

impl<'a> Compared<'a> {
    /// Returns what is looked at; which cells are compared is for the published table to say.
    pub(super) fn scope(&self) -> Scope<'a> {
        let base = self.ratio_to.map(|cell| ("/ratio-to".to_owned(), cell));
        let selections = [("/where".to_owned(), self.only)].into_iter().chain(base).collect();
        Scope::published(self.metric, self.published, selections)
    }

    pub(super) fn check(&self, faults: &mut Faults<'_>) {
        let single = |base: &Where| !base.0.is_empty() && base.0.values().all(|v| v.0.len() == 1);
        faults.unless(self.ratio_to.is_none_or(single), "/ratio-to", || {
            "expected one value per factor: the base of a ratio is one cell".to_owned()
        });
    }

    /// Compares cells, or log ratios of cells, with the paper's: one draft, in which `weigh` judges what is `claimed` of them.
    pub(super) fn draft(
        &self,
        bench: &Bench<'_>,
        test: &'static str,
        claimed: &str,
        weigh: impl FnOnce(&str, &[Pair], &[Point<'_>]) -> Result<Evidence, CannotTest>,
    ) -> Vec<Draft> {
        let ratio = self.ratio_to.map(|base| format!(" as log ratio to ({base})"));
        let about = format!(
            "{}{} against published `{}`: {claimed}",
            self.metric.0.join(" and "),
            ratio.unwrap_or_default(),
            self.published
        );
        let mut paired = pair_up(bench, self.metric, self.published, self.scale, self.only);
        let mut notes = paired.notes;
        let evidence = paired.pairs.and_then(|pairs| {
            let points = match self.ratio_to {
                None => pairs.iter().map(Point::of).collect(),
                Some(base) => {
                    let (points, lost) = log_ratios(&pairs, base);
                    if lost > 0 {
                        notes
                            .push(format!("{lost} cells have no positive base to take a ratio to"));
                    }
                    points
                }
            };
            let (cells, minimum) = (points.len(), self.minimum_n.max(FEWEST_CELLS));
            if (cells as u64) < minimum {
                return Err(CannotTest::FewCells { cells, minimum });
            }
            weigh(&about, &pairs, &points)
        });
        paired.cells.truncate(MOST_CELLS);
        let cells = paired.cells;
        vec![Draft { about, test, cells, conditions: Vec::new(), evidence, notes }]
    }
}
