//! One bundle, from being opened to being played: requests, and what answers them.

use crate::study;
use reenact::bundle::{Archive, Bundle, Fault, Limits, Moment, Source as Bytes, archive};
use reenact::document::{Source, reports};
use reenact::plan::{ENGINE_VERSION, Plan, Selection};
use reenact::report::{self, Played, Sensing, page_under_banner, replay_page};
use reenact::runner::RunError;
use reenact::studies::{TrialRecord, recording::Recording};
use reenact::verify::{
    Brief, Errand, Executed, Level, Options, Reenactment, ReplanError, Reviewer, Trust, Vouching,
    climb_and_keep, plan_of,
};
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;

/// What may be asked.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Request {
    /// Which program this is.
    Version,
    /// Takes the bytes as the bundle.
    Open,
    /// Takes the bytes as keys that may vouch for the bundle, by the name of their file.
    Trust { name: String },
    /// Takes the bytes as a signature that lies beside the bundle.
    Signature { name: String },
    /// Climbs to a level: with what has been executed for it, and executing here what has not.
    Climb { level: u8, sample: usize, seed: String, now: u64 },
    /// Makes the errand of a climb, and says how many trials it has.
    Errand { level: u8, sample: usize, seed: String },
    /// Executes one of them; the answer's bytes are the line of its record.
    Execute { number: usize },
    /// Takes the bytes as lines of records that were executed for the climb.
    Executed,
    /// Makes the report.
    Report { unchecked: bool },
    /// Lists the trials.
    Trials,
    /// Plays one trial, or two beside each other.
    Replay { trials: Vec<String>, unchecked: bool },
    /// Runs a manifest with the files given, and says what came out.
    Run(study::Asked),
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
enum Refusal {
    #[error("the request is not understood: {0}")]
    Request(#[from] serde_json::Error),
    #[error("the request has no {0} bytes for its header")]
    Short(usize),
    #[error("there is no bundle yet")]
    NoBundle,
    #[error("the bundle cannot be read, so there is nothing to show of it")]
    Unread,
    #[error("the bundle is not what it says: {0}")]
    Refused(String),
    #[error("`{0}` is no level from 0 to 5")]
    NoLevel(u8),
    #[error("`{0}` is no seed")]
    NoSeed(String),
    #[error("there is no trial {0} to execute")]
    NoTrial(usize),
    #[error("`{0}`: expected text in UTF-8")]
    NoText(String),
    #[error("a record that was executed cannot be read: {0}")]
    Record(String),
    #[error("{0}")]
    Keys(String),
    #[error(transparent)]
    Replan(#[from] ReplanError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error("{0}")]
    Fault(Fault),
    #[error("{0}")]
    Other(String),
}

/// A signature and the name of its file.
type Named = (String, Vec<u8>);

/// What is known of one bundle.
pub(crate) struct Session {
    /// Is told the states of the levels, as JSON.
    judged: &'static dyn Fn(&str),
    clock: &'static dyn Fn() -> f64,
    bytes: Option<(Arc<dyn Bytes>, u64)>,
    trust: Option<Trust>,
    signature: Option<Named>,
    executed: Executed,
    errand: Option<Errand>,
    /// What the last climb found, and the bundle where it can be read.
    checked: Option<(Brief, Option<Bundle>)>,
}

impl Session {
    /// Begins with no bundle.
    pub(crate) fn begin(judged: &'static dyn Fn(&str), clock: &'static dyn Fn() -> f64) -> Self {
        Self {
            judged,
            clock,
            bytes: None,
            trust: None,
            signature: None,
            executed: Executed::default(),
            errand: None,
            checked: None,
        }
    }

    /// Answers a request: both are the number of bytes of JSON, the JSON, and further bytes.
    pub(crate) fn answer(&mut self, request: &[u8]) -> Vec<u8> {
        let (value, bytes) = match read(request).and_then(|(asked, body)| self.do_it(asked, body)) {
            Ok(answer) => answer,
            Err(refusal) => (json!({"error": refusal.to_string()}), Vec::new()),
        };
        let header = value.to_string();
        let length = u32::try_from(header.len()).unwrap_or(u32::MAX);
        [&length.to_le_bytes()[..], header.as_bytes(), &bytes].concat()
    }

    fn do_it(&mut self, request: Request, body: &[u8]) -> Result<(Value, Vec<u8>), Refusal> {
        let alone = |value: Value| Ok((value, Vec::new()));
        match request {
            Request::Version => alone(
                json!({"version": reenact::bundle::format::VERSION, "engine": ENGINE_VERSION}),
            ),
            Request::Open => {
                let length = body.len() as u64;
                *self = Self {
                    bytes: Some((Arc::new(body.to_vec()), length)),
                    trust: self.trust.take(),
                    signature: self.signature.take(),
                    ..Self::begin(self.judged, self.clock)
                };
                alone(json!({"bytes": length}))
            }
            Request::Trust { name } => {
                let text = String::from_utf8(body.to_vec());
                let text = text.map_err(|_| Refusal::NoText(name.clone()))?;
                let trust = Trust::read(&Source::new(name, text));
                self.trust = Some(
                    trust.map_err(|faults| Refusal::Keys(reports(&faults, false).join("\n")))?,
                );
                alone(json!({}))
            }
            Request::Signature { name } => {
                self.signature = Some((name, body.to_vec()));
                alone(json!({}))
            }
            Request::Climb { level, sample, seed, now } => {
                let options = options(level, sample, &seed)?;
                alone(self.climb(&options, Moment(i64::try_from(now).unwrap_or(0)))?)
            }
            Request::Errand { level, sample, seed } => {
                let options = options(level, sample, &seed)?;
                let bundle = Bundle::open(self.archive()?.map_err(|_| Refusal::Unread)?);
                let bundle = bundle.map_err(|_| Refusal::Unread)?;
                let errand = Reenactment::new(1)?.errand(&bundle, &options)?;
                let count = errand.count();
                self.errand = Some(errand);
                alone(json!({"trials": count}))
            }
            Request::Execute { number } => {
                let record = self.errand.as_ref().and_then(|errand| errand.execute(number));
                let record = record.ok_or(Refusal::NoTrial(number))?;
                let told = json!({"sim_seconds": record.sim_seconds});
                Ok((told, record.to_line().into_bytes()))
            }
            Request::Executed => {
                let lines = str::from_utf8(body).map_err(|e| Refusal::Record(e.to_string()))?;
                for line in lines.lines() {
                    let record = TrialRecord::from_line(line);
                    self.executed.add(record.map_err(|e| Refusal::Record(e.to_string()))?);
                }
                alone(json!({"executed": self.executed.count()}))
            }
            Request::Report { unchecked } => {
                let (bundle, brief) = self.shown(unchecked)?;
                let (plan, selection) = plan_of(bundle)?;
                let content = report::content_of(bundle, &plan, &selection);
                let mut content = content.map_err(|e| Refusal::Other(e.to_string()))?;
                content.checked.clone_from(&brief.words);
                let page = under_banner(report::page(&content), brief);
                Ok((json!({"words": brief.words}), page.into_bytes()))
            }
            Request::Trials => {
                let (bundle, _) = self.shown(true)?;
                alone(trials(&plan_of(bundle)?))
            }
            Request::Replay { trials, unchecked } => {
                let (bundle, brief) = self.shown(unchecked)?;
                let (plan, _) = plan_of(bundle)?;
                let mut all = Vec::new();
                for wanted in &trials {
                    let spec = plan.find(wanted).map_err(|e| Refusal::Other(e.to_string()))?;
                    let played = report::play(bundle, &plan, spec, Sensing::Shown);
                    all.push(played.map_err(Refusal::Fault)?);
                }
                let notes: Vec<_> = all.iter().map(|played| played.note.clone()).collect();
                let shown: Vec<(String, &Recording)> = all
                    .iter()
                    .map(|Played { title, recording, .. }| (title.clone(), recording))
                    .collect();
                let page = replay_page(&plan.experiment.title, &shown, &notes);
                let told: Vec<_> = notes.iter().map(|note| json!([note.text, note.good])).collect();
                Ok((json!({"notes": told}), under_banner(page, brief).into_bytes()))
            }
            Request::Run(asked) => {
                let ran = study::run(&asked, body).map_err(Refusal::Other)?;
                alone(json!({
                    "results_digest": format!("sha256:{}", ran.results_digest),
                    "trials": ran.trials,
                    "failed": ran.failed,
                }))
            }
        }
    }

    /// Opens the archive anew: what a climb judges first.
    fn archive(&self) -> Result<Result<Archive, Vec<Fault>>, Refusal> {
        let (source, length) = self.bytes.as_ref().ok_or(Refusal::NoBundle)?;
        let opened = archive::read_from(source, *length, &Limits::default());
        opened.map_err(|error| Refusal::Other(error.to_string()))
    }

    fn climb(&mut self, options: &Options, now: Moment) -> Result<Value, Refusal> {
        let judged = |report: &reenact::verify::Report| {
            (self.judged)(&json!(report.states()).to_string());
        };
        let signature = self.signature.as_ref();
        let vouching = Vouching {
            trust: self.trust.as_ref(),
            signature: signature.map(|(name, bytes)| (name.as_str(), bytes.as_slice())),
            now,
        };
        let reviewer = Reviewer { vouching, clock: self.clock, judged: &judged };
        let pipeline = Reenactment::new(1)?.with_executed(&self.executed);
        let (report, bundle) = climb_and_keep(&reviewer, self.archive()?, options, &pipeline);
        let brief = report.in_brief();
        let answer = json!({
            "human": report.to_human(),
            "report": serde_json::from_str::<Value>(&report.to_json())?,
            "exit": report.verdict().exit_code(),
            "words": brief.words,
            "refused": brief.is_refused,
            "is_read": bundle.is_some(),
            "seconds": report.seconds,
        });
        self.checked = Some((brief, bundle));
        Ok(answer)
    }

    /// Returns the bundle, where it may be shown.
    fn shown(&self, unchecked: bool) -> Result<(&Bundle, &Brief), Refusal> {
        let (brief, bundle) = self.checked.as_ref().ok_or(Refusal::NoBundle)?;
        let bundle = bundle.as_ref().ok_or(Refusal::Unread)?;
        if brief.is_refused && !unchecked {
            return Err(Refusal::Refused(brief.words.clone()));
        }
        Ok((bundle, brief))
    }
}

/// Reads a request: what is asked, and the bytes that belong to it.
fn read(request: &[u8]) -> Result<(Request, &[u8]), Refusal> {
    let (length, rest) = request.split_first_chunk::<4>().ok_or(Refusal::Short(4))?;
    let length = u32::from_le_bytes(*length) as usize;
    let (header, body) = rest.split_at_checked(length).ok_or(Refusal::Short(length))?;
    Ok((serde_json::from_slice(header)?, body))
}

/// Returns the options of a climb. Rows of the tables of other values are as many as the command takes where nothing is said.
fn options(level: u8, sample: usize, seed: &str) -> Result<Options, Refusal> {
    let known = Level::from_number(level).filter(|level| *level <= Level::Full);
    let seed = seed.parse().map_err(|_| Refusal::NoSeed(seed.to_owned()))?;
    Ok(Options { level: known.ok_or(Refusal::NoLevel(level))?, sample, rows: None, seed })
}

fn under_banner(page: String, brief: &Brief) -> String {
    match &brief.banner {
        Some(banner) => page_under_banner(&page, banner),
        None => page,
    }
}

/// Trials of a condition that are listed.
const MOST_LISTED: usize = 1000;

/// Lists the trials by condition, with what readers see of each.
fn trials((plan, _): &(Plan, Selection)) -> Value {
    let labels = &plan.experiment.labels;
    let conditions = plan.trials.chunk_by(|a, b| a.condition == b.condition).map(|trials| {
        let condition = &trials[0].condition;
        let slug = condition.slug();
        let label = if labels.is_empty() { slug.clone() } else { labels.condition(condition) };
        let numbers: Vec<u32> = trials.iter().take(MOST_LISTED).map(|spec| spec.trial).collect();
        json!({"slug": slug, "label": label, "trials": numbers, "of": trials.len()})
    });
    json!({
        "title": plan.experiment.title,
        "trials": plan.trials.len(),
        "conditions": conditions.collect::<Vec<_>>(),
    })
}
