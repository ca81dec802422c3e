//! From an expression to its value.

use super::expression::Expression;
use super::functions;
use super::value::Value;
use crate::math;
use std::rc::Rc;

/// Longest text (bytes) and longest list that an expression may yield.
pub(super) const MAX_LENGTH: usize = 1 << 20;

/// What functions' names may begin with.
const MODULES: [&str; 3] = ["math", "python", "xacro"];

/// Who knows what a name stands for: `None` where nobody does.
pub(super) type LookUp<'l> = dyn FnMut(&str) -> Result<Option<Value>, String> + 'l;

/// Returns the value of `expression`.
///
/// # Errors
/// Why it has none.
pub(super) fn evaluate(expression: &Expression, names: &mut LookUp<'_>) -> Result<Value, String> {
    Ok(match expression {
        Expression::Literal(value) => value.clone(),
        Expression::Name(name) => match names(name)? {
            Some(value) => value,
            None => functions::constant(name).ok_or_else(|| format!("`{name}` is not defined"))?,
        },
        Expression::List(items) => {
            let items: Result<Rc<[Value]>, String> =
                items.iter().map(|item| evaluate(item, names)).collect();
            Value::List(items?)
        }
        Expression::Dict(entries) => {
            let entry = |(key, value): &(Expression, Expression)| {
                let key: Rc<str> = evaluate(key, names)?.to_string().into();
                Ok((key, evaluate(value, names)?))
            };
            let entries: Result<Rc<[_]>, String> = entries.iter().map(entry).collect();
            Value::Dict(entries?)
        }
        Expression::Not(inner) => Value::Bool(!evaluate(inner, names)?.is_true()),
        Expression::Minus(inner) => match evaluate(inner, names)? {
            Value::Float(number) => Value::Float(-number),
            other => match other.int().and_then(i64::checked_neg) {
                Some(number) => Value::Int(number),
                None => return Err(format!("{} has no sign", other.kind())),
            },
        },
        Expression::And(left, right) => match evaluate(left, names)? {
            left if left.is_true() => evaluate(right, names)?,
            left => left,
        },
        Expression::Or(left, right) => match evaluate(left, names)? {
            left if left.is_true() => left,
            _ => evaluate(right, names)?,
        },
        Expression::Binary(operator, left, right) => {
            let (left, right) = (evaluate(left, names)?, evaluate(right, names)?);
            binary(operator, &left, &right)?
        }
        Expression::Compare(first, others) => {
            let mut left = evaluate(first, names)?;
            for (operator, other) in others {
                let right = evaluate(other, names)?;
                if !compare(operator, &left, &right)? {
                    return Ok(Value::Bool(false));
                }
                left = right;
            }
            Value::Bool(true)
        }
        Expression::If(condition, then, otherwise) => {
            let chosen = if evaluate(condition, names)?.is_true() { then } else { otherwise };
            evaluate(chosen, names)?
        }
        Expression::Attribute(of, name) => {
            if let Some(constant) = full_name(expression).and_then(|n| functions::constant(&n)) {
                return Ok(constant);
            }
            match evaluate(of, names)? {
                Value::Dict(entries) => entry(&entries, name)?,
                other => return Err(format!("{} has no `{name}`", other.kind())),
            }
        }
        Expression::Index(of, index) => match (evaluate(of, names)?, evaluate(index, names)?) {
            (Value::Dict(entries), key) => entry(&entries, &key.to_string())?,
            (Value::List(items), index) => items[position(&index, items.len())?].clone(),
            (Value::Text(text), index) => {
                let characters: Vec<char> = text.chars().collect();
                let found = characters[position(&index, characters.len())?];
                Value::Text(found.to_string().into())
            }
            (other, _) => return Err(format!("{} has no items", other.kind())),
        },
        Expression::Slice(of, from, to) => {
            let mut bound = |bound: &Option<Box<Expression>>| -> Result<Option<i64>, String> {
                let Some(bound) = bound else { return Ok(None) };
                let value = evaluate(bound, names)?;
                value.int().map(Some).ok_or_else(|| format!("{} is no position", value.kind()))
            };
            let (from, to) = (bound(from)?, bound(to)?);
            slice(&evaluate(of, names)?, from, to)?
        }
        Expression::Call(called, arguments, named) => {
            let mut values = Vec::new();
            for argument in arguments {
                values.push(evaluate(argument, names)?);
            }
            let mut pairs = Vec::new();
            for (name, argument) in named {
                pairs.push((Rc::from(name.as_str()), evaluate(argument, names)?));
            }
            if let Some(name) = full_name(called)
                && let Some(value) = functions::call(&name, &values, &pairs)?
            {
                return Ok(value);
            }
            match &**called {
                Expression::Attribute(of, method) if matches!(&**of, Expression::Name(n) if MODULES.contains(&n.as_str())) =>
                {
                    let module = full_name(of).unwrap_or_default();
                    return Err(format!("the function `{module}.{method}` is not known"));
                }
                Expression::Attribute(of, method) => {
                    functions::method(&evaluate(of, names)?, method, &values)?
                }
                Expression::Name(name) => {
                    return Err(format!("the function `{name}` is not known"));
                }
                _ => return Err("what is called is no function".to_owned()),
            }
        }
    })
}

/// Returns `a.b.c` where the expression is nothing but names.
fn full_name(expression: &Expression) -> Option<String> {
    match expression {
        Expression::Name(name) => Some(name.clone()),
        Expression::Attribute(of, name) => full_name(of).map(|of| format!("{of}.{name}")),
        _ => None,
    }
}

fn entry(entries: &[(Rc<str>, Value)], key: &str) -> Result<Value, String> {
    // Of a key that is written twice, the last one counts.
    let found = entries.iter().rev().find(|(name, _)| &**name == key);
    found.map(|(_, value)| value.clone()).ok_or_else(|| format!("the mapping has no `{key}`"))
}

/// Returns the place of `index`, which counts from the end where it is negative.
fn position(index: &Value, length: usize) -> Result<usize, String> {
    let Some(index) = index.int() else { return Err(format!("{} is no position", index.kind())) };
    let size = i64::try_from(length).unwrap_or(i64::MAX);
    let at = if index < 0 { index.saturating_add(size) } else { index };
    usize::try_from(at)
        .ok()
        .filter(|at| *at < length)
        .ok_or_else(|| format!("there is no item {index} of {length}"))
}

fn slice(of: &Value, from: Option<i64>, to: Option<i64>) -> Result<Value, String> {
    let bounds = |length: usize| {
        let size = i64::try_from(length).unwrap_or(i64::MAX);
        let at = |bound: i64| {
            let at = if bound < 0 { bound.saturating_add(size) } else { bound };
            usize::try_from(at.clamp(0, size)).unwrap_or(length)
        };
        let (from, to) = (from.map_or(0, at), to.map_or(length, at));
        from..to.max(from)
    };
    Ok(match of {
        Value::List(items) => Value::List(items[bounds(items.len())].into()),
        Value::Text(text) => {
            let characters: Vec<char> = text.chars().collect();
            let part: String = characters[bounds(characters.len())].iter().collect();
            Value::Text(part.into())
        }
        other => return Err(format!("{} has no items", other.kind())),
    })
}

fn compare(operator: &str, left: &Value, right: &Value) -> Result<bool, String> {
    let within = || -> Result<bool, String> {
        Ok(match right {
            Value::List(items) => items.iter().any(|item| item.equals(left)),
            Value::Dict(entries) => entries.iter().any(|(key, _)| **key == *left.to_string()),
            Value::Text(text) => match left {
                Value::Text(part) => text.contains(&**part),
                other => return Err(format!("{} cannot be in text", other.kind())),
            },
            other => return Err(format!("nothing is in {}", other.kind())),
        })
    };
    let order = || {
        left.compare(right)
            .ok_or_else(|| format!("{} and {} have no order", left.kind(), right.kind()))
    };
    Ok(match operator {
        "==" => left.equals(right),
        "!=" => !left.equals(right),
        "<" => order()?.is_lt(),
        "<=" => order()?.is_le(),
        ">" => order()?.is_gt(),
        ">=" => order()?.is_ge(),
        "in" => within()?,
        _ => !within()?,
    })
}

fn binary(operator: &str, left: &Value, right: &Value) -> Result<Value, String> {
    match (operator, left, right) {
        ("+", Value::Text(a), Value::Text(b)) if a.len() + b.len() <= MAX_LENGTH => {
            return Ok(Value::Text(format!("{a}{b}").into()));
        }
        ("+", Value::List(a), Value::List(b)) if a.len() + b.len() <= MAX_LENGTH => {
            return Ok(Value::List(a.iter().chain(b.iter()).cloned().collect()));
        }
        _ => {}
    }
    let whole = left.int().zip(right.int());
    let exact = whole.and_then(|(a, b)| match operator {
        "+" => a.checked_add(b),
        "-" => a.checked_sub(b),
        "*" => a.checked_mul(b),
        "//" => (b != 0).then(|| floor_division(a, b)).flatten(),
        "%" => (b != 0).then(|| a.checked_rem_euclid(b)).flatten().map(|rest| {
            // Python's remainder has the sign of the divisor.
            if b < 0 && rest != 0 { rest + b } else { rest }
        }),
        "**" => u32::try_from(b).ok().and_then(|b| a.checked_pow(b)),
        _ => None,
    });
    if let Some(exact) = exact {
        return Ok(Value::Int(exact));
    }
    let (Some(a), Some(b)) = (left.number(), right.number()) else {
        return Err(format!("`{operator}` does not take {} and {}", left.kind(), right.kind()));
    };
    if matches!(operator, "/" | "//" | "%") && b == 0.0 {
        return Err("it divides by zero".to_owned());
    }
    let number = match operator {
        "+" => a + b,
        "-" => a - b,
        "*" => a * b,
        "/" => a / b,
        "//" => (a / b).floor(),
        "%" => a - b * (a / b).floor(),
        _ => math::pow(a, b),
    };
    if !number.is_finite() {
        return Err("its result is no finite number".to_owned());
    }
    Ok(Value::Float(number))
}

fn floor_division(a: i64, b: i64) -> Option<i64> {
    let quotient = a.checked_div(b)?;
    Some(if a % b != 0 && (a < 0) != (b < 0) { quotient - 1 } else { quotient })
}
