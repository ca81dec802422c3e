//! `README.md` and `LICENSE.txt`: what a stranger reads first. They hold no number that the results hold too.

use super::{Additions, BundleContent, Circumstance, Departure, format};
use crate::digest::ResultsDigest;
use crate::table::{Column, Kind};
use std::collections::BTreeSet;

/// Writes how to check the bundle and run it again.
pub(super) fn readme(
    content: &BundleContent,
    circumstance: &Circumstance,
    digest: ResultsDigest,
    additions: Additions<'_>,
) -> String {
    let (version, engine) = (&circumstance.version, &content.engine);
    let install = format::INSTALL;
    let stem = format!("{}-{}", content.name, digest.short());
    let mut later = String::new();
    let mut text = format!("# {}\n\n{}\n", content.title, content.description);
    if content.partial {
        text.push_str("\n**Partial**: only some of the study's trials were run; no claim is judged on them.\n");
    }
    if let Some(cite) = &content.cite {
        text.push_str(&format!("\nReproduces: {}", cite.text));
        if let Some(url) = &cite.url {
            text.push_str(&format!(" <{url}>"));
        }
        text.push('\n');
    }
    let again = again(content);
    text.push_str(&format!(
        "
## Check it

With this folder's parent as the working directory and nothing of ours:

```
sha256sum --check manifest-sha256.txt tagmanifest-sha256.txt
bagit.py --validate .
```

With Reenact {version} (engine {engine}), which also derives every table from the trial records and runs trials again. It is
installed from the root of a checkout of that version's source:

```
{install}
```

Then, in the folder where the bundle lies:

```
reenact verify {stem}.zip                # levels 0 to 3: seconds
reenact verify {stem}.zip --level 5      # every trial again, bit for bit
```

Results digest: `sha256:{digest}`.
Checksums show that nothing changed since they were made; who made them, only a signature shows.

{again}
## What is in it

| path | holds |
| --- | --- |
| `study.yaml` | the manifest, byte for byte as its author wrote it |
| `study.resolved.json` | the same with every default and override written out, and the digest of every input |
| `inputs/` | robots, worlds, prior maps and whatever else the manifest names |
| `trials/` | one line of JSON a trial, one file a condition, in plan order |
| `results/` | tables, figures and verdicts, all derived from `trials/` |
| `ro-crate-metadata.json` | the same for machines: RO-Crate 1.1, Provenance Run Crate 0.5 |
"
    ));
    text.push_str(
        "| `data-dictionary.md` | every column of every CSV file: unit, range, meaning, when it is empty |
| `datapackage.json` | the same for programs: Frictionless Data Package with Table Schema |
| `CITATION.cff`, `.zenodo.json` | how to cite this bundle; what Zenodo asks of a deposit |
",
    );
    if !circumstance.files.is_empty() {
        text.push_str(
            "| `circumstances/` | wall times on the machine of the run and verdicts on them: not part of the results |\n",
        );
    }
    if let Some(capsule) = additions.source {
        text.push_str(&format!(
            "| `{engine_folder}` | the source of Reenact {version} with its lock file: data, which no check unpacks or runs |
",
            engine_folder = format::ENGINE,
        ));
        later = format!(
            "
## In ten years

Where no checkout of that version can be had, `{path}` holds its source. Unpack it in this folder, read it, and
build it:

```
unzip {path}
cargo install --path reenact-{version} --locked
```

The crates that it needs are named in its `Cargo.lock`, each with its digest; they are not in here.
",
            path = capsule.path
        );
    }
    text.push_str(&reading(content));
    text + &later
}

/// Returns the command that gives the results digest again, wherever the bundle is unpacked.
fn again(content: &BundleContent) -> String {
    let departure = Departure::of(&content.resolved, content.partial);
    let mut text = "## Run it again\n\n".to_owned();
    if let Some(words) = departure.in_words() {
        // Whatever could end the quotation stays where it is data.
        let told = if words.contains('`') {
            "`study.resolved.json` tells what was set and which part was run.".to_owned()
        } else {
            format!("How it was run: `{words}`.")
        };
        text.push_str(&format!("This is not `study.yaml` as it stands. {told}\n\n"));
    }
    match departure.command() {
        Some(command) => text.push_str(&format!(
            "Whoever runs this in this folder, with the same engine, gets the same results digest:

```
{command} --out ../../again
```

Inputs are then those in `inputs/`, whatever paths the manifest names them by; the new bundle lands outside of this one.
"
        )),
        None => text.push_str(
            "What was set on the command line cannot stand on a line; it is under `study`, `overrides` in `study.resolved.json`.
`reenact run study.yaml --out ../../again` in this folder, with a `--set` for each, gives the same results digest.
",
        ),
    }
    text
}

/// Writes three lines that read the trials with what people analyse data with; nothing where there are no trials to
/// read.
fn reading(content: &BundleContent) -> String {
    let Some(trials) = content.tables.iter().find(|table| table.path == "results/trials.csv")
    else {
        return String::new();
    };
    let is_factor = |column: &&Column| column.among.len() > 1 && column.name != "outcome";
    let names = |columns: Vec<&Column>| -> Vec<String> {
        columns.iter().map(|column| format!("\"{}\"", column.name)).collect()
    };
    let mut by = names(trials.columns.iter().filter(is_factor).collect());
    // More make a long print.
    by.drain(..by.len().saturating_sub(2));
    if by.is_empty() {
        by.push("\"outcome\"".to_owned());
    }
    let measured = |column: &&Column| column.kind == Kind::Number && column.among.is_empty();
    let usual = trials.columns.iter().find(|column| column.name == "time-s");
    let Some(measure) = usual.or_else(|| trials.columns.iter().find(measured)) else {
        return String::new();
    };
    let (measure, by) = (&measure.name, by.join(", "));
    format!(
        "
## Read the data

In this folder. With Python and pandas:

```python
import pandas
trials = pandas.read_csv(\"results/trials.csv\")
print(trials.groupby([{by}])[\"{measure}\"].agg([\"count\", \"mean\", \"std\"]))
```

With R, nothing to install:

```r
trials <- read.csv(\"results/trials.csv\", check.names = FALSE)
by <- trials[c({by})]
print(aggregate(trials[\"{measure}\"], by, function(x) c(n = sum(!is.na(x)), mean = mean(x, na.rm = TRUE), sd = sd(x, na.rm = TRUE))))
```
"
    )
}

/// Writes which licences hold for what.
pub(super) fn license(content: &BundleContent) -> String {
    let mut text = format!("This bundle is licensed under {}.\n", with_address(&content.license));
    let own: BTreeSet<_> = content
        .inputs
        .iter()
        .filter_map(|input| Some((input.name.as_str(), input.license.as_deref()?)))
        .collect();
    if !own.is_empty() {
        text.push_str("\nFiles that came from elsewhere keep their own licences:\n\n");
        for (name, license) in own {
            text.push_str(&format!("{}{name}: {}\n", format::INPUTS, with_address(license)));
        }
    }
    text
}

fn with_address(license: &str) -> String {
    match license_address(license) {
        Some(address) if address != license => format!("{license} <{address}>"),
        _ => license.to_owned(),
    }
}

/// Returns where the text of `license` is: an SPDX identifier's page, or the address itself.
pub(super) fn license_address(license: &str) -> Option<String> {
    if license.starts_with("https://") || license.starts_with("http://") {
        return Some(license.to_owned());
    }
    let spdx = !license.is_empty()
        && license.bytes().all(|b| b.is_ascii_alphanumeric() || b"-.+".contains(&b));
    spdx.then(|| format!("https://spdx.org/licenses/{license}"))
}
