//! From a manifest as written to an experiment: every name looked up, every file read, every fault collected.

use super::asked::Asked;
use super::crossing::cross;
use super::document::{InferenceDoc, ManifestDoc};
use super::experiment::{Assumption, Experiment, Meanings, ResolvedCondition};
use super::faults::{Faults, step};
use super::input::InputKind;
use super::knowledge::Knowledge;
use super::library::{Inputs, Library, normalised};
use super::names::{is_kebab, kebab};
use super::parameters::{WrappedValue, groups};
use super::parts::Parts;
use super::requests::{self, Requests};
use super::resolver::Resolver;
use super::schema::schema;
use super::{
    claims, from_trials, infer, labels, lint, multiverse, numbers, overrides, previous,
    sensitivity, settings,
};
use crate::condition::Condition;
use crate::document::{Diagnostic, Node, Parsed, Source, parse_tree_by, read};
use crate::studies::StudyKind;
use crate::studies::inference::Shown;
use crate::studies::inference::from_trials::Part;
use crate::table::Table;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};

/// Resolves the manifest `source`, changed by `overrides` (`PATH=VALUE`), with the files that `inputs` hands
/// over. Comes with warnings.
///
/// ```
/// use reenact::document::Source;
/// use reenact::manifest::{self, InputError, Inputs, WrittenIn};
/// use reenact::plan::Plan;
/// # struct Beside;
/// # impl Inputs for Beside {
/// #     fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
/// #         std::fs::read(format!("manifests/{as_written}")).map_err(InputError::other)
/// #     }
/// # }
///
/// let text = std::fs::read_to_string("manifests/quickstart.yaml").unwrap();
/// let source = Source::new("quickstart.yaml", text);
/// // `Beside` reads files beside the manifest.
/// let (experiment, _) = manifest::resolve(&source, &["trials=3".to_owned()], &Beside).unwrap();
/// let plan = Plan::of(experiment);
/// assert_eq!(plan.trials.len(), 2 * 3);
/// assert_eq!(plan.find("floor-plan/2").unwrap().trial, 2);
/// ```
///
/// # Errors
/// Every fault that can be found at this point, warnings among them, in the order of the manifest.
pub fn resolve(
    source: &Source,
    overrides: &[String],
    inputs: &dyn Inputs,
) -> Result<(Experiment, Vec<Diagnostic>), Vec<Diagnostic>> {
    let mut tree = read(source)?;
    let mut library = Library::new(inputs);
    settings::underlay(&mut tree, overrides, &mut library)?;
    overrides::apply(&mut tree, overrides)?;
    // The study says which parameters there are; the schema refuses one that is not known.
    let kind = tree.root.get("study").and_then(Node::scalar_text);
    let kind = kind.as_deref().and_then(StudyKind::named);
    let Parsed { value: doc, tree } = parse_tree_by::<ManifestDoc>(tree, &schema(kind))?;
    let mut faults = Faults::new(&tree);
    library.pin(&doc.pinned, &mut faults);
    let mut resolver = Resolver {
        doc: &doc,
        folder: &source.name,
        faults,
        library,
        factors: Vec::new(),
        aligned: BTreeSet::new(),
        started: BTreeSet::new(),
        groups: groups(doc.study),
        calibration_run: None,
        draws: None,
        inference_run: None,
    };
    let mut experiment = resolver.run(overrides);
    let Resolver { faults, library, .. } = resolver;
    let broken = faults.any_error();
    let faults = faults.finish();
    if broken {
        return Err(faults);
    }
    experiment.inputs = library.files.finish(&doc.license_of);
    Ok((experiment, faults))
}

/// What reports say first where trials are those of a model.
const MODEL: &str = "Trials at graph level: a model of the study on the building's graph, without bodies, sensors or walls. \
                     They propose and are no result.";

impl Resolver<'_> {
    fn run(&mut self, overrides: &[String]) -> Experiment {
        let doc = self.doc;
        if !is_kebab(&doc.name) {
            let label = "expected lower-case letters, digits and single hyphens";
            let fault = self.faults.fault("/name", format!("`{}` cannot be a name", doc.name));
            let help = format!("for example `{}`", kebab(&doc.name));
            self.faults.push(fault.label(label).help(help));
        }
        let (factors, conditions) = cross(doc, &mut self.faults);
        self.factors.clone_from(&factors);
        labels::check(&doc.labels, &factors, &mut self.faults);
        self.draws = Self::draws(self);
        self.check_shared_noise();
        self.check_prior_names();
        self.check_study_keys();
        let assumptions = self.assumptions();
        let sensitivity = sensitivity::read(self, &assumptions);
        let multiverse = multiverse::read(self, &assumptions);
        let published = self.published();
        let requests = Requests { doc, factors: &factors, published: &published };
        requests.check_tables(&mut self.faults);
        requests.check_figures(&mut self.faults);

        let conditions: Vec<ResolvedCondition> =
            conditions.into_iter().filter_map(|condition| self.condition(condition)).collect();
        if !self.faults.any_error() {
            requests::check_recorded(doc, &conditions, &mut self.faults);
            // What names a file, a map its image, may itself be what is missing.
            self.check_unread();
        }
        let conditions = infer::propose(self, &published, conditions);
        let from_trials = from_trials::read(self, &published, &conditions);
        claims::check(self, &conditions);
        let is_model = conditions.iter().any(|resolved| resolved.setup.is_model());
        if is_model {
            self.refuse_results_of_models();
        }
        Experiment {
            name: doc.name.clone(),
            title: doc.title.clone(),
            cite: doc.cite.clone(),
            authors: doc.authors.clone(),
            license: doc.license.clone(),
            limits: doc.limits.iter().cloned().chain(is_model.then(|| MODEL.to_owned())).collect(),
            kind: doc.study,
            seed: doc.seed,
            trials: doc.trials,
            shared_noise: doc.shared_noise.clone(),
            factors,
            labels: doc.labels.clone(),
            conditions,
            published,
            published_files: doc
                .published
                .iter()
                .map(|(name, file)| (name.clone(), normalised(file.path())))
                .collect(),
            tables: match &doc.infer {
                Some(InferenceDoc::FromCounts(infer)) => Shown::requests(infer.times.is_some()),
                Some(InferenceDoc::FromTrials(_)) => [&Part::requests()[..], &doc.tables].concat(),
                None => doc.tables.clone(),
            },
            from_trials,
            figures: doc.figures.clone(),
            claims: claims::as_judged(self),
            assumptions,
            sensitivity,
            multiverse,
            calibration: self.calibration_run.take(),
            inference: self.inference_run.take(),
            overrides: overrides.to_vec(),
            inputs: Vec::new(),
            document: self.faults.tree.clone(),
        }
    }

    /// Collects the faults of what would rest on trials of a model.
    fn refuse_results_of_models(&mut self) {
        let doc = self.doc;
        let asked = [
            ("tables", doc.tables.is_empty()),
            ("figures", doc.figures.is_empty()),
            ("claims", doc.claims.is_empty()),
        ];
        for (key, _) in asked.iter().filter(|(_, is_empty)| !is_empty) {
            let message = "no table, figure or claim may rest on trials at graph level: they are proposals, not results";
            let fault = self.faults.key_fault(&format!("/{key}"), message).label("asks for one");
            let help = "simulate with `mission: {simulation: physics}`, or remove this key";
            self.faults.push(fault.help(help));
        }
    }

    fn check_shared_noise(&mut self) {
        for (i, name) in self.doc.shared_noise.iter().enumerate() {
            let pointer = format!("/shared-noise/{i}");
            self.faults.check_factor(&self.factors, name, &pointer, false);
        }
    }

    /// Collects the faults of licences and pins of files that nobody read.
    fn check_unread(&mut self) {
        let doc = self.doc;
        let read = self.library.files.paths();
        let known: Vec<&str> = read.iter().map(String::as_str).collect();
        let licensed = doc.license_of.keys().filter(|path| !known.contains(&path.as_str()));
        let licensed = licensed.map(|path| (path.clone(), step("/license-of", path), "as written"));
        let pinned = self.library.unused_pins().into_iter();
        let pinned = pinned.map(|(path, pointer)| (path, pointer, "from the manifest"));
        for (path, pointer, how) in licensed.chain(pinned) {
            let message = format!("no input is read from `{path}`");
            let label = format!("expected the path of an input, {how}");
            self.faults.unknown_key(&pointer, message, &label, &path, &known);
        }
    }

    /// Returns the values with reasons; collects the faults of those that depend on a factor.
    fn assumptions(&mut self) -> Vec<Assumption> {
        let mut assumptions = Vec::new();
        for wrapped in self.doc.parameters.wrapped(self.doc.study) {
            let value = match wrapped.value {
                WrappedValue::Plain(value) => value.clone(),
                WrappedValue::By { factor, values, otherwise } => {
                    let by = format!("{}/by", wrapped.pointer);
                    let found = self.faults.check_factor(&self.factors, factor, &by, false);
                    if let Some(found) = found {
                        let place = format!("{}/values", wrapped.pointer);
                        let complete = otherwise.is_none();
                        self.faults.check_levels(values.keys(), found, &place, complete);
                    }
                    let mut value = json!({ "by": factor, "values": values });
                    if let Some(otherwise) = otherwise {
                        value["otherwise"] = otherwise.clone();
                    }
                    value
                }
                WrappedValue::Factor(factor) => {
                    let place = format!("{}/factor", wrapped.pointer);
                    self.faults.check_factor(&self.factors, factor, &place, false);
                    json!({ "factor": factor })
                }
                WrappedValue::Drawn(computed) => {
                    self.check_computed(&computed, &wrapped.pointer);
                    computed.to_json()
                }
            };
            assumptions.extend(wrapped.why.map(|why| Assumption {
                path: wrapped.pointer[1..].replace('/', "."),
                value,
                why: why.to_owned(),
                range: wrapped.range.to_vec(),
            }));
        }
        if let Some(draws) = &self.draws {
            assumptions.retain(|assumption| !draws.replace(&assumption.path));
            assumptions.extend(draws.assumptions());
        }
        assumptions.extend(previous::assumptions(self.doc));
        assumptions
    }

    fn published(&mut self) -> BTreeMap<String, Table> {
        let mut tables = BTreeMap::new();
        let mut factors = self.factors.clone();
        let counts = self.doc.infer.as_ref().and_then(InferenceDoc::from_counts);
        factors.extend(counts.into_iter().flat_map(infer::columns));
        for (name, file) in &self.doc.published {
            let pointer = step("/published", name);
            for (i, factor) in file.for_all().iter().enumerate() {
                let pointer = format!("{pointer}/for-all/{i}");
                self.faults.check_factor(&self.factors, factor, &pointer, false);
            }
            if let Some(source) = self.text(file.path(), &pointer, InputKind::PublishedNumbers)
                && let Some(table) =
                    numbers::read(&source, self.doc.study, &factors, &mut self.faults)
            {
                tables.insert(name.clone(), table);
            }
        }
        tables
    }

    fn condition(&mut self, condition: Condition) -> Option<ResolvedCondition> {
        let doc = self.doc;
        let parts = self.parts(&condition);
        let mut asked = Asked {
            resolver: self,
            condition: &condition,
            parts,
            knowledge: None,
            coverage_map: None,
        };
        let setup = doc.study.setup(&mut asked)?;
        let Asked { parts, knowledge, .. } = asked;
        let Parts { robot_meaning, robot_described, world, .. } = parts?;
        let start = setup.start();
        let start = [start.x, start.y, start.heading].map(f64::to_bits);
        // Conditions share starts; a look at one is enough.
        let is_new = self.started.insert((robot_meaning, world.meaning, start));
        let from_file = world.described.get("file").is_some();
        lint::check(&setup, is_new, from_file, &mut self.faults);
        let meanings = Meanings {
            robot: robot_meaning,
            world: world.meaning,
            prior: knowledge.as_ref().map(Knowledge::meaning),
        };
        let mut described = json!({ "robot": robot_described, "world": world.described });
        if doc.study.keys().contains(&"prior") {
            described["prior"] = json!(knowledge.map(|knowledge| knowledge.described()));
        }
        Some(ResolvedCondition { condition, setup, meanings, described })
    }

    /// Collects the faults of keys that belong to other studies.
    fn check_study_keys(&mut self) {
        let doc = self.doc;
        let written = [
            ("prior", doc.prior.is_some()),
            ("prior-maps", !doc.prior_maps.is_empty()),
            ("calibration", doc.calibration.is_some()),
        ];
        let known = doc.study.keys();
        for (key, _) in written.iter().filter(|(key, is_there)| *is_there && !known.contains(key)) {
            let message = format!("the study `{}` has no `{key}`", doc.study.name());
            self.faults.at_key(&format!("/{key}"), message, "remove this key");
        }
    }
}
