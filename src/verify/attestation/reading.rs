//! An attestation read back: who signed it, and whether it is about this very bundle. The signature comes first: before it
//! fits, nothing of the payload is read.

use super::dsse::Envelope;
use super::statement::{self, HOLDS, Head, Note, Predicate, STATEMENT, Statement};
use crate::bundle::{Fault, Moment, visible};
use crate::json;
use crate::verify::signature::{self, Signable, Signed, Trust};
use crate::verify::{Finding, Level, Report, Severity};
use serde::Serialize;

/// What somebody whom the reader trusts attests of the bundle at hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct Attestation {
    /// Who, one or more.
    pub signed: Vec<Signed>,
    /// The keys of others who signed it, whom the reader does not trust.
    pub others: Vec<String>,
    /// The highest level that held.
    pub level: Level,
    /// When, by their word.
    pub date: String,
    /// The program that checked it.
    pub program: String,
    /// The engine that ran the study, and executed trials again.
    pub engine: String,
    /// What was executed, a line each.
    pub executed: Vec<String>,
    /// What was noticed.
    pub notes: Vec<String>,
    /// What nothing was held against.
    pub not_checked: Vec<String>,
}

impl std::fmt::Display for Attestation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { signed, level, date, program, engine, .. } = self;
        let signed: Vec<String> = signed.iter().map(ToString::to_string).collect();
        write!(
            f,
            "{}: level {level} held on {date}, by {program}, engine {engine}",
            signed.join(", and ")
        )
    }
}

impl Attestation {
    /// Says what the attestation states besides, a line each.
    pub(in crate::verify) fn in_words(&self) -> Vec<String> {
        let others = self
            .others
            .iter()
            .map(|key| format!("said to be signed with the key {key} too, which you do not trust"));
        let unchecked = self.not_checked.iter().map(|what| format!("not checked: {what}"));
        let all = self.executed.iter().cloned().chain(self.notes.iter().cloned());
        all.chain(unchecked).chain(others).map(|line| format!("attested: {line}")).collect()
    }
}

impl Report {
    /// Holds the attestation in the file called `name` against the bundle that was checked, and notes what came of it.
    pub fn hold_against(&mut self, (name, bytes): (&str, &[u8]), trust: &Trust, now: Moment) {
        let attestation = read(name, bytes, trust, now)
            .and_then(|(signed, others, said)| self.about_this(name, signed, others, said));
        self.attestation = Some(attestation);
    }

    /// Checks that what was `said` is about this bundle.
    fn about_this(
        &self,
        name: &str,
        signed: Vec<Signed>,
        others: Vec<String>,
        said: Statement,
    ) -> Result<Attestation, Fault> {
        let fault = |expected: String, found: String| Err(Fault::new(name, expected, found));
        let (Some(id), Some(results)) = (self.bundle_id, self.results_digest) else {
            return fault(
                "a bag to hold it against".to_owned(),
                "none that can be read".to_owned(),
            );
        };
        // Only then the bundle's id stands for all of its bytes.
        if self.reached < Some(Level::Fixity) {
            return fault(
                "a bundle whose files are those of its lists".to_owned(),
                "one that does not hold to level 1 (fixity)".to_owned(),
            );
        }
        let ours = format!("sha256:{id}");
        let [subject] = &said.subject[..] else {
            return fault(
                "one subject, the bundle".to_owned(),
                format!("{} subjects", said.subject.len()),
            );
        };
        let subject = format!("sha256:{}", subject.digest.sha256);
        for theirs in [&subject, &said.predicate.bundle_id] {
            if *theirs != ours {
                let fault = Fault::new(name, format!("the bundle {ours}"), theirs.as_str());
                return Err(fault.hint("it attests another bundle"));
            }
        }
        let results = format!("sha256:{results}");
        if said.predicate.results_digest != results {
            return fault(format!("the results {results}"), said.predicate.results_digest);
        }
        said.predicate.attestation(name, signed, others)
    }
}

impl Predicate {
    /// Returns what the predicate comes to, where it is in keeping with itself.
    fn attestation(
        self,
        name: &str,
        signed: Vec<Signed>,
        others: Vec<String>,
    ) -> Result<Attestation, Fault> {
        let fault = |expected: String, found: String| Err(Fault::new(name, expected, found));
        if self.verdict != HOLDS {
            return fault(format!("the verdict `{HOLDS}`"), format!("`{}`", self.verdict));
        }
        let level = match Level::from_number(self.level) {
            Some(level) if level.name() == self.level_name => level,
            _ => {
                let found = format!("level {} ({})", self.level, self.level_name);
                return fault("a level from 0 to 6 and its name".to_owned(), found);
            }
        };
        let passed: Vec<_> = self.levels.iter().map(|l| (l.level, l.state.as_str())).collect();
        let all: Vec<_> = (0..=u64::from(self.level)).map(|level| (level, "passed")).collect();
        if passed != all {
            let states: Vec<String> =
                passed.iter().map(|(level, state)| format!("{level} {state}")).collect();
            let expected = format!("every level from 0 to {} passed", self.level);
            return fault(expected, states.join(", "));
        }
        if !statement::is_instant(&self.date) {
            let expected = "a date such as 2026-01-15T12:00:00Z".to_owned();
            return fault(expected, format!("`{}`", self.date));
        }
        let told = self.sample.map(|sample| sample.in_words);
        let told = told.into_iter().chain(self.earlier);
        let told = told.chain(self.replication.map(|replication| replication.in_words));
        let executed = told.flat_map(|text| text.lines().map(one_line).collect::<Vec<_>>());
        Ok(Attestation {
            signed,
            others,
            level,
            date: self.date,
            program: one_line(&self.program),
            engine: one_line(&self.engine),
            executed: executed.collect(),
            notes: self.notes.into_iter().map(Note::in_words).collect(),
            not_checked: self.not_checked.iter().map(|what| one_line(what)).collect(),
        })
    }
}

impl Note {
    fn in_words(self) -> String {
        let fault = Fault::new(self.path, self.expected, self.found).hint(self.hint);
        match Level::from_number(self.level) {
            Some(level) => one_line(&Finding::new(level, Severity::Note, fault).to_string()),
            None => one_line(&format!("note: {fault}")),
        }
    }
}

/// Reads who signed the attestation and what it says: the trusted signers, the keys of the others, the Statement.
fn read(
    name: &str,
    bytes: &[u8],
    trust: &Trust,
    now: Moment,
) -> Result<(Vec<Signed>, Vec<String>, Statement), Fault> {
    let envelope = Envelope::read(name, bytes)?;
    let (signed, others) = signers(name, &envelope, trust, now)?;
    let not_one = |problem: String| {
        Fault::new(name, format!("a Statement of in-toto ({STATEMENT})"), problem)
    };
    let head: Head = json::read(&envelope.payload).map_err(|e| not_one(e.to_string()))?;
    if head.kind != STATEMENT {
        return Err(not_one(format!("`{}`", head.kind)));
    }
    let ours = statement::predicate_type();
    if head.predicate_type != ours {
        let found = format!("`{}`", head.predicate_type);
        let fault = Fault::new(name, format!("a predicate of the type {ours}"), found);
        return Err(fault.hint("it says something else than how far a bundle was checked"));
    }
    let statement = json::read(&envelope.payload).map_err(|problem| {
        Fault::new(name, format!("a predicate of the type {ours}"), problem.to_string())
    })?;
    Ok((signed, others, statement))
}

/// Checks the signatures: every one must fit these bytes as far as it can be checked, whoever made it, and one at least
/// must be by a key that is trusted.
fn signers(
    name: &str,
    envelope: &Envelope,
    trust: &Trust,
    now: Moment,
) -> Result<(Vec<Signed>, Vec<String>), Fault> {
    let expected = format!("a signature by a key of `{}`", trust.name());
    let to_sign = envelope.to_sign();
    let (mut signed, mut others, mut strange) = (Vec::new(), Vec::new(), None);
    for signature in &envelope.signatures {
        match signature::signer(trust, &signature.file, &to_sign, now, Signable::Attestation) {
            Ok(signer) if signed.contains(&signer) => {}
            Ok(signer) => signed.push(signer),
            Err(refusal) if refusal.stranger.is_some() => {
                others.extend(refusal.stranger.clone());
                strange = strange.or(Some(refusal));
            }
            Err(refusal) => {
                return Err(Fault::new(name, expected, refusal.found).hint(refusal.hint));
            }
        }
    }
    match strange {
        _ if !signed.is_empty() => Ok((signed, others)),
        Some(refusal) => Err(Fault::new(name, expected, refusal.found).hint(refusal.hint)),
        None => Err(Fault::new(name, expected, "none")
            .hint("sign it as docs/verification.md says; `reenact attest` puts the signature in")),
    }
}

/// Writes `text` of unknown origin on one line.
fn one_line(text: &str) -> String {
    visible(text).replace('\n', " ")
}
