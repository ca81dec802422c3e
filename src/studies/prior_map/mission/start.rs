//! The start of a trial: the manifest's, or a place near it drawn for the trial.

use crate::geometry::{Outline, Pose};
use crate::rng::Seeds;
use crate::studies::prior_map::Setup;

/// Draws until one fits; where none does, the manifest's own start is kept.
const DRAWS: u64 = 1000;
/// The straight line from the manifest's start is tested at this spacing (m).
const SPACING: f64 = 0.05;

/// Draws the start of one trial in the world's frame (m, rad); `None` where the manifest asks for no jitter. The body
/// could have been pushed there in a straight line from the manifest's start without touching anything of `solid`, so
/// that no draw puts it behind a wall.
pub(super) fn draw(setup: &Setup, solid: &[Outline], seeds: &Seeds) -> Option<Pose> {
    let mission = &setup.parameters.mission;
    let (reach, turn) = (mission.start_jitter_m, mission.start_jitter_deg.to_radians());
    if reach <= 0.0 && turn <= 0.0 {
        return None;
    }
    let mut stream = seeds.stream("start-jitter");
    let radius = setup.robot.circumscribed_radius();
    let draws = (0..DRAWS).map(|number| {
        let stream = stream.at(number);
        let mut about = |middle: f64, reach: f64| stream.between(middle - reach, middle + reach);
        let start = setup.start;
        Pose::new(about(start.x, reach), about(start.y, reach), about(start.heading, turn))
    });
    let fits = |start: &Pose| {
        let (from, to) = (setup.start.position(), start.position());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few")]
        let steps = (from.distance(to) / SPACING).ceil().max(1.0) as u32;
        (1..=steps).all(|step| {
            let at = from + (to - from) * (f64::from(step) / f64::from(steps));
            solid.iter().all(|outline| outline.distance(at) > radius + SPACING / 2.0)
        })
    };
    Some({ draws }.find(fits).unwrap_or(setup.start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::studies::prior_map::mission::tests::setup;

    #[test]
    fn starts_differ_between_trials_and_stay_on_this_side_of_walls() {
        let mut setup = setup(None);
        setup.start = Pose::new(-0.5, 1.5, 0.0);
        let solid = setup.world.contact(0.01, 0.43);
        let seeds = |trial: u32| Seeds::new(1, vec![("trial".into(), trial.to_string())]);
        assert_eq!(draw(&setup, &solid, &seeds(0)), None, "without jitter");
        setup.parameters.mission.start_jitter_m = 1.5;
        setup.parameters.mission.start_jitter_deg = 20.0;
        let starts: Vec<Pose> =
            (0..200).map(|trial| draw(&setup, &solid, &seeds(trial)).unwrap()).collect();
        assert_eq!(draw(&setup, &solid, &seeds(7)), Some(starts[7]), "the same again");
        for start in &starts {
            // The wall x = 0 is beside it, the wall y = 2 before it.
            assert!(start.x < -0.075 - 0.178 && start.y < 2.0 - 0.178, "{start:?}");
            assert!((start.x + 0.5).abs() <= 1.5 && start.heading.abs() <= 0.35);
        }
        let spread = |of: fn(&Pose) -> f64| {
            let (low, high) =
                starts.iter().map(of).fold((9.0_f64, -9.0_f64), |(l, h), v| (l.min(v), h.max(v)));
            high - low
        };
        assert!(spread(|s| s.x) > 1.5 && spread(|s| s.y) > 1.5 && spread(|s| s.heading) > 0.6);
    }

    #[test]
    fn a_start_with_no_room_around_it_stays() {
        let mut setup = setup(None);
        setup.parameters.mission.start_jitter_m = 0.5;
        let tight = [Outline::Circle { center: Point::new(-2.5, 0.5), radius: 0.01 }];
        assert_eq!(draw(&setup, &tight, &Seeds::new(1, vec![])), Some(setup.start));
    }
}
