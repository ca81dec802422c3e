//! The topo-metric graph: places with rough positions, and which of them are joined directly.

use crate::digest::{MeaningDigest, Sha256Digest};
use crate::geometry::{Point, Pose};
use crate::json;
use crate::rng::Stream;
use serde::Serialize;

/// A place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Node {
    pub(super) name: String,
    pub(super) at: Point,
}

/// A graph "whose nodes are locations and edges are direct connections that roughly reflect the true metric distances
/// between locations" (section 2). Connected, and with at least one node: its reader makes sure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TopoMetricMap {
    /// By name.
    pub(super) nodes: Vec<Node>,
    /// Pairs of nodes, the lower first, sorted.
    pub(super) edges: Vec<(usize, usize)>,
}

impl TopoMetricMap {
    /// Returns the positions of the nodes (m), by name.
    pub fn positions(&self) -> Vec<Point> {
        self.nodes.iter().map(|node| node.at).collect()
    }

    /// Returns the names of the nodes, in the order of [`Self::positions`].
    pub fn names(&self) -> Vec<&str> {
        self.nodes.iter().map(|node| node.name.as_str()).collect()
    }

    /// Returns the pairs of places (m) that are joined directly.
    pub fn edges(&self) -> Vec<(Point, Point)> {
        self.edges.iter().map(|&(a, b)| (self.nodes[a].at, self.nodes[b].at)).collect()
    }

    /// Returns the digest of the graph's meaning.
    pub fn meaning(&self) -> MeaningDigest {
        MeaningDigest(Sha256Digest::of(json::canonical_of(self)))
    }

    /// Returns the same graph in the frame of `start`, which is given in the graph's own.
    #[must_use]
    pub fn seen_from(&self, start: Pose) -> Self {
        self.moved(|_, at| start.inverse_transform(at))
    }

    /// Returns the graph with Gaussian noise of standard deviation `sd` (m) in x and in y on every node: "when Gaussian
    /// noise ... is added to the node positions of the topo-metric map" (section 4.5). Edges stay, with the lengths
    /// that follow from it.
    #[must_use]
    pub fn with_noise(&self, sd: f64, noise: &mut Stream) -> Self {
        // Numbered by node, so that no draw depends on another.
        self.moved(|i, at| {
            let noise = noise.at(i);
            at + Point::new(noise.normal(), noise.normal()) * sd
        })
    }

    fn moved(&self, mut to: impl FnMut(u64, Point) -> Point) -> Self {
        let mut moved = self.clone();
        for (i, node) in (0..).zip(&mut moved.nodes) {
            node.at = to(i, node.at);
        }
        moved
    }

    /// Computes the lengths (m) of the shortest paths between all pairs of nodes, by Floyd and Warshall; infinite where
    /// there is none.
    pub fn distances(&self) -> Vec<Vec<f64>> {
        let n = self.nodes.len();
        let mut distances = vec![vec![f64::INFINITY; n]; n];
        for (i, row) in distances.iter_mut().enumerate() {
            row[i] = 0.0;
        }
        for &(a, b) in &self.edges {
            let length = self.nodes[a].at.distance(self.nodes[b].at);
            distances[a][b] = length;
            distances[b][a] = length;
        }
        for via in 0..n {
            let onwards = distances[via].clone();
            for row in &mut distances {
                let there = row[via];
                for (known, onward) in row.iter_mut().zip(&onwards) {
                    *known = known.min(there + onward);
                }
            }
        }
        distances
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::rng::Seeds;
    use std::f64::consts::FRAC_PI_2;

    pub(in super::super) fn graph(
        places: &[(f64, f64)],
        edges: &[(usize, usize)],
    ) -> TopoMetricMap {
        let node = |(i, &(x, y)): (usize, &(f64, f64))| Node {
            name: format!("n{i:02}"),
            at: Point::new(x, y),
        };
        TopoMetricMap {
            nodes: places.iter().enumerate().map(node).collect(),
            edges: edges.to_vec(),
        }
    }

    #[test]
    fn ways_lead_over_edges_and_take_the_shortest() {
        // A square with one side missing, and a shortcut of no use.
        let square = graph(
            &[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)],
            &[(0, 1), (1, 2), (2, 3), (0, 2)],
        );
        let distances = square.distances();
        assert_eq!(distances[0], [0.0, 4.0, 5.0, 9.0], "to 3 by way of 2, not straight");
        assert_eq!(distances[3][1], 7.0);
        assert_eq!(graph(&[(0.0, 0.0), (1.0, 0.0)], &[]).distances()[0][1], f64::INFINITY);
    }

    #[test]
    fn the_start_is_the_origin_and_faces_along_x() {
        let seen =
            graph(&[(3.0, 2.0), (3.0, 5.0)], &[(0, 1)]).seen_from(Pose::new(3.0, 2.0, FRAC_PI_2));
        assert!(seen.positions()[0].distance(Point::ZERO) < 1e-12);
        assert!(seen.positions()[1].distance(Point::new(3.0, 0.0)) < 1e-12);
    }

    #[test]
    fn noise_has_its_deviation_in_x_and_y_and_none_changes_nothing() {
        let places: Vec<(f64, f64)> = (0..2000).map(|i| (f64::from(i), 0.0)).collect();
        let graph = graph(&places, &[]);
        let mut stream = Seeds::new(1, vec![]).stream("node-noise");
        assert_eq!(graph.with_noise(0.0, &mut stream), graph);
        let noisy = graph.with_noise(2.5, &mut stream);
        assert_eq!(noisy, graph.with_noise(2.5, &mut stream), "whatever was drawn before");
        let off = graph.positions().into_iter().zip(noisy.positions()).map(|(a, b)| b - a);
        let (x, y) = off.fold((0.0, 0.0), |(x, y), d| (x + d.x * d.x, y + d.y * d.y));
        for squares in [x, y] {
            assert!(((squares / 2000.0).sqrt() - 2.5).abs() < 0.2, "{squares}");
        }
    }

    #[test]
    fn what_a_graph_means_is_its_places_and_edges() {
        let one = graph(&[(0.0, 0.0), (4.0, 0.0)], &[(0, 1)]);
        assert_eq!(one.meaning(), one.clone().meaning());
        assert_ne!(one.meaning(), graph(&[(0.0, 0.0), (4.0, 0.1)], &[(0, 1)]).meaning());
        assert_ne!(one.meaning(), graph(&[(0.0, 0.0), (4.0, 0.0)], &[]).meaning());
    }
}
