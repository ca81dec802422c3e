//! A topo-metric map as a user writes it.

use super::graph::{Node, TopoMetricMap};
use crate::document::{self, Diagnostic, Parsed, Source, suggestion};
use crate::geometry::Point;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// A topo-metric map as written.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct TopoMetricDoc {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    #[expect(dead_code, reason = "the schema holds it to 1")]
    reenact_topo_metric_map: u32,
    /// Name of the environment.
    #[expect(dead_code, reason = "for people")]
    name: String,
    /// Where it comes from.
    #[expect(dead_code, reason = "for people")]
    source: String,
    /// Places by name.
    nodes: BTreeMap<String, NodeDoc>,
    /// Pairs of places between which there is a direct way.
    #[serde(default)]
    edges: Vec<[String; 2]>,
}

/// A place as written.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct NodeDoc {
    /// Where it is, roughly, in the world's frame (m).
    at_m: [f64; 2],
}

/// Reads a topo-metric map.
///
/// # Errors
/// Every difference from the format; edges to nowhere, to themselves or written twice; nodes that cannot be reached from
/// the first.
pub fn read(source: &Source) -> Result<TopoMetricMap, Vec<Diagnostic>> {
    let parsed = document::parse::<TopoMetricDoc>(source)?;
    let doc = &parsed.value;
    let names: Vec<&str> = doc.nodes.keys().map(String::as_str).collect();
    if names.is_empty() {
        let fault = parsed.fault("/nodes", "the map has no node").label("expected places");
        return Err(vec![fault]);
    }
    let mut faults = Vec::new();
    let mut edges = BTreeSet::new();
    for (i, pair) in doc.edges.iter().enumerate() {
        let [a, b] = [0, 1].map(|end| index(&parsed, &names, &pair[end], i, end, &mut faults));
        let (Some(a), Some(b)) = (a, b) else { continue };
        let place = format!("/edges/{i}");
        if a == b {
            let message = format!("an edge from `{}` to itself", pair[0]);
            faults.push(parsed.fault(&place, message).label("expected two different nodes"));
        } else if !edges.insert((a.min(b), a.max(b))) {
            let message = format!("`{}` and `{}` are joined twice", pair[0], pair[1]);
            faults.push(parsed.fault(&place, message).label("this edge is there already"));
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let nodes = doc.nodes.iter().map(|(name, node)| {
        let [x, y] = node.at_m;
        Node { name: name.clone(), at: Point::new(x, y) }
    });
    let map = TopoMetricMap { nodes: nodes.collect(), edges: edges.into_iter().collect() };
    let from_first = &map.distances()[0];
    for (name, _) in names.iter().zip(from_first).filter(|(_, distance)| distance.is_infinite()) {
        let message = format!("no edges lead from `{}` to `{name}`", names[0]);
        let fault = parsed.key_fault(&format!("/nodes/{name}"), message);
        let help = "a tour must come to every node: add an edge";
        faults.push(fault.label("cannot be reached").help(help));
    }
    if faults.is_empty() { Ok(map) } else { Err(faults) }
}

/// Returns the node that an end of the edge `i` names.
fn index(
    parsed: &Parsed<TopoMetricDoc>,
    names: &[&str],
    name: &str,
    i: usize,
    end: usize,
    faults: &mut Vec<Diagnostic>,
) -> Option<usize> {
    let found = names.iter().position(|known| *known == name);
    if found.is_none() {
        let fault = parsed.fault(&format!("/edges/{i}/{end}"), format!("unknown node `{name}`"));
        let help = suggestion(name, names.iter().copied()).map_or_else(
            || "name it under `nodes`".to_owned(),
            |near| format!("did you mean `{near}`?"),
        );
        faults.push(fault.label("not a key of `nodes`").help(help));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "reenact-topo-metric-map: 1\nname: flat\nsource: ours\n";

    fn told(text: &str) -> String {
        match read(&Source::new("flat.yaml", format!("{HEAD}{text}"))) {
            Ok(map) => panic!("read as {map:?}"),
            Err(faults) => faults.iter().map(|fault| fault.render(false)).collect(),
        }
    }

    #[test]
    fn nodes_are_ordered_by_name_and_edges_have_no_direction() {
        let text = |edges: &str| {
            format!(
                "{HEAD}nodes:\n  b: {{at-m: [1, 2]}}\n  a: {{at-m: [0, 0.5]}}\nedges: {edges}\n"
            )
        };
        let read = |edges| read(&Source::new("flat.yaml", text(edges))).unwrap();
        let map = read("[[b, a]]");
        assert_eq!(map.positions(), [Point::new(0.0, 0.5), Point::new(1.0, 2.0)]);
        assert_eq!(map, read("[[a, b]]"));
        assert_eq!(map.edges, [(0, 1)]);
    }

    #[test]
    fn every_fault_says_where_and_what_next() {
        let nodes = "nodes:\n  door: {at-m: [0, 0]}\n  hall: {at-m: [1, 0]}\n";
        let slip = told(&format!("{nodes}edges: [[door, hal], [door, door], [hall, nowhere]]\n"));
        for part in [
            "unknown node `hal`",
            "did you mean `hall`?",
            "flat.yaml:7",
            "to itself",
            "name it under",
        ] {
            assert!(slip.contains(part), "{part}: {slip}");
        }
        let twice = told(&format!("{nodes}edges: [[door, hall], [hall, door]]\n"));
        assert!(twice.contains("joined twice"), "{twice}");
        let apart = told(nodes);
        assert!(apart.contains("no edges lead from `door` to `hall`"), "{apart}");
        assert!(told("nodes: {}\n").contains("no node"));
        let unit = told("nodes: {a: {at: [0, 0]}}\n");
        assert!(unit.contains("at-m"), "{unit}");
    }
}
