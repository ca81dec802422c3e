//! Lists the program's own source, so that `run --capsule` can seal it into a bundle (`src/bundle/capsule.rs`).
//!
//! Writes `capsule.deflate` to `OUT_DIR`: the number of bytes of what follows unpacked, then deflated for each file the lengths
//! of its path and of its content, its path and its content. Numbers are of eight bytes, the lowest first.

use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::ffi::OsString;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Folders taken whole.
const FOLDERS: [&str; 2] = ["src", "benches"];

/// What else a build needs: `reenact init` holds the last two. A test keeps this list complete.
const FILES: [&str; 8] = [
    "Cargo.lock",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "build.rs",
    "robots/kobuki.urdf",
    "robots/pioneer3at.urdf",
    "worlds/basic.yaml",
];

fn main() {
    // Asked for at run time: a checkout that was moved with its target folder runs the script that was built before.
    let root = PathBuf::from(from_cargo("CARGO_MANIFEST_DIR"));
    let mut files: Vec<(String, PathBuf)> =
        FILES.iter().map(|file| ((*file).to_owned(), root.join(file))).collect();
    // A package from a registry holds a rewritten manifest beside the one that was written: the same source must give the
    // same capsule however it was obtained.
    let as_written = root.join("Cargo.toml.orig");
    let manifest = if as_written.exists() { as_written } else { root.join("Cargo.toml") };
    files.push(("Cargo.toml".to_owned(), manifest));
    for folder in FOLDERS {
        walk(&root.join(folder), folder, &mut files);
        println!("cargo::rerun-if-changed={folder}");
    }
    for file in FILES.iter().chain(&["Cargo.toml"]) {
        println!("cargo::rerun-if-changed={file}");
    }
    files.sort();
    let number = |length: usize| (length as u64).to_le_bytes();
    let mut plain = Vec::new();
    for (name, path) in &files {
        let bytes = fs::read(path).expect("the source can be read");
        plain.extend(number(name.len()));
        plain.extend(number(bytes.len()));
        plain.extend(name.as_bytes());
        plain.extend(bytes);
    }
    let mut packed = DeflateEncoder::new(number(plain.len()).to_vec(), Compression::new(6));
    packed.write_all(&plain).expect("a vector takes every byte");
    let packed = packed.finish().expect("a vector takes every byte");
    let out = from_cargo("OUT_DIR");
    fs::write(Path::new(&out).join("capsule.deflate"), packed).expect("OUT_DIR can be written");
}

/// What cargo tells a build script by the variable `name` of its environment.
#[expect(
    clippy::disallowed_methods,
    reason = "cargo tells build scripts where things lie by the environment"
)]
fn from_cargo(name: &str) -> OsString {
    std::env::var_os(name).unwrap_or_else(|| panic!("cargo sets {name}"))
}

/// Every file below `folder`, called `name` from the root on; hidden files and editors' copies are not source.
fn walk(folder: &Path, name: &str, files: &mut Vec<(String, PathBuf)>) {
    for entry in fs::read_dir(folder).expect("the source can be read") {
        let path = entry.expect("the source can be read").path();
        let Some(last) = path.file_name().and_then(|last| last.to_str()) else { continue };
        let name = format!("{name}/{last}");
        if last.starts_with('.') || last.ends_with('~') {
            continue;
        }
        if path.is_dir() {
            walk(&path, &name, files);
        } else {
            files.push((name, path));
        }
    }
}
