//! Entries and sums that the model refuses.

use super::*;

#[test]
fn entries_are_refused_one_by_one_with_what_was_expected() {
    let mut builder = CmdpBuilder::new(2, 1);
    let text = |result: Result<(), EntryError>| result.unwrap_err().to_string();
    assert_eq!(text(builder.absorb(2)), "state 2 does not exist; expected an index below 2");
    assert_eq!(
        text(builder.transition(0, 1, 1, 1.0)),
        "action 1 does not exist; expected an index below 1"
    );
    assert_eq!(
        text(builder.transition(0, 0, 1, -0.1)),
        "probability -0.1 is negative; expected a number in [0, 1]"
    );
    assert_eq!(
        text(builder.initial(0, 1.5)),
        "probability 1.5 is above 1; expected a number in [0, 1]"
    );
    assert_eq!(
        text(builder.initial(0, f64::NAN)),
        "probability NaN is not finite; expected a number in [0, 1]"
    );
    builder.transition(0, 0, 1, 1.0).unwrap();
    assert_eq!(
        text(builder.primary(0, 0, -3.0)),
        "cost -3 is negative; expected a finite number >= 0"
    );
    assert_eq!(
        text(builder.primary(1, 0, 1.0)),
        "state 1 has no transition by action 0; list it in `transitions` or drop the cost"
    );
    assert_eq!(
        builder.secondary("time", f64::INFINITY).unwrap_err().to_string(),
        "bound inf is not finite; expected a finite number >= 0"
    );
}

#[test]
fn repeated_entries_add_up_and_sums_are_checked() {
    let mut builder = CmdpBuilder::new(2, 1);
    builder.absorb(1).unwrap();
    builder.initial(0, 0.5).unwrap();
    assert_eq!(
        builder.clone().build().unwrap_err().to_string(),
        "the initial probabilities sum to 0.5; expected 1"
    );
    builder.initial(0, 0.5).unwrap();
    builder.transition(0, 0, 0, 0.0).unwrap();
    builder.transition(0, 0, 1, 0.75).unwrap();
    assert_eq!(
        builder.clone().build().unwrap_err(),
        ModelError::PairSum { entry: 0, state: 0, action: 0, sum: 0.75 }
    );
    builder.transition(0, 0, 1, 0.25).unwrap();
    builder.primary(0, 0, 1.0).unwrap();
    builder.primary(0, 0, 2.0).unwrap();
    let cmdp = builder.build().unwrap();
    assert_eq!(cmdp.initial(), &[(0, 1.0)]);
    assert_eq!(cmdp.pairs_of(0), 0..1);
    assert_eq!(cmdp.pairs_of(1), 1..1);
    assert_eq!(
        cmdp.pairs()[0],
        Pair { state: 0, action: 0, successors: vec![(1, 1.0)], costs: vec![3.0] }
    );
}
