//! Zips, written byte-identically and read in place without trust: nothing is ever unpacked to disk.
//!
//! Level 0 of verification is this module: whatever it hands out is safe to look at, however the archive was made, and
//! is what every other reader sees.

mod extra;
mod header;
mod layout;
mod told;
mod unpack;

use self::layout::Directory;
use self::told::Faults;
pub use self::told::told;
pub(super) use self::unpack::inflate;
use self::unpack::unpack;
use super::path::PAYLOAD;
use super::{BundlePath, Fault, Tree, format, in_payload, names};
use std::collections::BTreeSet;
use std::io::{Cursor, Write as _};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// How the files of a bundle are laid out in a zip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// One folder that holds the bag: what `run` writes.
    Bag,
    /// The bag at the archive's root.
    Flat,
    /// The payload alone at the archive's root: an RO-Crate without its bag.
    Crate,
}

/// What an archive may ask of us.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most entries.
    pub entries: usize,
    /// Most bytes of all files unpacked.
    pub bytes: u64,
    /// Most bytes unpacked for a byte of archive, beyond the first 32 MiB.
    pub ratio: u64,
}

impl Default for Limits {
    fn default() -> Self {
        // Checking takes up to five times the bytes, and is to take no more than 300 MB.
        Self { entries: 20_000, bytes: 48 << 20, ratio: 250 }
    }
}

/// What may be unpacked from any archive, however small: a blank map compresses a thousandfold.
const RATIO_ALLOWANCE: u64 = 32 << 20;

/// An opened archive or folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Archive {
    /// How it was laid out.
    pub form: Form,
    /// The files by their path in the bag; those of a bare crate stand under `data/` as well.
    pub tree: Tree,
}

/// Writes `tree` as a zip, `bagit.txt` first, then the other tag files, then the payload, each sorted.
///
/// Fixed dates, permissions and compression, and each file compressed in one piece: equal trees give equal bytes.
pub fn write(tree: &Tree, root: &str, form: Form) -> Vec<u8> {
    let mut order: Vec<(&String, &Vec<u8>)> = tree.iter().collect();
    order.sort_by_key(|(path, _)| (in_payload(path).is_some(), *path != format::BAGIT));
    let named = order.into_iter().filter_map(|(path, bytes)| {
        let name = match form {
            Form::Bag => format!("{root}/{path}"),
            Form::Flat => path.clone(),
            Form::Crate => in_payload(path)?.to_owned(),
        };
        Some((name, bytes))
    });
    let options =
        options().compression_method(CompressionMethod::Deflated).compression_level(Some(6));
    pack(named, options)
}

/// Writes `tree` below the folder `root` without compression, so that the bytes depend on the files alone.
pub(super) fn store(tree: &Tree, root: &str) -> Vec<u8> {
    let named = tree.iter().map(|(path, bytes)| (format!("{root}/{path}"), bytes));
    pack(named, options().compression_method(CompressionMethod::Stored))
}

/// Returns the options that make an archive depend on nothing but its files.
fn options() -> SimpleFileOptions {
    SimpleFileOptions::default().last_modified_time(DateTime::default()).unix_permissions(0o644)
}

fn pack<'a>(
    files: impl Iterator<Item = (String, &'a Vec<u8>)>,
    options: SimpleFileOptions,
) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(name, options).expect("a tree's names are unique and short");
        zip.write_all(bytes).expect("a vector takes every byte");
    }
    zip.finish().expect("a vector takes every byte").into_inner()
}

/// Reads a zip.
///
/// # Errors
/// Everything that makes it unsafe or no bundle, as far as it could be read.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Archive, Vec<Fault>> {
    let files = contents(bytes, limits).map_err(Vec::from)?;
    locate(files).map_err(|fault| vec![fault])
}

/// Returns the files of a zip, by the names they have there.
fn contents(bytes: &[u8], limits: &Limits) -> Result<Vec<(String, Vec<u8>)>, Faults> {
    let directory = Directory::find(bytes)?;
    let entries = directory.headers(bytes, limits)?;
    let mut faults = Faults::default();
    let (mut paths, mut declared) = (Vec::with_capacity(entries.len()), 0_u64);
    for entry in &entries {
        if let Ok(path) = std::str::from_utf8(entry.name) {
            paths.push(path);
        } else {
            let shown = String::from_utf8_lossy(entry.name);
            faults.push(Fault::new(shown, "a name in UTF-8", "other bytes"));
        }
        faults.extend(entry.faults());
        declared = declared.saturating_add(entry.size);
    }
    let allowed = limits
        .bytes
        .min(RATIO_ALLOWANCE.saturating_add(limits.ratio.saturating_mul(bytes.len() as u64)));
    if declared > allowed {
        faults.push(
            Fault::new(
                "(archive)",
                format!("at most {allowed} bytes unpacked from {}", bytes.len()),
                format!("{declared} bytes declared"),
            )
            .hint("it may be a zip bomb"),
        );
    }
    // Names before bytes: a clash or a bomb is reason enough not to unpack anything.
    unsafe_names(&paths, limits, &mut faults);
    faults.or(())?;
    let packed = directory.account(bytes, &entries)?;
    let (mut contents, mut faults) = (Vec::with_capacity(entries.len()), Faults::default());
    for ((entry, path), packed) in entries.iter().zip(paths).zip(packed) {
        match unpack(entry, packed) {
            Ok(_) if entry.is_folder() => {}
            Ok(content) => contents.push((path.to_owned(), content)),
            Err(found) => {
                let expected = "an entry that unpacks to its declared size and checksum";
                faults.push(Fault::new(path, expected, found.to_string()));
            }
        }
    }
    faults.or(contents)
}

/// Does the same for a folder's files, given by their paths relative to it (with `/`), as `store` lists them. A folder
/// in it is a path that ends in `/`, without bytes.
///
/// # Errors
/// Where a name is unsafe, a folder is empty, or the whole is neither a bag nor a crate.
pub fn from_files(
    mut files: Vec<(String, Vec<u8>)>,
    limits: &Limits,
) -> Result<Archive, Vec<Fault>> {
    let paths: Vec<&str> = files.iter().map(|(path, _)| path.as_str()).collect();
    let mut faults = Faults::default();
    unsafe_names(&paths, limits, &mut faults);
    faults.or(()).map_err(Vec::from)?;
    files.retain(|(path, _)| !path.ends_with('/'));
    locate(files).map_err(|fault| vec![fault])
}

/// Most bytes of a path and of a part of it, which every system can write.
const LONGEST_PATH: usize = 1000;
const LONGEST_PART: usize = 255;

fn unsafe_names(paths: &[&str], limits: &Limits, faults: &mut Faults) {
    let mut seen = names::Names::default();
    let (mut once, mut twice) = (BTreeSet::new(), BTreeSet::new());
    for path in paths {
        if !once.insert(*path) {
            if twice.insert(*path) {
                let shown = path.escape_debug().to_string();
                faults.push(Fault::new(shown, "one entry of this name", "several"));
            }
            continue;
        }
        let shown = || path.escape_debug().to_string();
        let name = path.strip_suffix('/').unwrap_or(path);
        let longest = name.split('/').map(str::len).max().unwrap_or_default();
        if name.len() > LONGEST_PATH || longest > LONGEST_PART {
            let begin: String = name.chars().take(60).collect();
            faults.push(Fault::new(
                format!("{}...", begin.escape_debug()),
                format!("at most {LONGEST_PATH} bytes of path and {LONGEST_PART} of a name in it"),
                format!("{} and {longest}", name.len()),
            ));
        } else if let Some(hazard) = names::hazard(name) {
            faults.push(Fault::new(shown(), "a safe relative path", hazard));
        } else if !names::is_portable(name) {
            faults.push(Fault::new(
                shown(),
                "a name of A-Z a-z 0-9 . _ - only",
                "other characters, which systems spell in more than one way",
            ));
        } else if let Some(other) = seen.enter(path) {
            faults.push(Fault::new(
                shown(),
                "names that differ on every system",
                format!("`{other}` beside it"),
            ));
        }
        // Every folder on the way counts as well: a path of a thousand letters may name five hundred.
        if seen.len() > limits.entries {
            let expected = format!("at most {} files and folders", limits.entries);
            faults.push(Fault::new("(archive)", expected, "more"));
            return;
        }
    }
    // A folder whose name is refused needs no second reason.
    if faults.is_empty() {
        faults.extend(empty_folders(paths));
    }
}

/// Returns one fault for all the folders that hold no file; `None` where there are none.
fn empty_folders(paths: &[&str]) -> Option<Fault> {
    let files: BTreeSet<&str> = paths.iter().copied().filter(|path| !path.ends_with('/')).collect();
    let holds =
        |folder: &str| files.range(folder..).next().is_some_and(|file| file.starts_with(folder));
    let empty: BTreeSet<&str> =
        paths.iter().copied().filter(|path| path.ends_with('/') && !holds(path)).collect();
    let first = empty.first()?.escape_debug().to_string();
    let found = match empty.len() - 1 {
        0 => "none in it".to_owned(),
        more => format!("none in it, nor in {more} more"),
    };
    Some(Fault::new(first, "a folder that holds files", found).hint("no checksum covers it"))
}

/// Finds the bag or the crate among the files.
fn locate(files: Vec<(String, Vec<u8>)>) -> Result<Archive, Fault> {
    let has = |name: &str| files.iter().any(|(path, _)| path == name);
    let tops: BTreeSet<&str> =
        files.iter().filter_map(|(path, _)| path.split('/').next()).collect();
    let bags: Vec<&str> =
        tops.iter().copied().filter(|top| has(&format!("{top}/{}", format::BAGIT))).collect();
    let (form, prefix, onto) = match (has(format::BAGIT), has(format::METADATA), &bags[..]) {
        (true, false, []) => (Form::Flat, String::new(), ""),
        (false, true, []) => (Form::Crate, String::new(), PAYLOAD),
        (false, false, [bag]) => (Form::Bag, format!("{bag}/"), ""),
        (flat, bare, _) => return Err(no_one_root(flat, bare, &bags)),
    };
    if form == Form::Bag {
        let bag = bags[0];
        if tops.len() > 1 {
            let others: Vec<_> =
                tops.iter().filter(|top| **top != bag).map(|t| format!("`{t}`")).collect();
            return Err(Fault::new(
                "(archive)",
                format!("the one folder `{bag}`"),
                format!("{} beside it", others.join(", ")),
            ));
        }
        if RESERVED.iter().any(|name| bag.eq_ignore_ascii_case(name)) {
            let expected = "a bag in a folder that no part of a bag is named after";
            let hint = "rename the folder";
            return Err(Fault::new("(archive)", expected, format!("`{bag}`")).hint(hint));
        }
    }
    // A second root inside the first: which of them is read depends on who reads.
    let inner = BundlePath::payload(format::BAGIT);
    for inner in [&*inner, format::METADATA] {
        let path = format!("{prefix}{inner}");
        if form != Form::Crate && has(&path) {
            let expected =
                format!("no second root in a bag ({}, {})", format::BAGIT, format::METADATA);
            return Err(Fault::new(path, expected, "one"));
        }
    }
    let tree = files
        .into_iter()
        .map(|(path, bytes)| (format!("{onto}{}", &path[prefix.len()..]), bytes))
        .collect();
    Ok(Archive { form, tree })
}

/// Names at the root of a bag or of a crate that tell one from the other.
const RESERVED: [&str; 3] = ["data", format::BAGIT, format::METADATA];

fn no_one_root(flat: bool, bare: bool, bags: &[&str]) -> Fault {
    let mut roots = Vec::new();
    if flat {
        roots.push("a bag at the root".to_owned());
    }
    if bare {
        roots.push("a crate at the root".to_owned());
    }
    roots.extend(bags.iter().map(|bag| format!("a bag in `{bag}`")));
    let found = if roots.is_empty() { "neither".to_owned() } else { roots.join(", ") };
    let expected = format!("one bag ({}) or crate ({})", format::BAGIT, format::METADATA);
    Fault::new("(archive)", expected, found).hint("is it a bundle, and is it whole?")
}

#[cfg(test)]
mod tests;
