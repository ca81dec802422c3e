//! Who made the study and whom they belong to, as an RO-Crate names them.

use super::crate_entities::Entity;
use super::{BundleContent, Person, format};
use std::collections::BTreeMap;

/// Identifiers of authors and of the organisations they belong to.
pub(super) struct People {
    /// Identifiers of the authors, at least one.
    pub(super) authors: Vec<String>,
    /// Name to identifier and web address.
    organizations: BTreeMap<String, (String, String)>,
}

/// The validator recommends an affiliation for every person; a manifest need not give one.
const UNAFFILIATED: &str = "No affiliation stated";

impl People {
    pub(super) fn of(content: &BundleContent) -> Self {
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

    /// Returns the identifier of who answers for the bundle.
    pub(super) fn publisher(&self, content: &BundleContent) -> &str {
        let first = content.authors.first();
        first.map_or(&self.authors[0], |author| &self.organizations[affiliation(author)].0)
    }

    pub(super) fn entities(&self, content: &BundleContent) -> Vec<Entity> {
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

fn affiliation(author: &Person) -> &str {
    author.affiliation.as_deref().unwrap_or(UNAFFILIATED)
}

fn percent_encoded(text: &str) -> String {
    let encode = |b: u8| {
        if b.is_ascii_alphanumeric() { char::from(b).to_string() } else { format!("%{b:02X}") }
    };
    text.bytes().map(encode).collect()
}
