//! A world from elsewhere as world YAML.

use super::{CircleDoc, GoalDoc, LayerDoc, PolygonDoc, PoseDoc, WorldDoc};
use crate::geometry::{Outline, Placement};
use crate::world::{Body, Solid, World};
use std::collections::BTreeMap;

/// Decimals kept of a length (m): a tenth of a millimetre.
const DECIMALS: f64 = 1e4;

impl WorldDoc {
    /// Describes the solids, starts and goals of `world`, whose measures come from `source`.
    ///
    /// Upright boxes, cylinders and prisms keep their heights. Whatever else there is (meshes, what leans) becomes the
    /// outlines in which the plane at `height` (m) cuts it, as high as a storey.
    pub fn of(world: &World, source: String, height: f64) -> Self {
        let mut layers: BTreeMap<String, LayerDoc> = BTreeMap::new();
        for solid in &world.solids {
            let layer = layers.entry(solid.layer.clone()).or_default();
            match upright(&solid.body) {
                Some((outline, z)) => add(layer, solid, &outline, Some(z)),
                None => solid.body.slice(height).iter().for_each(|o| add(layer, solid, o, None)),
            }
        }
        layers.entry(super::BASE_LAYER.to_owned()).or_default();
        let starts = world.starts.iter().map(|(name, pose)| {
            let heading_deg = rounded(pose.heading.to_degrees());
            (name.clone(), PoseDoc { at_m: [rounded(pose.x), rounded(pose.y)], heading_deg })
        });
        let goals = world.goals.iter().map(|(name, goal)| {
            (name.clone(), GoalDoc { at_m: [rounded(goal.x), rounded(goal.y)] })
        });
        Self {
            reenact_world: 1,
            name: world.name.clone(),
            source,
            layers,
            regions: BTreeMap::new(),
            tags: BTreeMap::new(),
            starts: starts.collect(),
            goals: goals.collect(),
        }
    }
}

/// Returns outline and heights (m) of a body that is the same at each of them.
fn upright(body: &Body) -> Option<(Outline, [f64; 2])> {
    let around = |placement: &Placement, length: f64| {
        let middle = placement.translation[2];
        [middle - length / 2.0, middle + length / 2.0]
    };
    let z = match body {
        Body::Prism { outline, z } => return Some((outline.clone(), *z)),
        Body::Box { size, placement } if placement.is_upright() => around(placement, size[2]),
        Body::Cylinder { length, placement, .. } if placement.is_upright() => {
            around(placement, *length)
        }
        _ => return None,
    };
    let outline = body.slice(f64::midpoint(z[0], z[1])).into_iter().next()?;
    Some((outline, z))
}

fn add(layer: &mut LayerDoc, solid: &Solid, outline: &Outline, z: Option<[f64; 2]>) {
    let (name, z_m) = (solid.name.clone(), z.map(|z| z.map(rounded)));
    match outline {
        Outline::Circle { center, radius } => {
            let center_m = [rounded(center.x), rounded(center.y)];
            layer.circles.push(CircleDoc { name, center_m, radius_m: rounded(*radius), z_m });
        }
        Outline::Polygon(corners) => {
            let mut corners_m: Vec<[f64; 2]> =
                corners.iter().map(|corner| [rounded(corner.x), rounded(corner.y)]).collect();
            corners_m.dedup();
            // Less than a tenth of a millimetre across is nothing that anybody sees.
            if corners_m.len() >= 3 {
                layer.polygons.push(PolygonDoc { name, corners_m, z_m });
            }
        }
    }
}

fn rounded(length: f64) -> f64 {
    (length * DECIMALS).round() / DECIMALS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Source;
    use crate::geometry::{Point, Pose};
    use crate::world::document::{build, read};

    #[test]
    fn what_is_written_is_seen_and_touched_as_before() {
        let solid = |name: &str, body: Body| Solid {
            name: name.to_owned(),
            layer: "walls".to_owned(),
            body,
        };
        let at = |pose: [f64; 6]| Placement::from_xyz_rpy(pose);
        let lean = at([4.0, 0.0, 0.5, 0.6, 0.0, 0.0]);
        let world = World {
            name: "yard: 2".to_owned(),
            solids: vec![
                solid(
                    "wall",
                    Body::Box {
                        size: [4.0, 0.2, 2.0],
                        placement: at([1.0, 2.0, 1.0, 0.0, 0.0, 0.3]),
                    },
                ),
                solid(
                    "",
                    Body::Cylinder {
                        radius: 0.25,
                        length: 0.5,
                        placement: at([-1.0, 0.0, 0.25, 0.0, 0.0, 0.0]),
                    },
                ),
                solid("ramp", Body::Box { size: [1.0, 2.0, 0.3], placement: lean }),
            ],
            starts: [("door".to_owned(), Pose::new(0.5, -1.0, 0.25))].into(),
            goals: [("bay".to_owned(), Point::new(2.0, 3.0))].into(),
            ..World::default()
        };
        let doc = WorldDoc::of(&world, "measured by hand".to_owned(), 0.5);
        let text = doc.to_yaml();
        let again = read(&Source::new("w.yaml", text.clone()), None).unwrap();
        assert_eq!(again, build(&doc).unwrap());
        assert_eq!((again.name.as_str(), &again.goals), ("yard: 2", &world.goals));
        assert!(again.starts["door"].position().distance(Point::new(0.5, -1.0)) < 1e-9, "{text}");
        for height in [0.2, 0.5, 1.5, 2.2] {
            let mut bounds: Vec<_> = again.slice(height).iter().map(Outline::bounds).collect();
            // What leans is as it was where it was cut, at any height.
            let before = world.solids.iter().flat_map(|solid| {
                solid.body.slice(if solid.name == "ramp" { 0.5 } else { height })
            });
            for outline in before {
                let wanted = outline.bounds();
                let near = |b: &crate::geometry::Bounds| {
                    b.min.distance(wanted.min) < 1e-3 && b.max.distance(wanted.max) < 1e-3
                };
                let found = bounds.iter().position(near);
                bounds.remove(found.unwrap_or_else(|| panic!("{height}: {outline:?} in {text}")));
            }
            assert!(bounds.is_empty(), "{height}: {bounds:?}");
        }
    }
}
