//! `--set PATH=VALUE`: changes the manifest's tree before it is checked, so that faults name the option.

use crate::document::{Diagnostic, Source, Tree};

/// Puts the YAML value of every `PATH=VALUE` where its path leads (`world.file`, `factors.prior.0` or
/// `factors.prior[0]`), the later ones over the earlier.
///
/// # Errors
/// Every override that is not `PATH=VALUE`, whose value is not YAML or whose path leads nowhere.
pub(super) fn apply(tree: &mut Tree, overrides: &[String]) -> Result<(), Vec<Diagnostic>> {
    let mut faults = Vec::new();
    for written in overrides {
        if let Err(found) = apply_one(tree, written) {
            faults.extend(found);
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

const OPTION: &str = "--set ";

fn apply_one(tree: &mut Tree, written: &str) -> Result<(), Vec<Diagnostic>> {
    let source = Source::new("command line", format!("{OPTION}{written}"));
    let fault = |start: usize, end: usize, message: &str| {
        vec![
            Diagnostic::error(&source, OPTION.len() + start..OPTION.len() + end, message)
                .label("expected PATH=VALUE")
                .help("for example `--set trials=3` or `--set world.file=../worlds/basic.yaml`"),
        ]
    };
    let Some((path, _)) = written.split_once('=') else {
        return Err(fault(0, written.len(), "an override has no `=`"));
    };
    // `a[0].b` and `a.0.b` are the same path.
    let mut steps = Vec::new();
    let mut begin = 0;
    for (at, character) in path.char_indices().chain([(path.len(), '.')]) {
        if !matches!(character, '.' | '[' | ']') {
            continue;
        }
        let closed = begin > 0 && path.as_bytes()[begin - 1] == b']';
        if at > begin {
            steps.push((&path[begin..at], OPTION.len() + begin..OPTION.len() + at));
        } else if !closed {
            return Err(fault(0, path.len(), "the path of an override has an empty step"));
        }
        begin = at + character.len_utf8();
    }
    tree.graft(&source, &steps, OPTION.len() + path.len() + 1)
}
