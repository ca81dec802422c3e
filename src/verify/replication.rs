//! Level 6: the whole study again with fresh seeds. Do the verdicts hold?
//!
//! Levels 0 to 5 ask whether a bundle is what it says; this one asks whether what it says is luck. A claim that turns from
//! supported to contradicted, or back, breaks the level: where the sealed verdict is right, chance does that with a
//! probability of at most the claim's alpha. Anything less (a claim that is open in one run and decided in the other) is what
//! two honest runs of limited power do, and is noted with both numbers.

use super::closeness::{self, Closeness};
use super::{Replanned, Severity};
use crate::bundle::{Bundle, BundleContent, BundlePath, Fault, FileRef, format};
use crate::claims::verdict::EffectSize;
use crate::claims::{ClaimVerdict, Judgement};
use serde::Serialize;

/// The claims file, relative to `results/`.
const CLAIMS: &str = "claims.json";

/// What the study says when it is run again with another seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct Replication {
    /// The reviewer's seed, in place of the experiment's.
    pub seed: u64,
    /// Every claim, in the manifest's order.
    pub claims: Vec<ClaimAgain>,
    /// How near the fresh numbers lie to the sealed ones.
    pub closeness: Closeness,
}

/// A claim judged twice.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct ClaimAgain {
    /// Its id.
    pub id: String,
    /// The verdict in the bundle.
    pub sealed: Judgement,
    /// The numbers behind it.
    pub sealed_numbers: String,
    /// The verdict of the fresh run; none where it does not judge the claim.
    pub fresh: Option<Judgement>,
    /// The numbers behind that.
    pub fresh_numbers: String,
    /// The two beside each other.
    pub standing: VerdictStanding,
}

/// A fresh verdict beside the sealed one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictStanding {
    /// The same.
    Holds,
    /// Decided in the bundle, not in the fresh run.
    Weaker,
    /// Decided in the fresh run, not in the bundle.
    Stronger,
    /// Neither decides it, for different reasons.
    Open,
    /// The opposite.
    Flipped,
}

impl VerdictStanding {
    /// Holds a fresh verdict, if there is one, against the sealed one.
    fn of(sealed: Judgement, fresh: Option<Judgement>) -> Self {
        let is_decided =
            |verdict| matches!(verdict, Judgement::Supported | Judgement::Contradicted);
        match (is_decided(sealed), fresh.is_some_and(is_decided)) {
            _ if Some(sealed) == fresh => Self::Holds,
            (true, true) => Self::Flipped,
            (true, false) => Self::Weaker,
            (false, true) => Self::Stronger,
            (false, false) => Self::Open,
        }
    }
}

impl Replication {
    /// Says what it means: one line for the whole, one a claim, one for the numbers.
    pub fn in_words(&self) -> String {
        let count = |standing| self.claims.iter().filter(|c| c.standing == standing).count();
        let mut text = format!("run again with the experiment's seed {}: ", self.seed);
        if self.claims.is_empty() {
            text.push_str("the study makes no claim, so there is no verdict to replicate\n");
        } else {
            let named = [
                (VerdictStanding::Holds, "have the same verdict"),
                (VerdictStanding::Weaker, "are no longer decided"),
                (VerdictStanding::Stronger, "are decided only now"),
                (VerdictStanding::Open, "stay open for another reason"),
                (VerdictStanding::Flipped, "have the opposite verdict"),
            ];
            let parts: Vec<String> = named
                .into_iter()
                .filter(|(standing, _)| count(*standing) > 0)
                .map(|(standing, words)| format!("{} {words}", count(standing)))
                .collect();
            text.push_str(&format!("of {} claims {}\n", self.claims.len(), parts.join(", ")));
        }
        for claim in &self.claims {
            text.push_str(&format!(
                "  {}: {} ({}), now {} ({})\n",
                claim.id,
                claim.sealed,
                claim.sealed_numbers,
                word(claim.fresh),
                claim.fresh_numbers
            ));
        }
        text + &self.closeness.in_words()
    }
}

/// Runs the study again with `seed` and holds its verdicts against the bundle's.
pub(super) fn check(
    bundle: &Bundle,
    replanned: &dyn Replanned,
    seed: u64,
) -> (Option<Replication>, Vec<(Severity, Fault)>) {
    let resolved = BundlePath::payload(format::RESOLVED);
    let claims = BundlePath::result(CLAIMS);
    let obstacle = |fault: Fault| (None, vec![(Severity::Obstacle, fault)]);
    if bundle.is_partial() {
        let fault = Fault::new(resolved, "a whole study", "part of one")
            .hint("no claim is judged on a part, so there is no verdict to replicate");
        return obstacle(fault);
    }
    if bundle.resolved().seed.read().ok() == Some(seed) {
        let fault =
            Fault::new(resolved, "a seed that the study was not run with", seed.to_string()).hint(
                "the same seed gives the same trials; choose another `--sample-seed`, or none",
            );
        return obstacle(fault);
    }
    let fresh = match replanned.replicate(seed) {
        Ok(fresh) => fresh,
        Err(problem) => {
            let expected = "a study that can be run with another seed";
            let path = BundlePath::payload(format::STUDY);
            return obstacle(Fault::new(path, expected, problem.to_string()));
        }
    };
    let pair = |path: &str| (text(result_in(bundle, path)), text(result_of(&fresh, path)));
    let (sealed, again) = pair(CLAIMS);
    let (sealed_trials, fresh_trials) = pair("trials.csv");
    let replication = Replication {
        seed,
        claims: judged_twice(&sealed, &again),
        closeness: closeness::of(&sealed_trials, &fresh_trials),
    };
    let mut findings = Vec::new();
    let failed: usize = fresh.conditions.iter().map(|condition| condition.failed).sum();
    if failed > 0 {
        let fault =
            Fault::new(&resolved, "fresh trials that all run", format!("{failed} that failed"))
                .hint("their verdicts cannot be told; please report it with the seed");
        findings.push((Severity::Obstacle, fault));
    }
    if replication.claims.is_empty() {
        let fault = Fault::new(&claims, "claims to judge again", "none")
            .hint("the fresh numbers are compared with the sealed ones, which decides nothing");
        findings.push((Severity::Obstacle, fault));
    }
    for claim in &replication.claims {
        findings.extend(finding(claim, &claims));
    }
    (Some(replication), findings)
}

/// Names a fresh verdict.
fn word(fresh: Option<Judgement>) -> String {
    fresh.map_or_else(|| "no verdict".to_owned(), |judgement| judgement.to_string())
}

fn finding(claim: &ClaimAgain, path: &str) -> Option<(Severity, Fault)> {
    let ClaimAgain { id, sealed, sealed_numbers, fresh, fresh_numbers, standing } = claim;
    let (severity, hint) = match standing {
        VerdictStanding::Holds => return None,
        VerdictStanding::Flipped => (
            Severity::Error,
            "where the sealed verdict is right, chance does this in at most alpha of all runs: another `--sample-seed` tells",
        ),
        VerdictStanding::Weaker => (
            Severity::Note,
            "not the opposite: the number of trials decides it in some runs and not in others",
        ),
        VerdictStanding::Stronger | VerdictStanding::Open => (Severity::Note, ""),
    };
    let fault = Fault::new(
        path,
        format!("`{id}` {sealed} again ({sealed_numbers})"),
        format!("{} ({fresh_numbers})", word(*fresh)),
    );
    Some((severity, fault.hint(hint)))
}

/// Holds the claims of two `claims.json` against each other, in the order of the first. Level 3 has shown that the sealed
/// one is ours.
fn judged_twice(sealed: &str, fresh: &str) -> Vec<ClaimAgain> {
    let list = |text: &str| serde_json::from_str::<Vec<ClaimVerdict>>(text).unwrap_or_default();
    let fresh = list(fresh);
    let twice = |sealed: ClaimVerdict| {
        let fresh = fresh.iter().find(|claim| claim.id == sealed.id);
        let judgement = fresh.map(|claim| claim.judgement);
        ClaimAgain {
            standing: VerdictStanding::of(sealed.judgement, judgement),
            sealed: sealed.judgement,
            sealed_numbers: numbers(&sealed),
            fresh: judgement,
            fresh_numbers: fresh.map_or_else(|| NO_REASON.to_owned(), numbers),
            id: sealed.id,
        }
    };
    list(sealed).into_iter().map(twice).collect()
}

const NO_REASON: &str = "no reason given";

/// Returns the reason of a verdict, and the size of what was found where one comparison decides it.
fn numbers(verdict: &ClaimVerdict) -> String {
    let reason = if verdict.reason.is_empty() { NO_REASON } else { &verdict.reason };
    let effect = match &verdict.comparisons[..] {
        [only] => only.effect.as_ref(),
        _ => None,
    };
    let of = |effect: &EffectSize| {
        let EffectSize { name, value, low, high, .. } = effect;
        format!(", {name} {value:.3} within {low:.3} to {high:.3}")
    };
    reason.to_owned() + &effect.map(of).unwrap_or_default()
}

fn result_of<'a>(content: &'a BundleContent, path: &str) -> Option<FileRef<'a>> {
    let held = content.results.iter().map(|(name, bytes)| (name, FileRef::Held(bytes)));
    let large = content.large_results.iter().map(|(name, file)| (name, FileRef::Large(file)));
    held.chain(large).find(|(name, _)| *name == path).map(|(_, file)| file)
}

/// Most bytes of a table that is compared number by number.
const MOST_TABLE: u64 = 256 << 20;

fn result_in<'a>(bundle: &'a Bundle, path: &str) -> Option<FileRef<'a>> {
    bundle.result_files().find(|(name, _)| *name == path).map(|(_, file)| file)
}

fn text(file: Option<FileRef<'_>>) -> String {
    let bytes = file.and_then(|file| file.whole(MOST_TABLE)).unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::VerdictStanding::{Flipped, Holds, Open, Stronger, Weaker};
    use super::*;
    use serde_json::{Value, json};

    fn claim(id: &str, verdict: &str, p: f64) -> Value {
        json!({
            "id": id,
            "verdict": verdict,
            "reason": format!("p {p} at alpha 0.05 by welch"),
            "comparisons": [{"verdict": verdict, "effect": {"name": "difference", "value": p, "low": -1.5, "high": null}}],
        })
    }

    #[test]
    fn only_the_opposite_verdict_breaks() {
        let verdicts = [
            ("A", "supported", "supported"),
            ("B", "supported", "contradicted"),
            ("C", "contradicted", "supported"),
            ("D", "supported", "inconclusive"),
            ("E", "inconclusive", "supported"),
            ("F", "cannot-be-tested", "inconclusive"),
        ];
        let sealed: Vec<_> =
            verdicts.iter().map(|(id, sealed, _)| claim(id, sealed, 0.01)).collect();
        let fresh: Vec<_> = verdicts.iter().map(|(id, _, fresh)| claim(id, fresh, 0.02)).collect();
        let claims = judged_twice(&json!(sealed).to_string(), &json!(fresh).to_string());
        let standings: Vec<_> = claims.iter().map(|claim| claim.standing).collect();
        assert_eq!(standings, [Holds, Flipped, Flipped, Weaker, Stronger, Open]);
        let findings: Vec<_> = claims.iter().filter_map(|claim| finding(claim, "p")).collect();
        let errors = findings.iter().filter(|(severity, _)| *severity == Severity::Error).count();
        assert_eq!((findings.len(), errors), (5, 2));
        assert_eq!(
            findings[0].1.to_string(),
            "p: expected `B` supported again (p 0.01 at alpha 0.05 by welch, difference 0.010 within -1.500 to NaN), found \
             contradicted (p 0.02 at alpha 0.05 by welch, difference 0.020 within -1.500 to NaN) (where the sealed verdict \
             is right, chance does this in at most alpha of all runs: another `--sample-seed` tells)"
        );
        let replication = Replication { seed: 9, claims, closeness: closeness::of("", "") };
        assert!(
            replication.in_words().starts_with(
                "run again with the experiment's seed 9: of 6 claims 1 have the same verdict, 1 are no longer decided, 1 are \
                 decided only now, 1 stay open for another reason, 2 have the opposite verdict\n  A: supported (p 0.01 at \
                 alpha 0.05 by welch, difference 0.010 within -1.500 to NaN), now supported (p 0.02"
            ),
            "{}",
            replication.in_words()
        );
    }
}
