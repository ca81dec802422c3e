//! The honest bundle that every attack begins with: a tiny study, run once by the program under test.

use crate::sandbox::{Sandbox, tiny};
use reenact::bundle::{Limits, Tree, archive};
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

/// Two cells of three trials of 20 simulated seconds, with a table, a figure and a claim.
pub(crate) const STUDY: &str = tiny!(
    "authors: [{name: A. Researcher}]
tables:
  - id: table-1
    title: Distance travelled (m) at levels of coverage
    coverage-table: {metric: distance-m, at: [50], by: prior, baseline: none}
figures:
  - id: figure-1
    title: Coverage over time
    coverage-curve: {against: time-s, by: prior}
claims:
  - id: T1
    says: within 20 s the robot drives at least 5 m
    paper-table: silent
    expect: {between: {metric: distance-m, where: {prior: none}, low: 5, minimum-n: 3}}
"
);

/// A bundle that is what it says.
pub(crate) struct Honest {
    /// As `run` wrote it.
    pub(crate) zip: Vec<u8>,
    /// Its files, by their path in the bag.
    pub(crate) tree: Tree,
    /// Its one folder.
    pub(crate) root: String,
}

/// The honest bundle.
pub(crate) static HONEST: LazyLock<Honest> = LazyLock::new(|| {
    let sandbox = Sandbox::pinned().with_study(STUDY);
    let answer = sandbox.run(&["run", "tiny.yaml", "--no-cache"]);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    let path = Path::new(answer.last_line());
    let zip = fs::read(sandbox.path(answer.last_line())).unwrap();
    let tree = archive::read(&zip, &Limits::default()).unwrap().tree;
    Honest { zip, tree, root: path.file_stem().unwrap().to_str().unwrap().to_owned() }
});
