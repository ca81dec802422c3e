//! Which verdict hangs on which choice: the settings that were tried at other values, against the claims that change with one.

use super::ReportContent;
use serde::Serialize;

/// A matrix of settings and claims.
#[derive(Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) struct Hinges {
    /// The claims of which some verdict changes.
    claims: Vec<String>,
    /// The settings that change one, those that change most first, then the others that were tried.
    rows: Vec<Row>,
    /// Names of the settings that were tried and change nothing.
    idle: Vec<String>,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
struct Row {
    path: String,
    value: String,
    /// For each claim what it becomes: `at 0.3: supported → inconclusive`; empty where it stays.
    cells: Vec<Vec<String>>,
}

impl Hinges {
    /// Gathers the flips of `content`.
    pub(super) fn of(content: &ReportContent) -> Self {
        let flips = || {
            let tried = content.assumptions.iter().flat_map(|row| row.tried.iter().flatten());
            tried.flat_map(|tried| &tried.flips)
        };
        let mut claims: Vec<String> = Vec::new();
        // In the order in which the page has them.
        let known = content.claims.iter().map(|claim| &claim.id);
        for id in known.chain(flips().map(|flip| &flip.claim)) {
            if !claims.contains(id) && flips().any(|flip| flip.claim == *id) {
                claims.push(id.clone());
            }
        }
        let (mut rows, mut idle) = (Vec::new(), Vec::new());
        for row in &content.assumptions {
            let Some(tried) = &row.tried else { continue };
            let cell = |claim: &String| -> Vec<String> {
                let of_it = tried.iter().flat_map(|tried| {
                    let flips = tried.flips.iter().filter(move |flip| flip.claim == *claim);
                    flips.map(move |flip| format!("at {}: {} → {}", tried.at, flip.from, flip.to))
                });
                of_it.collect()
            };
            let cells: Vec<Vec<String>> = claims.iter().map(cell).collect();
            if cells.iter().all(Vec::is_empty) {
                idle.push(row.path.clone());
            } else {
                rows.push(Row { path: row.path.clone(), value: row.value.clone(), cells });
            }
        }
        let changed = |row: &Row| row.cells.iter().filter(|cell| !cell.is_empty()).count();
        rows.sort_by_key(|row| std::cmp::Reverse(changed(row)));
        Self { claims, rows, idle }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::content;
    use super::*;

    #[test]
    fn only_what_changes_has_a_row_and_a_column() {
        let hinges = Hinges::of(&content());
        assert_eq!(hinges.claims, ["P1"]);
        let row = &hinges.rows[0];
        assert_eq!((hinges.rows.len(), row.path.as_str()), (1, "parameters.drive.speed-m-s"));
        assert_eq!(row.cells, [["at 0.3: supported → inconclusive"]]);
        assert_eq!(hinges.idle, ["parameters.exploration.alpha"]);
        let none = Hinges::of(&ReportContent::default());
        assert!(none.claims.is_empty() && none.rows.is_empty() && none.idle.is_empty());
    }
}
