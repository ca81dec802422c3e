//! What figures ask for, held against factors, tables and published numbers.

use super::faults::Faults;
use super::requests::Requests;
use crate::studies::outcomes::OutcomeShares;
use crate::studies::{FigureLayout, Outcome, PublishedScatter, TableLayout};

impl Requests<'_> {
    /// Collects the faults of the requests for figures.
    pub(super) fn check_figures(self, faults: &mut Faults<'_>) {
        for (i, figure) in self.doc.figures.iter().enumerate() {
            match &figure.layout {
                FigureLayout::CoverageCurve(curve) => {
                    let pointer = format!("/figures/{i}/coverage-curve");
                    self.foreign(&pointer, faults);
                    faults.check_factor(self.factors, &curve.by, &format!("{pointer}/by"), false);
                    self.check_only(&curve.only, &pointer, faults);
                }
                FigureLayout::WorldPlan(plan) => {
                    let pointer = format!("/figures/{i}/world-plan");
                    self.foreign(&pointer, faults);
                    self.check_only(&plan.only, &pointer, faults);
                }
                FigureLayout::PriorOverWorld(plan) => {
                    let pointer = format!("/figures/{i}/prior-over-world");
                    self.foreign(&pointer, faults);
                    self.check_only(&plan.only, &pointer, faults);
                    let chosen = plan.only.get("prior").map(|value| value.0.as_str());
                    if chosen.or(self.doc.prior.as_deref()).is_none_or(|name| name == "none") {
                        let message = "the figure has no prior to lay over the world";
                        let fault = faults.key_fault(&pointer, message.to_owned());
                        let help = "say which, as in `where: {prior: bounding-box}`";
                        faults.push(fault.label("expected a prior other than `none`").help(help));
                    }
                }
                FigureLayout::OutcomeBars(bars) => {
                    let pointer = format!("/figures/{i}/outcome-bars");
                    self.check_outcomes(bars, &pointer, faults);
                }
                FigureLayout::OutcomeShares(wanted) => {
                    let pointer = format!("/figures/{i}/outcome-shares");
                    self.check_shares(wanted, &pointer, faults);
                }
                FigureLayout::PublishedScatter(wanted) => {
                    let pointer = format!("/figures/{i}/published-scatter");
                    self.check_scatter(wanted, &pointer, faults);
                }
                FigureLayout::PolicyGraph(wanted) => {
                    let pointer = format!("/figures/{i}/policy-graph");
                    self.foreign(&pointer, faults);
                    self.check_only(&wanted.only, &pointer, faults);
                }
            }
        }
    }

    fn check_shares(self, wanted: &OutcomeShares, pointer: &str, faults: &mut Faults<'_>) {
        self.check_only(&wanted.only, pointer, faults);
        self.check_columns(&wanted.by, &wanted.rows, pointer, faults);
        let mut counted: Vec<Outcome> = Vec::new();
        for (i, share) in wanted.published.iter().enumerate() {
            let place = format!("{pointer}/published/{i}");
            for outcome in &share.of {
                if counted.contains(outcome) {
                    let message = format!("`{}` is counted twice", outcome.name());
                    faults.at(&format!("{place}/of"), message, "shares must not overlap");
                }
                counted.push(*outcome);
            }
            self.check_published(
                Some(&share.table),
                &wanted.by,
                &wanted.rows,
                &format!("{place}/table"),
                faults,
            );
        }
    }

    fn check_scatter(self, wanted: &PublishedScatter, pointer: &str, faults: &mut Faults<'_>) {
        let place = format!("{pointer}/table");
        let with_numbers: Vec<(&str, &TableLayout)> = self
            .doc
            .tables
            .iter()
            .filter(|table| match &table.layout {
                TableLayout::CoverageTable(table) => table.published.is_some(),
                TableLayout::OutcomeTable(table) => table.published.is_some(),
                _ => false,
            })
            .map(|table| (table.id.as_str(), &table.layout))
            .collect();
        let Some((_, layout)) = with_numbers.iter().find(|(id, _)| *id == wanted.table) else {
            let message = format!("`{}` is no table with numbers of the paper's", wanted.table);
            let label = "expected the id of an outcome or coverage table with `published`";
            let known: Vec<&str> = with_numbers.iter().map(|(id, _)| *id).collect();
            faults.unknown(&place, message, label, &wanted.table, &known);
            return;
        };
        let (by, rows) = match layout {
            TableLayout::CoverageTable(table) => (&table.by, &table.rows),
            TableLayout::OutcomeTable(table) => (&table.by, &table.rows),
            _ => return,
        };
        if let Some(looks) = &wanted.by
            && looks != by
            && !rows.contains(looks)
        {
            faults.check_factor(self.factors, looks, &format!("{pointer}/by"), false);
            if self.factors.iter().any(|factor| factor.name == *looks) {
                let message = format!("the table `{}` does not tell `{looks}` apart", wanted.table);
                let known: Vec<&str> = rows.iter().chain([by]).map(String::as_str).collect();
                let label = format!("expected one of {}", known.join(", "));
                faults.at(&format!("{pointer}/by"), message, &label);
            }
        }
        let has_baseline =
            matches!(layout, TableLayout::CoverageTable(table) if table.baseline.is_some());
        if wanted.ratios && !has_baseline {
            let message = format!("the table `{}` has no baseline", wanted.table);
            faults.at(
                &format!("{pointer}/ratios"),
                message,
                "ratios are to a coverage table's `baseline`",
            );
        }
    }
}
