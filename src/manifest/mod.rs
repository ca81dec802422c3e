//! Manifests: one YAML file names everything of an experiment.
//!
//! `ManifestDoc` is what someone wrote; [`resolve`] takes it to an [`Experiment`], in which names are
//! references, defaults are written out and impossible combinations no longer exist, or to every fault it
//! has. Pure: files come through [`Inputs`].

mod choice;
mod claims;
mod crossing;
mod deadline;
mod document;
mod experiment;
mod faults;
mod figures;
mod inputs;
mod lint;
mod models;
mod overrides;
mod parameters;
mod pinned;
mod previous;
mod priors;
mod published;
mod readers;
mod resolve;
mod sensitivity;
mod settings;
mod worlds;

pub use choice::{By, Choice, DependentFactor, FactorDoc, Levels, Ordered};
pub use crossing::Factor;
pub use document::{
    Alpha, Author, BoundingBoxOf, Cite, DerivedFrom, FactorRef, FloorPlanOf, FootprintOf,
    GenerateDoc, GeneratedWorld, ManifestDoc, MapPrior, OriginDoc, OwnWorld, PoseDoc,
    PreviousMapDoc, PreviousMapOf, PriorDoc, PriorFrame, PublishedDoc, PublishedFile, SeedDoc,
    StartDoc, UnknownAs, WorldDoc, WorldFile,
};
pub use experiment::{
    Assumption, CalibrationRun, Experiment, Meanings, ResolvedCondition, Robustness,
};
pub use inputs::{Input, Inputs, Measured, WrittenIn};
pub use parameters::ParametersDoc;
pub use pinned::{PinnedDoc, PinnedFileDoc};
pub use previous::{explored, unexplored};
pub use resolve::resolve;

use crate::studies::StudyKind;

/// The JSON Schema (2020-12) of manifests: of one study, or of any.
pub fn schema(kind: Option<StudyKind>) -> serde_json::Value {
    let mut schema = crate::document::schema_of::<ManifestDoc>();
    if let Some(kind) = kind {
        schema["properties"]["parameters"] = parameters::schema_of(kind);
    }
    schema
}

#[cfg(test)]
mod tests;
