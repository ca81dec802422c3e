//! Level 3: the trials are those of the manifest, and sealing its records again gives the same bundle.

use super::{PlannedTrial, Replanned, difference};
use crate::bundle::{
    Additions, Bundle, Circumstance, Fault, Form, Moment, Tree, capsule, format, in_result_half,
    seal_with,
};
use crate::digest::{Sha256Digest, TrialKey};
use crate::studies::TrialRecord;

/// Everything that does not follow from the manifest, the inputs and the records; and what could not be judged.
pub(super) fn check(bundle: &Bundle, replanned: &dyn Replanned) -> (Vec<Fault>, Vec<Fault>) {
    let mut faults = trials(bundle, &replanned.trials());
    let content = match replanned.content() {
        Ok(content) => content,
        // Records of other trials need not make results.
        Err(_) if !faults.is_empty() => return (faults, Vec::new()),
        Err(problem) => {
            let path = format!("{}{}", format::PAYLOAD, format::TRIALS);
            faults.push(Fault::new(path, "records that make results", problem));
            return (faults, Vec::new());
        }
    };
    // The circumstance half is derived as well where the bag tells the circumstances and this version wrote it.
    let told = bundle.circumstance().filter(|c| c.version == format::VERSION);
    let circumstance = told.clone().unwrap_or(Circumstance::reproducible(Moment(0)));
    let own = bundle.capsule().map(|_| capsule::own());
    let described = format!("{}{}", format::PAYLOAD, format::DATA_PACKAGE);
    let additions =
        Additions { source: own.as_ref(), description: bundle.tree().contains_key(&described) };
    let derived = match seal_with(&content, &circumstance, additions) {
        Ok(sealed) => sealed.tree,
        Err(problem) => {
            faults.push(Fault::new(
                format::PAYLOAD,
                "content that can be sealed",
                problem.to_string(),
            ));
            return (faults, Vec::new());
        }
    };
    let mut differing = files(bundle.tree(), &derived, in_result_half);
    if told.is_some() {
        differing.extend(source(bundle.tree(), &derived));
    }
    // Each holds digests or sizes of those before it, and says something new only where those are as they should be.
    for part in [&DESCRIPTIONS[..], &[format::METADATA, format::PREVIEW]] {
        if differing.is_empty() && told.is_some() {
            differing = files(bundle.tree(), &derived, |path| part.contains(&path));
        }
    }
    faults.extend(differing);
    let untold = told.is_none().then(|| {
        let found = match bundle.form() {
            Form::Crate => "a crate without its bag".to_owned(),
            _ => bundle
                .circumstance()
                .map_or("none".to_owned(), |c| format!("those of reenact {}", c.version)),
        };
        Fault::new(
            format::BAG_INFO,
            format!("circumstances as reenact {} writes them", format::VERSION),
            found,
        )
        .hint(if bundle.capsule().is_some() {
            "metadata, preview and README were not derived again, and the sealed source was not compared; the results were"
        } else {
            "metadata, preview and README were not derived again; the results were"
        })
    });
    let measured = bundle.circumstance_files().next().map(|_| {
        Fault::new(
            format!("{}{}", format::PAYLOAD, format::CIRCUMSTANCES),
            "what follows from the records",
            "what the machine of the run measured, and verdicts on it",
        )
        .hint("no part of the results; checksums hold it, nothing can derive it again")
    });
    (faults, untold.into_iter().chain(measured).collect())
}

/// What says how to read, cite and check the rest.
const DESCRIPTIONS: [&str; 6] = [
    format::README,
    format::LICENSE,
    format::DATA_PACKAGE,
    format::DICTIONARY,
    format::CITATION,
    format::ZENODO,
];

/// Planned trials against records: one fault a condition, however many of its trials differ.
fn trials(bundle: &Bundle, planned: &[PlannedTrial]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut slugs: Vec<&str> = Vec::new();
    for trial in planned {
        if slugs.last() != Some(&trial.slug.as_str()) {
            slugs.push(&trial.slug);
        }
    }
    let sealed: Vec<&str> = bundle.conditions().iter().map(|c| c.slug.as_str()).collect();
    if slugs != sealed {
        faults.push(Fault::new(
            format!("{}{}", format::PAYLOAD, format::RESOLVED),
            format!("the conditions that the manifest plans: {}", slugs.join(", ")),
            sealed.join(", "),
        ));
    }
    for slug in sealed {
        let planned: Vec<_> = planned.iter().filter(|trial| trial.slug == slug).collect();
        let path = format!("{}{}", format::PAYLOAD, format::records_path(slug));
        let count = bundle.record_lines(slug).count();
        if planned.len() != count {
            let expected = format!("{} trials, as the manifest plans", planned.len());
            faults.push(Fault::new(&path, expected, count.to_string()));
        }
        // One record at a time: those of a forger may be large.
        let (mut first, mut more) = (None, 0);
        for (i, (planned, line)) in planned.iter().zip(bundle.record_lines(slug)).enumerate() {
            let found = TrialRecord::from_line(line).ok().map(|record| (record.key, record.trial));
            if found == Some((planned.key, planned.trial)) {
                continue;
            }
            if first.is_none() {
                first = Some((i, planned, found));
            } else {
                more += 1;
            }
        }
        if let Some((i, planned, found)) = first {
            let named =
                |(key, trial): (TrialKey, u32)| format!("trial {trial} with key {}", key.short());
            let found = found.map_or("no record".to_owned(), named);
            let more = if more > 0 { format!(", and {more} more") } else { String::new() };
            let expected =
                format!("{}, as the manifest plans", named((planned.key, planned.trial)));
            let hint = "the manifest, an input, the seed or the record was changed after the run";
            let place = format!("{path}:{}", i + 1);
            faults.push(Fault::new(place, expected, format!("{found}{more}")).hint(hint));
        }
    }
    faults
}

/// The engine's source, where the bundle holds it, against that of this very version.
fn source(found: &Tree, derived: &Tree) -> Vec<Fault> {
    let folder = format!("{}{}", format::PAYLOAD, format::ENGINE);
    found
        .iter()
        .filter(|(path, bytes)| path.starts_with(&folder) && derived.get(*path) != Some(bytes))
        .map(|(path, bytes)| {
            let expected = format!("the source that reenact {} was built from", format::VERSION);
            Fault::new(path, expected, format!("sha256:{}", Sha256Digest::of(bytes)))
                .hint("another source, or one of the same version that was changed: build nothing from it")
        })
        .collect()
}

/// Payload files of `found` that differ from those of `derived`, among those whose path within the payload `counts`.
fn files(found: &Tree, derived: &Tree, counts: impl Fn(&str) -> bool) -> Vec<Fault> {
    let counts = |path: &str| path.strip_prefix(format::PAYLOAD).is_some_and(&counts);
    let mut faults = Vec::new();
    for (path, expected) in derived.iter().filter(|(path, _)| counts(path)) {
        match found.get(path) {
            None => faults.push(Fault::new(path, "a file that follows from the records", "none")),
            Some(bytes) if bytes != expected => {
                let (expected, found) = difference::first(path, expected, bytes);
                faults.push(Fault::new(path, format!("{expected}, as the records give"), found));
            }
            Some(_) => {}
        }
    }
    for path in found.keys().filter(|path| counts(path) && !derived.contains_key(*path)) {
        faults.push(Fault::new(
            path,
            "only files that follow from the records",
            "one that does not",
        ));
    }
    faults
}
