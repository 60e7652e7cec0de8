//! The lines between pixels that stand and pixels that do not, without the steps that pixels make of slanted lines.

use std::collections::BTreeMap;

/// How far a line may pass from the corners of pixels that it replaces, in pixels. The steps of a slanted line lie up to 1 off
/// it, and a little more where it begins at the wrong one.
const TOLERANCE: f64 = 1.25;

/// A corner of pixels: column and row of lines between them.
type Corner = (i32, i32);

/// Closed lines around what stands, each ending where it began, in an order that depends on nothing but the image.
pub(super) fn contours(width: usize, height: usize, stands: impl Fn(usize, usize) -> bool) -> Vec<Vec<Corner>> {
    let mut edges = edges(width, height, stands);
    let mut loops = Vec::new();
    while let Some((from, _)) = edges.first_key_value() {
        let from = *from;
        let mut line = vec![from];
        let (mut here, mut came) = (from, (0, 0));
        while let Some(next) = taken(&mut edges, here, came) {
            came = (next.0 - here.0, next.1 - here.1);
            here = next;
            line.push(here);
            if here == from {
                break;
            }
        }
        loops.push(smoothed(&line));
    }
    loops
}

/// The sides of pixels where something stands on the left only, as steps from each corner.
fn edges(width: usize, height: usize, stands: impl Fn(usize, usize) -> bool) -> BTreeMap<Corner, Vec<Corner>> {
    let mut edges: BTreeMap<Corner, Vec<Corner>> = BTreeMap::new();
    let mut taken = |from: Corner, to: Corner| edges.entry(from).or_default().push(to);
    for row in 0..height {
        for column in (0..width).filter(|column| stands(*column, row)) {
            // A pixel's number fits: there are at most 100 million.
            let (x, y) = (column as i32, row as i32);
            if row == 0 || !stands(column, row - 1) {
                taken((x + 1, y), (x, y));
            }
            if row + 1 == height || !stands(column, row + 1) {
                taken((x, y + 1), (x + 1, y + 1));
            }
            if column == 0 || !stands(column - 1, row) {
                taken((x, y), (x, y + 1));
            }
            if column + 1 == width || !stands(column + 1, row) {
                taken((x + 1, y + 1), (x + 1, y));
            }
        }
    }
    edges
}

/// Takes the edge that goes on from `here`; where two pixels touch at a corner, the one that stays with its pixel.
fn taken(edges: &mut BTreeMap<Corner, Vec<Corner>>, here: Corner, came: Corner) -> Option<Corner> {
    let ways = edges.get_mut(&here)?;
    let turns = |to: &Corner| came.0 * (to.1 - here.1) - came.1 * (to.0 - here.0);
    let best = (0..ways.len()).min_by_key(|number| ways.get(*number).map(turns))?;
    let next = ways.remove(best);
    if ways.is_empty() {
        edges.remove(&here);
    }
    Some(next)
}

/// The line through fewer of its corners that passes none further than the tolerance (Douglas and Peucker, 1973).
fn smoothed(line: &[Corner]) -> Vec<Corner> {
    let far = |from: Corner| {
        let distance = |to: &Corner| i64::from(to.0 - from.0).pow(2) + i64::from(to.1 - from.1).pow(2);
        (0..line.len()).max_by_key(|number| line.get(*number).map_or(0, distance)).unwrap_or(0)
    };
    let Some(first) = line.first() else { return Vec::new() };
    // A closed line is split where it is furthest from its beginning.
    let split = far(*first);
    let mut kept = vec![false; line.len()];
    let mut open = vec![(0, split), (split, line.len() - 1)];
    while let Some((from, to)) = open.pop() {
        kept[from] = true;
        kept[to] = true;
        let off = |number: usize| distance(line[number], line[from], line[to]);
        let Some(worst) = (from + 1..to).max_by(|one, other| off(*one).total_cmp(&off(*other))) else { continue };
        if off(worst) > TOLERANCE {
            open.extend([(from, worst), (worst, to)]);
        }
    }
    // What is thinner than the tolerance becomes a line there and back: a wall without thickness.
    line.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(corner, _)| *corner).collect()
}

/// The distance of a corner from the line between two others.
fn distance(at: Corner, from: Corner, to: Corner) -> f64 {
    let number = |value: i32| f64::from(value);
    let (dx, dy) = (number(to.0 - from.0), number(to.1 - from.1));
    let (x, y) = (number(at.0 - from.0), number(at.1 - from.1));
    let length = libm::hypot(dx, dy);
    if length == 0.0 { libm::hypot(x, y) } else { (x * dy - y * dx).abs() / length }
}
