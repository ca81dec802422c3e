//! Macros and their parameters.

use super::tree::Element;
use std::rc::Rc;

/// A macro.
#[derive(Debug, Clone)]
pub(super) struct Macro {
    pub(super) parameters: Rc<[Parameter]>,
    pub(super) body: Rc<Element>,
}

/// A parameter of a macro.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Parameter {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// What a parameter takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Kind {
    /// An attribute; the default where it has one.
    Attribute(Option<Default>),
    /// `*name`: the next element of the call.
    Block,
    /// `**name`: what stands in the next element of the call.
    Inner,
}

/// What a parameter is where the call does not say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Default {
    /// `^`: the property of that name, where the caller has one.
    pub(super) forwards: bool,
    pub(super) text: Option<String>,
}

/// Reads `params`: names, with `:=` or `=` and a default where they have one.
pub(super) fn parameters(text: &str) -> Rc<[Parameter]> {
    let mut parameters = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let end = rest.find(|c: char| c.is_whitespace() || c == '=').unwrap_or(rest.len());
        let (written, after) = rest.split_at(end);
        let name = written.trim_end_matches(':');
        // Blanks may stand about the sign.
        let spaced = after.trim_start();
        let sign = spaced.strip_prefix(":=").or_else(|| spaced.strip_prefix('='));
        let (default, left) = match sign {
            None => (None, after),
            Some(default) => {
                let default = default.trim_start_matches([' ', '\t']);
                let length = default_length(default);
                (Some(&default[..length]), &default[length..])
            }
        };
        rest = left.trim_start();
        let kind = match default {
            Some(default) => Kind::Attribute(Some(self::default(default))),
            None => Kind::Attribute(None),
        };
        parameters.push(match (name.strip_prefix("**"), name.strip_prefix('*')) {
            (Some(name), _) => Parameter { name: name.to_owned(), kind: Kind::Inner },
            (None, Some(name)) => Parameter { name: name.to_owned(), kind: Kind::Block },
            (None, None) => Parameter { name: name.to_owned(), kind },
        });
    }
    parameters.into()
}

fn default(text: &str) -> Default {
    let plain = |text: &str| {
        let inner = text.strip_prefix('\'').and_then(|text| text.strip_suffix('\''));
        Some(inner.unwrap_or(text).to_owned())
    };
    match text.strip_prefix('^') {
        None => Default { forwards: false, text: plain(text) },
        Some("") => Default { forwards: true, text: None },
        Some(rest) => {
            Default { forwards: true, text: plain(rest.strip_prefix('|').unwrap_or(rest)) }
        }
    }
}

/// Returns how long a default is: up to a blank that stands neither in quotes nor in braces.
fn default_length(text: &str) -> usize {
    let (mut quote, mut depth) = (None, 0_usize);
    for (at, character) in text.char_indices() {
        match quote {
            Some(mark) if character == mark => quote = None,
            None if matches!(character, '\'' | '"') => quote = Some(character),
            None if matches!(character, '{' | '(') => depth += 1,
            None if matches!(character, '}' | ')') => depth = depth.saturating_sub(1),
            None if character.is_whitespace() && depth == 0 => return at,
            Some(_) | None => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_names_defaults_and_blocks() {
        let found = parameters("a b:=1 c:='x y' d=${1 + 2} *e **f g:=^ h:=^|0 i:='' ");
        let attribute = |name: &str, forwards: bool, text: Option<&str>| Parameter {
            name: name.to_owned(),
            kind: Kind::Attribute(Some(Default { forwards, text: text.map(str::to_owned) })),
        };
        let plain = |name: &str, kind| Parameter { name: name.to_owned(), kind };
        assert_eq!(
            found[..],
            [
                plain("a", Kind::Attribute(None)),
                attribute("b", false, Some("1")),
                attribute("c", false, Some("x y")),
                attribute("d", false, Some("${1 + 2}")),
                plain("e", Kind::Block),
                plain("f", Kind::Inner),
                attribute("g", true, None),
                attribute("h", true, Some("0")),
                attribute("i", false, Some("")),
            ]
        );
    }
}
