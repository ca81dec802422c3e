//! The walls between spaces: along every side of one, once where two share it, open at the gaps.

use super::layout::{Cm, Gap, Space, metres};
use crate::geometry::Axis;
use crate::world::document::WallDoc;
use std::collections::BTreeMap;

/// Builds the walls around `spaces`, `thickness` thick, but for `gaps`: those along E-W from south to north, then those
/// along N-S from west to east.
pub(super) fn walls(spaces: &[Space], gaps: &[Gap], thickness: Cm) -> Vec<WallDoc> {
    let mut walls = Vec::new();
    for line in Axis::ALL {
        // The pieces built along each line: by its distance from the origin, from and to.
        let mut built: BTreeMap<Cm, Vec<[Cm; 2]>> = BTreeMap::new();
        for space in spaces {
            let (length, sides) = match line {
                Axis::EastWest => (space.area.x, space.area.y),
                Axis::NorthSouth => (space.area.y, space.area.x),
            };
            for at in sides {
                built.entry(at).or_default().push(length);
            }
        }
        for (at, pieces) in built {
            let mut open: Vec<[Cm; 2]> = gaps
                .iter()
                .filter(|gap| gap.line == line && across(line, gap.at) == at)
                .map(|gap| {
                    let middle = along(line, gap.at);
                    [middle - gap.width / 2, middle + gap.width / 2]
                })
                .collect();
            open.sort_unstable();
            for piece in merged(pieces) {
                for [from, to] in standing(piece, &open, thickness / 2) {
                    let ends = match line {
                        Axis::EastWest => [(from, at), (to, at)],
                        Axis::NorthSouth => [(at, from), (at, to)],
                    };
                    walls.push(WallDoc {
                        name: String::new(),
                        path_m: ends.map(metres).to_vec(),
                        thickness_m: f64::from(thickness) / 100.0,
                        z_m: None,
                    });
                }
            }
        }
    }
    walls
}

fn along(line: Axis, at: (Cm, Cm)) -> Cm {
    if line == Axis::EastWest { at.0 } else { at.1 }
}

fn across(line: Axis, at: (Cm, Cm)) -> Cm {
    if line == Axis::EastWest { at.1 } else { at.0 }
}

/// Merges pieces that touch or overlap.
fn merged(mut pieces: Vec<[Cm; 2]>) -> Vec<[Cm; 2]> {
    pieces.sort_unstable();
    let mut merged: Vec<[Cm; 2]> = Vec::new();
    for piece in pieces {
        match merged.last_mut() {
            Some(last) if piece[0] <= last[1] => last[1] = last[1].max(piece[1]),
            _ => merged.push(piece),
        }
    }
    merged
}

/// Returns the parts of `piece` that stand between the `open` parts. Ends at corners reach on to the far face of the
/// other wall.
fn standing(piece: [Cm; 2], open: &[[Cm; 2]], half: Cm) -> Vec<[Cm; 2]> {
    let mut standing = Vec::new();
    let mut from = piece[0] - half;
    for gap in open.iter().filter(|gap| gap[0] > piece[0] && gap[1] < piece[1]) {
        standing.push([from, gap[0]]);
        from = gap[1];
    }
    standing.push([from, piece[1] + half]);
    standing
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::RegionKind;
    use crate::world::generate::layout::Area;

    #[test]
    fn shared_walls_stand_once_and_gaps_stay_open() {
        let space = |x: [Cm; 2], y: [Cm; 2]| {
            let area = Area { x, y };
            Space { name: String::new(), kind: RegionKind::Room, area, floor: area.grown(-10) }
        };
        let spaces = [space([0, 400], [0, 300]), space([400, 600], [0, 300])];
        let gap = Gap { line: Axis::NorthSouth, at: (400, 100), width: 90 };
        let found: Vec<Vec<[f64; 2]>> =
            walls(&spaces, &[gap], 20).into_iter().map(|wall| wall.path_m).collect();
        assert_eq!(
            found,
            [
                [[-0.1, 0.0], [6.1, 0.0]],
                [[-0.1, 3.0], [6.1, 3.0]],
                [[0.0, -0.1], [0.0, 3.1]],
                [[4.0, -0.1], [4.0, 0.55]],
                [[4.0, 1.45], [4.0, 3.1]],
                [[6.0, -0.1], [6.0, 3.1]],
            ]
        );
    }
}
