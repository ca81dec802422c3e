//! The artifact appendix that committees ask for, of one bundle: for people as Markdown, for a paper as LaTeX.
//!
//! Its parts are those of the appendix that ACM's conferences hand out ("Artifact Appendix": abstract, check-list, description,
//! installation, workflow, evaluation and expected results, customisation); what it says is what the bundle's page says.

mod markdown;
mod tex;

use super::finding::finding;
use super::origin;
use super::{Command, Evaluation, ReportContent};
use crate::bundle::format;

/// What an appendix knows beside the bundle's page.
#[derive(Debug, Clone, Copy)]
pub struct Packed<'a> {
    /// The bundle's file name.
    pub file: &'a str,
    /// Bytes of its files, unpacked.
    pub bytes: u64,
}

/// A part of the appendix.
struct Part {
    title: &'static str,
    blocks: Vec<Block>,
}

/// What stands in a part.
enum Block {
    Text(String),
    List(Vec<String>),
    /// A name and what is to be said of it, a row each.
    Facts(Vec<(&'static str, String)>),
    /// Commands to be typed, with purpose and time.
    Commands(Vec<Command>),
    /// Head and rows of a table.
    Table(Vec<&'static str>, Vec<Vec<String>>),
}

/// Returns the appendix: the names of its files and their text.
pub fn appendix(content: &ReportContent, packed: Packed<'_>) -> [(&'static str, String); 2] {
    let title = format!("Artifact appendix: {}", content.title);
    let parts = parts(content, packed);
    [
        ("artifact-appendix.md", markdown::written(&title, &parts)),
        ("artifact-appendix.tex", tex::written(&title, &parts)),
    ]
}

fn parts(content: &ReportContent, packed: Packed<'_>) -> Vec<Part> {
    let of = |title, blocks| Part { title, blocks };
    let Evaluation { basis, badges } = &content.evaluation;
    let mut evaluated = vec![Block::Text(basis.clone())];
    for badge in badges {
        evaluated.push(Block::Text(format!("{}: {}", badge.name, badge.asks)));
        evaluated.push(Block::List(badge.checks.clone()));
        evaluated.push(Block::Commands(badge.commands.clone()));
    }
    vec![
        of("Abstract", vec![Block::Text(summary(content))]),
        of("Check-list", vec![Block::Facts(check_list(content, packed))]),
        of("How to get it, and what it needs", access(content, packed)),
        of("Evaluation, badge by badge", evaluated),
        of("Expected results", expected(content)),
        of("What the numbers do not show", vec![Block::List(content.limits.clone())]),
        of("To go on from it", customisation(packed)),
    ]
}

fn summary(content: &ReportContent) -> String {
    let cited = match (&*content.citation.paper, &*content.citation.section) {
        ("", _) => String::new(),
        (paper, "") => format!(" It re-enacts {}.", paper.trim_end_matches('.')),
        (paper, section) => format!(" It re-enacts {}, {section}.", paper.trim_end_matches('.')),
    };
    let headline = &content.headline;
    let made = format!(
        "The artifact is one bundle: a manifest with the robots, worlds and maps that it names, the records of {} in {}, and every \
         table, figure and verdict that follows from them, under one checksum.{cited} It was made by {}, which executes any of \
         the trials again, to the same bytes on any machine.",
        counted(headline.trials, "trial"),
        counted(headline.conditions, "condition"),
        program(content),
    );
    format!("{made} {}", finding(content))
}

/// Returns what sealed the bundle, with its version where that is told.
fn program(content: &ReportContent) -> &str {
    let sealed = content.provenance.facts.iter().find(|(name, _)| name == origin::SEALED_BY);
    sealed.map_or("reenact", |(_, program)| program)
}

fn check_list(content: &ReportContent, packed: Packed<'_>) -> Vec<(&'static str, String)> {
    let headline = &content.headline;
    let inputs = content.provenance.inputs.len();
    let mut facts = vec![
        (
            "Program",
            format!(
                "{}, engine version {} ({})",
                program(content),
                headline.engine_version,
                format::HOME
            ),
        ),
        ("Data", format!("{}, sealed in the bundle", counted(inputs as u64, "input file"))),
        (
            "Run-time environment",
            "none beside the program: no ROS, no simulator, no container, no network".to_owned(),
        ),
        ("Hardware", "any x86-64 or 64-bit ARM machine; no GPU".to_owned()),
        (
            "Experiment",
            format!(
                "{} in {}, {:.0} h of simulated time, seed {}",
                counted(headline.trials, "trial"),
                counted(headline.conditions, "condition"),
                headline.sim_seconds / 3600.0,
                headline.seed
            ),
        ),
        (
            "Output",
            format!(
                "{}, {}, {} judged",
                counted(content.tables.len() as u64, "table"),
                counted(content.figures.len() as u64, "figure"),
                counted(content.claims.len() as u64, "claim")
            ),
        ),
        ("Disk space", format!("{:.1} MB unpacked", bytes_in_mb(packed.bytes))),
        ("Results digest", format!("sha256:{}", headline.results_digest)),
    ];
    if !headline.bundle_id.is_empty() {
        facts.push(("Bundle id", format!("sha256:{}", headline.bundle_id)));
    }
    facts.push(("Licence", content.license.clone()));
    facts.push((
        "Archived at",
        "(to be filled in: the identifier that an archive gave it)".to_owned(),
    ));
    facts
}

#[expect(clippy::cast_precision_loss, reason = "shown with one decimal")]
fn bytes_in_mb(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

fn access(content: &ReportContent, packed: Packed<'_>) -> Vec<Block> {
    let command = |purpose: &str, line: String, time: &str| Command {
        purpose: purpose.to_owned(),
        line,
        time: time.to_owned(),
    };
    vec![
        Block::Text(format!(
            "The bundle is `{}`. Without any program of ours it opens as a zip: `index.html` says what was found, `README.md` how to \
             go on, and `sha256sum` or any BagIt tool checks every file.",
            packed.file
        )),
        Block::Commands(vec![
            command(
                &format!(
                    "install the program: in a checkout of the source of {} (Rust is all it takes)",
                    program(content)
                ),
                format::INSTALL.to_owned(),
                "some minutes",
            ),
            command(
                "smoke test: check every file, and derive every table, figure and verdict anew",
                format!("reenact verify {}", packed.file),
                "seconds",
            ),
        ]),
        Block::Text(format!(
            "It ends with the results digest `sha256:{}`, which is to be the one printed in the paper.",
            content.headline.results_digest
        )),
    ]
}

fn expected(content: &ReportContent) -> Vec<Block> {
    if content.claims.is_empty() {
        let text = "No claim is judged. The tables in `data/results/tables/` are what every run gives, byte for byte.";
        return vec![Block::Text(text.to_owned())];
    }
    let rows = content.claims.iter().map(|claim| {
        let said = if claim.says.is_empty() { &claim.ours } else { &claim.says };
        vec![claim.id.clone(), said.clone(), claim.verdict.replace('-', " "), claim.numbers.clone()]
    });
    vec![
        Block::Text(
            "Levels 3 to 5 give exactly these verdicts and numbers; level 6, with fresh seeds, is to give the same verdicts where it \
             says so. A claim that these results contradict is told as contradicted."
                .to_owned(),
        ),
        Block::Table(vec!["Claim", "What is claimed", "Verdict", "Numbers"], rows.collect()),
    ]
}

fn customisation(packed: Packed<'_>) -> Vec<Block> {
    let line = |purpose: &str, line: String| Command {
        purpose: purpose.to_owned(),
        line,
        time: "under a second".to_owned(),
    };
    vec![
        Block::Text(
            "Every number that the study hangs on stands in `study.yaml`, with a reason where the paper leaves it open; robots, worlds \
             and maps are files beside it, which others can replace."
                .to_owned(),
        ),
        Block::Commands(vec![
            line("unpack it, to change the manifest", format!("reenact export {} --dir --out unpacked", packed.file)),
            line("say what changed between two runs", format!("reenact diff {} other.zip", packed.file)),
        ]),
    ]
}

fn counted(n: u64, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    fn written() -> [(&'static str, String); 2] {
        let packed = Packed { file: "corridor-9f86d081.zip", bytes: 2_345_678 };
        appendix(&fixtures::content(), packed)
    }

    #[test]
    fn both_forms_say_the_same() {
        let [(_, markdown), (_, tex)] = written();
        for words in [
            "Check-list",
            "2.3 MB unpacked",
            "Artifacts Evaluated: Functional",
            "reenact verify corridor-9f86d081.zip",
            "What the numbers do not show",
            "To go on from it",
        ] {
            assert!(markdown.contains(words) && tex.contains(words), "{words}\n{markdown}\n{tex}");
        }
    }

    #[test]
    fn a_study_without_claims_says_so() {
        let content = ReportContent { claims: Vec::new(), ..fixtures::content() };
        let [(_, markdown), _] = appendix(&content, Packed { file: "a.zip", bytes: 1 });
        assert!(markdown.contains("No claim is judged."), "{markdown}");
    }

    #[test]
    fn the_whole_in_markdown() {
        insta::assert_snapshot!(written()[0].1);
    }

    #[test]
    fn the_whole_in_latex() {
        insta::assert_snapshot!(written()[1].1);
    }
}
