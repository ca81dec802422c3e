//! `README.md` and `LICENSE.txt`: what a stranger reads first.

use super::{Account, Additions, BundleContent, Circumstance, Departure, bag, format};
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
    text.push_str(&found(&content.account));
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
| `index.html` | what was found, to be opened in a browser: claims, tables, figures, limits |
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

/// Tells the finding, and what the numbers cannot show.
fn found(account: &Account) -> String {
    let mut text = String::new();
    if !account.finding.is_empty() {
        text.push_str(&format!(
            "\n## What was found\n\n{}\n\n`index.html` has claims, tables and figures; any browser opens it.\n",
            bag::one_line(&account.finding)
        ));
    }
    if !account.limits.is_empty() {
        text.push_str("\n## What the numbers cannot show\n\n");
        for limit in &account.limits {
            text.push_str(&format!("- {}\n", bag::one_line(limit)));
        }
    }
    text
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

/// Asks the data one question, in words and in Python: how many trials of a condition succeeded, and whether a claim holds.
fn question(account: &Account) -> String {
    let Some(question) = &account.question else { return String::new() };
    // JSON's strings are Python's, and end no line.
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let words: Vec<String> =
        question.condition.iter().map(|(factor, value)| format!("{factor} {value}")).collect();
    let of = match &words[..] {
        [] => "all trials".to_owned(),
        words => format!("the trials with {}", bag::one_line(&words.join(", "))),
    };
    let claim = question.claim.as_ref().and_then(|id| account.claims.iter().find(|c| c.id == *id));
    let outcomes = question.outcomes.join(" or ");
    let mut text = format!("\nWhich share of {of} ended `{outcomes}`");
    if let Some(claim) = claim {
        let whose = if claim.is_ours { "our check" } else { "the paper's claim" };
        let (id, words) = (bag::one_line(&claim.id), bag::one_line(&claim.words));
        text.push_str(&format!(", and does {whose} {id} hold: \u{201c}{words}\u{201d}"));
    }
    let texts: Vec<String> =
        question.condition.iter().map(|(factor, _)| format!("{}: str", quoted(factor))).collect();
    text.push_str(&format!(
        "? With Python and pandas, in this folder:

```python
import pandas
trials = pandas.read_csv(\"results/trials.csv\", dtype={{{}}}, keep_default_na=False, na_values=[\"\"])
",
        texts.join(", ")
    ));
    text.push_str("asked = trials");
    for (i, (factor, value)) in question.condition.iter().enumerate() {
        let before = if i == 0 { "[" } else { " & " };
        let (factor, value) = (quoted(factor), quoted(value));
        text.push_str(&format!("{before}(trials[{factor}] == {value})"));
    }
    text.push_str(if question.condition.is_empty() { "\n" } else { "]\n" });
    let names: Vec<String> = question.outcomes.iter().map(|name| quoted(name)).collect();
    text.push_str(&format!(
        "print(asked[\"outcome\"].value_counts())
print(asked[\"outcome\"].isin([{}]).mean())
",
        names.join(", ")
    ));
    if let Some(claim) = claim {
        text.push_str(&format!(
            "claims = pandas.read_json(\"results/claims.json\", dtype=False).set_index(\"id\")
print(claims.loc[{}, [\"verdict\", \"paper-table\"]])
",
            quoted(&claim.id)
        ));
    }
    text + "```\n"
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
    let question = question(&content.account);
    format!(
        "
## Read the data
{question}
All conditions:

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

#[cfg(test)]
mod tests {
    use super::super::{sample, seal};
    use super::*;

    fn readme_of(content: &BundleContent) -> String {
        let sealed = seal(content, &sample::circumstance()).unwrap();
        String::from_utf8(sealed.tree["data/README.md"].clone()).unwrap()
    }

    #[test]
    fn it_tells_the_finding_and_asks_the_data_a_question() {
        let readme = readme_of(&sample::content());
        let found = "
## What was found

Of the paper's one claim, 1 holds here.

`index.html` has claims, tables and figures; any browser opens it.

## What the numbers cannot show

- The corridors are invented.

## Check it
";
        assert!(readme.contains(found), "{readme}");
        let question = "
## Read the data

Which share of the trials with prior none ended `explored`, and does the paper's claim P1 hold: \u{201c}A floor plan shortens the \
                        way.\u{201d}? With Python and pandas, in this folder:

```python
import pandas
trials = pandas.read_csv(\"results/trials.csv\", dtype={\"prior\": str}, keep_default_na=False, na_values=[\"\"])
asked = trials[(trials[\"prior\"] == \"none\")]
print(asked[\"outcome\"].value_counts())
print(asked[\"outcome\"].isin([\"explored\"]).mean())
claims = pandas.read_json(\"results/claims.json\", dtype=False).set_index(\"id\")
print(claims.loc[\"P1\", [\"verdict\", \"paper-table\"]])
```
";
        assert!(readme.contains(question), "{readme}");
    }

    #[test]
    fn what_a_stranger_wrote_ends_no_line_of_code() {
        let mut content = sample::content();
        let evil = "x\"\n```\nimport os";
        let question = content.account.question.as_mut().unwrap();
        question.condition = vec![("prior".into(), evil.into())];
        let readme = readme_of(&content);
        assert!(readme.contains(r#"(trials["prior"] == "x\"\n```\nimport os")"#), "{readme}");
        assert!(readme.lines().all(|line| line != "import os"), "{readme}");
    }
}
