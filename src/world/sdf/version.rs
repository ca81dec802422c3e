//! Versions of SDFormat.

/// The oldest and the newest minor version of SDFormat 1 that is read.
const KNOWN: [u32; 2] = [3, 12];

/// Returns the minor version of a version that is read: 6 of `1.6`.
pub(super) fn known(version: &str) -> Option<u32> {
    let (major, minor) = version.trim().split_once('.')?;
    let minor: u32 = minor.parse().ok()?;
    (major == "1" && (KNOWN[0]..=KNOWN[1]).contains(&minor)).then_some(minor)
}
