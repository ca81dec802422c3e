//! The trajectories of all particles, as trees: what particles share before they parted is kept once (GMapping's
//! `TNode`).

use crate::geometry::Pose;

/// The pose of a particle when a scan was taken in.
pub(super) type NodeId = usize;

#[derive(Debug, Clone, Copy)]
struct Node {
    pose: Pose,
    parent: Option<NodeId>,
    /// Number of the scan, from 0.
    scan: usize,
}

/// Every pose of every particle that was ever extended by one.
#[derive(Debug, Default)]
pub(super) struct Trajectories {
    nodes: Vec<Node>,
}

impl Trajectories {
    /// Extends the trajectory that ends at `parent` by `pose`, or begins a new one there.
    pub(super) fn extend(&mut self, parent: Option<NodeId>, pose: Pose) -> NodeId {
        let scan = parent.map_or(0, |parent| self.nodes[parent].scan + 1);
        self.nodes.push(Node { pose, parent, scan });
        self.nodes.len() - 1
    }

    /// Returns the pose at `node`, and the number of the scan taken there.
    pub(super) fn at(&self, node: NodeId) -> (Pose, usize) {
        (self.nodes[node].pose, self.nodes[node].scan)
    }

    /// Returns the trajectory to `node` from its beginning.
    pub(super) fn way_to(&self, node: NodeId) -> Vec<Pose> {
        let (_, nodes) = self.between(None, node);
        nodes.into_iter().map(|node| self.nodes[node].pose).collect()
    }

    /// Returns the nodes that only the trajectory to `from` has (last first), and those that only the one to `to` has
    /// (first first).
    pub(super) fn between(&self, from: Option<NodeId>, to: NodeId) -> (Vec<NodeId>, Vec<NodeId>) {
        let scan = |node: Option<NodeId>| node.map(|node| self.nodes[node].scan);
        let (mut left, mut right) = (Vec::new(), Vec::new());
        let (mut from, mut to) = (from, Some(to));
        while from != to {
            // `None` is the beginning of all, before scan 0.
            let (behind, ahead) = (scan(from), scan(to));
            if behind >= ahead
                && let Some(node) = from
            {
                left.push(node);
                from = self.nodes[node].parent;
            }
            if ahead >= behind
                && let Some(node) = to
            {
                right.push(node);
                to = self.nodes[node].parent;
            }
        }
        right.reverse();
        (left, right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_ways_differ_from_where_they_parted() {
        let mut ways = Trajectories::default();
        let at = |x: u32| Pose::new(f64::from(x), 0.0, 0.0);
        let root = ways.extend(None, at(0));
        let shared = ways.extend(Some(root), at(1));
        let a = ways.extend(Some(shared), at(2));
        let b = ways.extend(Some(shared), at(3));
        let b2 = ways.extend(Some(b), at(4));
        assert_eq!(ways.between(None, a), (vec![], vec![root, shared, a]));
        assert_eq!(ways.between(Some(a), b2), (vec![a], vec![b, b2]));
        assert_eq!(ways.between(Some(b2), a), (vec![b2, b], vec![a]));
        assert_eq!(ways.between(Some(shared), b2), (vec![], vec![b, b2]));
        assert_eq!(ways.between(Some(a), a), (vec![], vec![]));
        let other = ways.extend(None, at(9));
        assert_eq!(ways.between(Some(shared), other), (vec![shared, root], vec![other]));
        assert_eq!(ways.way_to(b2), [at(0), at(1), at(3), at(4)]);
        assert_eq!(ways.at(b2), (at(4), 3));
    }
}
