//! Proposals of the deadline study for an inference, at graph level: the real mind walks through the building from every vertex,
//! every walk is timed by every supposed pace, and goal and starts are placed everywhere.
//!
//! Given building, goal, rules and pace, the rows of the table are independent of one another, for each has a start of its own:
//! the likelihood of all placements of the starts is the product over starts of a mean over vertices.

mod model;
mod rounds;
mod score;
mod timing;
mod walk;

#[cfg(test)]
mod tests;

use crate::rng::{Seeds, Stream};
use crate::stats::{length, real};
use crate::studies::Setup as AnySetup;
use crate::studies::deadline::Parameters;
use crate::studies::inference::{
    Cells, Drawn, Inference, Likelihoods, Proposal, Proposing, stratified,
};

use model::{Bears, Model};
use rounds::{Group, Near, importance, round};
use score::Scores;
use timing::{Cuts, Hazards, Sums, Timing};
use walk::{Site, Walk};

/// Points of the prior that share their times: hazards cost less to suppose.
const HAZARDS: usize = 8;

/// What a point of the prior gives, by variant and start.
type Reached = Vec<Vec<Sums>>;

/// Proposals at graph level.
#[derive(Debug)]
pub(in crate::studies::deadline) struct AtGraphLevel;

impl Proposing for AtGraphLevel {
    fn refuses(&self, setup: &AnySetup, inference: &Inference) -> Vec<(Option<String>, String)> {
        Model::new(setup, inference).err().into_iter().collect()
    }

    fn placements(&self, inference: &Inference) -> Vec<String> {
        let starts = inference.observed.factor("start");
        let starts = starts.map_or_else(Vec::new, |start| inference.observed.levels(start));
        let starts = starts.into_iter().map(|start| format!("start-{start}"));
        std::iter::once("goal".to_owned()).chain(starts).collect()
    }

    fn place(&self, setup: &AnySetup, number: f64) -> Option<(String, [f64; 2])> {
        let (tag, at) = model::place(setup, index(number))?;
        Some((tag, [at.x, at.y]))
    }

    fn is_of_the_model(&self, path: &str) -> bool {
        path.starts_with("graph.")
    }

    fn predict(
        &self,
        setup: &AnySetup,
        inference: &Inference,
        seeds: &Seeds,
    ) -> Result<Drawn, String> {
        let model = Model::new(setup, inference).map_err(|(_, why)| why)?;
        let mut stream = seeds.stream("prior");
        let priors: Vec<f64> =
            inference.priors.iter().map(|prior| prior.at(stream.uniform())).collect();
        let concentration = stream.below(inference.concentration.len() as u64);
        let mut below = |count: usize| index(real(stream.below(count.max(1) as u64)));
        let goal = below(model.goals.len());
        let starts: Vec<usize> = (0..model.starts)
            .map(|_| any_but(model.goals[goal], below(model.topology.vertices.len() - 1)))
            .collect();
        let parameters = model.parameters(&priors)?;
        let maneuvers = model.maneuvers(&parameters);
        let site = Site { topology: model.topology, places: &model.places, maneuvers: &maneuvers };
        let mut walking = seeds.stream("walks");
        let mut cells = vec![[0.0; 2]; inference.observed.cells.len()];
        let with_times = inference.times.is_some();
        let mut times = vec![None; if with_times { cells.len() } else { 0 }];
        for (row, start) in starts.iter().enumerate() {
            let columns: Vec<usize> =
                (0..model.columns.len()).filter(|column| model.columns[*column].0 == row).collect();
            let deadlines: Vec<f64> =
                columns.iter().map(|column| model.columns[*column].1).collect();
            let pace = model.pace(&parameters);
            let timing = Timing::new(pace, &parameters.rules.schedule, &deadlines);
            let hazards = Hazards::of(&pace);
            let (mut cuts, mut survivals) = (Cuts::default(), Vec::new());
            for strategy in 0..model.strategies.len() {
                let rules = model.rules(&parameters, strategy);
                let mut sums = Sums::none(model.goals.len(), deadlines.len(), with_times);
                for walk in 0..u64::from(inference.walks) {
                    let place = (row * model.strategies.len() + strategy) as u64;
                    let stream = walking.at(place * u64::from(inference.walks) + walk);
                    let legs = site.walk(&rules, *start, stream);
                    let walk = Walk::new(*start, legs, &model.goal_at);
                    timing.cut(&walk.legs, &mut cuts);
                    hazards.add(&walk, &cuts, &mut survivals, &mut sums);
                }
                sums.divide(f64::from(inference.walks));
                for (t, column) in columns.iter().enumerate() {
                    let at = goal * deadlines.len() + t;
                    let cell = model.cells[*column][strategy];
                    cells[cell] = [sums.reached[at], sums.collided[at]];
                    if with_times {
                        times[cell] = sums.time_s(at);
                    }
                }
            }
        }
        let mut values = vec![real(model.goals[goal] as u64)];
        values.extend(starts.iter().map(|start| real(*start as u64)));
        values.extend(priors);
        values.push(real(concentration));
        Ok(Drawn { values, cells, times })
    }

    fn propose(
        &self,
        setup: &AnySetup,
        inference: &Inference,
        likelihoods: &Likelihoods,
        truths: &[Drawn],
        seeds: &Seeds,
    ) -> Result<Proposal, String> {
        let model = Model::new(setup, inference).map_err(|(_, why)| why)?;
        let mut stream = seeds.stream("prior");
        // What bears on all walks is drawn once: walks take longest.
        let mut fixed: Vec<f64> = inference.priors.iter().map(|prior| prior.at(0.0)).collect();
        for (value, (prior, bears)) in
            fixed.iter_mut().zip(inference.priors.iter().zip(&model.bears))
        {
            if *bears == Bears::Walk {
                *value = prior.at(stream.uniform());
            }
        }
        let variants = variants(&model, &fixed);
        let walks = Walks::of(&model, &variants, seeds)?;
        let bearing = |what: Bears| -> Vec<usize> {
            (0..fixed.len()).filter(|prior| model.bears[*prior] == what).collect()
        };
        let (paced, hazards) = (bearing(Bears::Pace), bearing(Bears::Hazard));
        let timings = (inference.points as usize).div_ceil(HAZARDS);
        let points = timings * HAZARDS;
        let paces = stratified(paced.len(), timings, &mut stream);
        let others = stratified(hazards.len() + 1, points, &mut stream);
        let even = paces.into_iter().zip(others.chunks(HAZARDS));
        let first: Vec<Group> =
            even.map(|(pace, others)| Group { pace, others: others.to_vec() }).collect();
        let mut scores = Scores::new(&model, &variants, likelihoods, truths, points, seeds);
        let deadlines: Vec<f64> = model.columns.iter().map(|(_, deadline)| *deadline).collect();
        let suppose = |group: &Group| -> Result<(Vec<Supposed>, Vec<Reached>), String> {
            let supposed: Vec<Supposed> = group
                .others
                .iter()
                .map(|other| {
                    let mut values = fixed.clone();
                    let shares = paced.iter().zip(&group.pace).chain(hazards.iter().zip(other));
                    for (prior, share) in shares {
                        values[*prior] = inference.priors[*prior].at(*share);
                    }
                    let count = length(&inference.concentration);
                    let concentration =
                        index((other[hazards.len()] * count).floor().min(count - 1.0));
                    Supposed { values, concentration }
                })
                .collect();
            let parameters: Vec<Parameters> = supposed
                .iter()
                .map(|supposed| model.parameters(&supposed.values))
                .collect::<Result<_, _>>()?;
            let schedule = &parameters[0].rules.schedule;
            let timed = Timing::new(model.pace(&parameters[0]), schedule, &deadlines);
            let hazards: Vec<Hazards> =
                parameters.iter().map(|parameters| Hazards::of(&model.pace(parameters))).collect();
            Ok((supposed, walks.timed(&model, &timed, &hazards)))
        };
        // Simulated tables are held against the first round, for the others lie where the observed one is explained.
        for (number, group) in first.iter().enumerate() {
            let (supposed, sums) = suppose(group)?;
            for (place, (supposed, sums)) in supposed.iter().zip(&sums).enumerate() {
                let number = Some(number * HAZARDS + place);
                if inference.rounds == 1 {
                    scores.simulate(None, supposed, sums);
                    scores.add(number, supposed, sums, 1.0);
                } else {
                    scores.simulate(number, supposed, sums);
                }
            }
        }
        let mut stream = seeds.stream("rounds");
        let (mut groups, mut near) = (first, None);
        for left in (1..inference.rounds).rev() {
            let mut weights = Vec::with_capacity(groups.len());
            for group in &groups {
                let (supposed, sums) = suppose(group)?;
                let each = supposed.iter().zip(&sums).zip(&group.others);
                let weight = |((one, sums), other): ((&Supposed, &Reached), &Vec<f64>)| {
                    scores.explains(one, sums) * importance(near.as_ref(), &group.pace, other)
                };
                weights.push(each.map(weight).collect::<Vec<f64>>());
            }
            near = Near::of(&groups, &weights);
            let each = (paced.len(), hazards.len() + 1);
            groups = round(near.as_ref(), each, (timings, HAZARDS), &mut stream);
            if left > 1 {
                continue;
            }
            for group in &groups {
                let (supposed, sums) = suppose(group)?;
                for ((supposed, sums), other) in supposed.iter().zip(&sums).zip(&group.others) {
                    let weight = importance(near.as_ref(), &group.pace, other);
                    scores.add(None, supposed, sums, weight);
                }
            }
        }
        Ok(scores.finish())
    }
}

/// One way to go by: a strategy with a value of every prior that bears on it.
pub(super) struct Variant {
    /// The strategy's place among the table's.
    strategy: usize,
    /// Values of all priors; of those that bear on something else, any.
    values: Vec<f64>,
}

/// Returns every variant of every strategy, strategy by strategy.
fn variants(model: &Model<'_>, fixed: &[f64]) -> Vec<Variant> {
    let mut all = Vec::new();
    for strategy in 0..model.strategies.len() {
        let mut crossed = vec![fixed.to_vec()];
        for (index, prior) in model.inference.priors.iter().enumerate() {
            if model.bears[index] != Bears::Strategy(strategy) {
                continue;
            }
            let with = |values: &Vec<f64>| {
                let values = values.clone();
                (0..prior.values().len()).map(move |value| {
                    let mut values = values.clone();
                    values[index] = real(value as u64);
                    values
                })
            };
            crossed = crossed.iter().flat_map(with).collect();
        }
        all.extend(crossed.into_iter().map(|values| Variant { strategy, values }));
    }
    all
}

/// A point of the prior: values of all priors, and the index of the concentration.
pub(super) struct Supposed {
    values: Vec<f64>,
    concentration: usize,
}

/// Walks of every variant from every vertex.
struct Walks {
    /// By variant, then by start, then by number.
    walks: Vec<Vec<Vec<Walk>>>,
}

impl Walks {
    fn of(model: &Model<'_>, variants: &[Variant], seeds: &Seeds) -> Result<Self, String> {
        let mut stream = seeds.stream("walks");
        let vertices = model.topology.vertices.len();
        let count = u64::from(model.inference.walks);
        let mut walks = Vec::with_capacity(variants.len());
        for (number, variant) in variants.iter().enumerate() {
            let parameters = model.parameters(&variant.values)?;
            let rules = model.rules(&parameters, variant.strategy);
            let maneuvers = model.maneuvers(&parameters);
            let site =
                Site { topology: model.topology, places: &model.places, maneuvers: &maneuvers };
            let from = |start: usize, stream: &mut Stream| {
                let first = (number * vertices + start) as u64 * count;
                (first..first + count)
                    .map(|place| {
                        let legs = site.walk(&rules, start, stream.at(place));
                        Walk::new(start, legs, &model.goal_at)
                    })
                    .collect::<Vec<_>>()
            };
            walks.push((0..vertices).map(|start| from(start, &mut stream)).collect());
        }
        Ok(Self { walks })
    }

    /// Times all walks and gives them to all `hazards`: means by hazard, variant and start.
    fn timed(
        &self,
        model: &Model<'_>,
        timing: &Timing<'_>,
        hazards: &[Hazards],
    ) -> Vec<Vec<Vec<Sums>>> {
        let with_times = model.inference.times.is_some();
        let none = Sums::none(model.goals.len(), model.columns.len(), with_times);
        let (mut cuts, mut survivals) = (Cuts::default(), Vec::new());
        let mut all: Vec<Vec<Vec<Sums>>> = vec![Vec::new(); hazards.len()];
        for starts in &self.walks {
            for variants in &mut all {
                variants.push(Vec::with_capacity(starts.len()));
            }
            for walks in starts {
                let mut sums = vec![none.clone(); hazards.len()];
                for walk in walks {
                    timing.cut(&walk.legs, &mut cuts);
                    for (hazards, sums) in hazards.iter().zip(&mut sums) {
                        hazards.add(walk, &cuts, &mut survivals, sums);
                    }
                }
                for (variants, mut sums) in all.iter_mut().zip(sums) {
                    sums.divide(length(walks));
                    if let Some(variant) = variants.last_mut() {
                        variant.push(sums);
                    }
                }
            }
        }
        all
    }
}

/// Returns the vertex `number` of all but one.
fn any_but(one: usize, number: usize) -> usize {
    if number < one { number } else { number + 1 }
}

/// Returns a whole number that is written as one with a fraction.
fn index(number: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole and not negative, as draws hold indices"
    )]
    let index = number as usize;
    index
}
