//! Manifests: one YAML file names everything of an experiment.
//!
//! `ManifestDoc` is what someone wrote; [`resolve`] takes it to an [`Experiment`], in which names are
//! references, defaults are written out and impossible combinations no longer exist, or to every fault it
//! has. Pure: files come through [`Inputs`].

mod choice;
mod claims;
mod crossing;
mod document;
mod experiment;
mod faults;
mod inputs;
mod lint;
mod overrides;
mod parameters;
mod priors;
mod published;
mod readers;
mod resolve;
mod worlds;

pub use choice::{By, Choice, DependentFactor, FactorDoc, Levels, Ordered};
pub use claims::check_claims;
pub use crossing::Factor;
pub use document::{
    Alpha, Author, BoundingBoxOf, Cite, DerivedFrom, FloorPlanOf, FootprintOf, ManifestDoc,
    MapPrior, OriginDoc, OwnWorld, PoseDoc, PriorDoc, PriorFrame, PublishedDoc, PublishedFile,
    StartDoc, UnknownAs, WorldDoc,
};
pub use experiment::{Assumption, Experiment, Meanings};
pub use inputs::{Input, Inputs, WrittenIn};
pub use parameters::ParametersDoc;
pub use resolve::resolve;

/// The JSON Schema (2020-12) of manifests.
pub fn schema() -> serde_json::Value {
    crate::document::schema_of::<ManifestDoc>()
}

#[cfg(test)]
mod tests;
