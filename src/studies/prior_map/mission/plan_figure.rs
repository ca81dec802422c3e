//! The truth of a condition as a drawing: Figures 3 and 5.

use crate::figure::Plan;
use crate::studies::prior_map::Setup;

/// The layer of a world that always stands.
const WALLS: &str = "walls";

/// The world of `setup` as its scanner sees it, and over it, where asked for, the obstacles of its prior called `prior`.
pub fn plan_figure(title: &str, setup: &Setup, prior: Option<&str>) -> String {
    let height = setup.robot.lidar.as_ref().map_or(0.0, |lidar| lidar.height);
    let standing = |walls: bool| {
        let solids = setup.world.solids.iter().filter(|solid| (solid.layer == WALLS) == walls);
        solids.filter_map(|solid| solid.body.slice(height)).collect()
    };
    let plan = Plan {
        title: title.to_owned(),
        walls: standing(true),
        furniture: standing(false),
        start: Some(setup.start),
        overlay: prior.zip(setup.prior.as_deref()),
    };
    plan.to_svg()
}
