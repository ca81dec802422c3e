//! Text with `${expressions}` and `$(substitutions)` in it.

/// A piece of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece<'t> {
    /// Text as it stands.
    Text(&'t str),
    /// What stands within `${}`.
    Expression(&'t str),
    /// What stands within `$()`.
    Substitution(&'t str),
}

/// Cuts `text` into pieces; `$${` and `$$(` stand for `${` and `$(`.
///
/// # Errors
/// A piece without an end.
pub(super) fn pieces(text: &str) -> Result<Vec<Piece<'_>>, String> {
    let mut pieces = Vec::new();
    let (mut begin, mut at) = (0, 0);
    while let Some(dollar) = text[at..].find('$').map(|n| at + n) {
        let rest = &text[dollar + 1..];
        let dollars = rest.bytes().take_while(|b| *b == b'$').count();
        let (open, close) = match rest.as_bytes().get(dollars) {
            Some(b'{') => ('{', '}'),
            Some(b'(') => ('(', ')'),
            _ => {
                at = dollar + 1 + dollars;
                continue;
            }
        };
        if dollars > 0 {
            // One of them says that the others are meant as they stand.
            pieces.push(Piece::Text(&text[begin..dollar]));
            begin = dollar + 1;
            at = dollar + 1 + dollars + 1;
            continue;
        }
        let Some(length) = length_within(&rest[1..], open, close) else {
            return Err(format!("`{}` has no `{close}`", &text[dollar..]));
        };
        if begin < dollar {
            pieces.push(Piece::Text(&text[begin..dollar]));
        }
        let inner = &rest[1..=length];
        pieces.push(match open {
            '{' => Piece::Expression(inner),
            _ => Piece::Substitution(inner),
        });
        at = dollar + 1 + length + 2;
        begin = at;
    }
    if begin < text.len() {
        pieces.push(Piece::Text(&text[begin..]));
    }
    Ok(pieces)
}

/// Returns how long the text is up to the `close` that ends it.
fn length_within(text: &str, open: char, close: char) -> Option<usize> {
    let (mut depth, mut quote) = (0_usize, None);
    for (at, character) in text.char_indices() {
        match quote {
            Some(mark) if character == mark => quote = None,
            // An apostrophe within `$()` is one.
            None if open == '{' && matches!(character, '\'' | '"') => quote = Some(character),
            None if character == open => depth += 1,
            None if character == close && depth == 0 => return Some(at),
            None if character == close => depth -= 1,
            Some(_) | None => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_cut_at_its_dollars() {
        let cut = |text| pieces(text).unwrap();
        assert_eq!(
            cut("a${b}_$(arg c)"),
            [
                Piece::Text("a"),
                Piece::Expression("b"),
                Piece::Text("_"),
                Piece::Substitution("arg c")
            ]
        );
        assert_eq!(cut("${d['}']}"), [Piece::Expression("d['}']")]);
        assert_eq!(cut("$(eval f(1))"), [Piece::Substitution("eval f(1)")]);
        assert_eq!(cut("5 $ or $x"), [Piece::Text("5 $ or $x")]);
        assert_eq!(cut("a$${b}"), [Piece::Text("a"), Piece::Text("${b}")]);
        assert_eq!(pieces("a ${b").unwrap_err(), "`${b` has no `}`");
    }
}
