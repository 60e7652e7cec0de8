//! Computes the positions of boxes in a picture. The children of a scope or a loop are arranged in rows inside it.

use super::exits::ends;
use super::measure::{LINE, letters, width, wrapped};
use super::texts::{Until, exponent, labels, passes, until};
use crate::fsm::{Atom, Element, ElementKind, Machine};
use crate::plan::frame_text;

/// Maximum width of a picture, in pixels, unless a single element is wider.
const PICTURE: i64 = 1180;
/// Minimum width of a box's content, in pixels, regardless of the nesting depth.
const LEAST: i64 = 400;
/// Distance between adjacent boxes, and between a box and its content, in pixels.
pub(super) const GAP: i64 = 34;
pub(super) const SIDE: i64 = 26;
const BETWEEN_ROWS: i64 = 34;
const BOTTOM: i64 = 16;
/// Height, in pixels, below the content of a loop, where the arrow to the next pass is drawn.
const AGAIN: i64 = 30;
const PADDING: i64 = 10;
/// Maximum width of an atom's text, in characters.
const LETTERS: usize = 30;
/// Maximum number of lines of an atom's text.
const LINES: usize = 3;

/// Style of a line in a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    Law,
    Name,
    Until,
    Quiet,
}

/// The box of a bracket. While boxes are being computed, its position is relative to the enclosing box.
#[derive(Debug, Clone, Default)]
pub(super) struct Placed {
    pub(super) x: i64,
    pub(super) y: i64,
    pub(super) width: i64,
    pub(super) height: i64,
    /// Distance from the box's upper edge to the arrow that enters the box.
    pub(super) enters: i64,
    /// Distance from the box's upper edge to the arrow that leaves the box.
    pub(super) leaves: i64,
    /// Lines at the head of the box, from top to bottom.
    pub(super) lines: Vec<(Style, String)>,
    pub(super) children: Vec<usize>,
    /// Numbers of the children that begin a row.
    pub(super) rows: Vec<usize>,
    /// Number of scopes and loops that enclose the box.
    pub(super) depth: usize,
    /// `true` if the element can end.
    pub(super) ends: bool,
    /// `true` if the element can end together with its last element, or is an atom that can end.
    pub(super) flows: bool,
}

/// Returns the boxes of all elements; the index is the element's number. No recursion is needed, because enclosing
/// elements have smaller numbers.
pub(super) fn places(machine: &Machine) -> Vec<Placed> {
    let mut all: Vec<Placed> = Vec::new();
    for (element, ends) in machine.elements().zip(ends(machine)) {
        let depth = element.parent().map_or(0, |parent| all[parent.index()].depth + 1);
        let children = element.children().map(Element::index).collect();
        all.push(Placed { depth, children, ends: ends.ever, flows: ends.at_its_end, ..Placed::default() });
    }
    for element in machine.elements().rev() {
        match element.kind() {
            ElementKind::Atom(of) => atom(of, &mut all[element.index()]),
            ElementKind::Scope | ElementKind::Loop { .. } => holder(element, &mut all),
        }
    }
    if let Some(root) = all.first_mut() {
        (root.x, root.y) = (0, 0);
    }
    for number in 0..all.len() {
        let (x, y) = (all[number].x, all[number].y);
        for child in all[number].children.clone() {
            all[child].x += x;
            all[child].y += y;
        }
    }
    all
}

fn atom(atom: Atom<'_>, placed: &mut Placed) {
    let parts = [
        (Style::Quiet, labels(atom.element()), 1),
        (Style::Quiet, frame_text(atom.frame()), 1),
        (Style::Law, atom.law().text.clone(), LINES),
    ];
    let wrap = |(style, text, most): (Style, String, usize)| {
        wrapped(&text, LETTERS, most).into_iter().map(move |line| (style, line))
    };
    let mut lines: Vec<_> = parts.into_iter().flat_map(wrap).collect();
    lines.extend(until_lines(&until(atom.element()), LETTERS));
    placed.width = widest(&lines).max(80) + 2 * PADDING;
    placed.height = lines.len() as i64 * LINE + 2 * PADDING;
    placed.enters = placed.height / 2;
    placed.leaves = placed.enters;
    placed.lines = lines;
}

/// Returns the lines that show the condition by which an element ends.
fn until_lines(until: &Until, letters: usize) -> Vec<(Style, String)> {
    let (style, text) = match until {
        Until::Fires(text) => (Style::Until, format!("until {text}")),
        Until::Done => (Style::Until, "until done".into()),
        Until::FiresOrDone(text) => (Style::Until, format!("until {text} or done")),
        Until::Removed(_) | Until::Never => (Style::Quiet, "never ends by itself".into()),
    };
    wrapped(&text, letters, LINES).into_iter().map(|line| (style, line)).collect()
}

fn widest(lines: &[(Style, String)]) -> i64 {
    lines.iter().map(|(_, line)| width(line)).max().unwrap_or(0)
}

/// Places the children of a scope or a loop, and computes its size. The sizes of the children must already be known.
fn holder(element: Element<'_>, all: &mut [Placed]) {
    let number = element.index();
    let children = all[number].children.clone();
    let room = (PICTURE - 2 * SIDE * all[number].depth as i64).max(LEAST);
    let limit = even(&children, all, room);
    let rows = rows(&children, all, limit);
    let content = rows.iter().map(|row| row_width(row, all)).max().unwrap_or(0);
    let lines = head(element, content);
    let inside = content.max(widest(&lines) - SIDE);
    let mut y = PADDING + lines.len() as i64 * LINE + PADDING;
    let (mut enters, mut leaves) = (y, y);
    for (place, row) in rows.iter().enumerate() {
        let above = row.iter().map(|child| all[*child].enters).max().unwrap_or(0);
        let mut x = SIDE;
        for child in row {
            let child = &mut all[*child];
            (child.x, child.y) = (x, y + above - child.enters);
            x += child.width + GAP;
        }
        if place == 0 {
            enters = y + above;
        }
        let bottom = row.iter().map(|child| all[*child].y + all[*child].height).max().unwrap_or(y);
        leaves = row.last().map_or(leaves, |last| all[*last].y + all[*last].leaves);
        y = bottom + if place + 1 < rows.len() { BETWEEN_ROWS } else { 0 };
    }
    let again = if matches!(element.kind(), ElementKind::Loop { .. }) { AGAIN } else { 0 };
    let placed = &mut all[number];
    placed.width = inside + 2 * SIDE;
    placed.height = y + BOTTOM + again;
    (placed.enters, placed.leaves, placed.lines) = (enters, leaves, lines);
    placed.rows = rows.iter().filter_map(|row| row.first().copied()).collect();
}

/// Returns the lines at the head of a scope or a loop.
fn head(element: Element<'_>, content: i64) -> Vec<(Style, String)> {
    let letters = letters(content + SIDE).max(34);
    let labels = labels(element);
    let named =
        |name: &str| wrapped(&format!("{labels}{name}"), letters, 1).into_iter().map(|line| (Style::Name, line));
    match element.kind() {
        ElementKind::Loop { times } => named(&format!("{} ({})", exponent(times), passes(times))).collect(),
        ElementKind::Scope => {
            let until = until(element);
            let until = if until.ends() { until_lines(&until, letters) } else { Vec::new() };
            named(element.name()).chain(until).collect()
        }
        ElementKind::Atom(_) => Vec::new(),
    }
}

/// Returns the smallest width at which the children need no more rows than at the width `room`. With this width, the
/// rows are about equally long.
fn even(children: &[usize], all: &[Placed], room: i64) -> i64 {
    let needed = rows(children, all, room).len();
    let (mut low, mut high) = (0, room);
    while low + 1 < high {
        let middle = i64::midpoint(low, high);
        if rows(children, all, middle).len() > needed {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Arranges the children in rows. Each row is at most `limit` wide, unless a single child is wider.
fn rows(children: &[usize], all: &[Placed], limit: i64) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = Vec::new();
    let mut taken = 0;
    for child in children {
        let wide = all[*child].width;
        match rows.last_mut() {
            Some(row) if taken + GAP + wide <= limit => {
                row.push(*child);
                taken += GAP + wide;
            }
            Some(_) | None => {
                rows.push(vec![*child]);
                taken = wide;
            }
        }
    }
    rows
}

fn row_width(row: &[usize], all: &[Placed]) -> i64 {
    row.iter().map(|child| all[*child].width).sum::<i64>() + GAP * (row.len() as i64 - 1)
}
