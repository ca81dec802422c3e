//! What to do about a bundle that another engine ran: which levels can be climbed here, and how to climb the rest.

use crate::bundle::{Bundle, Fault, format};

/// The obstacle at level 3, with the way around it.
pub(super) fn other_engine(bundle: &Bundle, ours: &str) -> Fault {
    let path = format!("{}{}", format::PAYLOAD, format::RESOLVED);
    let fault = Fault::new(path, format!("engine {ours}"), format!("engine {}", bundle.engine()));
    let mut hint =
        "levels 0 to 2 can be judged here; the rest only by the engine that ran the study: "
            .to_owned();
    let version = bundle.circumstance().map(|told| told.version).filter(|v| is_version(v));
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

/// Whether `text` can be a version and nothing else: a bundle's words end up in a line that people paste into a shell.
fn is_version(text: &str) -> bool {
    text.len() <= 40
        && text.starts_with(|c: char| c.is_ascii_digit())
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || b"-.+".contains(&b))
}

#[cfg(test)]
mod tests {
    use super::is_version;

    #[test]
    fn only_versions_are_put_into_a_command() {
        assert!(is_version("0.1.0") && is_version("12.3.4-rc.1+build"));
        for bad in ["", "latest", "1;rm", "1 2", "1`id`", "1$(id)", &"1".repeat(41)] {
            assert!(!is_version(bad), "{bad}");
        }
    }
}
