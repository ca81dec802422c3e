//! The forger: changes something, then makes right whatever can be made right without running a trial.

use reenact::bundle::{
    Archive, Bundle, Circumstance, Form, Moment, Tree, assemble, results_digest, seal,
};
use reenact::digest::Sha256Digest;
use reenact::json;
use reenact::verify::plan_of;
use serde_json::Value;

pub(crate) const STUDY: &str = "data/study.yaml";
pub(crate) const RESOLVED: &str = "data/study.resolved.json";
pub(crate) const METADATA: &str = "data/ro-crate-metadata.json";
pub(crate) const INFO: &str = "bag-info.txt";
pub(crate) const MANIFEST: &str = "manifest-sha256.txt";
pub(crate) const TAG_MANIFEST: &str = "tagmanifest-sha256.txt";

/// Returns the text of a file.
pub(crate) fn text(tree: &Tree, path: &str) -> String {
    String::from_utf8(tree[path].clone()).unwrap()
}

/// Changes a file's text; the change must be one.
#[track_caller]
pub(crate) fn edit(tree: &mut Tree, path: &str, change: impl FnOnce(&str) -> String) {
    let old = text(tree, path);
    let new = change(&old);
    assert_ne!(new, old, "the edit must change {path}");
    tree.insert(path.to_owned(), new.into_bytes());
}

/// Replaces a piece of a file's text, everywhere.
#[track_caller]
pub(crate) fn replace(tree: &mut Tree, path: &str, from: &str, to: &str) {
    edit(tree, path, |text| text.replace(from, to));
}

/// Changes a cell of a CSV file without quoted fields, rows counted from 1.
#[track_caller]
pub(crate) fn set_cell(tree: &mut Tree, path: &str, row: usize, column: &str, value: &str) {
    edit(tree, path, |text| {
        let at = text.lines().next().unwrap().split(',').position(|c| c == column).unwrap();
        let line = |(i, line): (usize, &str)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if i == row {
                cells[at] = value;
            }
            cells.join(",") + "\n"
        };
        text.lines().enumerate().map(line).collect()
    });
}

/// Changes a file of canonical JSON.
#[track_caller]
pub(crate) fn set_json(tree: &mut Tree, path: &str, change: impl FnOnce(&mut Value)) {
    edit(tree, path, |text| {
        let mut value = serde_json::from_str(text).unwrap();
        change(&mut value);
        json::canonical(&value) + "\n"
    });
}

/// Changes the records of a condition, each one a line of canonical JSON.
#[track_caller]
pub(crate) fn set_records(tree: &mut Tree, slug: &str, change: impl FnOnce(&mut Vec<Value>)) {
    edit(tree, &format!("data/trials/{slug}.jsonl"), |text| {
        let mut records = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        change(&mut records);
        records.iter().map(|record| json::canonical(record) + "\n").collect()
    });
}

/// Adds an input that the study calls `as_written`, described by the crate and the resolved study.
pub(crate) fn add_input(tree: &mut Tree, as_written: &str, bytes: impl Into<Vec<u8>>) {
    tree.insert(format!("data/inputs/{as_written}"), bytes.into());
    let id = format!("inputs/{as_written}");
    set_json(tree, RESOLVED, |resolved| {
        let digest = Sha256Digest::of("").hex();
        let input = serde_json::json!({"as-written": as_written, "path": id, "sha256": digest});
        resolved["inputs"].as_array_mut().unwrap().push(input);
    });
    describe(tree, &id);
}

/// Adds a file to the crate's metadata.
pub(crate) fn describe(tree: &mut Tree, id: &str) {
    set_json(tree, METADATA, |metadata| {
        let entity = serde_json::json!({"@id": id, "@type": "File", "sha256": ""});
        metadata["@graph"].as_array_mut().unwrap().push(entity);
    });
}

/// Makes every digest, size and count right again, wherever it stands: digests of inputs and counts of records in the
/// resolved study, digests and sizes in the crate, the results digest in all texts, the bag's facts and manifests.
pub(crate) fn reseal(tree: &mut Tree) {
    let mut resolved: Value = serde_json::from_slice(&tree[RESOLVED]).unwrap();
    for input in resolved["inputs"].as_array_mut().unwrap() {
        let path = format!("data/{}", input["path"].as_str().unwrap());
        if let Some(bytes) = tree.get(&path) {
            input["sha256"] = Sha256Digest::of(bytes).hex().into();
        }
    }
    for condition in resolved["conditions"].as_array_mut().unwrap() {
        let path = format!("data/trials/{}.jsonl", condition["slug"].as_str().unwrap());
        if let Some(bytes) = tree.get(&path) {
            condition["trials"] =
                bytes.split(|b| *b == b'\n').filter(|l| !l.is_empty()).count().into();
        }
    }
    // Where nothing had to change, not a byte does.
    if resolved != serde_json::from_slice::<Value>(&tree[RESOLVED]).unwrap() {
        tree.insert(RESOLVED.into(), (json::canonical(&resolved) + "\n").into_bytes());
    }
    reseal_crate(tree);
    reseal_bag(tree);
}

/// Does the crate's part of [`reseal`].
pub(crate) fn reseal_crate(tree: &mut Tree) {
    let old = stated_results(tree);
    let (results, study) = (results_digest(tree).to_string(), Sha256Digest::of(&tree[RESOLVED]));
    for path in ["data/README.md", "data/ro-crate-preview.html", METADATA] {
        let new = text(tree, path).replace(&old, &results).replace(&old[..8], &results[..8]);
        tree.insert(path.to_owned(), new.into_bytes());
    }
    let mut metadata: Value = serde_json::from_slice(&tree[METADATA]).unwrap();
    for entity in metadata["@graph"].as_array_mut().unwrap() {
        let id = entity["@id"].as_str().unwrap_or_default().to_owned();
        let bytes = tree.get(&format!("data/{id}"));
        if id == "#study-digest" {
            entity["value"] = format!("sha256:{study}").into();
        } else if let (Some(bytes), true) = (bytes, entity.get("sha256").is_some()) {
            entity["sha256"] = Sha256Digest::of(bytes).hex().into();
            entity["contentSize"] = bytes.len().to_string().into();
        }
    }
    tree.insert(METADATA.into(), format!("{metadata:#}\n").into_bytes());
}

/// Does the bag's part of [`reseal`].
pub(crate) fn reseal_bag(tree: &mut Tree) {
    let is_payload = |path: &str| path.starts_with("data/");
    let payload: Vec<_> = tree.iter().filter(|(path, _)| is_payload(path)).collect();
    let octets: usize = payload.iter().map(|(_, bytes)| bytes.len()).sum();
    let study = tree.get(RESOLVED).map(Sha256Digest::of);
    let facts: String = text(tree, INFO)
        .lines()
        .map(|line| match line.split_once(": ") {
            Some(("Payload-Oxum", _)) => format!("Payload-Oxum: {octets}.{}\n", payload.len()),
            Some(("Results-Digest", _)) => {
                format!("Results-Digest: sha256:{}\n", results_digest(tree))
            }
            Some(("Study-Digest", _)) => format!("Study-Digest: sha256:{}\n", study.unwrap()),
            _ => format!("{line}\n"),
        })
        .collect();
    tree.insert(INFO.into(), facts.into_bytes());
    reseal_manifests(tree);
}

/// Writes the bag's two lists of digests.
pub(crate) fn reseal_manifests(tree: &mut Tree) {
    let lines = |tree: &Tree, wanted: &dyn Fn(&str) -> bool| -> String {
        let files = tree.iter().filter(|(path, _)| wanted(path));
        files
            .map(|(path, bytes)| [&Sha256Digest::of(bytes).hex(), "  ", path, "\n"].concat())
            .collect()
    };
    let manifest = lines(tree, &|path| path.starts_with("data/"));
    tree.insert(MANIFEST.into(), manifest.into_bytes());
    let tags = lines(tree, &|path| !path.starts_with("data/") && path != TAG_MANIFEST);
    tree.insert(TAG_MANIFEST.into(), tags.into_bytes());
}

fn stated_results(tree: &Tree) -> String {
    let info = text(tree, INFO);
    let line = info.lines().find_map(|line| line.strip_prefix("Results-Digest: sha256:"));
    line.unwrap().to_owned()
}

/// Makes the best forgery there is short of running the trials: the changed manifest and inputs are planned, every
/// record gets the key of its place in that plan, and the program itself derives all the rest from them and seals it.
pub(crate) fn rederive(tree: Tree) -> Tree {
    let bundle = Bundle::open(Archive::of(Form::Bag, tree)).unwrap();
    let (plan, selection) = plan_of(&bundle).unwrap();
    let mut records = bundle.records().unwrap();
    assert_eq!(records.len(), plan.trials.len());
    for (record, spec) in records.iter_mut().zip(&plan.trials) {
        record.key = spec.key;
    }
    let content = assemble::assemble(&plan, bundle.study_yaml(), &selection, &records).unwrap();
    seal(&content, &Circumstance::reproducible(Moment(1_600_000_000))).unwrap().tree
}
