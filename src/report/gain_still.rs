//! The gain of a candidate location, with and without prior knowledge, as the prior-knowledge study's Figure 2.

use crate::figure::svg::{Element, document, number};
use crate::figure::{INK, PAPER, cell_runs};
use crate::geometry::Point;
use crate::grid::{Cell, CellSet, GridFrame, Occupancy, OccupancyGrid, visible_runs};
use crate::studies::recording::{Decision, Recording};

/// Width of one panel, and the space between and around them (px).
const PANEL: f64 = 430.0;
const GAP: f64 = 16.0;
const CAPTION: f64 = 40.0;
/// Cells that are counted: light blue, as in the paper.
const GAIN: &str = "#56b4e9";
/// Obstacles of the prior.
const PRIOR: &str = "#e69f00";
/// The candidate location: red, as in the paper.
const CANDIDATE: &str = "#d55e00";
const UNKNOWN: &str = "#c4c7cc";
const OBSTACLE: &str = "#111111";

/// The candidate to draw, and the strategy's view from it.
#[derive(Debug, Clone, Copy)]
pub struct GainView {
    /// The number of the choice in the trial, from 1.
    pub decision: usize,
    /// The number of its frontier, from 1; the chosen one where `None`.
    pub candidate: Option<usize>,
    /// Range of the scanner in cells of the map, above 0.
    pub range_cells: i32,
    /// Whether known obstacles hide what lies behind them where there is no prior.
    pub known_obstacles_occlude: bool,
}

/// Why there is nothing to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum GainError {
    /// The trial has no such choice.
    #[error("the trial has no choice {choice}: there are {count}")]
    NoChoice {
        /// Which was asked for, from 1.
        choice: usize,
        /// How many there are.
        count: usize,
    },
    /// The choice has no such candidate.
    #[error("choice {choice} has no candidate {candidate}: there are {count}")]
    NoCandidate {
        /// Which choice, from 1.
        choice: usize,
        /// Which candidate was asked for, from 1.
        candidate: usize,
        /// How many there are.
        count: usize,
    },
    /// The choice took none of its candidates.
    #[error("choice {choice} chose none of its {count} candidates")]
    NoneChosen {
        /// Which choice, from 1.
        choice: usize,
        /// How many candidates there are.
        count: usize,
    },
}

/// Draws the map at a choice with the candidate; the cells that count without prior knowledge; and where the trial had a prior, the
/// prior over the map, and the cells that count with it (the paper's definition of I(p), section 3.2).
///
/// # Errors
/// Where the trial has no such choice or candidate.
pub fn gain_svg(recording: &Recording, view: GainView) -> Result<String, GainError> {
    let (decision, map) = at_choice(recording, view.decision)?;
    let count = decision.frontiers.len();
    let index = match view.candidate {
        Some(n) => n.checked_sub(1),
        None => decision.chosen,
    };
    let choice = view.decision;
    let frontier = index.and_then(|i| decision.frontiers.get(i)).ok_or(match view.candidate {
        Some(candidate) => GainError::NoCandidate { choice, candidate, count },
        None => GainError::NoneChosen { choice, count },
    })?;
    let home = recording.map_pose.inverse_transform(frontier.candidate);
    let scene = Scene::new(recording, &map, home, view.range_cells);
    let without = scene
        .gain(|cell| view.known_obstacles_occlude && scene.map.at(cell) == Occupancy::Occupied);
    let mut panels = vec![
        scene.panel("(a) the map and the candidate location p", None, false),
        scene.panel(
            &format!("(b) I(p) by the perceivable area: {:.1} m²", scene.area(&without)),
            Some(&without),
            false,
        ),
    ];
    if scene.prior.is_some() {
        let with = scene
            .gain(|cell| scene.map.at(cell) == Occupancy::Occupied || !scene.free_in_prior(cell));
        panels.push(scene.panel("(c) the prior's obstacles over the map", None, true));
        panels.push(scene.panel(
            &format!("(d) I(p) by the prior: {:.1} m²", scene.area(&with)),
            Some(&with),
            true,
        ));
    }
    let (width, height) = (PANEL + GAP, PANEL + CAPTION);
    let rows = if panels.len() > 2 { 2.0 } else { 1.0 };
    let (whole, tall) = (2.0 * width + GAP, rows * height + GAP);
    let ground = Element::new("rect").at("width", whole).at("height", tall).set("fill", PAPER);
    let mut body = vec![ground];
    for (panel, (x, y)) in panels.into_iter().zip([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
    {
        let at = format!("translate({} {})", number(GAP + x * width), number(GAP + y * height));
        body.push(panel.set("transform", at));
    }
    let title = format!(
        "Choice {}: D {:.2} m, I {:.2} m², u {:.3}",
        view.decision, frontier.distance_m, frontier.gain_m2, frontier.utility
    );
    Ok(document(whole, tall, &recording.titled(&title), body))
}

/// Returns the `choice`-th choice of a trial, from 1, and the map on which it was made.
fn at_choice(
    recording: &Recording,
    choice: usize,
) -> Result<(&Decision, OccupancyGrid), GainError> {
    let mut map = OccupancyGrid::filled(recording.map_frame, Occupancy::Unknown);
    let mut count = 0;
    for frame in &recording.frames {
        for (cell, value) in &frame.map_changes {
            map.set(*cell, *value);
        }
        if let Some(decision) = &frame.decision {
            count += 1;
            if count == choice {
                return Ok((decision, map));
            }
        }
    }
    Err(GainError::NoChoice { choice, count })
}

/// Map and prior on one lattice, cut to what the scanner reaches from the candidate.
struct Scene {
    map: OccupancyGrid,
    prior: Option<OccupancyGrid>,
    candidate: Cell,
    range: i32,
}

impl Scene {
    fn new(recording: &Recording, map: &OccupancyGrid, candidate: Point, range: i32) -> Self {
        let whole = *map.frame();
        let (center, margin) = (whole.cell_at(candidate), range + 2);
        let (left, below) = (center.x - margin, center.y - margin);
        let side = 2 * margin + 1;
        let shift = Point::new(f64::from(left), f64::from(below)) * whole.resolution;
        let frame = GridFrame { origin: whole.origin + shift, width: side, height: side, ..whole };
        let moved = |cell: Cell| map.at(Cell::new(cell.x + left, cell.y + below));
        let cut = OccupancyGrid::from_cells(frame, frame.cells().map(moved).collect());
        let prior = recording.prior.as_ref().map(|prior| {
            let value = |cell: Cell| {
                let there = recording.map_pose.transform(frame.center(cell));
                prior.at(prior.frame().cell_at(there))
            };
            OccupancyGrid::from_cells(frame, frame.cells().map(value).collect())
        });
        Self { map: cut, prior, candidate: Cell::new(margin, margin), range }
    }

    fn free_in_prior(&self, cell: Cell) -> bool {
        self.prior.as_ref().is_some_and(|prior| prior.at(cell) == Occupancy::Free)
    }

    /// Returns the unknown cells in sight of the candidate past what is `blocking`.
    fn gain(&self, blocking: impl Fn(Cell) -> bool) -> Vec<Cell> {
        let side = self.map.frame().width;
        let high = Cell::new(side - 1, side - 1);
        let blocked = CellSet::of_words(Cell::new(0, 0), high, |x, y| {
            (0..64).fold(0, |word, bit| word | u64::from(blocking(Cell::new(x + bit, y))) << bit)
        });
        let mut cells = Vec::new();
        visible_runs(self.candidate, self.range, &blocked, |run| {
            let seen = (run.from..=run.to).map(|along| run.cell(along));
            cells.extend(seen.filter(|&cell| self.map.at(cell) == Occupancy::Unknown));
        });
        cells
    }

    /// Returns the area of `cells` (m²).
    fn area(&self, cells: &[Cell]) -> f64 {
        let side = self.map.frame().resolution;
        crate::stats::length(cells) * side * side
    }

    fn panel(&self, caption: &str, gain: Option<&[Cell]>, with_prior: bool) -> Element {
        let scale = PANEL / f64::from(self.map.frame().width);
        let mut cells = Element::new("g")
            .set("transform", format!("translate(0 {CAPTION}) scale({scale})"))
            .set("shape-rendering", "crispEdges");
        let side = self.map.frame().width;
        let ground = Element::new("rect").set("width", side).set("height", side);
        cells.push(ground.set("fill", UNKNOWN));
        let mut fill = |data: String, colour: &str| {
            if !data.is_empty() {
                cells.push(Element::new("path").set("d", data).set("fill", colour));
            }
        };
        fill(cell_runs(&self.map, |_, value| value == Occupancy::Free), PAPER);
        if let Some(gain) = gain {
            let mut counted = OccupancyGrid::filled(*self.map.frame(), Occupancy::Unknown);
            for cell in gain {
                counted.set(*cell, Occupancy::Free);
            }
            fill(cell_runs(&counted, |_, value| value == Occupancy::Free), GAIN);
        }
        if let Some(prior) = self.prior.as_ref().filter(|_| with_prior) {
            fill(cell_runs(prior, |_, value| value == Occupancy::Occupied), PRIOR);
        }
        fill(cell_runs(&self.map, |_, value| value == Occupancy::Occupied), OBSTACLE);
        let at = |cell: i32| (f64::from(cell) + 0.5) * scale;
        let spot = Element::new("circle")
            .at("cx", at(self.candidate.x))
            .at("cy", CAPTION + at(side - 1 - self.candidate.y))
            .at("r", 5.0)
            .set("fill", CANDIDATE)
            .set("stroke", PAPER);
        let words = Element::new("text").at("x", 0.0).at("y", CAPTION - 12.0).at("font-size", 15.0);
        let frame = Element::new("rect").at("y", CAPTION).at("width", PANEL).at("height", PANEL);
        Element::new("g")
            .child(cells)
            .child(frame.set("fill", "none").set("stroke", INK))
            .child(spot)
            .child(words.set("fill", INK).text(caption))
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::recording;
    use super::*;

    fn view(candidate: Option<usize>) -> GainView {
        GainView { decision: 1, candidate, range_cells: 80, known_obstacles_occlude: true }
    }

    #[test]
    fn a_prior_promises_no_more_than_the_whole_area() {
        let recording = recording(40);
        let svg = gain_svg(&recording, view(Some(1))).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
        let area = |panel: &str| -> f64 {
            let rest = svg.split(panel).nth(1).unwrap().split(" m²").next().unwrap();
            rest.rsplit(' ').next().unwrap().parse().unwrap()
        };
        let (without, with) = (area("(b) I(p)"), area("(d) I(p)"));
        assert!(with > 0.0 && with < without, "{with} of {without}");
        assert!(without <= std::f64::consts::PI * 16.0 + 0.1, "a disc of 4 m: {without}");
    }

    #[test]
    fn without_a_prior_there_are_two_panels() {
        let mut recording = recording(40);
        recording.prior = None;
        let svg = gain_svg(&recording, view(Some(1))).unwrap();
        assert!(svg.contains("(b) I(p)") && !svg.contains("(c) ") && !svg.contains(PRIOR));
    }

    #[test]
    fn what_is_not_there_is_told_with_what_is() {
        let recording = recording(40);
        let fault = |view| gain_svg(&recording, view).unwrap_err().to_string();
        let many = fault(GainView { decision: 999, ..view(None) });
        assert!(many.starts_with("the trial has no choice 999: there are "), "{many}");
        let none = fault(view(Some(99)));
        assert!(none.starts_with("choice 1 has no candidate 99: there are "), "{none}");
        assert!(fault(view(Some(0))).starts_with("choice 1 has no candidate 0"));
    }
}
