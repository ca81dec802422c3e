use super::*;
use crate::condition::Condition;
use crate::digest::{Sha256Digest, TrialKey};
use crate::geometry::Pose;
use crate::rng::Seeds;
use crate::robot::Robot;
use crate::studies::{Outcome, Setup, TrialRecord, TrialSpec, prior_map};
use crate::world::World;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// Returns a plan of `trials` trials of which nothing but the identity matters here.
fn plan(trials: u32) -> Vec<TrialSpec> {
    let setup = Setup::new(prior_map::Setup::new(
        Arc::new(World::empty()),
        Arc::new(Robot::disc(0.2)),
        None,
        Pose::new(0.0, 0.0, 0.0),
        prior_map::Parameters::default(),
    ));
    (0..trials)
        .map(|trial| TrialSpec {
            key: TrialKey(Sha256Digest::of(trial.to_le_bytes())),
            condition: Condition::from([("prior", "none")]),
            trial,
            seeds: Seeds::new(1, Vec::new()),
            setup: setup.clone(),
        })
        .collect()
}

/// A store in memory, which may be full.
#[derive(Default)]
struct Memory {
    records: Mutex<BTreeMap<TrialKey, TrialRecord>>,
    capacity: Option<usize>,
}

impl TrialStore for Memory {
    fn get(&self, key: &TrialKey) -> Result<Option<TrialRecord>, StoreError> {
        Ok(self.records.lock().unwrap().get(key).cloned())
    }

    fn put(&self, record: &TrialRecord) -> Result<(), StoreError> {
        let mut records = self.records.lock().unwrap();
        if self.capacity.is_some_and(|capacity| records.len() >= capacity) {
            return Err(StoreError::Io("disk full".into()));
        }
        records.insert(record.key, record.clone());
        Ok(())
    }
}

fn run(jobs: usize, plan: &[TrialSpec], executor: &dyn Executor) -> Vec<TrialRecord> {
    Scheduler::new(jobs).unwrap().run(plan, executor, None, &Silent).unwrap()
}

#[test]
fn neither_threads_nor_order_touch_the_records() {
    let plan = plan(50);
    let one = run(1, &plan, &Mock::default());
    assert_eq!(run(4, &plan, &Mock::default()), one);
    // Slow trials first: completion order is far from plan order.
    let uneven = |spec: &TrialSpec| {
        std::thread::sleep(std::time::Duration::from_micros(u64::from(50 - spec.trial) * 20));
        Mock::default().execute(spec)
    };
    assert_eq!(run(4, &plan, &uneven), one);
    let mut shuffled = plan.clone();
    shuffled.sort_by_key(|spec| spec.key);
    let mut records = run(3, &shuffled, &Mock::default());
    records.sort_by_key(|record| record.trial);
    assert_eq!(records, one);
}

#[test]
fn a_panic_is_a_record_with_its_cause_and_is_never_stored() {
    let (plan, store) = (plan(6), Memory::default());
    let scheduler = Scheduler::new(2).unwrap();
    let failing = Mock { panicking: vec![2, 4] };
    let records = scheduler.run(&plan, &failing, Some(&store), &Silent).unwrap();
    assert_eq!(records[2].outcome, Outcome::PANICKED);
    assert_eq!(records[2].cause, "trial 2 was told to fail");
    assert_eq!(store.records.lock().unwrap().len(), 4);
    // Next time only those two run.
    let executed = AtomicUsize::new(0);
    let counting = |spec: &TrialSpec| {
        executed.fetch_add(1, Ordering::Relaxed);
        Mock::default().execute(spec)
    };
    let resumed = scheduler.run(&plan, &counting, Some(&store), &Silent).unwrap();
    assert_eq!(executed.load(Ordering::Relaxed), 2);
    assert_eq!(resumed, run(1, &plan, &Mock::default()), "resumed equals uninterrupted");
}

#[test]
fn events_tell_every_trial_once() {
    let (plan, store) = (plan(5), Memory::default());
    let scheduler = Scheduler::new(2).unwrap();
    scheduler.run(&plan[..2], &Mock::default(), Some(&store), &Silent).unwrap();
    let events = Mutex::new(Vec::new());
    let observer = |event: &RunEvent<'_>| {
        events.lock().unwrap().push(match *event {
            RunEvent::Started { trials, cached, jobs, .. } => {
                format!("{trials} trials, {cached} cached, {jobs} jobs")
            }
            RunEvent::Finished { index, record, cached } => {
                assert_eq!(record.trial as usize, index);
                format!("{index} {cached}")
            }
        });
    };
    scheduler.run(&plan, &Mock::default(), Some(&store), &observer).unwrap();
    let mut events = events.into_inner().unwrap();
    assert_eq!(events.remove(0), "5 trials, 2 cached, 2 jobs");
    events.sort();
    assert_eq!(events, ["0 true", "1 true", "2 false", "3 false", "4 false"]);
}

#[test]
fn a_full_disk_ends_the_run_and_keeps_what_was_stored() {
    let store = Memory { capacity: Some(3), ..Memory::default() };
    let error = Scheduler::new(2)
        .unwrap()
        .run(&plan(20), &Mock::default(), Some(&store), &Silent)
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "trial store: disk full; free some space, allow writing, or choose another place with REENACT_STORE"
    );
    assert_eq!(store.records.lock().unwrap().len(), 3);
}

/// Returns an executor whose trials give the same bytes at first sight; those of `numbers` are spoilt by `spoil` every
/// second time.
fn flaky(
    numbers: &'static [u32],
    spoil: fn(&mut TrialRecord),
) -> impl Fn(&TrialSpec) -> TrialRecord + Sync {
    let seen = Mutex::new(BTreeMap::<u32, usize>::new());
    move |spec: &TrialSpec| {
        let mut record = Mock::default().execute(spec);
        let mut seen = seen.lock().unwrap();
        let times = seen.entry(spec.trial).or_default();
        *times += 1;
        if numbers.contains(&spec.trial) && *times == 2 {
            drop(seen);
            spoil(&mut record);
        }
        record
    }
}

#[test]
fn twice_finds_what_is_not_deterministic_and_names_the_first_divergent_step() {
    let plan = plan(6);
    let executor = flaky(&[4, 2], |record| {
        record.chain[1] = "0".repeat(16);
        record.measures.insert("distance-m".to_owned(), Some(1.5));
    });
    let twice = Twice::new(&executor);
    let records = run(3, &plan, &twice);
    assert_eq!(records, run(1, &plan, &Mock::default()), "the first of the two is kept");
    let mut spoilt = records[2].clone();
    spoilt.chain[1] = "0".repeat(16);
    spoilt.measures.insert("distance-m".to_owned(), Some(1.5));
    assert_eq!(
        twice.verdict(6).unwrap_err().to_string(),
        format!(
            "trial none/2 (key {}): expected the same bytes twice, found sha256:{} and sha256:{} whose states first differ \
             between 10 s and 20 s of simulated time; 2 of 6 trials differ: the engine is not deterministic, so nothing \
             is stored or sealed; please report it, with the manifest and its inputs",
            plan[2].key,
            Sha256Digest::of(records[2].to_line()),
            Sha256Digest::of(spoilt.to_line()),
        )
    );
}

#[test]
fn twice_finds_a_panic_that_comes_once_and_is_content_with_one_that_comes_twice() {
    let executor = flaky(&[1], |_| panic!("once in a while"));
    let twice = Twice::new(&executor);
    run(2, &plan(3), &twice);
    let Err(RunError::Nondeterministic { first, count, executed }) = twice.verdict(3) else {
        panic!("a panic that comes once was missed");
    };
    assert_eq!((first.trial, count, executed), (1, 1, 3));

    let failing = Mock { panicking: vec![1] };
    let twice = Twice::new(&failing);
    let records = run(2, &plan(3), &twice);
    assert_eq!(
        records,
        run(1, &plan(3), &failing),
        "a panicked trial stays a record with its cause"
    );
    assert_eq!(twice.verdict(3), Ok(()));
}
