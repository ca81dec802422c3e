//! `untestable`: nothing that this manifest runs could decide it, for the reason given. The claim stands among the
//! others, so that nobody takes it for overlooked; its verdict is `cannot-be-tested`.
//!
//! ```yaml
//! id: P22
//! says: >-
//!   The performance improvement ... is more evident in the real world, which is inherently more complex
//!   and noisy, than in simulations
//! paper-table: silent
//! expect: {untestable: {because: there is no real world in a simulation}}
//! ```

use super::form::Form;
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft};
use crate::claims::terms::Terms;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `untestable`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Untestable {
    /// Why nothing that is run could decide the claim.
    pub because: String,
}

impl Form for Untestable {
    fn terms(&self) -> Terms {
        Terms::default()
    }

    fn scope(&self) -> Scope<'_> {
        Scope::nothing()
    }

    fn needs_metric(&self) -> bool {
        false
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        faults.unless(!self.because.trim().is_empty(), "/because", || {
            "expected the reason".to_owned()
        });
    }

    fn judge(&self, _: &Bench<'_>) -> Vec<Draft> {
        vec![Draft::untestable("this study".to_owned(), CannotTest::Stated(self.because.clone()))]
    }
}
