//! Archives whose sizes and places need eight bytes: more than 4 GiB, as records of many million trials are. Minutes and 5 GB of disk,
//! so `.ci/full` runs it.

use crate::adversary::forger;
use crate::sandbox::{Sandbox, repository};
use reenact::bundle::{Archive, Content, Files, Form, LargeFiles, Limits, Source, archive};
use reenact::digest::Sha256Digest;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

/// Bytes that do not compress, each block of eight by its place alone (SplitMix64).
#[derive(Debug)]
struct Noise(u64);

impl Source for Noise {
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
        let count =
            into.len().min(usize::try_from(self.0.saturating_sub(at)).unwrap_or(usize::MAX));
        for (byte, at) in into[..count].iter_mut().zip(at..) {
            let mut mixed = (at / 8 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            *byte = (mixed ^ mixed >> 31).to_le_bytes()[usize::try_from(at % 8).unwrap()];
        }
        Ok(count)
    }
}

const RECORDS: &str = "data/trials/floor-plan.jsonl";
/// 4.3 GiB, which do not become less by compression.
const SIZE: u64 = (4 << 30) + (300 << 20);

/// Writes the quickstart's bundle with [`RECORDS`] of that size, and lists of what is in it that say so.
fn write(to: &Path) {
    let quickstart = fs::read(repository().join("artifacts/quickstart-published.zip")).unwrap();
    let Archive { mut tree, .. } = archive::read(&quickstart, &Limits::default()).unwrap();
    let records = archive::file_of_folder(RECORDS, Arc::new(Noise(SIZE)), SIZE).unwrap();
    let Content::Large(records) = records else { panic!("held in memory") };
    let listed = |name: &str, digest: Sha256Digest| {
        let (name, digest) = (name.to_owned(), digest.to_string());
        move |text: &str| {
            let line = |line: &str| match line.split_once("  ") {
                Some((_, path)) if path == name => format!("{digest}  {path}\n"),
                _ => format!("{line}\n"),
            };
            text.lines().map(line).collect::<String>()
        }
    };
    tree.remove(RECORDS);
    forger::edit(&mut tree, forger::MANIFEST, listed(RECORDS, records.digest()));
    let payload = tree.iter().filter(|(path, _)| path.starts_with("data/"));
    let (count, bytes) = payload.fold((1, SIZE), |(n, sum), (_, b)| (n + 1, sum + b.len() as u64));
    forger::edit(&mut tree, forger::INFO, |text| {
        let line = |line: &str| match line.split_once(": ") {
            Some(("Payload-Oxum", _)) => format!("Payload-Oxum: {bytes}.{count}\n"),
            _ => format!("{line}\n"),
        };
        text.lines().map(line).collect()
    });
    for path in [forger::MANIFEST, forger::INFO] {
        let digest = Sha256Digest::of(&tree[path]);
        forger::edit(&mut tree, forger::TAG_MANIFEST, listed(path, digest));
    }
    let large = LargeFiles::from([(RECORDS.to_owned(), records)]);
    let files = Files { tree: &tree, large: &large };
    archive::write_to(files, "large", Form::Bag, File::create(to).unwrap()).unwrap();
}

#[test]
#[ignore = "minutes and 5 GB of disk (`.ci/full large`)"]
fn an_archive_of_more_than_4_gib_is_written_for_everybody_and_read() {
    let desk = Sandbox::new();
    let bundle = desk.path("large.zip");
    write(&bundle);
    assert!(fs::metadata(&bundle).unwrap().len() > SIZE);

    let read = desk.run(&["verify", "--level", "1", "--max-size", "8G", "large.zip"]);
    assert_eq!(
        (read.code, &*read.stdout),
        (
            0,
            "  0 safe      passed\n  1 fixity    passed\n\
             reached level 1 (fixity) of level 1 (fixity): the bundle is what it says\n"
        ),
        "{}",
        read.stderr
    );
    let refused = desk.run(&["verify", "--level", "1", "large.zip"]);
    assert_eq!(refused.code, 1);
    assert!(refused.stdout.contains("`--max-size` admits it"), "{}", refused.stdout);

    // What everybody has reads it as well: Info-ZIP, and Python's own library.
    for (program, before) in [("unzip", &["-tqq"][..]), ("python3", &["-m", "zipfile", "-t"])] {
        let tried = Command::new(program).args(before).arg(&bundle).output();
        let tried = tried.unwrap_or_else(|error| panic!("{program}: {error}"));
        assert!(tried.status.success(), "{program}: {}", String::from_utf8_lossy(&tried.stderr));
    }
}
