//! A source of randomness that has none: what the writer of zips would encrypt with where it is compiled for the web.
//!
//! It takes the place of the crate of this name (`[patch.crates-io]` in `page/Cargo.toml`), which asks the browser by way of
//! wasm-bindgen. Nothing is encrypted here, and nothing of a result may depend on chance: whoever asks is refused.

use std::fmt;

/// There is no randomness here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Error;

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("there is no randomness in this module")
    }
}

impl std::error::Error for Error {}

/// Refuses.
///
/// # Errors
/// Always.
pub fn fill(_: &mut [u8]) -> Result<(), Error> {
    Err(Error)
}

/// Refuses.
///
/// # Errors
/// Always.
pub fn u64() -> Result<u64, Error> {
    Err(Error)
}
