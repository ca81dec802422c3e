//! Level 0: archives and folders that must not even be opened.

use super::case::{Case, Made};
use super::raw_zip::{self, Entry, zip};
use super::study::HONEST;

/// The honest bag's entries.
fn entries() -> Vec<Entry> {
    let name = |path: &str| format!("{}/{path}", HONEST.root);
    HONEST.tree.iter().map(|(path, bytes)| Entry::stored(name(path), bytes.clone())).collect()
}

/// A name in the bag's folder.
fn inside(path: &str) -> String {
    format!("bag/{path}")
}

/// A small bag with one more file under a name of the attacker's.
fn with_name(name: &'static str, entry: impl Into<Vec<u8>>) -> Case {
    with(name, vec![Entry::stored(entry, "evil")])
}

/// A small bag with more entries.
fn with(name: &'static str, more: Vec<Entry>) -> Case {
    let mut all = vec![Entry::stored(inside("bagit.txt"), "")];
    all.extend(more);
    Case::new(name, 0, Made::File(zip(&all)))
}

fn file(name: &'static str, bytes: impl Into<Vec<u8>>) -> Case {
    Case::new(name, 0, Made::File(bytes.into()))
}

/// Names that lead out of the folder or that some system takes for another.
pub(crate) fn names() -> Vec<Case> {
    vec![
        with_name("zip-slip", "bag/../../evil"),
        with_name("absolute path", "/etc/evil"),
        with_name("drive path", "C:/evil"),
        with_name("drive-relative path", "C:evil"),
        with_name("alternate data stream", "bag/bagit.txt:evil"),
        with_name("network path", "//server/share/evil"),
        with_name("backslashes", "bag\\..\\..\\evil"),
        with_name("NUL in a name", "bag/evil\0.txt"),
        with_name("escape sequence in a name", "bag/\u{1b}[2Jevil"),
        with_name("Windows device", "bag/data/CON.txt"),
        with_name("trailing dot", "bag/data/evil."),
        with_name("empty part", "bag//evil"),
        with_name("name that is not UTF-8", b"bag/\xff\xfe".as_slice()),
        with_name("text that runs backwards", "bag/\u{202e}txt.exe"),
        with(
            "one name in two Unicode normal forms",
            vec![
                Entry::stored("bag/caf\u{e9}", "composed"),
                Entry::stored("bag/cafe\u{301}", "decomposed"),
            ],
        ),
        with(
            "names that differ in case",
            vec![Entry::stored("bag/data/x", "1"), Entry::stored("bag/Data/x", "2")],
        ),
        with(
            "one name twice",
            vec![Entry::stored("bag/data/x", "1"), Entry::stored("bag/data/x", "2")],
        ),
        with(
            "a file where another has a folder",
            vec![Entry::stored("bag/data", "1"), Entry::stored("bag/data/x", "2")],
        ),
        with(
            "a Unicode path extra field that renames a file",
            vec![Entry {
                // Info-ZIP's 0x7075: version, CRC-32 of the header's name, the other name.
                extra: {
                    let other = b"bag/../../evil";
                    let mut extra = vec![0x75, 0x70, u8::try_from(5 + other.len()).unwrap(), 0, 1];
                    extra.extend(raw_zip::crc32(b"bag/data/x").to_le_bytes());
                    extra.extend(other);
                    extra
                },
                ..Entry::stored("bag/data/x", "1")
            }],
        ),
    ]
}

/// Entries and structure that readers understand differently, or that are no files.
pub(crate) fn structure() -> Vec<Case> {
    let kind = |name, mode| {
        with(name, vec![Entry { mode, ..Entry::stored(inside("data/x"), "/etc/passwd") }])
    };
    let whole = zip(&entries());
    let mut flipped = entries();
    flipped[8].crc ^= 1;
    let mut shorter = entries();
    shorter[8].size -= 1;
    let mut longer = entries();
    longer[8].size += 1;
    let mut renamed = entries();
    renamed[8].local_name = Some(b"elsewhere".to_vec());
    let mut twins = entries();
    let twin = Entry { shared: true, name: inside("twin").into(), ..twins[8].clone() };
    twins.insert(9, twin);
    let mut before = b"#!/bin/sh\nexit\n".to_vec();
    before.extend(&whole);
    let mut after = whole.clone();
    after.extend(b"\n<script>");
    // Two archives in one file: readers that search for the last end see the other.
    let mut two = whole.clone();
    two.extend(zip(&[Entry::stored(inside("bagit.txt"), "another bag")]));
    let mut commented = whole.clone();
    let hidden = zip(&[Entry::stored(inside("bagit.txt"), "another bag")]);
    let at = commented.len() - 2;
    commented[at..].copy_from_slice(&u16::try_from(hidden.len()).unwrap().to_le_bytes());
    commented.extend(&hidden);
    vec![
        kind("symbolic link", 0o120_777),
        kind("named pipe", 0o010_644),
        kind("character device", 0o020_644),
        with("encryption", vec![Entry { flags: 1, ..Entry::stored(inside("data/x"), "secret") }]),
        with(
            "compression by bzip2",
            vec![Entry { method: 12, ..Entry::stored(inside("data/x"), "BZh9") }],
        ),
        with("folder with content", vec![Entry::stored(inside("data/"), "evil")]),
        with(
            "two bags",
            vec![Entry::stored("other/bagit.txt", ""), Entry::stored("other/data/x", "")],
        ),
        with("a file beside the bag's folder", vec![Entry::stored("autorun.inf", "")]),
        file("wrong CRC", zip(&flipped)),
        file("size declared one byte too small", zip(&shorter)),
        file("size declared one byte too large", zip(&longer)),
        file("another name in the local header", zip(&renamed)),
        file("two names for one entry's bytes", zip(&twins)),
        file("a shell script before the archive", before),
        file("a script after the archive", after),
        file("two archives in one file", two),
        file("an archive in the comment of another", commented),
        file("cut in half", &whole[..whole.len() / 2]),
        file("cut by one byte", &whole[..whole.len() - 1]),
        file("an empty file", ""),
        file("a page that says not found", "<!doctype html><title>404</title>"),
        file("an archive of nothing", raw_zip::end(0, 0, 0)),
    ]
}

/// Archives that would fill the memory or never end.
pub(crate) fn bombs() -> Vec<Case> {
    let many = |count: u32| -> Vec<Entry> {
        (0..count).map(|i| Entry::stored(format!("bag/data/{i}"), "")).collect()
    };
    let mut overlapping =
        vec![Entry::stored(inside("bagit.txt"), ""), Entry::zeros("bag/data/0", 1 << 20, 1 << 20)];
    let packed = overlapping[1].packed.clone();
    overlapping.extend((1..900).map(|i| Entry {
        shared: true,
        packed: packed.clone(),
        ..Entry::zeros(&format!("bag/data/{i}"), 0, 1 << 20)
    }));
    // The central directory of almost a million files, of which the end admits 65535.
    let mut directory = many(1);
    let header = Entry { shared: true, ..Entry::stored("a", "") };
    directory.extend(std::iter::repeat_n(header, 800_000));
    vec![
        with("49 MiB of zeros", vec![Entry::zeros("bag/data/x", 49 << 20, 49 << 20)]),
        with("a gigabyte that declares ten bytes", vec![Entry::zeros("bag/data/x", 1 << 30, 10)]),
        with(
            "a gigabyte that declares 40 MiB",
            vec![Entry::zeros("bag/data/x", 1 << 30, 40 << 20)],
        ),
        with("ten bytes that declare 4 GiB", vec![Entry::zeros("bag/data/x", 10, u32::MAX)]),
        file("nine hundred names for one MiB", zip(&overlapping)),
        with("20000 files too many", many(40_000)),
        file("800000 headers", zip(&directory)),
        file("a file of 49 MiB", vec![b'P'; 49 << 20]),
    ]
}

/// What only a folder can hold.
#[cfg(unix)]
pub(crate) fn folders() -> Vec<Case> {
    use std::ffi::OsStr;
    use std::fs;
    use std::os::unix::ffi::OsStrExt as _;
    use std::os::unix::fs::symlink;
    use std::os::unix::net::UnixListener;
    use std::path::Path;
    use std::process::Command;

    fn folder(name: &'static str, add: impl Fn(&Path) + 'static) -> Case {
        Case::new(name, 0, Made::Folder(Box::new(add)))
    }
    vec![
        folder("symbolic link to a file", |bag| {
            symlink("/etc/passwd", bag.join("data/inputs/passwd")).unwrap();
        }),
        folder("symbolic link to a folder above", |bag| {
            symlink("..", bag.join("data/loop")).unwrap();
        }),
        folder("named pipe that never ends", |bag| {
            let made = Command::new("mkfifo").arg(bag.join("data/pipe")).status().unwrap();
            assert!(made.success());
        }),
        folder("socket", |bag| drop(UnixListener::bind(bag.join("data/s")).unwrap())),
        folder("name that is not UTF-8 in a folder", |bag| {
            fs::write(bag.join(OsStr::from_bytes(b"data/\xff")), "").unwrap();
        }),
        folder("names in two Unicode normal forms in a folder", |bag| {
            fs::write(bag.join("data/caf\u{e9}"), "").unwrap();
            fs::write(bag.join("data/cafe\u{301}"), "").unwrap();
        }),
        folder("a sparse file of a terabyte", |bag| {
            fs::File::create(bag.join("data/sparse")).unwrap().set_len(1 << 40).unwrap();
        }),
        folder("20000 empty folders", |bag| {
            for i in 0..20_000 {
                fs::create_dir(bag.join(format!("data/{i}"))).unwrap();
            }
        }),
        folder("folders a thousand deep", |bag| {
            let deep = bag.join("data").join("d/".repeat(1000));
            fs::create_dir_all(&deep).unwrap();
            symlink("/", deep.join("end")).unwrap();
        }),
        folder("no declaration", |bag| fs::remove_file(bag.join("bagit.txt")).unwrap()),
    ]
}
