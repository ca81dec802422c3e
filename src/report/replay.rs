//! Pages in which trials play.

use super::recorded::Recorded;
use super::template::render;
use crate::json;
use crate::studies::recording::Recording;
use serde::Serialize;

pub(super) const SCRIPT: &str = concat!(
    "\n",
    include_str!("templates/unpack.js"),
    include_str!("templates/draw.js"),
    include_str!("templates/view.js"),
    include_str!("templates/graph.js"),
    include_str!("templates/panels.js"),
    include_str!("templates/chart.js"),
    include_str!("templates/replay.js")
);

/// A sentence over the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Note {
    /// What is said, such as whether the re-enacted record equals the archived one.
    pub text: String,
    /// Whether that is as it should be.
    pub good: bool,
}

#[derive(Serialize)]
struct Content<'a> {
    title: &'a str,
    notes: &'a [Note],
    /// The trials as JSON that no `<` can end.
    data: String,
}

/// Returns one self-contained page titled `title` in which the named trials play side by side on one clock.
///
/// `notes` stand over the page, the bad ones marked as such. The page starts at the instant of its address, if it ends in `#t=12.5` (s).
pub fn replay_page(title: &str, trials: &[(String, &Recording)], notes: &[Note]) -> String {
    let trials: Vec<_> =
        trials.iter().map(|(name, recording)| Recorded::new(name, recording)).collect();
    let data = json::canonical_of(&trials).replace('<', "\\u003c");
    render(include_str!("templates/replay.html"), SCRIPT, &Content { title, notes, data })
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{assert_offline, recording};
    use super::*;

    #[test]
    fn two_trials_share_a_page_that_needs_nothing_else() {
        let (a, b) = (recording(40), recording(60));
        let trials = [("prior=none #0".to_owned(), &a), ("prior=floor-plan #0".to_owned(), &b)];
        let note = |text: &str, good| Note { text: text.to_owned(), good };
        let notes =
            [note("the first equals the archived one", true), note("the second DIFFERS", false)];
        let page = replay_page("Replay", &trials, &notes);
        assert_offline(&page);
        let [good, bad] =
            ["✓ the first equals", "✗ the second DIFFERS"].map(|text| page.find(text).unwrap());
        assert!(good < bad);
        assert!(page.contains("prior=floor-plan #0"));
        assert_eq!(page, replay_page("Replay", &trials, &notes));
    }

    #[test]
    fn hostile_names_stay_text() {
        let mut recording = recording(5);
        recording.frames[1].event = Some("</script><script>alert(2)</script>".into());
        let name = "</script><script>alert(1)</script>".to_owned();
        let page =
            replay_page("<b>&", &[(name, &recording)], &[Note { text: "<i>".into(), good: true }]);
        assert_eq!(page.matches("</script>").count(), 2, "the data block and the script");
        assert!(!page.contains("<script>alert") && !page.contains("<b>&") && !page.contains("<i>"));
        assert_offline(&page);
    }

    #[test]
    fn a_trial_of_150_s_stays_small_and_an_empty_one_still_makes_a_page() {
        let mut long = recording(1500);
        let page = replay_page("Long", &[("one".into(), &long)], &[]);
        assert!(page.len() < 2_000_000, "{} bytes", page.len());
        long.frames.clear();
        long.world.clear();
        assert_offline(&replay_page("Empty", &[("none".into(), &long)], &[]));
    }

    #[test]
    fn the_script_stays_readable() {
        let parts = [
            include_str!("templates/unpack.js"),
            include_str!("templates/draw.js"),
            include_str!("templates/view.js"),
            include_str!("templates/graph.js"),
            include_str!("templates/panels.js"),
            include_str!("templates/chart.js"),
            include_str!("templates/replay.js"),
        ];
        assert!(parts.iter().all(|part| part.lines().count() <= 300));
        assert!(parts.iter().flat_map(|part| part.lines()).all(|line| line.len() <= 120));
    }
}
