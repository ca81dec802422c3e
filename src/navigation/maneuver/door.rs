//! A door ahead: the gap's two edges in the scan.

use super::outlook::Outlook;
use super::rule::PilotRule;
use crate::geometry::Point;

/// A gap in a wall across the leg, in the leg's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    /// Distance of the wall's near face along the leg (m).
    pub(super) distance: f64,
    /// Offset of the gap's middle across the leg (m, to the left).
    pub(super) middle: f64,
    /// Width of the gap (m).
    pub(super) width: f64,
}

/// Side of a bin along the leg (m), and their number.
const BIN: f64 = 0.1;
const BINS: usize = 60;
/// Fewest points of a wall across the leg.
const POINTS: u32 = 4;
/// Points this near to a wall's plane belong to it (m).
const FLAT: f64 = 0.07;
/// Walls count this far to either side of a door's edges (m).
const BESIDE: f64 = 0.8;

/// Finds the door through which the leg leads: in the nearest wall across the leg that has a gap of a door's width
/// whose middle is within reach of `expected` (m, to the left), and not beyond `limit` (m).
pub(super) fn find(outlook: &Outlook, rule: &PilotRule, expected: f64, limit: f64) -> Option<Gap> {
    let reach = rule.door_reach_m + rule.door_widest_m / 2.0 + BESIDE;
    let start = outlook.sensor.x;
    let mut bins = [(0_u32, 0.0_f64); BINS];
    for point in outlook.points() {
        if (point.y - expected).abs() > reach || point.x <= start {
            continue;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "above zero")]
        let bin = ((point.x - start) / BIN) as usize;
        if let Some((count, sum)) = bins.get_mut(bin) {
            (*count, *sum) = (*count + 1, *sum + point.x);
        }
    }
    (0..BINS - 1).find_map(|i| {
        let (near, far) = (bins[i], bins[i + 1]);
        // Two bins at a time, so that a wall on their border is one; each pair once.
        if near.0 == 0 || near.0 + far.0 < POINTS || (i > 0 && bins[i - 1].0 > near.0 + far.0) {
            return None;
        }
        let distance = (near.1 + far.1) / f64::from(near.0 + far.0);
        if distance > limit { None } else { gap_at(outlook, rule, expected, distance) }
    })
}

/// A beam at the plane at some distance: where it meets it, and whether it goes on.
#[derive(Clone, Copy)]
struct Crossing {
    at: f64,
    open: bool,
}

/// Finds the gap in the wall at `distance` whose middle is nearest to `expected`.
fn gap_at(outlook: &Outlook, rule: &PilotRule, expected: f64, distance: f64) -> Option<Gap> {
    let sensor = outlook.sensor;
    let mut best: Option<Gap> = None;
    // The last beam that ended at the wall or before it, and the open one next to it.
    let mut closed: Option<Crossing> = None;
    let mut edge: Option<f64> = None;
    let mut last_open = 0.0;
    for &end in &outlook.ends {
        let Some(crossing) = cross(sensor, end, distance) else { continue };
        if crossing.open {
            if edge.is_none()
                && let Some(wall) = closed
            {
                edge = Some(f64::midpoint(wall.at, crossing.at));
            }
            last_open = crossing.at;
        } else {
            if let Some(right) = edge.take() {
                let left = f64::midpoint(last_open, crossing.at);
                let gap = Gap { distance, middle: f64::midpoint(left, right), width: left - right };
                let fits = (rule.door_narrowest_m..=rule.door_widest_m).contains(&gap.width)
                    && (gap.middle - expected).abs() <= rule.door_reach_m;
                let off = |gap: &Gap| (gap.middle - expected).abs();
                if fits && best.as_ref().is_none_or(|best| off(&gap) < off(best)) {
                    best = Some(gap);
                }
            }
            closed = Some(crossing);
        }
    }
    best
}

/// Returns where the beam from `sensor` to `end` meets the plane at `distance`; `None` where it leads away from it.
fn cross(sensor: Point, end: Point, distance: f64) -> Option<Crossing> {
    let along = end.x - sensor.x;
    if along <= 1e-6 {
        return None;
    }
    let open = end.x > distance + FLAT;
    let at =
        if open { sensor.y + (end.y - sensor.y) * (distance - sensor.x) / along } else { end.y };
    Some(Crossing { at, open })
}
