//! The format's version and the names of its files (`docs/bundle-format.md`).

use super::Fault;

/// Version of the layout and of everything that is derived in it; what this program writes, and the newest it reads. Engine and
/// format together say every byte that follows from manifest, inputs, records and circumstances: whoever changes a table, a
/// figure or a description raises it.
pub const FORMAT: u64 = IN_PARTS;

/// The version of bundles of which each condition's records are one file. What fits is written so.
pub const WHOLE: u64 = 4;

/// The version of bundles of which some condition's records go on in further files ([`records_part`]), and which have no table of
/// the curves that are in them. Everything else is as in [`WHOLE`].
pub const IN_PARTS: u64 = 5;

/// Most bytes of a file of records, unless one record alone has more: what a person's tools still open.
pub const PART: u64 = 16 << 20;

/// The oldest that this program reads: up to level 2, as it derives nothing the way that was done before [`WHOLE`].
pub const OLDEST: u64 = 1;

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Where the program can be found; the root of the identifiers in the crate's metadata.
pub const HOME: &str = "https://crates.io/crates/reenact";

/// The bag's declaration.
pub const BAGIT: &str = "bagit.txt";
/// Facts about the bag: format version, digests and the circumstances of the run.
pub const BAG_INFO: &str = "bag-info.txt";
/// Digests of the payload.
pub const MANIFEST: &str = "manifest-sha256.txt";
/// Digests of the other tag files; its own digest is the bundle's id.
pub const TAG_MANIFEST: &str = "tagmanifest-sha256.txt";
/// Detached signatures of [`TAG_MANIFEST`]: the only files a bag may hold unlisted.
pub const SIGNATURES: [&str; 2] = ["tagmanifest-sha256.txt.sig", "tagmanifest-sha256.txt.minisig"];

/// Name of the fact of a run's environment that says how many trials it executed itself; the others came from a store.
pub const SIMULATED_TRIALS: &str = "trials-simulated";
/// Fact of a bundle that was merged: of how many shards.
pub const MERGED_SHARDS: &str = "shards-merged";

/// The crate's metadata. This and what follows is relative to the payload, where [`super::BundlePath`] leads.
pub const METADATA: &str = "ro-crate-metadata.json";
/// The crate's page for people.
pub const PREVIEW: &str = "ro-crate-preview.html";
/// The page that says what was found, for whoever opens the folder.
pub const INDEX: &str = "index.html";
/// How to check the bundle and run it again.
pub const README: &str = "README.md";
/// Under which licences the bundle may be shared.
pub const LICENSE: &str = "LICENSE.txt";
/// What every column of every CSV file says, for programs.
pub const DATA_PACKAGE: &str = "datapackage.json";
/// The same for people.
pub const DICTIONARY: &str = "data-dictionary.md";
/// How to cite the bundle.
pub const CITATION: &str = "CITATION.cff";
/// What Zenodo asks of a deposit.
pub const ZENODO: &str = ".zenodo.json";
/// The manifest, byte for byte as its author wrote it.
pub const STUDY: &str = "study.yaml";
/// The manifest with everything resolved.
pub const RESOLVED: &str = "study.resolved.json";
/// Robots, worlds, priors, scripts.
pub const INPUTS: &str = "inputs/";
/// Trial records, one file a condition.
pub const TRIALS: &str = "trials/";
/// Tables, figures and verdicts.
pub const RESULTS: &str = "results/";

/// What the machine of the run measured, and verdicts on it. Not part of the result half.
pub const CIRCUMSTANCES: &str = "circumstances/";

/// The engine's own source, where the bundle holds it.
pub const ENGINE: &str = "engine/";

/// The line that installs the program from the root of a checkout of its source. No registry has it.
pub const INSTALL: &str = "cargo install --path . --locked";

/// Says in words where and how to install the program of `version`.
pub fn install_words(version: &str) -> String {
    format!("in a checkout of the source of reenact {version}, `{INSTALL}`")
}

/// Returns the path of a condition's records, relative to the payload.
pub fn records_path(slug: &str) -> String {
    format!("{TRIALS}{slug}.jsonl")
}

/// Returns the path of the part `number`, from 1, of a condition's records. A slug has as many underscores as any other slug of its
/// bundle, so that no part is called like another condition.
pub fn records_part(slug: &str, number: usize) -> String {
    match number {
        0 | 1 => records_path(slug),
        number => format!("{TRIALS}{slug}_part-{number:04}.jsonl"),
    }
}

/// Says what to do about a bundle of the newer format `found`.
pub fn newer_format_hint(found: u64) -> String {
    format!(
        "this is reenact {VERSION}, which reads formats 1 to {FORMAT}; install the version named after \
         `Bag-Software-Agent` in {BAG_INFO} (or any newer one) to read format {found}"
    )
}

/// What to do about a bundle that does not say its format.
pub const NO_FORMAT_HINT: &str = "every release writes its format's number: ask the author for the bundle as `reenact run` \
                                  sealed it";

/// Checks that this program reads format `found`, which the file `path` states.
///
/// # Errors
/// Where it is newer, or older than the first.
pub(super) fn check(path: &str, found: u64) -> Result<(), Fault> {
    let wrong = |expected: String| Fault::new(path, expected, format!("bundle format {found}"));
    if found > FORMAT {
        Err(wrong(format!("bundle format {FORMAT} or older")).hint(newer_format_hint(found)))
    } else if found < OLDEST {
        Err(wrong(format!("bundle format {OLDEST} to {FORMAT}")).hint(
            "no release wrote that format: ask the author for the bundle as `reenact run` sealed it, or run its study.yaml \
             again",
        ))
    } else {
        Ok(())
    }
}

/// Returns the media type that archives expect for `path`, by its extension.
pub fn media_type(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "yaml" | "yml" | "cff" => "application/yaml",
        "urdf" | "sdf" | "world" | "xml" | "xacro" => "application/xml",
        "pgm" => "image/x-portable-graymap",
        "png" => "image/png",
        "csv" => "text/csv",
        "svg" => "image/svg+xml",
        "json" => "application/json",
        "jsonl" => "application/jsonl",
        "md" => "text/markdown",
        "txt" => "text/plain",
        "html" => "text/html",
        "stl" => "model/stl",
        "dae" => "model/vnd.collada+xml",
        "obj" => "model/obj",
        "zip" => "application/zip",
        _ => "application/octet-stream",
    }
}
