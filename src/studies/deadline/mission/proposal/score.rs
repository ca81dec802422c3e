//! Placements scored: every goal with every start of every row, against every table.

use super::model::Bears;
use super::{Model, Sums, Supposed, Variant, index};
use crate::math;
use crate::rng::{Seeds, Stream};
use crate::stats::importance::draw;
use crate::stats::{length, real};
use crate::studies::inference::{Below, Drawn, Likelihoods, Place, Proposal};

/// Draws by which the cells of a hold-out are predicted.
const HELD_DRAWS: usize = 4;
/// Draws of the prior that a trial hands on.
const PRIOR_DRAWS: usize = 2;

/// Sums over points and goals, and the draws kept so far.
pub(super) struct Scores<'a> {
    model: &'a Model<'a>,
    variants: &'a [Variant],
    likelihoods: &'a Likelihoods,
    truths: &'a [Drawn],
    /// One variant of every strategy, in every combination.
    combinations: Vec<Vec<usize>>,
    /// By hold-out, the columns from which each strategy's cells are learned.
    trains: Vec<Vec<Vec<bool>>>,
    stream: Stream,
    /// By hold-out: the sum of all likelihoods, and draws by them.
    sums: Vec<f64>,
    kept: Vec<Vec<Drawn>>,
    /// By prior and value: the sum of likelihoods, and how many were summed up.
    by_value: Vec<Vec<(f64, f64)>>,
    simulated: Vec<(f64, Vec<f64>)>,
    /// Points and goals of the prior's draws.
    prior: Vec<(usize, usize)>,
    prior_draws: Vec<Drawn>,
    count: f64,
    count_simulated: f64,
}

/// A point of the prior with what it predicts.
struct Point<'p> {
    values: &'p [f64],
    concentration: usize,
    goal: usize,
    sums: &'p [Vec<Sums>],
    /// How much less likely than by the prior it was drawn.
    weight: f64,
}

/// By start of the table, variant and vertex: the likelihood of the row.
type Rows = Vec<Vec<Vec<f64>>>;

impl<'a> Scores<'a> {
    pub(super) fn new(
        model: &'a Model<'a>,
        variants: &'a [Variant],
        likelihoods: &'a Likelihoods,
        truths: &'a [Drawn],
        points: usize,
        seeds: &Seeds,
    ) -> Self {
        let inference = model.inference;
        let mut combinations = vec![Vec::new()];
        for strategy in 0..model.strategies.len() {
            let own: Vec<usize> =
                (0..variants.len()).filter(|v| variants[*v].strategy == strategy).collect();
            let with = |combination: &Vec<usize>| {
                let combination = combination.clone();
                own.clone().into_iter().map(move |variant| {
                    let mut combination = combination.clone();
                    combination.push(variant);
                    combination
                })
            };
            combinations = combinations.iter().flat_map(with).collect();
        }
        let trains = |part: &crate::studies::inference::HoldOut| {
            let of = |column: &Vec<usize>| {
                column.iter().map(|cell| part.trains(&inference.observed, *cell)).collect()
            };
            model.cells.iter().map(of).collect()
        };
        let mut stream = seeds.stream("draws");
        let mut any = |count: usize| index(real(stream.below(count.max(1) as u64)));
        let prior = (0..PRIOR_DRAWS).map(|_| (any(points), any(model.goals.len()))).collect();
        let values =
            |prior: &crate::studies::inference::Prior| vec![(0.0, 0.0); prior.values().len()];
        let continuous = inference.priors.iter().filter(|prior| prior.is_continuous()).count();
        Self {
            model,
            variants,
            likelihoods,
            truths,
            combinations,
            trains: inference.hold_outs.iter().map(trains).collect(),
            stream,
            sums: vec![0.0; inference.hold_outs.len()],
            kept: vec![Vec::new(); inference.hold_outs.len()],
            by_value: inference.priors.iter().map(values).collect(),
            simulated: vec![(0.0, vec![0.0; continuous]); truths.len()],
            prior,
            prior_draws: Vec::new(),
            count: 0.0,
            count_simulated: 0.0,
        }
    }

    /// Returns the likelihood of the observed table at a point, in the mean over every goal with every start.
    pub(super) fn explains(&self, supposed: &Supposed, sums: &[Vec<Sums>]) -> f64 {
        let Supposed { values, concentration } = supposed;
        let of_goal = |goal: usize| {
            let point = Point { values, concentration: *concentration, goal, sums, weight: 1.0 };
            let rows = self.rows(&point, &self.places(&point), 0, 0);
            let combined = self.combined(goal, &rows);
            combined.iter().sum::<f64>() / length(&combined)
        };
        let goals = self.model.goals.len();
        (0..goals).map(of_goal).sum::<f64>() / real(goals as u64)
    }

    /// Adds a point that was drawn `weight` times less likely than by the prior: every goal with every start. Where it is the point
    /// `of_prior` of the prior itself, it may be one of those that are handed on.
    pub(super) fn add(
        &mut self,
        of_prior: Option<usize>,
        supposed: &Supposed,
        sums: &[Vec<Sums>],
        weight: f64,
    ) {
        let Supposed { values, concentration } = supposed;
        for goal in 0..self.model.goals.len() {
            let point = Point { values, concentration: *concentration, goal, sums, weight };
            let places = self.places(&point);
            self.observed(&point, &places);
            self.count += 1.0;
            self.keep_of_prior(of_prior, &point);
        }
    }

    /// Holds the simulated tables against a point of the prior, as [`Self::add`] the observed one.
    pub(super) fn simulate(
        &mut self,
        of_prior: Option<usize>,
        supposed: &Supposed,
        sums: &[Vec<Sums>],
    ) {
        let Supposed { values, concentration } = supposed;
        for goal in 0..self.model.goals.len() {
            let point = Point { values, concentration: *concentration, goal, sums, weight: 1.0 };
            let places = self.places(&point);
            for table in 0..self.truths.len() {
                self.simulated(&point, &places, table);
            }
            self.count_simulated += 1.0;
            self.keep_of_prior(of_prior, &point);
        }
    }

    fn keep_of_prior(&mut self, number: Option<usize>, point: &Point<'_>) {
        if number.is_some_and(|number| self.prior.contains(&(number, point.goal))) {
            let combination = self.any(self.combinations.len());
            let vertices = self.model.topology.vertices.len();
            let goal = self.model.goals[point.goal];
            let starts: Vec<usize> = (0..self.model.starts)
                .map(|_| super::any_but(goal, self.any(vertices - 1)))
                .collect();
            self.prior_draws.push(self.drawn(point, combination, &starts));
        }
    }

    fn any(&mut self, count: usize) -> usize {
        index(real(self.stream.below(count.max(1) as u64)))
    }

    /// Returns where the likelihood of each prediction stands: by variant, vertex and column.
    fn places(&self, point: &Point<'_>) -> Vec<Vec<Vec<Place>>> {
        let columns = self.model.columns.len();
        let of_start = |sums: &Sums| {
            (0..columns)
                .map(|column| {
                    let at = point.goal * columns + column;
                    Likelihoods::place(sums.reached[at], sums.collided[at], sums.time_s(at))
                })
                .collect()
        };
        point.sums.iter().map(|starts| starts.iter().map(of_start).collect()).collect()
    }

    /// Computes the likelihoods of the rows of `table`, learned from as `part` says.
    fn rows(
        &self,
        point: &Point<'_>,
        places: &[Vec<Vec<Place>>],
        table: usize,
        part: usize,
    ) -> Rows {
        let model = self.model;
        let mut rows: Rows = vec![Vec::with_capacity(self.variants.len()); model.starts];
        for (number, variant) in self.variants.iter().enumerate() {
            let mut own = vec![vec![1.0_f64; model.topology.vertices.len()]; model.starts];
            for (column, (start, _)) in model.columns.iter().enumerate() {
                if !self.trains[part][column][variant.strategy] {
                    continue;
                }
                let cell = model.cells[column][variant.strategy];
                let known = self.likelihoods.of_cell(table, point.concentration, cell);
                let timed = self.likelihoods.of_time(table, point.concentration, cell);
                for (vertex, product) in own[*start].iter_mut().enumerate() {
                    let place = places[number][vertex][column];
                    *product *= f64::from(known[place.counts]);
                    if let Some(timed) = timed {
                        *product *= f64::from(timed[place.time]);
                    }
                }
            }
            for (row, own) in rows.iter_mut().zip(own) {
                row.push(own);
            }
        }
        rows
    }

    /// Computes the likelihood of every combination, in the mean over all starts.
    fn combined(&self, goal: usize, rows: &Rows) -> Vec<f64> {
        let vertices = self.model.topology.vertices.len();
        let vertex = self.model.goals[goal];
        let mut all = vec![1.0; self.combinations.len()];
        for row in rows {
            let mut means = Vec::with_capacity(all.len());
            let mut product = vec![1.0; vertices];
            product[vertex] = 0.0;
            self.multiply(0, &product, row, &mut means);
            for (likelihood, mean) in all.iter_mut().zip(means) {
                *likelihood *= mean / real(vertices as u64 - 1);
            }
        }
        all
    }

    /// Multiplies `product`, by vertex, with every variant of `strategy` and of those after it in turn, and adds up the last products:
    /// one sum for each of the combinations, in their order.
    fn multiply(&self, strategy: usize, product: &[f64], row: &[Vec<f64>], sums: &mut Vec<f64>) {
        if strategy == self.model.strategies.len() {
            sums.push(product.iter().sum());
            return;
        }
        for (variant, own) in self.variants.iter().zip(row) {
            if variant.strategy == strategy {
                let next: Vec<f64> = product.iter().zip(own).map(|(p, own)| p * own).collect();
                self.multiply(strategy + 1, &next, row, sums);
            }
        }
    }

    fn observed(&mut self, point: &Point<'_>, places: &[Vec<Vec<Place>>]) {
        for part in 0..self.trains.len() {
            let rows = self.rows(point, places, 0, part);
            let combined = self.combined(point.goal, &rows);
            let mean = point.weight * combined.iter().sum::<f64>() / length(&combined);
            if part == 0 {
                self.value(point, &combined);
            }
            self.sums[part] += mean;
            let slots = if part == 0 { self.model.inference.draws as usize } else { HELD_DRAWS };
            for slot in 0..slots {
                // A draw that has been kept so far gives way by the share of the new ones in all.
                let gives_way = self.stream.uniform() * self.sums[part] < mean;
                if mean > 0.0 && (gives_way || self.kept[part].len() <= slot) {
                    let drawn = self.posterior(point, &rows, &combined);
                    match self.kept[part].get_mut(slot) {
                        Some(kept) => *kept = drawn,
                        None => self.kept[part].push(drawn),
                    }
                }
            }
        }
    }

    fn value(&mut self, point: &Point<'_>, combined: &[f64]) {
        for (prior, sums) in self.by_value.iter_mut().enumerate() {
            if sums.is_empty() {
                continue;
            }
            if let Bears::Strategy(strategy) = self.model.bears[prior] {
                for (combination, likelihood) in self.combinations.iter().zip(combined) {
                    let value = index(self.variants[combination[strategy]].values[prior]);
                    sums[value].0 += point.weight * likelihood;
                    sums[value].1 += point.weight;
                }
            } else {
                let (sum, count) = &mut sums[index(point.values[prior])];
                *sum += point.weight * combined.iter().sum::<f64>();
                *count += point.weight * length(combined);
            }
        }
    }

    fn simulated(&mut self, point: &Point<'_>, places: &[Vec<Vec<Place>>], table: usize) {
        let rows = self.rows(point, places, table + 1, 0);
        let combined = self.combined(point.goal, &rows);
        let mean = combined.iter().sum::<f64>() / length(&combined);
        let (sum, below) = &mut self.simulated[table];
        *sum += mean;
        let priors = self.model.inference.priors.iter().enumerate();
        let truth = &self.truths[table].values[1 + self.model.starts..];
        let continuous = priors.filter(|(_, prior)| prior.is_continuous());
        for (below, (prior, _)) in below.iter_mut().zip(continuous) {
            if point.values[prior] < truth[prior] {
                *below += mean;
            }
        }
    }

    /// Draws one combination and its starts by their likelihoods.
    fn posterior(&mut self, point: &Point<'_>, rows: &Rows, combined: &[f64]) -> Drawn {
        let combination = draw(combined, &mut self.stream).unwrap_or_default();
        let goal = self.model.goals[point.goal];
        let mut starts = Vec::with_capacity(rows.len());
        for row in rows {
            let mut likelihoods: Vec<f64> = (0..self.model.topology.vertices.len())
                .map(|start| {
                    self.combinations[combination].iter().map(|v| row[*v][start]).product()
                })
                .collect();
            likelihoods[goal] = 0.0;
            starts.push(draw(&likelihoods, &mut self.stream).unwrap_or_default());
        }
        self.drawn(point, combination, &starts)
    }

    fn drawn(&self, point: &Point<'_>, combination: usize, starts: &[usize]) -> Drawn {
        let model = self.model;
        let mut priors = point.values.to_vec();
        let mut cells = vec![[0.0; 2]; model.inference.observed.cells.len()];
        let with_times = model.inference.times.is_some();
        let mut times = vec![None; if with_times { cells.len() } else { 0 }];
        for (strategy, variant) in self.combinations[combination].iter().enumerate() {
            for (prior, bears) in model.bears.iter().enumerate() {
                if *bears == Bears::Strategy(strategy) {
                    priors[prior] = self.variants[*variant].values[prior];
                }
            }
            for (column, (start, _)) in model.columns.iter().enumerate() {
                let sums = &point.sums[*variant][starts[*start]];
                let at = point.goal * model.columns.len() + column;
                let cell = model.cells[column][strategy];
                cells[cell] = [sums.reached[at], sums.collided[at]];
                if with_times {
                    times[cell] = sums.time_s(at);
                }
            }
        }
        let mut values = vec![real(model.goals[point.goal] as u64)];
        values.extend(starts.iter().map(|start| real(*start as u64)));
        values.extend(priors);
        values.push(real(point.concentration as u64));
        Drawn { values, cells, times }
    }

    /// Returns what the building says.
    pub(super) fn finish(mut self) -> Proposal {
        let inference = self.model.inference;
        let ln = |sum: f64, count: f64| math::ln(sum / count);
        let held = |part: usize| {
            let kept = &self.kept[part];
            let cells = 0..inference.observed.cells.len();
            let tested = cells
                .filter(|cell| inference.hold_outs[part].tests(&inference.observed, *cell))
                .filter(|_| !kept.is_empty());
            let mean = |cell: usize| {
                kept.iter().map(|drawn| drawn.cells[cell][0]).sum::<f64>() / length(kept)
            };
            tested.map(|cell| (cell, mean(cell))).collect()
        };
        Proposal {
            ln_evidence: self.sums.iter().map(|sum| ln(*sum, self.count)).collect(),
            by_value: self
                .by_value
                .iter()
                .map(|values| values.iter().map(|(sum, count)| ln(*sum, *count)).collect())
                .collect(),
            held: (1..inference.hold_outs.len()).map(held).collect(),
            simulated: self
                .simulated
                .iter()
                .map(|(sum, below)| Below {
                    ln_evidence: ln(*sum, self.count_simulated),
                    below: below.iter().map(|below| ln(*below, self.count_simulated)).collect(),
                })
                .collect(),
            draws: std::mem::take(&mut self.kept[0]),
            prior: self.prior_draws,
        }
    }
}
