//! Level 3: the trials are those of the manifest, and sealing its records again gives the same bundle.

use super::{PlannedTrial, Replanned, difference};
use crate::bundle::{
    Additions, Bundle, BundlePath, Circumstance, Fault, FileRef, Files, Limits, Moment, Tree, bag,
    capsule, format, in_bag_info, in_payload, in_result_half, seal_with,
};
use crate::digest::{Sha256Digest, TrialKey};
use crate::studies::TrialRecord;

/// What level 3 finds.
#[derive(Debug, Default)]
pub(super) struct Derived {
    /// What does not follow from the manifest, the inputs and the records.
    pub(super) faults: Vec<Fault>,
    /// What this program could not derive, so that the level is not passed.
    pub(super) obstacles: Vec<Fault>,
    /// What is worth knowing.
    pub(super) notes: Vec<Fault>,
    /// What nothing was held against though another program might, in a few words each.
    pub(super) unchecked: Vec<String>,
    /// What nothing can be held against, in a few words each.
    pub(super) circumstances: Vec<&'static str>,
}

/// Holds the bundle against what its manifest, inputs, records and stated circumstances give when sealed again.
pub(super) fn check(bundle: &Bundle, replanned: &dyn Replanned) -> Derived {
    let mut found = Derived { faults: trials(bundle, &replanned.trials()), ..Derived::default() };
    let content = match replanned.content() {
        Ok(content) => content,
        // Records of other trials need not make results.
        Err(_) if !found.faults.is_empty() => return found,
        Err(problem) => {
            let path = BundlePath::payload(format::TRIALS);
            found.faults.push(Fault::new(path, "records that make results", problem.to_string()));
            return found;
        }
    };
    // What describes the bundle follows from the same and from the circumstances, which the metadata state in every
    // form of a bundle: engine and format say how, whatever version of the program was at work.
    let told = bundle.circumstance();
    if told.is_none() {
        let metadata = BundlePath::payload(format::METADATA);
        let expected =
            "the run's version, begin, end and environment, as a crate of this format tells them";
        found.faults.push(Fault::new(metadata, expected, "none that can be read"));
    }
    let circumstance = told.clone().unwrap_or(Circumstance::reproducible(Moment(0)));
    let own = bundle.capsule().map(|_| capsule::own());
    let derived = match seal_with(
        &content,
        &circumstance,
        Additions { source: own.as_ref(), limits: UNLIMITED },
    ) {
        Ok(sealed) => sealed,
        Err(problem) => {
            let expected = "content that can be sealed";
            found.faults.push(Fault::new(BundlePath::payload(""), expected, problem.to_string()));
            return found;
        }
    };
    let mut differing = files(bundle.files(), derived.files(), in_result_half);
    let same_version = circumstance.version == format::VERSION;
    if let (Some(path), false) = (bundle.capsule(), same_version) {
        let (expected, version) =
            (format!("the source of reenact {}", format::VERSION), &circumstance.version);
        let fault =
            Fault::new(path, expected, format!("one that claims to be of reenact {version}"));
        let hint = "this program can compare its own source only: build nothing from this one before you have read it";
        found.obstacles.push(fault.hint(hint));
        found.unchecked.push("the engine's source is not checked".to_owned());
    } else {
        differing.extend(source(bundle.tree(), &derived.tree));
    }
    // Each holds digests or sizes of those before it, and says something new only where those are as they should be. A foreign
    // source changes the metadata that lists it.
    let judged = told.is_some() && (bundle.capsule().is_none() || same_version);
    for part in [&DESCRIPTIONS[..], &[format::METADATA, format::PREVIEW]] {
        if differing.is_empty() && judged {
            differing = files(bundle.files(), derived.files(), |path| part.contains(&path));
        }
    }
    if !judged {
        found.unchecked.push("the description is not checked".to_owned());
    }
    if differing.is_empty() {
        differing.extend(identifier(bundle));
    }
    found.faults.extend(differing);
    if bundle.circumstance_files().next().is_some() {
        let path = BundlePath::payload(format::CIRCUMSTANCES);
        let fault = Fault::new(
            path,
            "what follows from the records",
            "what the machine of the run measured, and verdicts on it",
        );
        let hint = "no part of the results; checksums hold it, nothing can derive it again";
        found.notes.push(fault.hint(hint));
        found.circumstances.push("wall times and verdicts on them");
    }
    // Without a host the time is SOURCE_DATE_EPOCH's, which says nothing of the run.
    if !circumstance.environment.is_empty() {
        found.circumstances.push("time and host of the run");
    }
    found
}

/// Checks the identifier in the bag's facts, which follows from the digests of the payload.
fn identifier(bundle: &Bundle) -> Option<Fault> {
    let info = bundle.tree().get(format::BAG_INFO).map(|bytes| bag::BagInfo::parse(bytes))?;
    let right = in_bag_info(bundle, None);
    let (expected, found) = (right.get(bag::IDENTIFIER)?, info.get(bag::IDENTIFIER)?);
    (expected != found).then(|| {
        let expected = format!("{}: {expected}, as the payload gives", bag::IDENTIFIER);
        Fault::new(format::BAG_INFO, expected, found)
    })
}

/// What says how to read, cite and check the rest.
const DESCRIPTIONS: [&str; 7] = [
    format::INDEX,
    format::README,
    format::LICENSE,
    format::DATA_PACKAGE,
    format::DICTIONARY,
    format::CITATION,
    format::ZENODO,
];

/// Holds planned trials against records: one fault a condition, however many of its trials differ.
fn trials(bundle: &Bundle, planned: &[PlannedTrial]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut slugs: Vec<&str> = Vec::new();
    for trial in planned {
        if slugs.last() != Some(&&*trial.slug) {
            slugs.push(&trial.slug);
        }
    }
    let sealed: Vec<&str> = bundle.conditions().iter().map(|c| c.slug.as_str()).collect();
    if slugs != sealed {
        faults.push(Fault::new(
            BundlePath::payload(format::RESOLVED),
            format!("the conditions that the manifest plans: {}", slugs.join(", ")),
            sealed.join(", "),
        ));
    }
    for slug in sealed {
        let planned: Vec<_> = planned.iter().filter(|trial| *trial.slug == *slug).collect();
        let path = BundlePath::records(slug);
        let count = bundle.record_count(slug);
        if planned.len() != count {
            let expected = format!("{} trials, as the manifest plans", planned.len());
            faults.push(Fault::new(&path, expected, count.to_string()));
        }
        // One record at a time: those of a forger may be large.
        let (mut first, mut more) = (None, 0);
        let mut next = planned.iter();
        bundle.record_lines(slug, |line| {
            let Some(planned) = next.next() else { return false };
            let record = TrialRecord::from_line(line.text).ok();
            let found = record.map(|record| (record.key, record.trial));
            if found != Some((planned.key, planned.trial)) {
                if first.is_none() {
                    first = Some((line.place(), planned, found));
                } else {
                    more += 1;
                }
            }
            true
        });
        if let Some((place, planned, found)) = first {
            let named =
                |(key, trial): (TrialKey, u32)| format!("trial {trial} with key {}", key.short());
            let found = found.map_or("no record".to_owned(), named);
            let more = if more > 0 { format!(", and {more} more") } else { String::new() };
            let expected =
                format!("{}, as the manifest plans", named((planned.key, planned.trial)));
            let hint = "the manifest, an input, the seed or the record was changed after the run";
            faults.push(Fault::new(place, expected, format!("{found}{more}")).hint(hint));
        }
    }
    faults
}

/// Holds the engine's source, where the bundle holds it, against that of this very version.
fn source(found: &Tree, derived: &Tree) -> Vec<Fault> {
    let folder = BundlePath::payload(format::ENGINE);
    found
        .iter()
        .filter(|(path, bytes)| path.starts_with(&*folder) && derived.get(*path) != Some(bytes))
        .map(|(path, bytes)| {
            let expected = format!("the source that reenact {} was built from", format::VERSION);
            Fault::new(path, expected, format!("sha256:{}", Sha256Digest::of(bytes)))
                .hint("another source, or one of the same version that was changed: build nothing from it")
        })
        .collect()
}

/// Returns whether two files have the same bytes.
fn is_same(a: FileRef<'_>, b: FileRef<'_>) -> bool {
    match (a.held(), b.held()) {
        (Some(a), Some(b)) => a == b,
        _ => a.size() == b.size() && a.digest() == b.digest(),
    }
}

/// Whoever opened the bundle has decided how large it may be.
const UNLIMITED: Limits =
    Limits { entries: usize::MAX, bytes: u64::MAX, held: u64::MAX, ratio: u64::MAX };

/// Most bytes of a file whose first difference is looked for: of a larger one its digest says enough.
const MOST_READ: u64 = 48 << 20;

/// Finds payload files of `found` that differ from those of `derived`, among those whose path within the payload
/// `counts`.
fn files(found: Files<'_>, derived: Files<'_>, counts: impl Fn(&str) -> bool) -> Vec<Fault> {
    let counts = |path: &str| in_payload(path).is_some_and(&counts);
    let mut faults = Vec::new();
    for (path, expected) in derived.iter().filter(|(path, _)| counts(path)) {
        match found.get(path) {
            None => faults.push(Fault::new(path, "a file that follows from the records", "none")),
            Some(file) if is_same(file, expected) => {}
            Some(file) => {
                let (expected, found) = match (expected.whole(MOST_READ), file.whole(MOST_READ)) {
                    (Some(expected), Some(found)) => difference::first(path, &expected, &found),
                    _ => (
                        format!("{} bytes of sha256:{}", expected.size(), expected.digest()),
                        format!("{} bytes of sha256:{}", file.size(), file.digest()),
                    ),
                };
                faults.push(Fault::new(path, format!("{expected}, as the records give"), found));
            }
        }
    }
    for path in found.paths().filter(|path| counts(path) && derived.get(path).is_none()) {
        faults.push(Fault::new(
            path,
            "only files that follow from the records",
            "one that does not",
        ));
    }
    faults
}
