//! What the trials of every study need: a robot in a world, where it starts.

use super::document::{FactorRef, StartDoc};
use super::resolver::Resolver;
use super::used_world::UsedWorld;
use crate::condition::Condition;
use crate::digest::MeaningDigest;
use crate::geometry::Pose;
use crate::robot::Robot;
use crate::units::Radians;
use serde_json::{Value, json};
use std::sync::Arc;

/// What the trials of every study need.
pub(super) struct Parts {
    pub(super) robot: Arc<Robot>,
    pub(super) robot_meaning: MeaningDigest,
    /// The robot as written.
    pub(super) robot_described: Option<Value>,
    pub(super) world: UsedWorld,
    pub(super) start: Pose,
}

impl Resolver<'_> {
    /// Returns the parts of `condition`, where all could be had; the faults of those that could not are collected.
    pub(super) fn parts(&mut self, condition: &Condition) -> Option<Parts> {
        let doc = self.doc;
        let robot = self.choose(&doc.robot, "/robot", condition);
        let robot_described = robot.as_ref().map(|(robot, _)| json!(robot));
        let robot = robot.and_then(|(robot, pointer)| self.robot(robot, &pointer));
        let world = self
            .choose(&doc.world, "/world", condition)
            .and_then(|(world, pointer)| self.world(world, &pointer, condition));
        let start = self.start(world.as_ref(), condition);
        let ((robot, robot_meaning), world, start) = (robot?, world?, start?);
        Some(Parts { robot, robot_meaning, robot_described, world, start })
    }

    fn start(&mut self, world: Option<&UsedWorld>, condition: &Condition) -> Option<Pose> {
        let (start, pointer) = self.choose(&self.doc.start, "/start", condition)?;
        self.start_written(start, &pointer, world, condition)
    }

    /// Returns the start that `start`, written at `pointer`, is in `world`.
    pub(super) fn start_written(
        &mut self,
        start: &StartDoc,
        pointer: &str,
        world: Option<&UsedWorld>,
        condition: &Condition,
    ) -> Option<Pose> {
        match start {
            StartDoc::Pose(pose) => {
                Some(Pose::new(pose.x_m, pose.y_m, Radians::from_degrees(pose.heading_deg).get()))
            }
            StartDoc::Name(name) => self.named_start(name, pointer, world?),
            StartDoc::Factor(FactorRef { factor }) => {
                let place = format!("{pointer}/factor");
                self.faults.check_factor(&self.factors, factor, &place, false)?;
                self.named_start(condition.value(factor)?, &place, world?)
            }
        }
    }

    fn named_start(&mut self, name: &str, pointer: &str, world: &UsedWorld) -> Option<Pose> {
        let starts = &world.world.starts;
        if let Some(pose) = starts.get(name) {
            return Some(*pose);
        }
        let known: Vec<&str> = starts.keys().map(String::as_str).collect();
        let message = format!("unknown start `{name}`");
        self.faults.unknown(pointer, message, "not a start of the world", name, &known);
        None
    }
}
