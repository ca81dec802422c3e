//! Generated buildings: a family and a seed identify one building, on every machine.
//!
//! A building is made as a [`WorldDoc`], so that it can be written as world YAML, and read as any other.

mod hall;
mod layout;
mod office_floor;
mod walls;

pub use office_floor::{ROOM_VERTICES, VERTICES};

use super::document::{self, PoseDoc, WorldDoc};
use super::topology::{Opening, TagScheme, Topology};
use super::{RegionKind, World};
use crate::rng::{Seeds, Stream};
use layout::degrees;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A family of buildings.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Floors like that of the deadline study: about 65 x 40 m, 45 to 50 vertices, starts A, B and C.
    OfficeFloor,
}

impl Family {
    /// Returns its name in manifests.
    pub const fn name(self) -> &'static str {
        match self {
            Self::OfficeFloor => "office-floor",
        }
    }
}

/// Failure to make a building.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no building of the family `{}` was found for seed {seed} in {attempts} attempts", family.name())]
pub struct Unsatisfied {
    /// The family.
    pub family: Family,
    /// The seed.
    pub seed: u64,
    /// The number of attempts.
    pub attempts: u32,
}

/// Draws before a seed is given up.
const ATTEMPTS: u32 = 500;

/// Edges from the goal to the starts A, B and C: at least, at most (what fits the deadline study's Table 1).
pub const START_DISTANCES: [(&str, [u32; 2]); 3] = [("A", [2, 3]), ("B", [4, 7]), ("C", [7, 12])];
/// B's distance from the goal by C's, per mille: as the deadlines of Table 1, 2899 and 5628 s.
const B_BY_C: u32 = 515;

/// Generates the building `seed` of `family`, as a document.
///
/// # Errors
/// Where no draw of the seed fits together.
pub fn document(family: Family, seed: u64) -> Result<WorldDoc, Unsatisfied> {
    let Family::OfficeFloor = family;
    let found = (0..ATTEMPTS).find_map(|attempt| office_floor(seed, attempt));
    found.ok_or(Unsatisfied { family, seed, attempts: ATTEMPTS })
}

/// Generates the building `seed` of `family`.
///
/// # Errors
/// As [`document()`].
///
/// # Panics
/// Never: the document written here keeps to the format.
pub fn generate(family: Family, seed: u64) -> Result<World, Unsatisfied> {
    // Not written and read: that takes ten times as long as to draw it, and gives the same world.
    Ok(document::build(&document(family, seed)?).expect("a generated document can be read"))
}

fn office_floor(seed: u64, attempt: u32) -> Option<WorldDoc> {
    let coordinates =
        [("family", Family::OfficeFloor.name().to_owned()), ("attempt", attempt.to_string())];
    let seeds =
        Seeds::new(seed, coordinates.map(|(name, value)| (name.to_owned(), value)).to_vec());
    let layout = office_floor::draw(&mut seeds.stream("layout"), &mut seeds.stream("mouths"))?;
    let scheme = TagScheme::default();
    let mut ids: Vec<String> = (1..=layout.tag_count()).map(|i| format!("t{i:03}")).collect();
    seeds.stream("tags").shuffle(&mut ids);
    let tags = layout.tags(&ids, &scheme);
    let topology = Topology::read(&tags, &scheme).ok()?;
    let starts = choose_starts(&topology, &mut seeds.stream("starts"))?;

    let name = format!("office-floor-{seed}");
    let source = format!(
        "Reenact's generator, family office-floor, seed {seed}: not a real building, but one of the kind that Tables 1 and 2 of the deadline study imply"
    );
    let mut doc = layout.document(name, source, &tags);
    doc.starts = starts;
    Some(doc)
}

/// Chooses starts at the corridor vertices that have the right distances from the goal, each facing along its corridor: C
/// any of these; B nearest to the share of C's distance that it has of C's deadlines; A on this side of the goal's door, so
/// that exploring leads away from it.
fn choose_starts(topology: &Topology, stream: &mut Stream) -> Option<BTreeMap<String, PoseDoc>> {
    let distances = topology.distances_to_goal();
    let [(_, near), (_, middle), (_, far)] = START_DISTANCES;
    let corridor = |range: [u32; 2]| -> Vec<(usize, u32)> {
        distances
            .iter()
            .enumerate()
            .filter(|(number, _)| topology.vertices[*number].kind == RegionKind::Corridor)
            .filter_map(|(number, distance)| Some((number, (*distance)?)))
            .filter(|(_, distance)| (range[0]..=range[1]).contains(distance))
            .collect()
    };
    let mut draw = |candidates: Vec<(usize, u32)>| {
        let index = stream.below(candidates.len().max(1) as u64);
        candidates.get(usize::try_from(index).ok()?).copied()
    };
    let c = draw(corridor(far))?;
    let from_c = topology.distances([c.0]);
    let door = topology.goals().next().map(|goal| topology.vertices[goal].exits[0].to)?;
    let is_before = |(n, _): &(usize, u32)| from_c[*n] < from_c[door];
    let a = draw(corridor(near).into_iter().filter(is_before).collect())?;
    let off = |distance: u32| (1000 * distance).abs_diff(B_BY_C * c.1);
    let best = corridor(middle).iter().map(|(_, distance)| off(*distance)).min()?;
    let b = draw(corridor(middle).into_iter().filter(|(_, d)| off(*d) == best).collect())?;

    let mut starts = BTreeMap::new();
    for ((name, _), (number, _)) in START_DISTANCES.into_iter().zip([a, b, c]) {
        let vertex = &topology.vertices[number];
        let ways: Vec<_> = vertex.exits.iter().filter(|e| e.opening == Opening::Corridor).collect();
        let way = ways[usize::try_from(stream.below(ways.len() as u64)).ok()?];
        let pose =
            PoseDoc { at_m: [vertex.at.x, vertex.at.y], heading_deg: degrees(way.direction) };
        starts.insert(name.to_owned(), pose);
    }
    Some(starts)
}

#[cfg(test)]
mod tests;
