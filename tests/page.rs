//! The page that checks bundles, as far as it needs no browser: what it executes elsewhere, what it is built of, and the site that an
//! author publishes with it. `.ci/page-check` and `.ci/full page` run the page itself.

use crate::adversary::study::HONEST;
use crate::sandbox::{Sandbox, repository};
use reenact::bundle::{Bundle, Limits, archive};
use reenact::runner::RunEvent;
use reenact::verify::{Executed, Level, Options, Reenactment, Verdict, climb};
use std::collections::BTreeSet;
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Checks that trials which workers executed by number are compared as if they had been executed here, and that none is executed twice.
#[test]
fn trials_that_workers_executed_are_compared_like_our_own() {
    let opened = || archive::read(&HONEST.zip, &Limits::default());
    let bundle = Bundle::open(opened().unwrap()).unwrap();
    for (level, count) in [(Level::Full, 6), (Level::Sampled, 2)] {
        let options = Options { level, sample: 2, rows: None, seed: 7 };
        let alone = climb(opened(), &options, &Reenactment::new(2).unwrap());
        assert_eq!(alone.verdict(), Verdict::Holds);
        let errand = Reenactment::new(1).unwrap().errand(&bundle, &options).unwrap();
        assert_eq!((errand.count(), errand.execute(count)), (count, None));
        let mut executed = Executed::default();
        for number in (0..count).rev() {
            executed.add(errand.execute(number).unwrap());
        }
        let fresh = AtomicUsize::new(0);
        let observer = |event: &RunEvent<'_>| {
            if let RunEvent::Finished { cached: false, .. } = event {
                fresh.fetch_add(1, Ordering::Relaxed);
            }
        };
        let pipeline = Reenactment::new(1).unwrap().observed_by(&observer);
        let together = climb(opened(), &options, &pipeline.with_executed(&executed));
        assert_eq!(together.to_human(), alone.to_human());
        assert_eq!((executed.count(), fresh.into_inner()), (count, 0));
        // One that gave something else is a difference, whoever executed it.
        let mut other = errand.execute(0).unwrap();
        other.sim_seconds += 1.0;
        executed.add(other);
        let pipeline = Reenactment::new(1).unwrap().with_executed(&executed);
        let told = climb(opened(), &options, &pipeline);
        assert_eq!(told.verdict(), Verdict::Broken);
        assert!(told.to_human().contains("sim-seconds"), "{}", told.to_human());
    }
}

/// Checks that the page computes with the very crates that the program computes with: another version may give other bits.
#[test]
fn the_page_is_built_of_the_crates_of_the_program() {
    let locked = |path: &str| -> BTreeSet<String> {
        let text = fs::read_to_string(repository().join(path)).unwrap();
        let packages = text.split("[[package]]\n").skip(1);
        packages.map(|package| package.lines().take(2).collect::<Vec<_>>().join(" ")).collect()
    };
    let own = ["reenact-page", "web-time", "getrandom"].map(|name| format!("name = \"{name}\""));
    let (program, page) = (locked("Cargo.lock"), locked("page/Cargo.lock"));
    let foreign: Vec<_> = page
        .difference(&program)
        .filter(|package| !own.iter().any(|name| package.starts_with(name)))
        .collect();
    assert!(page.len() > 50, "{} packages", page.len());
    assert_eq!(foreign, Vec::<&String>::new(), "page/Cargo.lock: take the versions of Cargo.lock");
}

/// What the published bundle is checked with where only its files matter.
const GENERATOR: &str = "Reenact verify.html";

fn page_of(version: &str) -> String {
    format!("<!doctype html>\n<meta name=\"generator\" content=\"{GENERATOR} {version}\">\n")
}

#[test]
fn a_site_holds_the_bundle_the_page_the_report_and_an_index() {
    let desk = Sandbox::new();
    let version = reenact::bundle::format::VERSION;
    let page = page_of(&format!("{version}, engine {}", reenact::plan::ENGINE_VERSION));
    desk.write("study.zip", &HONEST.zip);
    desk.write("verify.html", &page);
    let answer = desk.run(&["export", "study.zip", "--site", "site", "--page", "verify.html"]);
    assert_eq!(answer.code, 0, "{answer:?}");
    let says = "checked to level 3 (derived): the bundle is what it says\nsite\n";
    assert_eq!((answer.stdout.as_str(), answer.stderr.as_str()), (says, ""));
    let name = format!("{}.zip", HONEST.root);
    let mut files: Vec<String> = fs::read_dir(desk.path("site"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    assert_eq!(files, ["index.html", "report.html", &name, "verify.html"]);
    let read = |name: &str| fs::read_to_string(desk.path("site").join(name)).unwrap();
    assert_eq!(read("verify.html"), page);
    assert!(
        read("index.html").contains(&format!("verify.html?bundle={name}")),
        "{}",
        read("index.html")
    );
    assert_eq!(desk.run(&["verify", &format!("site/{name}")]).code, 0);
    let answer = desk.run(&["report", "study.zip", "-o", "alone.html"]);
    assert_eq!(answer.code, 0);
    assert_eq!(read("report.html"), fs::read_to_string(desk.path("alone.html")).unwrap());
}

#[test]
fn a_site_that_cannot_be_made_says_why() {
    let desk = Sandbox::new();
    let version = reenact::bundle::format::VERSION;
    let engine = reenact::plan::ENGINE_VERSION;
    desk.write("study.zip", &HONEST.zip);
    desk.write("report.html", "<!doctype html>\n<p>Another page</p>\n");
    desk.write("old.html", page_of("0.0.9, engine 1"));
    fs::create_dir(desk.path("full")).unwrap();
    desk.write("full/CNAME", "example.org\n");
    let refused = |words: &[&str]| {
        let answer = desk.run(words);
        assert_eq!((answer.stdout.as_str(), answer.code), ("", 2), "{answer:?}");
        answer.stderr
    };
    let with = |page: &str| refused(&["export", "study.zip", "--site", "site", "--page", page]);
    let built = "`.ci/page` in the source of this program builds it as target/page/verify.html\n";
    assert_eq!(
        with("nowhere.html"),
        format!("error: cannot read `nowhere.html`: no such file; {built}")
    );
    let expected = format!("expected the page `{GENERATOR} {version}, engine {engine}`");
    assert_eq!(
        with("report.html"),
        format!(
            "error: `report.html` cannot check this bundle: {expected}, found another file; {built}"
        )
    );
    assert_eq!(
        with("old.html"),
        format!(
            "error: `old.html` cannot check this bundle: {expected}, found `{GENERATOR} 0.0.9, engine 1`; {built}"
        )
    );
    assert_eq!(
        refused(&["export", "study.zip", "--site", "full", "--page", "report.html"]),
        "error: `full` is not empty: expected a new or empty folder, so that nothing else is published with the site; choose \
         another, or empty it\n"
    );
    assert!(!desk.path("site").exists(), "nothing was begun");
    let said = refused(&["export", "study.zip", "--site", "site"]);
    assert!(
        said.starts_with(
            "error: the following required arguments were not provided:\n  --page <FILE>\n"
        ),
        "{said}"
    );
}
