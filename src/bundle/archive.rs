//! Zips, written byte-identically and read in place without trust: nothing is ever unpacked to disk.
//!
//! Level 0 of verification is this module: whatever it hands out is safe to look at, however the archive was made, and
//! is what every other reader sees.

mod extra;
mod header;
mod layout;
mod raw;
mod told;
mod unpack;

use self::header::Central;
use self::layout::Directory;
use self::raw::Raw;
use self::told::Faults;
pub use self::told::told;
use self::unpack::unpack;
pub(super) use self::unpack::{inflate, inflating};
use super::file::SourceReader;
use super::path::PAYLOAD;
use super::scratch::{HELD, Passing};
use super::{
    BundlePath, Content, Edition, Fault, FileRef, Files, LargeFile, LargeFiles, Source, Tree,
    format, in_edition, in_payload, names,
};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::{self, Cursor, Read as _, Seek, Write};
use std::sync::Arc;
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
    /// Most bytes of those of them that are held in memory: all but the records and the tables that have a line for each trial.
    pub held: u64,
    /// Most bytes unpacked for a byte of archive, beyond the first 32 MiB.
    pub ratio: u64,
}

impl Default for Limits {
    fn default() -> Self {
        // Checking takes up to five times the bytes that are held, and is to take no more than 300 MB for them. The others are
        // read as streams, so that they cost time alone: some 20 s a gigabyte.
        Self { entries: 20_000, bytes: 4 << 30, held: 48 << 20, ratio: 250 }
    }
}

/// What may be unpacked from any archive, however small: a blank map compresses a thousandfold.
const RATIO_ALLOWANCE: u64 = 32 << 20;

/// An opened archive or folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Archive {
    /// How it was laid out.
    pub form: Form,
    /// The files in memory by their path in the bag; those of a bare crate stand under `data/` as well.
    pub tree: Tree,
    /// The others.
    pub large: LargeFiles,
}

impl Archive {
    /// Returns one of files that are all in memory.
    pub fn of(form: Form, tree: Tree) -> Self {
        Self { form, tree, large: LargeFiles::new() }
    }

    /// Returns every file.
    pub fn files(&self) -> Files<'_> {
        Files { tree: &self.tree, large: &self.large }
    }
}

/// Writes `tree` as a zip, `bagit.txt` first, then the other tag files, then the payload, each sorted.
///
/// Fixed dates, permissions and compression, and each file compressed in pieces that its size alone decides: equal trees give equal
/// bytes.
pub fn write(tree: &Tree, root: &str, form: Form) -> Vec<u8> {
    write_files(Files { tree, large: &LargeFiles::new() }, root, form)
}

/// Does the same for files of which some are not in memory.
pub(super) fn write_files(files: Files<'_>, root: &str, form: Form) -> Vec<u8> {
    let mut zip = Cursor::new(Vec::new());
    write_to(files, root, form, &mut zip).expect("a vector takes every byte");
    zip.into_inner()
}

/// Does the same to `out`, file by file, with sizes of eight bytes (zip64) where they need them.
///
/// # Errors
/// Where it cannot be written, or a large file not be read.
pub fn write_to(
    files: Files<'_>,
    root: &str,
    form: Form,
    out: impl Write + Seek,
) -> io::Result<()> {
    let mut order: Vec<(&String, FileRef<'_>)> = files.iter().collect();
    order.sort_by_key(|(path, _)| (in_payload(path).is_some(), *path != format::BAGIT));
    let named = order.into_iter().filter_map(|(path, file)| {
        let name = match form {
            Form::Bag => format!("{root}/{path}"),
            Form::Flat => path.clone(),
            Form::Crate => in_payload(path)?.to_owned(),
        };
        Some((name, file))
    });
    let options =
        options().compression_method(CompressionMethod::Deflated).compression_level(Some(6));
    pack(named, options, out).map(drop)
}

/// Writes `tree` below the folder `root` without compression, so that the bytes depend on the files alone.
pub(super) fn store(tree: &Tree, root: &str) -> Vec<u8> {
    let named = tree.iter().map(|(path, bytes)| (format!("{root}/{path}"), FileRef::Held(bytes)));
    let options = options().compression_method(CompressionMethod::Stored);
    let zip = pack(named, options, Cursor::new(Vec::new())).expect("a vector takes every byte");
    zip.into_inner()
}

/// Returns the options that make an archive depend on nothing but its files.
fn options() -> SimpleFileOptions {
    SimpleFileOptions::default().last_modified_time(DateTime::default()).unix_permissions(0o644)
}

fn pack<'a, W: Write + Seek>(
    files: impl Iterator<Item = (String, FileRef<'a>)>,
    options: SimpleFileOptions,
    out: W,
) -> io::Result<W> {
    // A deflated file may be a little longer than it was.
    const NEEDS_EIGHT_BYTES: u64 = u32::MAX as u64 - (64 << 20);
    let mut zip = ZipWriter::new(out);
    for (name, file) in files {
        zip.start_file(name, options.large_file(file.size() > NEEDS_EIGHT_BYTES))?;
        let copied = match file {
            FileRef::Held(bytes) if file.size() <= HELD => {
                zip.write_all(bytes)?;
                file.size()
            }
            _ => in_blocks(file, &mut zip)?,
        };
        if copied != file.size() {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
    }
    Ok(zip.finish()?)
}

/// Writes `file` to `out`, and returns how many bytes it has. The compressor notices how its input is cut: by size alone, so that
/// equal files give equal bytes, wherever they are.
fn in_blocks(file: FileRef<'_>, out: &mut impl Write) -> io::Result<u64> {
    const BLOCK: u64 = 64 << 10;
    let step = if file.size() <= HELD { HELD } else { BLOCK };
    let (mut reader, mut block, mut copied) = (file.reader(), Vec::new(), 0);
    loop {
        block.clear();
        let count = reader.by_ref().take(step).read_to_end(&mut block)?;
        if count == 0 {
            return Ok(copied);
        }
        out.write_all(&block)?;
        copied += count as u64;
    }
}

/// Reads a zip that is in memory; all its files are held there.
///
/// # Errors
/// Everything that makes it unsafe or no bundle, as far as it could be read.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Archive, Vec<Fault>> {
    /// Bytes that somebody else has.
    #[derive(Debug)]
    struct Lent<'a>(&'a [u8]);
    impl Source for Lent<'_> {
        fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
            let rest = usize::try_from(at).ok().and_then(|at| self.0.get(at..)).unwrap_or_default();
            let count = rest.len().min(into.len());
            into[..count].copy_from_slice(&rest[..count]);
            Ok(count)
        }
    }
    let (limits, failed) =
        (Limits { bytes: limits.bytes.min(limits.held), ..*limits }, RefCell::new(None));
    let lent = Lent(bytes);
    let raw = Raw::new(&lent, bytes.len() as u64, &failed);
    let files = contents(&raw, None, &limits).map_err(Vec::from)?;
    locate(files).map_err(|fault| vec![fault])
}

/// Reads a zip of so many bytes from where it is: records, and tables that have a line for each trial, stay there where they are
/// large.
///
/// # Errors
/// Where it cannot be read; what is wrong with it is data, as for [`read`].
pub fn read_from(
    source: &Arc<dyn Source>,
    length: u64,
    limits: &Limits,
) -> io::Result<Result<Archive, Vec<Fault>>> {
    let failed = RefCell::new(None);
    let files = contents(&Raw::new(&**source, length, &failed), Some(source), limits);
    match failed.into_inner() {
        Some(error) => Err(error),
        None => Ok(files.map_err(Vec::from).and_then(|f| locate(f).map_err(|fault| vec![fault]))),
    }
}

/// Returns whether the file `path`, as an archive calls it, may be left where it is: whatever has a line for each trial.
fn is_streamed(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or_default();
    let folder = path.strip_suffix(name).unwrap_or_default();
    let is_in = |within: &str| folder == within || folder.ends_with(&format!("/{within}"));
    is_in(format::TRIALS) && name.rsplit_once('.').is_some_and(|(_, kind)| kind == "jsonl")
        || is_in(format::RESULTS) && ["trials.csv", "series.csv"].contains(&name)
}

/// Most bytes of such files that are held in memory, where each is small.
const MOST_HELD: u64 = 16 << 20;

/// Returns the files of a zip, by the names they have there; those that may be left in the source, where one is given, as places
/// in it.
fn contents(
    raw: &Raw<'_>,
    source: Option<&Arc<dyn Source>>,
    limits: &Limits,
) -> Result<Vec<(String, Content)>, Faults> {
    let directory = Directory::find(raw)?;
    let bytes = directory.bytes(raw);
    let entries = directory.headers(&bytes, limits)?;
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
    faults.extend(too_large(declared, raw.len(), limits));
    // Names before bytes: a clash or a bomb is reason enough not to unpack anything.
    unsafe_names(&paths, limits, &mut faults);
    faults.or(())?;
    let streamed = |path: &str| source.is_some() && is_streamed(path);
    let sum = |are_streamed: bool| -> u64 {
        let of = entries.iter().zip(&paths).filter(|(_, path)| streamed(path) == are_streamed);
        of.map(|(entry, _)| entry.size).sum()
    };
    if source.is_some() && sum(false) > limits.held {
        let expected = format!("at most {} bytes beside records and tables of trials", limits.held);
        let fault = Fault::new("(archive)", expected, format!("{} bytes declared", sum(false)));
        return Err(fault.hint("it may be a zip bomb").into());
    }
    let most = if sum(true) > MOST_HELD { 0 } else { HELD };
    let places = directory.account(raw, &entries)?;
    let (mut contents, mut faults) = (Vec::with_capacity(entries.len()), Faults::default());
    for ((entry, path), at) in entries.iter().zip(paths).zip(places) {
        let packed = raw.part(at, at.saturating_add(entry.packed));
        let left = source.filter(|_| streamed(path) && entry.size > most);
        match content(entry, &packed, left.map(|source| (source, at))) {
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

/// Returns the fault of an archive of `length` bytes that declares more than it may.
fn too_large(declared: u64, length: u64, limits: &Limits) -> Option<Fault> {
    let by_ratio = RATIO_ALLOWANCE.saturating_add(limits.ratio.saturating_mul(length));
    let allowed = limits.bytes.min(by_ratio);
    (declared > allowed).then(|| {
        let expected = format!("at most {allowed} bytes unpacked from {length}");
        let fault = Fault::new("(archive)", expected, format!("{declared} bytes declared"));
        fault.hint(if declared > by_ratio { "it may be a zip bomb" } else { TOO_LARGE })
    })
}

/// What to do about a bundle that is larger than the reader admits.
pub const TOO_LARGE: &str =
    "where you trust that it is so large, `--max-size` admits it: `--max-size 8G`";

/// Unpacks an entry: into memory, or past it where it may be `left` where it is, behind that byte of the source.
fn content(
    entry: &Central<'_>,
    packed: &Raw<'_>,
    left: Option<(&Arc<dyn Source>, u64)>,
) -> Result<Content, unpack::UnpackError> {
    let Some((source, at)) = left else {
        let mut bytes = Vec::new();
        unpack(entry, packed, &mut |block| bytes.extend_from_slice(block))?;
        return Ok(Content::Held(bytes));
    };
    let mut passing = Passing::new();
    unpack(entry, packed, &mut |block| passing.take(block))?;
    let (source, known) = (Arc::clone(source), passing.done());
    Ok(Content::Large(if entry.is_stored() {
        LargeFile::plain(source, at, known)
    } else {
        LargeFile::packed(source, at, entry.packed, known)
    }))
}

/// Returns a file of a folder, `length` bytes in a source of its own: in memory, or where it is if it is large and may stay there.
///
/// # Errors
/// Where it cannot be read.
pub fn file_of_folder(path: &str, source: Arc<dyn Source>, length: u64) -> io::Result<Content> {
    let mut reader = SourceReader { source: &*source, at: 0, left: length };
    if !is_streamed(path) || length <= HELD {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes)?;
        return Ok(Content::Held(bytes));
    }
    let mut passing = Passing::new();
    let mut block = vec![0; 1 << 16];
    loop {
        match reader.read(&mut block)? {
            0 => break,
            count => passing.take(&block[..count]),
        }
    }
    Ok(Content::Large(LargeFile::plain(source, 0, passing.done())))
}

/// Does the same for a folder's files, given by their paths relative to it (with `/`), as `store` lists them. A folder
/// in it is a path that ends in `/`, without bytes.
///
/// # Errors
/// Where a name is unsafe, a folder is empty, or the whole is neither a bag nor a crate.
pub fn from_files<F: Into<Content>>(
    files: Vec<(String, F)>,
    limits: &Limits,
) -> Result<Archive, Vec<Fault>> {
    let mut files: Vec<(String, Content)> =
        files.into_iter().map(|(path, file)| (path, file.into())).collect();
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
fn locate(files: Vec<(String, Content)>) -> Result<Archive, Fault> {
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
    let (mut tree, mut large) = (Tree::new(), LargeFiles::new());
    for (path, file) in files {
        let path = format!("{onto}{}", &path[prefix.len()..]);
        match file {
            Content::Held(bytes) => drop(tree.insert(path, bytes)),
            Content::Large(file) => drop(large.insert(path, file)),
        }
    }
    // A crate in the newer edition is what it was sealed as, in other words.
    if form == Form::Crate
        && let Some(metadata) = tree.get_mut(&*BundlePath::payload(format::METADATA))
        && let Some(own) = in_edition(metadata, Edition::default())
    {
        *metadata = own;
    }
    Ok(Archive { form, tree, large })
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
