//! Verdicts as tables for whoever works with columns: `results/claims.csv`, one row a claim, and `results/comparisons.csv`, one
//! row for each comparison that it rests on. Both say what `claims.json` says, numbers rounded alike.

use super::verdict::{ClaimVerdict, Judgement, rounded};
use crate::table::{Column, Table, Value};

const CLAIMS: [&str; 14] = [
    "claim",
    "whose",
    "text",
    "cite",
    "verdict",
    "paper-table",
    "reason",
    "form",
    "alpha",
    "comparisons",
    "required",
    "hold",
    "hold-reversed",
    "untested",
];

const COMPARISONS: [&str; 15] = [
    "claim",
    "comparison",
    "about",
    "verdict",
    "reason",
    "test",
    "effect",
    "effect-value",
    "effect-low",
    "effect-high",
    "confidence",
    "p-for",
    "p-for-corrected",
    "p-against-corrected",
    "trials-to-decide",
];

fn number(x: f64) -> Value {
    rounded(x).as_f64().into()
}

fn count(n: u64) -> Value {
    i64::try_from(n).ok().into()
}

/// Returns one row a claim, in the manifest's order.
pub fn claims(verdicts: &[ClaimVerdict]) -> Table {
    let mut table = Table::new(CLAIMS);
    for claim in verdicts {
        let (whose, text) = match (&claim.says, &claim.ours) {
            (Some(says), _) => ("paper", says.as_str()),
            (None, ours) => ("ours", ours.as_deref().unwrap_or_default()),
        };
        let judged = |judgement: Judgement| {
            let alike = claim.comparisons.iter().filter(|one| one.judgement == judgement);
            count(alike.count() as u64)
        };
        table.push(vec![
            claim.id.as_str().into(),
            whose.into(),
            text.into(),
            claim.cite.clone().into(),
            claim.judgement.to_string().into(),
            claim.paper_table.to_string().into(),
            claim.reason.as_str().into(),
            claim.form.as_ref().into(),
            number(claim.alpha),
            count(claim.comparisons.len() as u64),
            count(claim.required as u64),
            judged(Judgement::Supported),
            judged(Judgement::Contradicted),
            judged(Judgement::CannotBeTested),
        ]);
    }
    table
}

/// Returns one row a comparison, in the order of the claims.
pub fn comparisons(verdicts: &[ClaimVerdict]) -> Table {
    let mut table = Table::new(COMPARISONS);
    for claim in verdicts {
        for (place, one) in (1..).zip(&claim.comparisons) {
            let effect = one.effect.as_ref();
            let of = |what: fn(&super::verdict::EffectSize) -> f64| effect.map(|e| number(what(e)));
            let p = |p: Option<f64>| Value::from(p.map(number));
            table.push(vec![
                claim.id.as_str().into(),
                Value::Integer(place),
                one.about.as_str().into(),
                one.judgement.to_string().into(),
                one.reason.clone().into(),
                one.test.as_ref().into(),
                effect.map(|effect| effect.name.as_ref()).into(),
                of(|effect| effect.value).into(),
                of(|effect| effect.low).into(),
                of(|effect| effect.high).into(),
                of(|effect| effect.confidence).into(),
                p(one.p_for),
                p(one.p_for_corrected),
                p(one.p_against_corrected),
                one.trials_to_decide.map(count).into(),
            ]);
        }
    }
    table
}

/// Describes a column of [`claims`].
pub fn claims_column(name: &str) -> Option<Column> {
    let of = |meaning: &str, values: &[&str]| {
        let values: Vec<String> = values.iter().map(|&value| value.to_owned()).collect();
        Column::of_values(name, "", meaning, &values)
    };
    Some(match name {
        "claim" => Column::text(name, "Id of the claim"),
        "whose" => of("Whose claim it is", &["paper", "ours"]),
        "text" => Column::text(name, "What is claimed, in the words of whose it is"),
        "cite" => Column::text(name, "Where the paper says so").empty_where("nothing is cited"),
        "verdict" => verdict(name, "What the trials say of it"),
        "paper-table" => of(
            "What the paper's own printed numbers say of it, as the manifest states",
            &["supports", "contradicts", "silent"],
        ),
        "reason" => Column::text(name, "The verdict in a sentence"),
        "form" => Column::text(name, "Form of the expectation"),
        "alpha" => {
            Column::probability(name, "Level of significance").empty_where("the form has none")
        }
        "comparisons" => {
            Column::count(name, "Comparisons that it rests on: rows of comparisons.csv")
        }
        "required" => Column::count(name, "How many of these must hold"),
        "hold" => Column::count(name, "How many hold"),
        "hold-reversed" => Column::count(name, "How many hold the other way round"),
        "untested" => Column::count(name, "How many cannot be tested"),
        _ => return None,
    })
}

/// Describes a column of [`comparisons`].
pub fn comparisons_column(name: &str) -> Option<Column> {
    let nothing = "it could not be tested, or the form has none";
    let p = |meaning: &str| Column::probability(name, meaning).empty_where(nothing);
    Some(match name {
        "claim" => Column::text(name, "Id of the claim: a row of claims.csv"),
        "comparison" => Column::count(name, "Number of the comparison in its claim, from 1"),
        "about" => Column::text(name, "Metric and cells that are compared"),
        "verdict" => verdict(name, "What the trials say of it"),
        "reason" => Column::text(name, "Why it cannot be tested").empty_where("it can"),
        "test" => Column::text(name, "Name of the test").empty_where(nothing),
        "effect" => Column::text(name, "Measure of the effect, first cell less second")
            .empty_where(nothing),
        "effect-value" => Column::number(name, "", "The effect, in that measure's unit")
            .empty_where(nothing),
        "effect-low" | "effect-high" => {
            Column::number(name, "", "End of the effect's interval").empty_where(nothing)
        }
        "confidence" => p("Confidence of that interval"),
        "p-for" => p("p-value of what is claimed, as tested"),
        "p-for-corrected" => p("The same, corrected for the claim's number of comparisons"),
        "p-against-corrected" => p("p-value of the opposite, corrected alike"),
        "trials-to-decide" => Column::count(
            name,
            "Trials per condition that would have decided it with 80 % power, if what was seen is the truth",
        )
        .empty_where("it is decided, or none would"),
        _ => return None,
    })
}

fn verdict(name: &str, meaning: &str) -> Column {
    Column::of_values(name, "", meaning, &Judgement::ALL.map(|verdict| verdict.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn verdicts() -> Vec<ClaimVerdict> {
        serde_json::from_value(json!([
            {"id": "P1", "says": "plans help, \"much\"", "cite": "section 4", "verdict": "inconclusive", "paper-table": "supports",
             "reason": "1 of 3 hold", "form": "less", "alpha": 0.05, "required": 3, "comparisons": [
                {"about": "a < b", "verdict": "supported", "test": "welch", "p-for": 0.001, "p-for-corrected": 0.003,
                 "p-against-corrected": 1.0,
                 "effect": {"name": "mean-difference", "value": -1.5, "low": null, "high": -0.25, "confidence": 0.9}},
                {"about": "a < c", "verdict": "contradicted", "test": "welch", "trials-to-decide": 40},
                {"about": "a < d", "verdict": "cannot-be-tested", "reason": "nobody got there"}]},
            {"id": "O1", "ours": "distances are sane", "verdict": "supported"},
        ]))
        .unwrap()
    }

    #[test]
    fn a_claim_is_a_row_and_so_is_each_of_its_comparisons() {
        assert_eq!(
            claims(&verdicts()).to_csv(),
            "claim,whose,text,cite,verdict,paper-table,reason,form,alpha,comparisons,required,hold,hold-reversed,untested\n\
             P1,paper,\"plans help, \"\"much\"\"\",section 4,inconclusive,supports,1 of 3 hold,less,0.05,3,3,1,1,1\n\
             O1,ours,distances are sane,,supported,silent,,,,0,0,0,0,0\n"
        );
        assert_eq!(
            comparisons(&verdicts()).to_csv(),
            "claim,comparison,about,verdict,reason,test,effect,effect-value,effect-low,effect-high,confidence,p-for,\
             p-for-corrected,p-against-corrected,trials-to-decide\n\
             P1,1,a < b,supported,,welch,mean-difference,-1.5,,-0.25,0.9,0.001,0.003,1,\n\
             P1,2,a < c,contradicted,,welch,,,,,,,,,40\n\
             P1,3,a < d,cannot-be-tested,nobody got there,,,,,,,,,,\n"
        );
    }

    #[test]
    fn every_column_is_described() {
        for name in CLAIMS {
            assert!(claims_column(name).is_some_and(|column| !column.meaning.is_empty()), "{name}");
        }
        for name in COMPARISONS {
            let column = comparisons_column(name);
            assert!(column.is_some_and(|column| !column.meaning.is_empty()), "{name}");
        }
    }
}
