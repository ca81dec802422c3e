//! What a bundle tells people of its results: the finding, the limits, claims, tables and figures in words. `index.html` and
//! `README.md` are written from it.

use super::{Exhibited, Found, finding, format, limits};
use crate::claims::{ClaimVerdict, compared};
use crate::plan::Plan;
use crate::stats::compatibility::Agreement;
use crate::studies::{End, Exhibit, GridRow, Ledger};
use crate::table::Table;

/// Results in words.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Account {
    /// What was found, in a sentence or two.
    pub finding: String,
    /// What the numbers cannot show, a sentence each.
    pub limits: Vec<String>,
    /// Why only a part was run; `None` for a whole run.
    pub partial: Option<String>,
    /// The claims about the study, judged.
    pub claims: Vec<ToldClaim>,
    /// The tables.
    pub tables: Vec<ToldTable>,
    /// The figures.
    pub figures: Vec<ToldFigure>,
    /// A question that the data answer; `None` where there are no trials to ask about.
    pub question: Option<Question>,
}

/// A claim and its verdict.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ToldClaim {
    /// Its id in the manifest.
    pub id: String,
    /// The paper's sentence, or what we check besides.
    pub words: String,
    /// Whether it is no claim of the paper.
    pub is_ours: bool,
    /// Where the paper says so; may be empty.
    pub cite: String,
    /// The verdict's name.
    pub verdict: String,
    /// What the paper's own table shows: `supports`, `contradicts`, `silent`.
    pub paper_table: String,
}

/// A table as a document has room for it.
#[derive(Debug, Clone, PartialEq)]
pub struct ToldTable {
    /// Its tidy form, relative to the payload.
    pub path: String,
    /// Its title.
    pub title: String,
    /// The answer to what it asks, where it asks something.
    pub answer: Option<String>,
    /// Its lines.
    pub lines: Table,
    /// How many cells the lines leave out, which the tidy form has.
    pub more: usize,
    /// What its marks mean; `None` where it has none.
    pub rules: Option<String>,
}

/// A figure in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ToldFigure {
    /// Its file, relative to the payload.
    pub path: String,
    /// Its title.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// What it shows, for those who cannot see it.
    pub alt: String,
}

/// How many trials of one condition succeeded, and whether one claim holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// The condition's factors and values.
    pub condition: Vec<(String, String)>,
    /// The outcomes that are a success.
    pub outcomes: Vec<String>,
    /// The claim's id, where claims are judged.
    pub claim: Option<String>,
}

/// What an account is made from.
pub(super) struct Shown<'a> {
    pub(super) plan: &'a Plan,
    pub(super) ledger: &'a Ledger,
    pub(super) conditions: u64,
    pub(super) partial: Option<String>,
    pub(super) verdicts: &'a [ClaimVerdict],
    pub(super) exhibits: Vec<Exhibit>,
    pub(super) figures: Vec<ToldFigure>,
}

impl Account {
    /// Tells what is `shown`.
    pub(super) fn of(shown: Shown<'_>) -> Self {
        let Shown { plan, ledger, conditions, partial, verdicts, exhibits, figures } = shown;
        let grids: Vec<&[GridRow]> = exhibits.iter().map(|e| &e.set.grid.rows[..]).collect();
        let cells: Vec<Agreement> = grids
            .iter()
            .flat_map(|rows| rows.iter().flat_map(|row| &row.cells))
            .map(|cell| cell.agreement)
            .collect();
        let claims: Vec<ToldClaim> = verdicts.iter().map(ToldClaim::of).collect();
        let papers: Vec<String> =
            claims.iter().filter(|claim| !claim.is_ours).map(|c| c.verdict.clone()).collect();
        let compared = compared(verdicts, &plan.experiment.labels);
        let finding = finding(Found {
            answer: exhibits.iter().find_map(|exhibit| exhibit.answer.as_deref()),
            verdicts: &papers,
            cells: &cells,
            compared: compared.as_deref(),
            partial: partial.as_deref(),
            trials: ledger.len() as u64,
            conditions,
        });
        let requests = plan.experiment.figures.iter();
        let is_drawn = |id: &str| figures.iter().any(|f| f.path.ends_with(&format!("/{id}.svg")));
        let drawn: Vec<&str> =
            requests.map(|request| request.id.as_str()).filter(|id| is_drawn(id)).collect();
        let censored = verdicts.iter().filter(|verdict| verdict.censored().is_some()).count();
        let limits = limits(plan, ledger, Exhibited { tables: &grids, figures: &drawn, censored });
        let question = Question::of(plan, claims.first());
        Self {
            finding,
            limits,
            partial,
            claims,
            tables: exhibits.into_iter().map(ToldTable::of).collect(),
            figures,
            question,
        }
    }
}

impl ToldClaim {
    fn of(verdict: &ClaimVerdict) -> Self {
        Self {
            id: verdict.id.clone(),
            words: verdict.says.clone().or_else(|| verdict.ours.clone()).unwrap_or_default(),
            is_ours: verdict.ours.is_some(),
            cite: verdict.cite.clone().unwrap_or_default(),
            verdict: verdict.judgement.to_string(),
            paper_table: verdict.paper_table.to_string(),
        }
    }
}

impl ToldTable {
    fn of(exhibit: Exhibit) -> Self {
        Self {
            path: format!("{}tables/{}.csv", format::RESULTS, exhibit.id),
            rules: exhibit.rules(),
            more: exhibit.set.more,
            lines: exhibit.print().clone(),
            title: exhibit.title,
            answer: exhibit.answer,
        }
    }
}

impl Question {
    /// Asks about the first condition and the first claim.
    fn of(plan: &Plan, claim: Option<&ToldClaim>) -> Option<Self> {
        let known = plan.experiment.kind.outcomes();
        let successes = known.iter().filter(|outcome| outcome.end() == End::Success);
        let mut outcomes: Vec<String> = successes.map(|o| o.name().to_owned()).collect();
        if outcomes.is_empty() {
            outcomes.extend(known.first().map(|outcome| outcome.name().to_owned()));
        }
        let condition = &plan.trials.first()?.condition;
        Some(Self {
            condition: condition.iter().map(|(f, v)| (f.clone(), v.clone())).collect(),
            outcomes,
            claim: claim.map(|claim| claim.id.clone()),
        })
    }
}
