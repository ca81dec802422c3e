//! The truth of a condition as a drawing: Figures 3, 5, 6 and 7.

use crate::figure::Plan;
use crate::studies::prior_map::Setup;

/// The layer of a world that every condition has.
const WALLS: &str = "walls";

/// Draws the world of `setup` as its scanner sees it, the layers `crossed` as crosses, and over it, where asked for,
/// the obstacles of its prior called `prior`.
pub fn plan_figure(title: &str, setup: &Setup, crossed: &[String], prior: Option<&str>) -> String {
    let height = setup.robot.lidar.as_ref().map_or(0.0, |lidar| lidar.height);
    let cut = |wanted: &dyn Fn(&str) -> bool| {
        let solids = setup.world.solids.iter().filter(|solid| wanted(&solid.layer));
        solids.flat_map(|solid| solid.body.slice(height)).collect()
    };
    let is_crossed = |layer: &str| crossed.iter().any(|name| name == layer);
    let plan = Plan {
        title: title.to_owned(),
        walls: cut(&|layer| layer == WALLS && !is_crossed(layer)),
        furniture: cut(&|layer| layer != WALLS && !is_crossed(layer)),
        crossed: cut(&is_crossed),
        crossed_name: crossed.join(", "),
        start: Some(setup.start),
        overlay: prior.zip(setup.prior.as_deref()),
    };
    plan.to_svg()
}
