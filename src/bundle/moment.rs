//! Instants of the circumstance half, in the one spelling that the validators accept.

/// Seconds since 1970-01-01 00:00:00 UTC, leap seconds not counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment(pub i64);

impl Moment {
    /// Writes the day, in UTC: `2026-01-15`.
    pub fn date(self) -> String {
        let (year, month, day) = civil(self.0.div_euclid(86_400));
        format!("{year:04}-{month:02}-{day:02}")
    }

    /// Writes the instant as `2026-01-15T12:00:00+00:00`. RO-Crate's validator refuses `Z`, fractions and other
    /// offsets.
    pub fn iso(self) -> String {
        let second = self.0.rem_euclid(86_400);
        format!(
            "{}T{:02}:{:02}:{:02}+00:00",
            self.date(),
            second / 3600,
            second / 60 % 60,
            second % 60
        )
    }

    /// Reads what [`Self::iso`] writes; `None` for anything else.
    pub fn from_iso(text: &str) -> Option<Self> {
        let number = |range: std::ops::Range<usize>| text.get(range)?.parse::<i64>().ok();
        let (year, month, day) = (number(0..4)?, number(5..7)?, number(8..10)?);
        let (hour, minute, second) = (number(11..13)?, number(14..16)?, number(17..19)?);
        let moment = Self(days(year, month, day) * 86_400 + hour * 3600 + minute * 60 + second);
        (moment.iso() == text).then_some(moment)
    }
}

/// Computes year, month and day of the proleptic Gregorian calendar for a day counted from 1970-01-01 (H. Hinnant,
/// "chrono-Compatible Low-Level Date Algorithms", `civil_from_days`).
fn civil(days: i64) -> (i64, i64, i64) {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (year_of_era + era * 400 + i64::from(month <= 2), month, day)
}

/// Computes the inverse of [`civil`] (Hinnant, `days_from_civil`).
fn days(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let month_from_march = if month > 2 { month - 3 } else { month + 9 };
    let day_of_year = (153 * month_from_march + 2) / 5 + day - 1;
    let day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    era * 146_097 + day_of_era - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_instants() {
        assert_eq!(Moment(0).iso(), "1970-01-01T00:00:00+00:00");
        assert_eq!(Moment(951_827_696).iso(), "2000-02-29T12:34:56+00:00");
        assert_eq!(Moment(1_768_478_400).iso(), "2026-01-15T12:00:00+00:00");
        for bad in ["", "2026-01-15", "2026-13-15T12:00:00+00:00", "2026-01-15T12:00:00Z"] {
            assert_eq!(Moment::from_iso(bad), None);
        }
    }

    proptest! {
        #[test]
        fn iso_round_trips(seconds in -62_135_596_800_i64..253_402_300_800) {
            prop_assert_eq!(Moment::from_iso(&Moment(seconds).iso()), Some(Moment(seconds)));
        }
    }
}
