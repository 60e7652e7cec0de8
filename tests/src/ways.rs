//! Measures of the paths that robots drove, such as the excess length over a straight line.

/// A place on the floor, in metres.
pub type Point = [f64; 2];

/// Returns the distance between two places, in metres.
#[must_use]
pub fn distance(one: Point, other: Point) -> f64 {
    libm::hypot(one[0] - other[0], one[1] - other[1])
}

/// Returns by how much a path is longer than the distance between its ends, in percent.
///
/// # Panics
///
/// If the path has no places.
#[must_use]
pub fn excess(way: &[Point]) -> f64 {
    let length: f64 = way.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
    (length / distance(way[0], way[way.len() - 1]) - 1.0) * 100.0
}

/// Returns the maximum distance of a path from the line between its ends, in metres.
///
/// # Panics
///
/// If the path has no places.
#[must_use]
pub fn bulge(way: &[Point]) -> f64 {
    let (from, to) = (way[0], way[way.len() - 1]);
    let off = |at: &Point| {
        let cross = (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0]);
        (cross / distance(from, to)).abs()
    };
    way.iter().map(off).fold(0.0, f64::max)
}
