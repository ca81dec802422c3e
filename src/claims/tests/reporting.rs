//! What a verdict says and does not depend on, its one text, and the power said beforehand.

use super::*;
use crate::condition::Condition;
use crate::json::canonical;

#[test]
fn what_the_paper_says_shows_and_we_find_are_three_facts() {
    let published = published();
    let trials = as_printed();
    let context = Context::new(&published, &[], 2019);
    let mut stated = claim(
        "{less: {metric: success, where: {start: C, strategy: random}, than: {where: {start: C, strategy: frontier}}}}",
    );
    let first = judge(&stated, &trials, &context).unwrap();
    stated.paper_table = Some(PaperTable::Contradicts);
    stated.says = Some("the opposite".to_owned());
    let second = judge(&stated, &trials, &context).unwrap();
    assert_eq!(first.judgement, second.judgement);
    assert_eq!(first.comparisons, second.comparisons);
    assert_eq!(Score::of(&[first]), Score::of(&[second]));
    assert_eq!(
        Score { supported: 1, contradicted: 2, inconclusive: 3, cannot_be_tested: 4 }
            .in_words("claims of the paper"),
        "1 of 10 claims of the paper supported, 2 contradicted, 3 inconclusive, 4 cannot be tested"
    );
}

/// Checks that a check of our own needs no word on the paper's table, stands under its own key and counts apart.
#[test]
fn our_own_checks_are_told_and_counted_apart_from_the_papers_claims() {
    let published = published();
    let trials = as_printed();
    let context = Context::new(&published, &[], 2019);
    let said = claim(
        "{less: {metric: success, where: {start: C, strategy: random}, than: {where: {start: C, strategy: frontier}}}}",
    );
    let own = Claim {
        id: "own".to_owned(),
        says: None,
        ours: Some("ours alone".to_owned()),
        paper_table: None,
        ..said.clone()
    };
    let verdicts = [said, own].map(|claim| judge(&claim, &trials, &context).unwrap());
    let json = verdicts.clone().map(|verdict| serde_json::json!(verdict));
    assert_eq!((json[0]["says"].as_str(), json[0].get("ours")), (Some("something"), None));
    assert_eq!((json[1]["ours"].as_str(), json[1].get("says")), (Some("ours alone"), None));
    assert_eq!(json[1]["paper-table"], "silent");
    assert_eq!(
        Score::lines(&verdicts),
        [
            "1 of 1 claims of the paper supported, 0 contradicted, 0 inconclusive, 0 cannot be tested",
            "1 of 1 checks of our own supported, 0 contradicted, 0 inconclusive, 0 cannot be tested",
        ]
    );
    assert_eq!(Score::lines(&[]), Vec::<String>::new());
}

#[test]
fn verdicts_have_one_text() {
    // p by scipy.stats.fisher_exact, limits by statsmodels' Newcombe interval at 90 %.
    let expect = "{less: {metric: success, where: {start: C, deadline-s: 5628, strategy: random}, than: {where: {start: C, \
                  deadline-s: 5628, strategy: frontier}}}}";
    let text = canonical(&serde_json::json!(verdict(expect)));
    assert_eq!(
        text,
        "{\"alpha\":0.05,\"cite\":null,\"comparisons\":[{\"about\":\"success: (deadline-s=5628, start=C, \
         strategy=random) < (deadline-s=5628, start=C, strategy=frontier)\",\"cells\":[{\"cell\":\"deadline-s=5628, \
         start=C, strategy=random\",\"mean\":0.08,\"reached\":50,\"successes\":4,\"trials\":50},{\"cell\":\
         \"deadline-s=5628, start=C, strategy=frontier\",\"mean\":0.54,\"reached\":50,\"successes\":27,\"trials\":50}],\
         \"effect\":{\"confidence\":0.9,\"high\":-0.315986372,\"low\":-0.579142079,\"name\":\"risk-difference\",\
         \"value\":-0.46},\"p-against\":0.999999972,\"p-against-corrected\":0.999999972,\"p-for\":4.02666661e-7,\
         \"p-for-corrected\":4.02666661e-7,\"test\":\"fisher-exact\",\"verdict\":\"supported\"}],\"correction\":\
         \"holm\",\"form\":\"less\",\"id\":\"X\",\"minimum-n\":10,\"notes\":[],\"paper-table\":\"silent\",\"reason\":\
         \"p 4.03e-7 at alpha 0.05 by fisher-exact\",\"required\":1,\"says\":\"something\",\"trials-to-decide\":null,\
         \"verdict\":\"supported\"}"
    );
    assert_eq!(verdict(expect), verdict(expect));
    assert_eq!(verdict::rounded(1.0 / 3.0).to_string(), "0.333333333");
    assert_eq!(verdict::rounded(f64::INFINITY), serde_json::Value::Null);
}

#[test]
fn power_is_that_of_the_very_test() {
    let mut stated = claim(
        "{less: {metric: success, where: {strategy: random}, than: {where: {strategy: frontier}}, test: fisher-exact}}",
    );
    stated.power =
        serde_yaml::from_str("{cells: [{where: {strategy: random}, value: 0.3}, {value: 0.6}]}")
            .unwrap();
    let conditions = ["random", "frontier"].map(|s| Condition::from([("strategy", s)]));
    let none = BTreeMap::new();
    let context = Context::new(&none, &[], 2019);
    let found = power::power(&stated, &conditions, 30, &context, 1000).unwrap();
    // scipy: sum over k1, k2 of binom.pmf(k1, 30, .3) binom.pmf(k2, 30, .6) [fisher_exact 'less' <= .05];
    // three standard errors of a share over 1000 studies are 0.044
    assert!(
        (found.planned.supported - 0.665_356_518_542_805_8).abs() < 0.044,
        "{}",
        found.planned.supported
    );
    // The same sum for 'greater' is 6.9e-6: rare, not impossible. Two in a thousand would have probability 2e-5.
    assert!(found.planned.contradicted < 0.002, "{}", found.planned.contradicted);
    assert_eq!(found.enough, Some(50));
    assert_eq!(found, power::power(&stated, &conditions, 30, &context, 1000).unwrap());
    // From the published cells.
    stated.power =
        serde_yaml::from_str("{published: {table: success-percent, scale: 0.01}}").unwrap();
    let tables = published();
    let context = Context::new(&tables, &[], 2019);
    let conditions = ["random", "frontier"]
        .map(|s| Condition::from([("start", "C"), ("deadline-s", "5628"), ("strategy", s)]));
    let found = power::power(&stated, &conditions, 50, &context, 100).unwrap();
    assert!(found.planned.supported > 0.97);
    assert_eq!(found.enough, Some(20));
    let refused =
        |claim: &Claim| power::power(claim, &conditions, 50, &context, 10).unwrap_err().to_string();
    // Percent without its scale is no share.
    stated.power = serde_yaml::from_str("{published: {table: success-percent}}").unwrap();
    assert_eq!(
        refused(&stated),
        "success in (start=C, deadline-s=5628, strategy=random) is a share and cannot be 8; is a scale missing?"
    );
    stated.power = None;
    assert_eq!(
        refused(&stated),
        "the claim assumes no truth; add `power:` with `published` or `cells`"
    );
}
