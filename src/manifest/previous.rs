//! Previous maps: what a robot mapped in an exploration before the experiment's own, as its prior knowledge.
//!
//! Which exploration is part of the manifest, so the map is a function of it. It is run where the manifest is run, and
//! sealed in bundles, so that whoever reads one need not run it again; `verify --level 5` does.

use super::choice::{By, Choice};
use super::document::{ManifestDoc, PreviousMapDoc, PriorDoc, UnknownAs};
use super::experiment::{Assumption, Meanings};
use super::faults::step;
use super::knowledge::{Exploration, Knowledge, Told, UsedPrior, read_as};
use super::library::{InputError, Known, normalised};
use super::lint;
use super::readers;
use super::resolver::Resolver;
use crate::condition::Condition;
use crate::digest::{Sha256Digest, TrialKey};
use crate::document::{Diagnostic, Source, reports};
use crate::grid::OccupancyGrid;
use crate::json;
use crate::rng::Seeds;
use crate::studies::prior_map::{self, PriorMap};
use crate::studies::{Setup, Study, TrialSpec};
use crate::world::floor_plan::{self, FloorPlanSettings};
use crate::world::map_server;
use serde_json::json;
use std::fmt;
use std::string::FromUtf8Error;
use std::sync::Arc;

/// Why an exploration gives no map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExploreError {
    /// The trial is of another study.
    #[error("the study makes no maps")]
    NoMaps,
    /// It cannot run, or maps nothing.
    #[error("{0}")]
    Unmapped(String),
    /// Nothing can stand in for its map.
    #[error(transparent)]
    NoPlan(#[from] floor_plan::FloorPlanError),
}

impl ExploreError {
    fn unmapped(problem: impl fmt::Display) -> Self {
        Self::Unmapped(problem.to_string())
    }
}

impl From<ExploreError> for InputError {
    fn from(error: ExploreError) -> Self {
        Self::other(error)
    }
}

/// Returns the map that the robot of `spec` ends with, as the descriptor and the image `named`: runs the exploration.
///
/// # Errors
/// Where it cannot run or maps nothing.
pub fn explored(spec: &TrialSpec, named: &[String; 2]) -> Result<[Vec<u8>; 2], ExploreError> {
    let map = prior_map::explored_map(spec, setup_of(spec)?).map_err(ExploreError::unmapped)?;
    Ok(map_server::write(&map, &image_beside(named)))
}

/// Returns what stands in for that map where nothing is simulated, with its name and frame but for its size: the floor plan of the
/// world that is explored. It enters no result.
///
/// # Errors
/// Where there is nothing to draw.
pub fn unexplored(spec: &TrialSpec, named: &[String; 2]) -> Result<[Vec<u8>; 2], ExploreError> {
    let setup = setup_of(spec)?;
    let height = setup.robot.lidar.as_ref().map_or(0.0, |lidar| lidar.height);
    let resolution = setup.parameters.mapping.resolution_m;
    let plan = FloorPlanSettings { height, resolution, layers: None };
    let map = floor_plan::floor_plan(&setup.world, plan)?;
    Ok(map_server::write(&map, &image_beside(named)))
}

fn setup_of(spec: &TrialSpec) -> Result<&prior_map::Setup, ExploreError> {
    spec.setup.of().ok_or(ExploreError::NoMaps)
}

fn image_beside([_, image]: &[String; 2]) -> String {
    image.rsplit('/').next().unwrap_or_default().to_owned()
}

/// Returns every previous map of `doc` and where it is written.
fn all(doc: &ManifestDoc) -> Vec<(String, &PreviousMapDoc)> {
    fn collect<'d>(
        choice: &'d Choice<PriorDoc>,
        pointer: &str,
        found: &mut Vec<(String, &'d PreviousMapDoc)>,
    ) {
        match choice {
            Choice::Plain(PriorDoc::Previous(of)) => {
                found.push((format!("{pointer}/previous-map"), &of.previous_map));
            }
            Choice::Plain(_) => {}
            Choice::By(By { values, .. }) => {
                for (level, choice) in values {
                    collect(choice, &step(&format!("{pointer}/values"), level), found);
                }
            }
        }
    }
    let mut found = Vec::new();
    for (name, choice) in &doc.prior_maps {
        collect(choice, &step("/prior-maps", name), &mut found);
    }
    found
}

/// Returns the prior maps that earlier explorations start from, and where they are named.
pub(super) fn priors_then(doc: &ManifestDoc) -> Vec<(String, &str)> {
    all(doc)
        .into_iter()
        .map(|(place, map)| (format!("{place}/prior"), map.prior.as_str()))
        .collect()
}

/// Returns the reasons for the choice of explorations.
pub(super) fn assumptions(doc: &ManifestDoc) -> Vec<Assumption> {
    let assumption = |(pointer, map): (String, &PreviousMapDoc)| Assumption {
        path: pointer[1..].replace('/', "."),
        value: json!({
            "prior": map.prior,
            "trial": map.trial,
            "seed": map.seed,
            "unknown": map.unknown,
        }),
        why: map.why.clone(),
        range: Vec::new(),
    };
    all(doc).into_iter().map(assumption).collect()
}

impl<'a> Resolver<'a> {
    /// Returns the map of the exploration `doc`, written at `pointer`, for the trials of `own`.
    pub(super) fn previous_map<'d>(
        &mut self,
        doc: &'d PreviousMapDoc,
        pointer: &str,
        own: &Exploration<'_>,
        before: &mut Vec<&'d str>,
    ) -> Result<UsedPrior, Told>
    where
        'a: 'd,
    {
        let place = format!("{pointer}/previous-map");
        if let Some(from) = before.iter().position(|name| *name == doc.prior) {
            let circle = before[from..].join("` from `");
            let message = format!("`{circle}` is made from `{}` again", doc.prior);
            let label = "no exploration can be the first";
            self.faults.at(&format!("{place}/prior"), message, label);
            return Err(Told);
        }
        let world = self.world(&doc.world, &format!("{place}/world"), own.condition).ok_or(Told)?;
        let start = match &doc.start {
            None => own.start,
            Some(start) => {
                let place = format!("{place}/start");
                self.start_written(start, &place, Some(&world), own.condition).ok_or(Told)?
            }
        };
        lint::start(&world.world, own.robot, start, &mut self.faults);
        if start.heading != 0.0 {
            let message = "a previous map needs a start that faces along x";
            let label = format!("this start is turned by {} degrees", start.heading.to_degrees());
            let fault = self.faults.fault(&place, message).label(label);
            self.faults.push(fault.help("grids lie along the world's axes"));
            return Err(Told);
        }
        let then = Exploration { world: &world, start, ..*own };
        let prior = self.prior_called(&doc.prior, &then, before)?;
        let seed = doc.seed.unwrap_or(self.doc.seed);
        let meanings = Meanings {
            robot: own.robot.meaning(),
            world: world.meaning,
            prior: prior.as_ref().map(Knowledge::meaning),
        };
        let spec = spec(doc.trial, seed, &then, prior.as_ref(), &meanings);
        let described = json!({
            "previous-map": {
                "world": world.described,
                "start": { "x-m": start.x, "y-m": start.y },
                "prior": prior.as_ref().map(Knowledge::described),
                "trial": doc.trial,
                "seed": seed,
                "exploration": spec.key.short(),
                "unknown": doc.unknown,
            },
        });
        let cache = json!([spec.key, doc.unknown]).to_string();
        let known = self.once(
            |library| &mut library.grids,
            cache,
            |this| this.read_explored(&spec, doc.unknown, &place),
        );
        let (grid, meaning) = known.ok_or(Told)?;
        Ok(UsedPrior { grid, meaning, described, pointer: pointer.to_owned(), own: false })
    }

    fn read_explored(
        &mut self,
        spec: &TrialSpec,
        unknown: UnknownAs,
        pointer: &str,
    ) -> Known<OccupancyGrid> {
        let sealed_as = ["yaml", "pgm"]
            .map(|ending| normalised(&format!("previous-map-{}.{ending}", spec.key.short())));
        match self.map_of(spec, &sealed_as) {
            Ok(grid) => Some(read_as(&grid, *grid.frame(), unknown)),
            Err(problem) => {
                let fault = self.faults.fault(pointer, "this exploration gives no map");
                self.faults.push(fault.label(problem.to_string()));
                None
            }
        }
    }

    fn map_of(
        &mut self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<OccupancyGrid, NoMap> {
        let [descriptor, image] = self.library.files.explore(spec, sealed_as)?;
        let source = Source::new(sealed_as[0].clone(), String::from_utf8(descriptor.to_vec())?);
        readers::explored(&source, &sealed_as[1], &image).map_err(NoMap::Faulty)
    }
}

/// Why an exploration's map cannot be read.
#[derive(Debug, thiserror::Error)]
enum NoMap {
    #[error(transparent)]
    Input(#[from] InputError),
    #[error(transparent)]
    NotText(#[from] FromUtf8Error),
    #[error("{}", reports(.0, false).concat())]
    Faulty(Vec<Diagnostic>),
}

/// Specifies the trial. Its identity holds what a trial's does but for the condition and the engine, and its random
/// streams are no others': an earlier exploration shares noise with no trial of the experiment.
fn spec(
    trial: u32,
    seed: u64,
    then: &Exploration<'_>,
    prior: Option<&Knowledge>,
    meanings: &Meanings,
) -> TrialSpec {
    let Exploration { world, robot, start, parameters, .. } = *then;
    let content = json!({
        "previous-map": trial,
        "seed": seed,
        "robot": meanings.robot,
        "world": meanings.world,
        "prior": meanings.prior,
        "start": [start.x, start.y, start.heading],
        "parameters": parameters,
    });
    let setup = prior_map::Setup::new(
        Arc::clone(&world.world),
        Arc::clone(robot),
        prior.and_then(Knowledge::map).map(|map| Arc::clone(&map.grid)),
        start,
        parameters.clone(),
    )
    .with_topo_metric_map(prior.and_then(Knowledge::topo_metric_map));
    let coordinates = vec![
        ("study".to_owned(), PriorMap.name().to_owned()),
        ("previous-map".to_owned(), trial.to_string()),
    ];
    TrialSpec {
        key: TrialKey(Sha256Digest::of(json::canonical(&content))),
        condition: Condition::default(),
        trial,
        seeds: Seeds::new(seed, coordinates),
        setup: Setup::new(setup),
    }
}
