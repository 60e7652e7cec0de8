//! The breakpoints of a session. A breakpoint stops the run at a place in the plan, at the entry of an atom or of a
//! named scope, or at a time.

use std::collections::BTreeMap;
use std::path::Path;

use mdle_compiler::alphabet::{Decimal, ParameterKind, Unit};
use mdle_compiler::diagnostic::{SourceId, Span};
use mdle_compiler::plan::{Plan, PlanPart};
use mdle_runtime::Nanos;

use crate::launch::LaunchedPlan;
use crate::places::{StopPlace, meant, places};
use crate::run::{DebugRun, StepKind};

/// Number of a breakpoint.
pub(crate) type Id = i64;

/// The breakpoints of a session.
#[derive(Debug)]
pub(crate) struct Breakpoints {
    places: Vec<StopPlace>,
    /// For each file, the numbers of its breakpoints, with the places at which they stop the run.
    lines: BTreeMap<SourceId, Vec<(Id, StopPlace)>>,
    names: Vec<(Id, NamedBreakpoint)>,
    last: Id,
}

/// Condition of a breakpoint that has no place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
enum NamedBreakpoint {
    /// The entry of a scope with this name, or of an atom with this law.
    Entered(String),
    /// The first turn with a plan time of at least this time.
    Time(Nanos),
}

impl Breakpoints {
    /// Creates the breakpoints of a plan; none is set.
    pub(crate) fn new(loaded: &LaunchedPlan) -> Self {
        Self { places: places(loaded), lines: BTreeMap::new(), names: Vec::new(), last: 0 }
    }

    /// Returns all places at which a run can stop.
    pub(crate) fn places(&self) -> &[StopPlace] {
        &self.places
    }

    /// Replaces the breakpoints in a file by breakpoints at the given lines and columns, which are counted from 0.
    /// Returns the number of each breakpoint, with its place or the reason why it has none.
    pub(crate) fn set(
        &mut self,
        loaded: &LaunchedPlan,
        path: &Path,
        wanted: &[(u32, Option<u32>)],
    ) -> Vec<(Id, Result<StopPlace, String>)> {
        let source = loaded.source(path);
        let mut set = Vec::new();
        for (line, column) in wanted {
            self.last += 1;
            let place = match source {
                None => Err("this file has no part of the plan that runs".to_owned()),
                Some(source) => meant(&self.places, source, *line, *column)
                    .ok_or_else(|| "nothing of the plan that runs begins here or after this line".to_owned()),
            };
            set.push((self.last, place));
        }
        if let Some(source) = source {
            let placed = set.iter().filter_map(|(id, place)| Some((*id, place.clone().ok()?)));
            self.lines.insert(source, placed.collect());
        }
        set
    }

    /// Replaces the breakpoints that have no place in a file. Returns the number of each breakpoint; `Err` contains the
    /// reason why it cannot stop a run.
    pub(crate) fn set_names(&mut self, plan: &Plan, wanted: &[String]) -> Vec<(Id, Result<(), String>)> {
        self.names.clear();
        let mut set = Vec::new();
        for text in wanted {
            self.last += 1;
            let name = name(plan, text.trim());
            self.names.extend(name.clone().ok().map(|name| (self.last, name)));
            set.push((self.last, name.map(drop)));
        }
        set
    }

    /// Returns the breakpoints at the current position of a run. `step` is the step that led to this position, or
    /// `None` at the start of the run.
    pub(crate) fn hits(&self, run: &DebugRun<'_>, plan: &Plan, step: Option<StepKind>) -> Vec<Id> {
        let entered = match step {
            None => 0,
            Some(StepKind::Transition { kept, .. }) => kept,
            Some(StepKind::Turn | StepKind::End) => usize::MAX,
        };
        let entered: Vec<PlanPart<'_>> = run.open().skip(entered).map(|open| open.part()).collect();
        let firing = if self.lines.values().all(Vec::is_empty) { Vec::new() } else { run.firing() };
        let is_hit = |place: &StopPlace| {
            let has = |span: &Span| *span == place.span;
            if place.is_operand { firing.iter().any(has) } else { entered.iter().any(|part| has(&part.span())) }
        };
        let at_places = self.lines.values().flatten().filter(|(_, place)| is_hit(place)).map(|(id, _)| *id);
        let by_name = self.names.iter().filter(|(_, name)| match name {
            NamedBreakpoint::Entered(name) => entered.iter().any(|part| is_called(*part, plan, name)),
            NamedBreakpoint::Time(time) => {
                let begins = matches!(step, None | Some(StepKind::Turn));
                begins && run.reports().t >= *time && run.reports_before().is_none_or(|before| before.t < *time)
            }
        });
        at_places.chain(by_name.map(|(id, _)| *id)).collect()
    }
}

/// Parses the text of a breakpoint that has no place in a file. The text is a name, or a time with its unit.
fn name(plan: &Plan, text: &str) -> Result<NamedBreakpoint, String> {
    if text.starts_with(|c: char| c.is_ascii_digit()) {
        return time(text)
            .map(NamedBreakpoint::Time)
            .ok_or_else(|| format!("`{text}` is no time: write it as `2.5s` or `500ms`"));
    }
    let is_there = plan.parts().any(|part| is_called(part, plan, text));
    let words = || format!("`{text}` is no plan, no behavior and no law of this plan; a time is written as `2.5s`");
    if is_there { Ok(NamedBreakpoint::Entered(text.to_owned())) } else { Err(words()) }
}

fn time(text: &str) -> Option<Nanos> {
    let (number, unit) = text.split_at(text.find(|c: char| c.is_ascii_alphabetic())?);
    let unit = Unit::from_name(unit).filter(|unit| unit.kind == ParameterKind::Time)?;
    Decimal::parse(number.trim())?.scaled(unit.factor, unit.exponent).to_nanos().map(Nanos)
}

/// Returns `true` if `part` is a scope with this name or an atom with this law.
fn is_called(part: PlanPart<'_>, plan: &Plan, name: &str) -> bool {
    match part {
        PlanPart::Scope(scope) => scope.name == name,
        PlanPart::Atom(atom) => plan.quark(atom.law).name == name,
        PlanPart::Loop(_) => false,
    }
}
