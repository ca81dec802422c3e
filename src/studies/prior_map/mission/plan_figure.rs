//! The truth of a condition as a drawing: Figures 3, 5, 6 and 7.

use crate::figure::{Medium, Plan};
use crate::studies::drawn::{NO_CONDITION, words_alone};
use crate::studies::prior_map::{PlanFigure, Setup};
use crate::studies::{Drawn, Findings};
use crate::table::Table;

/// The layer of a world that every condition has.
const WALLS: &str = "walls";

impl PlanFigure {
    /// Draws the floor plan of the first condition that it speaks of; words where the design leaves that combination out.
    pub(in crate::studies) fn draw(
        &self,
        title: &str,
        findings: &Findings<'_>,
        medium: Medium,
    ) -> Drawn {
        let (svg, data) = self.drawn(title, findings, false, medium);
        Drawn::new(
            ("Floor plan", title),
            svg,
            String::new(),
            "The world at the height of the laser scanner, with the robot's start.",
            data,
        )
    }

    /// Draws the same under the prior map of that condition.
    pub(in crate::studies) fn draw_with_prior(
        &self,
        title: &str,
        findings: &Findings<'_>,
        medium: Medium,
    ) -> Drawn {
        let (svg, data) = self.drawn(title, findings, true, medium);
        Drawn::new(
            ("Floor plan with a prior map over it", title),
            svg,
            String::new(),
            "The world at the height of the laser scanner; orange, the obstacles of the prior map.",
            data,
        )
    }

    fn drawn(
        &self,
        title: &str,
        findings: &Findings<'_>,
        with_prior: bool,
        medium: Medium,
    ) -> (String, Table) {
        let found = findings.first(&self.only);
        let Some((condition, setup)) = found.and_then(|(c, s)| Some((c, s.of::<Setup>()?))) else {
            return (words_alone(title, NO_CONDITION), Table::default());
        };
        let prior = condition.value("prior");
        let prior = prior.map_or("prior map", |prior| findings.labels.value("prior", prior));
        let plan = plan_figure(title, setup, &self.crossed, with_prior.then_some(prior));
        (plan.to_svg_on(medium), plan.data())
    }
}

/// Plans the drawing of the world of `setup` as its scanner sees it, the layers `crossed` as crosses, and over it, where asked for,
/// the obstacles of its prior called `prior`.
fn plan_figure<'a>(
    title: &str,
    setup: &'a Setup,
    crossed: &[String],
    prior: Option<&'a str>,
) -> Plan<'a> {
    let height = setup.robot.lidar.as_ref().map_or(0.0, |lidar| lidar.height);
    let cut = |wanted: &dyn Fn(&str) -> bool| {
        let solids = setup.world.solids.iter().filter(|solid| wanted(&solid.layer));
        solids.flat_map(|solid| solid.body.slice(height)).collect()
    };
    let is_crossed = |layer: &str| crossed.iter().any(|name| name == layer);
    Plan {
        title: title.to_owned(),
        walls: cut(&|layer| layer == WALLS && !is_crossed(layer)),
        furniture: cut(&|layer| layer != WALLS && !is_crossed(layer)),
        crossed: cut(&is_crossed),
        crossed_name: crossed.join(", "),
        start: Some(setup.start),
        overlay: prior.zip(setup.prior.as_deref()),
    }
}
