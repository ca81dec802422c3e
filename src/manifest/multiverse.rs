//! `multiverse: FILE`: what `reenact vary --joint` found at draws of all assumptions together, read and held against them.

use super::claims::as_judged;
use super::experiment::{Assumption, Experiment, JointDraws};
use super::input::InputKind;
use super::library::normalised;
use super::parameters::ParametersSchema;
use super::resolver::Resolver;
use super::sensitivity::warn_of_age;
use crate::claims::Multiverse;
use crate::claims::multiverse::Choice;
use crate::claims::sensitivity::in_words;
use crate::studies::StudyKind;

impl Experiment {
    /// Returns the choices that the paper leaves open and whose range the manifest states, in its order.
    pub fn choices(&self) -> Vec<Choice> {
        choices(self.kind, &self.assumptions)
    }
}

fn choices(kind: StudyKind, assumptions: &[Assumption]) -> Vec<Choice> {
    let schema = ParametersSchema::of(kind);
    let open = assumptions.iter().filter(|assumption| !assumption.range.is_empty());
    open.map(|assumption| {
        let Assumption { path, value, range, .. } = assumption;
        Choice::new(path, value, range, schema.is_whole(path))
    })
    .collect()
}

/// Reads the file that the manifest names, where it names one; warns where it is not what would be drawn now.
pub(super) fn read(resolver: &mut Resolver<'_>, assumptions: &[Assumption]) -> Option<JointDraws> {
    const PLACE: &str = "/multiverse";
    let path = resolver.doc.multiverse.as_deref()?;
    let source = resolver.text(path, PLACE, InputKind::Multiverse)?;
    let table = match Multiverse::from_csv(&source.text) {
        Ok(table) => table,
        Err(problem) => {
            let fault = resolver.faults.fault(PLACE, format!("`{path}`: {problem}"));
            resolver.faults.push(fault.label("expected what `reenact vary --joint` writes"));
            return None;
        }
    };
    let mut stale = stale(&table, &choices(resolver.doc.study, assumptions));
    let claims: Vec<String> = as_judged(resolver).into_iter().map(|claim| claim.id).collect();
    let gone = table.claims.iter().filter(|id| !claims.contains(id));
    stale.extend(gone.map(|id| format!("it judges `{id}`, which is no claim of this manifest")));
    let help = "`reenact vary --joint` on this manifest writes it anew";
    warn_of_age(resolver, (PLACE, path), &stale, help);
    Some(JointDraws { as_written: normalised(path), table })
}

/// Returns in words what of `table` is not what would be drawn of `choices`.
fn stale(table: &Multiverse, choices: &[Choice]) -> Vec<String> {
    let mut stale = Vec::new();
    let place = |setting: &String| table.settings.iter().position(|known| known == setting);
    for choice in choices {
        let (setting, now) = (&choice.setting, in_words(&choice.chosen));
        match place(setting).map(|place| &table.chosen.values[place]) {
            None => stale.push(format!("{setting} was not drawn")),
            Some(then) if *then != now => {
                stale.push(format!("{setting} was drawn around {then}, it is {now} now"));
            }
            Some(_) => {}
        }
    }
    let known = |setting: &&String| choices.iter().any(|choice| choice.setting == **setting);
    let closed = table.settings.iter().filter(|setting| !known(setting));
    stale.extend(closed.map(|setting| format!("{setting} was drawn, and states no range now")));
    let drawn = table.drawn_again(choices);
    let misdrawn = table.draws.iter().filter_map(|draw| {
        let (expected, found) = table.misdrawn(draw, &drawn)?;
        Some(format!("draw {} is not {expected}, but {found}", draw.number.unwrap_or_default()))
    });
    stale.extend(misdrawn);
    stale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::multiverse::{Draw, Found};
    use crate::digest::Sha256Digest;
    use serde_json::json;

    #[test]
    fn what_would_be_drawn_otherwise_now_is_told() {
        let judged = || Found::Judged { records: Sha256Digest::of("any"), verdicts: Vec::new() };
        let stop = Choice::new("parameters.pilot.stop-m", &json!(0.05), &[json!(0.1)], false);
        let values = stop.draw(7, 2);
        let draw = |i: usize| Draw {
            number: Some(i),
            values: vec![in_words(&values[i])],
            found: judged(),
        };
        let table = Multiverse {
            seed: 7,
            trials: 1,
            settings: vec![stop.setting.clone()],
            claims: Vec::new(),
            chosen: Draw { number: None, values: vec!["0.05".to_owned()], found: judged() },
            draws: vec![draw(0), draw(1)],
        };
        let none: [String; 0] = [];
        assert_eq!(stale(&table, std::slice::from_ref(&stop)), none);
        let moved = Choice { chosen: json!(0.06), ..stop.clone() };
        assert_eq!(
            stale(&table, &[moved]),
            ["parameters.pilot.stop-m was drawn around 0.05, it is 0.06 now"]
        );
        let closed = ["parameters.pilot.stop-m was drawn, and states no range now"];
        assert_eq!(stale(&table, &[]), closed);
        let other = Choice::new("parameters.pilot.pivot-rad", &json!(1), &[json!(2)], false);
        let both = [stop.clone(), other];
        assert_eq!(stale(&table, &both), ["parameters.pilot.pivot-rad was not drawn"]);
        let wider = Choice::new(&stop.setting, &stop.chosen, &[json!(0.2)], false);
        let told = stale(&table, &[wider]);
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told[0].starts_with("draw 0 is not parameters.pilot.stop-m at "), "{told:?}");
    }
}
