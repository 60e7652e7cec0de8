//! Arranges the numbers of atoms beside the positions at which the atoms began, without overlaps.

use std::f64::consts::TAU;

use super::shapes::{Pixel, RADIUS};

/// Radius of the dot at the labelled position, in pixels.
pub(super) const DOT: f64 = 3.0;
/// Number of directions around a dot that are tried.
const DIRECTIONS: u8 = 16;
/// Distances that are tried, in pixels; the nearest comes first.
const DISTANCES: [f64; 6] = [22.0, 36.0, 50.0, 66.0, 84.0, 104.0];
/// Minimum distance between two labels, in pixels.
const APART: f64 = 3.0;

/// A rectangle, given by its left and right edge, and its upper and lower edge.
pub(super) type LabelBox = ((f64, f64), (f64, f64));

/// Returns the positions of the labels of `dots`, in order. A label is inside the given rectangle, and overlaps no dot
/// and no earlier label. If possible, it also overlaps none of `lines`; these are given as points that are at most the
/// width of a label apart.
pub(super) fn placed(dots: &[Pixel], lines: &[Pixel], ((left, right), (top, bottom)): LabelBox) -> Vec<Pixel> {
    let mut labels: Vec<Pixel> = Vec::with_capacity(dots.len());
    for dot in dots {
        let clear = |at: &Pixel| {
            let inside =
                (left + RADIUS..right - RADIUS).contains(&at.0) && (top + RADIUS..bottom - RADIUS).contains(&at.1);
            inside
                && labels.iter().all(|label| distance(*at, *label) >= 2.0 * RADIUS + APART)
                && dots.iter().all(|dot| distance(*at, *dot) >= RADIUS + DOT + APART)
        };
        let free = |at: &Pixel| lines.iter().all(|line| distance(*at, *line) >= RADIUS + APART);
        let found = around(*dot).find(|at| clear(at) && free(at)).or_else(|| around(*dot).find(clear));
        labels.push(found.unwrap_or(*dot));
    }
    labels
}

/// Returns candidate positions of a label; the best comes first.
fn around((x, y): Pixel) -> impl Iterator<Item = Pixel> {
    DISTANCES.into_iter().flat_map(move |distance| {
        (0..DIRECTIONS).map(move |direction| {
            // Begins at the upper right.
            let (sin, cos) = libm::sincos(TAU * (f64::from(direction) / f64::from(DIRECTIONS) + 0.125));
            (x + cos * distance, y - sin * distance)
        })
    })
}

fn distance(one: Pixel, other: Pixel) -> f64 {
    libm::hypot(one.0 - other.0, one.1 - other.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_beside_a_line_where_there_is_room() {
        let line: Vec<Pixel> = (0..60).map(|step| (f64::from(step) * 10.0, 300.0 - f64::from(step) * 2.0)).collect();
        let [label] = placed(&[(300.0, 240.0)], &line, ((0.0, 600.0), (0.0, 600.0)))[..] else { panic!("one label") };
        assert!(line.iter().all(|at| distance(*at, label) > RADIUS), "{label:?}");
    }

    #[test]
    fn labels_of_one_place_lie_apart() {
        let dots = [(300.0, 300.0); 24];
        let labels = placed(&dots, &[], ((0.0, 600.0), (0.0, 600.0)));
        for (number, one) in labels.iter().enumerate() {
            assert!(distance(*one, (300.0, 300.0)) >= RADIUS + DOT);
            for other in &labels[number + 1..] {
                assert!(distance(*one, *other) >= 2.0 * RADIUS, "{one:?} {other:?}");
            }
        }
    }
}
