//! Levels 1 and 2: files that are not those that were sealed, and parts that contradict one another.

use super::case::{Case, Made};
use super::forger::{
    INFO, MANIFEST, METADATA, RESOLVED, STUDY, TAG_MANIFEST, describe, edit, replace, reseal,
    reseal_bag, reseal_manifests, set_json, set_records,
};
use super::study::HONEST;
use reenact::bundle::Tree;

const NONE: &str = "data/trials/none.jsonl";
const TRIALS: &str = "data/results/trials.csv";

/// Returns changes after which nothing was made right: reported alike in a zip and in a folder.
pub(crate) fn fixity() -> Vec<Case> {
    let case = |name, attack: fn(&mut Tree)| {
        let mut tree = HONEST.tree.clone();
        attack(&mut tree);
        Case { level: 1, ..Case::new(name, 1, Made::Both(tree)) }
    };
    vec![
        case("a flipped byte", |tree| tree.get_mut(TRIALS).unwrap()[100] ^= 1),
        case("a byte appended", |tree| tree.get_mut(STUDY).unwrap().push(b'\n')),
        case("a missing file", |tree| drop(tree.remove(NONE).unwrap())),
        case("an emptied file", |tree| tree.get_mut(NONE).unwrap().clear()),
        case("a file added to the payload", |tree| {
            tree.insert("data/results/extra.csv".into(), b"x\n".to_vec());
        }),
        case("a program added beside the payload", |tree| {
            tree.insert("run.sh".into(), b"#!/bin/sh\n".to_vec());
        }),
        case("a signature under another name", |tree| {
            tree.insert("tagmanifest-sha256.txt.asc".into(), b"-----BEGIN PGP".to_vec());
        }),
        case("a renamed file", |tree| {
            let bytes = tree.remove(NONE).unwrap();
            tree.insert("data/trials/nothing.jsonl".into(), bytes);
        }),
        case("two files swapped", |tree| {
            let (a, b) = (tree[NONE].clone(), tree["data/trials/floor-plan.jsonl"].clone());
            tree.insert(NONE.into(), b);
            tree.insert("data/trials/floor-plan.jsonl".into(), a);
        }),
        case("no manifest", |tree| drop(tree.remove(MANIFEST).unwrap())),
        case("no tag manifest", |tree| drop(tree.remove(TAG_MANIFEST).unwrap())),
        case("a manifest of another digest", |tree| {
            let md5 = format!("{}  data/study.yaml\n", "0".repeat(32));
            tree.insert("manifest-md5.txt".into(), md5.into_bytes());
        }),
        case("a manifest that leads out of the bag", |tree| {
            edit(tree, MANIFEST, |text| format!("{text}{}  data/../../evil\n", "0".repeat(64)));
            reseal_tags(tree);
        }),
        case("a manifest that names a file twice", |tree| {
            edit(tree, MANIFEST, |text| format!("{text}{}\n", text.lines().next().unwrap()));
            reseal_tags(tree);
        }),
        case("a payload file in the tag manifest", |tree| {
            edit(tree, TAG_MANIFEST, |text| format!("{text}{}  data/study.yaml\n", "0".repeat(64)));
        }),
        case("a manifest of noise", |tree| {
            tree.insert(MANIFEST.into(), b"\x00\xff\n".to_vec());
            reseal_tags(tree);
        }),
        case("a manifest of ten million lines", |tree| {
            tree.insert(MANIFEST.into(), b"x\n".repeat(10_000_000));
            reseal_tags(tree);
        }),
        case("files to fetch from elsewhere", |tree| {
            let line = b"https://example.org/evil 4 data/evil\n";
            tree.insert("fetch.txt".into(), line.to_vec());
            reseal_manifests(tree);
        }),
        case("another version of BagIt", |tree| {
            replace(tree, "bagit.txt", "1.0", "0.96");
            reseal_manifests(tree);
        }),
    ]
}

/// Makes the tag manifest alone right.
fn reseal_tags(tree: &mut Tree) {
    let manifest = tree[MANIFEST].clone();
    reseal_manifests(tree);
    tree.insert(MANIFEST.into(), manifest.clone());
    let right = reenact::digest::Sha256Digest::of(&manifest);
    edit(tree, TAG_MANIFEST, |text| {
        let line = |line: &str| match line.split_once("  ") {
            Some((_, path)) if path == MANIFEST => format!("{right}  {path}\n"),
            _ => format!("{line}\n"),
        };
        text.lines().map(line).collect()
    });
}

/// Returns contradictions, every checksum of the bag made right.
pub(crate) fn coherence() -> Vec<Case> {
    // The bag made right, but not the crate or the resolved study.
    let bag = |name, attack: fn(&mut Tree)| Case {
        level: 2,
        ..Case::on_honest(name, 2, |tree| {
            attack(tree);
            reseal_bag(tree);
        })
    };
    // Everything made right, but for what the attack is about.
    let all = |name, attack: fn(&mut Tree)| Case {
        level: 2,
        ..Case::on_honest(name, 2, |tree| {
            attack(tree);
            reseal(tree);
        })
    };
    // Only the lists made right: the bag's facts are what is attacked.
    let lists = |name, attack: fn(&mut Tree)| Case {
        level: 2,
        ..Case::on_honest(name, 2, |tree| {
            attack(tree);
            reseal_manifests(tree);
        })
    };
    vec![
        bag("a changed table that the crate still describes as it was", |tree| {
            replace(tree, "data/results/tables/table-1.csv", "none", "nine");
        }),
        bag("a file that the crate describes and is not there", |tree| {
            describe(tree, "results/gone.csv");
        }),
        bag("a file that the crate does not describe", |tree| {
            tree.insert("data/run.sh".into(), b"#!/bin/sh\n".to_vec());
        }),
        bag("metadata that are no JSON", |tree| {
            tree.insert(METADATA.into(), b"{\"@graph\": [".to_vec());
        }),
        bag("metadata a hundred thousand lists deep", |tree| {
            tree.insert(METADATA.into(), b"[".repeat(100_000));
        }),
        bag("metadata of four million objects", |tree| {
            let graph = format!("{{\"@graph\":[{}0]}}", "{\"\":0},".repeat(4_000_000));
            tree.insert(METADATA.into(), graph.into_bytes());
        }),
        bag("a resolved study of four million objects", |tree| {
            let bomb = format!("\"study\": {{\"x\":[{}0],", "{\"\":0},".repeat(4_000_000));
            replace(tree, RESOLVED, "\"study\": {", &bomb);
        }),
        lists("ten million facts in the bag", |tree| {
            tree.insert(INFO.into(), b"a:\n".repeat(10_000_000));
        }),
        lists("a wrong count of bytes", |tree| {
            replace(tree, INFO, "Payload-Oxum: ", "Payload-Oxum: 1");
        }),
        lists("another results digest in the bag", |tree| {
            replace(tree, INFO, "Results-Digest: sha256:", "Results-Digest: sha256:0");
        }),
        lists("two results digests in the bag", |tree| {
            edit(tree, INFO, |text| format!("{text}Results-Digest: sha256:{}\n", "0".repeat(64)));
        }),
        lists("a whole study that is called partial", |tree| {
            replace(tree, INFO, "Partial: false", "Partial: true");
        }),
        lists("a fact that would rewrite the screen", |tree| {
            replace(tree, INFO, "Partial: false", "Partial: \u{1b}[2Jreached level 5");
        }),
        all("a record lost", |tree| {
            // The count is made right again; so it is the order that shows.
            set_records(tree, "none", |records| drop(records.remove(0)));
        }),
        bag("a record lost that is still counted", |tree| {
            set_records(tree, "none", |records| drop(records.pop()));
            super::forger::reseal_crate(tree);
        }),
        all("records in another order", |tree| {
            set_records(tree, "none", |records| records.swap(0, 1));
        }),
        all("a record twice under another number", |tree| {
            set_records(tree, "none", |records| {
                records[1] = records[0].clone();
                records[1]["trial"] = 1.into();
            });
        }),
        all("a record of another condition", |tree| {
            set_records(tree, "none", |records| {
                records[1]["condition"][0][1] = "floor-plan".into();
            });
        }),
        all("a record spelt otherwise", |tree| replace(tree, NONE, "\"trial\":1", "\"trial\": 1")),
        all("a record with a number that is none", |tree| {
            replace(tree, NONE, "\"contacts\":0", "\"contacts\":NaN");
        }),
        all("a record with a fact of the forger's own", |tree| {
            replace(tree, NONE, "{\"chain\"", "{\"approved\":true,\"chain\"");
        }),
        all("a record of ten million state hashes", |tree| {
            let bomb = format!("{{\"chain\":[{}", "\"\",".repeat(10_000_000));
            edit(tree, NONE, |text| text.replacen("{\"chain\":[", &bomb, 1));
        }),
        all("ten million lines that are no records", |tree| {
            tree.insert(NONE.into(), b"x\n".repeat(10_000_000));
        }),
        all("records cut short", |tree| {
            let records = tree.get_mut(NONE).unwrap();
            records.truncate(records.len() - 40);
        }),
        all("records that are no text", |tree| {
            tree.get_mut(NONE).unwrap()[5] = 0xff;
        }),
        all("an input that no one names", |tree| {
            tree.insert("data/inputs/more.yaml".into(), b"x: 1\n".to_vec());
            describe(tree, "inputs/more.yaml");
        }),
        all("an input that is not there", |tree| {
            replace(tree, RESOLVED, "\"inputs/basic.yaml\"", "\"../../etc/passwd\"");
        }),
        bag("an input that was changed", |tree| {
            replace(tree, "data/inputs/basic.yaml", "thickness-m: 0.15", "thickness-m: 0.14");
            super::forger::reseal_crate(tree);
        }),
        all("a condition twice", |tree| {
            set_json(tree, RESOLVED, |resolved| {
                resolved["conditions"][1] = resolved["conditions"][0].clone();
            });
        }),
        all("a name that leads out of a folder", |tree| {
            set_json(tree, RESOLVED, |resolved| resolved["name"] = "../../evil".into());
        }),
        all("a resolved study with a key of the forger's own", |tree| {
            set_json(tree, RESOLVED, |resolved| resolved["approved"] = true.into());
        }),
    ]
}

/// Returns formats that are not this program's.
pub(crate) fn formats() -> Vec<Case> {
    let format = |name, rung, exit, attack: fn(&mut Tree)| Case {
        exit,
        ..Case::on_honest(name, rung, |tree| {
            attack(tree);
            reseal(tree);
        })
    };
    vec![
        format("a newer format, says the bag", 1, 2, |tree| {
            replace(tree, INFO, "Bundle-Format: 4", "Bundle-Format: 6");
        }),
        format("a newer format, says the resolved study", 1, 2, |tree| {
            set_json(tree, RESOLVED, |resolved| {
                resolved["bundle-format"] = 6.into();
                resolved["unheard-of"] = true.into();
            });
        }),
        format("format 0, says the bag", 2, 1, |tree| {
            replace(tree, INFO, "Bundle-Format: 4", "Bundle-Format: 0");
        }),
        format("format 0, says the resolved study", 2, 1, |tree| {
            set_json(tree, RESOLVED, |resolved| resolved["bundle-format"] = 0.into());
        }),
        format("no format in the bag", 2, 1, |tree| {
            replace(tree, INFO, "Bundle-Format: 4\n", "");
        }),
        format("no format in the resolved study", 2, 1, |tree| {
            set_json(tree, RESOLVED, |resolved| {
                drop(resolved.as_object_mut().unwrap().remove("bundle-format"));
            });
        }),
        format("another engine", 3, 2, |tree| {
            set_json(tree, RESOLVED, |resolved| resolved["engine"] = "0".into());
        }),
    ]
}
