//! Constrained MDPs as JSON: what `reenact solve-cmdp FILE.json` reads and prints.
//!
//! ```json
//! {"states": ["room", "door", "goal"], "actions": ["slow", "fast"],
//!  "absorbing": [2],
//!  "initial": [[0, 1.0]],
//!  "transitions": [[0, 0, 1, 1.0], [1, 0, 2, 1.0], [1, 1, 2, 0.9], [1, 1, 1, 0.1]],
//!  "primary": [[0, 0, 1.0], [1, 0, 1.0], [1, 1, 1.0]],
//!  "secondary": [{"name": "time-s", "bound": 20.0, "costs": [[0, 0, 5.0], [1, 0, 12.0], [1, 1, 4.0]]}]}
//! ```
//!
//! Every reference is an index into `states` or `actions`, which are names. `transitions` are
//! `[state, action, successor, probability]`: a pair exists if and only if it is listed, repeated entries add
//! up, and a pair's probabilities sum to 1. Costs are `[state, action, cost]`; a missing cost is 0. All seven
//! keys are needed; other keys are ignored.
//!
//! The answer is one line, `{"status": "optimal", "primary": v, "secondary": [v], "policy": [[s, a, prob]]}`,
//! or with status `infeasible`, `null` and empty lists. No bound is relaxed. The policy covers every state
//! from which it can surely arrive, visited or not.

use super::lexicographic::{MAX_STATES, Outcome, SolveError, solve};
use super::model::{Cmdp, CmdpBuilder, EntryError, ModelError};
use crate::json::canonical;
use serde_json::{Map, Value, json};
use thiserror::Error;

/// Why a document has no answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DocumentError {
    /// The text is not a constrained MDP: exit code 2.
    #[error("{place}: {fault}")]
    Malformed {
        /// The entry, such as `transitions[3]`.
        place: String,
        /// What was found and what was expected.
        fault: String,
    },
    /// The model is well-formed and its answer could not be computed: exit code 3.
    #[error("the model could not be solved: {0}")]
    Unsolved(#[from] SolveError),
}

/// Reads the model in `text`, solves it and writes the answer: one line of JSON, without a line end.
///
/// ```
/// let model = r#"{"states": ["here", "goal"], "actions": ["walk", "run"], "absorbing": [1],
///     "initial": [[0, 1.0]], "transitions": [[0, 0, 1, 1.0], [0, 1, 1, 1.0]],
///     "primary": [[0, 0, 4.0], [0, 1, 1.0]],
///     "secondary": [{"name": "risk", "bound": 0.5, "costs": [[0, 1, 1.0]]}]}"#;
/// let answer = reenact::cmdp::solve_document(model).unwrap();
/// let policy = r#""policy":[[0,0,0.5],[0,1,0.5]]}"#;
/// assert!(answer.ends_with(policy), "{answer}");
/// ```
///
/// # Errors
/// The first malformed entry, or a model too badly scaled to solve.
pub fn solve_document(text: &str) -> Result<String, DocumentError> {
    let cmdp = read(text)?;
    Ok(write(&cmdp, &solve(&cmdp)?))
}

/// Reads the model in `text`.
///
/// # Errors
/// The first malformed entry.
pub fn read(text: &str) -> Result<Cmdp, DocumentError> {
    let root: Value = serde_json::from_str(text)
        .map_err(|error| malformed("document", format!("not JSON: {error}")))?;
    let Value::Object(root) = root else {
        return Err(malformed("document", format!("expected an object, found {}", kind(&root))));
    };
    let states = names(&root, "states")?;
    if states > MAX_STATES {
        return Err(malformed("states", format!("{states} states; expected at most {MAX_STATES}")));
    }
    let actions = names(&root, "actions")?;
    let mut builder = CmdpBuilder::new(states, actions);

    for (i, value) in list(&root, "", "absorbing")?.iter().enumerate() {
        let place = || format!("absorbing[{i}]");
        let state = index(value, "a state index").map_err(|fault| unfit(place(), &fault))?;
        builder.absorb(state).map_err(|error| entry(place(), &error))?;
    }
    for (i, value) in list(&root, "", "initial")?.iter().enumerate() {
        let place = || format!("initial[{i}]");
        let ([state], probability) =
            row(value, "[state, probability]").map_err(|fault| unfit(place(), &fault))?;
        builder.initial(state, probability).map_err(|error| entry(place(), &error))?;
    }
    for (i, value) in list(&root, "", "transitions")?.iter().enumerate() {
        let place = || format!("transitions[{i}]");
        let ([state, action, successor], probability) =
            row(value, "[state, action, successor, probability]")
                .map_err(|fault| unfit(place(), &fault))?;
        builder
            .transition(state, action, successor, probability)
            .map_err(|error| entry(place(), &error))?;
    }
    for (i, value) in list(&root, "", "primary")?.iter().enumerate() {
        let place = || format!("primary[{i}]");
        let ([state, action], cost) =
            row(value, "[state, action, cost]").map_err(|fault| unfit(place(), &fault))?;
        builder.primary(state, action, cost).map_err(|error| entry(place(), &error))?;
    }
    for (k, value) in list(&root, "", "secondary")?.iter().enumerate() {
        secondary(&mut builder, k, value)?;
    }
    builder.build().map_err(|error| match error {
        ModelError::InitialSum(_) => malformed("initial", error.to_string()),
        ModelError::PairSum { entry, .. } => {
            malformed(format!("transitions[{entry}]"), error.to_string())
        }
    })
}

fn secondary(builder: &mut CmdpBuilder, k: usize, value: &Value) -> Result<(), DocumentError> {
    let place = format!("secondary[{k}]");
    let Value::Object(item) = value else {
        let fault = format!("expected an object with name, bound and costs, found {}", kind(value));
        return Err(malformed(place, fault));
    };
    let name = match member(item, &place, "name", "a string")? {
        Value::String(name) => name,
        other => {
            let fault = format!("expected a string, found {}", kind(other));
            return Err(malformed(format!("{place}.name"), fault));
        }
    };
    let bound = number(member(item, &place, "bound", "a number >= 0")?)
        .map_err(|fault| unfit(format!("{place}.bound"), &fault))?;
    let declared =
        builder.secondary(name, bound).map_err(|error| entry(format!("{place}.bound"), &error))?;
    for (i, value) in list(item, &place, "costs")?.iter().enumerate() {
        let place = || format!("{place}.costs[{i}]");
        let ([state, action], cost) =
            row(value, "[state, action, cost]").map_err(|fault| unfit(place(), &fault))?;
        builder
            .secondary_cost(declared, state, action, cost)
            .map_err(|error| entry(place(), &error))?;
    }
    Ok(())
}

/// Writes the answer as one line of JSON.
pub fn write(cmdp: &Cmdp, outcome: &Outcome) -> String {
    let Outcome::Optimal(solution) = outcome else {
        return r#"{"status":"infeasible","primary":null,"secondary":[],"policy":[]}"#.to_owned();
    };
    let number = |x: f64| canonical(&Value::from(x));
    let secondary: Vec<String> = solution.secondary.iter().map(|v| number(*v)).collect();
    let policy: Vec<String> = (0..cmdp.states())
        .flat_map(|x| solution.policy.at(x).iter().map(move |(a, p)| (x, a, p)))
        .map(|(x, a, p)| format!("[{x},{a},{}]", number(*p)))
        .collect();
    format!(
        r#"{{"status":"optimal","primary":{},"secondary":[{}],"policy":[{}]}}"#,
        number(solution.primary),
        secondary.join(","),
        policy.join(",")
    )
}

/// Writes the model as a document that [`read`] takes, with names for its states and actions: one line of JSON. The
/// names are for people.
///
/// # Panics
/// Where there is not one name per state and per action.
pub fn write_model(cmdp: &Cmdp, states: &[String], actions: &[String]) -> String {
    assert_eq!((states.len(), actions.len()), (cmdp.states(), cmdp.actions()), "a name for each");
    let cost = |k: usize| -> Vec<Value> {
        let positive = cmdp.pairs().iter().filter(|pair| pair.costs[k] > 0.0);
        positive.map(|pair| json!([pair.state, pair.action, pair.costs[k]])).collect()
    };
    let absorbing: Vec<usize> = (0..cmdp.states()).filter(|x| cmdp.is_absorbing(*x)).collect();
    let transitions: Vec<Value> = cmdp
        .pairs()
        .iter()
        .flat_map(|pair| {
            let row = |(y, p): &(usize, f64)| json!([pair.state, pair.action, y, p]);
            pair.successors.iter().map(row).collect::<Vec<_>>()
        })
        .collect();
    let secondary: Vec<Value> = cmdp
        .secondary()
        .iter()
        .enumerate()
        .map(|(i, s)| json!({"name": s.name, "bound": s.bound, "costs": cost(i + 1)}))
        .collect();
    canonical(&json!({
        "states": states,
        "actions": actions,
        "absorbing": absorbing,
        "initial": cmdp.initial(),
        "transitions": transitions,
        "primary": cost(0),
        "secondary": secondary,
    }))
}

fn malformed(place: impl Into<String>, fault: impl Into<String>) -> DocumentError {
    DocumentError::Malformed { place: place.into(), fault: fault.into() }
}

fn unfit(place: String, fault: &Unfit) -> DocumentError {
    malformed(place, fault.to_string())
}

fn entry(place: String, error: &EntryError) -> DocumentError {
    malformed(place, error.to_string())
}

/// Says what a JSON value is, in words, without repeating a hostile amount of it.
fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(b) => b.to_string(),
        Value::Number(n) => n.to_string(),
        Value::String(_) => "a string".to_owned(),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "an object".to_owned(),
    }
}

/// Returns `object[key]`, which must exist.
fn member<'a>(
    object: &'a Map<String, Value>,
    place: &str,
    key: &str,
    expected: &str,
) -> Result<&'a Value, DocumentError> {
    object.get(key).ok_or_else(|| {
        let place = if place.is_empty() { "document" } else { place };
        malformed(place, format!("key `{key}` is missing; expected {expected}"))
    })
}

fn list<'a>(
    object: &'a Map<String, Value>,
    place: &str,
    key: &str,
) -> Result<&'a [Value], DocumentError> {
    match member(object, place, key, "a list")? {
        Value::Array(items) => Ok(items),
        other => {
            let place = if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
            Err(malformed(place, format!("expected a list, found {}", kind(other))))
        }
    }
}

/// Counts the names in the list `key`.
fn names(root: &Map<String, Value>, key: &str) -> Result<usize, DocumentError> {
    let items = list(root, "", key)?;
    for (i, item) in items.iter().enumerate() {
        if !item.is_string() {
            let fault = format!("expected a name, found {}", kind(item));
            return Err(malformed(format!("{key}[{i}]"), fault));
        }
    }
    Ok(items.len())
}

/// A value of another kind than its place takes.
#[derive(Debug, thiserror::Error)]
#[error("expected {expected}, found {found}")]
struct Unfit {
    expected: String,
    found: String,
}

impl Unfit {
    fn new(expected: &str, value: &Value) -> Self {
        Self { expected: expected.to_owned(), found: kind(value) }
    }
}

fn index(value: &Value, expected: &str) -> Result<usize, Unfit> {
    let index = value.as_u64().and_then(|i| usize::try_from(i).ok());
    index.ok_or_else(|| Unfit::new(expected, value))
}

fn number(value: &Value) -> Result<f64, Unfit> {
    value.as_f64().ok_or_else(|| Unfit::new("a number", value))
}

/// Reads a row of N indices and a number; `shape` names its elements.
fn row<const N: usize>(value: &Value, shape: &str) -> Result<([usize; N], f64), Unfit> {
    let Value::Array(items) = value else {
        return Err(Unfit::new(shape, value));
    };
    let [indices @ .., last] = items.as_slice() else {
        return Err(Unfit::new(shape, value));
    };
    let Ok(indices) = <&[Value; N]>::try_from(indices) else {
        return Err(Unfit::new(shape, value));
    };
    let mut read = [0; N];
    for ((slot, item), what) in read.iter_mut().zip(indices).zip(["state", "action", "successor"]) {
        *slot = index(item, &format!("an index as {what}"))?;
    }
    Ok((read, number(last)?))
}

#[cfg(test)]
#[path = "tests/document.rs"]
mod tests;
