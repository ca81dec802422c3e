//! What `${}` and `$()` stand for.

use super::evaluate::{self, LookUp, MAX_LENGTH};
use super::expand::{Expander, HELP};
use super::expression;
use super::scope::Property;
use super::text::{Piece, pieces};
use super::value::Value;
use std::rc::Rc;

/// Most text (bytes) that one expansion may work on.
const MAX_WORK: usize = 64 << 20;

/// Why a text cannot be expanded, and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) why: String,
    pub(super) help: String,
}

impl From<String> for Refusal {
    fn from(why: String) -> Self {
        Self { why, help: HELP.to_owned() }
    }
}

impl Expander<'_> {
    /// Returns the value of `text` as the scopes below `top` see it.
    pub(super) fn value(&mut self, text: &str, top: usize) -> Result<Value, Refusal> {
        if !text.contains('$') {
            return Ok(Value::Text(text.into()));
        }
        let pieces = pieces(text)?;
        if let [piece @ (Piece::Expression(_) | Piece::Substitution(_))] = pieces[..] {
            return self.piece(piece, top);
        }
        let mut whole = String::new();
        for piece in pieces {
            match piece {
                Piece::Text(text) => whole.push_str(text),
                piece => whole.push_str(&self.piece(piece, top)?.to_string()),
            }
            if whole.len() > MAX_LENGTH {
                return Err(format!("its result is longer than {MAX_LENGTH} bytes").into());
            }
        }
        self.work += whole.len();
        if self.work > MAX_WORK {
            return Err("the description is too large: macros may multiply without end"
                .to_owned()
                .into());
        }
        Ok(Value::Text(whole.into()))
    }

    fn piece(&mut self, piece: Piece<'_>, top: usize) -> Result<Value, Refusal> {
        match piece {
            Piece::Text(text) => Ok(Value::Text(text.into())),
            Piece::Expression(text) => self.expression(text, top),
            Piece::Substitution(text) => self.substitution(text, top),
        }
    }

    fn expression(&mut self, text: &str, top: usize) -> Result<Value, Refusal> {
        let parsed = expression::parse(text)?;
        self.work += text.len();
        // The way out of the evaluation, which knows words only.
        let mut refused = None;
        let value = evaluate::evaluate(&parsed, &mut |name| match self.property(name, top) {
            Ok(value) => Ok(value),
            Err(refusal) => {
                let why = refusal.why.clone();
                refused = Some(refusal);
                Err(why)
            }
        });
        value.map_err(|why| match refused {
            Some(refusal) => refusal,
            None if why.ends_with("is not defined") => Refusal {
                help: format!(
                    "give it as `robot: {{file, arguments: {{{}: VALUE}}}}` where whoever starts the robot does; else {HELP}",
                    why.split('`').nth(1).unwrap_or("NAME")
                ),
                why,
            },
            None => why.into(),
        })
    }

    /// Returns the property `name`, or the argument of that name that the manifest gives.
    pub(super) fn property(&mut self, name: &str, top: usize) -> Result<Option<Value>, Refusal> {
        let Some((at, property)) = self.scopes.property(name, top) else {
            return Ok(self.given.get(name).map(|text| Value::of_literal(text)));
        };
        match property {
            Property::Value(value) => Ok(Some(value.clone())),
            Property::Open => Err(format!("`{name}` is made of itself").into()),
            Property::Written(text) => {
                let text = Rc::clone(text);
                self.deeper()?;
                self.scopes.set(at, name, Property::Open);
                let value = literal(self.value(&text, at + 1)?);
                self.scopes.set(at, name, Property::Value(value.clone()));
                self.depth -= 1;
                Ok(Some(value))
            }
        }
    }

    fn substitution(&mut self, text: &str, top: usize) -> Result<Value, Refusal> {
        let text = match self.value(text, top)? {
            Value::Text(text) => text,
            other => other.to_string().into(),
        };
        let text = text.trim();
        let (command, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        let (first, others) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let found: String = match command {
            "arg" => self.argument(rest)?,
            "find" => package(rest),
            "optenv" => {
                if let Some(given) = self.given.get(first) {
                    given.clone()
                } else {
                    self.environment += 1;
                    others.trim().to_owned()
                }
            }
            "env" => self.given.get(rest).cloned().ok_or_else(|| Refusal {
                why: "the environment is not read".to_owned(),
                help: format!("give it as `robot: {{file, arguments: {{{rest}: VALUE}}}}`"),
            })?,
            "dirname" => ".".to_owned(),
            "anon" => rest.to_owned(),
            "eval" => return self.eval(rest),
            _ => return Err(format!("`$({command})` is not known").into()),
        };
        Ok(Value::Text(found.into()))
    }

    fn argument(&self, name: &str) -> Result<String, Refusal> {
        self.arguments.get(name).cloned().ok_or_else(|| Refusal {
            why: format!("the argument `{name}` has no default"),
            help: format!("give it as `robot: {{file, arguments: {{{name}: VALUE}}}}`"),
        })
    }

    /// Evaluates an expression among the arguments, as `$(eval)` does.
    fn eval(&mut self, text: &str) -> Result<Value, Refusal> {
        // `arg('x')` and `find('x')` are functions there.
        let parsed = expression::parse(text)?;
        let rewritten = self.called(parsed)?;
        let arguments = &self.arguments;
        let names: &mut LookUp<'_> =
            &mut |name| Ok(arguments.get(name).map(|text| Value::of_literal(text)));
        Ok(evaluate::evaluate(&rewritten, names)?)
    }

    /// Returns the expression with calls of `arg` and `find` replaced by what they yield.
    fn called(&self, whole: expression::Expression) -> Result<expression::Expression, Refusal> {
        use expression::Expression as E;
        let boxed = |inner: Box<E>| self.called(*inner).map(Box::new);
        Ok(match whole {
            E::Call(function, arguments, named) => {
                let name = match (&*function, &arguments[..]) {
                    (E::Name(function), [E::Literal(Value::Text(name))]) => {
                        Some((function.as_str(), &**name))
                    }
                    _ => None,
                };
                match name {
                    Some(("arg", name)) => E::Literal(Value::of_literal(&self.argument(name)?)),
                    Some(("find", name)) => E::Literal(Value::Text(package(name).into())),
                    _ => {
                        let arguments: Result<Vec<E>, Refusal> =
                            arguments.into_iter().map(|argument| self.called(argument)).collect();
                        E::Call(function, arguments?, named)
                    }
                }
            }
            E::Not(inner) => E::Not(boxed(inner)?),
            E::Minus(inner) => E::Minus(boxed(inner)?),
            E::And(a, b) => E::And(boxed(a)?, boxed(b)?),
            E::Or(a, b) => E::Or(boxed(a)?, boxed(b)?),
            E::Binary(operator, a, b) => E::Binary(operator, boxed(a)?, boxed(b)?),
            E::If(a, b, c) => E::If(boxed(a)?, boxed(b)?, boxed(c)?),
            E::Compare(first, others) => {
                let others: Result<Vec<_>, Refusal> = others
                    .into_iter()
                    .map(|(operator, other)| Ok((operator, self.called(other)?)))
                    .collect();
                E::Compare(boxed(first)?, others?)
            }
            other => other,
        })
    }
}

/// Returns `value` as properties take it: text that is a number is one.
pub(super) fn literal(value: Value) -> Value {
    match value {
        Value::Text(text) => Value::of_literal(&text),
        other => other,
    }
}

/// Returns what stands for the folder of the package `name`: whoever opens a file there learns whether it is given.
fn package(name: &str) -> String {
    format!("package://{name}")
}

/// Says how to give the folder of a package.
pub(in crate::robot) fn how_to_give(name: &str) -> String {
    format!("give it as `robot: {{file, packages: {{{name}: FOLDER}}}}`")
}
