//! Just enough reading of Rust to know which paths the shipped part of a file names.

/// One token of a source file: an identifier, `::`, or a single other character.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) line: usize,
    pub(crate) text: String,
}

/// A path as named in a file, from the crate's root (`["crate", "sim", "Body"]`) or from a foreign crate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct NamedPath {
    pub(crate) line: usize,
    pub(crate) segments: Vec<String>,
}

/// The shipped part of a file.
#[derive(Debug)]
pub(crate) struct Shipped {
    pub(crate) tokens: Vec<Token>,
    /// Modules declared as `#[cfg(test)] mod name;`: their files are not shipped.
    pub(crate) test_modules: Vec<String>,
}

impl Shipped {
    /// Reads a file's text, without its comments, the inside of its literals and its `#[cfg(test)]` items.
    pub(crate) fn read(text: &str) -> Self {
        let tokens = tokens(&without_comments_and_literals(text));
        let (mut kept, mut test_modules) = (Vec::new(), Vec::new());
        let mut at = 0;
        while at < tokens.len() {
            if starts_with(&tokens[at..], &["#", "[", "cfg", "(", "test", ")", "]"]) {
                let begin = at + 7;
                at = end_of_item(&tokens, begin);
                let item: Vec<&str> = tokens[begin..at].iter().map(|t| t.text.as_str()).collect();
                if let [.., "mod", name, ";"] = item[..] {
                    test_modules.push(name.to_owned());
                }
            } else {
                kept.push(tokens[at].clone());
                at += 1;
            }
        }
        Self { tokens: kept, test_modules }
    }

    /// Returns every path with at least two segments, use trees written out; `super` and `self` resolved for a file
    /// that is the module `module` (empty for the crate's root).
    pub(crate) fn paths(&self, module: &[String]) -> Vec<NamedPath> {
        let mut paths = Vec::new();
        let mut at = 0;
        while at < self.tokens.len() {
            let before = at.checked_sub(1).map(|i| self.tokens[i].text.as_str());
            let in_use = before == Some("use");
            let begins = is_identifier(&self.tokens[at].text)
                && !matches!(before, Some("::" | "."))
                && (in_use || self.text(at + 1) == "::");
            if begins {
                at = self.tree(at, &[], &mut paths);
            } else {
                at += 1;
            }
        }
        for path in &mut paths {
            path.segments = absolute(&path.segments, module);
        }
        paths
    }

    fn text(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |t| &t.text)
    }

    /// Reads one use tree or path from `at`, and returns where it ends.
    fn tree(&self, mut at: usize, prefix: &[String], paths: &mut Vec<NamedPath>) -> usize {
        let line = self.tokens[at].line;
        let mut segments = prefix.to_vec();
        while is_identifier(self.text(at)) || self.text(at) == "*" {
            segments.push(self.text(at).to_owned());
            at += 1;
            if self.text(at) != "::" {
                break;
            }
            at += 1;
            if self.text(at) == "{" {
                at += 1;
                while at < self.tokens.len() && self.text(at) != "}" {
                    let named = is_identifier(self.text(at)) || self.text(at) == "*";
                    at = if named && self.text(at) != "as" {
                        self.tree(at, &segments, paths)
                    } else if self.text(at) == "as" {
                        at + 2
                    } else {
                        at + 1
                    };
                }
                return at + 1;
            }
        }
        paths.push(NamedPath { line, segments });
        at
    }
}

fn absolute(segments: &[String], module: &[String]) -> Vec<String> {
    let climbs = segments.iter().take_while(|s| *s == "super").count();
    let own = segments.first().is_some_and(|s| s == "self");
    if climbs == 0 && !own {
        return segments.to_vec();
    }
    // A module inside the file climbs out of itself first: such a path reaches less far than it seems to, never further.
    let base = &module[..module.len().saturating_sub(climbs)];
    let rest = &segments[climbs.max(usize::from(own))..];
    std::iter::once("crate".to_owned())
        .chain(base.iter().cloned())
        .chain(rest.iter().cloned())
        .collect()
}

fn is_identifier(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

fn starts_with(tokens: &[Token], texts: &[&str]) -> bool {
    tokens.len() >= texts.len() && tokens.iter().zip(texts).all(|(token, text)| token.text == *text)
}

/// Returns where the item that begins at `at` ends: after its `;` or its closing brace.
fn end_of_item(tokens: &[Token], mut at: usize) -> usize {
    let (mut braces, mut others) = (0_i32, 0_i32);
    while at < tokens.len() {
        match tokens[at].text.as_str() {
            "{" => braces += 1,
            "}" => {
                braces -= 1;
                let braced_use = tokens.get(at + 1).is_some_and(|t| t.text == ";");
                if braces == 0 && others == 0 && !braced_use {
                    return at + 1;
                }
            }
            "(" | "[" => others += 1,
            ")" | "]" => others -= 1,
            ";" if braces == 0 && others == 0 => return at + 1,
            _ => {}
        }
        at += 1;
    }
    at
}

fn tokens(code: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    for (number, line) in code.lines().enumerate() {
        let mut rest = line.trim_start();
        while let Some(first) = rest.chars().next() {
            let word = |c: char| c.is_alphanumeric() || c == '_';
            let length = if word(first) {
                rest.find(|c| !word(c)).unwrap_or(rest.len())
            } else if rest.starts_with("::") {
                2
            } else {
                first.len_utf8()
            };
            tokens.push(Token { line: number + 1, text: rest[..length].to_owned() });
            rest = rest[length..].trim_start();
        }
    }
    tokens
}

/// Returns the text with comments removed and literals emptied; line breaks stay, so that line numbers do.
fn without_comments_and_literals(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut kept = String::new();
    let mut at = 0;
    let looks = |at: usize, word: &str| {
        word.chars().enumerate().all(|(i, c)| chars.get(at + i) == Some(&c))
    };
    while at < chars.len() {
        let end = if looks(at, "//") {
            (at..chars.len()).find(|&i| chars[i] == '\n').unwrap_or(chars.len())
        } else if looks(at, "/*") {
            end_of_block_comment(&chars, at)
        } else if let Some(hashes) = raw_string(&chars, at) {
            let close = format!("\"{}", "#".repeat(hashes));
            let inside = at + 2 + hashes;
            (inside..chars.len())
                .find(|&i| looks(i, &close))
                .map_or(chars.len(), |i| i + 1 + hashes)
        } else if chars[at] == '"' {
            end_of_quoted(&chars, at, '"')
        } else if chars[at] == '\''
            && (chars.get(at + 1) == Some(&'\\') || chars.get(at + 2) == Some(&'\''))
        {
            end_of_quoted(&chars, at, '\'')
        } else {
            kept.push(chars[at]);
            at += 1;
            continue;
        };
        kept.push(' ');
        kept.extend(chars[at..end].iter().filter(|c| **c == '\n'));
        at = end;
    }
    kept
}

/// Returns the number of hashes, where a raw string begins at `at`.
fn raw_string(chars: &[char], at: usize) -> Option<usize> {
    let inside_word =
        at > 0 && (chars[at - 1].is_alphanumeric() && chars[at - 1] != 'b' || chars[at - 1] == '_');
    if chars[at] != 'r' || inside_word {
        return None;
    }
    let hashes = chars[at + 1..].iter().take_while(|c| **c == '#').count();
    (chars.get(at + 1 + hashes) == Some(&'"')).then_some(hashes)
}

fn end_of_quoted(chars: &[char], begin: usize, quote: char) -> usize {
    let mut at = begin + 1;
    while at < chars.len() && chars[at] != quote {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    (at + 1).min(chars.len())
}

fn end_of_block_comment(chars: &[char], begin: usize) -> usize {
    let (mut at, mut depth) = (begin, 0);
    while at + 1 < chars.len() {
        match (chars[at], chars[at + 1]) {
            ('/', '*') => (depth, at) = (depth + 1, at + 2),
            ('*', '/') if depth == 1 => return at + 2,
            ('*', '/') => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    chars.len()
}
