//! Where the numbers of the atoms go: beside the places where they began, and never on top of each other.

use std::f64::consts::TAU;

/// A place in the drawing, in pixels.
pub(crate) type Pixel = (i32, i32);

/// The radius of a label.
pub(crate) const RADIUS: i32 = 10;
/// The radius of the dot at the place itself.
pub(crate) const DOT: i32 = 3;
/// Directions tried around a place.
const DIRECTIONS: u8 = 16;
/// Distances tried, nearest first.
const DISTANCES: [i32; 6] = [22, 36, 50, 66, 84, 104];
/// Between two labels.
const APART: i32 = 3;

/// A label for each of the `dots`, in order, clear of all dots and of the labels before it, inside `width` × `height`.
pub(crate) fn placed(dots: &[Pixel], (width, height): (i32, i32)) -> Vec<Pixel> {
    let mut labels: Vec<Pixel> = Vec::with_capacity(dots.len());
    for dot in dots {
        let clear = |at: &Pixel| {
            let inside = (RADIUS..width - RADIUS).contains(&at.0) && (RADIUS..height - RADIUS).contains(&at.1);
            inside
                && labels.iter().all(|label| distance(*at, *label) >= f64::from(2 * RADIUS + APART))
                && dots.iter().all(|dot| distance(*at, *dot) >= f64::from(RADIUS + DOT + APART))
        };
        let found = around(*dot).find(clear);
        labels.push(found.unwrap_or(*dot));
    }
    labels
}

/// Where a label could go, best first.
fn around((x, y): Pixel) -> impl Iterator<Item = Pixel> {
    DISTANCES.into_iter().flat_map(move |distance| {
        (0..DIRECTIONS).map(move |direction| {
            // From the upper right round.
            let (sin, cos) = libm::sincos(TAU * (f64::from(direction) / f64::from(DIRECTIONS) + 0.125));
            let along = |part: f64| libm::round(part * f64::from(distance)) as i32;
            (x + along(cos), y - along(sin))
        })
    })
}

fn distance(one: Pixel, other: Pixel) -> f64 {
    libm::hypot(f64::from(one.0 - other.0), f64::from(one.1 - other.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_one_place_lie_apart() {
        let dots = [(300, 300); 24];
        let labels = placed(&dots, (600, 600));
        for (number, one) in labels.iter().enumerate() {
            assert!(distance(*one, (300, 300)) >= f64::from(RADIUS + DOT));
            for other in &labels[number + 1..] {
                assert!(distance(*one, *other) >= f64::from(2 * RADIUS), "{one:?} {other:?}");
            }
        }
    }
}
