//! Manifests: one YAML file names everything of an experiment.
//!
//! `ManifestDoc` is what someone wrote; [`resolve`] takes it to an [`Experiment`], in which names are
//! references, defaults are written out and impossible combinations no longer exist, or to every fault it
//! has. Pure: files come through [`Inputs`].
//!
//! | room | holds |
//! |---|---|
//! | `document` `choice` `parameters` `pinned` `schema` | what someone wrote, and its JSON Schema |
//! | `faults` `names` | every fault once; factors, values and near misses |
//! | `library/` | every file read once, held against its pin, and what was made of it |
//! | `drawn` `used_world` | draws of a posterior; a world as a condition uses it |
//! | `resolver` | all these and the manifest: what the rooms below work with |
//! | `parts` `robots` `worlds` `models` | robot, world and start of a condition |
//! | `knowledge` `priors` `previous` | its prior knowledge |
//! | `nested` `calibration` `posterior` | other manifests that trials rest on: what they expect, which draws they are of |
//! | `lint` | what is wrong or suspicious about a condition |
//! | `numbers` `requests` `figures` `claims` `sensitivity` `multiverse` | what the paper prints, and what is asked of results |
//! | `infer` | what is not known, and the conditions that become proposals |
//! | `from_trials` | factors that are not known, and the table of means that their trials are held against |
//! | `observed` | parts of such tables, by name |
//! | `settings` `overrides` `crossing` | the manifest before its conditions, and those |
//! | `resolve` | the way through all of them, to an `experiment` |

mod asked;
mod calibration;
mod choice;
mod claims;
mod crossing;
mod document;
mod drawn;
mod experiment;
mod faults;
mod figures;
mod from_trials;
mod infer;
mod input;
mod knowledge;
mod labels;
mod library;
mod lint;
mod models;
mod multiverse;
mod names;
mod nested;
mod numbers;
mod observed;
mod overrides;
mod parameters;
mod parts;
mod pinned;
mod posterior;
mod previous;
mod priors;
mod readers;
mod requests;
mod resolve;
mod resolver;
mod robots;
mod schema;
mod sensitivity;
mod settings;
mod used_world;
mod worlds;

pub use choice::{By, Choice, DependentFactor, DrawsFactor, FactorDoc, Levels, Ordered};
pub use document::{
    Alpha, Author, BoundingBoxOf, ChoiceDoc, ChoicePriorDoc, Cite, DerivedFrom, FactorRef,
    FloorPlanOf, FootprintOf, FromTrialsDoc, GenerateDoc, GeneratedWorld, InferDoc, InferenceDoc,
    LeftOutDoc, ManifestDoc, MapPrior, OriginDoc, OwnWorld, PlaceDoc, PointDoc, PoseDoc,
    PreviousMapDoc, PreviousMapOf, PriorDoc, PriorFrame, PublishedDoc, PublishedFile, RobotDoc,
    RobotFile, SeedDoc, StartDoc, TopoMetricPrior, UnknownAs, WorldDoc, WorldFile,
};
pub use experiment::{
    Assumption, CalibrationRun, Experiment, InferenceRun, JointDraws, Meanings, ResolvedCondition,
    Robustness,
};
pub use input::{Input, InputKind, Nested, WrittenIn};
pub use library::{CalibrationTrials, InputError, Inputs, ProposalTrials};
pub use parameters::ParametersDoc;
pub use pinned::{PinnedDoc, PinnedFileDoc};
pub use previous::{ExploreError, explored, unexplored};
pub use resolve::resolve;
pub use schema::schema;

#[cfg(test)]
mod tests;
