//! Disks, permissions and clocks that fail: a clear error or a recovery, and no finished trial is lost.
//!
//! `.ci/kill-and-resume.sh` adds a hundred random kills.

use crate::sandbox::{Answer, PROGRAM, Sandbox, TINY, skipped};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::LazyLock;

fn place() -> Sandbox {
    Sandbox::new().with_study(TINY)
}

/// Returns the command of a run of the study with this store and this place for bundles.
fn command(place: &Sandbox, store: &str, out: &str) -> Command {
    let mut command = place.command(&["run", "tiny.yaml", "--format", "json", "--out", out]);
    command.env("REENACT_STORE", place.path(store));
    command
}

/// Returns what that run answers, the folder's name replaced.
fn run(place: &Sandbox, store: &str, out: &str) -> Answer {
    let mut answer = Answer::of(&mut command(place, store, out));
    answer.stderr = answer.stderr.replace(&here(place), "HERE");
    answer
}

fn here(place: &Sandbox) -> String {
    place.path("").display().to_string().trim_end_matches('/').to_owned()
}

/// Asserts that a run ended with this error and no result.
#[track_caller]
fn failed(answer: &Answer, message: &str) {
    let says = format!("error: {message}\n");
    let told = (answer.stdout.as_str(), answer.stderr.as_str(), answer.code);
    assert_eq!(told, ("", says.as_str(), 3));
}

/// Returns what a run that came to its end says: its results, and how many trials it found in the store.
#[track_caller]
fn finished(answer: &Answer) -> (String, u64) {
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0), "{answer:?}");
    let told: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    let results = told["results_digest"].as_str().unwrap().to_owned();
    (results, told["cached"].as_u64().unwrap())
}

/// The results of a run that nothing disturbed.
static UNDISTURBED: LazyLock<String> = LazyLock::new(|| finished(&run(&place(), "store", "out")).0);

/// A file system of its own on a folder, of so many KiB or for reading only; taken away at the end.
struct Mounted(PathBuf);

impl Mounted {
    /// Mounts a file system; where this user may not mount, says so and returns `None`.
    fn tmpfs(on: PathBuf, options: &str) -> Option<Self> {
        fs::create_dir_all(&on).unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&on).stderr(Stdio::null());
        if mount.status().is_ok_and(|status| status.success()) {
            return Some(Self(on));
        }
        skipped(&format!("a file system `{options}` takes a user who may mount one"));
        None
    }

    fn remount(&self, options: &str) {
        let options = format!("remount,{options}");
        let status = Command::new("mount").args(["-o", &options]).arg(&self.0).status().unwrap();
        assert!(status.success());
    }
}

impl Drop for Mounted {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
fn a_store_that_is_no_folder_is_told_and_nothing_is_run() {
    let place = place();
    fs::write(place.path("file"), "").unwrap();
    let says = "trial store: cannot read `HERE/file/store`: a part of its path is a file; free some space, allow writing, or \
                choose another place with REENACT_STORE";
    failed(&run(&place, "file/store", "out"), says);
    assert_eq!(place.files("out"), [] as [PathBuf; 0]);
}

#[test]
fn a_store_for_reading_only_is_told_and_serves_what_it_has() {
    let place = place();
    let Some(store) = Mounted::tmpfs(place.path("store"), "size=1m") else { return };
    store.remount("ro");
    let says = "trial store: cannot write to `HERE/store`: the file system is for reading only; free some space, allow \
                writing, or choose another place with REENACT_STORE";
    failed(&run(&place, "store", "out"), says);
    assert_eq!(place.files("out"), [] as [PathBuf; 0]);
    store.remount("rw");
    assert_eq!(finished(&run(&place, "store", "out")), (UNDISTURBED.clone(), 0));
    store.remount("ro");
    assert_eq!(finished(&run(&place, "store", "again")), (UNDISTURBED.clone(), 6));
}

#[test]
fn a_full_disk_ends_the_run_and_loses_no_finished_trial() {
    let place = place();
    let Some(store) = Mounted::tmpfs(place.path("store"), "size=12k") else { return };
    let says = "trial store: cannot write to `HERE/store`: the disk is full; free some space, allow writing, or choose \
                another place with REENACT_STORE";
    failed(&run(&place, "store", "out"), says);
    let stored = place.records("store");
    assert!((1..6).contains(&stored.len()), "{stored:?}");
    let segments = place.files("store");
    assert_eq!(segments.len(), 1, "{segments:?}");
    assert_eq!(fs::read_to_string(&segments[0]).unwrap(), stored.concat(), "a part stays behind");
    assert_eq!(place.files("out"), [] as [PathBuf; 0]);
    store.remount("size=1m");
    let resumed = finished(&run(&place, "store", "out"));
    assert_eq!(resumed, (UNDISTURBED.clone(), stored.len() as u64));
}

#[test]
fn a_disk_without_room_is_told_before_anything_is_run() {
    let place = place();
    let Some(out) = Mounted::tmpfs(place.path("out"), "size=8k") else { return };
    let refused = run(&place, "store", "out");
    assert_eq!((refused.stdout.as_str(), refused.code), ("", 2));
    assert!(
        refused
            .stderr
            .starts_with("error: nothing was run: the bundle of 6 trials would hold at least ")
            && refused.stderr.contains(" kB free in `out`, found 8 kB; ")
            && refused.stderr.ends_with("free some space, or choose another folder with --out\n"),
        "{}",
        refused.stderr
    );
    assert_eq!(place.files("out"), [] as [PathBuf; 0]);
    out.remount("size=1m");
    assert_eq!(finished(&run(&place, "store", "out")), (UNDISTURBED.clone(), 0));
}

#[test]
fn a_place_for_bundles_that_cannot_be_written_is_told_and_the_trials_stay() {
    let place = place();
    let results = UNDISTURBED.strip_prefix("sha256:").unwrap();
    let name = format!("tiny-{}.zip", &results[..8]);
    fs::write(place.path("file"), "").unwrap();
    let says = format!("cannot write `file/out/{name}`: a part of its path is a file");
    failed(&run(&place, "store", "file/out"), &says);
    // A folder stands where the bundle should.
    fs::create_dir_all(place.path("out").join(&name).join("x")).unwrap();
    let says = format!("cannot write `out/{name}`: it is a folder");
    failed(&run(&place, "store", "out"), &says);
    assert_eq!(fs::read_dir(place.path("out")).unwrap().count(), 1, "a part stays behind");
    if let Some(_locked) = Mounted::tmpfs(place.path("locked"), "ro") {
        let says = format!("cannot write `locked/{name}`: the file system is for reading only");
        failed(&run(&place, "store", "locked"), &says);
    }
    assert_eq!(finished(&run(&place, "store", "elsewhere")), (UNDISTURBED.clone(), 6));
}

/// Permissions do not bind root, so the program is run as nobody where the tests run as root.
#[cfg(target_os = "linux")]
#[test]
fn missing_permissions_are_told() {
    use std::os::unix::fs::PermissionsExt as _;
    let place = place();
    let mode = |name: &str, mode| {
        fs::create_dir_all(place.path(name)).unwrap();
        fs::set_permissions(place.path(name), fs::Permissions::from_mode(mode)).unwrap();
    };
    mode("store", 0o555);
    mode("out", 0o777);
    mode(".", 0o755);
    mode("..", 0o755);
    let is_root = Command::new("id").arg("-u").output().is_ok_and(|o| o.stdout == b"0\n");
    let mut command = command(&place, "store", "out");
    if is_root {
        // The program may lie in a folder that is root's alone. Another process copies it: of a file that this one has open
        // for writing, children of tests beside this one inherit the handle, and then it cannot be executed.
        let copy = place.path("reenact");
        assert!(Command::new("cp").arg(PROGRAM).arg(&copy).status().unwrap().success());
        let mut as_nobody = Command::new("setpriv");
        place.dress(&mut as_nobody).args(["--reuid", "65534", "--regid", "65534"]);
        as_nobody.arg("--clear-groups").arg(copy).args(command.get_args());
        command = as_nobody;
    }
    let Ok(output) = command.output() else {
        skipped("missing permissions take `setpriv` where the tests run as root");
        return;
    };
    let says = "error: trial store: cannot write to `HERE/store`: no permission; free some space, allow writing, or choose \
                another place with REENACT_STORE\n";
    let stderr = String::from_utf8(output.stderr).unwrap();
    let stderr = stderr.replace(&here(&place), "HERE");
    assert_eq!((stderr.as_str(), output.status.code()), (says, Some(3)));
    assert_eq!(place.files("out"), [] as [PathBuf; 0]);
}

#[test]
fn records_that_a_crash_left_damaged_are_run_again() {
    let place = place();
    finished(&run(&place, "store", "out"));
    let (whole, segments) = (place.records("store"), place.files("store"));
    assert_eq!((whole.len(), segments.len()), (6, 1));
    // As crashes and failing disks leave them: a flipped bit, zeros for what was not written, and cut at the end.
    let half = whole[1].len() / 2;
    let mut flipped = whole[0].clone().into_bytes();
    flipped[half] ^= 1;
    let zeros = vec![0; whole[1].len() - half];
    let rest = whole[2..5].concat();
    let cut = &whole[5][..half];
    let damaged =
        [&flipped, &whole[1].as_bytes()[..half], &zeros, rest.as_bytes(), cut.as_bytes()].concat();
    fs::write(&segments[0], &damaged).unwrap();
    // The zeros took the end of their line, and with it the next one.
    assert_eq!(finished(&run(&place, "store", "again")), (UNDISTURBED.clone(), 2));
    // What was there stays, and the four are appended on lines of their own.
    let mended = fs::read(&segments[0]).unwrap();
    assert!(mended.starts_with(&[&damaged[..], b"\n"].concat()));
    assert_eq!(
        mended.len(),
        damaged.len() + 1 + [0, 1, 2, 5].map(|i| whole[i].len()).iter().sum::<usize>()
    );
    assert_eq!(finished(&run(&place, "store", "again")), (UNDISTURBED.clone(), 6));
}

#[test]
fn another_record_under_a_trial_s_key_is_not_believed() {
    let place = place();
    finished(&run(&place, "store", "out"));
    let (mut records, segments) = (place.records("store"), place.files("store"));
    // Behind its key each line has its digest.
    records[1] = format!("{}{}", &records[1][..75], &records[0][75..]);
    fs::write(&segments[0], records.concat()).unwrap();
    assert_eq!(finished(&run(&place, "store", "again")), (UNDISTURBED.clone(), 5));
}

#[test]
fn two_processes_share_one_store() {
    let place = &place();
    std::thread::scope(|scope| {
        let run = |out| scope.spawn(move || run(place, "store", out));
        for answer in ["one", "two", "three"].map(run) {
            assert_eq!(finished(&answer.join().unwrap()).0, *UNDISTURBED);
        }
    });
    let mut records = place.records("store");
    records.sort();
    records.dedup();
    assert_eq!(records.len(), 6);
    assert!((1..=3).contains(&place.files("store").len()), "{:?}", place.files("store"));
}

/// Results that cannot be written are not a success.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_stdout_is_told() {
    let place = place();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = command(&place, "store", "out").stdout(full).output().unwrap();
    let says = "error: cannot write the result: the disk is full\n";
    assert_eq!(
        (String::from_utf8(output.stderr).unwrap().as_str(), output.status.code()),
        (says, Some(3))
    );
    assert_eq!(place.files("out").len(), 1, "the bundle itself is written");
}
