//! What a study asks of the manifest for one condition, and what is noted of the answers.

use super::knowledge::Knowledge;
use super::lint;
use super::parameters::Here;
use super::parts::Parts;
use super::resolver::Resolver;
use crate::condition::Condition;
use crate::digest::MeaningDigest;
use crate::studies::Expectations;
use crate::studies::prior_map::{CoverageMap, Parameters, SharedReference};
use crate::studies::{ConditionAsWritten, Graph, Prior, Remark, Surroundings};
use crate::world::topology::{TagScheme, Topology};
use serde_json::{Value, json};
use std::sync::Arc;

/// A condition while its setup is made.
pub(super) struct Asked<'r, 'a> {
    pub(super) resolver: &'r mut Resolver<'a>,
    pub(super) condition: &'r Condition,
    /// Robot, world and start; `None` where one could not be had, which has been told.
    pub(super) parts: Option<Parts>,
    /// The prior knowledge that was asked for.
    pub(super) knowledge: Option<Knowledge>,
    /// What the map means that coverage is counted against.
    pub(super) coverage_map: Option<MeaningDigest>,
}

impl ConditionAsWritten for Asked<'_, '_> {
    fn parameters(&self) -> Value {
        let Resolver { doc, groups, draws, .. } = &*self.resolver;
        let condition = self.condition;
        let here = Here {
            level: &|factor| condition.value(factor),
            drawn: &|reference| draws.as_ref()?.number(reference, condition),
        };
        let mut parameters = doc.parameters.for_condition(groups, &here);
        if let Some(draws) = draws {
            draws.put_into(&mut parameters, condition);
        }
        parameters
    }

    fn refuse_parameters(&mut self, reason: String) {
        let label = format!("for `{}`", self.condition);
        self.resolver.faults.at_key("/parameters", reason, &label);
    }

    fn surroundings(&self) -> Option<Surroundings> {
        self.parts.as_ref().map(|parts| Surroundings {
            robot: Arc::clone(&parts.robot),
            world: Arc::clone(&parts.world.world),
            start: parts.start,
        })
    }

    fn prior(&mut self, own: &Parameters) -> Option<Option<Prior>> {
        let Parts { robot, world, start, .. } = self.parts.as_ref()?;
        let known = self.resolver.prior(self.condition, world, robot, *start, own).ok()?;
        if let Some(map) = known.as_ref().and_then(Knowledge::map) {
            let faults = &mut self.resolver.faults;
            lint::resolution(own.mapping.resolution_m, map, faults);
            // Conditions share worlds and priors; holding one against the other once is enough.
            let pair = (world.meaning, map.meaning, map.pointer.clone());
            if !map.own && self.resolver.aligned.insert(pair) {
                lint::alignment(robot, &world.world, map, faults);
            }
        }
        self.knowledge = known;
        Some(self.knowledge.as_ref().map(|known| match known {
            Knowledge::Map(map) => Prior::Map(Arc::clone(&map.grid)),
            Knowledge::TopoMetric(graph, ..) => Prior::TopoMetric(Arc::clone(graph)),
        }))
    }

    fn coverage_map(&mut self, own: &Parameters) -> Option<Option<CoverageMap>> {
        let Some(path) = &own.measurement.coverage_map else { return Some(None) };
        let start = self.parts.as_ref()?.start;
        let frame = own.measurement.coverage_map_frame;
        let (map, meaning) = self.resolver.coverage_map(path, frame, start)?;
        self.coverage_map = Some(meaning);
        Some(Some(CoverageMap { map, meaning }))
    }

    fn reference(&mut self, parameters: &Value) -> SharedReference {
        let Some(Parts { robot_meaning, world, start, .. }) = &self.parts else {
            return SharedReference::default();
        };
        let meanings = [Some(robot_meaning), Some(&world.meaning), self.coverage_map.as_ref()];
        let key = json!([meanings, start, parameters]).to_string();
        self.resolver.library.references.entry(key).or_default().clone()
    }

    fn graph(&mut self, scheme: &TagScheme) -> Option<Graph> {
        let world = &self.parts.as_ref()?.world;
        let key = format!("{} {scheme:?}", world.meaning);
        let graphs = &mut self.resolver.library.graphs;
        let read = || match Topology::read(&world.world.tags, scheme) {
            Ok(graph) => Ok(Arc::new(graph)),
            Err(faults) => Err(faults.into()),
        };
        Some(graphs.entry(key).or_insert_with(read).clone())
    }

    fn calibration(&mut self) -> Option<Expectations> {
        self.resolver.calibration()
    }

    fn tell(&mut self, remark: Remark) {
        let faults = &mut self.resolver.faults;
        let fault = faults.fault(remark.pointer, remark.message).label(remark.label);
        faults.push(match remark.help {
            Some(help) => fault.help(help),
            None => fault,
        });
    }
}
