//! How to cite the bundle and how to deposit it: `CITATION.cff` (Citation File Format 1.2.0) and `.zenodo.json` (the fields of
//! Zenodo's deposit schema), from what the manifest says of its authors, licence and the work it reproduces.

use super::{BundleContent, Circumstance, Person};
use crate::digest::ResultsDigest;
use crate::figure::svg::escape;
use serde_json::{Value, json};

const MESSAGE: &str =
    "If you use these data, please cite them as below, and the work that they reproduce.";

const KEYWORDS: [&str; 4] = ["robotics", "exploration", "reproducibility", "simulation"];

/// Written before a family name without being part of its sorting: `van`, `de la`.
const PARTICLES: [&str; 14] =
    ["af", "da", "de", "del", "della", "den", "der", "di", "du", "la", "ter", "van", "von", "zu"];

/// A name taken apart.
#[derive(Debug, PartialEq, Eq)]
enum Name<'a> {
    Person {
        given: String,
        particle: String,
        family: String,
    },
    /// An organisation or a group.
    Entity(&'a str),
}

impl<'a> Name<'a> {
    /// Splits `name` into its parts. `Family, Given` is taken as written; of `Given Family` the last word is the family
    /// name, with the lower-case particles before it. One word, or a name with an article, is a group.
    fn of(name: &'a str) -> Self {
        if let Some((family, given)) = name.split_once(',') {
            return Self::person(given.trim().to_owned(), family.trim());
        }
        let words: Vec<&str> = name.split_whitespace().collect();
        match words.as_slice() {
            ["The" | "the", ..] | [_] | [] => Self::Entity(name),
            [given @ .., family] => {
                let particles =
                    given.iter().rev().take_while(|word| PARTICLES.contains(word)).count();
                let (given, particles) = given.split_at(given.len() - particles);
                Self::Person {
                    given: given.join(" "),
                    particle: particles.join(" "),
                    family: (*family).to_owned(),
                }
            }
        }
    }

    fn person(given: String, family: &str) -> Self {
        let words: Vec<&str> = family.split_whitespace().collect();
        let particles = words.iter().take_while(|word| PARTICLES.contains(word)).count();
        let (particle, family) = words.split_at(particles.min(words.len().saturating_sub(1)));
        Self::Person { given, particle: particle.join(" "), family: family.join(" ") }
    }

    /// Returns the lines of an entry in a list of authors.
    fn lines(&self) -> Vec<String> {
        match self {
            Self::Entity(name) => vec![format!("name: {}", quoted(name))],
            Self::Person { given, particle, family } => {
                let fields =
                    [("family-names", family), ("name-particle", particle), ("given-names", given)];
                let told = fields.into_iter().filter(|(_, value)| !value.is_empty());
                told.map(|(key, value)| format!("{key}: {}", quoted(value))).collect()
            }
        }
    }

    /// Returns the name as Zenodo takes it: `Family, Given`.
    fn sorted(&self) -> String {
        match self {
            Self::Entity(name) => (*name).to_owned(),
            Self::Person { given, particle, family } => {
                let parts = [particle.as_str(), family.as_str()];
                let family: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
                let names = [family.join(" "), given.clone()];
                names.into_iter().filter(|name| !name.is_empty()).collect::<Vec<_>>().join(", ")
            }
        }
    }
}

/// Returns those who answer for the bundle: a manifest may name nobody.
fn authors(content: &BundleContent) -> Vec<Person> {
    if content.authors.is_empty() {
        let name = format!("The authors of {}", content.name);
        return vec![Person { name, ..Person::default() }];
    }
    content.authors.clone()
}

fn summary(content: &BundleContent) -> String {
    let partial = if content.partial { " Partial run: only some of the trials." } else { "" };
    format!("{}{partial}", content.description)
}

/// Writes `CITATION.cff`. Every value is quoted as JSON quotes it, which YAML reads alike.
pub(super) fn cff(
    content: &BundleContent,
    circumstance: &Circumstance,
    digest: ResultsDigest,
) -> String {
    let mut text = format!(
        "cff-version: 1.2.0\nmessage: {}\ntype: dataset\ntitle: {}\nabstract: {}\nversion: {}\ndate-released: {}\n",
        quoted(MESSAGE),
        quoted(&content.title),
        quoted(&summary(content)),
        quoted(&digest.short()),
        quoted(&circumstance.ended.date()),
    );
    if is_spdx(&content.license) {
        text.push_str(&format!("license: {}\n", quoted(&content.license)));
    } else if content.license.starts_with("https://") || content.license.starts_with("http://") {
        text.push_str(&format!("license-url: {}\n", quoted(&content.license)));
    }
    text.push_str("authors:\n");
    for author in authors(content) {
        let mut lines = Name::of(&author.name).lines();
        lines.extend(author.affiliation.map(|name| format!("affiliation: {}", quoted(&name))));
        lines.extend(author.orcid.map(|orcid| format!("orcid: {}", quoted(&orcid))));
        text.push_str(&entry(&lines, 2));
    }
    text.push_str(&format!("keywords: [{}]\n", KEYWORDS.map(quoted).join(", ")));
    text.push_str("identifiers:\n");
    text.push_str(&entry(
        &[
            "type: other".to_owned(),
            format!("value: {}", quoted(&format!("sha256:{digest}"))),
            format!(
                "description: {}",
                quoted(
                    "results digest: the same for everyone who runs the study with the same engine"
                )
            ),
        ],
        2,
    ));
    if let Some(cite) = &content.cite {
        let (names, title) = reference(&cite.text);
        text.push_str("references:\n");
        let mut lines = vec!["type: article".to_owned(), format!("title: {}", quoted(title))];
        let url = cite.url.as_deref();
        if let Some(doi) = url.and_then(doi) {
            lines.push(format!("doi: {}", quoted(doi)));
        } else if let Some(url) = url {
            lines.push(format!("url: {}", quoted(url)));
        }
        lines.push("authors:".to_owned());
        for name in names {
            let name = entry(&name.lines(), 2);
            lines.extend(name.lines().map(str::to_owned));
        }
        text.push_str(&entry(&lines, 2));
    }
    text
}

/// Writes `.zenodo.json`. The publication date is the day of the deposit, which Zenodo fills in.
pub(super) fn zenodo(content: &BundleContent, digest: ResultsDigest) -> Vec<u8> {
    let creators: Vec<Value> = authors(content)
        .into_iter()
        .map(|author| {
            let mut creator = json!({"name": Name::of(&author.name).sorted()});
            if let Some(affiliation) = author.affiliation {
                creator["affiliation"] = json!(affiliation);
            }
            if let Some(orcid) = author.orcid {
                creator["orcid"] = json!(orcid.rsplit('/').next().unwrap_or_default());
            }
            creator
        })
        .collect();
    let mut deposit = json!({
        "title": content.title,
        "upload_type": "dataset",
        "description": format!("<p>{}</p>", escape(&summary(content))),
        "creators": creators,
        "access_right": "open",
        "version": digest.short(),
        "keywords": KEYWORDS,
        "notes": format!("Results digest sha256:{digest}"),
    });
    if is_spdx(&content.license) {
        // Zenodo's vocabulary spells SPDX identifiers in lower case.
        deposit["license"] = json!(content.license.to_ascii_lowercase());
    }
    if let Some(cite) = &content.cite {
        deposit["references"] = json!([cite.text]);
        if let Some(url) = &cite.url {
            let (identifier, scheme) = doi(url).map_or((url.as_str(), "url"), |doi| (doi, "doi"));
            deposit["related_identifiers"] =
                json!([{"identifier": identifier, "scheme": scheme, "relation": "references"}]);
        }
    }
    format!("{deposit:#}\n").into_bytes()
}

fn doi(url: &str) -> Option<&str> {
    url.strip_prefix("https://doi.org/").filter(|doi| doi.starts_with("10."))
}

/// Returns whether `license` may be an SPDX identifier: neither an address nor words.
fn is_spdx(license: &str) -> bool {
    !license.is_empty() && license.bytes().all(|b| b.is_ascii_alphanumeric() || b"-.+".contains(&b))
}

/// Splits a reference into the authors at its beginning, each with initials before the family name, and the rest. Where
/// it does not begin so, the whole is the title.
fn reference(text: &str) -> (Vec<Name<'_>>, &str) {
    let (mut names, mut rest) = (Vec::new(), text);
    while let Some((part, after)) = rest.split_once(", ") {
        let words: Vec<&str> = part.split_whitespace().collect();
        let is_initial = |word: &&&str| word.len() <= 5 && word.ends_with('.');
        let initials = words.iter().take_while(is_initial).count();
        if initials == 0 || initials == words.len() {
            break;
        }
        let (given, family) = words.split_at(initials);
        names.push(Name::person(given.join(" "), &family.join(" ")));
        rest = after;
    }
    if names.is_empty() {
        return (vec![Name::Entity("Authors as the title says")], text);
    }
    (names, rest)
}

/// Writes `lines` as one entry of a list, indented by `depth`.
fn entry(lines: &[String], depth: usize) -> String {
    let indent = " ".repeat(depth);
    let line = |(i, line): (usize, &String)| {
        let mark = if i == 0 { "- " } else { "  " };
        format!("{indent}{mark}{line}\n")
    };
    lines.iter().enumerate().map(line).collect()
}

fn quoted(text: &str) -> String {
    json!(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use crate::bundle::seal;

    #[test]
    fn names_are_taken_apart_as_archives_want_them() {
        let sorted = |name: &str| Name::of(name).sorted();
        assert_eq!(sorted("Ada Lovelace"), "Lovelace, Ada");
        assert_eq!(sorted("J. L. Susa Rincon"), "Rincon, J. L. Susa");
        assert_eq!(sorted("Susa Rincon, J. L."), "Susa Rincon, J. L.");
        assert_eq!(sorted("Ludwig van Beethoven"), "van Beethoven, Ludwig");
        assert_eq!(sorted("The Reenact authors"), "The Reenact authors");
        assert_eq!(sorted("ROS"), "ROS");
        let lines = Name::of("Ludwig van Beethoven").lines();
        assert_eq!(
            lines,
            ["family-names: \"Beethoven\"", "name-particle: \"van\"", "given-names: \"Ludwig\""]
        );
    }

    #[test]
    fn a_references_authors_are_those_with_initials() {
        let (names, title) =
            reference("J. L. Susa Rincon, S. Carpin, Exploration, fast and slow, a journal, 2019");
        let names: Vec<String> = names.iter().map(Name::sorted).collect();
        assert_eq!(names, ["Susa Rincon, J. L.", "Carpin, S."]);
        assert_eq!(title, "Exploration, fast and slow, a journal, 2019");
        let (names, title) = reference("Exploration, 2019");
        assert_eq!(
            (names, title),
            (vec![Name::Entity("Authors as the title says")], "Exploration, 2019")
        );
    }

    #[test]
    fn a_bundle_says_how_to_cite_and_to_deposit_it() {
        let mut content = sample::content();
        content.authors[0].orcid = Some("https://orcid.org/0000-0002-1825-0097".into());
        let sealed = seal(&content, &sample::circumstance()).unwrap();
        let short = sealed.results_digest.short();
        let cff = String::from_utf8(sealed.tree["data/CITATION.cff"].clone()).unwrap();
        assert_eq!(
            cff,
            format!(
                "cff-version: 1.2.0
message: \"If you use these data, please cite them as below, and the work that they reproduce.\"
type: dataset
title: \"Corridors with and without a floor plan\"
abstract: \"A robot explores corridors, with and without a floor plan.\"
version: \"{short}\"
date-released: \"2026-01-15\"
license: \"CC-BY-4.0\"
authors:
  - family-names: \"Researcher\"
    given-names: \"A.\"
    affiliation: \"Example Robotics Lab\"
    orcid: \"https://orcid.org/0000-0002-1825-0097\"
keywords: [\"robotics\", \"exploration\", \"reproducibility\", \"simulation\"]
identifiers:
  - type: other
    value: \"sha256:{}\"
    description: \"results digest: the same for everyone who runs the study with the same engine\"
references:
  - type: article
    title: \"\\\"On corridors\\\", 2020\"
    doi: \"10.1000/182\"
    authors:
      - family-names: \"Author\"
        given-names: \"A.\"
",
                sealed.results_digest
            )
        );
        let zenodo: Value = serde_json::from_slice(&sealed.tree["data/.zenodo.json"]).unwrap();
        assert_eq!(
            zenodo,
            json!({
                "title": "Corridors with and without a floor plan",
                "upload_type": "dataset",
                "description": "<p>A robot explores corridors, with and without a floor plan.</p>",
                "creators": [{
                    "name": "Researcher, A.", "affiliation": "Example Robotics Lab", "orcid": "0000-0002-1825-0097"
                }],
                "access_right": "open",
                "version": short,
                "keywords": KEYWORDS,
                "notes": format!("Results digest sha256:{}", sealed.results_digest),
                "license": "cc-by-4.0",
                "references": ["A. Author, \"On corridors\", 2020"],
                "related_identifiers": [
                    {"identifier": "10.1000/182", "scheme": "doi", "relation": "references"}
                ],
            })
        );
        content.license = "words of our own".into();
        content.authors.clear();
        let sealed = seal(&content, &sample::circumstance()).unwrap();
        let cff = String::from_utf8(sealed.tree["data/CITATION.cff"].clone()).unwrap();
        assert!(!cff.contains("license"), "{cff}");
        assert!(cff.contains("authors:\n  - name: \"The authors of corridors\"\n"), "{cff}");
    }
}
