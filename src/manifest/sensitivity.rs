//! `sensitivity: FILE`: what `reenact vary` found at the other values of the assumptions, read and held against them.

use super::claims::as_judged;
use super::experiment::{Assumption, Robustness};
use super::input::InputKind;
use super::library::normalised;
use super::resolver::Resolver;
use crate::claims::Sensitivity;
use crate::claims::sensitivity::in_words;

/// Reads the file that the manifest names, where it names one; warns of every assumption of which it says something
/// else or nothing.
pub(super) fn read(resolver: &mut Resolver<'_>, assumptions: &[Assumption]) -> Option<Robustness> {
    const PLACE: &str = "/sensitivity";
    let path = resolver.doc.sensitivity.as_deref()?;
    let source = resolver.text(path, PLACE, InputKind::Robustness)?;
    let sensitivity = match Sensitivity::from_csv(&source.text) {
        Ok(sensitivity) => sensitivity,
        Err(problem) => {
            let fault = resolver.faults.fault(PLACE, format!("`{path}`: {problem}"));
            resolver.faults.push(fault.label("expected what `reenact vary` writes"));
            return None;
        }
    };
    let attempts = sensitivity.attempts();
    let mut stale = Vec::new();
    for assumption in assumptions {
        let chosen = in_words(&assumption.value);
        let of_it = || attempts.iter().filter(|attempt| attempt.setting == assumption.path);
        let untried = assumption.range.iter().map(in_words).find(|value| {
            !of_it().any(|attempt| attempt.chosen == chosen && attempt.tried == *value)
        });
        if let Some(value) = untried {
            let around = of_it().find(|attempt| attempt.chosen != chosen);
            stale.push(match around {
                Some(old) => {
                    format!("{} was tried around {}, it is {chosen} now", old.setting, old.chosen)
                }
                None => format!("{} was not tried at {value}", assumption.path),
            });
        }
    }
    let claims: Vec<String> = as_judged(resolver).into_iter().map(|claim| claim.id).collect();
    let gone = sensitivity.claims();
    let gone = gone.into_iter().filter(|id| !claims.iter().any(|claim| claim == id));
    stale.extend(gone.map(|id| format!("it judges `{id}`, which is no claim of this manifest")));
    let help = "`reenact vary` on this manifest writes it anew; a report shows what still fits";
    warn_of_age(resolver, (PLACE, path), &stale, help);
    Some(Robustness { as_written: normalised(path), table: sensitivity })
}

/// Warns that the file `path`, named at `place`, is out of date, where something of it is `stale`: the first in words, the others
/// counted.
pub(super) fn warn_of_age(
    resolver: &mut Resolver<'_>,
    (place, path): (&'static str, &str),
    stale: &[String],
    help: &str,
) {
    let Some(first) = stale.first() else { return };
    let more = match stale.len() - 1 {
        0 => String::new(),
        more => format!(" (and {more} more)"),
    };
    let fault = resolver.faults.fault(place, format!("`{path}` is out of date: {first}{more}"));
    resolver.faults.push(fault.warning().help(help));
}
