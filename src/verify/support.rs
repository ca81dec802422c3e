//! What to do about a bundle that another engine ran: which levels can be climbed here, and how to climb the rest.

use crate::bundle::{Bundle, BundlePath, Fault, format};

/// Creates the obstacle at level 3 of a bundle of an older format.
pub(super) fn other_format(bundle: &Bundle) -> Fault {
    let path = BundlePath::payload(format::RESOLVED);
    let ours = format!("bundle format {} or {}", format::WHOLE, format::FORMAT);
    Fault::new(path, ours, format!("bundle format {}", bundle.format())).hint(
        "levels 0 to 2 can be judged here; tables and descriptions followed from the records in another way then, so the rest \
         is for the program that sealed the bundle, or run its study.yaml again",
    )
}

/// Creates the obstacle at level 3 of a bundle of another engine, and says how to get past it.
pub(super) fn other_engine(bundle: &Bundle, ours: &str) -> Fault {
    let path = BundlePath::payload(format::RESOLVED);
    let fault = Fault::new(path, format!("engine {ours}"), format!("engine {}", bundle.engine()));
    let mut hint =
        "levels 0 to 2 can be judged here; the rest only by the engine that ran the study: "
            .to_owned();
    let version = bundle.circumstance().map(|told| told.version);
    match version {
        Some(version) => hint.push_str(&format!(
            "{}, then its own `reenact verify`",
            format::install_words(&version)
        )),
        None => hint.push_str("install the version of reenact that the bundle's README.md names"),
    }
    if let Some(capsule) = bundle.capsule() {
        hint.push_str(&format!(
            ", or, where none can be had, build the source sealed in {capsule} (read it first: it is a stranger's)"
        ));
    }
    fault.hint(hint)
}
