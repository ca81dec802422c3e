//! The bag's tag files (RFC 8493): written in one form, read in every harmless one.

use super::{Circumstance, Fault, FileRef, Files, Limits, format, names};
use crate::digest::{ResultsDigest, Sha256Digest, StudyDigest};

/// The declaration.
pub const DECLARATION: &str = "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n";

/// The label that names the program that bagged.
pub(crate) const AGENT: &str = "Bag-Software-Agent";
/// The label of the identifier that is made of the manifest's digest.
pub(crate) const IDENTIFIER: &str = "External-Identifier";

/// Writes the manifest lines of `files`, in their order.
pub(super) fn manifest<'a>(files: impl Iterator<Item = (&'a String, FileRef<'a>)>) -> String {
    let mut text = String::new();
    for (path, file) in files {
        text.push_str(&format!("{}  {path}\n", file.digest()));
    }
    text
}

/// Reads a manifest. Upper-case digits, ` *` before the path and CRLF are other tools' habits, and harmless.
///
/// # Errors
/// Every line that is not a digest and a safe path, and every path named twice.
pub fn parse_manifest(file: &str, bytes: &[u8]) -> Result<Vec<(String, Sha256Digest)>, Vec<Fault>> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        vec![Fault::new(file, "UTF-8 text", format!("a byte that is not at {}", e.valid_up_to()))]
    })?;
    let (mut entries, mut faults) = (Vec::new(), Vec::new());
    let mut seen = names::Names::default();
    let most = Limits::default().entries;
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.is_empty()) {
        if entries.len() + faults.len() >= most {
            return Err(vec![Fault::new(file, format!("at most {most} lines"), "more")]);
        }
        let place = format!("{file}:{}", number + 1);
        let entry = line.split_at_checked(64).and_then(|(digest, rest)| {
            let path = rest.strip_prefix("  ").or_else(|| rest.strip_prefix(" *"))?;
            Some((path.to_owned(), Sha256Digest::from_hex(digest)?))
        });
        let Some((path, digest)) = entry else {
            faults.push(Fault::new(place, "64 hex digits, two spaces and a path", excerpt(line)));
            continue;
        };
        if let Some(hazard) = names::hazard(&path) {
            faults.push(Fault::new(place, "a safe relative path", hazard));
        } else if let Some(other) = seen.enter(&path) {
            faults.push(Fault::new(place, "every path once", format!("`{path}` beside `{other}`")));
        } else {
            entries.push((path, digest));
        }
    }
    if faults.is_empty() { Ok(entries) } else { Err(faults) }
}

/// Returns the first characters of a line that may be long or hostile, quoted.
fn excerpt(line: &str) -> String {
    let start: String = line.chars().take(40).collect();
    format!("`{}`", start.escape_default())
}

/// Lines of `bag-info.txt` that are read; it has a dozen.
const MOST_LINES: usize = 10_000;
/// Labels of `bag-info.txt` that are told as none of its own.
const MOST_LABELS: usize = 20;
/// Labels that tell when and where the run was.
const CIRCUMSTANCES: [&str; 4] = ["Bagging-Date", "Run-Ended", "Run-Environment", "Run-Started"];

/// The labels of `bag-info.txt` in the order written; a label may stand several times.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct BagInfo(pub Vec<(String, String)>);

impl BagInfo {
    /// Returns the labels that this program writes; without circumstances where it bags a payload whose bag was lost.
    pub(crate) fn of(
        payload: Files<'_>,
        version: u64,
        circumstance: Option<&Circumstance>,
        results: ResultsDigest,
        study: StudyDigest,
        partial: bool,
        uuid: &str,
    ) -> Self {
        let octets: u64 = payload.iter().map(|(_, file)| file.size()).sum();
        let program = circumstance.map_or(format::VERSION, |c| c.version.as_str());
        let mut labels = vec![
            (AGENT, format!("reenact {program} <{}>", format::HOME)),
            ("Bundle-Format", version.to_string()),
            (IDENTIFIER, format!("urn:uuid:{uuid}")),
            ("Partial", partial.to_string()),
            ("Payload-Oxum", format!("{octets}.{}", payload.len())),
            ("Results-Digest", format!("sha256:{results}")),
            ("Study-Digest", format!("sha256:{study}")),
        ];
        if let Some(circumstance) = circumstance {
            labels.push(("Bagging-Date", circumstance.ended.date()));
            labels.push(("Run-Ended", circumstance.ended.iso()));
            labels.push(("Run-Started", circumstance.started.iso()));
        }
        labels.sort_unstable();
        for (name, value) in circumstance.iter().flat_map(|c| &c.environment) {
            labels.push(("Run-Environment", one_line(&format!("{name}={value}"))));
        }
        Self(labels.into_iter().map(|(label, value)| (label.to_owned(), value)).collect())
    }

    /// Replaces the value of `label`.
    pub(crate) fn set(&mut self, label: &str, value: &str) {
        for (_, known) in self.0.iter_mut().filter(|(known, _)| known == label) {
            value.clone_into(known);
        }
    }

    pub(super) fn to_text(&self) -> String {
        let mut text = String::new();
        for (label, value) in &self.0 {
            text.push_str(&format!("{label}: {value}\n"));
        }
        text
    }

    /// Reads the file; lines that begin with white space continue the last value.
    pub fn parse(bytes: &[u8]) -> Self {
        let mut labels: Vec<(String, String)> = Vec::new();
        for line in String::from_utf8_lossy(bytes).lines().take(MOST_LINES) {
            match (line.split_once(':'), labels.last_mut()) {
                (_, Some((_, value))) if line.starts_with([' ', '\t']) => {
                    value.push(' ');
                    value.push_str(line.trim());
                }
                (Some((label, value)), _) => {
                    labels.push((label.trim().to_owned(), value.trim().to_owned()));
                }
                (None, _) => {}
            }
        }
        Self(labels)
    }

    /// Returns the first value of `label`.
    pub fn get(&self, label: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == label).map(|(_, value)| value.as_str())
    }

    /// Returns what is wrong with the labels, given those that are `right`: each of them must stand as often as there,
    /// and no other. Whether the `version` of the program that bagged matters is left to the caller, for another
    /// program may bag a lost crate again.
    pub(crate) fn faults(&self, right: &Self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let values = |info: &Self, label: &str| -> Vec<String> {
            info.0.iter().filter(|(l, _)| l == label).map(|(_, value)| value.clone()).collect()
        };
        let mut labels: Vec<&str> = right.0.iter().map(|(label, _)| label.as_str()).collect();
        labels.dedup();
        for label in labels {
            let (expected, found) = (values(right, label), values(self, label));
            // Said twice, readers differ in which they believe.
            if expected != found {
                let shown = |values: &[String]| match values {
                    [] => "nothing".to_owned(),
                    values => values.join(", then "),
                };
                let expected = format!("{label}: {}", shown(&expected));
                let fault = Fault::new(format::BAG_INFO, expected, shown(&found));
                let is_format = label == "Bundle-Format";
                faults.push(if is_format { fault.hint(format::NO_FORMAT_HINT) } else { fault });
            }
        }
        let mut others: Vec<&str> = self.0.iter().map(|(label, _)| label.as_str()).collect();
        others.retain(|label| !right.0.iter().any(|(known, _)| known == label));
        others.dedup();
        for label in others.into_iter().take(MOST_LABELS) {
            let expected =
                "only labels that follow from the run (docs/bundle-format.md lists them)";
            let found = excerpt(&format!("{label}: {}", self.get(label).unwrap_or_default()));
            faults.push(Fault::new(format::BAG_INFO, expected, found));
        }
        faults
    }

    /// Returns whether the labels say when or where the run was.
    pub(crate) fn tells_circumstances(&self) -> bool {
        self.0.iter().any(|(label, _)| CIRCUMSTANCES.contains(&label.as_str()))
    }

    /// Takes over what `info` says of when and where the run was.
    pub(crate) fn keep_circumstances(&mut self, info: &Self) {
        let told = info.0.iter().filter(|(label, _)| CIRCUMSTANCES.contains(&label.as_str()));
        self.0.extend(told.take(MOST_LABELS).cloned());
    }
}

/// Writes `text` on one line: control characters would begin another label.
pub(super) fn one_line(text: &str) -> String {
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    line.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::{LargeFiles, Moment, Tree};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn manifests_of_other_tools_are_read_and_faulty_lines_named() {
        let hex = "a".repeat(64);
        let text = format!("{}  data/x\r\n{hex} *data/y\n", hex.to_uppercase());
        let entries = parse_manifest("m", text.as_bytes()).unwrap();
        assert_eq!(entries.iter().map(|e| e.0.as_str()).collect::<Vec<_>>(), ["data/x", "data/y"]);

        let text = format!("{hex}  data/x\n{hex}  ../x\nnothing\n{hex}  data/X\n");
        let faults = parse_manifest("m", text.as_bytes()).unwrap_err();
        let faults: Vec<_> = faults.iter().map(ToString::to_string).collect();
        let expected = [
            "m:2: expected a safe relative path, found a path that climbs out of its folder",
            "m:3: expected 64 hex digits, two spaces and a path, found `nothing`",
            "m:4: expected every path once, found `data/X` beside `data/x`",
        ];
        assert_eq!(faults, expected);
    }

    #[test]
    fn circumstances_survive_the_bag() {
        let circumstance = Circumstance {
            version: "0.1.0".into(),
            started: Moment(5),
            ended: Moment(9),
            environment: vec![("host".into(), "a=b\nPartial: true".into())],
            files: Vec::new(),
        };
        let (results, study) = (Sha256Digest::of("r"), Sha256Digest::of("s"));
        let info = BagInfo::of(
            Files { tree: &Tree::new(), large: &LargeFiles::new() },
            format::WHOLE,
            Some(&circumstance),
            ResultsDigest(results),
            StudyDigest(study),
            false,
            "u",
        );
        let back = BagInfo::parse(info.to_text().as_bytes());
        assert_eq!(back, info);
        assert_eq!(back.get("Partial"), Some("false"), "a value cannot smuggle a label in");
        assert_eq!(back.get("Run-Environment"), Some("host=a=b Partial: true"));
        assert_eq!(back.faults(&info), []);
        let mut more = info.to_text();
        more.push_str("Partial: true\nSource-Organization: ACM Artifact Evaluation\n");
        let more = more.replace("Run-Ended: 1970-01-01T00:00:09+00:00\n", "");
        let told = BagInfo::parse(more.as_bytes()).faults(&info);
        let told: Vec<String> = told.iter().map(ToString::to_string).collect();
        let expected = [
            "bag-info.txt: expected Partial: false, found false, then true",
            "bag-info.txt: expected Run-Ended: 1970-01-01T00:00:09+00:00, found nothing",
            "bag-info.txt: expected only labels that follow from the run (docs/bundle-format.md lists them), found \
             `Source-Organization: ACM Artifact Evalua`",
        ];
        assert_eq!(told, expected);
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = parse_manifest("m", &bytes);
            let _ = BagInfo::parse(&bytes).faults(&BagInfo::default());
        }
    }
}
