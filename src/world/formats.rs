//! Formats of worlds that other simulators read and this does not: each is named, so that nobody looks for a slip in a file
//! that has none.

use crate::document::Diagnostic;

/// A format that is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Foreign {
    /// USD as text.
    Usda,
    /// USD in binary.
    Usdc,
    /// MuJoCo's format.
    Mjcf,
}

impl Foreign {
    /// Tells the format of a file by how it begins.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"PXR-USDC") {
            return Some(Self::Usdc);
        }
        let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes).trim_ascii_start();
        if text.starts_with(b"#usda") {
            return Some(Self::Usda);
        }
        text.starts_with(b"<mujoco").then_some(Self::Mjcf)
    }

    /// Says that the format is not read, and what is.
    pub fn help(self) -> &'static str {
        match self {
            Self::Usda => "USD (`#usda`) is not read: Gazebo's SDF is, and world YAML",
            Self::Usdc => "USD (`PXR-USDC`, binary) is not read: Gazebo's SDF is, and world YAML",
            Self::Mjcf => {
                "MJCF, the format of MuJoCo, is not read: Gazebo's SDF is, and world YAML"
            }
        }
    }

    /// Returns the fault of the file `name` in this format.
    pub fn fault(self, name: &str) -> Diagnostic {
        Diagnostic::placeless(format!("`{name}` is a world of another simulator")).help(self.help())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_how_they_begin() {
        assert_eq!(Foreign::of(b"PXR-USDC\0\x08"), Some(Foreign::Usdc));
        assert_eq!(Foreign::of(b"\n#usda 1.0\n"), Some(Foreign::Usda));
        assert_eq!(Foreign::of("\u{feff}<mujoco model='a'/>".as_bytes()), Some(Foreign::Mjcf));
        assert_eq!(Foreign::of(b"reenact-world: 1\n"), None);
        assert_eq!(
            Foreign::Usda.fault("hall.usda").render(false),
            "\
error: `hall.usda` is a world of another simulator
 |
 = help: USD (`#usda`) is not read: Gazebo's SDF is, and world YAML
"
        );
    }
}
