//! From an experiment to its trials, each with an identity that depends on nothing but what it means.

mod expand;
mod key;
mod resolved;
mod selection;

pub use expand::{FindError, Plan};
pub use key::{ENGINE_VERSION, engine_version, explain, key_content, study_digest};
pub use resolved::{ResolvedStudy, Start, StudyCondition, StudyInput};
pub use selection::{Dealt, Selection, SelectionError};
