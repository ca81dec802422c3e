//! Records of shards in the order of the whole: each bundle is read once, from its first record to its last, and of each no more
//! than one record is held.

use super::{Conflict, MergeError, Merged};
use crate::bundle::RecordLines;
use crate::digest::{Sha256Digest, TrialKey};
use crate::studies::{TrialRecord, TrialSpec};
use std::io;

/// The records of one condition in one bundle, with a look at the next one.
struct Reading<'a> {
    name: &'a str,
    shard: u32,
    lines: RecordLines<'a>,
    next: Option<TrialRecord>,
}

impl Reading<'_> {
    /// Returns the record that comes next, and looks at the one after it.
    fn take(&mut self) -> Result<Option<TrialRecord>, MergeError> {
        let after = match self.lines.next_line() {
            Some(line) => Some(TrialRecord::from_line(line.text).map_err(|problem| {
                let (name, place) = (self.name.to_owned(), line.place());
                MergeError::NoRecord { name, place, problem: problem.to_string() }
            })?),
            None => None,
        };
        Ok(std::mem::replace(&mut self.next, after))
    }
}

impl Merged<'_> {
    /// Hands over the record of every trial, in plan order.
    ///
    /// # Errors
    /// Where a shard lacks a record or has one too many, two records of a trial differ, or `take` fails.
    pub fn records(
        &self,
        mut take: impl FnMut(&TrialRecord) -> io::Result<()>,
    ) -> Result<(), MergeError> {
        let dealt = self.plan.dealt(self.shards, self.dealt);
        let mut dealt = &dealt[..];
        for trials in self.plan.trials.chunk_by(|a, b| a.condition == b.condition) {
            let mut readings = self.readings(&trials[0].condition.slug())?;
            let (shards, rest) = dealt.split_at(trials.len());
            dealt = rest;
            for (spec, shard) in trials.iter().zip(shards) {
                take(&self.record(&mut readings, spec, *shard)?)?;
            }
            let left = readings.iter().find_map(|r| r.next.as_ref().map(|record| (r, record)));
            if let Some((reading, record)) = left {
                return Err(self.stray(reading, record));
            }
        }
        Ok(())
    }

    /// Begins to read the records of a condition in all bundles, in the order of their shards.
    fn readings(&self, slug: &str) -> Result<Vec<Reading<'_>>, MergeError> {
        let bundles =
            self.given.iter().flat_map(|(shard, at)| at.iter().map(move |&at| (*shard, at)));
        let readings = bundles.map(|(shard, at)| {
            let lines = self.bundles[at].bundle.record_reader(slug);
            let mut reading = Reading { name: &self.bundles[at].name, shard, lines, next: None };
            reading.take()?;
            Ok(reading)
        });
        readings.collect()
    }

    /// Reads the record of `spec` from every bundle of its shard, of which [`super::merge`] has seen that there is one.
    fn record(
        &self,
        readings: &mut [Reading<'_>],
        spec: &TrialSpec,
        shard: u32,
    ) -> Result<TrialRecord, MergeError> {
        let first = readings.partition_point(|reading| reading.shard < shard);
        let mut found = self.next(readings, first, spec)?;
        for at in first + 1..readings.len() {
            if readings[at].shard != shard {
                break;
            }
            let again = self.next(readings, at, spec)?;
            if again != found {
                return Err(conflict((readings[first].name, &found), (readings[at].name, &again)));
            }
            found = again;
        }
        Ok(found)
    }

    /// Reads the record of `spec` from the bundle that is read at `at`.
    fn next(
        &self,
        readings: &mut [Reading<'_>],
        at: usize,
        spec: &TrialSpec,
    ) -> Result<TrialRecord, MergeError> {
        let here = &mut readings[at];
        if here.next.as_ref().is_some_and(|record| record.key == spec.key)
            && let Some(record) = here.take()?
        {
            return Ok(record);
        }
        Err(self.out_of_order(readings, at, spec))
    }

    /// Says what is wrong where the bundle that is read at `at` goes on with something else than `spec`: that it holds what is none
    /// of it, that another bundle does, or that it lacks the trial.
    fn out_of_order(&self, readings: &[Reading<'_>], at: usize, spec: &TrialSpec) -> MergeError {
        let here = &readings[at];
        let elsewhere = readings.iter().find_map(|reading| {
            let record = reading.next.as_ref()?;
            (reading.shard != here.shard && record.key == spec.key).then_some((reading, record))
        });
        if let Some((reading, record)) = elsewhere {
            return self.stray(reading, record);
        }
        match &here.next {
            Some(record) if self.shard_of(record.key) != Some(here.shard) => {
                self.stray(here, record)
            }
            _ => MergeError::Gap {
                name: here.name.to_owned(),
                trial: format!("{}/{}", spec.condition.slug(), spec.trial),
                shard: here.shard,
                of: self.shards,
            },
        }
    }

    fn stray(&self, reading: &Reading<'_>, record: &TrialRecord) -> MergeError {
        MergeError::Stray {
            name: reading.name.to_owned(),
            trial: name_of(record),
            shard: reading.shard,
            of: self.shards,
        }
    }

    /// Returns the shard of the trial with this key, looked for only where something is wrong.
    fn shard_of(&self, key: TrialKey) -> Option<u32> {
        let at = self.plan.trials.iter().position(|spec| spec.key == key)?;
        self.plan.dealt(self.shards, self.dealt).get(at).copied()
    }
}

fn conflict(
    (first, known): (&str, &TrialRecord),
    (name, found): (&str, &TrialRecord),
) -> MergeError {
    MergeError::Conflict(Box::new(Conflict {
        trial: name_of(found),
        key: found.key,
        first: first.to_owned(),
        expected: Sha256Digest::of(known.to_line()),
        name: name.to_owned(),
        found: Sha256Digest::of(found.to_line()),
        divergence: known.parting(found),
    }))
}

fn name_of(record: &TrialRecord) -> String {
    format!("{}/{}", record.condition.slug(), record.trial)
}
