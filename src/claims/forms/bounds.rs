//! One quantity against bounds: what `between` and `share` are made of.

use crate::claims::faults::Faults;
use crate::claims::gather::Evidence;
use crate::claims::verdict::EffectSize;
use crate::stats::distribution::normal_sf;
use crate::stats::proportion::{Proportion, wilson};
use crate::stats::real;

/// The bounds of a form.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) low: Option<f64>,
    pub(super) high: Option<f64>,
}

impl Bounds {
    /// Returns the p-values of "inside" and "outside" from those of "above" and "below" a bound.
    pub(super) fn hold(self, tails: impl Fn(f64) -> (f64, f64)) -> (f64, f64) {
        let low = self.low.map(&tails);
        let high = self.high.map(|bound| {
            let (above, below) = tails(bound);
            (below, above)
        });
        if low.is_none() && high.is_none() {
            // Nothing is claimed, so nothing is shown.
            return (1.0, 1.0);
        }
        let given = || low.iter().chain(&high);
        (
            given().map(|(inside, _)| *inside).fold(0.0, f64::max),
            given().map(|(_, outside)| *outside).fold(1.0, f64::min),
        )
    }

    pub(super) fn words(self) -> String {
        match (self.low, self.high) {
            (Some(low), Some(high)) => format!("between {low} and {high}"),
            (Some(low), None) => format!("at least {low}"),
            (None, Some(high)) => format!("at most {high}"),
            (None, None) => "anything".to_owned(),
        }
    }

    /// Checks the bounds; those of a share lie strictly between 0 and 1 (`open_unit`).
    pub(super) fn check(self, open_unit: bool, faults: &mut Faults<'_>) {
        let Self { low, high } = self;
        faults.unless(low.is_some() || high.is_some(), "/low", || {
            "expected `low`, `high` or both".to_owned()
        });
        if let (Some(low), Some(high)) = (low, high) {
            faults.unless(low < high, "/low", || format!("{low} is not below high, {high}"));
        }
        for (path, bound) in [("/low", low), ("/high", high)] {
            if let Some(bound) = bound {
                let inside = !open_unit || (bound > 0.0 && bound < 1.0);
                faults.unless(bound.is_finite() && inside, path, || {
                    format!("a share is bounded strictly between 0 and 1, found {bound}; leave out what always holds")
                });
            }
        }
    }
}

/// Tests a share by its score, which Wilson's interval inverts.
pub(super) fn share_level(share: Proportion, bounds: Bounds, confidence: f64) -> Evidence {
    let (p_for, p_against) = bounds.hold(|bound| {
        let z = (share.share() - bound) / (bound * (1.0 - bound) / real(share.trials)).sqrt();
        // At 0 and 1 the score has no variance: the data are on the bound, or on its only side.
        if z.is_nan() { (0.5, 0.5) } else { (normal_sf(z), normal_sf(-z)) }
    });
    let interval = wilson(share, confidence);
    let effect = EffectSize::new("share", share.share(), interval);
    Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) }
}
