//! The claims where all choices change at once: a matrix of claims and choices.

use super::content::{Matrix, MatrixCell, MatrixColumn, MatrixRow, RefusedDraw};
use crate::claims::Judgement;
use crate::claims::multiverse::{Explained, Multiverse, short};
use crate::manifest::Experiment;

/// From which share on a cell is drawn darker.
const SHADES: [f64; 4] = [0.05, 0.2, 0.4, 0.6];

/// Returns the matrix of `experiment`; `None` where its manifest names no draws.
pub(super) fn matrix(experiment: &Experiment) -> Option<Matrix> {
    experiment.multiverse.as_ref().map(|known| of(&known.table, &known.as_written))
}

fn of(table: &Multiverse, file: &str) -> Matrix {
    let column = |path: &String| MatrixColumn { path: path.clone(), name: short(path).to_owned() };
    let refused = table.refused().map(|(draw, reason)| RefusedDraw {
        draw: draw.number.unwrap_or_default(),
        reason: reason.to_owned(),
    });
    Matrix {
        made: table.in_words(),
        rules: table.rules(),
        file: file.to_owned(),
        columns: table.settings.iter().map(column).collect(),
        rows: table.explanation().claims.iter().map(|claim| row(claim, &table.settings)).collect(),
        refused: refused.collect(),
    }
}

fn row(claim: &Explained, settings: &[String]) -> MatrixRow {
    let count = |judgement: Judgement| (judgement.to_string(), claim.count(judgement));
    MatrixRow {
        claim: claim.claim.clone(),
        chosen: claim.chosen.to_string(),
        counts: Judgement::ALL.map(count).to_vec(),
        support: claim.support_in_words(),
        percent: claim.share().map(|share| 100.0 * share),
        explained: claim.quantity.name().to_owned(),
        most: claim.most_in_words(settings),
        cells: (0..settings.len()).map(|place| cell(claim, place)).collect(),
    }
}

fn cell(claim: &Explained, place: usize) -> MatrixCell {
    let share = claim.shares[place].map(|share| share.share);
    MatrixCell {
        text: claim.cell(place),
        shade: SHADES.iter().filter(|from| share.is_some_and(|share| share >= **from)).count(),
        stands_out: claim.stands_out(place),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Returns the matrix of a study in which the first choice decides the first claim, and draw 3 was refused.
    pub(in crate::report) fn sample() -> Matrix {
        let mut text = "draw,seed,trials,refused,records,parameters.drive.speed-m-s,parameters.exploration.alpha,verdict:P1,\
                        estimate:P1,verdict:P2,estimate:P2\n"
            .to_owned();
        let records = "a".repeat(64);
        text.push_str(&format!("chosen,7,15,,{records},0.5,0.4,supported,1.5,contradicted,\n"));
        for draw in 0_u32..24 {
            if draw == 3 {
                text.push_str("3,7,15,it is too fast,,0.9,0.4,,,,\n");
                continue;
            }
            let speed = f64::from(draw) / 24.0;
            let alpha = f64::from(draw * 7 % 24) / 24.0;
            let verdict = if speed < 0.6 { "supported" } else { "inconclusive" };
            text.push_str(&format!(
                "{draw},7,15,,{records},{speed},{alpha},{verdict},{},contradicted,\n",
                3.0 * speed + 0.2 * alpha
            ));
        }
        of(&Multiverse::from_csv(&text).unwrap(), "study.multiverse.csv")
    }

    #[test]
    fn a_matrix_is_as_dark_as_what_a_choice_explains() {
        let matrix = sample();
        let names: Vec<&str> = matrix.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["drive.speed-m-s", "exploration.alpha"]);
        let [first, second] = &matrix.rows[..] else { panic!("two claims") };
        assert_eq!((first.cells[0].shade, first.cells[0].stands_out), (4, true));
        assert!(first.cells[0].text.ends_with(" %*"), "{first:?}");
        assert!(!first.cells[1].stands_out && first.cells[1].shade < 2, "{first:?}");
        assert_eq!(first.support, "14 of 23 (41 to 78 %)");
        assert_eq!(first.counts[2], ("inconclusive".to_owned(), 9));
        assert_eq!(second.percent, Some(0.0));
        assert!(second.cells.iter().all(|cell| cell.text.is_empty() && cell.shade == 0));
        assert_eq!(second.most, "its support is the same in every draw");
        assert_eq!(
            (matrix.refused[0].draw, matrix.refused[0].reason.as_str()),
            (3, "it is too fast")
        );
    }
}
