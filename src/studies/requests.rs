//! What a manifest may ask to see: tables and figures in its study's layouts.

use super::{Drawn, Exhibit, Findings, PublishedScatter, deadline, inference, outcomes, prior_map};
use crate::figure::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One table to produce.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct TableRequest {
    /// Name of its file: lower-case letters, digits and hyphens, unique.
    pub id: String,
    /// Its title.
    #[serde(default)]
    pub title: String,
    /// What it shows, and how.
    #[serde(flatten)]
    pub layout: TableLayout,
}

/// The layouts of tables, each a variant of [`TableLayout`] that holds what a manifest says of it.
macro_rules! table_layouts {
    ($($(#[$doc:meta])* $name:ident $key:literal ($wanted:ty),)*) => {
        /// The layouts of tables.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum TableLayout {
            $($(#[$doc])* #[serde(rename = $key)] $name($wanted),)*
        }

        impl TableLayout {
            /// Returns its key in manifests.
            pub fn key(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => $key,)*
                }
            }
        }

        impl TableRequest {
            /// Makes the table of `findings`; `tables` are all that the manifest asks for.
            pub fn exhibit(&self, findings: &Findings<'_>, tables: &[Self]) -> Exhibit {
                match &self.layout {
                    $(TableLayout::$name(wanted) => Exhibit::of(self, wanted, findings, tables),)*
                }
            }
        }
    };
}

table_layouts! {
    /// Prior map: mean and standard deviation of a metric at levels of coverage, as in Tables 1 to 10.
    CoverageTable "coverage-table" (prior_map::CoverageTable),
    /// Prior map: slope, correlation and distance of log ratios to the baseline, ours against the paper's.
    AgreementTable "agreement-table" (prior_map::AgreementTable),
    /// Prior map: what each reading of the paper leaves of its tables unexplained.
    ReadingsTable "readings-table" (prior_map::ReadingsTable),
    /// Prior map: how much each level of a factor moves a metric, over matched conditions.
    EffectsTable "effects-table" (prior_map::EffectsTable),
    /// Prior map: measures of whole trials side by side, as the numbers of section 4.5.
    MeasuresTable "measures-table" (prior_map::MeasuresTable),
    /// Deadline: shares of outcomes, means and ratios by condition, as in Tables 1 and 2.
    OutcomeTable "outcome-table" (outcomes::OutcomeTable),
    /// Deadline: the six maneuvers as calibrated and as they went in the study's own trials.
    ManeuverTable "maneuver-table" (deadline::ManeuverTable),
    /// What an inference found; every manifest with `infer` has all of them.
    InferenceTable "inference-table" (inference::InferenceTable),
    /// What an inference from trials found; every manifest whose `infer` has choices has all of them.
    FromTrialsTable "inference-from-trials-table" (inference::from_trials::FromTrialsTable),
}

/// Returns the coverage tables among `tables`, each with its id.
pub fn coverage_tables(tables: &[TableRequest]) -> Vec<(&str, &prior_map::CoverageTable)> {
    tables
        .iter()
        .filter_map(|request| match &request.layout {
            TableLayout::CoverageTable(table) => Some((request.id.as_str(), table)),
            _ => None,
        })
        .collect()
}

/// One figure to produce.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FigureRequest {
    /// Name of its file: lower-case letters, digits and hyphens, unique.
    pub id: String,
    /// Its title.
    #[serde(default)]
    pub title: String,
    /// What it shows, and how.
    #[serde(flatten)]
    pub layout: FigureLayout,
}

/// The layouts of figures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FigureLayout {
    /// Prior map: coverage over time or distance, one curve per value of a factor, as in Figure 4.
    CoverageCurve(prior_map::CoverageCurve),
    /// Prior map: an environment's floor plan with its dimensions, as in Figure 3.
    WorldPlan(prior_map::PlanFigure),
    /// Prior map: the obstacles of a prior map over the floor plan, as in Figure 5.
    PriorOverWorld(prior_map::PlanFigure),
    /// One estimate per value of a factor with its interval, in panels of conditions: bars of shares, dots of means, as in the
    /// deadline study's Figures 4 and 5.
    OutcomeBars(outcomes::OutcomeTable),
    /// How the ways in which trials ended add up, one bar per value of a factor, in panels of conditions.
    OutcomeShares(outcomes::OutcomeShares),
    /// The paper's numbers against ours, one point per cell of a table.
    PublishedScatter(PublishedScatter),
    /// Deadline: policies on the toposemantic graph of the building, from a start to the goal.
    PolicyGraph(deadline::PolicyGraph),
}

impl FigureRequest {
    /// Draws the figure of `findings`; `tables` are all that the manifest asks for. `None` where no trial that was run has
    /// anything to show in it, as a partial run may leave it: axes alone would look like a result.
    pub fn draw(&self, findings: &Findings<'_>, tables: &[TableRequest]) -> Option<Drawn> {
        self.draw_for(findings, tables, Medium::Screen)
    }

    /// Draws it as wide as `medium` wants it.
    pub fn draw_for(
        &self,
        findings: &Findings<'_>,
        tables: &[TableRequest],
        medium: Medium,
    ) -> Option<Drawn> {
        let title = self.title.as_str();
        match &self.layout {
            FigureLayout::CoverageCurve(wanted) => wanted.draw(title, findings, tables, medium),
            FigureLayout::WorldPlan(wanted) => Some(wanted.draw(title, findings, medium)),
            FigureLayout::PriorOverWorld(wanted) => {
                Some(wanted.draw_with_prior(title, findings, medium))
            }
            FigureLayout::OutcomeBars(wanted) => wanted.draw(title, findings, medium),
            FigureLayout::OutcomeShares(wanted) => wanted.draw(title, findings, medium),
            FigureLayout::PublishedScatter(wanted) => wanted.draw(title, findings, tables, medium),
            FigureLayout::PolicyGraph(wanted) => Some(wanted.draw(title, findings, medium)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_survive_a_round_trip() {
        let json = serde_json::json!({
            "id": "figure-4", "title": "", "coverage-curve":
            {"against": "time-s", "by": "prior", "where": {"furnished": "false"}}
        });
        let request: FigureRequest = serde_json::from_value(json.clone()).unwrap();
        assert_eq!(serde_json::to_value(request).unwrap(), json);
    }
}
