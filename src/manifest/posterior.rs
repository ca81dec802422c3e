//! `draw: {posterior: FILE, n: N}`: a factor whose values are draws of what an inference found.
//!
//! The inference is a manifest of its own. Its proposals are taken from the store or made first, sealed as an input as they are, and
//! the draws follow from them wherever the manifest is read again.

use super::choice::DrawsFactor;
use super::crossing::draws;
use super::document::{PlaceDoc, PointDoc, PoseDoc};
use super::drawn::{Draw, Draws};
use super::experiment::{Experiment, InferenceRun};
use super::faults::step;
use super::input::{InputKind, Nested};
use super::library::{InputError, ProposalTrials, normalised};
use super::parameters::Computed;
use super::resolver::Resolver;
use super::used_world::UsedWorld;
use crate::condition::Condition;
use crate::document::Node;
use crate::studies::inference::{InferenceDesign, PickedDraw, PickedPlace};
use crate::studies::{RecordError, Setup, TrialRecord};
use std::string::FromUtf8Error;
use std::sync::Arc;

impl Resolver<'_> {
    /// Returns the draws that are the values of a factor, where there is such a factor; faults where they cannot be had.
    pub(super) fn draws(&mut self) -> Option<Draws> {
        let doc = self.doc;
        let known = self.factors.iter();
        let (name, wanted) =
            known.map(|f| &f.name).find_map(|name| Some((name.clone(), draws(doc, name)?)))?;
        let pointer = format!("{}/posterior", step("/factors", &name));
        let path = &wanted.posterior;
        if let Some((Nested::Inference, other)) = self.library.files.read_as() {
            let message =
                format!("`{other}` is read as an inference and asks for draws of `{path}`");
            let fault = self.faults.fault(&pointer, message).label("one that runs none");
            let help = "an inference proposes buildings and rules by itself: list the values of this factor";
            self.faults.push(fault.help(help));
            return None;
        }
        let experiment = self.nested(path, &pointer, Nested::Inference)?;
        if experiment.kind != doc.study {
            let message = format!("`{path}` infers for the study `{}`", experiment.kind.name());
            let label = format!("expected `{}`, the study of this manifest", doc.study.name());
            self.faults.at(&pointer, message, &label);
            return None;
        }
        let stem = normalised(path);
        let stem = stem.strip_suffix(".yaml").unwrap_or(&stem);
        let sealed_as = format!("{stem}.proposals.jsonl");
        match self.picked(experiment, (&name, wanted), sealed_as) {
            Ok((run, picked)) => {
                let made = self.made_of(&run, picked, (name, wanted), &pointer);
                self.inference_run = Some(run);
                made
            }
            Err(problem) => {
                let message = format!("`{path}` gives no draws");
                let fault = self.faults.fault(&pointer, message).label(problem.to_string());
                self.faults
                    .push(fault.help(format!("`reenact check {path}` tells its own faults")));
                None
            }
        }
    }

    /// Returns the draws of what `experiment` proposes.
    fn picked(
        &mut self,
        experiment: Experiment,
        (factor, wanted): (&str, &DrawsFactor),
        sealed_as: String,
    ) -> Result<(InferenceRun, Vec<PickedDraw>), Undrawn> {
        let proposals = match self.library.files.propose(&experiment, &sealed_as)? {
            ProposalTrials::StandIn => None,
            ProposalTrials::Lines(bytes) => Some(String::from_utf8(bytes)?),
        };
        let conditions: Vec<_> = experiment.design().collect();
        let design =
            InferenceDesign::of(&experiment.factors, &conditions).ok_or(Undrawn::NoInference)?;
        let (picked, lines) = match proposals {
            None => (design.stand_ins(wanted.n), None),
            Some(text) => {
                let records = records(&text, &experiment)
                    .map_err(|problem| Undrawn::Unread(sealed_as.clone(), problem))?;
                let lines: Arc<[String]> = text.lines().map(str::to_owned).collect();
                (design.pick(&records, wanted.n), Some(lines))
            }
        };
        if picked.len() < wanted.n as usize {
            return Err(Undrawn::Nothing);
        }
        let experiment = Arc::new(experiment);
        let factor = factor.to_owned();
        Ok((InferenceRun { experiment, proposals: lines, sealed_as, factor }, picked))
    }

    /// Returns the draws with their worlds, and seals their table; faults where something sets what they set.
    fn made_of(
        &mut self,
        run: &InferenceRun,
        picked: Vec<PickedDraw>,
        (factor, wanted): (String, &DrawsFactor),
        pointer: &str,
    ) -> Option<Draws> {
        let conditions: Vec<(&Condition, &Setup)> = run.experiment.design().collect();
        let design = InferenceDesign::of(&run.experiment.factors, &conditions)?;
        if run.proposals.is_some() {
            // What follows from the proposals is sealed beside them, for people.
            let table = run.sealed_as.replace(".proposals.jsonl", ".draws.csv");
            let csv = design.table(&picked).to_csv();
            self.library.files.made(&table, InputKind::Draws, csv.as_bytes());
        }
        let owned = |paths: Vec<&str>| paths.into_iter().map(str::to_owned).collect();
        let (parameters, numbers): (Vec<String>, Vec<String>) =
            (owned(design.parameters()), owned(design.numbers()));
        for path in &parameters {
            self.check_not_set(path, &factor);
        }
        let made = picked.into_iter().map(|draw| {
            let building =
                run.experiment.conditions.iter().find(|c| c.condition == draw.building)?;
            let used = UsedWorld {
                world: Arc::new(building.setup.world().clone()),
                meaning: building.meanings.world,
                described: building.described["world"].clone(),
            };
            let world = self.placed(used, &place(&draw.places), pointer)?;
            Some(Draw { world, values: draw.values.into_iter().collect() })
        });
        let each = made.collect::<Option<Vec<Draw>>>()?;
        Some(Draws { factor, file: wanted.posterior.clone(), parameters, numbers, each })
    }

    /// Collects the faults of a parameter at `pointer` that is computed from a number that was drawn.
    pub(super) fn check_computed(&mut self, computed: &Computed<'_>, pointer: &str) {
        let (reference, key) = computed.reference();
        let place = format!("{pointer}/{key}");
        if let Computed::Read { points, .. } = computed
            && points.windows(2).any(|pair| pair[1][0] <= pair[0][0])
        {
            let label = "expected points from left to right";
            self.faults.at(&format!("{pointer}/points"), "the points do not increase", label);
            return;
        }
        let Some(draws) = &self.draws else {
            let doc = self.doc;
            // Draws that could not be had have been told.
            if !self.factors.iter().any(|factor| draws(doc, &factor.name).is_some()) {
                let fault = self.faults.fault(&place, format!("nothing draws `{reference}`"));
                let fault = fault.label("no factor of this manifest is `{posterior: FILE, n: N}`");
                self.faults.push(fault.help("docs/inference.md says how draws are run"));
            }
            return;
        };
        let (known, each) = (draws.references(), draws.each(reference));
        if each.is_empty() {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let message = format!("no number `{reference}` is drawn");
            self.faults.unknown(&place, message, "expected FACTOR.PATH", reference, &known);
        }
        let beyond = each.iter().zip(1..).find(|(drawn, _)| computed.at(**drawn).is_none());
        if let Some((drawn, number)) = beyond {
            let number: u32 = number;
            let message = format!("draw {number} has `{reference}` at {drawn}");
            let label = match computed {
                Computed::Divided { .. } => "by which nothing can be divided",
                Computed::Read { .. } => "which lies beyond the points",
            };
            self.faults.at(&place, message, label);
        }
    }

    /// Collects the fault of a parameter at `path` that the manifest, or the command line, sets beside the draws of `factor`; settings
    /// are what holds where nothing else is said.
    fn check_not_set(&mut self, path: &str, factor: &str) {
        let pointer = format!("/parameters/{}", path.replace('.', "/"));
        let tree = self.faults.tree;
        let by_hand = |node: &Node| {
            let source = usize::from(node.place.source);
            source == 0 || tree.sources.get(source).is_some_and(|s| &*s.name == "command line")
        };
        if tree.node(&pointer).is_some_and(by_hand) {
            let message = format!("`{path}` is set twice");
            let fault = self.faults.key_fault(&pointer, message);
            let fault = fault.label(format!("each draw of `{factor}` has a value of its own"));
            self.faults.push(fault.help("remove this value"));
        }
    }
}

/// Returns where the goal and the starts of a draw lie, as a manifest would write it.
fn place(places: &[PickedPlace]) -> PlaceDoc {
    let goal = places.iter().find(|place| place.name == PickedPlace::GOAL);
    let starts = places.iter().filter_map(|place| {
        let [x_m, y_m] = place.at;
        Some((place.start()?.to_owned(), PoseDoc { x_m, y_m, heading_deg: 0.0 }))
    });
    let point = |place: &PickedPlace| PointDoc { x_m: place.at[0], y_m: place.at[1] };
    PlaceDoc { goal: goal.map(point), starts: starts.collect() }
}

/// Reads the proposals of `experiment`, which stand in plan order.
fn records(text: &str, experiment: &Experiment) -> Result<Vec<TrialRecord>, Misread> {
    let planned = experiment
        .conditions
        .iter()
        .flat_map(|resolved| (0..experiment.trials).map(move |trial| (&resolved.condition, trial)));
    let mut lines = text.lines().enumerate();
    let mut records = Vec::new();
    for (condition, trial) in planned {
        let (index, line) = lines.next().ok_or(Misread::Fewer(records.len()))?;
        let record =
            TrialRecord::from_line(line).map_err(|error| Misread::NoRecord(index + 1, error))?;
        if record.condition != *condition || record.trial != trial {
            return Err(Misread::Another {
                line: index + 1,
                expected: format!("{condition}/{trial}"),
            });
        }
        records.push(record);
    }
    match lines.next() {
        Some((index, _)) => Err(Misread::More(index + 1)),
        None => Ok(records),
    }
}

/// Why an inference gives no draws.
#[derive(Debug, thiserror::Error)]
enum Undrawn {
    #[error(transparent)]
    Input(#[from] InputError),
    #[error(transparent)]
    NotText(#[from] FromUtf8Error),
    #[error("`{0}`: {1}")]
    Unread(String, Misread),
    #[error("it proposes nothing")]
    NoInference,
    #[error("no proposal explains the table")]
    Nothing,
}

/// Why a text holds no proposals of an inference.
#[derive(Debug, thiserror::Error)]
enum Misread {
    #[error("line {0}: {1}")]
    NoRecord(usize, RecordError),
    #[error("line {line}: expected the proposal {expected}")]
    Another { line: usize, expected: String },
    #[error("{0} proposals are fewer than the inference makes")]
    Fewer(usize),
    #[error("line {0}: more proposals than the inference makes")]
    More(usize),
}
