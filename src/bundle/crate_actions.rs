//! What was done, as the Run Crate profiles tell it: one `CreateAction` a condition.

use super::crate_entities::Entity;
use super::crate_metadata::Graph;
use super::{SealedCondition, bag, format};

impl Graph<'_> {
    /// Describes what was done: the run, one action a condition, the analysis, and who had them done.
    pub(super) fn actions(&self) -> Vec<Entity> {
        let (runner, simulate, analyze) = self.tools();
        let (content, circumstance) = (self.content, self.circumstance);
        let inputs: Vec<String> = self.inputs().into_iter().map(|i| i.path).collect();
        let outputs: Vec<String> = self.outputs().into_iter().map(|o| o.path).collect();
        let parts = |c: &SealedCondition| -> Vec<String> {
            (1..=c.parts.len().max(1)).map(|part| format::records_part(&c.slug, part)).collect()
        };
        let records: Vec<String> = content.conditions.iter().flat_map(parts).collect();
        let environment: Vec<String> =
            (1..=circumstance.environment.len()).map(|i| format!("#environment-{i}")).collect();
        let timed = |entity: Entity| {
            entity
                .refer("agent", &self.people.authors[0])
                .text("startTime", circumstance.started.iso())
                .text("endTime", circumstance.ended.iso())
        };
        let action = |id: &str, name: String, description: String, failed: usize, all: usize| {
            let status = if failed == 0 { "Completed" } else { "Failed" };
            let action = timed(Entity::new(id, &["CreateAction"]))
                .text("name", name)
                .text("description", description)
                .text("actionStatus", format!("http://schema.org/{status}ActionStatus"));
            action.with((failed > 0).then_some(failed), |action, failed| {
                action.text(
                    "error",
                    format!("{failed} of {all} trials failed; their records say how"),
                )
            })
        };
        let failed: usize = content.conditions.iter().map(|c| c.failed).sum();
        let all: usize = content.conditions.iter().map(|c| c.trials).sum();
        let trials: Vec<String> =
            content.conditions.iter().map(|c| format!("#condition-{}", c.slug)).collect();

        let mut entities = vec![
            action(
                "#run",
                format!("Run of {}", content.name),
                "reenact run study.yaml".into(),
                failed,
                all,
            )
            .refer("instrument", format::STUDY)
            .refer_all("object", inputs.iter().map(String::as_str).chain(["#seed"]))
            .refer_all("result", &outputs)
            .refer_all("environment", &environment),
        ];
        for (condition, id) in content.conditions.iter().zip(&trials) {
            let (count, records) = (condition.trials, parts(condition));
            let description =
                format!("{count} trials of {} with seed {}", condition.label, content.seed);
            let name = format!("Condition {}", condition.label);
            let action = action(id, name, description, condition.failed, count)
                .refer("instrument", &simulate)
                .refer_all("object", inputs.iter().map(String::as_str).chain(["#seed"]));
            entities.push(match &records[..] {
                [whole] => action.refer("result", whole),
                parts => action.refer_all("result", parts),
            });
        }
        entities.push(
            action(
                "#analysis",
                "Analysis of all trials".into(),
                "Tables, figures and verdicts from the records".into(),
                0,
                0,
            )
            .refer("instrument", &analyze)
            .refer_all("object", &records)
            .refer_all("result", &outputs),
        );
        entities.push(
            Entity::new("#control-trials", &["ControlAction"])
                .text("name", "Orchestrate the trials")
                .refer("instrument", "#step-trials")
                .refer_all("object", &trials),
        );
        entities.push(
            Entity::new("#control-analysis", &["ControlAction"])
                .text("name", "Orchestrate the analysis")
                .refer("instrument", "#step-analysis")
                .refer("object", "#analysis"),
        );
        entities.push(
            timed(Entity::new("#engine-run", &["OrganizeAction"]))
                .text("name", format!("Run of reenact {}", circumstance.version))
                .refer("instrument", &runner)
                .refer_all("object", ["#control-trials", "#control-analysis"])
                .refer("result", "#run"),
        );
        for ((name, value), id) in circumstance.environment.iter().zip(&environment) {
            entities.push(
                Entity::new(id, &["PropertyValue"])
                    .text("name", bag::one_line(name))
                    .text("value", bag::one_line(value)),
            );
        }
        entities
    }
}
