//! What the draws say, as tables: claims down, choices across.

use super::draws::Multiverse;
use super::explained::{Explained, Explanation, LEAST_DRAWS, STANDS_OUT};
use crate::claims::verdict::{Judgement, rounded};
use crate::stats::variance_share::Share;
use crate::table::{Column, Table, Value};

/// What stands before most settings and tells none apart.
const PARAMETERS: &str = "parameters.";

/// Returns the name by which a table's column or a line knows the setting at `path`.
pub fn short(path: &str) -> &str {
    path.strip_prefix(PARAMETERS).unwrap_or(path)
}

/// Writes a share as a whole percentage; what stands out has a mark.
fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

impl Explained {
    /// Says how many draws support the claim: `16 of 23 (49 to 85 %)`.
    pub fn support_in_words(&self) -> String {
        let supported = format!("{} of {}", self.count(Judgement::Supported), self.judged());
        match self.support {
            Some(interval) => {
                format!(
                    "{supported} ({:.0} to {:.0} %)",
                    100.0 * interval.low,
                    100.0 * interval.high
                )
            }
            None => supported,
        }
    }

    /// Says which choice explains most of what changes, by the names of `settings`: `drive.speed-m-s explains 62 % of the
    /// estimate`, or why none does.
    pub fn most_in_words(&self, settings: &[String]) -> String {
        let quantity = self.quantity.name();
        if self.known < LEAST_DRAWS {
            return format!("too few draws to explain its {quantity}: {LEAST_DRAWS} at least");
        }
        if self.shares.iter().all(Option::is_none) {
            return format!("its {quantity} is the same in every draw");
        }
        let Some((place, share)) = self.most() else {
            return format!("no choice stands out in its {quantity}");
        };
        let mut words =
            format!("{} explains {} of its {quantity}", short(&settings[place]), percent(share));
        let mut others: Vec<(usize, f64)> = (0..settings.len())
            .filter(|other| *other != place && self.stands_out(*other))
            .filter_map(|other| Some((other, self.shares[other]?.share)))
            .collect();
        others.sort_by(|a, b| b.1.total_cmp(&a.1));
        for (other, share) in others {
            words.push_str(&format!(", {} {}", short(&settings[other]), percent(share)));
        }
        words
    }

    /// Writes what the choice at `place` explains, as a cell shows it: `62 %*` where it stands out, `0 %` for nothing beyond chance,
    /// nothing where there is nothing to explain.
    pub fn cell(&self, place: usize) -> String {
        let share = self.shares.get(place).copied().flatten();
        let mark = if self.stands_out(place) { "*" } else { "" };
        share.map(|Share { share, .. }| percent(share) + mark).unwrap_or_default()
    }
}

impl Multiverse {
    /// Says how the draws were made: `24 draws of 3 choices, 3 trials per condition, seed 7; 1 draw was refused`.
    pub fn in_words(&self) -> String {
        let counted =
            |n: usize, thing: &str| format!("{n} {thing}{}", if n == 1 { "" } else { "s" });
        let refused = match self.refused().count() {
            0 => String::new(),
            1 => "; 1 draw was refused".to_owned(),
            several => format!("; {several} draws were refused"),
        };
        format!(
            "{} of {}, {} per condition, seed {}{refused}",
            counted(self.draws.len(), "draw"),
            counted(self.settings.len(), "choice"),
            counted(self.trials as usize, "trial"),
            self.seed
        )
    }

    /// Says how to read the matrix, and what its numbers do not say.
    pub fn rules(&self) -> String {
        format!(
            "Every draw changes all choices at once, evenly over their ranges (a Latin hypercube); intervals are Wilson's of 95 %. A cell \
             is the share of the variance, from draw to draw, of what the claim is judged by that the choice explains by itself, less \
             what chance would put there (epsilon squared); what is missing to 100 % is combinations of choices and chance. * marks a \
             share so large that chance makes the largest of a row as large in {:.0} % of random orders at most",
            100.0 * STANDS_OUT
        )
    }
}

impl Explanation<'_> {
    /// Returns the matrix as a document shows it: a row a claim, a column a choice.
    pub fn matrix(&self) -> Table {
        let first = ["claim", "as chosen", "draws that support it", "contradict it", "explained"];
        let settings = self.multiverse.settings.iter().map(|path| short(path).to_owned());
        let mut table = Table::new(first.into_iter().map(str::to_owned).chain(settings));
        for claim in &self.claims {
            let mut row: Vec<Value> = vec![
                claim.claim.as_str().into(),
                claim.chosen.to_string().into(),
                claim.support_in_words().into(),
                i64::try_from(claim.count(Judgement::Contradicted)).ok().into(),
                claim.quantity.name().into(),
            ];
            row.extend(
                (0..self.multiverse.settings.len()).map(|place| Value::from(claim.cell(place))),
            );
            table.push(row);
        }
        table
    }

    /// Writes the matrix as a document, with what it says of every claim and how to read it.
    pub fn to_markdown(&self) -> String {
        let mut text = format!(
            "# Claims where all choices change at once\n\n{}.\n\n{}\n",
            self.multiverse.in_words(),
            self.matrix().to_markdown()
        );
        for claim in &self.claims {
            text.push_str(&format!(
                "- {}: {}.\n",
                claim.claim,
                claim.most_in_words(&self.multiverse.settings)
            ));
        }
        text.push_str(&format!("\n{}.\n", self.multiverse.rules()));
        for (draw, reason) in self.multiverse.refused() {
            text.push_str(&format!("\nRefused {draw}: {reason}.\n"));
        }
        text
    }

    /// Returns the same for programs: a row for every claim and choice.
    pub fn tidy(&self) -> Table {
        let mut table = Table::new(COLUMNS);
        let number = |x: f64| Value::from(rounded(x).as_f64());
        let count = |n: u64| Value::from(i64::try_from(n).ok());
        for claim in &self.claims {
            for (place, setting) in self.multiverse.settings.iter().enumerate() {
                let share = claim.shares[place];
                let mut row: Vec<Value> =
                    vec![claim.claim.as_str().into(), claim.chosen.to_string().into()];
                row.extend(claim.counts.map(count));
                row.extend([
                    claim.support.map(|interval| interval.low).map_or(Value::Missing, number),
                    claim.support.map(|interval| interval.high).map_or(Value::Missing, number),
                    setting.as_str().into(),
                    claim.quantity.name().into(),
                    count(claim.known as u64),
                    share.map_or(Value::Missing, |share| number(share.share)),
                    share.map_or(Value::Missing, |share| number(share.p)),
                ]);
                table.push(row);
            }
        }
        table
    }

    /// Describes a column of [`Explanation::tidy`].
    pub fn tidy_column(name: &str) -> Option<Column> {
        let verdicts = Judgement::ALL.map(|verdict| verdict.to_string());
        let nothing = "there is nothing to explain, or too few draws to explain it by";
        Some(match name {
            "claim" => Column::text(name, "Id of the claim"),
            "as-chosen" => Column::of_values(
                name,
                "",
                "The verdict at the values that the manifest chose",
                &verdicts,
            ),
            "supported" | "contradicted" | "inconclusive" | "cannot-be-tested" => {
                Column::count(name, &format!("Draws in which the claim is {name}"))
            }
            "support-low" | "support-high" => Column::probability(
                name,
                "End of the 95 % interval (Wilson) of the share of draws that support the claim",
            )
            .empty_where("no draw was judged"),
            "setting" => Column::text(name, "Path of the choice in the manifest"),
            "explained" => Column::of_values(
                name,
                "",
                "What of the claim is explained: the size of what it is judged by, or whether it is supported",
                &["estimate".to_owned(), "support".to_owned()],
            ),
            "draws" => Column::count(name, "Draws in which that is known"),
            "variance-share" => Column::probability(
                name,
                "Share of its variance that the choice explains by itself, less what chance would put there",
            )
            .empty_where(nothing),
            "p" => Column::probability(
                name,
                "How often the largest share of all choices is at least this one in random orders of the draws",
            )
            .empty_where(nothing),
            _ => return None,
        })
    }
}

/// The columns of [`Explanation::tidy`].
const COLUMNS: [&str; 13] = [
    "claim",
    "as-chosen",
    "supported",
    "contradicted",
    "inconclusive",
    "cannot-be-tested",
    "support-low",
    "support-high",
    "setting",
    "explained",
    "draws",
    "variance-share",
    "p",
];

#[cfg(test)]
mod tests {
    use super::super::draws::Found;
    use super::super::explained::tests::known;
    use super::*;

    #[test]
    fn a_matrix_has_claims_down_and_choices_across() {
        insta::assert_snapshot!(known(48).explanation().matrix().to_markdown());
    }

    #[test]
    fn every_column_for_programs_is_described() {
        let table = known(48).explanation().tidy();
        assert_eq!(table.rows.len(), 9);
        for column in &table.columns {
            assert!(Explanation::tidy_column(column).is_some(), "{column}");
        }
        let csv = table.to_csv();
        assert!(csv.contains("\nby-mode,supported,24,24,0,0,"), "{csv}");
    }

    #[test]
    fn what_explains_most_is_said_or_why_nothing_does() {
        let mut study = known(48);
        let words = |study: &Multiverse| -> Vec<String> {
            study
                .explanation()
                .claims
                .iter()
                .map(|claim| claim.most_in_words(&study.settings))
                .collect()
        };
        let [speed, mode, always] = &words(&study)[..] else { panic!("three claims") };
        assert!(speed.starts_with("drive.speed-m-s explains 9"), "{speed}");
        assert_eq!(mode, "mode explains 100 % of its support");
        assert_eq!(always, "its estimate is the same in every draw");
        assert_eq!(words(&known(5))[1], "too few draws to explain its support: 8 at least");
        study.draws[3].found = Found::refused("too fast");
        assert_eq!(
            study.in_words(),
            "48 draws of 3 choices, 3 trials per condition, seed 7; 1 draw was refused"
        );
    }
}
