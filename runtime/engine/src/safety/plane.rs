//! Points, vectors and edges in the plane; lengths are in metres.

/// A vector or a point in the plane.
pub(super) type Point = [f64; 2];
/// An edge, from one point to another.
pub(super) type Edge = (Point, Point);

/// Returns the unit vector of a heading.
pub(super) fn direction(heading: f64) -> Point {
    [libm::cos(heading), libm::sin(heading)]
}

/// Returns the cross product of two vectors.
pub(super) fn cross([ax, ay]: Point, [bx, by]: Point) -> f64 {
    ax * by - ay * bx
}

/// Returns the dot product of two vectors.
pub(super) fn dot([ax, ay]: Point, [bx, by]: Point) -> f64 {
    ax * bx + ay * by
}

/// Returns the vector from one point to another.
pub(super) fn between([ax, ay]: Point, [bx, by]: Point) -> Point {
    [bx - ax, by - ay]
}

/// Returns the distance from `here` in the direction `way`, a unit vector, to the first point that is at most `margin`
/// from the edge; `None` if there is no such point. If `here` is within the margin, returns 0 if `way` leads towards
/// the edge, and `None` if it leads away from it.
pub(super) fn reach(here: Point, way: Point, edge: Edge, margin: f64) -> Option<f64> {
    let (from, to) = edge;
    let to_edge = between(here, nearest(here, edge));
    if libm::hypot(to_edge[0], to_edge[1]) <= margin {
        return (dot(way, to_edge) > 0.0 || hit(here, way, edge).is_some()).then_some(0.0);
    }
    let [x, y] = between(from, to);
    let length = libm::hypot(x, y);
    let aside = [-y / length * margin, x / length * margin];
    let moved = |[x, y]: Point, sign: f64| [x + sign * aside[0], y + sign * aside[1]];
    let sides = [1.0, -1.0].into_iter().filter_map(|sign| hit(here, way, (moved(from, sign), moved(to, sign))));
    let ends = [from, to].into_iter().filter_map(|corner| {
        let corner = between(here, corner);
        let (along, across) = (dot(way, corner), cross(way, corner));
        let half = margin * margin - across * across;
        (along >= 0.0 && half >= 0.0).then(|| along - libm::sqrt(half))
    });
    sides.chain(ends).min_by(f64::total_cmp)
}

/// Returns the distance from `here` to the edge in the direction `way`, a unit vector; `None` if the edge is not in
/// this direction.
pub(super) fn hit(here: Point, way: Point, (from, to): Edge) -> Option<f64> {
    let (edge, begin) = (between(from, to), between(here, from));
    let across = cross(way, edge);
    let along = cross(begin, edge) / across;
    let part = cross(begin, way) / across;
    (across != 0.0 && along >= 0.0 && (0.0..=1.0).contains(&part)).then_some(along)
}

/// Returns the point of the edge nearest to `here`.
pub(super) fn nearest(here: Point, (from, to): Edge) -> Point {
    let edge = [to[0] - from[0], to[1] - from[1]];
    let length = edge[0] * edge[0] + edge[1] * edge[1];
    let part = ((here[0] - from[0]) * edge[0] + (here[1] - from[1]) * edge[1]) / length;
    let part = part.clamp(0.0, 1.0);
    [from[0] + part * edge[0], from[1] + part * edge[1]]
}

/// Returns `true` if the edges have a point in common.
pub(super) fn cross_over(one: Edge, other: Edge) -> bool {
    let side = |(from, to): Edge, point: Point| {
        let way = cross([to[0] - from[0], to[1] - from[1]], [point[0] - from[0], point[1] - from[1]]);
        if way == 0.0 {
            0
        } else if way > 0.0 {
            1
        } else {
            -1
        }
    };
    let sides = (side(one, other.0), side(one, other.1), side(other, one.0), side(other, one.1));
    if sides == (0, 0, 0, 0) {
        let overlap = |axis: usize| {
            let [a, b, c, d] = [one.0, one.1, other.0, other.1].map(|point| point[axis]);
            a.max(b) >= c.min(d) && c.max(d) >= a.min(b)
        };
        return overlap(0) && overlap(1);
    }
    sides.0 * sides.1 <= 0 && sides.2 * sides.3 <= 0
}
