//! The JSON form: the example of the documentation, and each possible fault.

use super::*;
use crate::cmdp::tests::{Family, Instance, relative};
use proptest::prelude::*;
use serde_json::json;

fn example() -> Value {
    json!({
        "states": ["room", "door", "goal"], "actions": ["slow", "fast"],
        "absorbing": [2],
        "initial": [[0, 1.0]],
        "transitions": [[0, 0, 1, 1.0], [1, 0, 2, 1.0], [1, 1, 2, 0.9], [1, 1, 1, 0.1]],
        "primary": [[0, 0, 1.0], [1, 0, 1.0], [1, 1, 1.0]],
        "secondary": [{"name": "time-s", "bound": 13.0, "costs": [[0, 0, 5.0], [1, 0, 12.0], [1, 1, 4.0]]}],
        "comment": "ignored"
    })
}

fn error(document: &Value) -> String {
    solve_document(&document.to_string()).unwrap_err().to_string()
}

fn with(path: &str, value: Value) -> Value {
    let mut document = example();
    *document.pointer_mut(path).unwrap() = value;
    document
}

#[test]
fn the_example_is_solved() {
    let answer: Value =
        serde_json::from_str(&solve_document(&example().to_string()).unwrap()).unwrap();
    assert_eq!(answer["status"], "optimal");
    // Slow takes 12, fast 4 / 0.9 in 1 / 0.9 steps; 8 s are allowed at the door: with share s of departures
    // slow, 12 s + 40/9 (1 - s) = 8.
    let slow = (8.0 - 40.0 / 9.0) / (12.0 - 40.0 / 9.0);
    let expected = 1.0 + slow + (1.0 - slow) / 0.9;
    assert!(relative(answer["primary"].as_f64().unwrap(), expected) < 1e-12);
    assert!(relative(answer["secondary"][0].as_f64().unwrap(), 13.0) < 1e-12);
    let policy = answer["policy"].as_array().unwrap();
    assert_eq!(policy.len(), 3);
    assert_eq!(policy[0], json!([0, 0, 1]));
    let share = slow / (slow + (1.0 - slow) / 0.9);
    assert!(relative(policy[1][2].as_f64().unwrap(), share) < 1e-12);
}

#[test]
fn infeasible_is_an_answer() {
    let text = r#"{"status":"infeasible","primary":null,"secondary":[],"policy":[]}"#;
    assert_eq!(solve_document(&with("/secondary/0/bound", json!(5.0)).to_string()).unwrap(), text);
    assert_eq!(solve_document(&with("/absorbing", json!([])).to_string()).unwrap(), text);
}

#[test]
fn each_malformed_entry_is_named() {
    let cases = [
        (
            "/transitions/3",
            json!([1, 1, 1, -0.1]),
            "transitions[3]: probability -0.1 is negative; expected a number in [0, 1]",
        ),
        (
            "/transitions/3",
            json!([1, 1, 1]),
            "transitions[3]: expected [state, action, successor, probability], found a list of 3",
        ),
        (
            "/transitions/0",
            json!([0, 0, 3, 1.0]),
            "transitions[0]: state 3 does not exist; expected an index below 3",
        ),
        (
            "/transitions/0",
            json!([0, -1, 1, 1.0]),
            "transitions[0]: expected an index as action, found -1",
        ),
        (
            "/transitions/0",
            json!([0.5, 0, 1, 1.0]),
            "transitions[0]: expected an index as state, found 0.5",
        ),
        (
            "/transitions/0",
            json!([0, 0, "door", 1.0]),
            "transitions[0]: expected an index as successor, found a string",
        ),
        (
            "/transitions/0",
            json!("x"),
            "transitions[0]: expected [state, action, successor, probability], found a string",
        ),
        (
            "/transitions/2/3",
            json!(0.8),
            "transitions[2]: the probabilities of state 1, action 1 sum to 0.9; expected 1",
        ),
        ("/transitions/2/3", json!(null), "transitions[2]: expected a number, found null"),
        (
            "/initial/0",
            json!([0, 0.5]),
            "initial: the initial probabilities sum to 0.5; expected 1",
        ),
        ("/initial/0", json!([0]), "initial[0]: expected [state, probability], found a list of 1"),
        ("/initial/0/0", json!(9), "initial[0]: state 9 does not exist; expected an index below 3"),
        (
            "/absorbing/0",
            json!(7),
            "absorbing[0]: state 7 does not exist; expected an index below 3",
        ),
        ("/absorbing/0", json!(1.5), "absorbing[0]: expected a state index, found 1.5"),
        (
            "/primary/2",
            json!([1, 1, -2]),
            "primary[2]: cost -2 is negative; expected a finite number >= 0",
        ),
        (
            "/primary/2",
            json!([0, 1, 2]),
            "primary[2]: state 0 has no transition by action 1; list it in `transitions` or drop the cost",
        ),
        (
            "/secondary/0/costs/1",
            json!([1, 5, 2]),
            "secondary[0].costs[1]: action 5 does not exist; expected an index below 2",
        ),
        (
            "/secondary/0/bound",
            json!(-1),
            "secondary[0].bound: bound -1 is negative; expected a finite number >= 0",
        ),
        ("/secondary/0/bound", json!("9"), "secondary[0].bound: expected a number, found a string"),
        ("/secondary/0/name", json!(3), "secondary[0].name: expected a string, found 3"),
        (
            "/secondary/0",
            json!({"name": "x", "bound": 1}),
            "secondary[0]: key `costs` is missing; expected a list",
        ),
        (
            "/secondary/0",
            json!([1]),
            "secondary[0]: expected an object with name, bound and costs, found a list of 1",
        ),
        ("/states", json!({}), "states: expected a list, found an object"),
        ("/states/1", json!(1), "states[1]: expected a name, found 1"),
        ("/states", json!(vec!["x"; 2001]), "states: 2001 states; expected at most 2000"),
    ];
    for (path, value, expected) in cases {
        assert_eq!(error(&with(path, value)), expected, "{path}");
    }
    let mut document = example();
    document.as_object_mut().unwrap().remove("primary");
    assert_eq!(error(&document), "document: key `primary` is missing; expected a list");
    assert_eq!(error(&json!([])), "document: expected an object, found a list of 0");
    assert_eq!(
        solve_document("{").unwrap_err().to_string(),
        "document: not JSON: EOF while parsing an object at line 1 column 1"
    );
    assert!(matches!(solve_document(&"[".repeat(100_000)), Err(DocumentError::Malformed { .. })));
}

#[test]
fn costs_of_absorbing_states_and_impossible_outcomes_are_harmless() {
    let mut document = with("/primary/0", json!([2, 1, 9.0]));
    document["transitions"].as_array_mut().unwrap().push(json!([0, 0, 2, 0.0]));
    document["primary"].as_array_mut().unwrap().push(json!([0, 0, 1.0]));
    assert_eq!(solve_document(&document.to_string()), solve_document(&example().to_string()),);
}

fn anything() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        (-3_i64..5).prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        Just(json!(1e-320)),
        Just(json!(1e308)),
        Just(json!("x")),
    ];
    leaf.prop_recursive(2, 8, 4, |inner| prop::collection::vec(inner, 0..5).prop_map(Value::from))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Checks that whatever value takes one place of a document, there is an answer or an error, never a panic.
    #[test]
    fn no_document_panics(place in 0_usize..14, value in anything()) {
        let places = [
            "/states", "/actions", "/absorbing", "/absorbing/0", "/initial", "/initial/0/1",
            "/transitions", "/transitions/2", "/transitions/2/3", "/primary/1/2", "/secondary",
            "/secondary/0/bound", "/secondary/0/costs/1", "/secondary/0/costs/1/2",
        ];
        let _ = solve_document(&with(places[place], value).to_string());
    }

    #[test]
    fn no_text_panics(text in "[\\[\\]{}\",:0-9a-z.e-]{0,60}") {
        prop_assert!(solve_document(&text).is_err());
    }

    /// Checks that extreme but legal numbers give an answer within its bound, or a typed error.
    #[test]
    fn extreme_numbers_are_answered_or_refused(
        exponents in prop::collection::vec(-320_i32..308, 4), slip in 1_i32..300,
    ) {
        let power = |e: i32| format!("1e{e}").parse::<f64>().unwrap();
        let slip = 1.0 - power(-slip);
        let instance = Instance {
            states: 3, actions: 2, absorbing: vec![2], initial: vec![(0, 1.0)],
            transitions: vec![(0, 0, 1, 1.0), (1, 0, 2, 1.0 - slip), (1, 0, 1, slip), (1, 1, 2, 1.0)],
            primary: vec![(0, 0, power(exponents[0])), (1, 1, power(exponents[1]))],
            secondary: vec![(power(exponents[2]), vec![(1, 0, power(exponents[3]))])],
        };
        match solve_document(&instance.document().to_string()) {
            Ok(answer) => {
                let answer: Value = serde_json::from_str(&answer).unwrap();
                if answer["status"] == "optimal" {
                    let total = answer["secondary"][0].as_f64().unwrap();
                    prop_assert!(total <= power(exponents[2]) * (1.0 + 1e-9));
                }
            }
            Err(error) => prop_assert!(matches!(error, DocumentError::Unsolved(_)), "{error}"),
        }
    }
}

/// Checks that a written model is read as the same, numbers to the bit.
#[test]
fn a_written_model_is_read_as_the_same() {
    for family in Family::ALL {
        for index in 0..6 {
            let cmdp = family.instance(index, 9).cmdp();
            let names = |n: usize| (0..n).map(|i| format!("n{i}")).collect::<Vec<_>>();
            let text = write_model(&cmdp, &names(cmdp.states()), &names(cmdp.actions()));
            assert_eq!(read(&text).unwrap(), cmdp, "{family:?} {index}");
        }
    }
}
