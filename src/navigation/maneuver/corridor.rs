//! The walls on either side, and the middle of the corridor between them.

use super::outlook::Outlook;
use crate::geometry::Point;

/// Side of a bin across the leg (m), and their number on one side.
const BIN: f64 = 0.05;
const BINS: usize = 60;
/// How far behind the base walls count (m).
const BEHIND: f64 = 0.5;
/// Fewest points of a wall, and the least length along the leg over which they lie (m).
const POINTS: u32 = 6;
const LENGTH: f64 = 0.4;

/// Returns the distances (m) of the nearest walls along the leg to the left and to the right, where there are such.
/// Doors and side corridors are gaps in them, with other walls farther away, so they pull nothing aside.
pub(super) fn sides(outlook: &Outlook, ahead: f64) -> [Option<f64>; 2] {
    [1.0, -1.0].map(|sign| side(outlook, ahead, sign))
}

fn side(outlook: &Outlook, ahead: f64, sign: f64) -> Option<f64> {
    let mut bins = [(0_u32, f64::INFINITY, f64::NEG_INFINITY); BINS];
    let within = |point: &Point| (-BEHIND..=ahead).contains(&point.x) && point.y * sign > 0.0;
    for point in outlook.points().filter(within) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "above zero")]
        let bin = (point.y * sign / BIN) as usize;
        if let Some((count, first, last)) = bins.get_mut(bin) {
            (*count, *first, *last) = (*count + 1, first.min(point.x), last.max(point.x));
        }
    }
    // Two bins at a time, so that a wall on their border is one.
    let wall = (0..BINS - 1).find(|&i| {
        let (near, far) = (bins[i], bins[i + 1]);
        near.0 > 0 && near.0 + far.0 >= POINTS && near.2.max(far.2) - near.1.min(far.1) >= LENGTH
    })?;
    #[expect(clippy::cast_precision_loss, reason = "few bins")]
    let from = wall as f64 * BIN;
    let (sum, count) = outlook
        .points()
        .filter(within)
        .map(|point| point.y * sign)
        .filter(|y| (from..from + 2.0 * BIN).contains(y))
        .fold((0.0, 0.0), |(sum, count), y| (sum + y, count + 1.0));
    Some(sum / count)
}
