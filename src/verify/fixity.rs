//! Level 1: every listed file is there unchanged, and nothing else is.

use super::signature;
use crate::bundle::{Archive, Fault, FileRef, Form, bag, format, in_payload, is_tag_file};
use std::collections::BTreeMap;

/// Finds everything that breaks fixity.
pub(super) fn check(archive: &Archive) -> Vec<Fault> {
    let (tree, files) = (&archive.tree, archive.files());
    // A crate without its bag has no list but its own metadata, which level 2 holds against the files.
    if archive.form == Form::Crate {
        return Vec::new();
    }
    let mut faults = Vec::new();
    match tree.get(format::BAGIT).map(|bytes| String::from_utf8_lossy(bytes)) {
        Some(text) if text.lines().eq(bag::DECLARATION.lines()) => {}
        _ => faults.push(Fault::new(
            format::BAGIT,
            "the declaration of BagIt 1.0 in UTF-8",
            "another",
        )),
    }
    let mut listed = BTreeMap::new();
    // Where there is no list to hold files against, that alone is reported.
    let mut unread = Vec::new();
    for file in [format::MANIFEST, format::TAG_MANIFEST] {
        let Some(bytes) = tree.get(file) else {
            faults.push(Fault::new(file, "a list of digests", "no file"));
            unread.push(file);
            continue;
        };
        match bag::parse_manifest(file, bytes) {
            Ok(entries) => {
                for (path, digest) in entries {
                    let payload = in_payload(&path).is_some();
                    if payload == (file == format::MANIFEST) {
                        listed.insert(path, (digest, file));
                    } else {
                        let expected =
                            if payload { "tag files only" } else { "payload files only" };
                        faults.push(Fault::new(file, expected, format!("`{path}`")));
                    }
                }
            }
            Err(problems) => {
                faults.extend(problems);
                unread.push(file);
            }
        }
    }
    for (path, (digest, file)) in &listed {
        match files.get(path).map(FileRef::digest) {
            None => faults.push(Fault::new(path, format!("a file, as {file} lists it"), "none")),
            Some(found) if found != *digest => faults.push(Fault::new(
                path,
                format!("sha256:{digest}, as {file} says"),
                format!("sha256:{found}"),
            )),
            Some(_) => {}
        }
    }
    for path in files.paths() {
        let exempt = path == format::TAG_MANIFEST || format::SIGNATURES.contains(&path.as_str());
        let list = if in_payload(path).is_some() { format::MANIFEST } else { format::TAG_MANIFEST };
        if !exempt && !unread.contains(&list) && !listed.contains_key(path) {
            let expected = format!("only files that {list} lists");
            faults.push(Fault::new(path, expected, "an unlisted file"));
        }
    }
    if tree.contains_key("fetch.txt") {
        faults.push(Fault::new(
            "fetch.txt",
            "a bundle that holds all its files",
            "a list of files to fetch",
        ));
    }
    // Those that no list names have been reported.
    for path in listed.keys().filter(|path| in_payload(path).is_none()) {
        if !is_tag_file(path) && path != "fetch.txt" {
            let expected = "only the tag files that docs/bundle-format.md lists";
            let hint = "a bundle is data: whatever it holds beside them, do not run it";
            faults.push(Fault::new(path, expected, "another file").hint(hint));
        }
    }
    faults.extend(signature::unreadable(tree));
    faults
}
