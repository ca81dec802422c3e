//! Inputs that are no files, files of another kind, secrets, names that steer a terminal, and interrupts: an error at once, in
//! little memory, and nothing of what was read by a slip is shown.

use crate::sandbox::{Answer, MOST_SECONDS, Sandbox, TINY};
use std::fs;
use std::process::Command;

fn with_study() -> Sandbox {
    Sandbox::new().with_study(TINY)
}

/// Asserts that `answer` is a refusal of a request that was not understood, and quick; gives what it said.
#[track_caller]
fn refused(answer: &Answer) -> &str {
    assert_eq!((answer.stdout.as_str(), answer.code), ("", 2), "{answer:?}");
    assert!(answer.seconds < MOST_SECONDS, "{} s", answer.seconds);
    &answer.stderr
}

#[test]
fn of_two_hundred_thousand_faults_a_hundred_are_told_and_the_others_counted() {
    let sandbox = with_study();
    let mut text = TINY.to_owned();
    for i in 0..200_000 {
        text.push_str(&format!("k{i}: 1\n"));
    }
    sandbox.write("tiny.yaml", text);
    let answer = sandbox.run_reading(&["check", "tiny.yaml"]);
    let told = refused(&answer);
    assert_eq!(told.matches("error: unknown key `k").count(), 100);
    let (_, end) = told.split_once("error: unknown key `k99`\n").unwrap();
    let (_, end) = end.split_once("\n\n").unwrap();
    assert_eq!(
        end,
        "error: 199900 more errors like these\n |\n = help: mend those above first: many may have one cause\n\n\
         error: tiny.yaml: 200000 errors\n"
    );
}

/// What is nearly known, unused or crossed is looked for among everything else: with so many of each that must not be done.
#[test]
fn many_names_cost_no_more_than_they_are_long() {
    let sandbox = with_study();
    let check = |from: &str, to: String, ends: &str| {
        sandbox.write("tiny.yaml", TINY.replace(from, &to));
        let answer = sandbox.run_reading(&["check", "tiny.yaml"]);
        let told = refused(&answer);
        assert!(told.ends_with(ends), "{}", &told[told.len().saturating_sub(500)..]);
    };
    let numbered = |count: usize, line: &dyn Fn(usize) -> String| -> String {
        (0..count).map(line).collect::<Vec<_>>().concat()
    };
    check(
        "  floor-plan: {floor-plan-of: world}\n",
        numbered(50_000, &|i| format!("  p{i}: {{floor-plan-of: world}}\n")),
        "warning: 49901 more warnings like these\n |\n = help: mend those above first: many may have one cause\n\n\
         error: tiny.yaml: 1 error, 50000 warnings\n",
    );
    check(
        "[none, floor-plan]\n",
        format!("[none, floor-plan]\n{}", numbered(50_000, &|i| format!("  f{i}: [a]\n"))),
        "error: tiny.yaml: 1 error, 1 warning\n",
    );
    let claim = |i: usize| {
        format!(
            "  - {{id: c{i}, ours: x, expect: {{between: {{metric: m{i}, where: {{f: a}}, high: 1}}}}}}\n"
        )
    };
    check(
        "parameters:",
        format!("claims:\n{}parameters:", numbered(20_000, &claim)),
        "error: 39900 more errors like these\n |\n = help: mend those above first: many may have one cause\n\n\
         error: tiny.yaml: 40000 errors\n",
    );
    check(
        "prior-maps:",
        format!("exclude:\n{}prior-maps:", numbered(50_000, &|_| "  - {prior: none}\n".to_owned())),
        "error: tiny.yaml: 1 error\n",
    );
}

#[cfg(unix)]
#[test]
fn inputs_that_are_no_files_are_refused_before_they_are_opened() {
    let sandbox = with_study();
    let pipe = sandbox.path("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    fs::create_dir(sandbox.path("folder")).unwrap();
    std::os::unix::fs::symlink("circle", sandbox.path("circle")).unwrap();
    let huge = fs::File::create(sandbox.path("huge.urdf")).unwrap();
    huge.set_len(1 << 40).unwrap();
    for (robot, found) in [
        ("/dev/zero", "expected a file, found a device"),
        ("pipe", "expected a file, found a pipe"),
        ("folder", "expected a file, found a folder"),
        ("circle", "expected a file, found a symbolic link that leads nowhere"),
        ("huge.urdf", "it is too large: expected at most 67108864 bytes, found 1099511627776"),
    ] {
        let text = TINY.replace("robots/kobuki.urdf", robot);
        sandbox.write("tiny.yaml", text);
        let answer = sandbox.run_reading(&["check", "tiny.yaml"]);
        let carets = "^".repeat(robot.len());
        let says = format!(
            "error: cannot read `{robot}`\n --> tiny.yaml:9:8\n  |\n9 | robot: {robot}\n  |        {carets} {found}\n  |\n  = \
             help: paths are relative to the file they are written in\n\nerror: tiny.yaml: 1 error\n"
        );
        assert_eq!(refused(&answer), says);
        // The same where the command line names it.
        for words in [
            &["check", robot][..],
            &["show", robot],
            &["solve-cmdp", robot],
            &["verify", "tiny.yaml", "--trust", robot],
        ] {
            let answer = sandbox.run_reading(words);
            assert!(refused(&answer).starts_with("error: cannot read `"), "{words:?}: {answer:?}");
        }
    }
}

/// A path is easily mistaken, and what stands in the file may be nobody's business.
#[test]
fn nothing_is_shown_of_files_of_another_kind() {
    let sandbox = with_study();
    let secrets = [
        "root:hunter2:0:0:root:/root:/bin/bash\n",
        "hunter2\n",
        "[hunter2, hunter2]\n",
        "\t%hunter2\n@hunter2: {\n",
        "-----BEGIN OPENSSH PRIVATE KEY-----\nhunter2AAAA\n-----END OPENSSH PRIVATE KEY-----\n",
        "-----BEGIN RSA PRIVATE KEY-----\nProc-Type: 4,ENCRYPTED\n\nhunter2\n-----END RSA PRIVATE KEY-----\n",
        "untrusted comment: minisign encrypted secret key\nRWRTY0IyHunter2hunter2\n",
        "PuTTY-User-Key-File-3: ssh-ed25519\nComment: hunter2\nPrivate-Lines: 1\nhunter2\n",
    ];
    let as_part = |part: &str| match part {
        "robot" => TINY.replace("robots/kobuki.urdf", "secret.urdf"),
        "world" => TINY.replace("{file: worlds/basic.yaml, layers: [walls]}", "{file: secret}"),
        "sensitivity" | "multiverse" => format!("{TINY}{part}: secret\n"),
        _ => format!("{TINY}published:\n  numbers: secret\n"),
    };
    for secret in secrets {
        for name in ["secret", "secret.urdf", "secret.lock"] {
            sandbox.write(name, secret);
        }
        for part in ["robot", "world", "sensitivity", "multiverse", "published"] {
            sandbox.write("part.yaml", as_part(part));
            let answer = sandbox.run_reading(&["check", "part.yaml"]);
            let told = refused(&answer).to_lowercase();
            assert!(told.contains("secret"), "{part}: the file is named: {told}");
            assert!(!told.contains("hunter2"), "{part}: {told}");
        }
        for words in [
            &["check", "secret"][..],
            &["show", "secret"],
            &["solve-cmdp", "secret"],
            &["diff", "secret.lock", "secret.lock"],
            &["verify", "tiny.yaml", "--trust", "secret"],
        ] {
            let answer = sandbox.run_reading(words);
            let told = refused(&answer).to_lowercase();
            assert!(told.contains("secret"), "{words:?}: the file is named: {told}");
            assert!(!told.contains("hunter2"), "{words:?}: {told}");
        }
    }
}

#[test]
fn a_private_key_is_no_key_to_trust_and_none_of_it_is_printed() {
    let sandbox = Sandbox::new();
    let key =
        "-----BEGIN OPENSSH PRIVATE KEY-----\nb3BlbnNzaC1rZXk\n-----END OPENSSH PRIVATE KEY-----\n";
    sandbox.write("id_ed25519", key);
    let answer = sandbox.run_reading(&["verify", "bundle", "--trust", "id_ed25519"]);
    assert_eq!(
        refused(&answer),
        "error: `id_ed25519`: expected public keys, found an OpenSSH private key\n |\n = help: give the public key, which \
         lies beside it (`id_ed25519.pub`), in an `allowed_signers` file; nothing of the private key was printed or kept\n"
    );
}

#[test]
fn what_a_manifest_calls_itself_steers_no_terminal() {
    let sandbox = with_study();
    let title = "title: \"A \\e[2J study \\u202e of \\x9b31m nothing\"";
    sandbox.write("tiny.yaml", TINY.replace("title: A tiny study", title));
    let words = ["run", "tiny.yaml", "--no-cache", "--only", "prior=none", "--trials", "1"];
    let answer = sandbox.run_bounded(&words);
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0), "{answer:?}");
    let first = answer.stdout.lines().next().unwrap();
    assert_eq!(first, "A \\u{1b}[2J study \\u{202e} of \\u{9b}31m nothing");
}

#[cfg(unix)]
#[test]
fn a_store_whose_name_is_no_text_is_told() {
    use std::os::unix::ffi::OsStrExt as _;
    let sandbox = with_study();
    let store = std::ffi::OsStr::from_bytes(b"st\xffre");
    let answer = Answer::of(sandbox.command(&["run", "tiny.yaml"]).env("REENACT_STORE", store));
    let says =
        "error: REENACT_STORE: expected a path in UTF-8, found `st\u{fffd}re`, which is none\n";
    assert_eq!((answer.stderr.as_str(), answer.code), (says, 2));
}

#[test]
fn threads_that_nobody_needs_are_not_started() {
    let sandbox = with_study();
    let words = ["run", "tiny.yaml", "--no-cache", "--trials", "1", "--jobs", "100000"];
    let answer = sandbox.run_bounded(&words);
    assert_eq!(answer.code, 0, "{answer:?}");
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let most = (4 * processors).max(64);
    let s = if processors == 1 { "" } else { "s" };
    assert_eq!(
        answer.stderr,
        format!(
            "note: --jobs 100000: {most} threads are started, the most that {processors} processor{s} can use\n"
        )
    );
}

/// Returns a bag whose only chunk says that it holds so many MiB of one message of zeros; compressed by zstd it has some kilobytes.
fn bag_of_zeros(mib: usize) -> Vec<u8> {
    /// The most that a block of zstd stands for (RFC 8878, section 3.1.1.2.4).
    const BLOCK: usize = 128 << 10;
    let size = mib << 20;
    let record = |kind: u8, parts: &[&[u8]]| {
        let content = parts.concat();
        [&[kind][..], &content.len().to_le_bytes(), &content].concat()
    };
    let text = |text: &[u8]| [&u32::try_from(text.len()).unwrap().to_le_bytes(), text].concat();
    let head = [&[5][..], &(size - 9).to_le_bytes()].concat();
    // A frame with a window of 8 MiB: the message's head as it is, then blocks of one byte again and again.
    let mut frame = b"\x28\xb5\x2f\xfd\0\x68".to_vec();
    let block = |length: usize, kind: usize| (length << 3 | kind << 1).to_le_bytes();
    frame.extend(&block(head.len(), 0)[..3]);
    frame.extend(&head);
    let mut left = size - head.len();
    while left > 0 {
        let length = left.min(BLOCK);
        left -= length;
        let mut block = block(length, 1);
        block[0] |= u8::from(left == 0);
        frame.extend(&block[..3]);
        frame.push(0);
    }
    let sizes = [&[0; 16][..], &size.to_le_bytes(), &[0; 4]].concat();
    let length = frame.len().to_le_bytes();
    [
        &b"\x89MCAP0\r\n"[..],
        &record(1, &[&text(b""), &text(b"")]),
        &record(3, &[&[1, 0], &text(b"nav_msgs/msg/OccupancyGrid"), &text(b"ros2msg"), &text(b"")]),
        &record(4, &[&[0, 0, 1, 0], &text(b"/map"), &text(b"cdr"), &text(b"")]),
        &record(6, &[&sizes, &text(b"zstd"), &length, &frame]),
        &record(15, &[&[0; 4]]),
        &record(2, &[&[0; 20]]),
        b"\x89MCAP0\r\n",
    ]
    .concat()
}

#[test]
fn a_bag_that_unpacks_to_thousands_of_times_its_size_costs_no_more_than_a_plain_one() {
    let sandbox = with_study();
    sandbox.write("tiny.yaml", TINY.replace("{floor-plan-of: world}", "{map: run.mcap}"));
    for (mib, why) in [
        (33, "it cannot be read: its chunks are larger than 32 MiB when unpacked"),
        (30, "the grid on `/map` is damaged"),
    ] {
        let bag = bag_of_zeros(mib);
        assert!(bag.len() < 4000, "{}", bag.len());
        sandbox.write("run.mcap", bag);
        let answer = sandbox.run_reading(&["check", "tiny.yaml"]);
        let told = refused(&answer);
        assert!(told.contains(why), "{told}");
    }
}
