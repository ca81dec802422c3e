//! Which file names a bundle may hold: those that every system, tool and archive format spells alike.

use std::collections::BTreeMap;

/// Names that Windows gives to devices, whatever their extension.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// Returns why it would be unsafe to unpack a file called `path` (relative, `/` between parts); `None` where it is
/// safe.
pub fn hazard(path: &str) -> Option<&'static str> {
    if path.chars().any(char::is_control) {
        return Some("a control character in its name");
    }
    if path.contains('\\') {
        return Some("a backslash in its name");
    }
    if path.starts_with('/') {
        return Some("an absolute path");
    }
    if path.contains(':') {
        return Some("a drive letter or a colon in its name");
    }
    path.split('/').find_map(|part| {
        let stem = part.split('.').next().unwrap_or_default().to_ascii_lowercase();
        let numbered = |prefix: &str| {
            stem.strip_prefix(prefix)
                .is_some_and(|n| n.len() == 1 && n.as_bytes()[0].is_ascii_digit())
        };
        match part {
            "" => Some("an empty part in its path"),
            "." | ".." => Some("a path that climbs out of its folder"),
            _ if part.ends_with(['.', ' ']) => Some("a name that ends in a dot or a space"),
            _ if DEVICES.contains(&stem.as_str()) || numbered("com") || numbered("lpt") => {
                Some("the name of a Windows device")
            }
            _ => None,
        }
    })
}

/// Returns whether every character of `path` is one that `BagIt` tools, RO-Crate identifiers, shells and file systems
/// agree on. This leaves no room for two Unicode spellings of one name.
pub fn is_portable(path: &str) -> bool {
    path.bytes().all(|b| b.is_ascii_alphanumeric() || b"._-/".contains(&b))
}

/// Names seen so far, to notice those that some file system would take for one another.
#[derive(Debug, Default)]
pub struct Names {
    seen: BTreeMap<String, (String, bool)>,
}

impl Names {
    /// Enters the file `path` (or the folder, where it ends in `/`) and the folders above it; the name it clashes with,
    /// if it does.
    pub fn enter(&mut self, path: &str) -> Option<String> {
        let folders = path.match_indices('/').map(|(i, _)| (&path[..i], true));
        let file = (!path.ends_with('/')).then_some((path, false));
        for (name, is_folder) in folders.chain(file) {
            let entry = (name.to_owned(), is_folder);
            // Full case folding only matters outside ASCII, where `is_portable` refuses the name anyway.
            match self.seen.get(&name.to_lowercase()) {
                Some(known) if *known == entry && is_folder => {}
                Some((other, _)) => return Some(other.clone()),
                None => {
                    self.seen.insert(name.to_lowercase(), entry);
                }
            }
        }
        None
    }

    /// Returns how many files and folders were entered.
    pub fn len(&self) -> usize {
        self.seen.len()
    }

    /// Returns whether nothing was entered.
    pub fn is_empty(&self) -> bool {
        self.seen.is_empty()
    }
}

/// Makes a portable file name for something called `as_written` elsewhere: the last part of its path, every character
/// that is not portable replaced by a hyphen.
pub fn portable(as_written: &str) -> String {
    let last = as_written.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or("input");
    let name: String = last
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '-' })
        .collect();
    // Leading dots hide files or climb; trailing dots vanish on Windows.
    let name = name.trim_matches('.');
    let name = if name.is_empty() { "input" } else { name };
    if hazard(name).is_some() { format!("input-{name}") } else { name.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn hazards_are_named() {
        for (path, expected) in [
            ("data/x\n", "a control character in its name"),
            ("data\\x", "a backslash in its name"),
            ("/etc/passwd", "an absolute path"),
            ("C:x", "a drive letter or a colon in its name"),
            ("a//b", "an empty part in its path"),
            ("../x", "a path that climbs out of its folder"),
            ("a/./b", "a path that climbs out of its folder"),
            ("a./b", "a name that ends in a dot or a space"),
            ("a/NUL.txt", "the name of a Windows device"),
            ("com1", "the name of a Windows device"),
        ] {
            assert_eq!(hazard(path), Some(expected), "{path}");
        }
        assert_eq!(hazard("data/inputs/communication.world"), None);
    }

    #[test]
    fn clashes_are_noticed_between_files_folders_and_cases() {
        let mut names = Names::default();
        assert_eq!(names.enter("data/a"), None);
        assert_eq!(names.enter("data/b"), None);
        assert_eq!(names.enter("data/A").as_deref(), Some("data/a"));
        assert_eq!(names.enter("Data/c").as_deref(), Some("data"));
        assert_eq!(names.enter("data/a/x").as_deref(), Some("data/a"));
        assert_eq!(names.enter("data/b").as_deref(), Some("data/b"));
        assert_eq!(names.len(), 3, "data, data/a and data/b");
        assert_eq!(names.enter("data/"), None);
        assert_eq!(names.enter("data/b/").as_deref(), Some("data/b"));
        assert_eq!(names.enter("data/c/"), None);
        assert_eq!(names.enter("data/c").as_deref(), Some("data/c"));
    }

    proptest! {
        #[test]
        fn a_portable_name_is_portable_and_safe(text in any::<String>()) {
            let name = portable(&text);
            prop_assert!(is_portable(&name) && hazard(&name).is_none() && !name.contains('/'), "{}", name);
        }
    }
}
