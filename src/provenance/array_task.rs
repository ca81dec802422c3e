//! Which task of an array job this process is, as the engines of laboratories tell their tasks.
//!
//! | engine | which task | of how many |
//! |---|---|---|
//! | Slurm (`sbatch --array`) | `SLURM_ARRAY_TASK_ID` from `SLURM_ARRAY_TASK_MIN` in steps of `SLURM_ARRAY_TASK_STEP` | `SLURM_ARRAY_TASK_COUNT` |
//! | Kubernetes (an Indexed Job) | `JOB_COMPLETION_INDEX`, from 0 | does not say |
//! | AWS Batch (an array job) | `AWS_BATCH_JOB_ARRAY_INDEX`, from 0 | `AWS_BATCH_JOB_ARRAY_SIZE` |
//!
//! `REENACT_SHARDS` says of how many where the engine does not.

use thiserror::Error;

/// The environment variable that says of how many tasks this is one.
const SHARDS: &str = "REENACT_SHARDS";

/// One task of an array job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArrayTask {
    /// The variable that says which task it is.
    pub told_by: &'static str,
    /// Which it is, from 1.
    pub number: u32,
    /// Of how many; `None` where nothing says it.
    pub of: Option<u32>,
}

/// Why the environment does not say which task this is.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ArrayTaskError {
    /// A variable is no number of tasks.
    #[error("{variable}: expected a whole number from {least}, found `{found}`")]
    NoNumber {
        /// Its name.
        variable: &'static str,
        /// The least it may be.
        least: u32,
        /// What it is.
        found: String,
    },
    /// Variables come in company.
    #[error("expected {missing} beside {given}, found it unset")]
    Alone {
        /// The one that is set.
        given: &'static str,
        /// The one that is not.
        missing: &'static str,
    },
    /// Variables say what cannot be.
    #[error("expected a task of {of}, found {given}={number}")]
    Beyond {
        /// The variable that says which.
        given: &'static str,
        /// What it says.
        number: u32,
        /// Which there are, in words.
        of: String,
    },
    /// The tasks of a Slurm array are not as far apart as it says.
    #[error(
        "expected a Slurm array without gaps, found {count} tasks from {first} to {last} in steps of {step}: a lost task is \
         run again as `--shard I/N` with the N of the array that lost it"
    )]
    Gaps {
        /// How many there are.
        count: u32,
        /// The first.
        first: u32,
        /// The last.
        last: u32,
        /// What lies between two.
        step: u32,
    },
    /// Two engines say it.
    #[error("expected one engine's array job, found {0} and {1} set")]
    Several(&'static str, &'static str),
    /// The engine and the user count otherwise.
    #[error("expected as many tasks as {SHARDS} says ({stated}), found {told_by} as one of {of}")]
    Otherwise {
        /// What the variable says.
        stated: u32,
        /// The variable that says which task it is.
        told_by: &'static str,
        /// Of how many the engine says.
        of: u32,
    },
}

impl ArrayTask {
    /// Reads which task this is from an environment given as a function; `None` where it is none of an array job.
    ///
    /// # Errors
    /// Where it says what cannot be.
    pub fn from_lookup(
        lookup: impl Fn(&str) -> Option<String>,
    ) -> Result<Option<Self>, ArrayTaskError> {
        let number = |variable: &'static str, least: u32| {
            let Some(found) = lookup(variable) else { return Ok(None) };
            match found.parse() {
                Ok(number) if (least..u32::MAX).contains(&number) => Ok(Some(number)),
                _ => Err(ArrayTaskError::NoNumber { variable, least, found }),
            }
        };
        let (slurm, indexed, batch) =
            (slurm(&number)?, indexed("JOB_COMPLETION_INDEX", None, &number)?, batch(&number)?);
        let mut tasks = [slurm, indexed, batch].into_iter().flatten();
        let Some(task) = tasks.next() else { return Ok(None) };
        if let Some(other) = tasks.next() {
            return Err(ArrayTaskError::Several(task.told_by, other.told_by));
        }
        let Some(stated) = number(SHARDS, 1)? else { return Ok(Some(task)) };
        match task.of {
            Some(of) if of != stated => {
                Err(ArrayTaskError::Otherwise { stated, told_by: task.told_by, of })
            }
            _ if task.number > stated => Err(ArrayTaskError::Beyond {
                given: task.told_by,
                number: task.number - 1,
                of: format!("{SHARDS}={stated}, which are 0 to {}", stated - 1),
            }),
            _ => Ok(Some(Self { of: Some(stated), ..task })),
        }
    }
}

type Number<'a> = &'a dyn Fn(&'static str, u32) -> Result<Option<u32>, ArrayTaskError>;

/// Reads a task of a Slurm array, which begins at any number and may go in steps.
fn slurm(number: Number<'_>) -> Result<Option<ArrayTask>, ArrayTaskError> {
    const ID: &str = "SLURM_ARRAY_TASK_ID";
    let Some(id) = number(ID, 0)? else { return Ok(None) };
    let beside = |missing: &'static str, least| {
        number(missing, least)?.ok_or(ArrayTaskError::Alone { given: ID, missing })
    };
    let (first, last) = (beside("SLURM_ARRAY_TASK_MIN", 0)?, beside("SLURM_ARRAY_TASK_MAX", 0)?);
    let count = beside("SLURM_ARRAY_TASK_COUNT", 1)?;
    let step = number("SLURM_ARRAY_TASK_STEP", 1)?.unwrap_or(1);
    if last.checked_sub(first).is_none_or(|span| span / step + 1 != count) {
        return Err(ArrayTaskError::Gaps { count, first, last, step });
    }
    if !(first..=last).contains(&id) || (id - first) % step != 0 {
        let of = format!("{first} to {last} in steps of {step}");
        return Err(ArrayTaskError::Beyond { given: ID, number: id, of });
    }
    Ok(Some(ArrayTask { told_by: ID, number: (id - first) / step + 1, of: Some(count) }))
}

/// Reads a task of an AWS Batch array job.
fn batch(number: Number<'_>) -> Result<Option<ArrayTask>, ArrayTaskError> {
    const INDEX: &str = "AWS_BATCH_JOB_ARRAY_INDEX";
    const SIZE: &str = "AWS_BATCH_JOB_ARRAY_SIZE";
    if number(INDEX, 0)?.is_none() {
        return Ok(None);
    }
    let size = number(SIZE, 1)?.ok_or(ArrayTaskError::Alone { given: INDEX, missing: SIZE })?;
    indexed(INDEX, Some(size), number)
}

/// Reads a task that is counted from 0.
fn indexed(
    told_by: &'static str,
    of: Option<u32>,
    number: Number<'_>,
) -> Result<Option<ArrayTask>, ArrayTaskError> {
    let Some(index) = number(told_by, 0)? else { return Ok(None) };
    match of {
        Some(of) if index >= of => Err(ArrayTaskError::Beyond {
            given: told_by,
            number: index,
            of: format!("0 to {}", of - 1),
        }),
        _ => Ok(Some(ArrayTask { told_by, number: index + 1, of })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(pairs: &[(&str, &str)]) -> Result<Option<(u32, Option<u32>)>, String> {
        let lookup = |name: &str| {
            pairs.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned())
        };
        let task = ArrayTask::from_lookup(lookup).map_err(|e| e.to_string())?;
        Ok(task.map(|task| (task.number, task.of)))
    }

    const SLURM: [&str; 5] = ["ID", "MIN", "MAX", "COUNT", "STEP"];

    fn slurm(values: [&str; 5]) -> Result<Option<(u32, Option<u32>)>, String> {
        let names = SLURM.map(|name| format!("SLURM_ARRAY_TASK_{name}"));
        let pairs: Vec<_> = names.iter().map(String::as_str).zip(values).collect();
        read(&pairs)
    }

    #[test]
    fn slurm_arrays_begin_anywhere_and_go_in_steps() {
        assert_eq!(slurm(["1", "1", "4", "4", "1"]), Ok(Some((1, Some(4)))));
        assert_eq!(slurm(["0", "0", "7", "8", "1"]), Ok(Some((1, Some(8)))));
        assert_eq!(slurm(["16", "10", "19", "4", "3"]), Ok(Some((3, Some(4)))));
        assert_eq!(
            slurm(["17", "10", "20", "4", "3"]).unwrap_err(),
            "expected a task of 10 to 20 in steps of 3, found SLURM_ARRAY_TASK_ID=17"
        );
        assert_eq!(
            slurm(["3", "1", "7", "3", "1"]).unwrap_err(),
            "expected a Slurm array without gaps, found 3 tasks from 1 to 7 in steps of 1: a lost task is run again as \
             `--shard I/N` with the N of the array that lost it"
        );
        assert_eq!(
            slurm(["3", "7", "1", "3", "1"]).unwrap_err(),
            "expected a Slurm array without gaps, found 3 tasks from 7 to 1 in steps of 1: a lost task is run again as \
             `--shard I/N` with the N of the array that lost it"
        );
        assert_eq!(
            slurm(["-1", "1", "4", "4", "1"]).unwrap_err(),
            "SLURM_ARRAY_TASK_ID: expected a whole number from 0, found `-1`"
        );
        assert_eq!(
            slurm(["1", "1", "4", "4", "0"]).unwrap_err(),
            "SLURM_ARRAY_TASK_STEP: expected a whole number from 1, found `0`"
        );
        assert_eq!(
            read(&[("SLURM_ARRAY_TASK_ID", "1")]).unwrap_err(),
            "expected SLURM_ARRAY_TASK_MIN beside SLURM_ARRAY_TASK_ID, found it unset"
        );
    }

    #[test]
    fn others_count_from_zero() {
        assert_eq!(read(&[]), Ok(None));
        assert_eq!(read(&[("REENACT_SHARDS", "4")]), Ok(None), "of four, and none of them");
        assert_eq!(read(&[("JOB_COMPLETION_INDEX", "0")]), Ok(Some((1, None))));
        let kubernetes =
            |index, shards| read(&[("JOB_COMPLETION_INDEX", index), ("REENACT_SHARDS", shards)]);
        assert_eq!(kubernetes("3", "4"), Ok(Some((4, Some(4)))));
        assert_eq!(
            kubernetes("4", "4").unwrap_err(),
            "expected a task of REENACT_SHARDS=4, which are 0 to 3, found JOB_COMPLETION_INDEX=4"
        );
        let batch = |index, size| {
            read(&[("AWS_BATCH_JOB_ARRAY_INDEX", index), ("AWS_BATCH_JOB_ARRAY_SIZE", size)])
        };
        assert_eq!(batch("0", "3"), Ok(Some((1, Some(3)))));
        assert_eq!(
            batch("3", "3").unwrap_err(),
            "expected a task of 0 to 2, found AWS_BATCH_JOB_ARRAY_INDEX=3"
        );
        assert_eq!(
            read(&[("AWS_BATCH_JOB_ARRAY_INDEX", "0")]).unwrap_err(),
            "expected AWS_BATCH_JOB_ARRAY_SIZE beside AWS_BATCH_JOB_ARRAY_INDEX, found it unset"
        );
    }

    #[test]
    fn contradictions_are_told() {
        let slurm = [
            ("SLURM_ARRAY_TASK_ID", "1"),
            ("SLURM_ARRAY_TASK_MIN", "1"),
            ("SLURM_ARRAY_TASK_MAX", "4"),
            ("SLURM_ARRAY_TASK_COUNT", "4"),
        ];
        let with = |name, value| read(&[&slurm[..], &[(name, value)]].concat()).unwrap_err();
        assert_eq!(
            with("JOB_COMPLETION_INDEX", "0"),
            "expected one engine's array job, found SLURM_ARRAY_TASK_ID and JOB_COMPLETION_INDEX set"
        );
        assert_eq!(
            with("REENACT_SHARDS", "8"),
            "expected as many tasks as REENACT_SHARDS says (8), found SLURM_ARRAY_TASK_ID as one of 4"
        );
    }
}
