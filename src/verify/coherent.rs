//! Level 2: the crate's metadata, the bag's facts, the resolved study, the inputs and the records agree.

use crate::bundle::{
    Bundle, BundlePath, Fault, Files, RecordLine, bag, class_of, format, in_bag_info as in_bag,
    in_payload, is_version, results_digest_of,
};
use crate::digest::{FileDigest, Sha256Digest, TrialKey};
use crate::json;
use crate::studies::TrialRecord;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Holds what the bag says of its payload and of the run against the payload: every label follows from it, so that
/// nothing rides along in what people take for our words.
pub(super) fn bag_facts(bundle: &Bundle) -> Vec<Fault> {
    let Some(info) = bundle.tree().get(format::BAG_INFO).map(|bytes| bag::BagInfo::parse(bytes))
    else {
        return Vec::new();
    };
    // A crate that lost its bag was bagged again, maybe by another version, and says nothing of the run there.
    let told = bundle.circumstance().filter(|_| info.tells_circumstances());
    let mut right = in_bag(bundle, told.as_ref());
    if told.is_none() {
        // Metadata that say nothing are reported as a fault of their own.
        right.keep_circumstances(&info);
    }
    if let Some(agent) = info.get(bag::AGENT).filter(|agent| told.is_none() && is_agent(agent)) {
        right.set(bag::AGENT, agent);
    }
    right.set("Bundle-Format", &bundle.format().to_string());
    // Made of all digests, so level 3 has something to say of it.
    if let Some(uuid) = info.get(bag::IDENTIFIER).filter(|uuid| is_uuid(uuid)) {
        right.set(bag::IDENTIFIER, uuid);
    }
    info.faults(&right)
}

fn is_uuid(text: &str) -> bool {
    text.strip_prefix("urn:uuid:").is_some_and(|uuid| {
        uuid.len() == 36 && uuid.bytes().all(|b| b.is_ascii_hexdigit() || b == b'-')
    })
}

/// Returns whether `text` names a version of this program and nothing else.
fn is_agent(text: &str) -> bool {
    let version = text.strip_prefix("reenact ").and_then(|rest| rest.split_once(' '));
    version
        .is_some_and(|(version, home)| is_version(version) && home == format!("<{}>", format::HOME))
}

/// Holds digests and sizes in the crate's metadata against the files, in both directions.
pub(super) fn crate_metadata(files: Files<'_>) -> Vec<Fault> {
    let metadata = BundlePath::payload(format::METADATA);
    let graph = files
        .tree
        .get(&*metadata)
        .ok_or_else(|| "no file".to_owned())
        .and_then(|bytes| json::read::<Value>(bytes).map_err(|e| e.to_string()))
        .and_then(|mut document| match document.get_mut("@graph").map(Value::take) {
            Some(Value::Array(entities)) => Ok(entities),
            _ => Err("no graph".to_owned()),
        });
    let graph = match graph {
        Ok(graph) => graph,
        Err(found) => return vec![Fault::new(metadata, "an RO-Crate's metadata", found)],
    };
    let mut faults = Vec::new();
    let mut described = BTreeSet::new();
    for entity in &graph {
        let text = |key: &str| entity.get(key).and_then(Value::as_str).unwrap_or_default();
        let id = text("@id");
        if id == "#results-digest" {
            let expected = format!("sha256:{}", results_digest_of(files));
            if text("value") != expected {
                faults.push(Fault::new(
                    &metadata,
                    format!("results digest {expected}"),
                    text("value"),
                ));
            }
        }
        let is_file = match entity.get("@type") {
            Some(Value::Array(kinds)) => kinds.iter().any(|kind| kind == "File"),
            kind => kind.is_some_and(|kind| kind == "File"),
        };
        if !is_file {
            continue;
        }
        let path = BundlePath::payload(id);
        match files.get(&path) {
            None => faults.push(Fault::new(&path, "a file, as the crate describes it", "none")),
            Some(file) => {
                let (digest, size) = (file.digest().hex(), file.size().to_string());
                for (key, truth) in [("sha256", digest), ("contentSize", size)] {
                    if text(key) != truth {
                        let said = if text(key).is_empty() { "nothing" } else { text(key) };
                        let expected = format!("{key} {truth} for `{id}`, as the file is");
                        faults.push(Fault::new(&metadata, expected, said));
                    }
                }
            }
        }
        described.insert(path);
    }
    let described: BTreeSet<&str> = described.iter().map(|path| &**path).collect();
    for path in files.paths() {
        let Some(within) = in_payload(path) else { continue };
        let own = [format::METADATA, format::PREVIEW].contains(&within);
        if !own && !described.contains(&**path) {
            faults.push(Fault::new(
                path,
                "a file that the crate describes",
                "one that it does not",
            ));
        }
    }
    faults
}

/// Holds the resolved study against inputs and records.
pub(super) fn contents(bundle: &Bundle) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut known = BTreeSet::new();
    for input in bundle.inputs() {
        let path = BundlePath::payload(&input.path);
        let digest = bundle.tree().get(&*path).map(|b| FileDigest(Sha256Digest::of(b)));
        if digest != Some(input.sha256) {
            faults.push(Fault::new(
                &path,
                format!(
                    "sha256:{}, as the resolved study says of `{}`",
                    input.sha256, input.as_written
                ),
                digest.map_or("no file".to_owned(), |digest| format!("sha256:{digest}")),
            ));
        }
        known.insert(String::from(path));
    }
    let mut keys = Keys::default();
    for condition in bundle.conditions() {
        let path = BundlePath::records(&condition.slug);
        if !known.insert(String::from(&path)) {
            faults.push(Fault::new(
                BundlePath::payload(format::RESOLVED),
                "every condition once",
                format!("`{}` again", condition.slug),
            ));
            continue;
        }
        known.extend(bundle.record_parts(&condition.slug).map(|(path, _)| path));
        let count = bundle.record_count(&condition.slug);
        if count != condition.trials {
            let expected = format!("{} records, as the resolved study says", condition.trials);
            faults.push(Fault::new(&path, expected, count.to_string()));
        }
        for (path, file) in bundle.record_parts(&condition.slug) {
            if file.last_byte().is_some_and(|last| last != b'\n') {
                let hint = "the file may have been cut short";
                faults.push(Fault::new(&path, "a line feed at its end", "none").hint(hint));
            }
        }
        faults.extend(records(bundle, &condition.slug, &path, &mut keys));
    }
    for path in bundle.files().paths() {
        let within = in_payload(path);
        let claimed = within.is_some_and(|within| {
            [format::INPUTS, format::TRIALS].iter().any(|folder| within.starts_with(folder))
        });
        if claimed && !known.contains(path) {
            faults.push(Fault::new(
                path,
                "a file that the resolved study names",
                "one that it does not",
            ));
        } else if within.is_some() && class_of(bundle, path).is_none() {
            let hint =
                "docs/bundle-format.md lists what a bundle holds; it is data, so run nothing of it";
            let fault = Fault::new(path, "a file of a bundle", "one of no class");
            faults.push(fault.hint(hint));
        }
    }
    faults
}

/// Faults of one file that are told; after so many it is clear that it is none of ours.
const MOST_FAULTS: usize = 100;

/// Checks the records of one condition: each whole, in its place, and under a key of its own.
fn records(bundle: &Bundle, slug: &str, path: &BundlePath, keys: &mut Keys) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut next = 0;
    bundle.record_lines(slug, |line| {
        if faults.len() >= MOST_FAULTS {
            faults.push(Fault::new(path, "records", "too many faults to tell them all"));
            return false;
        }
        let place = line.place();
        let record = match TrialRecord::from_line(line.text) {
            Ok(record) => record,
            Err(problem) => {
                faults.push(Fault::new(place, "a trial record", problem.to_string()));
                next += 1;
                return true;
            }
        };
        if record.to_line() != line.text {
            faults.push(Fault::new(&place, "canonical JSON", "the same record spelt otherwise"));
        }
        if record.condition.slug() != slug {
            let expected = format!("a record of the condition `{slug}`");
            faults.push(Fault::new(
                &place,
                expected,
                format!("one of `{}`", record.condition.slug()),
            ));
        }
        // A shard or a selection may leave trials out, never change their order.
        let in_order =
            if bundle.is_partial() { record.trial >= next } else { record.trial == next };
        if !in_order {
            faults.push(Fault::new(
                &place,
                format!("trial {next}"),
                format!("trial {}", record.trial),
            ));
        }
        next = record.trial.saturating_add(1);
        if let Some(other) = keys.enter(record.key, line) {
            faults.push(Fault::new(&place, "a key of its own", format!("that of {other}")));
        }
        true
    });
    faults
}

/// The keys of all records, and where each stands: in few bytes, since there may be millions.
#[derive(Default)]
struct Keys {
    paths: Vec<String>,
    places: BTreeMap<TrialKey, (u32, u32)>,
}

impl Keys {
    /// Enters the key of the record in `line`; returns where it stands already, if it does.
    fn enter(&mut self, key: TrialKey, line: RecordLine<'_>) -> Option<String> {
        if self.paths.last().is_none_or(|path| path != line.path) {
            self.paths.push(line.path.to_owned());
        }
        // Beyond four thousand million nobody counts.
        let short = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let place = (short(self.paths.len() - 1), short(line.number));
        let (path, number) = self.places.insert(key, place)?;
        Some(format!("{}:{number}", self.paths[path as usize]))
    }
}
