//! A map of an earlier exploration that is not what that exploration gives: found at level 5, not before.

use super::*;
use crate::document::Source;
use crate::manifest::{self, InputError, Inputs, WrittenIn};
use crate::plan::{Plan, Selection};
use crate::runner::{Scheduler, Silent};
use crate::studies::{self, TrialSpec};

const ROOM: &str = "reenact-world: 1\nname: room\nsource: test\nlayers:\n  walls: {walls: [{path-m: [[0, 0], [4, 0], \
    [4, 3], [0, 3], [0, 0]], thickness-m: 0.2}]}\n";
const MANIFEST: &str = "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\nseed: 1\ntrials: 1\nrobot: kobuki.urdf\n\
    world: {file: room.yaml}\nstart: {x-m: 1, y-m: 1}\nprior: m\nprior-maps:\n  m: {previous-map: {world: {file: room.yaml}, \
    prior: none, why: test}}\nparameters: {sensing: {range-m: 10}}\n";

/// The room's files; explorations, honest or with one cell more.
struct Inn {
    honest: bool,
}

impl Inputs for Inn {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/robots/kobuki.urdf");
        match as_written {
            "room.yaml" => Ok(ROOM.as_bytes().to_vec()),
            "kobuki.urdf" => std::fs::read(robot).map_err(InputError::other),
            _ => Err(InputError::NoFile),
        }
    }

    fn explore(
        &self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], InputError> {
        let [descriptor, mut image] = manifest::explored(spec, sealed_as)?;
        if !self.honest {
            let last = image.len() - 200;
            image[last] ^= 0xfe;
        }
        Ok([descriptor, image])
    }
}

/// Climbs to `level` with the bundle of a run that starts from such a map, all the rest as it follows from it.
fn climbed(honest: bool, level: Level) -> Report {
    let source = Source::new("study.yaml", MANIFEST);
    let (experiment, _) = manifest::resolve(&source, &[], &Inn { honest }).unwrap();
    let plan = Plan::of(experiment);
    let scheduler = Scheduler::new(1).unwrap();
    let records = scheduler.run(&plan.trials, &studies::execute, None, &Silent).unwrap();
    let selection = Selection::default();
    let content =
        crate::bundle::assemble::assemble(&plan, MANIFEST.as_bytes(), &selection, &records);
    let sealed = crate::bundle::seal(&content.unwrap(), &sample::circumstance()).unwrap();
    // Level 6 wants another seed than the experiment's.
    let options = Options { level, sample: 1, rows: None, seed: 2 };
    let archive = Archive::of(Form::Bag, sealed.tree);
    climb(Ok(archive), &options, &Reenactment::new(1).unwrap())
}

#[test]
fn an_earlier_exploration_is_run_again_at_level_5() {
    let honest = climbed(true, Level::Full);
    assert_eq!((honest.findings.as_slice(), honest.verdict()), (&[][..], Verdict::Holds));
    let forged = climbed(false, Level::Sampled);
    assert_eq!((forged.findings.as_slice(), forged.verdict()), (&[][..], Verdict::Holds));
    let forged = climbed(false, Level::Full);
    assert_eq!((forged.reached, forged.verdict()), (Some(Level::Sampled), Verdict::Broken));
    let [finding] = &forged.findings[..] else { panic!("{:?}", forged.findings) };
    assert!(finding.path.starts_with("data/inputs/previous-map-"), "{}", finding.path);
    assert!(finding.expected.ends_with(" as explored again"), "{}", finding.expected);
    let hint = "the previous map that the study starts from is not what that exploration gives";
    assert_eq!(finding.hint, hint);
}

#[test]
fn a_fresh_seed_explores_afresh() {
    let report = climbed(true, Level::Replicated);
    // All that keeps this level open is that the study claims nothing.
    let [open] = &report.findings[..] else { panic!("{:?}", report.findings) };
    assert_eq!(open.expected, "claims to judge again");
    assert_eq!(report.replication.unwrap().seed, 2);
}
