//! `ro-crate-metadata.json`: RO-Crate 1.1, Workflow RO-Crate 1.0 and the Process, Workflow and Provenance Run Crate
//! profiles 0.5, which roc-validator 0.13 knows. The manifest is the workflow; every condition is one `CreateAction`.
//!
//! What the validator wants beyond the specifications: `+00:00` rather than `Z`, `actionStatus` as a string, no
//! one-element arrays, every file reachable by `hasPart`, every key in the context (`sha256` is not in that of 1.1).

use super::crate_edition::{Edition, written};
use super::crate_entities::Entity;
use super::crate_people::People;
use super::readme::license_address;
use super::{BundleContent, Circumstance, FileRef, Files, bag, format, in_payload};
use crate::digest::{ResultsDigest, Sha256Digest, StudyDigest};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

const BIOSCHEMAS: &str = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE";
const PROFILES: [(&str, &str, &str); 4] = [
    ("https://w3id.org/ro/wfrun/process/0.5", "Process Run Crate", "0.5"),
    ("https://w3id.org/ro/wfrun/workflow/0.5", "Workflow Run Crate", "0.5"),
    ("https://w3id.org/ro/wfrun/provenance/0.5", "Provenance Run Crate", "0.5"),
    ("https://w3id.org/workflowhub/workflow-ro-crate/1.0", "Workflow RO-Crate", "1.0"),
];

/// Writes the document for a payload that holds everything but itself and the preview.
pub(super) fn document(
    content: &BundleContent,
    circumstance: &Circumstance,
    payload: Files<'_>,
    results: ResultsDigest,
    study: StudyDigest,
) -> Vec<u8> {
    let files: BTreeMap<&str, FileRef<'_>> =
        payload.iter().filter_map(|(path, file)| Some((in_payload(path)?, file))).collect();
    let graph = Graph { content, circumstance, files, people: People::of(content) };
    let entities: Vec<Value> = std::iter::empty()
        .chain(graph.root(results, study))
        .chain(graph.people.entities(content))
        .chain(graph.licenses())
        .chain(graph.workflow())
        .chain(graph.parameters())
        .chain(graph.actions())
        .chain(graph.files())
        .map(Entity::into_value)
        .collect();
    written(&json!({"@context": Edition::default().context(), "@graph": entities}))
}

/// Everything the graph is made of.
pub(super) struct Graph<'a> {
    pub(super) content: &'a BundleContent,
    pub(super) circumstance: &'a Circumstance,
    files: BTreeMap<&'a str, FileRef<'a>>,
    pub(super) people: People,
}

impl Graph<'_> {
    /// Describes the metadata's own descriptor, the crate and what its identifiers mean.
    fn root(&self, results: ResultsDigest, study: StudyDigest) -> Vec<Entity> {
        let content = self.content;
        let parts = self.files.keys().filter(|path| !path.starts_with(format::TRIALS));
        let parts: Vec<&str> = parts.copied().chain([format::TRIALS]).collect();
        let actions: Vec<String> = ["#run".to_owned(), "#analysis".to_owned()]
            .into_iter()
            .chain(content.conditions.iter().map(|c| format!("#condition-{}", c.slug)))
            .collect();
        let mut description = bag::one_line(&content.description);
        if content.partial {
            description.push_str(" (Partial run: only some of the trials.)");
        }
        let root = Entity::new("./", &["Dataset"])
            .text("name", &content.title)
            .text("description", description)
            .text("datePublished", self.circumstance.ended.date())
            .refer("license", &license_id(&content.license))
            .refer_all("author", &self.people.authors)
            .refer("publisher", self.people.publisher(content))
            .refer_all("conformsTo", PROFILES.map(|(id, ..)| id))
            .refer("mainEntity", format::STUDY)
            .refer_all("identifier", ["#results-digest", "#study-digest"])
            .refer_all("hasPart", parts)
            .refer_all("mentions", actions)
            .with(content.cite.as_ref(), |root, cite| root.refer("citation", &cite_id(cite)));
        let digest = |id: &str, name: &str, value: String| {
            Entity::new(id, &["PropertyValue"])
                .text("propertyID", format!("{}{id}", format::HOME))
                .text("name", name)
                .text("value", value)
        };
        let mut entities = vec![
            Entity::new(format::METADATA, &["CreativeWork"]).refer("about", "./").refer_all(
                "conformsTo",
                [
                    "https://w3id.org/ro/crate/1.1",
                    "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
                ],
            ),
            root,
            digest("#results-digest", "results digest", format!("sha256:{results}")),
            digest("#study-digest", "study digest", format!("sha256:{study}")),
            Entity::new(format::PREVIEW, &["CreativeWork"])
                .text("name", "Page about this bundle")
                .refer("about", "./")
                .text("encodingFormat", "text/html"),
            Entity::new(BIOSCHEMAS, &["CreativeWork"])
                .text("name", "Bioschemas ComputationalWorkflow profile")
                .text("version", "1.0-RELEASE"),
        ];
        entities.extend(PROFILES.map(|(id, name, version)| {
            Entity::new(id, &["CreativeWork", "Profile"])
                .text("name", name)
                .text("version", version)
        }));
        if let Some(cite) = &content.cite {
            let work = Entity::new(&cite_id(cite), &["ScholarlyArticle"]).text("name", &cite.text);
            entities.push(work.with(cite.url.as_ref(), |work, url| work.text("url", url)));
        }
        entities
    }

    fn licenses(&self) -> Vec<Entity> {
        let names: BTreeSet<&String> = std::iter::once(&self.content.license)
            .chain(self.content.inputs.iter().filter_map(|input| input.license.as_ref()))
            .collect();
        names
            .into_iter()
            .map(|name| {
                Entity::new(&license_id(name), &["CreativeWork"])
                    .text("name", name)
                    .text("description", format!("Licence: {name}"))
                    .with(license_address(name), |license, url| license.text("url", url))
            })
            .collect()
    }

    /// Describes the manifest as a workflow of two steps, and the program that carries them out.
    fn workflow(&self) -> Vec<Entity> {
        let version = &self.circumstance.version;
        let (runner, simulate, analyze) = self.tools();
        let inputs: Vec<_> = self.inputs().into_iter().map(|i| i.parameter).collect();
        let outputs: Vec<_> = self.outputs().into_iter().map(|o| o.parameter).collect();
        let seed = std::iter::once("#parameter-seed".to_owned());
        let language = format!("{}#manifest", format::HOME);
        let tool = |id: &str, name: &str, description: &str| {
            Entity::new(id, &["SoftwareApplication"])
                .text("name", name)
                .text("description", description)
                .text("url", format::HOME)
                .text("version", version)
        };
        let manifest = self.files.get(format::STUDY).copied().unwrap_or(FileRef::Held(&[]));
        let study = Entity::new(
            format::STUDY,
            &["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"],
        );
        vec![
            described(
                study,
                format::STUDY,
                manifest,
                "Study manifest",
                "The manifest, byte for byte as written; it determines every trial",
            )
            .text("version", "1")
            .text("url", format::HOME)
            .refer_all("author", &self.people.authors)
            .refer("license", &license_id(&self.content.license))
            .refer("conformsTo", BIOSCHEMAS)
            .refer("programmingLanguage", &language)
            .refer_all("input", inputs.iter().cloned().chain(seed))
            .refer_all("output", &outputs)
            .refer_all("hasPart", [&simulate, &analyze])
            .refer_all("step", ["#step-trials", "#step-analysis"]),
            Entity::new(&language, &["ComputerLanguage"])
                .text("name", "Reenact manifest")
                .text("alternateName", "reenact")
                .text("version", "1")
                .text("url", format::HOME)
                .refer("identifier", &language),
            tool(&runner, "reenact", "Runs every trial of a manifest and seals what came out"),
            tool(&simulate, "reenact simulate", "Simulates one trial")
                .refer("softwareRequirements", &runner)
                .refer_all("input", &inputs),
            tool(&analyze, "reenact analyse", "Tabulates records, judges claims, draws figures")
                .refer("softwareRequirements", &runner)
                .refer_all("output", &outputs),
            Entity::new("#step-trials", &["HowToStep"])
                .text("name", "Run every trial")
                .text("position", "1")
                .refer("workExample", &simulate),
            Entity::new("#step-analysis", &["HowToStep"])
                .text("name", "Tabulate, judge and draw")
                .text("position", "2")
                .refer("workExample", &analyze),
        ]
    }

    fn parameters(&self) -> Vec<Entity> {
        let mut entities: Vec<_> = self
            .inputs()
            .into_iter()
            .chain(self.outputs())
            .map(|file| {
                Entity::new(&file.parameter, &["FormalParameter"])
                    .text("additionalType", "File")
                    .text("name", file.parameter.trim_start_matches('#'))
                    .text("description", title(&file.path).1)
                    .text("encodingFormat", format::media_type(&file.path))
                    .refer("workExample", &file.path)
            })
            .collect();
        entities.push(
            Entity::new("#parameter-seed", &["FormalParameter"])
                .text("additionalType", "Integer")
                .text("name", "seed")
                .text("description", "Seed of the experiment: every random stream derives from it")
                .text("valueRequired", "True")
                .refer("workExample", "#seed"),
        );
        entities.push(
            Entity::new("#seed", &["PropertyValue"])
                .text("name", "seed")
                .text("value", self.content.seed.to_string())
                .refer("exampleOfWork", "#parameter-seed"),
        );
        entities
    }

    fn files(&self) -> Vec<Entity> {
        let records: Vec<&str> =
            self.files.keys().copied().filter(|path| path.starts_with(format::TRIALS)).collect();
        let mut entities = vec![
            Entity::new(format::TRIALS, &["Dataset"])
                .text("name", "Trial records")
                .text(
                    "description",
                    "One file a condition, one line of JSON a trial, in plan order",
                )
                .refer_all("hasPart", records),
        ];
        let parameters: BTreeMap<String, String> = self
            .inputs()
            .into_iter()
            .chain(self.outputs())
            .map(|f| (f.path, f.parameter))
            .collect();
        let licenses: BTreeMap<String, &String> = self
            .content
            .inputs
            .iter()
            .filter_map(|i| Some((format!("{}{}", format::INPUTS, i.name), i.license.as_ref()?)))
            .collect();
        for (&path, &file) in self.files.iter().filter(|(path, _)| **path != format::STUDY) {
            let (name, description) = title(path);
            let entity = described(Entity::new(path, &["File"]), path, file, &name, &description)
                .with(parameters.get(path), |file, parameter| {
                    file.refer("exampleOfWork", parameter)
                })
                .with(licenses.get(path), |file, name| file.refer("license", &license_id(name)))
                .with((path == format::README).then_some("./"), |file, root| {
                    file.refer("about", root)
                });
            entities.push(entity);
        }
        entities
    }

    /// Returns the identifiers of the runner and its two tools.
    pub(super) fn tools(&self) -> (String, String, String) {
        let (home, version) = (format::HOME, &self.circumstance.version);
        (
            format!("{home}#{version}"),
            format!("{home}/simulate#{version}"),
            format!("{home}/analyse#{version}"),
        )
    }

    pub(super) fn inputs(&self) -> Vec<Parameter> {
        self.parameters_under(format::INPUTS, "input")
    }

    pub(super) fn outputs(&self) -> Vec<Parameter> {
        self.parameters_under(format::RESULTS, "output")
    }

    fn parameters_under(&self, folder: &str, role: &str) -> Vec<Parameter> {
        self.files
            .keys()
            .filter_map(|path| Some((path, path.strip_prefix(folder)?)))
            .map(|(path, name)| Parameter {
                path: (*path).to_owned(),
                parameter: format!("#{role}/{name}"),
            })
            .collect()
    }
}

/// A file that stands for a formal parameter of the workflow.
pub(super) struct Parameter {
    pub(super) path: String,
    parameter: String,
}

fn described(
    entity: Entity,
    path: &str,
    file: FileRef<'_>,
    name: &str,
    description: &str,
) -> Entity {
    entity
        .text("name", name)
        .text("description", description)
        .text("encodingFormat", format::media_type(path))
        .text("contentSize", file.size().to_string())
        .text("sha256", file.digest().hex())
}

/// Returns the name and description of a payload file.
fn title(path: &str) -> (String, String) {
    let last = path.rsplit('/').next().unwrap_or(path);
    let stem = last.split('.').next().unwrap_or(last);
    let (name, description): (String, String) = match path {
        format::RESOLVED => (
            "Resolved study".into(),
            "The manifest with every default and override, and the digest of every input".into(),
        ),
        format::INDEX => (
            "Page of the findings".into(),
            "What was found and what that does not show: claims, tables, figures; how to check it".into(),
        ),
        format::README => ("Read me".into(), "How to check this bundle and run it again".into()),
        format::LICENSE => ("Licences".into(), "Which licence holds for what".into()),
        format::DATA_PACKAGE => (
            "Data package".into(),
            "Every column of every CSV file, for programs: Frictionless Data Package 1, Table Schema 1".into(),
        ),
        format::DICTIONARY => {
            ("Data dictionary".into(), "Every column of every CSV file, for people".into())
        }
        format::CITATION => {
            ("Citation".into(), "How to cite this bundle: Citation File Format 1.2.0".into())
        }
        format::ZENODO => {
            ("Deposit".into(), "What Zenodo asks of a deposit: title, creators, licence".into())
        }
        "results/trials.csv" => {
            ("Trials".into(), "One row a trial: factors, outcome, measures".into())
        }
        "results/series.csv" => {
            ("Curves".into(), "The trials' curves over coverage and time, joined to trials.csv by `key`".into())
        }
        "results/claims.csv" => ("Verdicts".into(), "One row a claim: what is claimed, and what the trials say of it".into()),
        "results/comparisons.csv" => {
            ("Comparisons".into(), "One row for each comparison that a verdict rests on, with its effect and p-values".into())
        }
        "results/claims.json" => {
            ("Claims".into(), "The verdict on every claim and the numbers that decided it".into())
        }
        _ if path.starts_with("results/tables/") => {
            (format!("Table {stem}"), "A table derived from the trial records".into())
        }
        _ if path.starts_with("results/figures/") => {
            (format!("Figure {stem}"), "A figure derived from the trial records".into())
        }
        _ if path.starts_with(format::RESULTS) => {
            (last.into(), "A result derived from the trial records".into())
        }
        "circumstances/claims.json" => (
            "Claims about the machine".into(),
            "The verdict on every claim about wall time, and the numbers that decided it".into(),
        ),
        "circumstances/wall-times.csv" => (
            "Wall times".into(),
            "One row a trial: the time it took on the machine that ran it".into(),
        ),
        _ if path.starts_with(format::ENGINE) => (
            "Source of the engine".into(),
            "What the program that ran the study was built from, with its lock file; data, not to be run unread".into(),
        ),
        _ if path.starts_with(format::TRIALS) => {
            (format!("Records of {stem}"), "One line of JSON a trial, in plan order".into())
        }
        _ => (last.into(), "A file that the study reads, as it was when the study ran".into()),
    };
    (name, description)
}

/// Returns the identifier of a licence: its address, or a local one for words.
fn license_id(license: &str) -> String {
    license_address(license)
        .unwrap_or_else(|| format!("#license-{}", Sha256Digest::of(license).short()))
}

fn cite_id(cite: &super::Publication) -> String {
    cite.url.clone().unwrap_or_else(|| "#reproduced-work".to_owned())
}
