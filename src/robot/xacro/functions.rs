//! The functions and constants that expressions may name: those of Python's `math` and the harmless ones of Python itself.

use super::evaluate::MAX_LENGTH;
use super::value::{Value, number};
use crate::math;
use std::cmp::Ordering;
use std::f64::consts;
use std::rc::Rc;

/// Returns the constant `name`.
pub(super) fn constant(name: &str) -> Option<Value> {
    let number = match name.strip_prefix("math.").unwrap_or(name) {
        "pi" => consts::PI,
        "tau" => consts::TAU,
        "e" => consts::E,
        _ => return None,
    };
    Some(Value::Float(number))
}

type Named = [(Rc<str>, Value)];

/// Returns what the function `name` yields; `None` where there is no function of that name.
///
/// # Errors
/// Where the arguments are not its own.
pub(super) fn call(
    name: &str,
    arguments: &[Value],
    named: &Named,
) -> Result<Option<Value>, String> {
    let name = name.strip_prefix("math.").or_else(|| name.strip_prefix("python.")).unwrap_or(name);
    if let Some(value) = of_one_number(name, arguments)? {
        return Ok(Some(value));
    }
    let two = || -> Result<(f64, f64), String> {
        match arguments.iter().map(Value::number).collect::<Option<Vec<_>>>().as_deref() {
            Some([a, b]) => Ok((*a, *b)),
            _ => Err(format!("`{name}` takes two numbers")),
        }
    };
    let one = || arguments.first().ok_or_else(|| format!("`{name}` takes an argument"));
    Ok(Some(match name {
        "atan2" => finite(two().map(|(y, x)| math::atan2(y, x))?)?,
        "pow" => finite(two().map(|(x, y)| math::pow(x, y))?)?,
        "hypot" => finite(two().map(|(x, y)| math::hypot(x, y))?)?,
        "fmod" => finite(two().map(|(x, y)| x % y)?)?,
        "copysign" => finite(two().map(|(x, y)| x.copysign(y))?)?,
        "min" => extreme(name, arguments, Ordering::Less)?,
        "max" => extreme(name, arguments, Ordering::Greater)?,
        "sum" => {
            let total = items(name, one()?)?.iter().map(Value::number).sum::<Option<f64>>();
            finite(total.ok_or_else(|| "`sum` takes numbers".to_owned())?)?
        }
        "round" => rounded(arguments)?,
        "abs" => match one()? {
            Value::Int(number) => Value::Int(number.saturating_abs()),
            other => finite(other.number().ok_or("`abs` takes a number")?.abs())?,
        },
        "len" => {
            let length = match one()? {
                Value::Text(text) => text.chars().count(),
                Value::List(items) => items.len(),
                Value::Dict(entries) => entries.len(),
                other => return Err(format!("{} has no length", other.kind())),
            };
            Value::Int(i64::try_from(length).unwrap_or(i64::MAX))
        }
        "str" => Value::Text(one()?.to_string().into()),
        "float" => match one()? {
            Value::Text(text) => number(text.trim())
                .map(Value::Float)
                .ok_or_else(|| format!("`{text}` is no number"))?,
            other => {
                finite(other.number().ok_or_else(|| format!("{} is no number", other.kind()))?)?
            }
        },
        "int" => match one()? {
            Value::Text(text) => text
                .trim()
                .parse()
                .map(Value::Int)
                .map_err(|_| format!("`{text}` is no whole number"))?,
            other => whole(
                other.number().ok_or_else(|| format!("{} is no number", other.kind()))?.trunc(),
            )?,
        },
        "bool" => Value::Bool(one()?.is_true()),
        "list" | "tuple" | "sorted" => {
            let mut list = match arguments.first() {
                None => Vec::new(),
                Some(of) => items(name, of)?,
            };
            if name == "sorted" {
                list.sort_by(|a, b| a.compare(b).unwrap_or(Ordering::Equal));
            }
            Value::List(list.into())
        }
        "dict" => {
            let mut entries = match arguments.first() {
                None => Vec::new(),
                Some(Value::Dict(entries)) => entries.to_vec(),
                Some(other) => return Err(format!("{} is no mapping", other.kind())),
            };
            entries.extend(named.iter().cloned());
            Value::Dict(entries.into())
        }
        "range" => range(arguments)?,
        "all" => Value::Bool(items(name, one()?)?.iter().all(Value::is_true)),
        "any" => Value::Bool(items(name, one()?)?.iter().any(Value::is_true)),
        "xacro.error" | "xacro.fatal" => return Err(format!("the description says: {}", one()?)),
        // Notes to whoever expands by hand.
        "xacro.warning" | "xacro.message" => Value::Text("".into()),
        _ => return Ok(None),
    }))
}

fn of_one_number(name: &str, arguments: &[Value]) -> Result<Option<Value>, String> {
    let function: fn(f64) -> f64 = match name {
        "sin" => math::sin,
        "cos" => math::cos,
        "tan" => math::tan,
        "asin" => math::asin,
        "acos" => math::acos,
        "atan" => |x| math::atan2(x, 1.0),
        "exp" => math::exp,
        "log" if arguments.len() == 1 => math::ln,
        "log10" => math::log10,
        "sqrt" => f64::sqrt,
        "fabs" => f64::abs,
        // As Python has them.
        "radians" => |x| x * (consts::PI / 180.0),
        "degrees" => |x| x * (180.0 / consts::PI),
        "floor" | "ceil" | "trunc" => {
            let [Some(number)] = arguments.iter().map(Value::number).collect::<Vec<_>>()[..] else {
                return Err(format!("`{name}` takes one number"));
            };
            return whole(match name {
                "floor" => number.floor(),
                "ceil" => number.ceil(),
                _ => number.trunc(),
            })
            .map(Some);
        }
        _ => return Ok(None),
    };
    match arguments.iter().map(Value::number).collect::<Vec<_>>()[..] {
        [Some(number)] => finite(function(number)).map(Some),
        _ => Err(format!("`{name}` takes one number")),
    }
}

fn finite(number: f64) -> Result<Value, String> {
    if number.is_finite() {
        return Ok(Value::Float(number));
    }
    Err("its result is no finite number".to_owned())
}

fn whole(number: f64) -> Result<Value, String> {
    if number.abs() < 9e15 {
        #[expect(clippy::cast_possible_truncation, reason = "checked: whole and small enough")]
        return Ok(Value::Int(number as i64));
    }
    Err("its result is too large".to_owned())
}

fn items(name: &str, of: &Value) -> Result<Vec<Value>, String> {
    Ok(match of {
        Value::List(items) => items.to_vec(),
        Value::Text(text) => text.chars().map(|c| Value::Text(c.to_string().into())).collect(),
        Value::Dict(entries) => {
            entries.iter().map(|(key, _)| Value::Text(Rc::clone(key))).collect()
        }
        other => return Err(format!("`{name}` does not take {}", other.kind())),
    })
}

fn extreme(name: &str, arguments: &[Value], wanted: Ordering) -> Result<Value, String> {
    let values = match arguments {
        [only] => items(name, only)?,
        several => several.to_vec(),
    };
    let mut values = values.into_iter();
    let mut best = values.next().ok_or_else(|| format!("`{name}` of nothing"))?;
    for value in values {
        let order = value.compare(&best);
        if order.ok_or_else(|| format!("`{name}` of what has no order"))? == wanted {
            best = value;
        }
    }
    Ok(best)
}

/// Rounds half to even, as Python does; to so many places where a second argument says so.
fn rounded(arguments: &[Value]) -> Result<Value, String> {
    let half_to_even = |number: f64| number.round_ties_even();
    match arguments {
        [Value::Int(number), ..] => Ok(Value::Int(*number)),
        [number] => whole(half_to_even(number.number().ok_or("`round` takes a number")?)),
        [number, places] => {
            let number = number.number().ok_or("`round` takes a number")?;
            let places = places.int().filter(|p| (0..=15).contains(p));
            let places = usize::try_from(places.ok_or("`round` takes 0 to 15 places")?);
            // Correctly rounded in decimal, which is what Python promises.
            let text = format!("{number:.*}", places.unwrap_or(0));
            finite(text.parse().unwrap_or(number))
        }
        _ => Err("`round` takes one or two numbers".to_owned()),
    }
}

fn range(arguments: &[Value]) -> Result<Value, String> {
    let bounds: Option<Vec<i64>> = arguments.iter().map(Value::int).collect();
    let (from, to, step) = match bounds.as_deref() {
        Some([to]) => (0, *to, 1),
        Some([from, to]) => (*from, *to, 1),
        Some([from, to, step]) if *step != 0 => (*from, *to, *step),
        _ => return Err("`range` takes one to three whole numbers".to_owned()),
    };
    let mut list = Vec::new();
    let mut at = from;
    while if step > 0 { at < to } else { at > to } {
        if list.len() >= MAX_LENGTH / 16 {
            return Err("`range` is too long".to_owned());
        }
        list.push(Value::Int(at));
        at = at.checked_add(step).ok_or("`range` is too long")?;
    }
    Ok(Value::List(list.into()))
}

/// Returns what the method `name` of `of` yields.
///
/// # Errors
/// Where there is none, or the arguments are not its own.
pub(super) fn method(of: &Value, name: &str, arguments: &[Value]) -> Result<Value, String> {
    let unknown = || Err(format!("{} has no function `{name}`", of.kind()));
    match of {
        Value::Text(text) => {
            let given: Vec<String> = arguments.iter().map(Value::to_string).collect();
            let given: Vec<&str> = given.iter().map(String::as_str).collect();
            let list = |parts: Vec<&str>| {
                Value::List(parts.into_iter().map(|part| Value::Text(part.into())).collect())
            };
            Ok(match (name, &given[..]) {
                ("split", []) => list(text.split_whitespace().collect()),
                ("split", [by]) if !by.is_empty() => list(text.split(by).collect()),
                ("lower", []) => Value::Text(text.to_lowercase().into()),
                ("upper", []) => Value::Text(text.to_uppercase().into()),
                ("strip", []) => Value::Text(text.trim().into()),
                ("startswith", [start]) => Value::Bool(text.starts_with(start)),
                ("endswith", [end]) => Value::Bool(text.ends_with(end)),
                ("find", [part]) => {
                    let found = text.find(part).map(|at| text[..at].chars().count());
                    Value::Int(found.and_then(|at| i64::try_from(at).ok()).unwrap_or(-1))
                }
                ("replace", [from, to]) if !from.is_empty() => {
                    let count = text.matches(from).count();
                    if text.len() + count * to.len() > MAX_LENGTH {
                        return Err("its result is too long".to_owned());
                    }
                    Value::Text(text.replace(from, to).into())
                }
                _ => return unknown(),
            })
        }
        Value::Dict(entries) => match (name, arguments) {
            ("keys", []) => {
                Ok(Value::List(entries.iter().map(|(k, _)| Value::Text(Rc::clone(k))).collect()))
            }
            ("values", []) => Ok(Value::List(entries.iter().map(|(_, v)| v.clone()).collect())),
            ("get", [key, otherwise @ ..]) => {
                let key = key.to_string();
                let found = entries.iter().rev().find(|(name, _)| **name == *key);
                Ok(found
                    .map_or(otherwise.first().cloned().unwrap_or(Value::None), |(_, v)| v.clone()))
            }
            _ => unknown(),
        },
        _ => unknown(),
    }
}
