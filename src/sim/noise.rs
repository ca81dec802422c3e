//! Distributions of errors.

use crate::rng::Stream;

/// The shape of an error around zero; its size is given where it is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// Normal: the size is the standard deviation.
    Gaussian,
    /// Uniform between minus and plus the size.
    Uniform,
}

impl Distribution {
    /// Draws two independent errors of size one, the next ones of `stream`.
    pub(super) fn pair(self, stream: &mut Stream) -> (f64, f64) {
        match self {
            Self::Gaussian => (stream.normal(), stream.normal()),
            Self::Uniform => {
                let first = stream.between(-1.0, 1.0);
                (first, stream.between(-1.0, 1.0))
            }
        }
    }
}
