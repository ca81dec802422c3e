//! What a form looks at: metrics, published tables, and which trials.

use super::Expect;
use super::cells::{ForEach, Values, Where};
use std::collections::BTreeMap;

impl Expect {
    /// The names of the metrics measured.
    pub fn metrics(&self) -> Vec<String> {
        self.measured().into_iter().map(|(_, name)| name.to_owned()).collect()
    }

    /// The metrics measured, each with the pointer from the form to where it is named.
    pub(crate) fn measured(&self) -> Vec<(String, &str)> {
        fn listed(metric: &Values) -> Vec<(String, &str)> {
            let names = metric.0.iter().enumerate();
            names.map(|(i, name)| (format!("/metric/{i}"), name.as_str())).collect()
        }
        match self {
            Self::Less(f) | Self::Greater(f) => listed(&f.metric),
            Self::Equivalent(f) => listed(&f.metric),
            Self::Between(f) => listed(&f.metric),
            Self::Trend(f) => listed(&f.metric),
            Self::Homogeneous(f) => listed(&f.metric),
            Self::Rank(f) => listed(&f.metric),
            Self::SignTest(f) => listed(&f.metric),
            Self::Spread(f) => listed(&f.metric),
            Self::Share(f) => vec![("/that/metric".to_owned(), &f.that.metric)],
            Self::Every(f) => vec![("/that/metric".to_owned(), &f.that.metric)],
            Self::Rate(f) => {
                let named = [
                    ("/of/metric", Some(&f.of.metric)),
                    ("/of/per", f.of.per.as_ref()),
                    ("/than/metric", Some(&f.than.metric)),
                    ("/than/per", f.than.per.as_ref()),
                ];
                let there = named.into_iter().filter_map(|(path, name)| Some((path, name?)));
                there.map(|(path, name)| (path.to_owned(), name.as_str())).collect()
            }
            Self::CorrelationWithPublished(f) => listed(&f.metric),
            Self::RmseWithPublished(f) => listed(&f.metric),
            Self::Untestable(_) => Vec::new(),
        }
    }

    /// The published table compared with, if any.
    pub fn published(&self) -> Option<&str> {
        match self {
            Self::CorrelationWithPublished(f) => Some(&f.published),
            Self::RmseWithPublished(f) => Some(&f.published),
            _ => None,
        }
    }

    /// The pools of trials that the form looks at, together: trials outside of them cannot matter.
    pub(crate) fn pools(&self) -> Vec<Where> {
        let each = |for_each: &ForEach, cells: &dyn Fn(&BTreeMap<String, String>) -> Vec<Where>| {
            for_each.combinations().iter().flat_map(cells).collect()
        };
        match self {
            Self::Less(f) | Self::Greater(f) => {
                each(&f.for_each, &|pins| vec![f.r#where.pinned(pins), f.than.r#where.pinned(pins)])
            }
            Self::Equivalent(f) => {
                each(&f.for_each, &|pins| vec![f.r#where.pinned(pins), f.to.r#where.pinned(pins)])
            }
            Self::Between(f) => each(&f.for_each, &|pins| {
                f.relative_to.iter().chain([&f.r#where]).map(|cell| cell.pinned(pins)).collect()
            }),
            Self::Trend(f) => each(&f.for_each, &|pins| {
                let base = f.r#where.pinned(pins);
                f.along.iter().map(|step| base.replaced(&step.r#where)).collect()
            }),
            Self::Homogeneous(f) => {
                each(&f.for_each, &|pins| vec![f.r#where.pinned(pins).replaced(&f.across)])
            }
            Self::Rank(f) => {
                each(&f.for_each, &|pins| vec![f.r#where.pinned(pins).replaced(&f.across)])
            }
            Self::SignTest(f) => {
                each(&f.for_each, &|pins| vec![f.r#where.pinned(pins), f.than.pinned(pins)])
            }
            Self::Spread(f) => each(&f.for_each, &|pins| {
                let base = f.r#where.pinned(pins);
                let other = f.than.iter().map(|than| base.replaced(than));
                other.chain([base.clone()]).map(|cell| cell.replaced(&f.across)).collect()
            }),
            Self::Share(f) => each(&f.for_each, &|pins| vec![f.r#where.pinned(pins)]),
            Self::Every(f) => each(&f.for_each, &|pins| vec![f.r#where.pinned(pins)]),
            Self::Rate(f) => each(&f.for_each, &|pins| vec![f.r#where.pinned(pins)]),
            // Which cells are compared is for the published table to say.
            Self::CorrelationWithPublished(_) | Self::RmseWithPublished(_) => {
                vec![Where::default()]
            }
            Self::Untestable(_) => Vec::new(),
        }
    }

    /// Every selection of trials the form names, with the pointer to it from the form.
    pub(crate) fn selections(&self) -> Vec<(String, &Where)> {
        let mut all: Vec<(String, &Where)> = Vec::new();
        let mut add = |path: &str, cell| all.push((path.to_owned(), cell));
        let mut repeated = None;
        match self {
            Self::Less(f) | Self::Greater(f) => {
                add("/where", &f.r#where);
                add("/than/where", &f.than.r#where);
                repeated = Some(&f.for_each);
            }
            Self::Equivalent(f) => {
                add("/where", &f.r#where);
                add("/to/where", &f.to.r#where);
                repeated = Some(&f.for_each);
            }
            Self::Between(f) => {
                add("/where", &f.r#where);
                f.relative_to.iter().for_each(|cell| add("/relative-to", cell));
                repeated = Some(&f.for_each);
            }
            Self::Trend(f) => {
                add("/where", &f.r#where);
                for (i, step) in f.along.iter().enumerate() {
                    add(&format!("/along/{i}/where"), &step.r#where);
                }
                repeated = Some(&f.for_each);
            }
            Self::Homogeneous(f) => {
                add("/where", &f.r#where);
                add("/across", &f.across);
                repeated = Some(&f.for_each);
            }
            Self::Rank(f) => {
                add("/where", &f.r#where);
                add("/across", &f.across);
                repeated = Some(&f.for_each);
            }
            Self::SignTest(f) => {
                add("/where", &f.r#where);
                add("/than", &f.than);
                repeated = Some(&f.for_each);
            }
            Self::Spread(f) => {
                add("/where", &f.r#where);
                add("/across", &f.across);
                f.than.iter().for_each(|cell| add("/than", cell));
                repeated = Some(&f.for_each);
            }
            Self::Share(f) => {
                add("/where", &f.r#where);
                repeated = Some(&f.for_each);
            }
            Self::Every(f) => {
                add("/where", &f.r#where);
                repeated = Some(&f.for_each);
            }
            Self::Rate(f) => {
                add("/where", &f.r#where);
                repeated = Some(&f.for_each);
            }
            Self::CorrelationWithPublished(f) => {
                add("/where", &f.r#where);
                f.ratio_to.iter().for_each(|cell| add("/ratio-to", cell));
            }
            Self::RmseWithPublished(f) => {
                add("/where", &f.r#where);
                f.ratio_to.iter().for_each(|cell| add("/ratio-to", cell));
            }
            Self::Untestable(_) => {}
        }
        for (i, cell) in repeated.iter().flat_map(|each| &each.0).enumerate() {
            all.push((format!("/for-each/{i}"), cell));
        }
        all
    }
}
