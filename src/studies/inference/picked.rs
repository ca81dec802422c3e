//! Draws of a posterior that are to be run in physics: the building of each, where goal and starts lie in it, and what is supposed.

use super::posterior::{DRAWS, Kept};
use super::{Inference, InferenceSetup, Posterior, Prior, Proposing, Shared, shown};
use crate::condition::Condition;
use crate::factor::Factor;
use crate::studies::columns::of_factor;
use crate::studies::findings::rounded;
use crate::studies::{Findings, Ledger, Setup, TrialRecord};
use crate::table::{Column, Table, Value as Cell};
use serde_json::Value;
use std::collections::BTreeMap;

/// One draw. Its numbers are those of the table `posterior`, to six significant digits.
#[derive(Debug, Clone, PartialEq)]
pub struct PickedDraw {
    /// Its row in the table `posterior`, from 0; `None` where it stands in for one that nobody made.
    pub number: Option<usize>,
    /// The condition of the inference whose building it is.
    pub building: Condition,
    /// Where goal and starts lie.
    pub places: Vec<PickedPlace>,
    /// What is supposed, in the order of the priors: path and value.
    pub values: Vec<(String, Value)>,
}

/// Where the goal or a start of a draw lies.
#[derive(Debug, Clone, PartialEq)]
pub struct PickedPlace {
    /// `goal`, or `start-` and the name of the start.
    pub name: String,
    /// The tag of its vertex.
    pub tag: String,
    /// Its position in the world's frame (m).
    pub at: [f64; 2],
}

impl PickedPlace {
    /// The name of the goal's place.
    pub const GOAL: &str = "goal";

    /// Returns the name of the start that it is; `None` where it is the goal.
    pub fn start(&self) -> Option<&str> {
        self.name.strip_prefix("start-")
    }
}

/// The conditions of an inference, in plan order, and its factors.
#[derive(Debug, Clone, Copy)]
pub struct InferenceDesign<'a> {
    factors: &'a [Factor],
    conditions: &'a [(&'a Condition, &'a Setup)],
    shared: &'a Shared,
}

impl<'a> InferenceDesign<'a> {
    /// The most draws that can be picked: as many as the table `posterior` has.
    pub const MOST: u32 = DRAWS;

    /// Reads the design of an experiment; `None` where it is no inference.
    pub fn of(factors: &'a [Factor], conditions: &'a [(&'a Condition, &'a Setup)]) -> Option<Self> {
        let setup = conditions.first()?.1.of::<InferenceSetup>()?;
        Some(Self { factors, conditions, shared: setup.shared() })
    }

    /// Returns what is inferred.
    pub fn inference(&self) -> &'a Inference {
        &self.shared.inference
    }

    /// Returns the paths of the numbers that are inferred: what a manifest may compute with.
    pub fn numbers(&self) -> Vec<&'a str> {
        let priors = self.inference().priors.iter();
        priors.filter(|prior| prior.is_continuous()).map(|prior| prior.path.as_str()).collect()
    }

    /// Returns the paths of what a trial in physics takes as it is. The others are about the model that proposes alone.
    pub fn parameters(&self) -> Vec<&'a str> {
        let priors = self.inference().priors.iter().map(|prior| prior.path.as_str());
        priors.filter(|path| !self.proposing().is_of_the_model(path)).collect()
    }

    fn proposing(&self) -> &'static dyn Proposing {
        self.shared.proposing()
    }

    /// Picks `count` draws of what `records` say, the middle one of each of as many equal parts of the table `posterior`.
    pub fn pick(&self, records: &[TrialRecord], count: u32) -> Vec<PickedDraw> {
        let ledger = Ledger::of(records);
        let published = BTreeMap::new();
        let findings = Findings::new(self.factors, &ledger, &published)
            .designed(self.conditions.iter().copied());
        let Some(posterior) = Posterior::of(&findings) else { return Vec::new() };
        let draws = posterior.draws();
        middles(draws.len(), count as usize)
            .filter_map(|row| Some(self.picked(row, draws.get(row)?)))
            .collect()
    }

    fn picked(&self, row: usize, kept: &Kept<'_>) -> PickedDraw {
        let names = self.proposing().placements(self.inference());
        let (placed, supposed) = kept.drawn.values.split_at(names.len());
        let places = names.into_iter().zip(placed).filter_map(|(name, vertex)| {
            let (tag, at) = self.proposing().place(kept.setup, *vertex)?;
            Some(PickedPlace { name, tag, at: at.map(rounded) })
        });
        let value = |(prior, number): (&Prior, &f64)| (prior.path.clone(), written(prior, *number));
        PickedDraw {
            number: Some(row),
            building: kept.condition.clone(),
            places: places.collect(),
            values: self.inference().priors.iter().zip(supposed).map(value).collect(),
        }
    }

    /// Returns what stands in for `count` draws where no proposal was made: buildings of the prior as they are, goal and starts on
    /// their first vertices, the middle of every prior. They enter no result.
    pub fn stand_ins(&self, count: u32) -> Vec<PickedDraw> {
        let names = self.proposing().placements(self.inference());
        let stand_in = |row: usize| {
            let (building, setup) = self.conditions[row];
            let own = setup.of::<InferenceSetup>().map_or(setup, InferenceSetup::own);
            let places = names.iter().zip(0_u32..).filter_map(|(name, vertex)| {
                let start = name.strip_prefix("start-");
                let known = start.is_none_or(|start| own.world().starts.contains_key(start));
                let (tag, at) = self.proposing().place(own, f64::from(vertex))?;
                (!known).then(|| PickedPlace { name: name.clone(), tag, at: at.map(rounded) })
            });
            let priors = self.inference().priors.iter();
            PickedDraw {
                number: None,
                building: building.clone(),
                places: places.collect(),
                values: priors.map(|p| (p.path.clone(), written(p, p.at(0.5)))).collect(),
            }
        };
        middles(self.conditions.len(), count as usize).map(stand_in).collect()
    }

    /// Returns the table of `draws`, one row each, numbered from 1 as the factor that they are values of.
    pub fn table(&self, draws: &[PickedDraw]) -> Table {
        let columns = self.columns();
        let mut table = Table::new(columns.iter().map(|column| column.name.clone()));
        for (index, draw) in draws.iter().enumerate() {
            let whole = |number: usize| Cell::from(i64::try_from(number).unwrap_or_default());
            let mut row = vec![whole(index + 1), draw.number.map_or(Cell::Missing, whole)];
            row.extend(
                self.factors.iter().map(|factor| {
                    draw.building.value(&factor.name).map_or(Cell::Missing, Cell::from)
                }),
            );
            for name in self.proposing().placements(self.inference()) {
                let place = draw.places.iter().find(|place| place.name == name);
                row.push(place.map_or(Cell::Missing, |place| place.tag.as_str().into()));
                row.extend([0, 1].map(|axis| place.map(|place| place.at[axis]).into()));
            }
            row.extend(draw.values.iter().map(|(_, value)| match value.as_f64() {
                Some(number) => number.into(),
                None => Cell::from(shown(value)),
            }));
            table.push(row);
        }
        table
    }

    /// Returns what the columns of that table say.
    pub fn columns(&self) -> Vec<Column> {
        let missing = "the draw has none";
        let mut columns = vec![
            Column::count("draw", "Number of the draw: a value of the factor of draws"),
            Column::count("posterior-draw", "Its row in the table of all posterior draws, from 0"),
        ];
        let factor = |factor: &Factor| {
            of_factor(self.factors, &factor.name).unwrap_or_else(|| Column::unknown(&factor.name))
        };
        columns.extend(self.factors.iter().map(factor));
        for place in self.proposing().placements(self.inference()) {
            columns.push(Column::text(&place, "The vertex, by its tag").empty_where(missing));
            columns.extend(["x", "y"].map(|axis| {
                let name = format!("{place}-{axis}-m");
                Column::number(&name, "m", "Its position").empty_where(missing)
            }));
        }
        columns.extend(self.inference().priors.iter().map(|prior| {
            let meaning = "The parameter of this path";
            if prior.is_continuous() {
                Column::number(&prior.path, "", meaning).empty_where(missing)
            } else {
                Column::text(&prior.path, meaning)
            }
        }));
        columns
    }
}

/// Returns the middle of each of `parts` equal parts of `length` rows.
fn middles(length: usize, parts: usize) -> impl Iterator<Item = usize> {
    (0..parts).map(move |part| (2 * part + 1) * length / (2 * parts.max(1)))
}

fn written(prior: &Prior, number: f64) -> Value {
    if prior.is_continuous() { rounded(number).into() } else { prior.written(number) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_each_part_is_picked() {
        assert_eq!(middles(200, 4).collect::<Vec<_>>(), [25, 75, 125, 175]);
        assert_eq!(middles(200, 20).take(3).collect::<Vec<_>>(), [5, 15, 25]);
        assert_eq!(middles(200, 200).last(), Some(199));
        assert_eq!(middles(2, 3).collect::<Vec<_>>(), [0, 1, 1]);
    }
}
