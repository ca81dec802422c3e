//! `--shard auto`: which shard this is, by the engine that runs it.

use super::args::SelectArgs;
use super::exit::Failure;
use crate::provenance::{ArrayTask, ArrayTaskError, Environment};

/// Why `--shard auto` is no shard.
#[derive(Debug, thiserror::Error)]
enum Unplaced {
    #[error("`--shard {0}` is neither I/N nor `auto` nor `auto/N` with N from 1")]
    Form(String),
    #[error("`--shard auto`: {0}")]
    Environment(ArrayTaskError),
    #[error(
        "`--shard auto`: expected a task of an array job, found none of SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX and \
         AWS_BATCH_JOB_ARRAY_INDEX set; name the shard: `--shard I/N`"
    )]
    NoTask,
    #[error(
        "`--shard auto`: {told_by} says that this is task {number}, and nothing says of how many; write `--shard auto/N`, or \
         set REENACT_SHARDS to N"
    )]
    OfUnknown { told_by: &'static str, number: u32 },
    #[error(
        "`--shard auto/{asked}`: expected a task of {asked}, found {told_by} as task {number} of {of}"
    )]
    Otherwise { asked: u32, told_by: &'static str, number: u32, of: String },
}

/// Replaces `--shard auto` by the shard that the environment names.
pub(super) fn place(select: &mut SelectArgs, environment: &Environment) -> Result<(), Failure> {
    if let Some(written) = select.shard.as_deref().filter(|written| written.starts_with("auto")) {
        let (i, n) = placed(written, &environment.array_task).map_err(Failure::not_understood)?;
        select.shard = Some(format!("{i}/{n}"));
    }
    Ok(())
}

fn placed(
    written: &str,
    task: &Result<Option<ArrayTask>, ArrayTaskError>,
) -> Result<(u32, u32), Unplaced> {
    let form = || Unplaced::Form(written.to_owned());
    let asked = match written.strip_prefix("auto") {
        Some("") => None,
        Some(rest) => {
            let n: u32 = rest.strip_prefix('/').and_then(|n| n.parse().ok()).ok_or_else(form)?;
            Some(n).filter(|n| *n > 0).ok_or_else(form).map(Some)?
        }
        None => return Err(form()),
    };
    let task = task.clone().map_err(Unplaced::Environment)?.ok_or(Unplaced::NoTask)?;
    let ArrayTask { told_by, number, of } = task;
    match (asked, of) {
        (None, None) => Err(Unplaced::OfUnknown { told_by, number }),
        (None, Some(of)) => Ok((number, of)),
        (Some(asked), of) if of.is_some_and(|of| of != asked) || number > asked => {
            let of = of.map_or_else(|| "an unknown number".to_owned(), |of| of.to_string());
            Err(Unplaced::Otherwise { asked, told_by, number, of })
        }
        (Some(asked), _) => Ok((number, asked)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_placed_by_what_the_engine_says_and_refused_by_what_contradicts_it() {
        let task = |number, of| Ok(Some(ArrayTask { told_by: "JOB_COMPLETION_INDEX", number, of }));
        let told = |written, task| placed(written, &task).map_err(|e| e.to_string());
        assert_eq!(told("auto", task(2, Some(4))), Ok((2, 4)));
        assert_eq!(told("auto/4", task(2, Some(4))), Ok((2, 4)));
        assert_eq!(told("auto/4", task(2, None)), Ok((2, 4)));
        for (written, task, expected) in [
            (
                "auto",
                Ok(None),
                "`--shard auto`: expected a task of an array job, found none of SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX and \
                 AWS_BATCH_JOB_ARRAY_INDEX set; name the shard: `--shard I/N`",
            ),
            (
                "auto",
                task(2, None),
                "`--shard auto`: JOB_COMPLETION_INDEX says that this is task 2, and nothing says of how many; write `--shard \
                 auto/N`, or set REENACT_SHARDS to N",
            ),
            (
                "auto/5",
                task(2, Some(4)),
                "`--shard auto/5`: expected a task of 5, found JOB_COMPLETION_INDEX as task 2 of 4",
            ),
            (
                "auto/3",
                task(4, None),
                "`--shard auto/3`: expected a task of 3, found JOB_COMPLETION_INDEX as task 4 of an unknown number",
            ),
            (
                "auto/0",
                task(1, None),
                "`--shard auto/0` is neither I/N nor `auto` nor `auto/N` with N from 1",
            ),
            (
                "automatic",
                task(1, None),
                "`--shard automatic` is neither I/N nor `auto` nor `auto/N` with N from 1",
            ),
            (
                "auto",
                Err(ArrayTaskError::Several("A", "B")),
                "`--shard auto`: expected one engine's array job, found A and B set",
            ),
        ] {
            assert_eq!(told(written, task).unwrap_err(), expected);
        }
    }
}
