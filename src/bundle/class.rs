//! What each file of a bundle is: given by the author, derived from other files, or a circumstance of the run. The one table
//! that `docs/bundle-format.md` prints; a file in none of its rows is no bundle's.

use super::{Bundle, BundlePath, format, in_payload};
use crate::manifest::WrittenIn;

/// Whose word a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// The author's: another one makes another study, told apart by its digests. What else follows from it is derived.
    Given,
    /// Follows from other files; derived again at that level of `verify`, and refused there where it differs.
    Derived(u8),
    /// What the run says of its time and machine: held by checksums, and by nothing else.
    Circumstance,
}

impl Class {
    /// Returns the word for the class.
    pub fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Derived(_) => "derived",
            Self::Circumstance => "circumstance",
        }
    }
}

/// Which files a row of the table is about.
enum Which {
    /// The tag file of this name.
    Tag(&'static str),
    /// The file of this path within the payload.
    File(&'static str),
    /// All below this folder of the payload whose name ends like that.
    Under(&'static str, &'static str),
    /// Inputs that were made by this: `written-in` of the resolved study.
    Made(WrittenIn),
    /// The other inputs.
    Inputs,
    /// The table of verdicts at other values of the assumptions.
    Robustness,
    /// The table of verdicts at draws of all assumptions together.
    Multiverse,
}

/// A row: which files, what they are, and by what they are derived.
struct Row(Which, Class, &'static str);

/// The table. The first row that fits counts.
const TABLE: &[Row] = &[
    Row(Which::Tag(format::BAGIT), Class::Derived(1), "the standard's own words"),
    Row(
        Which::Tag(format::BAG_INFO),
        Class::Circumstance,
        "times and host as the run tells them; every other label follows from the payload (level 2), and the labels are a closed list",
    ),
    Row(Which::Tag(format::MANIFEST), Class::Derived(1), "the payload"),
    Row(Which::Tag(format::TAG_MANIFEST), Class::Derived(1), "the other tag files"),
    Row(
        Which::Tag(format::SIGNATURES[0]),
        Class::Given,
        "who vouches for the bundle; `verify --trust` checks it",
    ),
    Row(Which::Tag(format::SIGNATURES[1]), Class::Given, "the same, by minisign"),
    Row(Which::File(format::STUDY), Class::Given, "the manifest"),
    Row(Which::File(format::RESOLVED), Class::Derived(3), "manifest and inputs"),
    Row(
        Which::Robustness,
        Class::Derived(5),
        "runs at other values of the assumptions: rows that are drawn",
    ),
    Row(
        Which::Multiverse,
        Class::Derived(5),
        "runs at draws of all assumptions together: rows that are drawn",
    ),
    Row(
        Which::Made(WrittenIn::Calibration),
        Class::Derived(5),
        "passages of the calibration; the pairs already at level 3, from the passages",
    ),
    Row(
        Which::Made(WrittenIn::Inference),
        Class::Derived(5),
        "proposals of the inference whose draws are run; the draws already at level 3, from the proposals",
    ),
    Row(Which::Made(WrittenIn::PreviousMap), Class::Derived(5), "earlier explorations"),
    Row(Which::Inputs, Class::Given, "robots, worlds, images, settings, published tables"),
    Row(
        Which::Under(format::TRIALS, ".jsonl"),
        Class::Derived(5),
        "the trials; a sample of them at level 4",
    ),
    Row(Which::Under(format::RESULTS, ""), Class::Derived(3), "manifest, inputs and records"),
    Row(
        Which::Under(format::CIRCUMSTANCES, ""),
        Class::Circumstance,
        "wall times on the machine of the run, and verdicts on them",
    ),
    Row(
        Which::Under(format::ENGINE, ".zip"),
        Class::Derived(3),
        "this program's own source, where it is of the same version",
    ),
    Row(Which::File(format::INDEX), Class::Derived(3), "manifest, inputs and records"),
    Row(
        Which::File(format::README),
        Class::Derived(3),
        "manifest, inputs, records and circumstances",
    ),
    Row(Which::File(format::LICENSE), Class::Derived(3), "the manifest"),
    Row(Which::File(format::DATA_PACKAGE), Class::Derived(3), "manifest and records"),
    Row(Which::File(format::DICTIONARY), Class::Derived(3), "manifest and records"),
    Row(Which::File(format::CITATION), Class::Derived(3), "manifest, results and circumstances"),
    Row(Which::File(format::ZENODO), Class::Derived(3), "manifest and results"),
    Row(
        Which::File(format::METADATA),
        Class::Derived(3),
        "everything else in the payload, and circumstances",
    ),
    Row(Which::File(format::PREVIEW), Class::Derived(3), "the same"),
];

/// Returns the class of the file `path` of `bundle`; `None` where it has none and so does not belong there.
pub fn class_of(bundle: &Bundle, path: &str) -> Option<Class> {
    TABLE.iter().find(|Row(which, ..)| fits(which, bundle, path)).map(|Row(_, class, _)| *class)
}

/// Returns whether `path` is a tag file's, which can be said without the bundle.
pub fn is_tag_file(path: &str) -> bool {
    let is_it = |Row(which, ..): &Row| matches!(which, Which::Tag(name) if *name == path);
    TABLE.iter().any(is_it)
}

fn fits(which: &Which, bundle: &Bundle, path: &str) -> bool {
    let within = in_payload(path).unwrap_or_default();
    let input = bundle.resolved_input(within);
    match which {
        Which::Tag(name) => path == *name,
        Which::File(name) => within == *name,
        Which::Under(folder, ending) => within.starts_with(folder) && within.ends_with(ending),
        Which::Made(by) => input.is_some_and(|input| input.written_in == *by),
        Which::Robustness => {
            let named = bundle.resolved().sensitivity.read();
            input.is_some_and(|input| named.is_ok_and(|named| input.as_written == named))
        }
        Which::Multiverse => {
            let named = bundle.resolved().multiverse.read();
            input.is_some_and(|input| named.is_ok_and(|named| input.as_written == named))
        }
        Which::Inputs => bundle.inputs().iter().any(|input| input.path == within),
    }
}

/// Writes the table as `docs/bundle-format.md` prints it.
pub fn table_in_markdown() -> String {
    let mut text =
        "| file | class | level | from, or what it is |\n| --- | --- | --- | --- |\n".to_owned();
    for Row(which, class, from) in TABLE {
        let files = match which {
            Which::Tag(name) => format!("`{name}`"),
            Which::File(name) => format!("`{}`", BundlePath::payload(name)),
            Which::Under(folder, ending) => format!("`{}*{ending}`", BundlePath::payload(folder)),
            Which::Made(WrittenIn::Calibration) => {
                "`data/inputs/*.passages.csv`, `*.maneuvers.csv`".to_owned()
            }
            Which::Made(WrittenIn::Inference) => {
                "`data/inputs/*.proposals.jsonl`, `*.draws.csv`".to_owned()
            }
            Which::Made(_) => "`data/inputs/previous-map-*`".to_owned(),
            Which::Inputs => "other `data/inputs/*`".to_owned(),
            Which::Robustness => "the input that `sensitivity:` names".to_owned(),
            Which::Multiverse => "the input that `multiverse:` names".to_owned(),
        };
        let level = match class {
            Class::Derived(level) => level.to_string(),
            Class::Given => "-".to_owned(),
            Class::Circumstance => "not checked".to_owned(),
        };
        text.push_str(&format!("| {files} | {} | {level} | {from} |\n", class.name()));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::{Form, Limits, sample};
    use super::*;

    #[test]
    fn every_file_of_a_bundle_has_a_class_and_no_other_file_has() {
        let zip = sample::sealed().zip(Form::Bag);
        let bundle = Bundle::read(&zip, &Limits::default()).unwrap();
        for path in bundle.tree().keys() {
            assert!(class_of(&bundle, path).is_some(), "{path}");
        }
        for stray in ["install.sh", "data/install.sh", "data/inputs/more.yaml", "data/trials/x.sh"]
        {
            assert_eq!(class_of(&bundle, stray), None, "{stray}");
        }
        assert!(is_tag_file("bagit.txt") && !is_tag_file("manifest-md5.txt"));
        assert!(!is_tag_file("data/README.md"));
    }

    #[test]
    fn the_documentation_prints_the_table() {
        let docs = include_str!("../../docs/bundle-format.md");
        let table = table_in_markdown();
        assert!(docs.contains(&table), "docs/bundle-format.md must hold:\n{table}");
    }
}
