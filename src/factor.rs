//! A factor of a design.

use serde::{Deserialize, Serialize};

/// A factor with all values it takes anywhere, in the order written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Factor {
    /// Its name.
    pub name: String,
    /// Its values.
    pub values: Vec<String>,
}

impl Factor {
    /// Creates a factor of these values.
    pub fn new<T: Into<String>>(
        name: impl Into<String>,
        values: impl IntoIterator<Item = T>,
    ) -> Self {
        Self { name: name.into(), values: values.into_iter().map(Into::into).collect() }
    }
}
