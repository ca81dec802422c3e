//! A requested figure, drawn, and told in words for those who cannot see it.

use super::{FactorValue, Findings, Setup};
use crate::condition::Condition;
use crate::figure::svg;
use crate::table::Table;
use std::collections::BTreeMap;

/// A figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The file.
    pub svg: String,
    /// How to read it, in a sentence or two.
    pub caption: &'static str,
    /// What it shows, for those who cannot see it: its kind, its title, its extremes.
    pub alt: String,
    /// What is drawn, in its units.
    pub data: Table,
}

impl Drawn {
    /// Makes the figure `title` of this `kind`, which `caption` says how to read; `words` say what it shows, as far as
    /// its title does not say it.
    pub(super) fn new(
        (kind, title): (&str, &str),
        svg: String,
        words: String,
        caption: &'static str,
        data: Table,
    ) -> Self {
        let alt = [format!("{kind}: {title}"), words];
        let alt = alt.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(". ");
        Self { svg, caption, alt, data }
    }
}

impl<'a> Findings<'a> {
    /// Returns the first condition of the design that has all values of `only`; `None` where the design leaves that combination
    /// out.
    pub(super) fn first(
        &self,
        only: &BTreeMap<String, FactorValue>,
    ) -> Option<(&'a Condition, &'a Setup)> {
        let admits = |condition: &Condition| {
            only.iter().all(|(factor, value)| condition.value(factor) == Some(&value.0))
        };
        self.design.iter().copied().find(|(condition, _)| admits(condition))
    }
}

/// What is said in place of a drawing of a condition that there is not.
pub(super) const NO_CONDITION: &str = "no condition of the design has these values";

/// Draws `words`, where nothing can be drawn.
pub(super) fn words_alone(title: &str, words: &str) -> String {
    let text = svg::Element::new("text").at("x", 10.0).at("y", 24.0).text(words);
    svg::document(320.0, 36.0, title, [text])
}
