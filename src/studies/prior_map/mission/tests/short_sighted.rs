//! A robot that does not see the walls from the middle of its room.

use super::*;
use crate::mapping::NoReturn;

/// Returns a room of 12 x 8 m with nothing in it.
fn hall() -> World {
    let mut hall = flat();
    hall.solids.truncate(4);
    let corners = [(-6.15, -4.15, 6.15, -4.0), (-6.15, 4.0, 6.15, 4.15)];
    let ends = [(-6.15, -4.15, -6.0, 4.15), (6.0, -4.15, 6.15, 4.15)];
    for (solid, (x0, y0, x1, y1)) in hall.solids.iter_mut().zip(corners.into_iter().chain(ends)) {
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
        let outline = Outline::Polygon(corners.map(|(x, y)| Point::new(x, y)).to_vec());
        solid.body = Body::Prism { outline, z: [0.0, 2.5] };
    }
    hall
}

#[test]
fn a_robot_that_sees_no_wall_explores_where_that_means_free_floor_and_gives_up_where_not() {
    let record = |no_return: NoReturn, start: Pose| {
        let mut parameters = Parameters::default();
        parameters.sensing.range_m = Some(3.5);
        parameters.sensing.field_of_view_deg = Some(360.0);
        parameters.mapping.no_return = no_return;
        let setup = Setup { world: Arc::new(hall()), start, parameters, ..setup(None) };
        let spec = TrialSpec { setup: studies::Setup::new(setup), ..spec_of_the_flat() };
        studies::execute(&spec)
    };
    for start in [Pose::new(-4.0, -2.0, 0.0), Pose::new(0.0, 0.0, 0.0)] {
        let explored = record(NoReturn::Free, start);
        assert_eq!((explored.outcome, explored.cause.as_str()), (Outcome::EXPLORED, ""));
        assert!(explored.measures["coverage-percent"].unwrap() > 97.0, "{explored:?}");
    }
    let short = record(NoReturn::Nothing, Pose::new(-4.0, -2.0, 0.0));
    assert_eq!(short.outcome, Outcome::GAVE_UP);
    let covered = short.measures["coverage-percent"].unwrap();
    let said = format!("gave up the one frontier that was left at {covered:.0} % coverage");
    assert_eq!(short.cause, said);
    assert!(covered < EXPLORED_FROM_PERCENT, "{covered}");
}
