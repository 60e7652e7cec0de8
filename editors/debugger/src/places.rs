//! Places in a plan at which a run can stop: starts of elements, and operands of conditions.

use mdle_compiler::diagnostic::{SourceId, Span};
use mdle_compiler::plan::PlanPart;

use crate::launch::LaunchedPlan;

/// A place at which a run can stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct StopPlace {
    source: SourceId,
    /// Line of the start, counted from 0.
    pub(crate) line: u32,
    /// Column of the start, counted from 0.
    pub(crate) column: u32,
    /// `true` for an operand of a condition, `false` for a scope, a loop or an atom.
    pub(crate) is_operand: bool,
    pub(crate) span: Span,
}

/// Returns all places of a plan, sorted by file and position.
pub(crate) fn places(loaded: &LaunchedPlan) -> Vec<StopPlace> {
    let place = |span: Span, is_operand: bool| {
        let (source, line, column) = loaded.place(span);
        StopPlace { source, line, column, is_operand, span }
    };
    let mut places = Vec::new();
    for part in loaded.compiled.plan.parts() {
        // A loop is entered together with its first element.
        if !matches!(part, PlanPart::Loop(_)) {
            places.push(place(part.span(), false));
        }
        let operands = part.interrupt().into_iter().flat_map(|interrupt| &interrupt.operands);
        places.extend(operands.map(|operand| place(operand.span, true)));
    }
    places.sort();
    // A plan that is used twice adds its places twice.
    places.dedup();
    places
}

/// Returns the place at which a breakpoint in the given line stops the run. If a column is given, this is the operand
/// at the column. If there is no operand, it is the next place in the line, or else the last place in the line. If no
/// column is given, this is the element that begins in the line. If none of these places exists, it is the next place
/// in the file.
pub(crate) fn meant(places: &[StopPlace], source: SourceId, line: u32, column: Option<u32>) -> Option<StopPlace> {
    let from = places.partition_point(|place| (place.source, place.line) < (source, line));
    let to = places.partition_point(|place| (place.source, place.line) <= (source, line));
    let (in_line, after) = (places.get(from..to)?, places.get(from..)?);
    let next = || after.iter().find(|place| place.source == source);
    let found = match column {
        Some(column) => {
            let around = |place: &&StopPlace| place.is_operand && place.column <= column && column < place.end_column();
            let behind = || in_line.iter().find(|place| place.column >= column);
            in_line.iter().rev().find(around).or_else(behind).or_else(|| in_line.last())
        }
        None => in_line.iter().find(|place| !place.is_operand),
    };
    found.or_else(next).copied()
}

/// Returns the places that begin in the lines from `first` to `last`.
pub(crate) fn between(
    places: &[StopPlace],
    source: SourceId,
    first: u32,
    last: u32,
) -> impl Iterator<Item = &StopPlace> {
    places.iter().filter(move |place| place.source == source && (first..=last).contains(&place.line))
}

impl StopPlace {
    /// Returns the column after the end of the place, which must end in the line in which it begins. Each character of
    /// an operand is one UTF-16 unit.
    fn end_column(&self) -> u32 {
        self.column.saturating_add(self.span.end.saturating_sub(self.span.start))
    }
}
