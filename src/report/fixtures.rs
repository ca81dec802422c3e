//! A synthetic trial and report, to exercise pages without a simulator.

use super::*;
use crate::geometry::{Outline, Point, Pose};
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use crate::math::{cos, sin};
use crate::stats::compatibility::{Agreement, Ours, Printed, Silence};
use crate::stats::summary::Summary;
use crate::studies::recording::{Decision, Frame, FrontierView, Recording};
use crate::studies::{GridCell, GridRow, Measured};

/// Records a robot that drives along two rooms of 12 by 6 m for `frames` tenths of a second and maps what is near.
pub(super) fn recording(frames: usize) -> Recording {
    let prior_frame =
        GridFrame { resolution: 0.05, origin: Point::new(-0.5, -0.5), width: 260, height: 140 };
    // The robot maps in the frame it began in, which the world does not share.
    let map_pose = Pose::new(1.0, 3.0, 0.45);
    let frame =
        GridFrame { resolution: 0.05, origin: Point::new(-3.0, -9.0), width: 320, height: 300 };
    let cell_of = |p: Point| frame.cell_at(map_pose.inverse_transform(p));
    let wall = |x0, y0, x1, y1| {
        Outline::Polygon(vec![
            Point::new(x0, y0),
            Point::new(x1, y0),
            Point::new(x1, y1),
            Point::new(x0, y1),
        ])
    };
    let world = vec![
        wall(-0.1, -0.1, 12.1, 0.0),
        wall(-0.1, 6.0, 12.1, 6.1),
        wall(-0.1, 0.0, 0.0, 6.0),
        wall(12.0, 0.0, 12.1, 6.0),
        wall(5.95, 0.0, 6.05, 2.4),
        wall(5.95, 3.6, 6.05, 6.0),
        wall(2.0, 4.6, 3.2, 5.4),
        Outline::Circle { center: Point::new(9.0, 1.6), radius: 0.5 },
    ];
    let solid = |p: Point| world.iter().any(|o| o.contains(p));
    let mut prior = OccupancyGrid::filled(prior_frame, Occupancy::Unknown);
    for cell in prior_frame.cells() {
        let p = prior_frame.center(cell);
        let inside = (-0.1..12.1).contains(&p.x) && (-0.1..6.1).contains(&p.y);
        let wall = world[..6].iter().any(|o| o.contains(p));
        if inside {
            prior.set(cell, if wall { Occupancy::Occupied } else { Occupancy::Free });
        }
    }
    let mut map = OccupancyGrid::filled(frame, Occupancy::Unknown);
    let mut out = Vec::new();
    for i in 0..frames {
        let count = |n: usize| f64::from(u32::try_from(n).unwrap());
        let (t, part) = (count(i) / 10.0, count(i) / count(frames));
        let pose =
            Pose::new(1.0 + 10.0 * part, 3.0 + 0.5 * sin(part * 9.0), 0.45 * cos(part * 9.0));
        let mut now = Frame {
            time_s: t,
            pose,
            distance_m: 11.5 * part,
            coverage_percent: 100.0 * (1.0 - (1.0 - part) * (1.0 - part)),
            ..Frame::default()
        };
        if i % 5 == 0 {
            let ends = (0..180).map(|k| {
                let angle = pose.heading + f64::from(k - 90) * 0.0209;
                let direction = Point::new(cos(angle), sin(angle));
                let mut range = 0.1;
                while range < 4.0 && !solid(pose.position() + direction * range) {
                    let cell = cell_of(pose.position() + direction * range);
                    if map.at(cell) == Occupancy::Unknown {
                        map.set(cell, Occupancy::Free);
                        now.map_changes.push((cell, Occupancy::Free));
                    }
                    range += 0.04;
                }
                let end = pose.position() + direction * range;
                let cell = cell_of(end);
                if range < 4.0 && map.at(cell) != Occupancy::Occupied {
                    map.set(cell, Occupancy::Occupied);
                    now.map_changes.push((cell, Occupancy::Occupied));
                }
                end
            });
            now.scan = Some(ends.collect());
        }
        if i % 10 == 0 {
            now.decision = Some(decision(pose));
            let to = now.decision.as_ref().unwrap().frontiers[0].candidate;
            now.path = Some(vec![pose.position(), Point::new(to.x, pose.y), to]);
            now.event = Some(format!("goes to the frontier at ({:.1}, {:.1})", to.x, to.y));
        }
        out.push(now);
    }
    Recording {
        world,
        footprint: Outline::Circle { center: Point::ZERO, radius: 0.18 },
        prior: Some(prior),
        map_frame: frame,
        map_pose,
        frames: out,
        ..Recording::default()
    }
}

fn decision(pose: Pose) -> Decision {
    let frontier = |x: f64, y: f64, utility: f64| FrontierView {
        cells: (0..14).map(|k| Point::new(x, y + 0.05 * f64::from(k))).collect(),
        candidate: Point::new(x, y + 0.35),
        distance_m: pose.position().distance(Point::new(x, y)),
        gain_m2: 9.0 * utility,
        utility,
    };
    Decision {
        frontiers: vec![
            frontier((pose.x + 2.6).min(11.6), 2.7, 0.83),
            frontier(1.2, 0.6, 0.41),
            frontier(4.6, 4.9, 0.57),
        ],
        chosen: Some(0),
    }
}

/// Returns a report with one of everything.
pub(super) fn content() -> ReportContent {
    let measured = |mean: f64, sd: f64| Some(Measured { mean, sd: Some(sd), n: Some(10) });
    let columns = ["no prior", "floor plan", "footprint", "bounding box"];
    let rows = [70.0, 80.0, 90.0, 95.0].map(|coverage: f64| {
        let cells = [(1.0, 1.02), (0.55, 0.62), (0.75, 1.4), (0.85, 0.86)];
        let cells = cells.iter().enumerate().map(|(i, (paper, ours))| {
            let base = coverage - 45.0;
            let (ours, published) = (measured(base * ours, 3.1), measured(base * paper, 3.46));
            let found = Summary { n: 10, mean: ours.unwrap().mean, sd: 3.1 };
            let missing = coverage > 94.0 && i == 2;
            GridCell {
                ours: if missing { None } else { ours },
                difference_percent: (i > 0 && !missing)
                    .then(|| (ours.unwrap().mean / base / 1.02 - 1.0) * 100.0),
                published,
                published_difference_percent: (i > 0).then(|| (paper - 1.0) * 100.0),
                agreement: Agreement::between(
                    if missing { Err(Silence::NotReached) } else { Ok(Ours::Mean(found)) },
                    Some(Printed { value: base * paper, sd: Some(3.46), n: Some(10) }),
                ),
                band: None,
            }
        });
        GridRow { label: format!("{coverage} %"), cells: cells.collect() }
    });
    let figure = |id: &str, title: &str, svg: String| Figure {
        id: id.into(),
        title: title.into(),
        caption:
            "Curves are medians over ten trials, bands the middle half; hollow marks are published."
                .into(),
        alt: format!("{title}: the floor plan needs the shortest way at every coverage"),
        svg,
        file: format!("results/figures/{id}.svg"),
    };
    let table = ReportTable {
        id: "table-1".into(),
        title: "Distance to coverage, basic environment, furnished".into(),
        source: "Table 1".into(),
        quantity: "distance travelled (m)".into(),
        beside: "paper".into(),
        decimals: 2,
        row_header: "coverage".into(),
        columns: columns.map(String::from).to_vec(),
        rows: rows.to_vec(),
    };
    ReportContent {
        title: "Exploration with prior knowledge: the basic environment".into(),
        checked: "checked to level 3 (derived): the bundle is what it says".into(),
        citation: Citation {
            paper: "M. Luperto, M. Antonazzi, F. Amigoni, N. A. Borghese, “Robot exploration of indoor environments using incomplete and inaccurate prior knowledge”, Robotics and Autonomous Systems, 2020".into(),
            section: "section 4.2, Tables 1 and 2".into(),
            doi: "10.1000/182".into(),
        },
        authors: vec!["A. Author".into(), "B. Author".into()],
        license: "CC-BY-4.0".into(),
        limits: vec![
            "The simulator is not the one of the paper: bodies, contacts and sensors are modelled anew.".into(),
            "Ten trials a cell give wide intervals; differences of a few percent mean nothing.".into(),
        ],
        partial: Some("only prior=none,floor-plan; no claim is judged".into()),
        answers: vec![Answer {
            table: "table-1".to_owned(),
            question: "Which strategy reaches the goal in time?".to_owned(),
            answer: "The third, in 59 % of its trials.".to_owned(),
        }],
        headline: Headline {
            study: "prior-map".into(),
            trials: 40,
            conditions: 4,
            outcomes: vec![
                OutcomeCount { name: "explored".into(), count: 38 },
                OutcomeCount { name: "stuck".into(), count: 2 },
            ],
            sim_seconds: 12_345.6,
            seed: 2020,
            results_digest: "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".into(),
            bundle_id: "60303ae22b998861bce3b28f33eec1be758a213c86c93c076dbe9f558c11c752".into(),
            engine_version: "1".into(),
        },
        tables: vec![table],
        figures: vec![
            figure("coverage", "Coverage over distance", crate::figure::tests::line_chart(&columns[..3]).to_svg()),
            figure("bars", "Distance by coverage", crate::figure::tests::bar_chart().to_svg()),
            figure("scatter", "Paper against us", crate::figure::tests::scatter().to_svg()),
        ],
        claims: claims(),
        compared: String::new(),
        machine_claims: vec![ClaimRow {
            id: "P21".into(),
            says: "a selection takes milliseconds".into(),
            cite: "section 3.3".into(),
            verdict: "supported".into(),
            numbers: "median 0.002 (0.001 to 0.003), p 1.00e-3 at alpha 0.05 by binomial".into(),
            paper_table: "silent".into(),
            ..ClaimRow::default()
        }],
        assumptions: assumptions(),
        tried_with: Some("15 trials per condition, one setting at a time, same noise".into()),
        multiverse: Some(multiverse::tests::sample()),
        provenance: Provenance {
            facts: vec![("engine version".into(), "1".into()), ("sealed by".into(), "reenact 0.1.0".into())],
            overrides: vec!["seed=7".into()],
            inputs: vec![InputRow {
                role: "world".into(),
                written: "../worlds/basic.yaml".into(),
                sealed: "inputs/basic.yaml".into(),
                license: "CC-BY-4.0".into(),
                sha256: "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855".into(),
            }],
        },
        evaluation: evaluation::evaluation(evaluation::Evaluated {
            file: "prior-9f86d081.zip",
            trial: "basic_none/0",
            trials: 40,
            sim_seconds: 12_345.6,
            partial: false,
            judged: true,
            circumstance: None,
        }),
    }
}

/// Returns a claim that we and the paper's table decide differently, one on which both agree, and a check of our own.
fn claims() -> Vec<ClaimRow> {
    let compared = |verdict: &str| ComparisonRow {
        about: "distance-m-at-90: (prior=floor-plan) < (prior=none)".into(),
        verdict: verdict.into(),
        finding: "−38 % (95 % interval −51 % to −22 %)".into(),
        test: "p = 0.002 (permutation)".into(),
        cells: vec!["prior=none: mean 45.90 ± 3.10, 10 runs".into()],
    };
    vec![
        ClaimRow {
            id: "P1".into(),
            says: "a floor plan shortens the way to 90 % coverage".into(),
            cite: "section 4.2".into(),
            verdict: "supported".into(),
            numbers: "−38 % (95 % interval −51 to −22 %); p = 0.002 (permutation)".into(),
            paper_table: "supports".into(),
            why: "one number a run".into(),
            rule: "Level of significance 0.05.".into(),
            notes: vec!["reached by 9 of 10".into()],
            comparisons: vec![compared("supported")],
            ..ClaimRow::default()
        },
        ClaimRow {
            id: "P2".into(),
            says: "a footprint never harms".into(),
            cite: "section 5".into(),
            verdict: "contradicted".into(),
            numbers: "+40 % (95 % interval 12 to 71 %)".into(),
            paper_table: "supports".into(),
            differs: "The paper's own table supports its sentence; our trials contradict it."
                .into(),
            comparisons: vec![compared("contradicted"), compared("inconclusive")],
            ..ClaimRow::default()
        },
        ClaimRow {
            id: "P3".into(),
            ours: "gains here go with those printed".into(),
            verdict: "inconclusive".into(),
            numbers: "rank correlation +0.20 (95 % interval −0.10 to +0.50)".into(),
            paper_table: "silent".into(),
            ..ClaimRow::default()
        },
    ]
}

/// Returns one assumption without a range, one that decides nothing within its range, one that decides a verdict.
fn assumptions() -> Vec<Assumption> {
    let tried = |at: &str, flips: &[FlipRow]| Tried { at: at.into(), flips: flips.to_vec() };
    let flip = |claim: &str, from: &str, to: &str| FlipRow {
        claim: claim.into(),
        from: from.into(),
        to: to.into(),
    };
    vec![
        Assumption {
            path: "parameters.mapping.particles".into(),
            value: "1".into(),
            why: "odometry is exact in the paper's simulator, so more than one particle changes nothing".into(),
            range: Vec::new(),
            tried: None,
        },
        Assumption {
            path: "parameters.exploration.alpha".into(),
            value: "0.4".into(),
            why: "the paper gives no number; the authors' program has this one".into(),
            range: vec!["0.2".into(), "0.6".into()],
            tried: Some(vec![tried("0.2", &[]), tried("0.6", &[])]),
        },
        Assumption {
            path: "parameters.drive.speed-m-s".into(),
            value: "0.5".into(),
            why: "the robot's datasheet".into(),
            range: vec!["0.3".into(), "0.7".into()],
            tried: Some(vec![
                tried("0.3", &[flip("P1", "supported", "inconclusive")]),
                tried("0.7", &[]),
            ]),
        },
    ]
}

/// Asserts that nothing in `page` is fetched from anywhere, and that no inline handler is left for the policy to stop.
pub(super) fn assert_offline(page: &str) {
    for word in
        ["http://", "https://", "src=", "@import", "url(", "<link rel=\"style", "onclick", "onload"]
    {
        assert!(!page.contains(word), "the page contains {word}");
    }
    assert!(page.starts_with("<!doctype html>") && page.trim_end().ends_with("</html>"));
}
