//! Zips, written byte-identically and read in place without trust: nothing is ever unpacked to disk.
//!
//! Level 0 of verification is this file: whatever it hands out is safe to look at, however the archive was made.

use super::{Fault, Tree, format, names};
use std::collections::BTreeSet;
use std::io::{Cursor, Read as _, Write as _};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

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
    order.sort_by_key(|(path, _)| (path.starts_with(format::PAYLOAD), *path != format::BAGIT));
    let named = order.into_iter().filter_map(|(path, bytes)| {
        let name = match form {
            Form::Bag => format!("{root}/{path}"),
            Form::Flat => path.clone(),
            Form::Crate => path.strip_prefix(format::PAYLOAD)?.to_owned(),
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

/// What makes an archive depend on nothing but its files.
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
    let broken = |e: &dyn std::fmt::Display| {
        vec![Fault::new("(archive)", "a whole zip archive", format!("another: {e}"))]
    };
    let mut faults = Vec::new();
    let too_many = |found: usize| {
        Fault::new(
            "(archive)",
            format!("at most {} entries", limits.entries),
            format!("{found} entries"),
        )
    };
    // Counted before they are read, for reading an entry takes ten times its bytes. The mark may stand in a file's bytes,
    // too, but not as often.
    let marks = bytes.windows(4).filter(|w| *w == b"PK\x01\x02").count();
    if marks > limits.entries.saturating_mul(2) {
        return Err(vec![too_many(marks)]);
    }
    let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|e| broken(&e))?;
    if zip.offset() > 0 {
        faults.push(Fault::new(
            "(archive)",
            "a zip that begins at the first byte",
            format!("{} bytes before it", zip.offset()),
        ));
    }
    if let Some(behind) = bytes_behind(bytes) {
        faults.push(Fault::new(
            "(archive)",
            "a zip that ends at the last byte",
            format!("{behind} bytes behind it"),
        ));
    }
    let start = usize::try_from(zip.central_directory_start()).unwrap_or(usize::MAX);
    let listed = central_names(bytes.get(start..).unwrap_or_default());
    if listed.len() > limits.entries || zip.len() > limits.entries {
        faults.push(too_many(listed.len().max(zip.len())));
        return Err(faults);
    }
    faults.extend(duplicates(&listed));
    if faults.is_empty()
        && let Err(e) = zip.validate_header_consistency()
    {
        faults.push(Fault::new(
            "(archive)",
            "local and central headers that agree",
            format!("others: {e}"),
        ));
    }

    let mut declared = 0_u64;
    let mut files = Vec::new();
    for index in 0..zip.len() {
        let entry = zip.by_index_data(index).map_err(|e| broken(&e))?;
        let Ok(name) = std::str::from_utf8(entry.name_raw()) else {
            let shown = String::from_utf8_lossy(entry.name_raw()).into_owned();
            faults.push(Fault::new(shown, "a name in UTF-8", "other bytes"));
            continue;
        };
        let mut found = Vec::new();
        if entry.encrypted() {
            found.push("encryption");
        }
        if !matches!(entry.compression(), CompressionMethod::Stored | CompressionMethod::Deflated) {
            found.push("another compression");
        }
        // Python's `writestr` leaves the type bits empty.
        let kind = entry.external_attributes() >> 16 & 0o170_000;
        if !matches!(kind, 0 | 0o100_000 | 0o040_000) {
            found.push(if kind == 0o120_000 { "a symbolic link" } else { "a special file" });
        }
        let folder = name.ends_with('/');
        if folder && entry.size() > 0 {
            found.push("a folder with content");
        }
        for found in found {
            faults.push(Fault::new(name.escape_debug().to_string(), "a plain file", found));
        }
        declared = declared.saturating_add(entry.size());
        files.push((index, name.to_owned(), folder));
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
    let paths: Vec<&str> = files.iter().map(|(_, name, _)| name.as_str()).collect();
    faults.extend(unsafe_names(&paths));
    if !faults.is_empty() {
        return Err(faults);
    }

    let mut contents = Vec::with_capacity(files.len());
    for (index, name, folder) in files {
        if folder {
            continue;
        }
        match unpack(&mut zip, index) {
            Ok(content) => contents.push((name, content)),
            Err(found) => {
                faults.push(Fault::new(
                    name,
                    "an entry that unpacks to its declared size and checksum",
                    found,
                ));
            }
        }
    }
    if faults.is_empty() { locate(contents) } else { Err(faults) }
}

/// The same for a folder's files, given by their paths relative to it (with `/`), as `store` lists them.
///
/// # Errors
/// Where a name is unsafe, or the folder is neither a bag nor a crate.
pub fn from_files(files: Vec<(String, Vec<u8>)>) -> Result<Archive, Vec<Fault>> {
    let paths: Vec<&str> = files.iter().map(|(path, _)| path.as_str()).collect();
    let faults = unsafe_names(&paths);
    if faults.is_empty() { locate(files) } else { Err(faults) }
}

/// Unpacks one entry, never more than it declares.
fn unpack(zip: &mut ZipArchive<Cursor<&[u8]>>, index: usize) -> Result<Vec<u8>, String> {
    let entry = zip.by_index(index).map_err(|e| e.to_string())?;
    let declared = entry.size();
    // Memory is taken as bytes come, not as the header asks.
    let mut content = Vec::new();
    entry.take(declared.saturating_add(1)).read_to_end(&mut content).map_err(|e| e.to_string())?;
    if content.len() as u64 == declared {
        Ok(content)
    } else {
        Err(format!("{} bytes where {declared} are declared", content.len()))
    }
}

fn unsafe_names(paths: &[&str]) -> Vec<Fault> {
    let mut seen = names::Names::default();
    let mut faults = Vec::new();
    for path in paths {
        let shown = || path.escape_debug().to_string();
        // A folder's own entry says nothing that the files in it do not say.
        let name = path.strip_suffix('/').unwrap_or(path);
        if let Some(hazard) = names::hazard(name) {
            faults.push(Fault::new(shown(), "a safe relative path", hazard));
        } else if !names::is_portable(name) {
            faults.push(Fault::new(
                shown(),
                "a name of A-Z a-z 0-9 . _ - only",
                "other characters, which systems spell in more than one way",
            ));
        } else if !path.ends_with('/')
            && let Some(other) = seen.enter(name)
        {
            faults.push(Fault::new(
                shown(),
                "names that differ on every system",
                format!("`{other}` beside it"),
            ));
        }
    }
    faults
}

/// Finds the bag or the crate among the files.
fn locate(files: Vec<(String, Vec<u8>)>) -> Result<Archive, Vec<Fault>> {
    let has = |name: &str| files.iter().any(|(path, _)| path == name);
    let tops: BTreeSet<&str> =
        files.iter().filter_map(|(path, _)| path.split('/').next()).collect();
    let bags: Vec<&str> =
        tops.iter().copied().filter(|top| has(&format!("{top}/{}", format::BAGIT))).collect();
    let (form, prefix, onto) = if has(format::BAGIT) {
        (Form::Flat, String::new(), "")
    } else if has(format::METADATA) {
        (Form::Crate, String::new(), format::PAYLOAD)
    } else if let [bag] = bags[..] {
        if tops.len() > 1 {
            let others: Vec<_> =
                tops.iter().filter(|top| **top != bag).map(|t| format!("`{t}`")).collect();
            return Err(vec![Fault::new(
                "(archive)",
                format!("the one folder `{bag}`"),
                format!("{} beside it", others.join(", ")),
            )]);
        }
        (Form::Bag, format!("{bag}/"), "")
    } else {
        let found = if bags.is_empty() {
            "neither".to_owned()
        } else {
            format!("{} bags: {}", bags.len(), bags.join(", "))
        };
        let expected = format!("one bag ({}) or crate ({})", format::BAGIT, format::METADATA);
        let hint = "is it a bundle, and is it whole?";
        return Err(vec![Fault::new("(archive)", expected, found).hint(hint)]);
    };
    let tree = files
        .into_iter()
        .map(|(path, bytes)| (format!("{onto}{}", &path[prefix.len()..]), bytes))
        .collect();
    Ok(Archive { form, tree })
}

/// How many bytes stand behind the archive's end record and its comment; `None` where none do.
fn bytes_behind(bytes: &[u8]) -> Option<usize> {
    let at = bytes.windows(4).rposition(|w| w == b"PK\x05\x06")?;
    let comment = bytes.get(at + 20..at + 22)?;
    let end = at + 22 + usize::from(u16::from_le_bytes([comment[0], comment[1]]));
    bytes.len().checked_sub(end).filter(|behind| *behind > 0)
}

/// The names in a central directory as they stand there: the zip crate keeps only the last of equal ones.
fn central_names(mut directory: &[u8]) -> Vec<&[u8]> {
    let mut names = Vec::new();
    while let Some(header) = directory.get(..46).filter(|h| h.starts_with(b"PK\x01\x02")) {
        let length = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let (name, rest) = (length(28), length(30) + length(32));
        let Some(bytes) = directory.get(46..46 + name) else { break };
        names.push(bytes);
        directory = directory.get(46 + name + rest..).unwrap_or_default();
    }
    names
}

fn duplicates(listed: &[&[u8]]) -> Vec<Fault> {
    let mut sorted = listed.to_vec();
    sorted.sort_unstable();
    let mut faults: Vec<Fault> = sorted
        .windows(2)
        .filter(|pair| pair[0] == pair[1])
        .map(|pair| {
            let name = String::from_utf8_lossy(pair[0]).escape_debug().to_string();
            Fault::new(name, "one entry of this name", "several")
        })
        .collect();
    faults.dedup();
    faults
}

#[cfg(test)]
mod tests;
