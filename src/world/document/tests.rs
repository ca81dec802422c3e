use super::*;
use crate::document::mutation::{edits, mutate};
use crate::grid::{Occupancy, OccupancyGrid};
use crate::world::floor_plan::{FloorPlanSettings, floor_plan};
use crate::world::{originals, sdf};
use proptest::prelude::*;

const BASIC: &str = include_str!("../../../worlds/basic.yaml");

const TINY: &str = "\
reenact-world: 1
name: tiny
source: this test
layers:
  walls:
    walls:
      - {path-m: [[0, 0], [4, 0], [4, 3]], thickness-m: 0.2}
  furniture:
    z-m: [0, 0.5]
    boxes:
      - {name: desk, center-m: [1, 1], size-m: [2, 1], heading-deg: 90}
    circles:
      - {center-m: [3, 2], radius-m: 0.25, z-m: [0.3, 1]}
    polygons:
      - {corners-m: [[0, 2], [1, 2], [0, 3]]}
regions:
  lab: {room: {corners-m: [[0, 0], [4, 0], [4, 3]]}}
tags:
  T1: {color: red, at-m: [2, 0.2], heading-deg: 90}
starts:
  A: {at-m: [3, 2], heading-deg: -90}
goals:
  exit: {at-m: [0.5, 0.5]}
";

fn tiny(layers: Option<&[String]>) -> World {
    read(&Source::new("tiny.yaml", TINY), layers).unwrap()
}

fn faults(from: &str, to: &str, layers: Option<&[String]>) -> String {
    assert!(TINY.contains(from), "{from}");
    let source = Source::new("tiny.yaml", TINY.replacen(from, to, 1));
    read(&source, layers).unwrap_err().iter().map(|fault| fault.render(false)).collect()
}

#[test]
fn a_document_means_solids_regions_tags_starts_and_goals() {
    let world = tiny(None);
    let names: Vec<_> = world.solids.iter().map(|s| (s.layer.as_str(), s.name.as_str())).collect();
    assert_eq!(
        names,
        [
            ("furniture", "desk"),
            ("furniture", "circle 0"),
            ("furniture", "polygon 0"),
            ("walls", "wall 0/0"),
            ("walls", "wall 0/1"),
        ]
    );
    assert_eq!(world.slice(0.16).len(), 4, "the circle begins above");
    assert_eq!(world.slice(0.9).len(), 3, "the others of its layer end below");
    let desk = world.solids[0].body.slice(0.1)[0].bounds();
    assert!((desk.width() - 1.0).abs() < 1e-12 && (desk.height() - 2.0).abs() < 1e-12);
    // The corner at (4, 0) is filled, the ends stay where they are written.
    let walls: Vec<_> = world.solids[3..].iter().map(|s| s.body.slice(1.0).remove(0)).collect();
    assert!(walls.iter().any(|wall| wall.contains(Point::new(4.09, -0.09))));
    assert_eq!(walls[0].bounds().min.x, 0.0);
    assert_eq!(walls[1].bounds().max.y, 3.0);
    assert_eq!(world.regions[0].kind, RegionKind::Room);
    assert_eq!(world.starts["A"], Pose::new(3.0, 2.0, -std::f64::consts::FRAC_PI_2));
    assert_eq!(world.goals["exit"], Point::new(0.5, 0.5));
    assert_eq!((world.tags[0].id.as_str(), world.tags[0].color.as_str()), ("T1", "red"));
}

#[test]
fn walls_stay_and_other_layers_are_chosen() {
    assert_eq!(tiny(Some(&[])).layers(), ["walls"]);
    let furnished = tiny(Some(&["furniture".to_owned()]));
    assert_eq!(furnished.layers(), ["furniture", "walls"]);
    assert_eq!(furnished.meaning(), tiny(None).meaning());
    assert_ne!(furnished.meaning(), tiny(Some(&[])).meaning());
    assert_eq!(
        faults("tiny", "tiny", Some(&["furnture".to_owned()])),
        "\
error: world `tiny` has no layer `furnture`
 --> tiny.yaml:4:1
  |
4 | layers:
  | ^^^^^^ the layers are furniture, walls
  |
  = help: did you mean `furniture`?
"
    );
}

#[test]
fn faults_say_where_and_what_was_expected() {
    assert_eq!(
        faults("radius-m: 0.25", "radius-m: -0.25", None),
        "\
error: length out of range
  --> tiny.yaml:13:38
   |
13 |       - {center-m: [3, 2], radius-m: -0.25, z-m: [0.3, 1]}
   |                                      ^^^^^ expected metres, above zero
"
    );
    for (from, to, said) in [
        ("reenact-world: 1", "reenact-world: 2", "unknown format version"),
        ("z-m: [0.3, 1]", "z-m: [1, 0.3]", "heights out of order"),
        ("[[0, 0], [4, 0], [4, 3]], thick", "[[0, 0]], thick", "expected at least 2, found 1"),
        ("[[0, 0], [4, 0], [4, 3]], thick", "[[0, 0], [0, 0]], thick", "point repeated"),
        (
            "heading-deg: 90}\n    circles",
            "heading-deg: 9000}\n    circles",
            "heading out of range",
        ),
        ("center-m: [1, 1]", "center-m: [1, 1e6]", "coordinate out of range"),
        ("center-m: [1, 1]", "center-m: [1, 1, 1]", "center-m"),
        ("thickness-m", "thickness", "thickness"),
        ("lab: {room:", "lab: {rom:", "rom"),
    ] {
        let found = faults(from, to, None);
        assert!(found.contains(said), "{said}: {found}");
    }
}

/// Returns the area (m2) of a simple polygon, by the shoelace formula.
fn area(corners: &[Point]) -> f64 {
    let sides = (0..corners.len()).map(|i| corners[i].cross(corners[(i + 1) % corners.len()]));
    sides.sum::<f64>().abs() / 2.0
}

#[test]
fn the_basic_apartment_is_as_described() {
    let source = Source::new("worlds/basic.yaml", BASIC);
    let world = read(&source, Some(&[])).unwrap();
    let bounds = world.bounds();
    assert!((bounds.width() - 18.7).abs() < 0.01 && (bounds.height() - 9.75).abs() < 0.01);
    assert_eq!(world.starts["default"], Pose::new(3.0, 2.0, 0.0));
    let furnished = read(&source, Some(&["furniture".to_owned()])).unwrap();
    let floor: f64 = world.regions.iter().map(|region| area(&region.polygon)).sum();
    let furniture: f64 = furnished
        .solids
        .iter()
        .filter(|solid| solid.layer == "furniture")
        .flat_map(|solid| solid.body.slice(0.1602))
        .map(|outline| match outline {
            Outline::Circle { radius, .. } => std::f64::consts::PI * radius * radius,
            Outline::Polygon(corners) => area(&corners),
        })
        .sum();
    assert!((0.105..0.115).contains(&(furniture / floor)), "{furniture} of {floor} m2");
    // No start lies inside a wall, and no furniture reaches into one: every piece is within one region.
    for solid in furnished.solids.iter().filter(|solid| solid.layer == "furniture") {
        let middle = solid.body.slice(0.1602)[0].bounds();
        let middle = (middle.min + middle.max) * 0.5;
        let rooms = furnished
            .regions
            .iter()
            .filter(|r| Outline::Polygon(r.polygon.clone()).contains(middle));
        assert_eq!(rooms.count(), 1, "{}", solid.name);
    }
    let start = world.starts["default"].position();
    assert!(furnished.slice(0.1602).iter().all(|outline| outline.distance(start) > 0.5));
}

/// Compares our walls with those measured in the authors' world, as cells of 0.2 m: F1 of precision and recall.
#[test]
fn the_basic_apartment_has_the_walls_of_the_original() {
    let Some(folder) = originals::folder("the_basic_apartment_has_the_walls_of_the_original")
    else {
        return;
    };
    let original =
        sdf::read(&originals::source(&folder.join("worlds/basic_no_furniture.world"))).unwrap();
    let ours = read(&Source::new("worlds/basic.yaml", BASIC), Some(&[])).unwrap();
    let plan = FloorPlanSettings { height: 0.1602, resolution: 0.2, layers: None };
    let cells = |grid: &OccupancyGrid| -> Vec<(i32, i32)> {
        let frame = *grid.frame();
        let occupied = frame.cells().filter(|cell| grid.at(*cell) == Occupancy::Occupied);
        let index = |v: f64| {
            #[expect(clippy::cast_possible_truncation, reason = "some hundred cells")]
            let index = (v / 0.2).round() as i32;
            index
        };
        occupied
            .map(|cell| (cell.x + index(frame.origin.x), cell.y + index(frame.origin.y)))
            .collect()
    };
    let (a, b) =
        (cells(&floor_plan(&original, plan).unwrap()), cells(&floor_plan(&ours, plan).unwrap()));
    let both = u32::try_from(a.iter().filter(|cell| b.contains(cell)).count()).unwrap();
    let sizes = u32::try_from(a.len() + b.len()).unwrap();
    let f1 = 2.0 * f64::from(both) / f64::from(sizes);
    assert!(f1 >= 0.95, "F1 {f1:.3}: {} and {} cells", a.len(), b.len());
}

proptest! {
    #[test]
    fn damaged_worlds_never_panic(edits in edits()) {
        for text in [TINY, BASIC] {
            let text = String::from_utf8_lossy(&mutate(text.as_bytes(), &edits)).into_owned();
            if let Ok(world) = read(&Source::new("t.yaml", text), None) {
                let _ = (world.slice(0.16), world.contact(0.0, 0.4), world.bounds());
            }
        }
    }
}
