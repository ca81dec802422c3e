//! Level 0 has one rule that no list of attacks covers: what is accepted, every other reader sees alike.

use super::raw_zip::{self, Entry, Header, Tail};
use crate::sandbox::skipped;
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;
use reenact::bundle::{Form, Limits, Tree, archive};
use reenact::digest::Sha256Digest;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// Archives that are made. Most are refused.
const ARCHIVES: usize = 2000;

/// What may be done to an archive. An entry is meant where nothing else is named.
#[derive(Debug, Clone)]
enum Change {
    Before(Vec<u8>),
    Comment(Vec<u8>),
    MoreData(Vec<u8>),
    LessData,
    Twice(&'static str),
    Shared(i32),
    Name(&'static str),
    LocalName(&'static str),
    Folder(&'static str),
    Bit { local: bool, field: u8, bit: u8 },
    Extra { local: bool, extra: Vec<u8> },
    Deflated,
    Streamed,
    StreamedLong,
    Descriptor(Vec<u8>),
    Mode(u32),
    Attributes(u32),
    System(u16),
    Swapped,
    Gap(Vec<u8>),
    BehindDirectory(Vec<u8>),
    ArchiveComment(Vec<u8>),
    Miscounted(i32),
    LongEnd(i32),
    Reversed,
    Flip(Index, u8),
    Cut(Index),
    InFront(Vec<u8>),
    AtEnd(Vec<u8>),
}

/// An archive: its root folder, and what is done to the entries at some places.
type Plan = (&'static str, Vec<(Index, Change)>);

/// Draws bytes that mean something in a zip, and others.
fn junk() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..24),
        Just(b"PK\x05\x06".to_vec()),
        Just(raw_zip::zip(&[Entry::stored("bag/data/x", "hidden")])),
        Just(raw_zip::end(0, 0, 0)),
        Just(raw_zip::descriptor(0, 0, 0)),
        Just(vec![0; 22]),
    ]
}

fn extra() -> impl Strategy<Value = Vec<u8>> {
    let field = raw_zip::extra;
    let known = vec![
        Vec::new(),
        field(0x5455, &[3, 1, 2, 3, 4]),
        field(0x5455, &[7, 1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3]),
        field(0x7875, &[1, 4, 0, 0, 0, 0, 4, 0, 0, 0, 0]),
        field(0x7855, &[1, 2, 3, 4]),
        field(0x000a, &[[0; 4].as_slice(), &[1, 0, 24, 0], &[7; 24]].concat()),
        field(0x000d, &[0; 12]),
        field(0x0001, &[]),
        field(0x0001, &[9, 0, 0, 0, 0, 0, 0, 0]),
        field(0x0001, &[9; 16]),
        field(0x9901, &[2, 0, b'A', b'E', 3, 8, 0]),
        field(0xcafe, &[]),
        raw_zip::unicode(0x7075, b"bag/data/a", b"bag/data/z"),
        raw_zip::unicode(0x7075, b"data/a", b"data/z"),
        raw_zip::unicode(0x6375, b"", b"comment"),
        b"UT".to_vec(),
        b"UT\x09\0\x01".to_vec(),
    ];
    prop_oneof![
        3 => prop::sample::select(known.clone()),
        1 => (prop::sample::select(known.clone()), prop::sample::select(known)).prop_map(|(a, b)| [a, b].concat()),
        1 => prop::collection::vec(any::<u8>(), 0..12),
    ]
}

fn name() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "data/a",
        "data/A",
        "data/b",
        "data/c/d",
        "data",
        "data/",
        "data/c",
        "data/c/",
        "data/a/",
        "data/new/",
        "data/new",
        "bagit.txt/",
        "bagit.txt",
        "data/../x",
        "/data/a",
        "data//a",
        "data\\a",
        "data/a\0",
        "data/\u{e9}",
        "data/a.",
        "./data/a",
        "data/bagit.txt",
        "ro-crate-metadata.json",
        "",
    ])
}

fn folder() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "",
        "data/",
        "data/c/",
        "data/c/",
        "data/C/",
        "data/a/",
        "data/new/",
        "bagit.txt/",
        "data",
    ])
}

fn change() -> impl Strategy<Value = Change> {
    let on_entries = prop_oneof![
        1 => junk().prop_map(Change::Before),
        1 => junk().prop_map(Change::Comment),
        1 => junk().prop_map(Change::MoreData),
        1 => Just(Change::LessData),
        1 => name().prop_map(Change::Twice),
        1 => (-40..40).prop_map(Change::Shared),
        1 => name().prop_map(Change::Name),
        1 => name().prop_map(Change::LocalName),
        6 => folder().prop_map(Change::Folder),
        4 => (any::<bool>(), 0..6_u8, 0..32_u8).prop_map(|(local, field, bit)| Change::Bit { local, field, bit }),
        4 => (any::<bool>(), extra()).prop_map(|(local, extra)| Change::Extra { local, extra }),
        2 => Just(Change::Deflated),
        3 => Just(Change::Streamed),
        2 => Just(Change::StreamedLong),
        1 => junk().prop_map(Change::Descriptor),
    ];
    let on_attributes = prop_oneof![
        prop::sample::select(vec![0, 0o600, 0o100_755, 0o120_777, 0o040_755, 0o010_644])
            .prop_map(Change::Mode),
        prop::sample::select(vec![0, 1, 8, 0x10, 0x20, 0x8000]).prop_map(Change::Attributes),
        (0..21_u16).prop_map(Change::System),
        Just(Change::Swapped),
    ];
    let on_archive = prop_oneof![
        1 => junk().prop_map(Change::Gap),
        1 => junk().prop_map(Change::BehindDirectory),
        1 => junk().prop_map(Change::ArchiveComment),
        1 => (-2..3).prop_map(Change::Miscounted),
        4 => prop::sample::select(vec![0, 0, 0, -1, 1]).prop_map(Change::LongEnd),
        1 => Just(Change::Reversed),
        8 => (any::<Index>(), any::<u8>()).prop_map(|(at, byte)| Change::Flip(at, byte)),
        1 => any::<Index>().prop_map(Change::Cut),
        1 => junk().prop_map(Change::InFront),
        1 => junk().prop_map(Change::AtEnd),
    ];
    prop_oneof![2 => on_entries, 1 => on_attributes, 1 => on_archive]
}

fn plan() -> impl Strategy<Value = Plan> {
    let roots = prop::sample::select(vec!["bag/", "bag/", "x.y/", "data/", ""]);
    (roots, prop::collection::vec((any::<Index>(), change()), 0..4))
}

fn make((root, changes): &Plan) -> Vec<u8> {
    let within = |path: &str| format!("{root}{path}");
    let mut entries = vec![
        Entry::stored(within("bagit.txt"), "BagIt-Version: 1.0\n"),
        Entry::deflated(within("data/a"), "the same words again and again, ".repeat(9)),
        Entry::stored(within("data/b"), ""),
        Entry::deflated(within("data/c/d"), "few words"),
    ];
    let mut tail = Tail::default();
    for (at, change) in changes {
        let at = at.index(entries.len());
        if let Change::Twice(name) = change {
            entries.push(Entry::stored(within(name), "another"));
        } else if let Change::Folder(name) = change {
            entries.insert(at, Entry::folder(within(name)));
        } else if matches!(change, Change::Swapped) {
            entries.swap(0, at);
        } else {
            change_entry(&mut entries[at], root, change);
            change_tail(&mut tail, change);
        }
    }
    // The first entry has no other before it.
    entries[0].shared = false;
    let mut zip = raw_zip::zip_with(&entries, &tail);
    for (_, change) in changes {
        match change {
            Change::Flip(at, byte) if !zip.is_empty() => {
                let at = at.index(zip.len());
                zip[at] = *byte;
            }
            Change::Cut(at) => zip.truncate(at.index(zip.len() + 1)),
            Change::InFront(junk) => drop(zip.splice(0..0, junk.iter().copied())),
            Change::AtEnd(junk) => zip.extend(junk),
            _ => {}
        }
    }
    zip
}

fn change_entry(entry: &mut Entry, root: &str, change: &Change) {
    let own = entry.clone();
    *entry = match change.clone() {
        Change::Before(before) => Entry { before, ..own },
        Change::Comment(comment) => Entry { comment, ..own },
        Change::MoreData(more) => {
            let data = [own.data.clone(), more].concat();
            own.replaced(data)
        }
        Change::LessData => {
            let data = own.data[..own.data.len().saturating_sub(1)].to_vec();
            own.replaced(data)
        }
        Change::Shared(shift) => Entry { shared: true, shift, ..own },
        Change::Name(name) => own.says(|header| header.name = format!("{root}{name}").into()),
        Change::LocalName(name) => {
            own.says_locally(|header| header.name = format!("{root}{name}").into())
        }
        Change::Bit { local: false, field, bit } => own.says(|header| flip(header, field, bit)),
        Change::Bit { local: true, field, bit } => {
            own.says_locally(|header| flip(header, field, bit))
        }
        Change::Extra { local: false, extra } => own.says(|header| header.extra = extra),
        Change::Extra { local: true, extra } => own.says_locally(|header| header.extra = extra),
        Change::Deflated => {
            let content = own.data.clone();
            Entry::deflated(own.central.name, content)
        }
        Change::Streamed => own.streamed(),
        Change::StreamedLong => long(own.streamed()),
        Change::Descriptor(descriptor) => Entry { descriptor, ..own },
        Change::Mode(mode) => Entry { mode, ..own },
        Change::Attributes(attributes) => Entry { attributes, ..own },
        Change::System(system) => Entry { system, ..own },
        _ => own,
    };
}

fn flip(header: &mut Header, field: u8, bit: u8) {
    match field {
        0 => header.version ^= 1 << (bit % 16),
        1 => header.flags ^= 1 << (bit % 16),
        2 => header.method ^= 1 << (bit % 16),
        3 => header.crc ^= 1 << bit,
        4 => header.packed ^= 1 << bit,
        _ => header.size ^= 1 << bit,
    }
}

/// Returns a streamed entry that leaves room for sizes of eight bytes.
fn long(streamed: Entry) -> Entry {
    let Header { crc, packed, size, .. } = streamed.central;
    let mut descriptor = raw_zip::descriptor(crc, packed, 0)[..12].to_vec();
    descriptor.extend([0; 4]);
    descriptor.extend(u64::from(size).to_le_bytes());
    let streamed = streamed.says_locally(|header| {
        (header.packed, header.size) = (u32::MAX, u32::MAX);
        header.version = 45;
        header.extra = raw_zip::extra(1, &[0; 16]);
    });
    Entry { descriptor, ..streamed }
}

fn change_tail(tail: &mut Tail, change: &Change) {
    match change.clone() {
        Change::Gap(gap) => tail.gap = gap,
        Change::BehindDirectory(behind) => tail.behind = behind,
        Change::ArchiveComment(comment) => tail.comment = comment,
        Change::Miscounted(miscount) => tail.miscount = miscount,
        Change::LongEnd(miscount) => tail.long = Some(miscount),
        Change::Reversed => tail.reversed = true,
        _ => {}
    }
}

/// Returns the files that we see, by the names they have in the archive; `None` where we refuse it.
fn seen_by_us(root: &str, zip: &[u8]) -> Option<Tree> {
    let archive = archive::read(zip, &Limits::default()).ok()?;
    let named = |(path, bytes): (String, Vec<u8>)| match archive.form {
        Form::Bag => (format!("{root}{path}"), bytes),
        Form::Flat => (path, bytes),
        Form::Crate => (path.strip_prefix("data/").unwrap().to_owned(), bytes),
    };
    Some(archive.tree.into_iter().map(named).collect())
}

/// Returns whether a program is there; says loudly where it is not.
fn is_there(program: &str, version: &str) -> bool {
    let quiet = Command::new(program)
        .arg(version)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let is_there = quiet.is_ok();
    if !is_there {
        skipped(&format!("`{program}` is not installed, so nothing is compared with it"));
    }
    is_there
}

/// Returns what a program says to `input`; it must succeed.
fn said(command: &mut Command, input: &str) -> Vec<u8> {
    let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {:?}: {error}", output.status);
    output.stdout
}

const PYTHON: &str = r"
import hashlib, json, sys, zipfile
for path in sys.stdin.read().splitlines():
    try:
        with zipfile.ZipFile(path) as archive:
            files = [i for i in archive.infolist() if not i.is_dir()]
            print(json.dumps(sorted([i.filename, hashlib.sha256(archive.read(i)).hexdigest()] for i in files)))
    except Exception as error:
        print(json.dumps(repr(error)))
";

#[test]
fn what_we_accept_others_see_alike() {
    let folder = tempfile::tempdir().unwrap();
    let mut runner = TestRunner::deterministic();
    let strategy = plan();
    let mut accepted = Vec::new();
    for i in 0..ARCHIVES {
        let plan = strategy.new_tree(&mut runner).unwrap().current();
        let zip = make(&plan);
        if let Some(tree) = seen_by_us(plan.0, &zip) {
            let path = folder.path().join(format!("{i}.zip"));
            fs::write(&path, zip).unwrap();
            accepted.push((path.to_str().unwrap().to_owned(), plan, tree));
        }
    }
    // Neither may be rare, or the rule is not tried.
    assert!(accepted.len() >= ARCHIVES / 8 && accepted.len() <= ARCHIVES / 2, "{}", accepted.len());
    let kept = |what: fn(&Change) -> bool| {
        accepted.iter().filter(|(_, (_, changes), _)| changes.iter().any(|(_, c)| what(c))).count()
    };
    let streamed = kept(|c| matches!(c, Change::Streamed | Change::StreamedLong));
    let (folders, long) =
        (kept(|c| matches!(c, Change::Folder(_))), kept(|c| matches!(c, Change::LongEnd(_))));
    assert!(streamed > 5 && folders > 5 && long > 5, "{streamed} {folders} {long}");

    if is_there("python3", "--version") {
        let paths: Vec<&str> = accepted.iter().map(|(path, ..)| path.as_str()).collect();
        let answers = said(Command::new("python3").args(["-c", PYTHON]), &paths.join("\n"));
        let answers = String::from_utf8(answers).unwrap();
        assert_eq!(answers.lines().count(), accepted.len());
        for (answer, (_, plan, tree)) in answers.lines().zip(&accepted) {
            let ours: Vec<(&String, String)> =
                tree.iter().map(|(name, bytes)| (name, Sha256Digest::of(bytes).hex())).collect();
            let theirs: serde_json::Value = serde_json::from_str(answer).unwrap();
            assert_eq!(theirs, serde_json::json!(ours), "Python sees something else: {plan:?}");
        }
    }
    if is_there("unzip", "-v") {
        for (path, plan, tree) in &accepted {
            let names =
                String::from_utf8(said(Command::new("unzip").args(["-Z1", path]), "")).unwrap();
            let files: Vec<&str> = names.lines().filter(|name| !name.ends_with('/')).collect();
            let mut sorted = files.clone();
            sorted.sort_unstable();
            let ours: Vec<&str> = tree.keys().map(String::as_str).collect();
            assert_eq!(sorted, ours, "unzip sees other files: {plan:?}");
            let bytes = said(Command::new("unzip").args(["-p", path]), "");
            let ours: Vec<u8> = files.iter().flat_map(|name| tree[*name].clone()).collect();
            assert!(bytes == ours, "unzip sees other bytes: {plan:?}");
        }
    }
}

/// Returns a bag as the programs that are installed here zip it, each by its name.
pub(crate) fn as_tools_write(tree: &Tree, root: &str) -> Vec<(String, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    for (path, bytes) in tree {
        let path = folder.path().join(root).join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    let python = |to: &str, how: &str| {
        format!("import os, sys, zipfile\n{}\n{WALK}", to.replace("HOW", how))
    };
    let stream = python(STREAM, "zipfile.ZIP_DEFLATED");
    let (stored, plain) =
        (python(STREAM, "zipfile.ZIP_STORED"), python(PLAIN, "zipfile.ZIP_DEFLATED"));
    let [out, this] = ["out.zip", root];
    let tools: [(&str, &str, &[&str]); 9] = [
        ("zip", "-v", &["-qr", out, this]),
        ("zip", "-v", &["-qr", "-fd", out, this]),
        ("zip", "-v", &["-qr", "-fz", "-0", out, this]),
        ("zip", "-v", &["-qrX9", out, this]),
        ("bsdtar", "--version", &["-a", "-cf", out, this]),
        ("7z", "--help", &["a", "-bso0", "-tzip", out, this]),
        ("python3", "--version", &["-c", &stream, out, this]),
        ("python3", "--version", &["-c", &stored, out, this]),
        ("python3", "--version", &["-c", &plain, out, this]),
    ];
    let mut written = Vec::new();
    for (program, version, words) in tools {
        if !is_there(program, version) {
            continue;
        }
        said(Command::new(program).args(words).current_dir(folder.path()), "");
        let path: &Path = &folder.path().join(out);
        written.push((
            format!("{program} {}", words[..words.len() - 1].join(" ")),
            fs::read(path).unwrap(),
        ));
        fs::remove_file(path).unwrap();
    }
    written
}

const PLAIN: &str = "archive = zipfile.ZipFile(sys.argv[1], 'w', HOW)";

/// An output that cannot go back, as a pipe or a socket.
const STREAM: &str = "
class Stream:
    def __init__(self, path):
        self.file = open(path, 'wb')
    def write(self, data):
        return self.file.write(data)
    def flush(self):
        self.file.flush()
archive = zipfile.ZipFile(Stream(sys.argv[1]), 'w', HOW)
";

const WALK: &str = "
for folder, _, names in os.walk(sys.argv[2]):
    archive.write(folder)
    for name in names:
        archive.write(os.path.join(folder, name))
archive.close()
";
