//! An Indexed Job, and a suspended one that seals.

use super::Work;
use crate::cli::args::SubmitArgs;
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::Terminal;
use serde_json::{Value, json};

/// Most characters of a job's name: its pods are called after it, their number and five characters more, and 63 are allowed.
const LONGEST_NAME: usize = 48;

/// Times that a pod of one shard may fail before the job does; what it finished before stays.
const RETRIES: u32 = 6;

/// Prints both jobs as `kubectl apply -f -` takes them.
pub(super) fn print(work: &Work, args: &SubmitArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let (Some(image), Some(claim), true) =
        (&args.kubernetes.image, &args.kubernetes.claim, args.dry_run)
    else {
        return Err(Failure::not_understood(
            "`--engine kubernetes` needs `--dry-run`, `--image` and `--claim`: it prints what `kubectl apply -f -` takes, and \
             talks to no cluster itself",
        ));
    };
    let path = args.manifest.to_str().filter(|_| args.manifest.is_relative()).ok_or_else(|| {
        Failure::not_understood(format!(
            "expected the manifest's path relative to `{}`, where the volume is mounted, found `{}`",
            args.kubernetes.mount,
            args.manifest.display()
        ))
    })?;
    let name = format!("reenact-{}", work.name);
    if name.len() > LONGEST_NAME {
        return Err(Failure::not_understood(format!(
            "expected a job's name of at most {LONGEST_NAME} characters, found `{name}`: `--set name=SHORTER` gives another"
        )));
    }
    let mut run = vec!["reenact".to_owned(), "run".to_owned(), path.to_owned()];
    run.extend(work.options.iter().cloned());
    run.extend(["--jobs".to_owned(), args.cpus.to_string()]);
    let with = |more: &[&str]| {
        let words = run.iter().map(String::as_str).chain(more.iter().copied());
        words.map(str::to_owned).collect::<Vec<_>>()
    };
    let mut resources = json!({"cpu": args.cpus.to_string()});
    if let Some(memory) = &args.memory {
        resources["memory"] = memory.as_str().into();
    }
    let pod = |command: Vec<String>| {
        json!({
            "spec": {
                "restartPolicy": "Never",
                "containers": [{
                    "name": "reenact",
                    "image": image,
                    "command": command,
                    "workingDir": args.kubernetes.mount,
                    "env": [
                        {"name": "REENACT_STORE", "value": format!("{}/store", args.kubernetes.mount)},
                        {"name": "REENACT_SHARDS", "value": work.shards.to_string()},
                    ],
                    "resources": {"requests": resources, "limits": resources},
                    "volumeMounts": [{"name": "study", "mountPath": args.kubernetes.mount}],
                }],
                "volumes": [{"name": "study", "persistentVolumeClaim": {"claimName": claim}}],
            },
        })
    };
    let job = |name: &str, spec: Value| {
        json!({
            "apiVersion": "batch/v1",
            "kind": "Job",
            "metadata": {"name": name, "labels": {"app.kubernetes.io/name": "reenact"}},
            "spec": spec,
        })
    };
    let parallelism = args.throttle.map_or(work.shards, |most| most.get().min(work.shards));
    let shards = job(
        &name,
        json!({
            "completionMode": "Indexed",
            "completions": work.shards,
            "parallelism": parallelism,
            "backoffLimitPerIndex": RETRIES,
            "template": pod(with(&["--no-seal", "--shard", "auto"])),
        }),
    );
    let out = args.out.display().to_string();
    let seal = job(
        &format!("{name}-seal"),
        json!({
            // Kubernetes knows no job after another: whoever waited for the shards sets it going.
            "suspend": true,
            "backoffLimit": RETRIES,
            "template": pod(with(&["--out", &out])),
        }),
    );
    // A stream of two documents; JSON is YAML.
    terminal.result(&format!("{shards:#}\n---\n{seal:#}\n"));
    terminal.note(&format!(
        "note: then `kubectl wait --for=condition=complete --timeout=-1s job/{name}`, and `kubectl patch job/{name}-seal -p \
         '{{\"spec\":{{\"suspend\":false}}}}'`"
    ));
    Ok(Exit::Yes)
}
