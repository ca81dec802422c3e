//! The tour completed on-line: the choice of the next frontier.

use super::graph::TopoMetricMap;
use super::salesperson::open_tour;
use crate::geometry::Point;

/// A tour under way, in the frame of the robot's map.
#[derive(Debug)]
pub struct Tour {
    /// Assumed positions of the nodes (m).
    nodes: Vec<Point>,
    /// Lengths of the shortest paths between them over edges (m).
    distances: Vec<Vec<f64>>,
    /// The nodes still to be visited, in the order of the tour.
    ahead: Vec<usize>,
    /// The node whose surroundings were explored last; `None` before the first choice.
    place: Option<usize>,
}

impl Tour {
    /// Creates a tour over all nodes of `map`, which is in the frame of the robot's map. It is planned at the first
    /// choice, from where the robot then is.
    pub fn new(map: &TopoMetricMap) -> Self {
        let nodes = map.positions();
        let ahead = (0..nodes.len()).collect();
        Self { nodes, distances: map.distances(), ahead, place: None }
    }

    /// Returns the nodes still to be visited, in the order of the tour.
    pub fn ahead(&self) -> &[usize] {
        &self.ahead
    }

    /// Returns the worth of each of `frontiers` (candidate locations, m), from 1 for the next one down to above 0, for
    /// a robot at `robot` whose map knows the places for which `is_known` holds.
    ///
    /// A frontier belongs to the nearest node still to be visited. Nodes that are known and have no frontier are
    /// finished: they are left out, and the rest of the tour is planned anew from the node that was explored last. The
    /// frontiers of the tour's first node that has any come first, those of the next one next; within a node, and once
    /// no node is left, the nearest comes first.
    pub fn rank(
        &mut self,
        robot: Point,
        frontiers: &[Point],
        is_known: impl Fn(Point) -> bool,
    ) -> Vec<f64> {
        let owners: Vec<Option<usize>> =
            frontiers.iter().map(|&frontier| nearest(&self.nodes, &self.ahead, frontier)).collect();
        let before = self.ahead.len();
        let nodes = &self.nodes;
        self.ahead.retain(|&node| owners.contains(&Some(node)) || !is_known(nodes[node]));
        let is_new = self.place.is_none();
        let place = self.place.or_else(|| {
            let all: Vec<usize> = (0..self.nodes.len()).collect();
            nearest(&self.nodes, &all, robot)
        });
        if let Some(place) = place
            && (is_new || self.ahead.len() < before)
        {
            // The plan does not depend on how the tour ran before.
            self.ahead.sort_unstable();
            self.ahead = open_tour(&self.distances, place, &self.ahead);
        }
        let next = self.ahead.iter().find(|node| owners.contains(&Some(**node)));
        self.place = next.copied().or(place);

        let turn = |i: usize| {
            let owner = owners[i];
            owner.and_then(|node| self.ahead.iter().position(|ahead| *ahead == node))
        };
        let mut order: Vec<(usize, f64, usize)> = (0..frontiers.len())
            .map(|i| (turn(i).unwrap_or(usize::MAX), robot.distance(frontiers[i]), i))
            .collect();
        order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut worth = vec![0.0; frontiers.len()];
        for (rank, (_, _, frontier)) in order.into_iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "few frontiers")]
            let share = (frontiers.len() - rank) as f64 / frontiers.len() as f64;
            worth[frontier] = share;
        }
        worth
    }
}

/// Returns the one of `among` that is nearest to `point`, the first among equals.
fn nearest(nodes: &[Point], among: &[usize], point: Point) -> Option<usize> {
    let nearer = |a: &usize, b: &usize| {
        let [a, b] = [a, b].map(|node| (nodes[*node].distance(point), *node));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    };
    among.iter().copied().min_by(nearer)
}

#[cfg(test)]
mod tests {
    use super::super::graph::tests::graph;
    use super::*;
    use crate::studies::prior_map::utility::ranked;

    /// Returns a corridor of four nodes along x, 10 m apart, and a side room at the second.
    fn corridor() -> Tour {
        let nodes = [(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (30.0, 0.0), (10.0, 8.0)];
        Tour::new(&graph(&nodes, &[(0, 1), (1, 2), (2, 3), (1, 4)]))
    }

    fn at(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn the_current_node_comes_before_nearer_frontiers_of_others() {
        let mut tour = corridor();
        // The room is on the path: the tour is 0, 1, 4, 2, 3.
        let frontiers = [at(14.9, 0.0), at(10.0, 7.0), at(18.0, 0.0)];
        let worth = tour.rank(at(13.0, 0.0), &frontiers, |p| p.x < 14.0 && p.y < 5.0);
        assert_eq!(tour.ahead(), [1, 4, 2, 3], "0 is known and has no frontier");
        assert_eq!(ranked(&worth), [0, 1, 2]);
        // 1 becomes known without a frontier of its own: the room is next, although others are nearer.
        let worth = tour.rank(at(14.0, 0.0), &frontiers[1..], |p| p.x < 16.0 && p.y < 5.0);
        assert_eq!(tour.ahead(), [4, 2, 3]);
        assert_eq!(ranked(&worth), [0, 1]);
        assert_eq!(worth, [1.0, 0.5]);
    }

    #[test]
    fn a_node_that_nothing_leads_to_yet_waits_for_its_turn() {
        let mut tour = corridor();
        // At the left end with a frontier at 2 only: 1 and 4 are unknown and have none.
        let worth = tour.rank(at(0.0, 0.0), &[at(17.0, 0.0)], |p| p.x < 5.0);
        assert_eq!((tour.ahead(), worth.as_slice()), (&[1, 4, 2, 3][..], &[1.0][..]));
        // Once something leads to 1, it is its turn.
        let worth = tour.rank(at(16.0, 0.0), &[at(17.0, 0.0), at(9.0, 0.0)], |p| p.x < 5.0);
        assert_eq!(ranked(&worth), [1, 0]);
    }

    #[test]
    fn what_is_left_over_after_the_tour_goes_by_distance() {
        let mut tour = corridor();
        tour.rank(at(0.0, 0.0), &[], |_| true);
        assert!(tour.ahead().is_empty());
        let worth = tour.rank(at(0.0, 0.0), &[at(9.0, 0.0), at(-2.0, 0.0)], |_| true);
        assert_eq!(ranked(&worth), [1, 0]);
    }
}
