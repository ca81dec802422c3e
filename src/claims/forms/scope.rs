//! What a form looks at: metrics, and trials in selections and pools.

use crate::claims::cells::{ForEach, Values, Where};
use std::collections::BTreeMap;

/// A value for each factor that a form is repeated over.
type Pins = BTreeMap<String, String>;

/// What a form looks at. Pointers are JSON pointers from the form: `/than/where`.
pub(in crate::claims) struct Scope<'a> {
    /// The metrics measured, each with the pointer to where it is named.
    pub(in crate::claims) measured: Vec<(String, &'a str)>,
    /// The name of the published table compared with, if there is one.
    pub(in crate::claims) published: Option<&'a str>,
    /// Every selection of trials that is named, with the pointer to it.
    pub(in crate::claims) selections: Vec<(String, &'a Where)>,
    /// Makes the pools, and only where somebody asks: their number is the product of all that a manifest lists.
    pub(super) pools: Box<dyn Fn() -> Vec<Where> + 'a>,
}

impl<'a> Scope<'a> {
    /// Returns the scope of a form that no trial can judge.
    pub(super) fn nothing() -> Self {
        Self {
            measured: Vec::new(),
            published: None,
            selections: Vec::new(),
            pools: Box::new(Vec::new),
        }
    }

    /// Returns the scope of a form that names selections, and looks at `pools` once for each combination of `for_each`.
    pub(super) fn repeated<P: IntoIterator<Item = Where>>(
        measured: Vec<(String, &'a str)>,
        named: impl IntoIterator<Item = (&'static str, &'a Where)>,
        for_each: &'a ForEach,
        pools: impl Fn(&Pins) -> P + 'a,
    ) -> Self {
        let selections = for_each.after(named);
        let pools = Box::new(move || for_each.pools(&pools));
        Self { measured, published: None, selections, pools }
    }

    /// Returns the scope of a form that looks at one cell.
    pub(super) fn cell(
        measured: Vec<(String, &'a str)>,
        cell: &'a Where,
        for_each: &'a ForEach,
    ) -> Self {
        Self::repeated(measured, [("/where", cell)], for_each, |pins| [cell.pinned(pins)])
    }

    /// Returns the scope of a form that holds one cell against another.
    pub(super) fn two_cells(
        metric: &'a Values,
        named: [(&'static str, &'a Where); 2],
        for_each: &'a ForEach,
    ) -> Self {
        Self::repeated(metric.as_metrics(), named, for_each, move |pins| {
            named.map(|(_, cell)| cell.pinned(pins))
        })
    }

    /// Returns the scope of a form that looks at the cells `across` factors.
    pub(super) fn across(
        metric: &'a Values,
        cell: &'a Where,
        across: &'a Where,
        for_each: &'a ForEach,
    ) -> Self {
        let named = [("/where", cell), ("/across", across)];
        Self::repeated(metric.as_metrics(), named, for_each, |pins| {
            [cell.pinned(pins).replaced(across)]
        })
    }

    /// Returns the scope of a form for which a published table says which trials it looks at.
    pub(super) fn published(
        metric: &'a Values,
        table: &'a str,
        selections: Vec<(String, &'a Where)>,
    ) -> Self {
        Self {
            measured: metric.as_metrics(),
            published: Some(table),
            selections,
            pools: Box::new(|| vec![Where::default()]),
        }
    }

    /// Returns the pools of trials that the form looks at: trials outside of them cannot matter. `plan --power` makes up no
    /// others.
    pub(in crate::claims) fn pools(&self) -> Vec<Where> {
        (self.pools)()
    }
}
