//! `ro-crate-metadata.json`: RO-Crate 1.1, Workflow RO-Crate 1.0 and the Process, Workflow and Provenance Run Crate
//! profiles 0.5, which roc-validator 0.13 knows. The manifest is the workflow; every condition is one `CreateAction`.
//!
//! What the validator wants beyond the specifications: `+00:00` rather than `Z`, `actionStatus` as a string, no
//! one-element arrays, every file reachable by `hasPart`, every key in the context (`sha256` is not in that of 1.1).

use super::crate_entities::Entity;
use super::readme::license_address;
use super::{Author, BundleContent, Circumstance, Tree, bag, format};
use crate::digest::{ResultsDigest, Sha256Digest, StudyDigest};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

const TERMS: &str = "https://w3id.org/ro/terms/workflow-run#";
const BIOSCHEMAS: &str = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE";
const PROFILES: [(&str, &str, &str); 4] = [
    ("https://w3id.org/ro/wfrun/process/0.5", "Process Run Crate", "0.5"),
    ("https://w3id.org/ro/wfrun/workflow/0.5", "Workflow Run Crate", "0.5"),
    ("https://w3id.org/ro/wfrun/provenance/0.5", "Provenance Run Crate", "0.5"),
    ("https://w3id.org/workflowhub/workflow-ro-crate/1.0", "Workflow RO-Crate", "1.0"),
];

/// The document for a payload that holds everything but itself and the preview.
pub(super) fn document(
    content: &BundleContent,
    circumstance: &Circumstance,
    payload: &Tree,
    results: ResultsDigest,
    study: StudyDigest,
) -> Vec<u8> {
    let files: BTreeMap<&str, &[u8]> = payload
        .iter()
        .filter_map(|(path, bytes)| Some((path.strip_prefix(format::PAYLOAD)?, bytes.as_slice())))
        .collect();
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
    let context = json!([
        "https://w3id.org/ro/crate/1.1/context",
        {
            "Profile": "http://www.w3.org/ns/dx/prof/Profile",
            "environment": format!("{TERMS}environment"),
            "sha256": format!("{TERMS}sha256"),
        }
    ]);
    let document = json!({"@context": context, "@graph": entities});
    format!("{document:#}\n").into_bytes()
}

/// Identifiers of authors and of the organisations they belong to.
struct People {
    authors: Vec<String>,
    /// Name to identifier and web address.
    organizations: BTreeMap<String, (String, String)>,
}

/// The validator recommends an affiliation for every person; a manifest need not give one.
const UNAFFILIATED: &str = "No affiliation stated";

impl People {
    fn of(content: &BundleContent) -> Self {
        let mut organizations = BTreeMap::new();
        for author in &content.authors {
            let name = affiliation(author);
            let url = match (&author.affiliation_url, &author.affiliation) {
                (Some(url), _) => url.clone(),
                // The validator recommends an address for every organisation.
                (None, Some(name)) => {
                    format!("https://ror.org/search?query={}", percent_encoded(name))
                }
                (None, None) => format::HOME.to_owned(),
            };
            let id = format!("#organization-{}", organizations.len() + 1);
            organizations.entry(name.to_owned()).or_insert((id, url));
        }
        let authors: Vec<String> = content
            .authors
            .iter()
            .enumerate()
            .map(|(i, a)| a.orcid.clone().unwrap_or_else(|| format!("#author-{}", i + 1)))
            .collect();
        // A crate needs an author; a manifest may name none.
        let authors = if authors.is_empty() { vec!["#authors".to_owned()] } else { authors };
        Self { authors, organizations }
    }

    /// Who answers for the bundle.
    fn publisher(&self, content: &BundleContent) -> &str {
        let first = content.authors.first();
        first.map_or(&self.authors[0], |author| &self.organizations[affiliation(author)].0)
    }

    fn entities(&self, content: &BundleContent) -> Vec<Entity> {
        let mut entities = Vec::new();
        for (author, id) in content.authors.iter().zip(&self.authors) {
            let organization = &self.organizations[affiliation(author)].0;
            let person = Entity::new(id, &["Person"]).text("name", &author.name);
            entities.push(person.refer("affiliation", organization));
        }
        if content.authors.is_empty() {
            let name = format!("The authors of {}", content.name);
            let nobody = Entity::new("#authors", &["Organization"]).text("name", name);
            entities.push(nobody.text("url", format::HOME));
        }
        for (name, (id, url)) in &self.organizations {
            entities.push(Entity::new(id, &["Organization"]).text("name", name).text("url", url));
        }
        entities
    }
}

fn affiliation(author: &Author) -> &str {
    author.affiliation.as_deref().unwrap_or(UNAFFILIATED)
}

fn percent_encoded(text: &str) -> String {
    let encode = |b: u8| {
        if b.is_ascii_alphanumeric() { char::from(b).to_string() } else { format!("%{b:02X}") }
    };
    text.bytes().map(encode).collect()
}

struct Graph<'a> {
    content: &'a BundleContent,
    circumstance: &'a Circumstance,
    files: BTreeMap<&'a str, &'a [u8]>,
    people: People,
}

impl Graph<'_> {
    /// The metadata's own descriptor, the crate and what its identifiers mean.
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

    /// The manifest as a workflow of two steps, and the program that carries them out.
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
        let bytes = self.files.get(format::STUDY).copied().unwrap_or_default();
        let study = Entity::new(
            format::STUDY,
            &["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"],
        );
        vec![
            described(
                study,
                format::STUDY,
                bytes,
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

    /// What was done: the run, one action a condition, the analysis, and who had them done.
    fn actions(&self) -> Vec<Entity> {
        let (runner, simulate, analyze) = self.tools();
        let (content, circumstance) = (self.content, self.circumstance);
        let inputs: Vec<String> = self.inputs().into_iter().map(|i| i.path).collect();
        let outputs: Vec<String> = self.outputs().into_iter().map(|o| o.path).collect();
        let records: Vec<String> =
            content.conditions.iter().map(|c| format::records_path(&c.slug)).collect();
        let environment: Vec<String> =
            (1..=circumstance.environment.len()).map(|i| format!("#environment-{i}")).collect();
        let timed = |entity: Entity| {
            entity
                .refer("agent", &self.people.authors[0])
                .text("startTime", circumstance.started.iso())
                .text("endTime", circumstance.ended.iso())
        };
        let action = |id: &str, name: String, description: String, failed: usize, all: usize| {
            let status = if failed == 0 { "Completed" } else { "Failed" };
            let action = timed(Entity::new(id, &["CreateAction"]))
                .text("name", name)
                .text("description", description)
                .text("actionStatus", format!("http://schema.org/{status}ActionStatus"));
            action.with((failed > 0).then_some(failed), |action, failed| {
                action.text(
                    "error",
                    format!("{failed} of {all} trials failed; their records say how"),
                )
            })
        };
        let failed: usize = content.conditions.iter().map(|c| c.failed).sum();
        let all: usize = content.conditions.iter().map(|c| c.records.len()).sum();
        let trials: Vec<String> =
            content.conditions.iter().map(|c| format!("#condition-{}", c.slug)).collect();

        let mut entities = vec![
            action(
                "#run",
                format!("Run of {}", content.name),
                "reenact run study.yaml".into(),
                failed,
                all,
            )
            .refer("instrument", format::STUDY)
            .refer_all("object", inputs.iter().map(String::as_str).chain(["#seed"]))
            .refer_all("result", &outputs)
            .refer_all("environment", &environment),
        ];
        for (condition, id) in content.conditions.iter().zip(&trials) {
            let count = condition.records.len();
            let description =
                format!("{count} trials of {} with seed {}", condition.label, content.seed);
            let name = format!("Condition {}", condition.label);
            entities.push(
                action(id, name, description, condition.failed, count)
                    .refer("instrument", &simulate)
                    .refer_all("object", inputs.iter().map(String::as_str).chain(["#seed"]))
                    .refer("result", &format::records_path(&condition.slug)),
            );
        }
        entities.push(
            action(
                "#analysis",
                "Analysis of all trials".into(),
                "Tables, figures and verdicts from the records".into(),
                0,
                0,
            )
            .refer("instrument", &analyze)
            .refer_all("object", &records)
            .refer_all("result", &outputs),
        );
        entities.push(
            Entity::new("#control-trials", &["ControlAction"])
                .text("name", "Orchestrate the trials")
                .refer("instrument", "#step-trials")
                .refer_all("object", &trials),
        );
        entities.push(
            Entity::new("#control-analysis", &["ControlAction"])
                .text("name", "Orchestrate the analysis")
                .refer("instrument", "#step-analysis")
                .refer("object", "#analysis"),
        );
        entities.push(
            timed(Entity::new("#engine-run", &["OrganizeAction"]))
                .text("name", format!("Run of reenact {}", circumstance.version))
                .refer("instrument", &runner)
                .refer_all("object", ["#control-trials", "#control-analysis"])
                .refer("result", "#run"),
        );
        for ((name, value), id) in circumstance.environment.iter().zip(&environment) {
            entities.push(
                Entity::new(id, &["PropertyValue"])
                    .text("name", bag::one_line(name))
                    .text("value", bag::one_line(value)),
            );
        }
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
        for (&path, &bytes) in self.files.iter().filter(|(path, _)| **path != format::STUDY) {
            let (name, description) = title(path);
            let entity = described(Entity::new(path, &["File"]), path, bytes, &name, &description)
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

    /// Identifiers of the runner and its two tools.
    fn tools(&self) -> (String, String, String) {
        let (home, version) = (format::HOME, &self.circumstance.version);
        (
            format!("{home}#{version}"),
            format!("{home}/simulate#{version}"),
            format!("{home}/analyse#{version}"),
        )
    }

    fn inputs(&self) -> Vec<Parameter> {
        self.parameters_under(format::INPUTS, "input")
    }

    fn outputs(&self) -> Vec<Parameter> {
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
struct Parameter {
    path: String,
    parameter: String,
}

fn described(entity: Entity, path: &str, bytes: &[u8], name: &str, description: &str) -> Entity {
    entity
        .text("name", name)
        .text("description", description)
        .text("encodingFormat", format::media_type(path))
        .text("contentSize", bytes.len().to_string())
        .text("sha256", Sha256Digest::of(bytes).hex())
}

/// Name and description of a payload file.
fn title(path: &str) -> (String, String) {
    let last = path.rsplit('/').next().unwrap_or(path);
    let stem = last.split('.').next().unwrap_or(last);
    let (name, description): (String, String) = match path {
        format::RESOLVED => (
            "Resolved study".into(),
            "The manifest with every default and override, and the digest of every input".into(),
        ),
        format::README => ("Read me".into(), "How to check this bundle and run it again".into()),
        format::LICENSE => ("Licences".into(), "Which licence holds for what".into()),
        "results/trials.csv" => {
            ("Trials".into(), "One row a trial: factors, outcome, measures".into())
        }
        "results/series.csv" => {
            ("Curves".into(), "The trials' curves over coverage and time".into())
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
        _ if path.starts_with(format::TRIALS) => {
            (format!("Records of {stem}"), "One line of JSON a trial, in plan order".into())
        }
        _ => (last.into(), "A file that the study reads, as it was when the study ran".into()),
    };
    (name, description)
}

/// Identifier of a licence: its address, or a local one for words.
fn license_id(license: &str) -> String {
    license_address(license)
        .unwrap_or_else(|| format!("#license-{}", Sha256Digest::of(license).short()))
}

fn cite_id(cite: &super::Citation) -> String {
    cite.url.clone().unwrap_or_else(|| "#reproduced-work".to_owned())
}
