//! What every column of every CSV file says: `datapackage.json` for programs (Frictionless Data Package 1, Table Schema 1) and
//! `data-dictionary.md` for people, both made of the same descriptions.

use super::readme::license_address;
use super::{BundleContent, BundlePath, FileRef, Files, format};
use crate::digest::ResultsDigest;
use crate::table::{Column, DescribedTable, Kind};
use serde_json::{Map, Value, json};

/// Writes `datapackage.json` of a payload that holds the described files.
pub(super) fn package(
    content: &BundleContent,
    tables: &[DescribedTable],
    payload: Files<'_>,
    digest: ResultsDigest,
) -> Vec<u8> {
    let resources: Vec<Value> = tables
        .iter()
        .map(|table| {
            let path = BundlePath::payload(&table.path);
            resource(table, payload.get(&path).unwrap_or(FileRef::Held(&[])))
        })
        .collect();
    let mut package = json!({
        "profile": "tabular-data-package",
        "name": content.name,
        "id": format!("sha256:{digest}"),
        "title": content.title,
        "description": content.description,
        "version": digest.short(),
        "resources": resources,
    });
    if let Some(address) = license_address(&content.license) {
        package["licenses"] = json!([{"name": content.license, "path": address}]);
    }
    if let Some(cite) = &content.cite {
        let mut source = json!({"title": cite.text});
        if let Some(url) = &cite.url {
            source["path"] = json!(url);
        }
        package["sources"] = json!([source]);
    }
    let people: Vec<Value> = content
        .authors
        .iter()
        .map(|author| {
            let mut person = json!({"title": author.name, "role": "author"});
            if let Some(affiliation) = &author.affiliation {
                person["organization"] = json!(affiliation);
            }
            if let Some(orcid) = &author.orcid {
                person["path"] = json!(orcid);
            }
            person
        })
        .collect();
    if !people.is_empty() {
        package["contributors"] = json!(people);
    }
    format!("{package:#}\n").into_bytes()
}

/// Returns the name of the resource that a table in the file `path` is.
fn resource_name(path: &str) -> String {
    path.trim_end_matches(".csv").replace('/', "-").to_ascii_lowercase()
}

fn resource(table: &DescribedTable, file: FileRef<'_>) -> Value {
    let name = resource_name(&table.path);
    let fields: Vec<Value> = table.columns.iter().map(field).collect();
    let mut schema = json!({"fields": fields, "missingValues": [""]});
    if !table.key.is_empty() {
        schema["primaryKey"] = json!(table.key);
    }
    if let Some((column, path)) = &table.joins {
        let reference = json!({"resource": resource_name(path), "fields": column});
        schema["foreignKeys"] = json!([{"fields": column, "reference": reference}]);
    }
    json!({
        "profile": "tabular-data-resource",
        "name": name,
        "path": table.path,
        "title": table.title,
        "description": format!("One row is {}.", table.row),
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "bytes": file.size(),
        "hash": format!("sha256:{}", file.digest()),
        "schema": schema,
    })
}

fn field(column: &Column) -> Value {
    let mut field = Map::new();
    field.insert("name".to_owned(), json!(column.name));
    field.insert("type".to_owned(), json!(kind(column.kind)));
    field.insert("description".to_owned(), json!(in_a_sentence(column)));
    if !column.unit.is_empty() {
        field.insert("unit".to_owned(), json!(column.unit));
    }
    let mut constraints = Map::new();
    if column.empty.is_none() {
        constraints.insert("required".to_owned(), json!(true));
    }
    for (name, bound) in [("minimum", column.least), ("maximum", column.most)] {
        if let Some(bound) = bound {
            constraints.insert(name.to_owned(), number(column.kind, bound));
        }
    }
    if let Some(pattern) = column.pattern {
        constraints.insert("pattern".to_owned(), json!(pattern));
    }
    if !column.among.is_empty() {
        let values = column.among.iter().map(|value| typed(column.kind, value));
        constraints.insert("enum".to_owned(), values.collect());
    }
    if !constraints.is_empty() {
        field.insert("constraints".to_owned(), Value::Object(constraints));
    }
    Value::Object(field)
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Text => "string",
        Kind::Integer => "integer",
        Kind::Number => "number",
        Kind::Boolean => "boolean",
    }
}

fn number(kind: Kind, bound: f64) -> Value {
    #[expect(clippy::cast_possible_truncation, reason = "bounds of counts are small")]
    if kind == Kind::Integer { json!(bound as i64) } else { json!(bound) }
}

/// Returns `value` as a constraint holds it: JSON of its own type.
fn typed(kind: Kind, value: &str) -> Value {
    match kind {
        Kind::Text => json!(value),
        Kind::Integer => value.parse::<i64>().map_or_else(|_| json!(value), Value::from),
        Kind::Number => value.parse::<f64>().map_or_else(|_| json!(value), Value::from),
        Kind::Boolean => json!(value == "true"),
    }
}

fn in_a_sentence(column: &Column) -> String {
    let mut text = match column.meaning.as_str() {
        "" => "Not described".to_owned(),
        meaning => meaning.to_owned(),
    };
    text.push('.');
    if let Some(empty) = &column.empty {
        text.push_str(&format!(" Empty where {empty}."));
    }
    text
}

/// Writes `data-dictionary.md`.
pub(super) fn dictionary(content: &BundleContent, tables: &[DescribedTable]) -> String {
    let mut text = format!(
        "# Data dictionary: {}\n\nEvery column of every CSV file of this bundle; `{}` says the same for programs.\n\nThe files are \
         UTF-8 with commas, a header line and a point in decimals (RFC 4180). An empty field is a missing value. Times are simulated \
         unless a column says otherwise. Percentages go from 0 to 100.\n",
        content.title,
        format::DATA_PACKAGE
    );
    for table in tables {
        text.push_str(&format!(
            "\n## `{}`\n\n{}. One row is {}.",
            table.path, table.title, table.row
        ));
        if !table.key.is_empty() {
            text.push_str(&format!(" `{}` tells rows apart.", table.key.join("`, `")));
        }
        if let Some((column, path)) = &table.joins {
            text.push_str(&format!(" `{column}` joins it to `{path}`."));
        }
        text.push_str("\n\n| column | unit | type | range | meaning | empty where |\n| --- | --- | --- | --- | --- | --- |\n");
        for column in &table.columns {
            let meaning = if column.meaning.is_empty() { "not described" } else { &column.meaning };
            let cells = [
                format!("`{}`", column.name),
                column.unit.clone(),
                kind(column.kind).to_owned(),
                column.range(),
                meaning.to_owned(),
                column.empty.clone().unwrap_or_else(|| "never".to_owned()),
            ];
            text.push_str(&format!(
                "| {} |\n",
                cells.map(|cell| cell.replace('|', "\\|")).join(" | ")
            ));
        }
    }
    text
}
