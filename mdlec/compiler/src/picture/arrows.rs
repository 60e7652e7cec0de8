//! Computes the arrows between the boxes of a picture. Arrows show the order of elements and the exits of scopes.

use super::layout::{GAP, Placed, SIDE};
use super::texts::until;
use crate::fsm::{Element, ElementKind, Machine};

/// Meaning of an arrow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arrow {
    /// An arrow to the next element.
    Flow,
    /// A line without a head, into the first element of a box or out of its last element.
    Port,
    /// An arrow that leaves a scope; it shows where the plan continues if the scope's own condition fires.
    Exit,
    /// An arrow back to the beginning of a loop, for its next pass.
    Again,
}

/// A line through `points`, with rounded corners.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Polyline {
    pub(super) arrow: Arrow,
    pub(super) points: Vec<(i64, i64)>,
    /// Nesting depth of the box to which the line belongs.
    pub(super) depth: usize,
}

/// Width of the margin on either side of the plan's box, which contains the signs for the beginning and the end of the
/// plan.
pub(super) const MARGIN: i64 = 44;
/// Distance from a scope's upper edge to the arrow that leaves the scope when its own condition fires.
pub(super) const EXIT: i64 = 16;

/// Returns all arrows, in the order of their boxes.
pub(super) fn arrows(machine: &Machine, all: &[Placed]) -> Vec<Polyline> {
    let mut lines = Vec::new();
    if let Some(root) = all.first() {
        let (y, right) = (root.y + root.enters, root.x + root.width);
        lines.push(line(Arrow::Flow, 0, &[(root.x - MARGIN + 16, y), (root.x, y)]));
        let end = (right + MARGIN - 18, root.y + root.leaves);
        if root.flows {
            lines.push(line(Arrow::Flow, 0, &[(right, end.1), end]));
        }
        lines.extend(exit(machine.root(), root, (end.0 + 6, end.1 - 9), right + MARGIN - 12));
    }
    for (element, placed) in machine.elements().zip(all) {
        inside(element, placed, all, &mut lines);
    }
    lines
}

fn line(arrow: Arrow, depth: usize, points: &[(i64, i64)]) -> Polyline {
    Polyline { arrow, points: points.to_vec(), depth }
}

/// Appends the arrows inside a box: into the first child, between the children, and out of the last child.
fn inside(element: Element<'_>, placed: &Placed, all: &[Placed], lines: &mut Vec<Polyline>) {
    let depth = placed.depth + 1;
    let (Some(first), Some(last)) = (element.children().next(), element.children().last()) else { return };
    let entry = placed.y + placed.enters;
    lines.push(line(Arrow::Port, depth, &[(placed.x, entry), (all[first.index()].x, entry)]));
    for (before, after) in element.children().zip(element.children().skip(1)) {
        let (one, next) = (&all[before.index()], &all[after.index()]);
        let (from, to) = ((one.x + one.width, one.y + one.leaves), (next.x, next.y + next.enters));
        let is_below = placed.rows.contains(&after.index());
        if one.flows {
            let points =
                if is_below { around(from, to, gap_above(after.index(), placed, all)) } else { beside(from, to) };
            lines.push(line(Arrow::Flow, depth, &points));
        }
        if is_below {
            let gap = gap_above(after.index(), placed, all);
            lines.extend(exit_below(before, one, to, gap));
        } else {
            lines.extend(exit(before, one, to, from.0 + GAP / 2));
        }
    }
    let end = &all[last.index()];
    let (from, right) = ((end.x + end.width, end.y + end.leaves), placed.x + placed.width);
    let is_loop = matches!(element.kind(), ElementKind::Loop { .. });
    if is_loop && end.ends {
        lines.push(again(placed, from, (all[first.index()].x, entry)));
    }
    let leads_on = !matches!(element.kind(), ElementKind::Loop { times: None });
    let port = if leads_on { right } else { from.0 + SIDE / 2 };
    if end.flows && leads_on {
        lines.push(line(Arrow::Port, depth, &[from, (right, from.1)]));
    }
    lines.extend(exit(last, end, (port, from.1), from.0 + SIDE / 2));
}

/// Returns the points of an arrow from a box to the next box in its row, whose height may differ.
fn beside(from: (i64, i64), to: (i64, i64)) -> Vec<(i64, i64)> {
    if from.1 == to.1 {
        return vec![from, to];
    }
    let middle = i64::midpoint(from.0, to.0);
    vec![from, (middle, from.1), (middle, to.1), to]
}

/// Returns the points of an arrow from the end of a row to the beginning of the next row, through the gap between them.
fn around(from: (i64, i64), to: (i64, i64), gap: i64) -> Vec<(i64, i64)> {
    vec![
        from,
        (from.0 + SIDE / 2, from.1),
        (from.0 + SIDE / 2, gap),
        (to.0 - SIDE / 2, gap),
        (to.0 - SIDE / 2, to.1),
        to,
    ]
}

/// Returns the middle of the gap above the row that begins with this child.
fn gap_above(child: usize, placed: &Placed, all: &[Placed]) -> i64 {
    let row = placed.children.iter().skip_while(|other| **other != child);
    let next = row.clone().skip(1).find(|other| placed.rows.contains(other));
    let tops = row.take_while(|other| Some(*other) != next).map(|other| all[*other].y);
    tops.min().unwrap_or(0) - GAP / 2
}

/// Returns the arrow for the next pass of a loop. It leads back to the first element, below all elements of the loop.
fn again(placed: &Placed, from: (i64, i64), to: (i64, i64)) -> Polyline {
    let (right, left, below) = (from.0 + SIDE / 2, to.0 - SIDE / 2, placed.y + placed.height - 16);
    line(Arrow::Again, placed.depth, &[from, (right, from.1), (right, below), (left, below), (left, to.1), to])
}

/// Returns the arrow that leaves a scope when its own condition fires. It leads from the scope's right edge to `to`, by
/// way of the vertical line at `over`. The list is empty for an element that has no such exit.
fn exit(element: Element<'_>, placed: &Placed, to: (i64, i64), over: i64) -> Vec<Polyline> {
    if !element.is_scope() || !until(element).ends() {
        return Vec::new();
    }
    let from = (placed.x + placed.width, placed.y + EXIT);
    vec![line(Arrow::Exit, placed.depth, &[from, (over, from.1), (over, to.1), to])]
}

/// Returns the arrow that leaves a scope at the end of a row when its own condition fires. If the scope can also end
/// with its last element, the arrow stops in the gap below the row, where it joins the arrow from the last element;
/// otherwise it continues to `to`.
fn exit_below(element: Element<'_>, placed: &Placed, to: (i64, i64), gap: i64) -> Vec<Polyline> {
    let right = placed.x + placed.width;
    if placed.flows {
        return exit(element, placed, (right - 8, gap), right + GAP / 2);
    }
    // The scope has no other arrow to the next row, so this arrow has to reach it.
    let mut lines = exit(element, placed, (to.0 - SIDE / 2, gap), right + GAP / 2);
    lines.iter_mut().for_each(|line| line.points.extend([(to.0 - SIDE / 2, to.1), to]));
    lines
}
