//! `NavigateToVertex(v, t_d)`: section 4, Algorithm 2.
//!
//! The listing's loop waits for the robot; here the robot's arrivals drive it, one turn of the loop each.

use super::planner::{Action, Plan, PlanError, Planning};
use super::schedule::LocalDeadline;
use super::toposemantic_map::{ToposemanticMap, VertexId};
use crate::rng::Stream;
use crate::studies::deadline::build_cmdp::Maneuvers;

/// A navigation task under way.
#[derive(Debug, Clone)]
pub struct NavigateToVertex {
    /// v.
    target: VertexId,
    /// π*; `None` if the robot was there already: nothing to plan.
    plan: Option<Plan>,
}

/// The result of a turn of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flag {
    /// Line 7: v_c = G.
    GlobalSuccess,
    /// Line 9: v_c = v.
    LocalSuccess,
    /// Lines 10 and 11: execute a.
    Execute(Action),
}

impl NavigateToVertex {
    /// Does lines 2 and 3: `BuildCMDP`, `Solve`.
    ///
    /// # Errors
    /// There is no plan.
    pub fn begin(
        map: &ToposemanticMap,
        current: VertexId,
        target: VertexId,
        deadline: &LocalDeadline,
        planning: &Planning,
        expectations: &Maneuvers,
    ) -> Result<Self, PlanError> {
        let plan = if current == target {
            None
        } else {
            Some(Plan::new(map, current, target, deadline.seconds, planning, expectations)?)
        };
        Ok(Self { target, plan })
    }

    /// Does lines 5 to 11, at `current`. The global deadline of lines 4 and 12 is left to the caller.
    ///
    /// # Errors
    /// The robot is where the plan never leads.
    pub fn step(
        &self,
        map: &ToposemanticMap,
        current: VertexId,
        stream: &mut Stream,
    ) -> Result<Flag, PlanError> {
        if map.is_goal(current) {
            return Ok(Flag::GlobalSuccess);
        }
        match &self.plan {
            Some(plan) if current != self.target => {
                Ok(Flag::Execute(plan.action(current, stream)?))
            }
            _ => Ok(Flag::LocalSuccess),
        }
    }

    /// Returns v.
    pub fn target(&self) -> VertexId {
        self.target
    }

    /// Returns π*, unless the robot was at v already.
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }
}
