//! The cells of a straight line.

use super::Cell;

/// Returns the cells of the line between the centres of `from` and `to`, both included, in order (Bresenham 1965,
/// "Algorithm for computer control of a digital plotter").
pub fn line(from: Cell, to: Cell) -> impl Iterator<Item = Cell> {
    let (dx, dy) = ((to.x - from.x).abs(), -(to.y - from.y).abs());
    let (sx, sy) = ((to.x - from.x).signum(), (to.y - from.y).signum());
    let mut error = dx + dy;
    let mut next = Some(from);
    std::iter::from_fn(move || {
        let cell = next?;
        next = (cell != to).then(|| {
            let doubled = 2 * error;
            let mut ahead = cell;
            if doubled >= dy {
                error += dy;
                ahead.x += sx;
            }
            if doubled <= dx {
                error += dx;
                ahead.y += sy;
            }
            ahead
        });
        Some(cell)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn joins_its_ends_by_neighbours(x in -40..40, y in -40..40) {
            let (from, to) = (Cell::new(3, -2), Cell::new(x, y));
            let cells: Vec<_> = line(from, to).collect();
            prop_assert_eq!(cells.first(), Some(&from));
            prop_assert_eq!(cells.last(), Some(&to));
            prop_assert_eq!(
                i32::try_from(cells.len()).unwrap(),
                (x - 3).abs().max((y + 2).abs()) + 1
            );
            prop_assert!(cells.windows(2).all(|w| w[0].neighbours8().contains(&w[1])));
        }
    }
}
