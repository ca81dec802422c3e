//! Bundles for programs that hold this library in their process: opened and refused as the commands do.

use super::args::LimitsArgs;
use super::checked;
use super::exit::{Exit, Failure};
use crate::bundle::{Bundle, Limits};
use crate::verify::Level;
use std::path::Path;

/// A bundle that was checked.
#[derive(Debug)]
pub struct Opened {
    /// What is in it.
    pub bundle: Bundle,
    /// What checking it found, on one line: `checked to level 3 (derived): the bundle is what it says`.
    pub checked: String,
    /// Whether it is what it says, as far as it was checked.
    pub holds: bool,
}

/// Why a bundle was not opened.
#[derive(Debug)]
pub struct Unopened {
    /// How a command would end.
    pub exit: Exit,
    /// What it would say, without colours.
    pub message: String,
}

impl From<Failure> for Unopened {
    fn from(failure: Failure) -> Self {
        let Failure { exit, message } = failure;
        // As `Terminal::failure` has it.
        let is_whole = message.contains('\n');
        let message = if is_whole { message } else { format!("error: {message}") };
        Self { exit, message: message.trim_end().to_owned() }
    }
}

/// Opens the bundle at `path` and checks it to `level`, which must be one that executes nothing: at most
/// [`Level::Derived`]. One that is not what it says is refused, unless it is wanted `unchecked`.
///
/// # Errors
/// What a command would say, and how it would end.
pub fn open(path: &Path, level: Level, unchecked: bool) -> Result<Opened, Unopened> {
    if level > Level::Derived {
        let message = format!(
            "a bundle is opened at level 0 to 3, found {}; `verify` executes trials again",
            level.number()
        );
        return Err(Failure::not_understood(message).into());
    }
    let limits = LimitsArgs { max_size: Limits::default().bytes };
    let found = checked::to_level(level, path, unchecked, limits);
    let checked::Checked { bundle, words, banner } = found.map_err(Failure::from)?;
    Ok(Opened { bundle, checked: words, holds: banner.is_none() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const PUBLISHED: &str = "artifacts/quickstart-published.zip";

    #[test]
    fn a_bundle_is_opened_with_what_checking_found() {
        let opened = open(Path::new(PUBLISHED), Level::Fixity, false).unwrap();
        assert!(opened.holds);
        assert_eq!(opened.checked, "checked to level 1 (fixity): the bundle is what it says");
        let (name, slug) = (opened.bundle.name(), &opened.bundle.conditions()[0].slug);
        assert_eq!((name, slug.as_str()), ("quickstart", "none"));
    }

    #[test]
    fn a_refusal_is_what_the_command_says() {
        let refused = |path, level| open(Path::new(path), level, false).unwrap_err();
        let missing = refused("artifacts/none.zip", Level::Derived);
        assert_eq!(missing.exit, Exit::NotUnderstood);
        assert_eq!(missing.message, "error: cannot read `artifacts/none.zip`: no such file");
        let broken = refused("Cargo.toml", Level::Derived);
        assert_eq!(broken.exit, Exit::No);
        assert!(
            broken.message.starts_with("error: Cargo.toml: the bundle is not what it says: "),
            "{}",
            broken.message
        );
        let deep = refused(PUBLISHED, Level::Full);
        assert_eq!(
            deep.message,
            "error: a bundle is opened at level 0 to 3, found 5; `verify` executes trials again"
        );
    }
}
