//! The forms of expectation: one file a form, with what is written, where it looks, what can be wrong with it, how it is judged,
//! and an example that is parsed, checked and judged by a test. A new form is a file and a line of [`Expect`].
//!
//! What several forms do alike stands in a file of its own: [`contrast`] (cell against cell), `difference`, `margin`,
//! [`condition`] (of one trial), `bounds`, `agreement` and `pairing` (with published numbers).

mod agreement;
mod bounds;
pub mod condition;
pub mod contrast;
mod declare;
mod difference;
mod form;
mod margin;
mod pairing;
mod scope;

pub mod between;
pub mod correlation;
pub mod equivalent;
pub mod every;
pub mod greater;
pub mod homogeneous;
pub mod less;
pub mod rank;
pub mod rate;
pub mod rmse;
pub mod share;
pub mod sign_test;
pub mod spread;
pub mod trend;
pub mod untestable;

pub(in crate::claims) use form::Form;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Makes [`Expect`] of the forms: meaning, name in manifests, variant, and the type that answers as a [`Form`].
macro_rules! forms {
    ($($(#[$doc:meta])* $name:literal => $Variant:ident($file:ident::$Type:ident),)*) => {
        /// A checkable expectation.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum Expect {
            $($(#[$doc])* #[serde(rename = $name)] $Variant($file::$Type),)*
        }

        impl Expect {
            /// Returns the form's name in manifests.
            pub fn form(&self) -> &'static str {
                match self {
                    $(Self::$Variant(_) => $name,)*
                }
            }

            pub(in crate::claims) fn as_form(&self) -> &dyn Form {
                match self {
                    $(Self::$Variant(form) => form,)*
                }
            }
        }

        /// Each form's name and the text of its file, which holds its example.
        #[cfg(test)]
        pub(in crate::claims) const FILES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!(stringify!($file), ".rs"))),)*];
    };
}

forms! {
    /// The first cell is lower.
    "less" => Less(less::Less),
    /// The first cell is higher.
    "greater" => Greater(greater::Greater),
    /// Two cells are equal within a margin.
    "equivalent" => Equivalent(equivalent::Equivalence),
    /// A cell lies between bounds.
    "between" => Between(between::Between),
    /// A metric rises or falls along scores.
    "trend" => Trend(trend::Trend),
    /// Cells are equal within a margin.
    "homogeneous" => Homogeneous(homogeneous::Homogeneity),
    /// Cells stand in an order.
    "rank" => Rank(rank::Ranking),
    /// One side is lower more often than not.
    "sign-test" => SignTest(sign_test::SignTest),
    /// Cells across a factor lie close together.
    "spread" => Spread(spread::Spread),
    /// A share of trials meets a condition.
    "share" => Share(share::Share),
    /// Every trial meets a condition.
    "every" => Every(every::Every),
    /// Of the same trials, one quantity is lower or higher than another.
    "rate" => Rate(rate::Rate),
    /// Our cells correlate with the published ones.
    "correlation-with-published" => CorrelationWithPublished(correlation::Correlation),
    /// Our cells lie near the published ones.
    "rmse-with-published" => RmseWithPublished(rmse::Rmse),
    /// Nothing that is run could decide it.
    "untestable" => Untestable(untestable::Untestable),
}

impl Expect {
    /// Returns the names of the metrics measured.
    pub fn metrics(&self) -> Vec<String> {
        self.as_form().scope().measured.into_iter().map(|(_, name)| name.to_owned()).collect()
    }

    /// Returns the name of the published table compared with, if there is one.
    pub fn published(&self) -> Option<&str> {
        self.as_form().scope().published
    }
}
