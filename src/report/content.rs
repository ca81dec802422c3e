//! What a report says, before it has a look: plain values, filled in from a bundle.

use super::{ClaimRow, Evaluation, Provenance};
use crate::studies::{Exhibit, GridRow, Source};
use serde::Serialize;

/// Everything on the page of one bundle.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ReportContent {
    /// Title of the manifest.
    pub title: String,
    /// How far it was checked before it was shown, in words; empty where nobody says.
    pub checked: String,
    /// What is reproduced.
    pub citation: Citation,
    /// Authors of the manifest.
    pub authors: Vec<String>,
    /// Licence of the manifest and the results (SPDX).
    pub license: String,
    /// What the numbers do not show, one sentence each; said before any number.
    pub limits: Vec<String>,
    /// Why this run is partial; `None` for a whole one.
    pub partial: Option<String>,
    /// The questions that the study's tables ask, answered: said first.
    pub answers: Vec<Answer>,
    /// The run in a few numbers.
    pub headline: Headline,
    /// The tables, in the paper's order.
    pub tables: Vec<ReportTable>,
    /// The figures.
    pub figures: Vec<Figure>,
    /// The claims judged; empty where the manifest has none or the run is partial.
    pub claims: Vec<ClaimRow>,
    /// Claims about the machine of the run, which are no results; mostly empty.
    pub machine_claims: Vec<ClaimRow>,
    /// Which side of what the study compares came out ahead; empty where no claim says so.
    pub compared: String,
    /// Choices the paper leaves open, with their reasons.
    pub assumptions: Vec<Assumption>,
    /// How other values of the assumptions were tried: `15 trials per condition, one setting at a time, same noise`;
    /// `None` where none were.
    pub tried_with: Option<String>,
    /// The claims where all choices change at once; `None` where that was not tried.
    pub multiverse: Option<Matrix>,
    /// Where it all comes from.
    pub provenance: Provenance,
    /// What an evaluator checks, and how.
    pub evaluation: Evaluation,
}

/// The work that is reproduced.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Citation {
    /// The paper, as one would cite it.
    pub paper: String,
    /// Which part of it: `section 4.2, Tables 1 and 2`; may be empty.
    pub section: String,
    /// Digital object identifier; may be empty.
    pub doi: String,
}

/// A question that a table asks, and what it answers.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Answer {
    /// Id of the table.
    pub table: String,
    /// Its title.
    pub question: String,
    /// The answer, in sentences.
    pub answer: String,
}

/// The run in a few numbers.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Headline {
    /// Study kind, as in the manifest.
    pub study: String,
    /// Trials in the bundle.
    pub trials: u64,
    /// Cells of the design.
    pub conditions: u64,
    /// How the trials ended, the most frequent first.
    pub outcomes: Vec<OutcomeCount>,
    /// Simulated time of all trials (s).
    pub sim_seconds: f64,
    /// The experiment's seed.
    pub seed: u64,
    /// Results digest, 64 hex digits.
    pub results_digest: String,
    /// Bundle id, 64 hex digits; empty where the bundle is not sealed yet.
    pub bundle_id: String,
    /// Version of the engine that ran the trials.
    pub engine_version: String,
}

/// How many trials ended one way.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct OutcomeCount {
    /// Name of the outcome.
    pub name: String,
    /// Number of trials.
    pub count: u64,
}

/// One table of ours in the paper's layout, each cell beside the paper's.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ReportTable {
    /// Identifier, unique in the report: letters, digits, hyphens.
    pub id: String,
    /// What it shows.
    pub title: String,
    /// Where the published values stand: `Table 1`; empty where nothing is published.
    pub source: String,
    /// Quantity and unit of the cells: `distance travelled (m)`.
    pub quantity: String,
    /// What stands in a cell's second line: `paper`, where it is the paper's number.
    pub beside: String,
    /// Decimals the cells are shown with.
    pub decimals: u8,
    /// What the rows are: `coverage`.
    pub row_header: String,
    /// What the columns are, one name each: `no prior`, `floor plan`.
    pub columns: Vec<String>,
    /// The rows, each with one cell per column.
    pub rows: Vec<GridRow>,
}

impl ReportTable {
    /// Makes the page's table of `exhibit`; the paper's numbers stand in its part `section`, and cells are of `trials` at most.
    pub(crate) fn of(exhibit: Exhibit, section: &str, trials: usize) -> Self {
        let Exhibit { id, title, set, .. } = exhibit;
        let grid = set.grid;
        // Cells over several conditions hold more than the trials of one.
        let cells = grid.rows.iter().flat_map(|row| &row.cells);
        let most = cells.filter_map(|cell| cell.ours.as_ref()?.n).max().unwrap_or(0);
        Self {
            id,
            title: match (grid.of_trials, most > trials as u64) {
                (true, true) => format!("{title} (n = {most} trials a cell at most)"),
                (true, false) => format!("{title} (n = {trials} trials a cell)"),
                (false, _) => title,
            },
            source: match grid.source {
                Source::Nowhere => String::new(),
                Source::Paper => section.to_owned(),
                Source::Other(place) => place.to_owned(),
            },
            quantity: grid.quantity,
            beside: grid.beside.to_owned(),
            decimals: grid.decimals,
            row_header: grid.row_header,
            columns: grid.columns,
            rows: grid.rows,
        }
    }
}

/// A figure.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Figure {
    /// Identifier, unique in the report: letters, digits, hyphens.
    pub id: String,
    /// Its title.
    pub title: String,
    /// The sentence under it.
    pub caption: String,
    /// What it shows, for those who cannot see it.
    pub alt: String,
    /// The drawing, SVG text.
    pub svg: String,
    /// Where it lies in the bundle.
    pub file: String,
}

/// A value the paper leaves open, and why this one.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Assumption {
    /// Where it stands in the manifest: `parameters.mapping.particles`.
    pub path: String,
    /// The value chosen, as text.
    pub value: String,
    /// The reason.
    pub why: String,
    /// The other values that could as well have been chosen, as text; empty where the manifest states none.
    pub range: Vec<String>,
    /// The other values of its stated range that were tried, in the order of the range; `None` where no range is
    /// stated.
    pub tried: Option<Vec<Tried>>,
}

/// One other value of a setting, and what it did to the verdicts.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Tried {
    /// The value tried, as text: `0.2`.
    pub at: String,
    /// The verdicts that are not what they are at the value chosen; empty where all stay.
    pub flips: Vec<FlipRow>,
}

/// A verdict that another value of a setting changes.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FlipRow {
    /// The claim's id: `D4`.
    pub claim: String,
    /// Its verdict at the value chosen.
    pub from: String,
    /// Its verdict at the value tried.
    pub to: String,
}

/// Claims and choices: what holds where all choices change at once, and which of them explains it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Matrix {
    /// How the draws were made, in words.
    pub made: String,
    /// How to read it.
    pub rules: String,
    /// The file of the draws, as the manifest names it.
    pub file: String,
    /// The choices.
    pub columns: Vec<MatrixColumn>,
    /// The claims.
    pub rows: Vec<MatrixRow>,
    /// Draws that were not run.
    pub refused: Vec<RefusedDraw>,
}

/// One choice.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MatrixColumn {
    /// Where it stands in the manifest: `parameters.pilot.lookahead-m`.
    pub path: String,
    /// The same without what stands before all of them.
    pub name: String,
}

/// One claim.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MatrixRow {
    /// Its id.
    pub claim: String,
    /// Its verdict at the values chosen.
    pub chosen: String,
    /// How many draws give each verdict.
    pub counts: Vec<(String, u64)>,
    /// How many draws support it: `16 of 23 (49 to 85 %)`.
    pub support: String,
    /// The same in percent; `None` where no draw was judged.
    pub percent: Option<f64>,
    /// What of it is explained: `estimate` or `support`.
    pub explained: String,
    /// Which choice explains most, or why none does.
    pub most: String,
    /// What each choice explains.
    pub cells: Vec<MatrixCell>,
}

/// What one choice explains of one claim.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MatrixCell {
    /// `62 %*`; empty where there is nothing to explain.
    pub text: String,
    /// How dark it is drawn, 0 to 4.
    pub shade: usize,
    /// Whether it is more than chance would make it.
    pub stands_out: bool,
}

/// A draw that the manifest's own checks refuse.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RefusedDraw {
    /// Its number.
    pub draw: usize,
    /// Why.
    pub reason: String,
}
