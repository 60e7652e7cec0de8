//! `mdle why --not`: the first chance of an atom to begin in a run, and what kept it from that.

use std::collections::BTreeMap;

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::fsm::{Element, Machine};
use mdle_host::Texts;
use mdle_runtime::Nanos;

use super::explanation::{AtomWords, Explainer, Scope};
use crate::rerun::{Moment, ScopeMoment};
use crate::rerun::{Rerun, RerunTurn, Stop};

/// A turn: its number and its time.
pub(crate) type Turned = (u64, Nanos);

/// The answer why an atom did not begin.
#[derive(Debug)]
pub(crate) struct Never {
    /// The atom as it was asked for.
    pub(crate) atom: String,
    /// The first turn in which its law was applied, and the cause of the transition to it.
    pub(crate) ran: Option<(Turned, String)>,
    /// The first turn in which it was entered and left again.
    pub(crate) skipped: Option<Stay>,
    /// The first chance to begin; `None` if there was none.
    pub(crate) chance: Option<Chance>,
    /// The end of the record.
    pub(crate) end: Turned,
    /// The atom that ran last; `None` if the plan was over.
    pub(crate) last: Option<AtomWords>,
}

/// A turn with an atom and the scopes around it.
#[derive(Debug)]
pub(crate) struct Stay {
    pub(crate) turned: Turned,
    pub(crate) atom: AtomWords,
    pub(crate) scopes: Vec<Scope>,
    /// Cause of the transition; empty if there was none.
    pub(crate) cause: String,
}

/// The turns in which the end of a scope would have led to an atom.
#[derive(Debug)]
pub(crate) struct Chance {
    /// Name of what would have begun, if it is not the atom that was asked for, but a scope around it.
    pub(crate) begins: Option<String>,
    /// The number of the scope among those that are listed, from the plan.
    pub(crate) scope: usize,
    /// The first of these turns.
    pub(crate) first: Stay,
    /// The last of these turns, and what ended instead if anything did.
    pub(crate) last: Stay,
}

/// A chance while the record is read.
struct Door {
    level: u16,
    first: Stay,
    last: Option<Stay>,
    /// The last turn in which it was open, its moment and its output.
    latest: (RerunPlace, Moment),
}

/// A turn with the ages of its sonars.
#[derive(Clone, Copy)]
struct RerunPlace {
    turned: Turned,
    facts: super::operands::Facts,
}

/// Answers why the atom of this text did not begin.
///
/// # Errors
/// The plan has no such atom: a sentence.
pub(crate) fn never(machine: &Machine, text: &str, rerun: &mut dyn Rerun) -> Result<Result<Never, Stop>, String> {
    let wanted = atoms(machine, text, rerun.texts())?;
    let mut search = Search {
        explainer: Explainer::new(machine),
        doors: BTreeMap::new(),
        answer: Never {
            atom: text.to_owned(),
            ran: None,
            skipped: None,
            chance: None,
            end: (0, Nanos::ZERO),
            last: None,
        },
        wanted,
    };
    while let Some(turn) = rerun.turn(&mut |_, _| true) {
        match turn {
            Ok(turn) => search.turn(&turn, rerun.texts()),
            Err(stop) => return Ok(Err(stop)),
        }
    }
    Ok(Ok(search.answer(machine, rerun.texts())))
}

/// Returns the atoms that are meant: those of a law or a line, or the first of each scope of a name.
fn atoms(machine: &Machine, text: &str, plan: &dyn Texts) -> Result<Vec<u32>, String> {
    let is_line = |element: Element<'_>| {
        let at = plan.source().bracket(element.number()).map(|words| words.at);
        at.is_some_and(|at| text == at.line.to_string() || text == format!("{}:{}", plan.source().file(at), at.line))
    };
    let is_meant = |element: Element<'_>| match element.atom() {
        Some(atom) => atom.law().text.split_whitespace().eq(text.split_whitespace()) || is_line(element),
        None => element.name() == text,
    };
    let mut found: Vec<_> =
        machine.elements().filter(|element| is_meant(*element)).map(|element| element.first().number()).collect();
    found.dedup();
    if !found.is_empty() && !text.is_empty() {
        return Ok(found);
    }
    let mut known: Vec<&str> = machine.atoms().map(|atom| atom.law().text.as_str()).collect();
    known.extend(machine.elements().map(Element::name).filter(|name| !name.is_empty()));
    known.sort_unstable();
    known.dedup();
    Err(format!("the plan has no atom `{text}`{}\nhelp: it has {}", did_you_mean(text, &known), known.join(", ")))
}

struct Search<'m> {
    explainer: Explainer<'m>,
    wanted: Vec<u32>,
    /// The first chance of each atom.
    doors: BTreeMap<u32, Door>,
    answer: Never,
}

impl Search<'_> {
    fn turn(&mut self, turn: &RerunTurn, plan: &dyn Texts) {
        let turned = (turn.recorded.number, turn.recorded.t);
        let steps = self.explainer.each(turn, plan);
        for (number, step) in steps.iter().enumerate() {
            let Some(moment) = turn.moments.get(number) else { continue };
            let place = RerunPlace { turned, facts: Explainer::facts(turn, moment) };
            self.chances(place, moment, &step.cause, plan);
            if moment.is_new() && self.answer.skipped.is_none() && self.wanted.contains(&moment.atom) {
                self.answer.skipped = Some(self.stay(place, moment, &step.cause, plan));
            }
            self.explainer.step(&step.transition, plan);
        }
        self.answer.end = turned;
        self.answer.last = None;
        let Some(moment) = turn.moments.get(steps.len()) else { return };
        let place = RerunPlace { turned, facts: Explainer::facts(turn, moment) };
        self.answer.last = Some(self.explainer.atom(plan, moment.atom));
        if self.answer.ran.is_none() && self.wanted.contains(&moment.atom) {
            let cause = steps.last().map_or_else(String::new, |step| step.cause.clone());
            self.answer.ran = Some((turned, cause));
        }
        self.chances(place, moment, "", plan);
    }

    /// Notes the atoms to which the end of a scope would lead at this moment, and those to which it no longer does.
    fn chances(&mut self, place: RerunPlace, moment: &Moment, cause: &str, plan: &dyn Texts) {
        let leads = |scope: &ScopeMoment| scope.leads_to.map(|atom| (atom, scope.level));
        let open: BTreeMap<u32, u16> = moment.scopes.iter().rev().filter_map(leads).collect();
        for (atom, level) in &open {
            if !self.doors.contains_key(atom) {
                let first = self.stay(place, moment, "", plan);
                self.doors.insert(*atom, Door { level: *level, first, last: None, latest: (place, moment.clone()) });
            }
        }
        let ended = moment.cause.map(|cause| cause.level());
        let mut closed = Vec::new();
        for (atom, door) in self.doors.iter_mut().filter(|(_, door)| door.last.is_none()) {
            match (open.get(atom), ended) {
                // An outer scope ended, and with it that which would have led to the atom.
                (Some(level), Some(ended)) if ended < *level => closed.push((*atom, place, moment.clone())),
                (Some(_), _) => door.latest = (place, moment.clone()),
                (None, _) => closed.push((*atom, door.latest.0, door.latest.1.clone())),
            }
        }
        for (atom, place, moment) in closed {
            let last = self.stay(place, &moment, cause, plan);
            if let Some(door) = self.doors.get_mut(&atom) {
                door.last = Some(last);
            }
        }
    }

    fn stay(&self, place: RerunPlace, moment: &Moment, cause: &str, plan: &dyn Texts) -> Stay {
        let scopes = self.explainer.scopes(moment, &place.facts, plan);
        let atom = self.explainer.atom(plan, moment.atom);
        Stay { turned: place.turned, atom, scopes, cause: cause.to_owned() }
    }

    /// Returns the answer after the last turn.
    fn answer(mut self, machine: &Machine, plan: &dyn Texts) -> Never {
        // The atom itself, or else the innermost enclosing scope that had a chance.
        let candidates = self.wanted.iter().flat_map(|atom| {
            let around = machine.atom(*atom).element().outwards();
            around.map(|element| (element.first().number(), element.name(), *atom))
        });
        let found = candidates.map(|(first, name, atom)| (first, (first != atom).then(|| name.to_owned())));
        let found: Vec<_> = found.collect();
        for (first, begins) in found {
            let Some(door) = self.doors.remove(&first) else { continue };
            let last = match door.last {
                Some(last) => last,
                None => self.stay(door.latest.0, &door.latest.1, "", plan),
            };
            let scope = usize::from(door.level);
            self.answer.chance = Some(Chance { begins, scope, first: door.first, last });
            break;
        }
        self.answer
    }
}
