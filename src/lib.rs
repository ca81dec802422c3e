//! Reenact re-enacts published robot-exploration experiments, exactly.
//!
//! One manifest goes in; one sealed, checksummed bundle comes out. The pipeline has one type per
//! stage, each consuming the last:
//!
//! ```text
//! ManifestDoc -> Experiment -> Plan -> TrialSpec -> TrialRecord -> Table -> Verdict   (sealed in a Bundle)
//!  manifest/     manifest/     plan/   studies/      runner/        studies/  claims/
//! ```
//!
//! Modules are layered: a module imports lower layers only, and `tests/architecture.rs` enforces the
//! table in `docs/architecture.md`. The mind (mapping, navigation, strategies) sees sensor messages
//! only, never the simulator or the world.

// Layer 0: numbers, bytes and shapes.
pub mod condition;
pub mod digest;
pub mod document;
pub mod factor;
pub mod figure;
pub mod geometry;
pub mod grid;
pub mod json;
pub mod labels;
pub mod math;
pub mod rng;
pub mod stats;
pub mod table;
pub mod units;

// Layer 1: the described body, the described truth, and what is claimed of them.
pub mod claims;
pub mod robot;
pub mod world;

// Layer 2: the truth in motion, and the parts of a mind.
pub mod cmdp;
pub mod mapping;
pub mod navigation;
pub mod sim;

// Layer 3: the studies.
pub mod studies;

// Layers 4 and 5: what is asked, and the trials that follow.
pub mod manifest;
pub mod plan;

// Layer 6: running a plan, and sealing what came out.
pub mod bundle;
pub mod runner;

// Layer 7: checking a sealed bundle, and comparing it with another or with a lock.
pub mod compare;
pub mod verify;

// Layer 8: what people look at, and shards of a study put together.
pub mod merge;
pub mod report;

// The shell: files, clock, environment and the command line.
#[cfg(feature = "shell")]
pub mod cli;
#[cfg(feature = "shell")]
pub mod provenance;
#[cfg(feature = "shell")]
pub mod store;
