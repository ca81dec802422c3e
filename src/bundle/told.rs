//! The circumstances of a run as the crate's metadata tells them: what `crate_metadata` wrote, read back, so that whoever
//! doubts a description can derive it again with or without the bag's own facts.

use super::{BundlePath, Circumstance, Moment, Tree, format};
use crate::json;
use serde_json::Value;

/// Returns the circumstances that the metadata in `tree` states, without the files that were measured; `None` where it
/// does not state them as this program writes them.
pub(super) fn circumstance(tree: &Tree) -> Option<Circumstance> {
    let bytes = tree.get(&*BundlePath::payload(format::METADATA))?;
    let document = json::read::<Value>(bytes).ok()?;
    let graph = document.get("@graph")?.as_array()?;
    let entity = |id: &str| graph.iter().find(|entity| entity["@id"] == id);
    let text = |entity: &Value, key: &str| entity.get(key)?.as_str().map(str::to_owned);
    let run = entity("#run")?;
    let engine = text(entity("#engine-run")?, "name")?;
    let version = engine.strip_prefix("Run of reenact ")?.to_owned();
    let moment = |key: &str| Moment::from_iso(&text(run, key)?);
    let environment = (1..)
        .map_while(|i| entity(&format!("#environment-{i}")))
        .map(|fact| Some((text(fact, "name")?, text(fact, "value")?)))
        .collect::<Option<Vec<_>>>()?;
    Some(Circumstance {
        version: Some(version).filter(|version| is_version(version))?,
        started: moment("startTime")?,
        ended: moment("endTime")?,
        environment,
        files: Vec::new(),
    })
}

/// Returns whether `text` can be a version and nothing else: a bundle's words end up in lines that people paste into a
/// shell.
pub fn is_version(text: &str) -> bool {
    text.len() <= 40
        && text.starts_with(|c: char| c.is_ascii_digit())
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || b"-.+".contains(&b))
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn circumstances_are_read_back_from_the_metadata() {
        let sealed = sample::sealed();
        let expected = Circumstance { files: Vec::new(), ..sample::circumstance() };
        assert_eq!(circumstance(&sealed.tree), Some(expected));
    }

    #[test]
    fn only_versions_are_put_into_a_command() {
        assert!(is_version("0.1.0") && is_version("12.3.4-rc.1+build"));
        for bad in ["", "latest", "1;rm", "1 2", "1`id`", "1$(id)", &"1".repeat(41)] {
            assert!(!is_version(bad), "{bad}");
        }
    }
}
