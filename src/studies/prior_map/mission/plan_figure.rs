//! The truth of a condition as a drawing: Figures 3, 5, 6 and 7.

use crate::figure::Plan;
use crate::studies::drawn::{NO_CONDITION, words_alone};
use crate::studies::prior_map::{PlanFigure, Setup};
use crate::studies::{Drawn, Findings};

/// The layer of a world that every condition has.
const WALLS: &str = "walls";

impl PlanFigure {
    /// Draws the floor plan of the first condition that it speaks of; words where the design leaves that combination out.
    pub(in crate::studies) fn draw(&self, title: &str, findings: &Findings<'_>) -> Drawn {
        Drawn::new(
            ("Floor plan", title),
            self.svg(title, findings, false),
            String::new(),
            "The world at the height of the laser scanner, with the robot's start.",
        )
    }

    /// Draws the same under the prior map of that condition.
    pub(in crate::studies) fn draw_with_prior(
        &self,
        title: &str,
        findings: &Findings<'_>,
    ) -> Drawn {
        Drawn::new(
            ("Floor plan with a prior map over it", title),
            self.svg(title, findings, true),
            String::new(),
            "The world at the height of the laser scanner; orange, the obstacles of the prior map.",
        )
    }

    fn svg(&self, title: &str, findings: &Findings<'_>, with_prior: bool) -> String {
        let found = findings.first(&self.only);
        let Some((condition, setup)) = found.and_then(|(c, s)| Some((c, s.of::<Setup>()?))) else {
            return words_alone(title, NO_CONDITION);
        };
        let prior = condition.value("prior");
        let prior = prior.map_or("prior map", |prior| findings.labels.value("prior", prior));
        plan_figure(title, setup, &self.crossed, with_prior.then_some(prior))
    }
}

/// Draws the world of `setup` as its scanner sees it, the layers `crossed` as crosses, and over it, where asked for,
/// the obstacles of its prior called `prior`.
fn plan_figure(title: &str, setup: &Setup, crossed: &[String], prior: Option<&str>) -> String {
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
