//! The engine's own source and lock file, sealed into a bundle as data on request (`run --capsule`).
//!
//! In ten years a registry may be gone; a bundle with its capsule still holds what its trials were run with. The capsule is
//! never unpacked, built or run by this program, and lies outside the result half: who seals it changes no result.

use super::{Tree, archive, format};

/// The source this program was built from, as `build.rs` packs it.
const PACKED: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/capsule.deflate"));

/// A sealed source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Capsule {
    /// Where it lies, relative to `data/`.
    pub path: String,
    /// A zip of one folder, its files stored as they are: no compressor can change a byte of it.
    pub bytes: Vec<u8>,
}

/// Returns the source this program was built from.
fn source() -> Tree {
    const OURS: &str = "the build script packs it so";
    fn number(bytes: &[u8]) -> (usize, &[u8]) {
        let (number, rest) = bytes.split_first_chunk().expect(OURS);
        (usize::try_from(u64::from_le_bytes(*number)).expect(OURS), rest)
    }
    let (length, packed) = number(PACKED);
    let plain = archive::inflate(packed, length as u64).expect(OURS);
    let (mut files, mut rest) = (Tree::new(), &plain[..]);
    while !rest.is_empty() {
        let (path, behind) = number(rest);
        let (length, behind) = number(behind);
        let (path, behind) = behind.split_at(path);
        let (bytes, behind) = behind.split_at(length);
        files.insert(String::from_utf8(path.to_vec()).expect(OURS), bytes.to_vec());
        rest = behind;
    }
    files
}

/// Returns this program's own capsule: the same bytes from every build of the same source.
pub fn own() -> Capsule {
    let tree = source();
    let version = format::VERSION;
    Capsule {
        path: format!("{}reenact-{version}-source.zip", format::ENGINE),
        bytes: archive::store(&tree, &format!("reenact-{version}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Read as _};
    use std::path::Path;

    #[test]
    fn the_capsule_is_the_source_itself() {
        let capsule = own();
        assert_eq!(capsule, own());
        let mut zip = zip::ZipArchive::new(Cursor::new(capsule.bytes)).unwrap();
        let mut read = |name: &str| {
            let mut text = String::new();
            let path = format!("reenact-{}/{name}", format::VERSION);
            zip.by_name(&path).unwrap().read_to_string(&mut text).unwrap();
            text
        };
        assert_eq!(read("src/bundle/capsule.rs"), include_str!("capsule.rs"));
        assert_eq!(read("Cargo.lock"), include_str!("../../Cargo.lock"));
        let manifest = read("Cargo.toml");
        assert!(manifest.contains("\nname = \"reenact\"\n"), "{manifest}");
        // Cargo refuses to build where a declared target is missing.
        for bench in manifest.split("[[bench]]").skip(1) {
            let name = bench.split('"').nth(1).unwrap();
            read(&format!("benches/{name}.rs"));
        }
    }

    #[test]
    fn whatever_the_source_includes_is_in_it() {
        let mut checked = 0;
        let is_rust = |path: &str| Path::new(path).extension().is_some_and(|e| e == "rs");
        let files = source();
        for (path, bytes) in files.iter().filter(|(path, _)| is_rust(path)) {
            let text = std::str::from_utf8(bytes).unwrap();
            let included =
                ["include_str!(\"", "include_bytes!(\""].into_iter().flat_map(|macro_| {
                    text.split(macro_).skip(1).filter_map(|rest| rest.split('"').next())
                });
            for target in included.filter(|target| target.starts_with('.')) {
                let mut parts: Vec<&str> = path.split('/').collect();
                parts.pop();
                for part in target.split('/') {
                    if part == ".." {
                        parts.pop();
                    } else {
                        parts.push(part);
                    }
                }
                let wanted = parts.join("/");
                checked += 1;
                let is_for_tests = path.contains("tests") || wanted.starts_with("docs/");
                assert!(
                    is_for_tests || files.contains_key(&wanted),
                    "src includes {wanted}, which the capsule lacks: add it to FILES in build.rs"
                );
            }
        }
        assert!(checked > 5, "{checked} files included");
    }
}
