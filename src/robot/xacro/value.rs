//! The values of xacro's expressions: those of Python that robots' descriptions use.

use std::cmp::Ordering;
use std::fmt;
use std::rc::Rc;

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(Rc<str>),
    List(Rc<[Value]>),
    /// A mapping from text, in the order written.
    Dict(Rc<[(Rc<str>, Value)]>),
}

impl Value {
    /// Returns the value of a property written as `text`, as xacro takes literals: a number, a truth value, or text whose
    /// single quotes are taken off.
    pub(super) fn of_literal(text: &str) -> Self {
        if let Some(inner) = text.strip_prefix('\'').and_then(|t| t.strip_suffix('\'')) {
            return Self::Text(inner.into());
        }
        let trimmed = text.trim();
        if !trimmed.contains('_') {
            if let Ok(number) = trimmed.parse() {
                return Self::Int(number);
            }
            if let Some(number) = number(trimmed) {
                return Self::Float(number);
            }
        }
        match trimmed {
            "true" | "True" => Self::Bool(true),
            "false" | "False" => Self::Bool(false),
            _ => Self::Text(text.into()),
        }
    }

    /// Returns the number that it is, or that a truth value stands for.
    pub(super) fn number(&self) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "Python's own conversion rounds too")]
        match self {
            Self::Int(number) => Some(*number as f64),
            Self::Float(number) => Some(*number),
            Self::Bool(truth) => Some(f64::from(u8::from(*truth))),
            _ => None,
        }
    }

    /// Returns the whole number that it is.
    pub(super) fn int(&self) -> Option<i64> {
        match self {
            Self::Int(number) => Some(*number),
            Self::Bool(truth) => Some(i64::from(*truth)),
            _ => None,
        }
    }

    /// Returns whether Python takes it for true.
    pub(super) fn is_true(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(truth) => *truth,
            Self::Int(number) => *number != 0,
            Self::Float(number) => *number != 0.0,
            Self::Text(text) => !text.is_empty(),
            Self::List(items) => !items.is_empty(),
            Self::Dict(entries) => !entries.is_empty(),
        }
    }

    /// Returns what `<xacro:if>` makes of it; `None` where it is neither a number nor a truth value.
    pub(super) fn condition(&self) -> Option<bool> {
        match self {
            Self::Text(text) => match Self::of_literal(text) {
                Self::Text(_) => None,
                literal => Some(literal.is_true()),
            },
            other => Some(other.is_true()),
        }
    }

    /// Returns whether both are equal, whole numbers and others alike.
    pub(super) fn equals(&self, other: &Self) -> bool {
        match (self.number(), other.number()) {
            (Some(a), Some(b)) => a == b,
            _ => self == other,
        }
    }

    /// Returns how it compares to `other`; `None` where it does not.
    pub(super) fn compare(&self, other: &Self) -> Option<Ordering> {
        match (self, other) {
            (Self::Text(a), Self::Text(b)) => Some(a.cmp(b)),
            _ => self.number()?.partial_cmp(&other.number()?),
        }
    }

    /// Returns the name of its kind, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool(_) => "a truth value",
            Self::Int(_) | Self::Float(_) => "a number",
            Self::Text(_) => "text",
            Self::List(_) => "a list",
            Self::Dict(_) => "a mapping",
        }
    }
}

/// Reads a finite number as Python's `float` does, but for its names of infinities.
pub(super) fn number(text: &str) -> Option<f64> {
    let begins = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    text.parse::<f64>().ok().filter(|number| begins && number.is_finite())
}

impl fmt::Display for Value {
    /// Writes it as Python's `str`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let quoted = |value: &Self| match value {
            Self::Text(text) => format!("'{text}'"),
            other => other.to_string(),
        };
        match self {
            Self::None => f.write_str("None"),
            Self::Bool(true) => f.write_str("True"),
            Self::Bool(false) => f.write_str("False"),
            Self::Int(number) => write!(f, "{number}"),
            Self::Float(number) => write!(f, "{number:?}"),
            Self::Text(text) => f.write_str(text),
            Self::List(items) => {
                let items: Vec<String> = items.iter().map(quoted).collect();
                write!(f, "[{}]", items.join(", "))
            }
            Self::Dict(entries) => {
                let entries: Vec<String> = entries
                    .iter()
                    .map(|(key, value)| format!("'{key}': {}", quoted(value)))
                    .collect();
                write!(f, "{{{}}}", entries.join(", "))
            }
        }
    }
}
