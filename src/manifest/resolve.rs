//! From a manifest as written to an experiment: every name looked up, every file read, every fault collected.

use super::choice::{By, Choice};
use super::claims;
use super::crossing::{Factor, cross, is_kebab, kebab};
use super::document::{FactorRef, ManifestDoc, StartDoc};
use super::experiment::{Assumption, CalibrationRun, Experiment, Meanings, ResolvedCondition};
use super::faults::{Faults, step};
use super::inputs::{InputFiles, Inputs, WrittenIn, joined, normalised};
use super::parameters::WrappedValue;
use super::pinned::Pins;
use super::priors::Knowledge;
use super::worlds::UsedWorld;
use super::{lint, overrides, previous, published, schema, sensitivity, settings};
use crate::digest::MeaningDigest;
use crate::document::{Diagnostic, Node, Parsed, Source, known_or_near, parse_tree_by, read};
use crate::geometry::Pose;
use crate::grid::OccupancyGrid;
use crate::robot::{Robot, urdf};
use crate::studies::deadline::Calibration;
use crate::studies::{Condition, Setup, StudyKind, prior_map};
use crate::table::Table;
use crate::units::Radians;
use crate::world::World;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Resolves the manifest `source`, changed by `overrides` (`PATH=VALUE`), with the files that `inputs` hands
/// over. Comes with warnings.
///
/// # Errors
/// Every fault that can be told at this point, warnings among them, in the order of the manifest.
pub fn resolve(
    source: &Source,
    overrides: &[String],
    inputs: &dyn Inputs,
) -> Result<(Experiment, Vec<Diagnostic>), Vec<Diagnostic>> {
    let mut tree = read(source)?;
    let mut files = InputFiles::new(inputs);
    settings::underlay(&mut tree, overrides, &mut files)?;
    overrides::apply(&mut tree, overrides)?;
    // The study says which parameters there are; one that is not known is told by the schema.
    let kind = tree.root.get("study").and_then(Node::scalar_text);
    let kind = StudyKind::ALL.into_iter().find(|k| kind.as_deref() == Some(k.name()));
    let Parsed { value: doc, tree } = parse_tree_by::<ManifestDoc>(tree, &schema(kind))?;
    let mut faults = Faults::new(&tree);
    let mut resolver = Resolver {
        doc: &doc,
        folder: &source.name,
        pins: Pins::read(&doc.pinned, &mut faults),
        faults,
        files,
        factors: Vec::new(),
        robots: BTreeMap::new(),
        worlds: BTreeMap::new(),
        priors: BTreeMap::new(),
        references: BTreeMap::new(),
        aligned: BTreeSet::new(),
        calibration: None,
        calibration_run: None,
    };
    let mut experiment = resolver.run(overrides);
    let Resolver { faults, files, .. } = resolver;
    let broken = faults.any_error();
    let faults = faults.finish();
    if broken {
        return Err(faults);
    }
    experiment.inputs = files.finish(&doc.license_of);
    Ok((experiment, faults))
}

/// What the trials of every study need.
pub(super) struct Parts {
    pub(super) robot: Arc<Robot>,
    pub(super) robot_meaning: MeaningDigest,
    pub(super) robot_file: Option<String>,
    pub(super) world: UsedWorld,
    pub(super) start: Pose,
}

/// What the planner's expectations were read to be.
#[derive(Clone)]
pub(super) enum Calibrated {
    /// These.
    Known(Arc<Calibration>),
    /// Nothing, which has been told.
    Told,
}

/// A thing that was read and what it means; `None` where it could not be, which has been told.
pub(super) type Known<T> = Option<(Arc<T>, MeaningDigest)>;

pub(super) struct Resolver<'a> {
    pub(super) doc: &'a ManifestDoc,
    /// Name of the manifest, which relative paths are shown beside.
    folder: &'a str,
    pub(super) faults: Faults<'a>,
    pub(super) pins: Pins,
    pub(super) files: InputFiles<'a>,
    pub(super) factors: Vec<Factor>,
    robots: BTreeMap<(String, WrittenIn), Known<Robot>>,
    pub(super) worlds: BTreeMap<String, Known<World>>,
    pub(super) priors: BTreeMap<String, Known<OccupancyGrid>>,
    references: BTreeMap<String, prior_map::SharedReference>,
    /// Pairs of world and prior that have been held against each other.
    aligned: BTreeSet<(MeaningDigest, MeaningDigest, String)>,
    /// What the calibration gave, once it was asked for.
    pub(super) calibration: Option<Calibrated>,
    /// The experiment that gave it.
    pub(super) calibration_run: Option<Arc<CalibrationRun>>,
}

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
        self.check_shared_noise();
        self.check_prior_names();
        self.check_study_keys();
        let assumptions = self.assumptions();
        let sensitivity = sensitivity::read(self, &assumptions);
        let published = self.published();
        published::check_requests(doc, &factors, &published, &mut self.faults);

        let conditions: Vec<ResolvedCondition> =
            conditions.into_iter().filter_map(|condition| self.condition(condition)).collect();
        if !self.faults.any_error() {
            published::check_recorded(doc, &conditions, &mut self.faults);
            // What names a file, a map its image, may itself be what is missing.
            self.check_licenses();
            self.check_pins();
        }
        claims::check(self, &conditions);
        Experiment {
            name: doc.name.clone(),
            title: doc.title.clone(),
            cite: doc.cite.clone(),
            authors: doc.authors.clone(),
            license: doc.license.clone(),
            limits: doc.limits.clone(),
            kind: doc.study,
            seed: doc.seed,
            trials: doc.trials,
            shared_noise: doc.shared_noise.clone(),
            factors,
            conditions,
            published,
            published_files: doc
                .published
                .iter()
                .map(|(name, file)| (name.clone(), normalised(file.path())))
                .collect(),
            tables: doc.tables.clone(),
            figures: doc.figures.clone(),
            claims: doc.claims.clone(),
            assumptions,
            sensitivity,
            calibration: self.calibration_run.take(),
            overrides: overrides.to_vec(),
            inputs: Vec::new(),
            document: self.faults.tree.clone(),
        }
    }

    fn check_shared_noise(&mut self) {
        for (i, name) in self.doc.shared_noise.iter().enumerate() {
            let pointer = format!("/shared-noise/{i}");
            self.faults.check_factor(&self.factors, name, &pointer, false);
        }
    }

    fn check_licenses(&mut self) {
        let read: Vec<String> = self.files.paths();
        let known: Vec<&str> = read.iter().map(String::as_str).collect();
        for path in self.doc.license_of.keys().filter(|path| !known.contains(&path.as_str())) {
            let fault = self
                .faults
                .key_fault(&step("/license-of", path), format!("no input is read from `{path}`"))
                .label("expected the path of an input, as written")
                .help(self.faults.near(path, &known));
            self.faults.push(fault);
        }
    }

    /// Values with reasons; faults of those that depend on a factor.
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
            };
            assumptions.extend(wrapped.why.map(|why| Assumption {
                path: wrapped.pointer[1..].replace('/', "."),
                value,
                why: why.to_owned(),
                range: wrapped.range.to_vec(),
            }));
        }
        assumptions.extend(previous::assumptions(self.doc));
        assumptions
    }

    fn published(&mut self) -> BTreeMap<String, Table> {
        let mut tables = BTreeMap::new();
        for (name, file) in &self.doc.published {
            let pointer = step("/published", name);
            for (i, factor) in file.for_all().iter().enumerate() {
                let pointer = format!("{pointer}/for-all/{i}");
                self.faults.check_factor(&self.factors, factor, &pointer, false);
            }
            if let Some(source) = self.text(file.path(), &pointer)
                && let Some(table) =
                    published::read(&source, self.doc.study, &self.factors, &mut self.faults)
            {
                tables.insert(name.clone(), table);
            }
        }
        tables
    }

    fn condition(&mut self, condition: Condition) -> Option<ResolvedCondition> {
        let doc = self.doc;
        let robot = self.choose(&doc.robot, "/robot", &condition);
        let robot_file = robot.as_ref().map(|(path, _)| (*path).clone());
        let robot = robot.and_then(|(path, pointer)| self.robot(path, &pointer));
        let world = self
            .choose(&doc.world, "/world", &condition)
            .and_then(|(world, pointer)| self.world(world, &pointer, &condition));
        let start = self.start(world.as_ref(), &condition);
        let parts = robot.zip(world).zip(start).map(|(((robot, robot_meaning), world), start)| {
            Parts { robot, robot_meaning, robot_file, world, start }
        });
        match doc.study {
            StudyKind::PriorMap => self.prior_map(condition, parts),
            StudyKind::Deadline => self.deadline(condition, parts),
        }
    }

    /// A condition of the prior-knowledge study.
    fn prior_map(
        &mut self,
        condition: Condition,
        parts: Option<Parts>,
    ) -> Option<ResolvedCondition> {
        let parameters = self.parameters::<prior_map::Parameters>(&condition);
        // Every part has told its faults by now; the prior needs them all.
        let (parameters, parts) = (parameters?, parts?);
        let Parts { robot, robot_meaning, robot_file, world, start } = parts;
        let knowledge = self.prior(&condition, &world, &robot, start, &parameters).ok()?;
        let prior = knowledge.as_ref().and_then(Knowledge::map);
        let reference = self.reference(robot_meaning, &world, start, &parameters);
        let setup = prior_map::Setup::new(
            Arc::clone(&world.world),
            robot,
            prior.as_ref().map(|prior| Arc::clone(&prior.grid)),
            start,
            parameters,
        )
        .with_topo_metric_map(knowledge.as_ref().and_then(Knowledge::topo_metric_map))
        .with_reference(reference);
        lint::check(&setup, prior, &mut self.faults);
        if let Some(prior) = prior.filter(|prior| !prior.own) {
            // Conditions share worlds and priors; holding one against the other once is enough.
            let pair = (world.meaning, prior.meaning, prior.pointer.clone());
            if self.aligned.insert(pair) {
                lint::alignment(&setup, prior, &mut self.faults);
            }
        }
        let meanings = Meanings {
            robot: robot_meaning,
            world: world.meaning,
            prior: knowledge.as_ref().map(Knowledge::meaning),
        };
        let described = json!({
            "robot": robot_file,
            "world": world.described,
            "prior": knowledge.map(|knowledge| knowledge.described()),
        });
        let setup = Setup::PriorMap(Arc::new(setup));
        Some(ResolvedCondition { condition, setup, meanings, described })
    }

    /// What coverage is measured against: the same for all conditions that differ in prior knowledge and choices only.
    fn reference(
        &mut self,
        robot: MeaningDigest,
        world: &UsedWorld,
        start: Pose,
        parameters: &prior_map::Parameters,
    ) -> prior_map::SharedReference {
        let alike = prior_map::Parameters {
            exploration: prior_map::Parameters::default().exploration,
            ..parameters.clone()
        };
        let key = json!([robot, world.meaning, start, alike]).to_string();
        self.references.entry(key).or_default().clone()
    }

    pub(super) fn parameters<P: serde::de::DeserializeOwned>(
        &mut self,
        condition: &Condition,
    ) -> Option<P> {
        let value_of = |factor: &str| condition.value(factor);
        match self.doc.parameters.for_condition(self.doc.study, &value_of) {
            Ok(parameters) => Some(parameters),
            Err(problem) => {
                self.faults.at_key("/parameters", problem, &format!("for `{condition}`"));
                None
            }
        }
    }

    /// What `choice` is for `condition`, and where that is written.
    pub(super) fn choose<'c, T>(
        &mut self,
        choice: &'c Choice<T>,
        pointer: &str,
        condition: &Condition,
    ) -> Option<(&'c T, String)> {
        match choice {
            Choice::Plain(value) => Some((value, pointer.to_owned())),
            Choice::By(By { by, values }) => {
                let place = format!("{pointer}/by");
                let factor = self.faults.check_factor(&self.factors, by, &place, false)?;
                let place = format!("{pointer}/values");
                self.faults.check_levels(values.keys(), factor, &place, true);
                let level = condition.value(by)?;
                let pointer = step(&format!("{pointer}/values"), level);
                self.choose(values.get(level)?, &pointer, condition)
            }
        }
    }

    /// The bytes of the file `path`, written at `pointer`, and its text's name.
    pub(super) fn bytes(&mut self, path: &str, pointer: &str) -> Option<Arc<[u8]>> {
        let written_in = self.faults.written_in(pointer);
        self.bytes_of(&normalised(path), written_in, path, pointer)
    }

    /// The text of the file `path`, written at `pointer`.
    pub(super) fn text(&mut self, path: &str, pointer: &str) -> Option<Source> {
        let bytes = self.bytes(path, pointer)?;
        let Ok(text) = std::str::from_utf8(&bytes) else {
            let fault = self.faults.fault(pointer, format!("`{path}` is not UTF-8 text"));
            self.faults.push(fault.label("expected a text file"));
            return None;
        };
        let name = match self.faults.written_in(pointer) {
            WrittenIn::Manifest => joined(self.folder, path),
            WrittenIn::CommandLine | WrittenIn::Calibration | WrittenIn::PreviousMap => {
                normalised(path)
            }
        };
        Some(Source::new(name, text))
    }

    fn robot(&mut self, path: &str, pointer: &str) -> Known<Robot> {
        let key = (normalised(path), self.faults.written_in(pointer));
        if let Some(known) = self.robots.get(&key) {
            return known.clone();
        }
        let known = self.text(path, pointer).and_then(|source| match urdf::read(&source) {
            Ok((robot, warnings)) => {
                self.faults.extend(warnings);
                let meaning = robot.meaning();
                Some((Arc::new(robot), meaning))
            }
            Err(faults) => {
                self.faults.extend(faults);
                None
            }
        });
        self.robots.insert(key, known.clone());
        known
    }

    fn start(&mut self, world: Option<&UsedWorld>, condition: &Condition) -> Option<Pose> {
        let (start, pointer) = self.choose(&self.doc.start, "/start", condition)?;
        self.start_written(start, &pointer, world, condition)
    }

    /// The start that `start`, written at `pointer`, is in `world`.
    pub(super) fn start_written(
        &mut self,
        start: &StartDoc,
        pointer: &str,
        world: Option<&UsedWorld>,
        condition: &Condition,
    ) -> Option<Pose> {
        match start {
            StartDoc::Pose(pose) => {
                Some(Pose::new(pose.x_m, pose.y_m, Radians::from_degrees(pose.heading_deg).get()))
            }
            StartDoc::Name(name) => self.named_start(name, pointer, world?),
            StartDoc::Factor(FactorRef { factor }) => {
                let place = format!("{pointer}/factor");
                self.faults.check_factor(&self.factors, factor, &place, false)?;
                self.named_start(condition.value(factor)?, &place, world?)
            }
        }
    }

    fn named_start(&mut self, name: &str, pointer: &str, world: &UsedWorld) -> Option<Pose> {
        let starts = &world.world.starts;
        if let Some(pose) = starts.get(name) {
            return Some(*pose);
        }
        let known: Vec<&str> = starts.keys().map(String::as_str).collect();
        let fault = self
            .faults
            .fault(pointer, format!("unknown start `{name}`"))
            .label("not a start of the world");
        self.faults.push(fault.help(known_or_near(name, &known)));
        None
    }
}

/// What paths are relative to, in words.
pub(super) fn relative_to(written_in: WrittenIn) -> &'static str {
    match written_in {
        WrittenIn::Manifest => "paths are relative to the file they are written in",
        WrittenIn::CommandLine | WrittenIn::Calibration | WrittenIn::PreviousMap => {
            "paths in `--set` are relative to the current directory"
        }
    }
}
