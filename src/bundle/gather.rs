//! From the records of a plan, one after another, to what a bundle is made of: their lines in files of bounded size, and their
//! numbers in columns. No record is held.

use super::{Content, InMemory, Scratch, SealedCondition, Spool, format};
use crate::plan::Plan;
use crate::studies::{Ledger, Outcome, TrialRecord};
use std::io::{self, Write as _};

/// The records of a plan, gathered.
#[derive(Debug, Clone, PartialEq)]
pub struct Gathered {
    /// What the trials came to.
    pub ledger: Ledger,
    /// The lines of their records, by condition in plan order.
    pub conditions: Vec<SealedCondition>,
}

impl Gathered {
    /// Gathers `records`, which stand in the order of `plan`, in memory.
    pub fn of(plan: &Plan, records: &[TrialRecord]) -> Self {
        const HELD: &str = "memory takes every byte";
        let scratch = InMemory::default();
        let mut gathering = Gathering::new(plan, &scratch);
        for record in records {
            gathering.take(record).expect(HELD);
        }
        gathering.finish().expect(HELD)
    }
}

/// Gathers the records of a plan, in its order.
#[derive(Debug)]
pub struct Gathering<'a> {
    plan: &'a Plan,
    scratch: &'a dyn Scratch,
    /// The trial of the plan that the next record belongs to.
    next: usize,
    ledger: Ledger,
    conditions: Vec<SealedCondition>,
    /// The file that the last condition goes on in.
    open: Option<Spool<'a>>,
    /// Bytes of all files that are held in memory.
    held: u64,
}

/// Most bytes of records that are held in memory, however many files they are in.
const MOST_HELD: u64 = 16 << 20;

impl<'a> Gathering<'a> {
    /// Begins with the first trial of `plan`; what is large is written to `scratch`.
    pub fn new(plan: &'a Plan, scratch: &'a dyn Scratch) -> Self {
        let (ledger, conditions) = (Ledger::default(), Vec::new());
        Self { plan, scratch, next: 0, ledger, conditions, open: None, held: 0 }
    }

    /// Takes the record of the next trial.
    ///
    /// # Errors
    /// Where its line cannot be written.
    pub fn take(&mut self, record: &TrialRecord) -> io::Result<()> {
        self.ledger.enter(record);
        // Records beyond the plan belong to none of its conditions.
        let Some(spec) = self.plan.trials.get(self.next) else { return Ok(()) };
        let is_new = self.next == 0 || self.plan.trials[self.next - 1].condition != spec.condition;
        self.next += 1;
        if is_new {
            self.close()?;
            self.conditions.push(SealedCondition {
                slug: spec.condition.slug(),
                label: spec.condition.to_string(),
                trials: 0,
                failed: 0,
                parts: Vec::new(),
            });
        }
        let mut line = record.to_line();
        line.push('\n');
        let is_full =
            |open: &Spool<'_>| open.size() > 0 && open.size() + line.len() as u64 > format::PART;
        if self.open.as_ref().is_some_and(is_full) {
            self.close()?;
        }
        let open = match &mut self.open {
            Some(open) => open,
            none => none.insert(Spool::holding(self.scratch, MOST_HELD - self.held)),
        };
        open.write_all(line.as_bytes())?;
        if let Some(condition) = self.conditions.last_mut() {
            condition.trials += 1;
            condition.failed += usize::from(record.outcome == Outcome::PANICKED);
        }
        Ok(())
    }

    /// Estimates how much memory (bytes) taking `record` would take for good.
    pub fn weight_of(&self, record: &TrialRecord) -> usize {
        self.ledger.weight_of(record)
    }

    fn close(&mut self) -> io::Result<()> {
        if let (Some(open), Some(condition)) = (self.open.take(), self.conditions.last_mut()) {
            let part = open.finish()?;
            self.held += part.as_file().held().map_or(0, |bytes| bytes.len() as u64);
            condition.parts.push(part);
        }
        Ok(())
    }

    /// Returns what was gathered.
    ///
    /// # Errors
    /// Where the last lines cannot be written.
    pub fn finish(mut self) -> io::Result<Gathered> {
        self.close()?;
        Ok(Gathered { ledger: self.ledger, conditions: self.conditions })
    }
}

/// Returns the lines of records as a bundle holds them: files of at most [`format::PART`] bytes, whole lines each.
pub fn in_parts<'l>(lines: impl IntoIterator<Item = &'l str>) -> Vec<Content> {
    let mut parts: Vec<Vec<u8>> = Vec::new();
    for line in lines {
        // With its line feed.
        let is_full = |part: &Vec<u8>| (part.len() + line.len()) as u64 >= format::PART;
        if parts.last().is_none_or(is_full) {
            parts.push(Vec::new());
        }
        let part = parts.last_mut().expect("there is one");
        part.extend_from_slice(line.as_bytes());
        part.push(b'\n');
    }
    parts.into_iter().map(Content::from).collect()
}
