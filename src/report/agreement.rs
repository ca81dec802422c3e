//! Whether our cell and the paper's tell the same: a reading aid, never a verdict.

use super::Measured;
use serde::Serialize;

/// How our mean lies to the published one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    /// Within one published standard deviation.
    Within,
    /// Within two.
    Near,
    /// Farther away.
    Apart,
    /// One of the two is missing.
    #[default]
    Silent,
}

impl Agreement {
    /// The rule, as the page prints it.
    pub const RULE: &'static str = "Marks compare means: \u{2713} ours lies within one published standard \
        deviation, \u{2248} within two, \u{2260} farther away (10 % and 20 % of the published value where \
        no deviation is printed). They are a reading aid; claims are judged by tests.";

    /// By the distance of the means in published standard deviations; where none is printed, or it is zero,
    /// by 10 and 20 % of the published mean.
    pub fn between(ours: Option<Measured>, published: Option<Measured>) -> Self {
        let (Some(ours), Some(published)) = (ours, published) else { return Self::Silent };
        let unit = published.sd.filter(|sd| *sd > 0.0).unwrap_or(published.mean.abs() / 10.0);
        let distance = (ours.mean - published.mean).abs();
        if distance <= unit {
            Self::Within
        } else if distance <= 2.0 * unit {
            Self::Near
        } else if distance.is_nan() {
            Self::Silent
        } else {
            Self::Apart
        }
    }

    /// The mark in a cell: a shape, so that colour adds nothing needed.
    pub fn mark(self) -> &'static str {
        match self {
            Self::Within => "\u{2713}",
            Self::Near => "\u{2248}",
            Self::Apart => "\u{2260}",
            Self::Silent => "",
        }
    }

    /// The mark in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Within => "within one published sd",
            Self::Near => "within two published sd",
            Self::Apart => "more than two published sd away",
            Self::Silent => "not comparable",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_in_published_deviations() {
        let measured = |mean, sd| Some(Measured { mean, sd, n: None });
        let published = measured(20.0, Some(3.0));
        let agreement = |mean| Agreement::between(measured(mean, None), published);
        assert_eq!(agreement(23.0), Agreement::Within);
        assert_eq!(agreement(14.0), Agreement::Near);
        assert_eq!(agreement(26.5), Agreement::Apart);
        assert_eq!(Agreement::between(None, published), Agreement::Silent);
        assert_eq!(agreement(f64::NAN), Agreement::Silent);
        for sd in [None, Some(0.0)] {
            let published = measured(50.0, sd);
            assert_eq!(Agreement::between(measured(54.0, None), published), Agreement::Within);
            assert_eq!(Agreement::between(measured(62.0, None), published), Agreement::Apart);
        }
    }
}
