//! One thing wrong with a bundle, as plain data: `verify` turns it into a finding of a level.

/// Something that is not as it should be.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fault {
    /// The file, relative to the bag's root, or an archive's entry as it is spelt there.
    pub path: String,
    /// What should be there.
    pub expected: String,
    /// What is there.
    pub found: String,
    /// What it may mean or what to do next; empty where the two say it all.
    pub hint: String,
}

impl Fault {
    /// Creates a fault at `path`.
    pub fn new(
        path: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self {
            path: visible(&path.into()),
            expected: visible(&expected.into()),
            found: visible(&found.into()),
            hint: String::new(),
        }
    }

    /// Adds a hint.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }
}

/// Characters of a stranger's text that are shown.
const LONGEST: usize = 2000;

/// Writes `text` of unknown origin as a terminal may show it, cut where it is endless: control characters, which could
/// move the cursor and rewrite what was said, and those that turn the direction of writing stand as escapes. Line feeds
/// stay.
pub fn visible(text: &str) -> String {
    let turns = |c| matches!(c, '\u{61c}' | '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let mut shown = String::new();
    for (i, c) in text.chars().enumerate() {
        if i == LONGEST {
            shown.push_str("...");
            break;
        }
        if c != '\n' && (c.is_control() || turns(c)) {
            shown.extend(c.escape_unicode());
        } else {
            shown.push(c);
        }
    }
    shown
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: expected {}, found {}", self.path, self.expected, self.found)?;
        if !self.hint.is_empty() {
            write!(f, " ({})", self.hint)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_stranger_wrote_cannot_steer_the_terminal() {
        let fault = Fault::new("a\u{1b}[2Jb", "x\ty", "\u{202e}z\r");
        assert_eq!(fault.to_string(), "a\\u{1b}[2Jb: expected x\\u{9}y, found \\u{202e}z\\u{d}");
        assert_eq!(visible(&"x".repeat(5000)), "x".repeat(2000) + "...");
    }
}
