//! Where tests run the program: in a folder of its own and with an environment of its own, so that no test sees another one's
//! files, or anything of whoever runs it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use tempfile::TempDir;

/// The program under test.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_reenact");

/// Two cells of three trials of 20 simulated seconds, for [`Sandbox::with_study`], and what is appended to them.
macro_rules! tiny {
    ($($more:literal)?) => {
        concat!(
            "
reenact: 1
name: tiny
title: A tiny study
license: CC-BY-4.0
study: prior-map
seed: 7
trials: 3
robot: robots/kobuki.urdf
world: {file: worlds/basic.yaml, layers: [walls]}
start: {x-m: 3, y-m: 2, heading-deg: 0}
factors:
  prior: [none, floor-plan]
prior-maps:
  floor-plan: {floor-plan-of: world}
parameters:
  mission: {time-limit-s: 20}
",
            $($more)?
        )
    };
}
pub(crate) use tiny;

/// The same as it is; what is appended belongs to the parameters.
pub(crate) const TINY: &str = tiny!();

/// The time (s since 1970) in a sandbox whose clock is pinned.
pub(crate) const PINNED: &str = "1600000000";

/// The most memory (KiB) that a bounded command may write to: 200 MB less what the program itself takes on disk.
const MEMORY_KIB: u32 = 180_000;

/// The longest (s) that a refusal may take: a second as users have the program (`.ci/full` runs these tests so); without
/// optimisation, and on a machine that is busy, what costs more than its length takes minutes.
pub(crate) const MOST_SECONDS: f64 = if cfg!(debug_assertions) { 60.0 } else { 1.0 };

/// Returns the root of the repository.
pub(crate) fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder of its own: working directory, store, home, cache and temporary files are all in it.
pub(crate) struct Sandbox {
    folder: TempDir,
    is_pinned: bool,
}

/// What a command answered.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) stdout: String,
    pub(crate) stderr: String,
    /// The commands that are worth typing next, which stand on stderr too.
    pub(crate) next: String,
    pub(crate) code: i32,
    pub(crate) seconds: f64,
}

impl Answer {
    /// Runs `command` to its end, which must be one of its own.
    pub(crate) fn of(command: &mut Command) -> Self {
        #[expect(clippy::disallowed_methods, reason = "how long an answer takes is tested")]
        let began = std::time::Instant::now();
        let output = command.output().unwrap();
        let seconds = began.elapsed().as_secs_f64();
        let Some(code) = output.status.code() else { panic!("{command:?}: {output:?}") };
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let (mut stderr, mut next) = (String::new(), String::new());
        for line in text(output.stderr).split_inclusive('\n') {
            let is_next = ["next: reenact ", "      reenact verify --level 4 "];
            let stream =
                if is_next.iter().any(|s| line.starts_with(s)) { &mut next } else { &mut stderr };
            stream.push_str(line);
        }
        Self { stdout: text(output.stdout), stderr, next, code, seconds }
    }

    /// Returns the last line of stdout.
    pub(crate) fn last_line(&self) -> &str {
        self.stdout.lines().last().unwrap_or_default()
    }
}

impl Sandbox {
    /// Makes an empty one.
    pub(crate) fn new() -> Self {
        let sandbox = Self { folder: tempfile::tempdir().unwrap(), is_pinned: false };
        for folder in ["work", "home", "tmp"] {
            fs::create_dir(sandbox.folder.path().join(folder)).unwrap();
        }
        sandbox
    }

    /// Makes one whose commands take the time to be [`PINNED`], so that they write nothing of the clock.
    pub(crate) fn pinned() -> Self {
        Self { is_pinned: true, ..Self::new() }
    }

    /// Writes the starter study to `demo/`.
    pub(crate) fn with_demo(self) -> Self {
        assert_eq!(self.done(&["init", "demo"]), "reenact run demo/demo.yaml\n");
        self
    }

    /// Writes `study` to `tiny.yaml`, with the robot and the world of [`TINY`].
    pub(crate) fn with_study(self, study: &str) -> Self {
        self.write("tiny.yaml", study);
        self.with_files(&["robots/kobuki.urdf", "worlds/basic.yaml"])
    }

    /// Copies files of the repository to where they are in it.
    pub(crate) fn with_files(self, files: &[&str]) -> Self {
        for file in files {
            let copy = self.path(file);
            fs::create_dir_all(copy.parent().unwrap()).unwrap();
            fs::copy(repository().join(file), copy).unwrap();
        }
        self
    }

    /// Returns a path in the working directory.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("work").join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    }

    /// Replaces `from`, which must be there, in a file.
    pub(crate) fn edit(&self, name: &str, from: &str, to: &str) {
        let text = self.read(name);
        assert!(text.contains(from), "{from} is not in {name}");
        self.write(name, text.replace(from, to));
    }

    /// Returns every file below a folder, which need not exist, in order.
    pub(crate) fn files(&self, below: &str) -> Vec<PathBuf> {
        let is_file = |(path, kind): (PathBuf, Kind)| (!kind.is_folder).then_some(path);
        listing(&self.path(below)).into_iter().filter_map(is_file).collect()
    }

    /// Returns the whole lines of the files of records in the store `below`.
    pub(crate) fn records(&self, below: &str) -> Vec<String> {
        let mut lines = Vec::new();
        for file in self.files(&format!("{below}/segments")) {
            // What is torn may be anything.
            let bytes = fs::read(file).unwrap();
            let text = String::from_utf8_lossy(&bytes);
            lines.extend(
                text.split_inclusive('\n').filter(|line| line.ends_with("}}\n")).map(str::to_owned),
            );
        }
        lines
    }

    /// Gives `command` this sandbox's working directory and environment, and nothing of the tester's but the search path.
    pub(crate) fn dress<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        let root = self.folder.path();
        command.current_dir(self.path("")).env_clear();
        #[expect(clippy::disallowed_methods, reason = "`sh` and others are found by it")]
        let search_path = std::env::var_os("PATH");
        command.envs(search_path.map(|path| ("PATH", path)));
        command.env("HOME", root.join("home")).env("TMPDIR", root.join("tmp"));
        command.env("REENACT_STORE", self.path("store"));
        command.envs(self.is_pinned.then_some(("SOURCE_DATE_EPOCH", PINNED)))
    }

    /// Returns the program with these arguments.
    pub(crate) fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(PROGRAM);
        self.dress(&mut command).args(words);
        command
    }

    /// Runs the program.
    pub(crate) fn run(&self, words: &[&str]) -> Answer {
        Answer::of(&mut self.command(words))
    }

    /// Runs the program, which must succeed and have nothing to say on stderr but what to type next, and gives its stdout.
    #[track_caller]
    pub(crate) fn done(&self, words: &[&str]) -> String {
        let answer = self.run(words);
        assert_eq!((answer.stderr.as_str(), answer.code), ("", 0), "{words:?}");
        answer.stdout
    }

    /// Runs the program in little memory.
    pub(crate) fn run_bounded(&self, words: &[&str]) -> Answer {
        let memory = if *BOUNDS_MEMORY { MEMORY_KIB } else { u32::MAX };
        Answer::of(&mut self.within(memory, words))
    }

    /// Runs the program in little memory, and asserts that it left everything as it was.
    pub(crate) fn run_reading(&self, words: &[&str]) -> Answer {
        let before = listing(self.folder.path());
        let answer = self.run_bounded(words);
        let after = listing(self.folder.path());
        assert_eq!(after, before, "{words:?} wrote to a folder that it was to read only");
        answer
    }

    fn within(&self, memory_kib: u32, words: &[&str]) -> Command {
        if !cfg!(target_os = "linux") {
            return self.command(words);
        }
        let mut command = Command::new("sh");
        // Data: everything that is private and can be written, whether it has been or not.
        let limited = format!("ulimit -d {memory_kib} && exec \"$0\" \"$@\"");
        self.dress(&mut command).args(["-c", &limited, PROGRAM]).args(words);
        command
    }
}

/// Whether this system ends a program that takes more memory than it was given.
static BOUNDS_MEMORY: LazyLock<bool> = LazyLock::new(|| {
    let sandbox = Sandbox::new();
    let helped = |kib| sandbox.within(kib, &["--help"]).output().unwrap().status.success();
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

/// What is at a path.
#[derive(Debug, PartialEq)]
struct Kind {
    is_folder: bool,
    is_link: bool,
    /// Length (bytes) of a file.
    size: Option<u64>,
}

/// Lists everything below `folder`, which another process may be writing to.
fn listing(folder: &Path) -> BTreeMap<PathBuf, Kind> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let entry = entry.unwrap();
            let Ok(kind) = entry.file_type() else { continue };
            if kind.is_dir() {
                folders.push(entry.path());
            }
            let length = || entry.metadata().map_or(0, |metadata| metadata.len());
            let size = kind.is_file().then(length);
            let kind = Kind { is_folder: kind.is_dir(), is_link: kind.is_symlink(), size };
            found.insert(entry.path(), kind);
        }
    }
    found
}
