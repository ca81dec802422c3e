//! Expressions: from the text within `${}` to a tree.
//!
//! Python's, from the loosest operator to the tightest: `a if b else c`, `or`, `and`, `not`, comparisons, `+ -`, `* / // %`,
//! signs, `**`, then calls, `x.name` and `x[i]`.

use super::value::{Value, number};

/// How deep an expression may nest.
const MAX_DEPTH: usize = 40;

/// An expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expression {
    Literal(Value),
    Name(String),
    List(Vec<Expression>),
    Dict(Vec<(Expression, Expression)>),
    Not(Box<Expression>),
    Minus(Box<Expression>),
    And(Box<Expression>, Box<Expression>),
    Or(Box<Expression>, Box<Expression>),
    Binary(&'static str, Box<Expression>, Box<Expression>),
    /// The first, then what each is compared to.
    Compare(Box<Expression>, Vec<(&'static str, Expression)>),
    /// Condition, then, otherwise.
    If(Box<Expression>, Box<Expression>, Box<Expression>),
    Attribute(Box<Expression>, String),
    Index(Box<Expression>, Box<Expression>),
    /// From, to.
    Slice(Box<Expression>, Option<Box<Expression>>, Option<Box<Expression>>),
    /// What is called, its arguments, and those with a name.
    Call(Box<Expression>, Vec<Expression>, Vec<(String, Expression)>),
}

/// What a function is called with: arguments, and those with a name.
type Arguments = (Vec<Expression>, Vec<(String, Expression)>);

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Literal(Value),
    Name(String),
    Mark(&'static str),
}

/// Longest first.
const MARKS: [&str; 25] = [
    "**", "//", "==", "!=", "<=", ">=", "+", "-", "*", "/", "%", "<", ">", "(", ")", "[", "]", "{",
    "}", ",", ":", ".", "=", "|", "&",
];

const COMPARISONS: [&str; 6] = ["==", "!=", "<=", ">=", "<", ">"];

fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = if first == '"' || first == '\'' {
            let inner = &rest[1..];
            let Some(end) = inner.find(first) else {
                return Err(format!("the text that begins at `{rest}` has no end"));
            };
            tokens.push(Token::Literal(Value::Text(inner[..end].into())));
            end + 2
        } else if first.is_ascii_digit()
            || (first == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit()))
        {
            let length = number_length(rest);
            let written = &rest[..length];
            let value = written
                .parse()
                .map(Value::Int)
                .ok()
                .or_else(|| number(written).map(Value::Float))
                .ok_or_else(|| format!("`{written}` is no number"))?;
            tokens.push(Token::Literal(value));
            length
        } else if first.is_alphabetic() || first == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            let end = end.unwrap_or(rest.len());
            tokens.push(Token::Name(rest[..end].to_owned()));
            end
        } else if let Some(mark) = MARKS.iter().find(|mark| rest.starts_with(**mark)) {
            tokens.push(Token::Mark(mark));
            mark.len()
        } else {
            return Err(format!("`{first}` is not understood"));
        };
        rest = rest[length..].trim_start();
    }
    Ok(tokens)
}

/// Returns how many bytes the number at the beginning of `text` has.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut end = 0;
    while let Some(&byte) = bytes.get(end) {
        let sign_of_exponent =
            matches!(byte, b'+' | b'-') && matches!(bytes[end.saturating_sub(1)], b'e' | b'E');
        let exponent = matches!(byte, b'e' | b'E')
            && bytes.get(end + 1).is_some_and(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-'));
        if !(byte.is_ascii_digit() || byte == b'.' || exponent || sign_of_exponent) {
            break;
        }
        end += 1;
    }
    end
}

/// Reads an expression.
///
/// # Errors
/// What is not understood of it.
pub(super) fn parse(text: &str) -> Result<Expression, String> {
    let mut parser = Parser { tokens: tokens(text)?, at: 0, depth: 0 };
    let mut expression = parser.whole()?;
    // `1, 2` is a tuple.
    if parser.takes(",") {
        let mut items = vec![expression];
        while parser.at < parser.tokens.len() {
            items.push(parser.whole()?);
            if !parser.takes(",") {
                break;
            }
        }
        expression = Expression::List(items);
    }
    match parser.tokens.get(parser.at) {
        None => Ok(expression),
        Some(token) => Err(format!("{} was not expected", said(token))),
    }
}

fn said(token: &Token) -> String {
    match token {
        Token::Literal(value) => format!("`{value}`"),
        Token::Name(name) => format!("`{name}`"),
        Token::Mark(mark) => format!("`{mark}`"),
    }
}

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

impl Parser {
    fn takes(&mut self, mark: &str) -> bool {
        let found = matches!(self.tokens.get(self.at), Some(Token::Mark(m)) if *m == mark);
        self.at += usize::from(found);
        found
    }

    fn takes_word(&mut self, word: &str) -> bool {
        let found = matches!(self.tokens.get(self.at), Some(Token::Name(name)) if name == word);
        self.at += usize::from(found);
        found
    }

    fn expects(&mut self, mark: &str) -> Result<(), String> {
        if self.takes(mark) {
            return Ok(());
        }
        let found = self.tokens.get(self.at).map_or("the end".to_owned(), said);
        Err(format!("expected `{mark}`, found {found}"))
    }

    fn whole(&mut self) -> Result<Expression, String> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(format!("it nests deeper than {MAX_DEPTH} levels"));
        }
        let then = self.or()?;
        let whole = if self.takes_word("if") {
            let condition = self.or()?;
            if !self.takes_word("else") {
                return Err("an `if` without an `else`".to_owned());
            }
            let otherwise = self.whole()?;
            Expression::If(Box::new(condition), Box::new(then), Box::new(otherwise))
        } else {
            then
        };
        self.depth -= 1;
        Ok(whole)
    }

    fn or(&mut self) -> Result<Expression, String> {
        let mut left = self.and()?;
        while self.takes_word("or") {
            left = Expression::Or(Box::new(left), Box::new(self.and()?));
        }
        Ok(left)
    }

    fn and(&mut self) -> Result<Expression, String> {
        let mut left = self.negation()?;
        while self.takes_word("and") {
            left = Expression::And(Box::new(left), Box::new(self.negation()?));
        }
        Ok(left)
    }

    fn negation(&mut self) -> Result<Expression, String> {
        let mut count = 0;
        while self.takes_word("not") {
            count += 1;
        }
        let mut inner = self.comparison()?;
        if count > 0 {
            inner = Expression::Not(Box::new(inner));
            if count % 2 == 0 {
                inner = Expression::Not(Box::new(inner));
            }
        }
        Ok(inner)
    }

    fn comparison(&mut self) -> Result<Expression, String> {
        let first = self.sum()?;
        let mut others = Vec::new();
        loop {
            let operator = if let Some(mark) = COMPARISONS.into_iter().find(|m| self.takes(m)) {
                mark
            } else if self.takes_word("in") {
                "in"
            } else if self.takes_word("not") {
                if !self.takes_word("in") {
                    return Err("a `not` that negates nothing".to_owned());
                }
                "not in"
            } else if self.takes_word("is") {
                if self.takes_word("not") { "!=" } else { "==" }
            } else {
                break;
            };
            others.push((operator, self.sum()?));
        }
        Ok(if others.is_empty() { first } else { Expression::Compare(Box::new(first), others) })
    }

    fn left_to_right(
        &mut self,
        operators: &[&'static str],
        part: fn(&mut Self) -> Result<Expression, String>,
    ) -> Result<Expression, String> {
        let mut left = part(self)?;
        while let Some(operator) = operators.iter().find(|operator| self.takes(operator)) {
            left = Expression::Binary(operator, Box::new(left), Box::new(part(self)?));
        }
        Ok(left)
    }

    fn sum(&mut self) -> Result<Expression, String> {
        self.left_to_right(&["+", "-"], Self::product)
    }

    fn product(&mut self) -> Result<Expression, String> {
        self.left_to_right(&["*", "/", "//", "%"], Self::signed)
    }

    fn signed(&mut self) -> Result<Expression, String> {
        let mut negative = false;
        loop {
            if self.takes("-") {
                negative = !negative;
            } else if !self.takes("+") {
                break;
            }
        }
        let inner = self.power()?;
        Ok(if negative { Expression::Minus(Box::new(inner)) } else { inner })
    }

    fn power(&mut self) -> Result<Expression, String> {
        let base = self.postfix()?;
        if !self.takes("**") {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(format!("it nests deeper than {MAX_DEPTH} levels"));
        }
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(Expression::Binary("**", Box::new(base), Box::new(exponent)))
    }

    fn postfix(&mut self) -> Result<Expression, String> {
        let mut inner = self.atom()?;
        let mut length = 0;
        loop {
            length += 1;
            if length > MAX_DEPTH {
                return Err(format!("it nests deeper than {MAX_DEPTH} levels"));
            }
            if self.takes(".") {
                let Some(Token::Name(name)) = self.tokens.get(self.at) else {
                    return Err("a `.` without a name".to_owned());
                };
                inner = Expression::Attribute(Box::new(inner), name.clone());
                self.at += 1;
            } else if self.takes("[") {
                inner = self.subscript(inner)?;
            } else if self.takes("(") {
                let (arguments, named) = self.arguments()?;
                inner = Expression::Call(Box::new(inner), arguments, named);
            } else {
                return Ok(inner);
            }
        }
    }

    fn subscript(&mut self, of: Expression) -> Result<Expression, String> {
        let bound = |this: &mut Self, end: &str| -> Result<Option<Box<Expression>>, String> {
            if matches!(this.tokens.get(this.at), Some(Token::Mark(m)) if *m == end) {
                return Ok(None);
            }
            this.whole().map(|bound| Some(Box::new(bound)))
        };
        let from = bound(self, ":")?;
        if self.takes(":") {
            let to = bound(self, "]")?;
            self.expects("]")?;
            return Ok(Expression::Slice(Box::new(of), from, to));
        }
        self.expects("]")?;
        let index = from.ok_or_else(|| "nothing stands within `[]`".to_owned())?;
        Ok(Expression::Index(Box::new(of), index))
    }

    fn arguments(&mut self) -> Result<Arguments, String> {
        let (mut arguments, mut named) = (Vec::new(), Vec::new());
        while !self.takes(")") {
            match (self.tokens.get(self.at), self.tokens.get(self.at + 1)) {
                (Some(Token::Name(name)), Some(Token::Mark("="))) => {
                    let name = name.clone();
                    self.at += 2;
                    named.push((name, self.whole()?));
                }
                _ => arguments.push(self.whole()?),
            }
            if !self.takes(",") {
                self.expects(")")?;
                break;
            }
        }
        Ok((arguments, named))
    }

    fn atom(&mut self) -> Result<Expression, String> {
        let Some(token) = self.tokens.get(self.at).cloned() else {
            return Err("it ends too early".to_owned());
        };
        self.at += 1;
        match token {
            Token::Literal(value) => Ok(Expression::Literal(value)),
            Token::Name(name) => Ok(match name.as_str() {
                "True" | "true" => Expression::Literal(Value::Bool(true)),
                "False" | "false" => Expression::Literal(Value::Bool(false)),
                "None" => Expression::Literal(Value::None),
                _ => Expression::Name(name),
            }),
            Token::Mark("(") => {
                if self.takes(")") {
                    return Ok(Expression::List(Vec::new()));
                }
                let first = self.whole()?;
                if self.takes(",") {
                    let mut items = vec![first];
                    while !self.takes(")") {
                        items.push(self.whole()?);
                        if !self.takes(",") {
                            self.expects(")")?;
                            break;
                        }
                    }
                    return Ok(Expression::List(items));
                }
                self.expects(")")?;
                Ok(first)
            }
            Token::Mark("[") => {
                let mut items = Vec::new();
                while !self.takes("]") {
                    items.push(self.whole()?);
                    if !self.takes(",") {
                        self.expects("]")?;
                        break;
                    }
                }
                Ok(Expression::List(items))
            }
            Token::Mark("{") => {
                let mut entries = Vec::new();
                while !self.takes("}") {
                    let key = self.whole()?;
                    self.expects(":")?;
                    entries.push((key, self.whole()?));
                    if !self.takes(",") {
                        self.expects("}")?;
                        break;
                    }
                }
                Ok(Expression::Dict(entries))
            }
            token @ Token::Mark(_) => Err(format!("{} was not expected", said(&token))),
        }
    }
}
