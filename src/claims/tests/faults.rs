//! What is said of claims before anything runs, and the examples, of which nothing is.

use super::*;
use crate::factor::Factor;

/// Factors with their values, metrics, published tables.
pub(super) type Things = (Vec<Factor>, Vec<String>, Vec<String>);

/// Puts a fault on one line: where, numbers of items left out, what, and what may have been meant.
pub(super) fn told(fault: &ClaimFault<'_>) -> String {
    let steps = fault.pointer.split('/').skip(1).filter(|step| step.parse::<usize>().is_err());
    let place = steps.collect::<Vec<_>>().join(".");
    let colon = if place.is_empty() { "" } else { ": " };
    let help = fault.help().map(|help| format!("; {help}")).unwrap_or_default();
    format!("{place}{colon}{}{help}", fault.message)
}

/// Returns the faults of one claim among `things`.
pub(super) fn faults_among(claim: &Claim, (factors, metrics, published): &Things) -> Vec<String> {
    let known = Known { factors, metrics, published };
    claim.check(known).iter().map(told).collect()
}

/// Returns what the examples speak of.
pub(super) fn known() -> Things {
    let owned = |names: &[&str]| names.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
    let factors = vec![
        Factor::new("start", owned(&["A", "B", "C"])),
        Factor::new("strategy", owned(&STRATEGIES)),
        Factor::new("deadline-s", owned(&["68", "272", "477", "680"])),
        Factor::new("prior", owned(&["none", "floor-plan", "footprint"])),
        Factor::new("furnished", owned(&["true", "false"])),
        Factor::new("environment", owned(&["basic", "office", "open"])),
    ];
    let metrics = owned(&[
        "success",
        "outcome:late",
        "time-s",
        "fast-collisions",
        "fast-maneuvers",
        "slow-collisions",
        "slow-maneuvers",
        "time-s-at-70",
        "distance-m-at-70",
        "distance-m-at-80",
        "distance-m-at-90",
        "distance-m-at-95",
        "wall-time-s-per-selection",
    ]);
    (factors, metrics, owned(&["success-percent", "distance-m"]))
}

pub(super) fn faults(expect: &str) -> Vec<String> {
    faults_among(&claim(expect), &known())
}

/// Returns the fenced YAML of a text, each line without `prefix`.
pub(super) fn examples(text: &str, prefix: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut open: Option<String> = None;
    for line in text.lines() {
        let Some(line) = line.strip_prefix(prefix) else { continue };
        match (&mut open, line.trim()) {
            (None, "```yaml") => open = Some(String::new()),
            (Some(example), "```") => {
                found.push(std::mem::take(example));
                open = None;
            }
            (Some(example), _) => example.push_str(&format!(
                "{}\n",
                line.strip_prefix(' ').filter(|_| !prefix.is_empty()).unwrap_or(line)
            )),
            (None, _) => {}
        }
    }
    found
}

#[test]
fn every_form_has_an_example_that_parses_and_checks() {
    let things = known();
    for (form, file) in super::super::forms::FILES {
        let [text] = &examples(file, "//!")[..] else { panic!("{form}: expected one example") };
        let claim: Claim = serde_yaml::from_str(text).unwrap_or_else(|e| panic!("{text}\n{e}"));
        assert_eq!(claim.expect.form(), *form);
        assert_eq!(faults_among(&claim, &things), Vec::<String>::new(), "{text}");
        let back: Claim = serde_json::from_value(serde_json::to_value(&claim).unwrap()).unwrap();
        assert_eq!(back, claim);
    }
}

#[test]
fn the_examples_of_the_page_parse_and_check() {
    let (factors, metrics, published) = known();
    let page = include_str!("../../../docs/claims.md");
    let (_, forms) = page.split_once("\n## Forms\n").unwrap();
    for (form, _) in super::super::forms::FILES {
        assert!(
            forms.contains(&format!("\n`{form}`")) || forms.contains(&format!(", `{form}`: ")),
            "{form}"
        );
    }
    let found = examples(page, "");
    for text in found {
        let claims: Vec<Claim> =
            serde_yaml::from_str(&text).unwrap_or_else(|e| panic!("{text}\n{e}"));
        let known = Known { factors: &factors, metrics: &metrics, published: &published };
        let found: Vec<_> = check_all(&claims, known).collect();
        assert_eq!(found, [], "{text}");
    }
}

#[test]
fn faults_are_named_with_their_place_and_the_nearest_name() {
    assert_eq!(
        faults("{less: {metric: sucess, where: {strat: random}, than: {where: {start: D}}}}"),
        [
            "expect.less.where.strat: unknown factor `strat`; did you mean `start`? (known: start, \
             strategy, deadline-s, prior, furnished, environment)",
            "expect.less.than.where.start: `D` is not a value of the factor `start`; known: A, B, C",
            "expect.less.metric: unknown metric `sucess`; did you mean `success`? (known: success, \
             outcome:late, time-s, fast-collisions, fast-maneuvers, slow-collisions, slow-maneuvers, time-s-at-70, distance-m-at-70, distance-m-at-80, distance-m-at-90, distance-m-at-95, wall-time-s-per-selection)",
        ]
    );
    assert_eq!(
        faults(
            "{less: {metric: success, than: {where: {start: A}}, test: welch, alpha: 0.7, at-least: 0, censored: worst}}"
        ),
        [
            "expect.less.alpha: expected a level between 0 and 0.5, found 0.7",
            "expect.less.at-least: expected at least 1, found 0: every verdict would be supported",
            "expect.less.test: welch is a test of measures",
            "expect.less.censored: `worst` has a rank and no value: it needs mann-whitney, spearman, \
             median, p95 or pairs of trials",
        ]
    );
    assert_eq!(
        faults(
            "{trend: {metric: success, direction: rising, along: [{score: 1, where: {}}, {score: 1, where: {}}]}}"
        ),
        ["expect.trend.along: expected two or more different scores, found [1.0, 1.0]"]
    );
    assert_eq!(
        faults("{less: {metric: time-s, than: {where: {start: A}}, test: anova}}"),
        ["expect.less.sides: anova has two sides; say `sides: two`"]
    );
    assert_eq!(
        faults(
            "{rmse-with-published: {metric: success, published: succes, at-most: 0, baseline: [x]}}"
        ),
        [
            "expect.rmse-with-published.published: unknown published table `succes`; did you mean \
             `success-percent`? (known: success-percent, distance-m)",
            "expect.rmse-with-published.at-most: expected a positive number, found 0",
            "expect.rmse-with-published.baseline: unknown factor `x`; known: start, strategy, \
             deadline-s, prior, furnished, environment",
        ]
    );
    assert_eq!(
        faults("{between: {metric: success, low: 0, high: 0.5}}"),
        [
            "expect.between.low: a share is bounded strictly between 0 and 1, found 0; leave out what \
          always holds"
        ]
    );
    let twice = [
        claim("{between: {metric: success, high: 0.5}}"),
        claim("{between: {metric: success, high: 0.5}}"),
    ];
    let (factors, metrics, published) = known();
    let known = Known { factors: &factors, metrics: &metrics, published: &published };
    let found: Vec<_> = check_all(&twice, known).map(|(i, fault)| (i, told(&fault))).collect();
    assert_eq!(found, [(1, "id: the id `X` is used twice".to_owned())]);
    let unknown = serde_yaml::from_str::<Claim>(
        "id: X\nsays: s\npaper-table: silent\nexpect: {less: {metrik: a}}\n",
    );
    assert!(unknown.unwrap_err().to_string().contains("metrik"));
}

/// Checks that cells are counted, and never made.
#[test]
fn cells_without_number_are_refused_at_once() {
    let values: Vec<String> = (0..1000).map(|i| i.to_string()).collect();
    let across: Vec<String> = (0..8).map(|i| format!("f{i}: [{}]", values.join(", "))).collect();
    let found = faults(&format!(
        "{{homogeneous: {{metric: success, across: {{{}}}, margin: 0}}}}",
        across.join(", ")
    ));
    assert_eq!(found.len(), 9, "{found:?}");
    assert_eq!(found[8], "expect.homogeneous.margin: expected a positive number, found 0");
}

#[test]
fn a_claim_is_in_the_papers_words_or_in_ours() {
    let things = known();
    let said = claim("{between: {metric: success, high: 0.5}}");
    let faults = |claim: &Claim| faults_among(claim, &things);
    assert_eq!(faults(&said), Vec::<String>::new());
    let own = Claim {
        says: None,
        ours: Some("half at most".to_owned()),
        paper_table: None,
        ..said.clone()
    };
    assert_eq!((faults(&own), own.papers_table()), (Vec::new(), PaperTable::Silent));
    let both = Claim { says: said.says.clone(), ..own.clone() };
    assert_eq!(
        faults(&both),
        [
            "expected `says` or `ours`, found both; keep `says` where the words are the paper's, `ours` where they \
             are your own"
        ]
    );
    assert_eq!(
        faults(&Claim { ours: None, ..own.clone() }),
        [
            "expected `says` with the paper's words, or `ours` with a check of your own, found neither"
        ]
    );
    let unsaid = Claim { paper_table: None, ..said };
    assert_eq!((faults(&unsaid), unsaid.papers_table()), (Vec::new(), PaperTable::Silent));
    assert_eq!(
        faults(&Claim { ours: Some(" ".to_owned()), ..own }),
        ["ours: expected words, found none"]
    );
}
