//! Why the trials of a condition cannot begin.

use crate::world::topology::TagFault;
use thiserror::Error;

/// A condition without which no trial can begin is not met. Resolution refuses such manifests before, with better messages.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CannotBegin {
    /// Nothing to measure ranges with.
    #[error("the robot has no range scanner")]
    NoScanner,
    /// Nothing to see tags with.
    #[error("the robot has no logical camera")]
    NoCamera,
    /// Nothing to know directions by.
    #[error("the robot has no compass")]
    NoCompass,
    /// The tags of the world make no graph.
    #[error("{}", in_a_line(.0))]
    NoGraph(Vec<TagFault>),
}

fn in_a_line(faults: &[TagFault]) -> String {
    faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}
