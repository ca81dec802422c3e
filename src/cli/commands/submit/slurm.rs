//! An array job, and a job after it that seals.

use super::{Work, absolute, program};
use crate::bundle::shell_word;
use crate::cli::args::{DataFormat, SubmitArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::provenance::Environment;
use crate::store::reason;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What stands for the number of the array's job before there is one.
const ARRAY: &str = "ARRAY";

/// The two scripts, and where they are.
struct Scripts {
    folder: PathBuf,
    shards: String,
    seal: String,
}

/// Writes and submits both jobs, or prints them.
pub(super) fn submit(
    work: &Work,
    args: &SubmitArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    let store = environment.store().map_err(Failure::not_understood)?;
    let scripts = Scripts::of(work, args, &absolute(store)?)?;
    let (shards, seal) = (scripts.folder.join("shards.sh"), scripts.folder.join("seal.sh"));
    if args.dry_run {
        let told = |path: &Path, text: &str| format!("# {}\n{text}\n", path.display());
        terminal.result(&format!(
            "{}{}# submitted by\n{}\n{}\n",
            told(&shards, &scripts.shards),
            told(&seal, &scripts.seal),
            line(&words(&shards, None))?,
            line(&words(&seal, Some(ARRAY)))?,
        ));
        return Ok(Exit::Yes);
    }
    load::write(&shards, scripts.shards.as_bytes())?;
    load::write(&seal, scripts.seal.as_bytes())?;
    let array = sbatch(&words(&shards, None))?;
    let sealing = sbatch(&words(&seal, Some(&array))).map_err(|failure| Failure {
        message: format!(
            "{}; the array is submitted as job {array}: `scancel {array}` takes it back, or run the manifest when it has ended",
            failure.message
        ),
        ..failure
    })?;
    let out = absolute(&args.out)?;
    terminal.result(&match args.format {
        DataFormat::Json => json!({
            "engine": "slurm",
            "shards": work.shards,
            "trials": work.trials,
            "array_job": array,
            "seal_job": sealing,
            "scripts": absolute(&scripts.folder)?,
            "store": absolute(store)?,
            "out": out,
        })
        .to_string(),
        DataFormat::Human => format!(
            "job {array}: {} of {} trials, into {}\njob {sealing}: seals them when all have ended well, into {}\nscripts and \
             logs are in {}\n",
            counted(work.shards as usize, "shard"),
            work.trials,
            store.display(),
            out.display(),
            scripts.folder.display()
        ),
    });
    Ok(Exit::Yes)
}

impl Scripts {
    fn of(work: &Work, args: &SubmitArgs, store: &Path) -> Result<Self, Failure> {
        let folder = args.slurm.scripts.clone();
        let folder = folder.unwrap_or_else(|| PathBuf::from(format!("{}.slurm", work.name)));
        let logs = absolute(&folder)?;
        let shards = work.shards;
        let throttle = args.throttle.map(|most| format!("%{most}")).unwrap_or_default();
        let common = |job: &str, log: &str| -> Result<String, Failure> {
            let mut lines = vec![format!("--job-name=reenact-{}{job}", work.name)];
            let options = [
                ("partition", &args.slurm.partition),
                ("account", &args.slurm.account),
                ("time", &args.slurm.time),
                ("mem", &args.memory),
            ];
            for (name, value) in options {
                lines.extend(value.iter().map(|value| format!("--{name}={value}")));
            }
            lines.push("--ntasks=1".to_owned());
            lines.push(format!("--cpus-per-task={}", args.cpus));
            // Whatever was finished is in the store, so that a job begun again goes on where it was.
            lines.push("--requeue".to_owned());
            lines.push("--open-mode=append".to_owned());
            lines.push(format!("--output={}", quoted(&logs.join(log))?));
            Ok(format!("#SBATCH {}\n", lines.join("\n#SBATCH ")))
        };
        let here = absolute(Path::new("."))?;
        let begin = |job: &str| -> Result<String, Failure> {
            Ok(format!(
                "\n# {job}\nset -eu\ncd {}\nexport REENACT_STORE={}\n",
                quoted(&here)?,
                quoted(store)?
            ))
        };
        let mut run = vec![quoted(&program()?)?, "run".to_owned(), quoted(&args.manifest)?];
        for option in &work.options {
            run.push(shell_word(option).ok_or_else(|| unwritable(option))?);
        }
        let run = run.join(" ");
        let jobs = format!("--jobs {}", args.cpus);
        let out = quoted(&args.out)?;
        Ok(Self {
            folder,
            shards: format!(
                "#!/bin/sh\n#SBATCH --array=1-{shards}{throttle}\n{}{}exec {run} --no-seal {jobs} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\"\n",
                common("", "shard-%A_%a.log")?,
                begin(
                    "One shard. A lost one is run again by `sbatch --array=I` with this script."
                )?
            ),
            seal: format!(
                "#!/bin/sh\n{}{}exec {run} {jobs} --out {out}\n",
                common("-seal", "seal-%j.log")?,
                begin(
                    "The whole study: every trial is in the store, so that nothing is simulated again."
                )?
            ),
        })
    }
}

/// Returns the words that submit a script, after the job `after` where there is one.
fn words(script: &Path, after: Option<&str>) -> Vec<String> {
    let mut words = vec!["sbatch".to_owned(), "--parsable".to_owned()];
    if let Some(job) = after {
        words.push(format!("--dependency=afterok:{job}"));
        // A job that waits for what cannot come would wait for good.
        words.push("--kill-on-invalid-dep=yes".to_owned());
    }
    words.push(script.display().to_string());
    words
}

/// Submits a job and returns its number.
fn sbatch(words: &[String]) -> Result<String, Failure> {
    let output = Command::new(&words[0]).args(&words[1..]).output().map_err(|e| {
        Failure::failed(format!(
            "cannot start `sbatch`: {}; run this where Slurm's commands are, or see what it would do with --dry-run",
            reason(&e)
        ))
    })?;
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if !output.status.success() {
        return Err(Failure::failed(format!(
            "`{}` was refused: {}",
            words.join(" "),
            said(&output.stderr).replace('\n', "; ")
        )));
    }
    // JOB, or JOB;CLUSTER.
    let answer = said(&output.stdout);
    let job = answer.split(';').next().unwrap_or_default().to_owned();
    if job.is_empty() || !job.bytes().all(|b| b.is_ascii_digit()) {
        return Err(Failure::failed(format!(
            "`{}`: expected the number of a job, found `{answer}`",
            words.join(" ")
        )));
    }
    Ok(job)
}

/// Returns `path` as a word of a shell's line.
fn quoted(path: &Path) -> Result<String, Failure> {
    let text = path.to_str().and_then(shell_word);
    text.ok_or_else(|| unwritable(&path.display().to_string()))
}

fn unwritable(text: &str) -> Failure {
    Failure::not_understood(format!(
        "expected a text that a line of a script can hold, found `{}`",
        text.escape_debug()
    ))
}

/// Returns `words` as a shell's line.
fn line(words: &[String]) -> Result<String, Failure> {
    let quoted = words.iter().map(|word| shell_word(word).ok_or_else(|| unwritable(word)));
    Ok(quoted.collect::<Result<Vec<_>, _>>()?.join(" "))
}
