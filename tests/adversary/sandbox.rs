//! Where attacks are let loose: a folder that must stay as it was, and little memory.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use tempfile::TempDir;

/// The most memory (KiB) that a command may write to: 200 MB less what the program itself takes on disk.
const MEMORY_KIB: u32 = 180_000;

/// The longest (s) that an answer may take: a second as users have the program (`.ci/full` runs these tests so); without
/// optimisation, and on a machine that is busy, what costs more than its length takes minutes.
pub(crate) const MOST_SECONDS: f64 = if cfg!(debug_assertions) { 60.0 } else { 1.0 };

/// A folder of its own: working directory, home, cache and temporary files are all in it.
pub(crate) struct Sandbox {
    folder: TempDir,
}

/// What a command answered.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
    pub(crate) seconds: f64,
}

impl Sandbox {
    pub(crate) fn new() -> Self {
        let sandbox = Self { folder: tempfile::tempdir().unwrap() };
        for folder in ["work", "home", "tmp"] {
            fs::create_dir(sandbox.folder.path().join(folder)).unwrap();
        }
        sandbox
    }

    /// A path in the working directory.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("work").join(name)
    }

    /// Runs the program in little memory, and asserts that it left everything as it was.
    pub(crate) fn reenact(&self, words: &[&str]) -> Answer {
        let before = listing(self.folder.path());
        let answer = self.reenact_that_writes(words);
        let after = listing(self.folder.path());
        assert_eq!(after, before, "{words:?} wrote to a folder that it was to read only");
        answer
    }

    /// Runs the program in little memory.
    pub(crate) fn reenact_that_writes(&self, words: &[&str]) -> Answer {
        let memory = if *BOUNDS_MEMORY { MEMORY_KIB } else { u32::MAX };
        run_within(memory, &self.path("."), self.folder.path(), words)
    }
}

fn run_within(memory_kib: u32, work: &Path, root: &Path, words: &[&str]) -> Answer {
    let program = assert_cmd::cargo::cargo_bin!("reenact");
    let mut command = if cfg!(target_os = "linux") {
        let mut command = Command::new("sh");
        // Data: everything that is private and can be written, whether it has been or not.
        let limited = format!("ulimit -d {memory_kib} && exec \"$0\" \"$@\"");
        command.args(["-c", &limited]).arg(program);
        command
    } else {
        Command::new(program)
    };
    command
        .args(words)
        .current_dir(work)
        .env("HOME", root.join("home"))
        .env("XDG_CACHE_HOME", root.join("home/cache"))
        .env("TMPDIR", root.join("tmp"))
        .env_remove("REENACT_STORE");
    #[expect(clippy::disallowed_methods, reason = "the table says how long an attack takes")]
    let began = std::time::Instant::now();
    let output = command.output().unwrap();
    Answer {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
        seconds: began.elapsed().as_secs_f64(),
    }
}

/// Whether this system ends a program that takes more memory than it was given.
static BOUNDS_MEMORY: LazyLock<bool> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let helped = |kib| run_within(kib, folder.path(), folder.path(), &["--help"]).code == Some(0);
    let bounds = helped(MEMORY_KIB) && !helped(16);
    if !bounds {
        skipped("this system does not bound memory (ulimit -d), so no attack's memory is measured");
    }
    bounds
});

#[expect(clippy::print_stderr, reason = "whoever runs the tests must know what they did not test")]
pub(crate) fn skipped(why: &str) {
    eprintln!("SKIPPED: {why}");
}

/// Every file below `folder` with its kind and size.
fn listing(folder: &Path) -> BTreeMap<PathBuf, (String, u64)> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let kind = entry.file_type().unwrap();
            if kind.is_dir() {
                folders.push(entry.path());
            }
            let size = if kind.is_file() { entry.metadata().unwrap().len() } else { 0 };
            found.insert(entry.path(), (format!("{kind:?}"), size));
        }
    }
    found
}
