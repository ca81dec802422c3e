//! The temporal deadline of one navigation task: section 5, "Temporal Deadline".

use super::rules::parameters;

parameters!(
    /// B is the number of edges to go multiplied by a constant; the less time is available, the smaller the share of it.
    Schedule {
        /// The constant (s per edge), above 0. The paper does not give it: about twice to three times a slow maneuver, so
        /// that the first two steps of the schedule leave time and the last does not.
        #[schemars(extend("exclusiveMinimum" = 0))]
        seconds_per_edge: f64 = 30.0,
        /// t_d is B while more than this share of T is available, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        ample_above: f64 = 0.8,
        /// ... and 0.3 B (`scarce-factor`) where this share or less is, 0 to 1.
        #[schemars(range(min = 0.0, max = 1.0))]
        scarce_below: f64 = 0.5,
        /// What B is multiplied by in between, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        middle_factor: f64 = 0.5,
        /// What B is multiplied by at the end, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        scarce_factor: f64 = 0.3,
    }
);

/// How much of T is left, in the schedule's three steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TimeAvailable {
    /// More than 0.8 T.
    Ample,
    /// Between 0.5 T and 0.8 T.
    Middle,
    /// Less than 0.5 T.
    Scarce,
}

/// t_d and the numbers from which it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalDeadline {
    /// The number of edges between v_c and v.
    pub edges: usize,
    /// The step of the schedule.
    pub available: TimeAvailable,
    /// t_d (s).
    pub seconds: f64,
}

impl Schedule {
    /// Computes t_d for a vertex `edges` away, `now_s` after the beginning of a task with the global deadline
    /// `deadline_s`.
    ///
    /// "The time available to complete the task" is read as what is left of T. The paper leaves the two boundaries
    /// open; they are counted to the tighter step.
    pub fn local_deadline(&self, edges: usize, now_s: f64, deadline_s: f64) -> LocalDeadline {
        let left = deadline_s - now_s;
        #[expect(clippy::cast_precision_loss, reason = "a path has few edges")]
        let preliminary = edges as f64 * self.seconds_per_edge;
        let (available, factor) = if left > self.ample_above * deadline_s {
            (TimeAvailable::Ample, 1.0)
        } else if left > self.scarce_below * deadline_s {
            (TimeAvailable::Middle, self.middle_factor)
        } else {
            (TimeAvailable::Scarce, self.scarce_factor)
        };
        LocalDeadline { edges, available, seconds: factor * preliminary }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t_d_is_b_then_half_then_three_tenths() {
        let schedule = Schedule::default();
        let t_d = |now_s| schedule.local_deadline(4, now_s, 1000.0).seconds;
        assert_eq!([t_d(0.0), t_d(199.0), t_d(201.0), t_d(499.0), t_d(501.0), t_d(999.0)], {
            [120.0, 120.0, 60.0, 60.0, 36.0, 36.0]
        });
        assert_eq!(t_d(1500.0), 36.0, "after the deadline nobody asks, but there is an answer");
    }

    #[test]
    fn the_boundaries_belong_to_the_tighter_step() {
        let step = |now_s| Schedule::default().local_deadline(1, now_s, 10.0).available;
        assert_eq!([step(2.0), step(5.0)], [TimeAvailable::Middle, TimeAvailable::Scarce]);
    }

    #[test]
    fn the_constant_scales_it_and_no_edge_takes_no_time() {
        let schedule = Schedule { seconds_per_edge: 15.0, ..Schedule::default() };
        assert_eq!(schedule.local_deadline(3, 0.0, 100.0).seconds, 45.0);
        assert_eq!(schedule.local_deadline(0, 0.0, 100.0).seconds, 0.0);
    }
}
