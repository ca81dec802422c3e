use super::super::sample;
use super::*;
use proptest::prelude::*;
use zip::ZipArchive;

fn faults(zip: &[u8]) -> Vec<String> {
    read(zip, &Limits::default()).unwrap_err().iter().map(ToString::to_string).collect()
}

#[test]
fn all_forms_are_read_back_and_written_alike_every_time() {
    let sealed = sample::sealed();
    for form in [Form::Bag, Form::Flat, Form::Crate] {
        let zip = sealed.zip(form);
        assert_eq!(zip, sample::sealed().zip(form), "byte-identical");
        let archive = read(&zip, &Limits::default()).unwrap();
        assert_eq!(archive.form, form);
        let expected: Tree = sealed
            .tree
            .iter()
            .filter(|(path, _)| form != Form::Crate || path.starts_with("data/"))
            .map(|(path, bytes)| (path.clone(), bytes.clone()))
            .collect();
        assert_eq!(archive.tree, expected);
    }
    let files = sealed.tree.clone().into_iter().collect();
    assert_eq!(from_files(files, &Limits::default()).unwrap().tree, sealed.tree);
}

#[test]
fn tag_files_come_first_and_nothing_depends_on_the_day() {
    let zip = sample::sealed().zip(Form::Flat);
    let names: Vec<_> = {
        let archive = ZipArchive::new(Cursor::new(&zip)).unwrap();
        archive.file_names().map(|name| name.unwrap().into_owned()).collect()
    };
    let expected = ["bagit.txt", "bag-info.txt", "manifest-sha256.txt", "tagmanifest-sha256.txt"];
    assert_eq!(names[..4], expected);
    assert!(names[4..].is_sorted() && names[4..].iter().all(|name| name.starts_with("data/")));
    let mut archive = ZipArchive::new(Cursor::new(&zip)).unwrap();
    for i in 0..archive.len() {
        let entry = archive.by_index(i).unwrap();
        assert_eq!(entry.last_modified(), Some(DateTime::default()));
        assert_eq!(entry.unix_mode(), Some(0o100_644));
        assert_eq!(entry.extra_data().unwrap_or_default(), Vec::<u8>::new());
    }
}

#[test]
fn sizes_of_eight_bytes_are_read_as_they_are_written() {
    let sealed = sample::sealed();
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in &sealed.tree {
        let options = options().compression_method(CompressionMethod::Deflated).large_file(true);
        zip.start_file(path.as_str(), options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    let zip = zip.finish().unwrap().into_inner();
    assert!(
        zip.windows(8).any(|w| w == [0xff; 8]),
        "the local headers say that sizes are elsewhere"
    );
    assert_eq!(read(&zip, &Limits::default()).unwrap().tree, sealed.tree);
}

fn elsewhere(bytes: Vec<u8>) -> Arc<dyn Source> {
    Arc::new(bytes)
}

#[test]
fn large_files_stay_where_they_are() {
    let mut tree = sample::sealed().tree;
    let lines = "x".repeat(99) + "\n";
    tree.insert("data/trials/none.jsonl".to_owned(), lines.repeat(20_000).into_bytes());
    tree.insert("data/inputs/big.csv".to_owned(), lines.repeat(20_000).into_bytes());
    for form in [Form::Bag, Form::Flat] {
        let zip = write(&tree, "b", form);
        let length = zip.len() as u64;
        let archive =
            read_from(&elsewhere(zip.clone()), length, &Limits::default()).unwrap().unwrap();
        let paths: Vec<&String> = archive.large.keys().collect();
        assert_eq!(paths, ["data/trials/none.jsonl"], "{form:?}");
        let file = archive.files().get("data/trials/none.jsonl").unwrap();
        assert_eq!(file.whole(3 << 20).unwrap(), tree["data/trials/none.jsonl"]);
        assert_eq!((file.whole(1 << 20), file.line_count()), (None, 20_000));
        assert!(write_files(archive.files(), "b", form) == zip, "written as it was");
        let few = Limits { held: 1 << 20, ..Limits::default() };
        let refused = read_from(&elsewhere(zip), length, &few).unwrap().unwrap_err();
        let told: Vec<String> = refused.iter().map(ToString::to_string).collect();
        assert!(
            told[0].starts_with(
                "(archive): expected at most 1048576 bytes beside records and tables of trials, found "
            ) && told[0].ends_with(" bytes declared (it may be a zip bomb)"),
            "{told:?}"
        );
    }
}

#[test]
fn a_bundle_that_is_larger_than_the_reader_admits_says_how_to_admit_it() {
    let (zip, small) = (sample::zip(), Limits { bytes: 1000, ..Limits::default() });
    let length = zip.len() as u64;
    let refused = read_from(&elsewhere(zip.to_vec()), length, &small).unwrap().unwrap_err();
    let told = refused[0].to_string();
    assert!(
        told.starts_with(&format!("(archive): expected at most 1000 bytes unpacked from {length}, found "))
            && told.ends_with(
                " bytes declared (where you trust that it is so large, `--max-size` admits it: `--max-size 8G`)"
            ),
        "{told}"
    );
}

#[test]
fn hostile_names_are_refused() {
    for (name, fault) in [
        (
            "../evil",
            "../evil: expected a safe relative path, found a path that climbs out of its folder",
        ),
        ("/etc/evil", "/etc/evil: expected a safe relative path, found an absolute path"),
        (
            "C:/evil",
            "C:/evil: expected a safe relative path, found a drive letter or a colon in its name",
        ),
        ("b\\evil", "b\\\\evil: expected a safe relative path, found a backslash in its name"),
        (
            "b/\u{1}",
            "b/\\u{1}: expected a safe relative path, found a control character in its name",
        ),
        ("b//x", "b//x: expected a safe relative path, found an empty part in its path"),
        (
            "b/nul.txt",
            "b/nul.txt: expected a safe relative path, found the name of a Windows device",
        ),
        ("b/x.", "b/x.: expected a safe relative path, found a name that ends in a dot or a space"),
        (
            "b/e\u{301}",
            "b/e\u{301}: expected a name of A-Z a-z 0-9 . _ - only, found other characters, which systems spell in more \
             than one way",
        ),
        (
            "b/BAGIT.txt",
            "b/BAGIT.txt: expected names that differ on every system, found `b/bagit.txt` beside it",
        ),
        (
            "b/bagit.txt/x",
            "b/bagit.txt/x: expected names that differ on every system, found `b/bagit.txt` beside it",
        ),
        ("c/other", "(archive): expected the one folder `b`, found `c` beside it"),
    ] {
        let zip = sample::zip_of(&[("b/bagit.txt", b""), (name, b"x")]);
        assert_eq!(faults(&zip), [fault]);
    }
}

#[test]
fn hostile_structure_is_refused() {
    let zip = sample::zip_of(&[("b/bagit.txt", b""), ("b/one", b"x"), ("b/two", b"yy")]);
    // Both names have one length, so the headers can be changed in place.
    let mut twice = zip.clone();
    sample::replace(&mut twice, b"b/two", b"b/one");
    assert_eq!(faults(&twice), ["b/one: expected one entry of this name, found several"]);

    let mut central_only = zip.clone();
    let last = central_only.windows(5).rposition(|w| w == b"b/two").unwrap();
    central_only[last..last + 5].copy_from_slice(b"b/twO");
    assert_eq!(
        faults(&central_only),
        ["b/twO: expected the same name in its local header, found `b/two`"]
    );

    let mut link = ZipWriter::new(Cursor::new(Vec::new()));
    link.add_symlink("b/link", "/etc/passwd", SimpleFileOptions::default()).unwrap();
    let link = link.finish().unwrap().into_inner();
    assert_eq!(faults(&link), ["b/link: expected a plain file, found a symbolic link"]);

    let mut encrypted = zip.clone();
    let at = encrypted.windows(4).rposition(|w| w == b"PK\x01\x02").unwrap();
    encrypted[at + 8] |= 1;
    assert!(
        faults(&encrypted).contains(&"b/two: expected a plain file, found encryption".to_owned())
    );

    let mut prefixed = b"#!/bin/sh\n".to_vec();
    prefixed.extend(&zip);
    assert_eq!(
        faults(&prefixed),
        ["(archive): expected a zip that begins at the first byte, found 10 bytes before it"]
    );
    let cut = "(archive): expected a whole zip archive, found no end record (is it a zip, and did all of it arrive?)";
    assert_eq!(faults(&zip[..zip.len() / 2]), [cut]);
    assert_eq!(faults(b""), [cut]);
    assert_eq!(
        faults(&sample::zip_of(&[("x/readme", b"")])),
        [
            "(archive): expected one bag (bagit.txt) or crate (ro-crate-metadata.json), found neither (is it a bundle, and \
          is it whole?)"
        ]
    );
    assert_eq!(
        faults(&sample::zip_of(&[("x/bagit.txt", b""), ("y/bagit.txt", b"")])),
        [
            "(archive): expected one bag (bagit.txt) or crate (ro-crate-metadata.json), found a bag in `x`, a bag in \
          `y` (is it a bundle, and is it whole?)"
        ]
    );
}

#[test]
fn bombs_and_forged_sizes_are_refused() {
    let zeros = vec![0_u8; 48 << 20];
    let bomb = sample::zip_of(&[("b/bagit.txt", b""), ("b/zeros", &zeros)]);
    let limits = Limits { ratio: 100, ..Limits::default() };
    let found = read(&bomb, &limits).unwrap_err();
    assert_eq!(found.len(), 1);
    assert!(found[0].to_string().ends_with("found 50331648 bytes declared (it may be a zip bomb)"));
    let many: Vec<String> = (0..30).map(|i| format!("b/{i}")).collect();
    let many: Vec<(&str, &[u8])> = many.iter().map(|name| (name.as_str(), &b""[..])).collect();
    let limits = Limits { entries: 20, ..Limits::default() };
    let found = read(&sample::zip_of(&many), &limits).unwrap_err();
    assert_eq!(found[0].to_string(), "(archive): expected at most 20 entries, found 30 entries");

    // A size forged in both headers: the entry still unpacks to more than it declares.
    let honest = sample::zip_of(&[("b/bagit.txt", b""), ("b/text", &[b'x'; 5000])]);
    let mut forged = honest.clone();
    sample::replace(&mut forged, &5000_u32.to_le_bytes(), &10_u32.to_le_bytes());
    assert!(
        faults(&forged)[0]
            .starts_with("b/text: expected an entry that unpacks to its declared size"),
        "{:?}",
        faults(&forged)
    );
    let mut flipped = sample::zip_of(&[("b/bagit.txt", b""), ("b/text", b"stored as it is")]);
    let crc = flipped.windows(4).position(|w| w == b"PK\x01\x02").unwrap() + 16;
    let old = flipped[crc + 46..].len(); // the second central header follows the first
    assert!(old > 0);
    let text = flipped.windows(6).position(|w| w == b"b/text").unwrap() + 6;
    flipped[text + 2] ^= 1;
    assert!(
        faults(&flipped)[0]
            .starts_with("b/text: expected an entry that unpacks to its declared size"),
        "{:?}",
        faults(&flipped)
    );
}

/// Checks that every end of an archive, and every byte that is put into it, is noticed.
#[test]
fn no_byte_may_be_taken_or_added_anywhere() {
    let zip = sample::zip_of(&[("b/bagit.txt", b"x"), ("b/one", b""), ("b/two", b"yy")]);
    assert!(read(&zip, &Limits::default()).is_ok());
    for at in 0..=zip.len() {
        if at < zip.len() {
            assert!(read(&zip[..at], &Limits::default()).is_err(), "cut at {at}");
            let mut less = zip.clone();
            less.remove(at);
            assert!(read(&less, &Limits::default()).is_err(), "without byte {at}");
        }
        for byte in [0, b'x', b'P'] {
            let mut more = zip.clone();
            more.insert(at, byte);
            assert!(read(&more, &Limits::default()).is_err(), "{byte} put in at {at}");
        }
    }
}

#[test]
fn extra_fields_that_change_nothing_are_read_over() {
    let field = |id: u16, field: &[u8]| {
        let length = u16::try_from(field.len()).unwrap();
        [&id.to_le_bytes(), &length.to_le_bytes(), field].concat()
    };
    let sizes = field(0x0001, &[7; 16]);
    assert_eq!(extra::read(&sizes).unwrap().zip64, Some(&[7; 16][..]));
    for honest in [
        field(0x5455, &[3, 0, 0, 0, 0]),
        field(0x7875, &[1, 4, 0, 0, 0, 0, 4, 0, 0, 0, 0]),
        [field(0x5455, &[7; 13]), field(0x7875, &[1, 0, 0]), field(0x7855, &[])].concat(),
        field(0x5855, &[0; 8]),
        field(0x000a, &[&[0; 4], &[1, 0, 24, 0], &[9; 24][..]].concat()),
    ] {
        assert_eq!(extra::read(&honest).unwrap().zip64, None, "{honest:?}");
    }
    for (hostile, found) in [
        (field(0x7075, b"\x01CRC.other"), "field 0x7075, which gives the file another name"),
        (field(0x6375, b"\x01CRC.other"), "field 0x6375, which holds a comment"),
        (field(0x9901, &[0; 7]), "field 0x9901, which is for encryption"),
        (field(0x000d, &[0; 12]), "field 0x000d, which can make it a link"),
        ([sizes.clone(), sizes].concat(), "field 0x0001 twice"),
        (field(0x5455, b"#!/bin/sh"), "field 0x5455 of 9 bytes that are not its own"),
        (field(0x5455, b"#!/bin/sh1234"), "field 0x5455 of 13 bytes that are not its own"),
        (
            field(0x7875, &[1, 4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 9]),
            "field 0x7875 of 12 bytes that are not its own",
        ),
        (field(0x7875, &[1, 200, 0]), "field 0x7875 of 3 bytes that are not its own"),
        (field(0x000a, &[1; 32]), "field 0x000a of 32 bytes that are not its own"),
        (field(0xbeef, &[]), "field 0xbeef, whose meaning is unknown"),
        (b"UT\x05\x00\x03".to_vec(), "5 bytes that are none"),
        (b"UT".to_vec(), "2 bytes that are none"),
    ] {
        assert_eq!(extra::read(&hostile).unwrap_err().to_string(), found);
    }
}

#[test]
fn folders_hold_files_and_faults_have_an_end() {
    let files =
        |paths: &[&str]| paths.iter().map(|path| ((*path).to_owned(), Vec::new())).collect();
    let said = |paths: &[&str]| -> Vec<String> {
        let refused = from_files(files(paths), &Limits::default()).unwrap_err();
        refused.iter().map(ToString::to_string).collect()
    };
    let whole = ["bagit.txt", "data/", "data/inputs/", "data/inputs/x"];
    assert_eq!(from_files(files(&whole), &Limits::default()).unwrap().tree.len(), 2);
    assert_eq!(
        said(&["bagit.txt", "data/", "data/x-1", "data/x/"]),
        ["data/x/: expected a folder that holds files, found none in it (no checksum covers it)"]
    );
    assert_eq!(
        said(&["bagit.txt", "data/", "data/x/", "data/x/y/"]),
        [
            "data/: expected a folder that holds files, found none in it, nor in 2 more (no checksum covers it)"
        ]
    );
    assert_eq!(
        said(&["bagit.txt", "data/x", "data/x/"])[0],
        "data/x/: expected names that differ on every system, found `data/x` beside it"
    );
    let hostile: Vec<String> = (0..150).map(|i| format!("b/{i}:x")).collect();
    let hostile = said(&hostile.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(hostile.len(), 101);
    assert_eq!(hostile[100], "(archive): expected no fault, found 50 more like these");
    let deep = format!("b{}", "/x".repeat(400));
    let limits = Limits { entries: 300, ..Limits::default() };
    assert_eq!(
        from_files(files(&[&deep]), &limits).unwrap_err()[0].to_string(),
        "(archive): expected at most 300 files and folders, found more"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(read(&bytes, &Limits::default()).is_err());
    }

    #[test]
    fn mutated_zips_never_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
                                cut in any::<prop::sample::Index>(), truncate in any::<bool>()) {
        let honest = sample::zip();
        let mut zip = honest.to_vec();
        for (at, value) in changes {
            let at = at.index(zip.len());
            zip[at] = value;
        }
        if truncate {
            zip.truncate(cut.index(zip.len()));
        }
        // Whatever is still read must be what was sealed, or fail the checksums (level 1) afterwards.
        if let Ok(archive) = read(&zip, &Limits::default()) {
            let _ = super::super::Bundle::open(archive);
        }
    }

    #[test]
    fn any_file_list_is_read_or_refused(files in prop::collection::vec((".{0,12}", prop::collection::vec(any::<u8>(), 0..8)), 0..5)) {
        let _ = from_files(files, &Limits::default());
    }
}
