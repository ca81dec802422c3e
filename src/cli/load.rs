//! Manifests and bundles from disk.

use super::args::{LimitsArgs, SelectArgs};
use super::calibrate::Calibrator;
use super::exit::Failure;
use super::terminal::Terminal;
use crate::bundle::archive::Archive;
use crate::bundle::{Resolved, format, names};
use crate::document::{Diagnostic, Severity, Source};
use crate::manifest::{
    self, CalibrationTrials, Experiment, InputError, Inputs, ProposalTrials, WrittenIn,
};
use crate::plan::{Plan, Selection};
use crate::store::{self, reason};
use crate::studies::TrialSpec;
use crate::verify::LONGEST_ATTESTATION;
use crate::world::mesh;
use std::collections::BTreeMap;
use std::io::{BufWriter, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Most bytes of a text that a command is given: a manifest, a lock, keys, a signature. No person writes as much.
const MOST_TEXT: u64 = 16 << 20;

/// Most bytes of any other input: those of the largest mesh or map.
pub(super) const MOST_INPUT: u64 = mesh::MAX_BYTES as u64;

/// A manifest that was understood.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) source: Source,
    pub(super) experiment: Experiment,
}

/// A manifest that was understood with its warnings, or all faults of one that was not.
pub(super) type Understood = Result<(Loaded, Vec<Diagnostic>), Vec<Diagnostic>>;

/// What the command line says of a manifest.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Given<'a> {
    /// Values to replace, as `PATH=VALUE`.
    pub(super) set: &'a [String],
    /// Folders from which files may be read that robots and worlds name by a path out of theirs.
    pub(super) allow: &'a [PathBuf],
}

impl Given<'_> {
    /// Returns whether `path` lies in a folder that is allowed, whichever links lead there.
    pub(super) fn allows(&self, path: &Path) -> bool {
        let Ok(real) = path.canonicalize() else { return false };
        let mut allowed = self.allow.iter().filter_map(|folder| folder.canonicalize().ok());
        allowed.any(|folder| real.starts_with(folder))
    }
}

/// Reads and resolves `manifest` as `given` changes it; every fault goes to stderr.
pub(super) fn manifest(
    manifest: &Path,
    given: Given<'_>,
    calibrator: Calibrator<'_>,
    terminal: Terminal,
) -> Result<Loaded, Failure> {
    let (found, mut faults) = match resolved(manifest, given, calibrator, terminal)? {
        Ok((loaded, warnings)) => (Some(loaded), warnings),
        Err(faults) => (None, faults),
    };
    faults.sort_by_key(|f| std::cmp::Reverse(f.severity));
    terminal.diagnostics(&faults);
    match found {
        Some(loaded) if faults.iter().all(|f| f.severity == Severity::Warning) => Ok(loaded),
        _ => Err(Failure::not_understood(format!(
            "{}: {}",
            manifest.display(),
            Terminal::count(&faults)
        ))),
    }
}

/// Reads and resolves `manifest` in the same way; its faults, or warnings, are returned and told nobody.
pub(super) fn resolved(
    manifest: &Path,
    given: Given<'_>,
    calibrator: Calibrator<'_>,
    terminal: Terminal,
) -> Result<Understood, Failure> {
    understood(text(manifest)?, manifest, given, calibrator, terminal)
}

/// Resolves a manifest that is about to be replaced in `manifest`; its faults go to stderr, warnings nowhere.
pub(super) fn draft(
    manifest: &Path,
    text: String,
    given: Given<'_>,
    terminal: Terminal,
) -> Result<Experiment, Failure> {
    let source = Source::new(manifest.display().to_string(), text);
    match understood(source, manifest, given, Calibrator::StandIn, terminal)? {
        Ok((loaded, _)) => Ok(loaded.experiment),
        Err(mut faults) => {
            faults.sort_by_key(|f| std::cmp::Reverse(f.severity));
            terminal.diagnostics(&faults);
            Err(Failure::not_understood(Terminal::count(&faults)))
        }
    }
}

fn understood(
    source: Source,
    manifest: &Path,
    given: Given<'_>,
    calibrator: Calibrator<'_>,
    terminal: Terminal,
) -> Result<Understood, Failure> {
    let folder = manifest.parent().unwrap_or(Path::new("")).to_owned();
    let sealed = sealed_beside(manifest, &folder)?;
    if !sealed.is_empty() {
        let inputs = folder.join(format::INPUTS);
        terminal.note(&format!("inputs are those that the bundle holds in `{}`", inputs.display()));
    }
    let folder = Folder { path: folder, sealed, given, calibrator, terminal };
    Ok(manifest::resolve(&source, given.set, &folder)
        .map(|(experiment, warnings)| (Loaded { source, experiment }, warnings)))
}

/// Returns the plan of an experiment, or the part of it that is wanted.
pub(super) fn plan(
    experiment: Experiment,
    select: &SelectArgs,
) -> Result<(Plan, Selection), Failure> {
    let selection = Selection::parse(&select.only, select.trials, select.shard.as_deref())
        .map_err(Failure::not_understood)?;
    let plan = if selection.is_partial() {
        Plan::select(experiment, &selection).map_err(Failure::not_understood)?
    } else {
        Plan::of(experiment)
    };
    Ok((plan, selection))
}

/// Opens a bundle or says why not: what is wrong with its content stays data.
pub(super) fn archive(
    path: &Path,
    limits: LimitsArgs,
) -> Result<Result<Archive, Vec<crate::bundle::Fault>>, Failure> {
    store::open_bundle(path, &limits.limits()).map_err(|e| unreadable(path, &e))
}

/// Reads a text file.
pub(super) fn text(path: &Path) -> Result<Source, Failure> {
    let bytes = text_bytes(path)?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        Failure::not_understood(format!(
            "cannot read `{}`: expected UTF-8 text, found byte {at} that is not",
            path.display()
        ))
    })?;
    Ok(Source::new(path.display().to_string(), text))
}

/// Reads what should be a short text.
pub(super) fn text_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    store::read(path, MOST_TEXT).map_err(|e| unreadable(path, &e))
}

/// Reads what should be an attestation: none is longer than that.
pub(super) fn attestation(path: &Path) -> Result<Vec<u8>, Failure> {
    store::read(path, LONGEST_ATTESTATION).map_err(|e| unreadable(path, &e))
}

/// Reads a file.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    store::read(path, MOST_INPUT).map_err(|e| unreadable(path, &e))
}

/// Writes a file that the user named.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_with(path, |out| out.write_all(bytes))
}

/// Writes a file that the user named piece by piece.
pub(super) fn write_with(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut std::fs::File>) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let name = path.file_name().and_then(|n| n.to_str()).ok_or_else(|| {
        Failure::not_understood(format!("`{}` is no name for a file", path.display()))
    })?;
    store::publish(folder, name, write).map(drop).map_err(|e| unwritten(path, &e))
}

/// Returns a folder as it may be shown: where none is named, it is this one.
pub(super) fn shown(folder: &Path) -> String {
    match folder.display().to_string() {
        empty if empty.is_empty() => ".".to_owned(),
        name => name,
    }
}

/// Creates the failure of a file that cannot be written.
pub(super) fn unwritten(path: &Path, error: &std::io::Error) -> Failure {
    Failure::failed(format!("cannot write `{}`: {}", path.display(), reason(error)))
}

/// Returns a place beside what is to be written in `folder`, for what does not fit into memory.
pub(super) fn scratch(folder: &Path) -> store::DiskScratch {
    store::DiskScratch::in_folder(folder)
}

/// Creates the failure of a file that cannot be read: a missing one is the user's fault; anything else is ours.
fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    let message = format!("cannot read `{}`: {}", path.display(), reason(error));
    match error.kind() {
        ErrorKind::NotFound
        | ErrorKind::IsADirectory
        | ErrorKind::PermissionDenied
        | ErrorKind::InvalidInput
        | ErrorKind::FileTooLarge => Failure::not_understood(message),
        _ => Failure::failed(message),
    }
}

/// Returns the inputs of an unpacked bundle whose manifest this is, by the path that it names each by; none for other
/// manifests.
fn sealed_beside(manifest: &Path, folder: &Path) -> Result<BTreeMap<String, PathBuf>, Failure> {
    let resolved = folder.join(format::RESOLVED);
    if manifest.file_name().is_none_or(|name| name != format::STUDY) || !resolved.exists() {
        return Ok(BTreeMap::new());
    }
    let fault = |found: String| {
        Failure::not_understood(format!("`{}` cannot be read: {found}", resolved.display()))
    };
    let read = Resolved::read(&bytes(&resolved)?).map_err(|f| fault(f.to_string()))?;
    let sealed =
        read.inputs.into_iter().map(|input| match input.path.strip_prefix(format::INPUTS) {
            Some(name) if names::hazard(name).is_none() => {
                Ok((input.as_written, folder.join(&input.path)))
            }
            _ => Err(fault(format!(
                "expected an input in `{}`, found `{}`",
                format::INPUTS,
                input.path
            ))),
        });
    sealed.collect()
}

/// Why a file that a manifest names cannot be read.
#[derive(Debug, thiserror::Error)]
enum Unread {
    #[error("{}", reason(.0))]
    Beside(std::io::Error),
    #[error("{}, neither here nor beside the manifest", reason(.0))]
    Anywhere(std::io::Error),
}

/// Inputs of a manifest in this folder.
struct Folder<'a> {
    path: PathBuf,
    /// Where the inputs of an unpacked bundle are.
    sealed: BTreeMap<String, PathBuf>,
    given: Given<'a>,
    calibrator: Calibrator<'a>,
    terminal: Terminal,
}

impl Inputs for Folder<'_> {
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, InputError> {
        let beside = self.path.join(as_written);
        let beside = self.sealed.get(as_written).unwrap_or(&beside);
        let read = |path: &Path| store::read(path, MOST_INPUT);
        match written_in {
            WrittenIn::Manifest
            | WrittenIn::Calibration
            | WrittenIn::Inference
            | WrittenIn::PreviousMap => read(beside).map_err(Unread::Beside),
            // Given on the command line: from here, as a shell completes it, or else from the manifest.
            WrittenIn::CommandLine => read(Path::new(as_written))
                .or_else(|here| read(beside).map_err(|_| Unread::Anywhere(here))),
        }
        .map_err(InputError::other)
    }

    fn follows(&self, as_written: &str, written_in: WrittenIn) -> bool {
        let here = written_in == WrittenIn::CommandLine && self.given.allows(Path::new(as_written));
        here || self.sealed.contains_key(as_written)
            || self.given.allows(&self.path.join(as_written))
    }

    fn calibrate(
        &self,
        calibration: &Experiment,
        _: &str,
    ) -> Result<CalibrationTrials, InputError> {
        self.calibrator.trials(calibration, self.terminal).map_err(InputError::other)
    }

    fn propose(&self, inference: &Experiment, _: &str) -> Result<ProposalTrials, InputError> {
        self.calibrator.proposals(inference, self.terminal).map_err(InputError::other)
    }

    fn explore(
        &self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], InputError> {
        Ok(self.calibrator.map(spec, sealed_as)?)
    }
}
