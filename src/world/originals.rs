//! The prior-knowledge study's own worlds, where a test finds them; they are not part of this repository.

use crate::document::Source;
use std::path::PathBuf;

/// Returns the folder named by `REENACT_ORIGINAL_WORLDS`; without it the test says that it is skipped.
#[expect(clippy::disallowed_methods, clippy::print_stderr, reason = "tests may ask and tell")]
pub(crate) fn folder(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("REENACT_ORIGINAL_WORLDS").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("skipped: {test} needs REENACT_ORIGINAL_WORLDS");
    }
    folder
}

/// Reads the text file at `path`.
pub(crate) fn source(path: &std::path::Path) -> Source {
    Source::new(path.to_string_lossy(), std::fs::read_to_string(path).unwrap())
}
