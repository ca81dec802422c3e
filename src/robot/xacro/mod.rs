//! Xacro: the macros in which robots' descriptions are written, expanded without ROS, without Python and without looking at
//! the machine.
//!
//! | file | does |
//! |---|---|
//! | `tree` | a file as elements that may be copied, each with where it is written |
//! | `expand` `macros` `scope` | walks through it: properties, macros, conditions, includes |
//! | `text` `substitute` | `${}` and `$()` in texts |
//! | `expression` `evaluate` `functions` `value` | what stands in `${}`: the part of Python that descriptions use |
//! | `write` | the expanded text, and where each element of it came from |
//!
//! The names are those of <https://github.com/ros/xacro/wiki>; macros see what their callers see, and properties are worked
//! out when they are first used, as there. What is not read: `xacro:element`, `xacro:attribute`, includes with a namespace,
//! `load_yaml`, and `$()` beyond `arg`, `find`, `eval`, `optenv`, `env`, `dirname` and `anon`. The environment is never
//! asked: `optenv` is its default.

mod evaluate;
mod expand;
mod expression;
mod functions;
mod macros;
mod scope;
mod substitute;
mod text;
mod tree;
mod value;
mod write;

pub(super) use substitute::how_to_give;
pub(super) use write::Expanded;

use super::files::{FilePath, Files, Places};
use crate::document::{Diagnostic, Source};
use expand::Expander;
use std::collections::BTreeMap;

/// Returns whether `source` is to be expanded: it declares or uses xacro, and something is left of it.
pub(super) fn is_unexpanded(source: &Source) -> bool {
    let text = &*source.text;
    let declares = text.contains("xmlns:xacro") || text.contains("<xacro:");
    declares && (text.contains("<xacro:") || text.contains("${") || text.contains("$("))
}

/// Expands `source` and puts the elements of the files `added` at its end.
///
/// # Errors
/// What cannot be expanded, or what makes a file no XML.
pub(super) fn expand(
    source: &Source,
    added: &[(FilePath, Source)],
    arguments: &BTreeMap<String, String>,
    places: &Places<'_>,
    files: &mut dyn Files,
) -> Result<Expanded, Vec<Diagnostic>> {
    let mut expander = Expander::new(places, arguments, files);
    // What was left out may be why something else is missing.
    let told = |expander: &mut Expander<'_>, faults: Vec<Diagnostic>| {
        let warnings = std::mem::take(&mut expander.warnings);
        faults.into_iter().chain(warnings).collect::<Vec<_>>()
    };
    let (root, mut nodes) = match expander.file(source, places.own.clone()) {
        Ok(expanded) => expanded,
        Err(faults) => return Err(told(&mut expander, faults)),
    };
    for (path, source) in added {
        match expander.file(source, path.clone()) {
            Ok((_, more)) => nodes.extend(more),
            Err(faults) => return Err(told(&mut expander, faults)),
        }
    }
    let name = expander.written(root.attribute("name").unwrap_or_default(), &root.origin);
    let name = name.map_err(|stop| vec![*stop])?;
    let mut warnings = std::mem::take(&mut expander.warnings);
    if expander.environment > 0 {
        let count = match expander.environment {
            1 => "a value of the robot comes".to_owned(),
            many => format!("{many} values of the robot come"),
        };
        let message = format!("{count} from environment variables, which are not read");
        let fault = root.origin.fault(message).label("their defaults are taken").warning();
        warnings.push(fault.help("give others as `robot: {file, arguments: {VARIABLE: VALUE}}`"));
    }
    write::write(source, &root, &name, &nodes, warnings)
}

#[cfg(test)]
mod tests;
