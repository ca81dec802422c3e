//! Level 0: archives and folders that must not even be opened.

use super::case::{Case, Made};
use super::raw_zip::{self, Entry, Header, Tail, zip, zip_with};
use super::study::HONEST;

/// Returns the honest bag's entries.
fn entries() -> Vec<Entry> {
    let name = |path: &str| format!("{}/{path}", HONEST.root);
    HONEST.tree.iter().map(|(path, bytes)| Entry::stored(name(path), bytes.clone())).collect()
}

/// Returns a name in the bag's folder.
fn inside(path: &str) -> String {
    format!("bag/{path}")
}

/// Makes a small bag with one more file under a name of the attacker's.
fn with_name(name: &'static str, entry: impl Into<Vec<u8>>) -> Case {
    with(name, vec![Entry::stored(entry, "evil")])
}

/// Makes a small bag with more entries.
fn with(name: &'static str, more: Vec<Entry>) -> Case {
    let mut all = vec![Entry::stored(inside("bagit.txt"), "")];
    all.extend(more);
    Case::new(name, 0, Made::File(zip(&all)))
}

/// Returns files, and folders where the path ends in `/`.
fn over(paths: &[&str]) -> Vec<Entry> {
    let entry = |path: &&str| match path.strip_suffix('/') {
        Some(_) => Entry::folder(inside(path)),
        None => Entry::stored(inside(path), "x"),
    };
    paths.iter().map(entry).collect()
}

fn file(name: &'static str, bytes: impl Into<Vec<u8>>) -> Case {
    Case::new(name, 0, Made::File(bytes.into()))
}

/// Returns names that lead out of the folder or that some system takes for another.
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
            vec![Entry::stored("bag/data/x", "1").says(|header| {
                header.extra = raw_zip::unicode(0x7075, b"bag/data/x", b"bag/../../evil");
            })],
        ),
        with(
            "a Unicode path extra field in the local header only",
            vec![Entry::stored("bag/data/x", "1").says_locally(|header| {
                header.extra = raw_zip::unicode(0x7075, b"bag/data/x", b"bag/data/y");
            })],
        ),
        with_name("a name of 256 letters", format!("bag/data/{}", "x".repeat(256))),
        with_name(
            "a path of 1001 letters",
            format!("bag/{}x", "data/".repeat(200))[..1001].to_owned(),
        ),
        with("a folder entry over a file", over(&["data/x", "data/x/"])),
        with("a folder entry under a file", over(&["data/x/", "data/x"])),
        with("a folder entry over a file in another case", over(&["data/x", "data/X/"])),
        with("a folder entry twice", over(&["data/", "data/x", "data/"])),
        with("a folder that holds nothing", over(&["data/x", "data/empty/"])),
        with("a folder that leads out", over(&["data/x", "../evil/"])),
    ]
}

/// Returns entries and structure that readers understand differently, or that are no files.
pub(crate) fn structure() -> Vec<Case> {
    let kind = |name, mode| {
        with(name, vec![Entry { mode, ..Entry::stored(inside("data/x"), "/etc/passwd") }])
    };
    let whole = zip(&entries());
    let mut flipped = entries();
    flipped[8].central.crc ^= 1;
    let mut shorter = entries();
    shorter[8].central.size -= 1;
    let mut longer = entries();
    longer[8].central.size += 1;
    let mut renamed = entries();
    renamed[8] = renamed[8].clone().says_locally(|header| header.name = b"elsewhere".to_vec());
    let mut twins = entries();
    let twin = twins[8].clone().says(|header| header.name = inside("twin").into());
    twins.insert(9, Entry { shared: true, ..twin });
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
        with("encryption", vec![x("secret").says(|header| header.flags = 1)]),
        with("encryption in the local header only", vec![x("1").says_locally(|h| h.flags = 1)]),
        with("compression by bzip2", vec![x("BZh9").says(|header| header.method = 12)]),
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

fn x(content: &str) -> Entry {
    Entry::stored(inside("data/x"), content)
}

/// Files that the honest bag does not list.
const SCRIPT: &str = "#!/bin/sh\necho code ran\nexit\n";

/// Makes the honest bag with something done to the entry of `data/inputs/basic.yaml`.
fn changed(name: &'static str, change: impl FnOnce(Entry) -> Entry) -> Case {
    let mut all = entries();
    all[8] = change(all[8].clone());
    file(name, zip(&all))
}

/// Makes the same bag with that entry compressed.
fn deflated(name: &'static str, change: impl FnOnce(Entry) -> Entry) -> Case {
    changed(name, |entry| change(Entry::deflated(entry.central.name, entry.data)))
}

/// Makes the honest bag with something else behind its entries.
fn ended(name: &'static str, tail: &Tail) -> Case {
    file(name, zip_with(&entries(), tail))
}

/// Makes the honest bag's files under another root.
fn rooted(name: &'static str, root: &str, more: &[(&str, &str)]) -> Case {
    let tree = HONEST.tree.iter().map(|(path, bytes)| (path.as_str(), bytes.as_slice()));
    let more = more.iter().map(|(path, text)| (*path, text.as_bytes()));
    let named = |(path, bytes): (&str, &[u8])| Entry::stored(format!("{root}{path}"), bytes);
    file(name, zip(&tree.chain(more).map(named).collect::<Vec<_>>()))
}

/// Returns the honest bag, whole, and bytes that belong to no file of it, or that readers take for different ones.
pub(crate) fn bytes_of_nobody() -> Vec<Case> {
    let hidden = zip(&[x("hidden")]);
    let entry = hidden[..hidden.windows(4).position(|w| w == b"PK\x01\x02").unwrap()].to_vec();
    let mut nested = entries();
    // The bytes of one entry are the header and the bytes of another.
    let name = inside("data/y");
    nested = nested.into_iter().take(3).collect();
    nested.push(Entry::stored(name, entry.clone()));
    let into = i32::try_from(30 + inside("data/y").len()).unwrap();
    nested.push(Entry { shared: true, shift: into, ..x("hidden") });
    let mut pieces = zip(&entries());
    let at = pieces.len() - 18;
    pieces[at..at + 2].copy_from_slice(&[1, 0]);
    let mut zeros = zip(&entries());
    zeros.extend([0; 512]);
    let sized = |header: &mut Header| {
        let size = u64::from(header.size) - 1;
        header.extra = raw_zip::extra(1, &size.to_le_bytes());
    };
    vec![
        {
            let mut all = entries();
            all[0].before = SCRIPT.into();
            file("a shell script before the archive, with offsets that are right", zip(&all))
        },
        changed("five thousand bytes between two entries", |entry| Entry {
            before: SCRIPT.repeat(160).into(),
            ..entry
        }),
        changed("a file between two entries that nothing lists", |e| Entry {
            before: entry.clone(),
            ..e
        }),
        ended(
            "bytes between the last entry and the directory",
            &Tail { gap: SCRIPT.into(), ..Tail::default() },
        ),
        ended(
            "a file before the directory that nothing lists",
            &Tail { gap: entry, ..Tail::default() },
        ),
        ended(
            "bytes between the directory and the end",
            &Tail { behind: SCRIPT.into(), ..Tail::default() },
        ),
        ended("64 KiB of comment", &Tail { comment: vec![b'x'; 0xffff], ..Tail::default() }),
        file("zeros behind the end", zeros),
        file("an entry within another entry's bytes", zip(&nested)),
        changed("an entry with a comment", |e| Entry { comment: SCRIPT.into(), ..e }),
        changed("a Unicode comment", |e| {
            let field = raw_zip::unicode(0x6375, b"", b"verified by the ACM");
            e.says(|header| header.extra = field)
        }),
        ended("an end that counts one entry less", &Tail { miscount: -1, ..Tail::default() }),
        ended("an end that counts one entry more", &Tail { miscount: 1, ..Tail::default() }),
        ended(
            "a zip64 end that counts one entry less",
            &Tail { long: Some(-1), ..Tail::default() },
        ),
        file("the second piece of an archive", pieces),
        deflated("junk behind a deflate stream", |mut entry| {
            entry.data.extend(SCRIPT.bytes());
            let data = entry.data.clone();
            entry.replaced(data)
        }),
        deflated("a deflate stream without its end", |mut entry| {
            entry.data.pop();
            let data = entry.data.clone();
            entry.replaced(data)
        }),
        deflated("a data descriptor with another checksum", |entry| {
            let mut streamed = entry.streamed();
            streamed.descriptor[4] ^= 1;
            streamed
        }),
        deflated("a data descriptor with another size", |entry| {
            let mut streamed = entry.streamed();
            streamed.descriptor[12] ^= 1;
            streamed
        }),
        deflated("a data descriptor with another packed size", |entry| {
            let mut streamed = entry.streamed();
            streamed.descriptor[8] ^= 1;
            streamed
        }),
        deflated("no data descriptor where the headers promise one", |entry| Entry {
            descriptor: Vec::new(),
            ..entry.streamed()
        }),
        deflated("a data descriptor that no header promises", |entry| {
            let Header { crc, packed, size, .. } = entry.central;
            Entry { descriptor: raw_zip::descriptor(crc, packed, size), ..entry }
        }),
        deflated("sizes of zero in the local header without a data descriptor", |entry| {
            entry.says_locally(|h| (h.crc, h.packed, h.size) = (0, 0, 0))
        }),
        changed("another method in the local header", |e| e.says_locally(|h| h.method = 8)),
        changed("another size in the local header", |e| e.says_locally(|h| h.size -= 1)),
        deflated("another packed size in the local header", |e| e.says_locally(|h| h.packed -= 1)),
        changed("another checksum in the local header", |e| e.says_locally(|h| h.crc ^= 1)),
        changed("a stored file with two sizes", |e| e.says(|h| h.packed -= 1)),
        changed("a zip64 field that gives another size", |e| e.says(sized)),
        changed("a zip64 field with another size in the local header", |e| e.says_locally(sized)),
        changed("a zip64 field twice", |e| {
            e.says(|header| {
                let size = header.size;
                header.size = u32::MAX;
                header.extra = [size, size - 1]
                    .iter()
                    .flat_map(|size| raw_zip::extra(1, &u64::from(*size).to_le_bytes()))
                    .collect();
            })
        }),
        changed("an extra field that nobody knows", |e| {
            e.says(|header| header.extra = raw_zip::extra(0xbeef, SCRIPT.as_bytes()))
        }),
        changed("an extra field that is cut", |e| {
            e.says(|header| header.extra = b"UT\x09\x00\x03".to_vec())
        }),
        changed("an entry of another system", |e| Entry { system: 2, ..e }),
        changed("a newer version of zip", |e| e.says(|header| header.version = 63)),
        changed("a patch instead of a file", |e| e.says(|header| header.flags |= 1 << 5)),
        changed("a folder by its mode and a file by its name", |e| Entry { mode: 0o040_755, ..e }),
        changed("a folder by its attributes and a file by its name", |e| Entry {
            attributes: 0x10,
            mode: 0,
            ..e
        }),
        changed("the name of a disk", |e| Entry { attributes: 0x08, ..e }),
        rooted("a bag in a folder named data", "data/", &[]),
        rooted("a bag in a folder named bagit.txt", "bagit.txt/", &[]),
        rooted("a bag and a crate at one root", "", &[("ro-crate-metadata.json", "{}")]),
        rooted("a bag and another in a folder beside it", "", &[("bag/bagit.txt", "")]),
        rooted("a crate beside the bag's payload", "bag/", &[("ro-crate-metadata.json", "{}")]),
        rooted("a bag within the payload", "bag/", &[("data/bagit.txt", "")]),
    ]
}

/// Returns archives that would fill the memory or never end.
pub(crate) fn bombs() -> Vec<Case> {
    let many = |count: u32| -> Vec<Entry> {
        (0..count).map(|i| Entry::stored(format!("bag/data/{i}"), "")).collect()
    };
    let mut overlapping =
        vec![Entry::stored(inside("bagit.txt"), ""), Entry::zeros("bag/data/0", 1 << 20, 1 << 20)];
    let packed = overlapping[1].data.clone();
    overlapping.extend((1..900).map(|i| {
        let entry = Entry::zeros(&format!("bag/data/{i}"), 0, 1 << 20).replaced(packed.clone());
        Entry { shared: true, ..entry }
    }));
    // Every path names hundreds of folders that no other names.
    let deep = |i| Entry::stored(format!("bag/{i:05}{}", "/x".repeat(490)), "");
    let empty = |i| Entry::folder(format!("bag/data/{i}/"));
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
        with("15000 empty folders", (0..15_000).map(empty).collect()),
        with("15000 paths of 490 folders each", (0..15_000).map(deep).collect()),
        file("a file of 49 MiB", vec![b'P'; 49 << 20]),
    ]
}

/// Returns what only a folder can hold.
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
        folder("an empty folder", |bag| fs::create_dir(bag.join("data/empty")).unwrap()),
        folder("folders in folders, and no file", |bag| {
            fs::create_dir_all(bag.join("data/a/b/c")).unwrap();
        }),
        folder("a bag within the payload of a folder", |bag| {
            fs::write(bag.join("data/bagit.txt"), "").unwrap();
        }),
        folder("no declaration", |bag| fs::remove_file(bag.join("bagit.txt")).unwrap()),
    ]
}
