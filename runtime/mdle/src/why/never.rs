//! `mdle why --not`: the chances of an atom or a scope to begin since it last began, and what kept it from that.

use std::collections::BTreeMap;

use mdle_compiler::fsm::{Element, Exit, Machine};
use mdle_files::Target;
use mdle_host::Texts;
use mdle_runtime::Nanos;

use super::explanation::{AtomWords, Explainer, Scope};
use super::operands::Facts;
use crate::elements_named::elements_named;
use crate::rerun::Moment;
use crate::rerun::{Rerun, RerunTurn, Stop};

/// A turn: its number and its time.
pub(crate) type Turned = (u64, Nanos);

/// The answer why an atom or a scope did not begin.
#[derive(Debug)]
pub(crate) struct Never {
    /// The atom or the scope as it was asked for.
    pub(crate) asked: String,
    /// The turns in which it began; `None` if it never did.
    pub(crate) began: Option<Beginnings>,
    /// `true` if it ran in the last turn.
    pub(crate) runs: bool,
    /// The turns since it last began in which it was entered and left again.
    pub(crate) skipped: Option<Skips>,
    /// The chances since then to begin; `None` if there was none.
    pub(crate) chance: Option<Chance>,
    /// The laws of the atoms that it could have followed.
    pub(crate) follows: Vec<String>,
    /// The end of the record.
    pub(crate) end: Turned,
    /// The atom that ran last; `None` if the plan was over.
    pub(crate) last: Option<AtomWords>,
}

/// The turns in which something began.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Beginnings {
    pub(crate) times: u64,
    /// The first and the last of these turns, each with the cause of the transition; empty for the start of the plan.
    pub(crate) first: (Turned, String),
    pub(crate) last: (Turned, String),
}

/// The turns in which something was entered and left again.
#[derive(Debug)]
pub(crate) struct Skips {
    pub(crate) times: u64,
    pub(crate) first: Stay,
    /// The last of these turns.
    pub(crate) last: Turned,
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
    /// Name of the scope that would have begun, if it encloses what was asked for.
    pub(crate) begins: Option<String>,
    /// Number of periods of such turns, as many as passes in a loop.
    pub(crate) times: u64,
    /// The scopes of which one had to end in the first turn, by their numbers among those that are listed.
    pub(crate) scopes: Vec<usize>,
    /// The first of these turns.
    pub(crate) first: Stay,
    /// The last of these turns, and what ended instead if anything did.
    pub(crate) last: Stay,
}

/// The chances of an atom while the record is read.
struct Door {
    times: u64,
    scopes: Vec<usize>,
    first: Stay,
    /// The outermost scope of which the end would lead to the atom.
    level: u16,
    /// The last turn of a period that is over.
    last: Option<Stay>,
    /// The last turn in which it was open, and its moment.
    latest: (RerunPlace, Moment),
}

/// A turn with the ages of its sonars.
#[derive(Clone, Copy)]
struct RerunPlace {
    turned: Turned,
    facts: Facts,
}

/// Answers why the atom or the scope of this text did not begin.
///
/// # Errors
/// The plan has no such atom: a sentence.
pub(crate) fn never(
    machine: &Machine,
    target: &Target,
    text: &str,
    rerun: &mut dyn Rerun,
) -> Result<Result<Never, Stop>, String> {
    let wanted = wanted(machine, target, text, rerun.texts())?;
    let mut search = Search {
        machine,
        explainer: Explainer::new(machine),
        wanted,
        entries: BTreeMap::new(),
        skips: BTreeMap::new(),
        doors: BTreeMap::new(),
        answer: Never {
            asked: text.to_owned(),
            began: None,
            runs: false,
            skipped: None,
            chance: None,
            follows: Vec::new(),
            end: (0, Nanos::ZERO),
            last: None,
        },
    };
    while let Some(turn) = rerun.turn(&mut |_, _| true) {
        match turn {
            Ok(turn) => search.turn(&turn, rerun.texts()),
            Err(stop) => return Ok(Err(stop)),
        }
    }
    Ok(Ok(search.answer(rerun.texts())))
}

/// Returns the elements that are meant: the atoms of a line, or what tests of plans name by this text.
fn wanted(machine: &Machine, target: &Target, text: &str, plan: &dyn Texts) -> Result<Vec<u32>, String> {
    let is_line = |element: &Element<'_>| {
        let at = plan.source().bracket(element.number()).map(|words| words.at);
        at.is_some_and(|at| text == at.line.to_string() || text == format!("{}:{}", plan.source().file(at), at.line))
    };
    let atoms = machine.elements().filter(|element| element.atom().is_some());
    let on_line: Vec<_> = atoms.filter(is_line).map(Element::number).collect();
    if !on_line.is_empty() {
        return Ok(on_line);
    }
    elements_named(machine, target, text).map_err(|(sentence, help)| format!("{sentence}\nhelp: {help}"))
}

struct Search<'m> {
    machine: &'m Machine,
    explainer: Explainer<'m>,
    /// The elements that are asked for.
    wanted: Vec<u32>,
    /// The time at which each of them was entered that began last.
    entries: BTreeMap<u32, Nanos>,
    /// The time at which each of them was entered that was skipped last.
    skips: BTreeMap<u32, Nanos>,
    /// The chances of each atom since what is asked for last began.
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
            self.skip(place, moment, &step.cause, plan);
            self.explainer.step(&step.transition, plan);
        }
        self.answer.end = turned;
        (self.answer.last, self.answer.runs) = (None, false);
        let Some(moment) = turn.moments.get(steps.len()) else { return };
        self.answer.last = Some(self.explainer.atom(plan, moment.atom));
        self.begin(turned, moment, steps.last().map_or("", |step| &step.cause));
        let place = RerunPlace { turned, facts: Explainer::facts(turn, moment) };
        self.chances(place, moment, "", plan);
    }

    /// Notes that what is asked for was entered, and left in the same turn.
    fn skip(&mut self, place: RerunPlace, moment: &Moment, cause: &str, plan: &dyn Texts) {
        let is_new =
            |bracket: &u32| moment.scopes.iter().any(|scope| scope.bracket == *bracket && scope.since == Nanos::ZERO);
        let Some(bracket) = self.wanted.iter().copied().find(is_new) else { return };
        let t = place.turned.1;
        // The first moment of a stay has the reason.
        if self.skips.insert(bracket, t) == Some(t) {
            return;
        }
        match &mut self.answer.skipped {
            Some(skips) => (skips.times, skips.last) = (skips.times + 1, place.turned),
            None => {
                let first = self.stay(place, moment, cause, plan);
                self.answer.skipped = Some(Skips { times: 1, first, last: place.turned });
            }
        }
    }

    /// Notes that what is asked for runs, or begins: then earlier skips and chances are no longer of interest.
    fn begin(&mut self, turned: Turned, moment: &Moment, cause: &str) {
        let mut begins = false;
        for scope in moment.scopes.iter().filter(|scope| self.wanted.contains(&scope.bracket)) {
            self.answer.runs = true;
            let entered = Nanos(turned.1.0.saturating_sub(scope.since.0));
            begins |= self.entries.insert(scope.bracket, entered) != Some(entered);
        }
        if !begins {
            return;
        }
        let now = (turned, cause.to_owned());
        match &mut self.answer.began {
            Some(began) => (began.times, began.last) = (began.times + 1, now),
            None => self.answer.began = Some(Beginnings { times: 1, first: now.clone(), last: now }),
        }
        self.answer.skipped = None;
        self.doors.clear();
    }

    /// Notes the atoms to which the end of a scope would lead at this moment, and those to which it no longer does.
    fn chances(&mut self, place: RerunPlace, moment: &Moment, cause: &str, plan: &dyn Texts) {
        let mut open: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (number, scope) in moment.scopes.iter().enumerate() {
            if let Some(atom) = scope.leads_to {
                open.entry(atom).or_default().push(number);
            }
        }
        for (atom, scopes) in &open {
            let level = scopes.first().and_then(|number| moment.scopes.get(*number)).map_or(0, |scope| scope.level);
            match self.doors.get_mut(atom) {
                Some(door) => {
                    door.times += u64::from(door.last.take().is_some());
                    (door.level, door.latest) = (level, (place, moment.clone()));
                }
                None => {
                    let first = self.stay(place, moment, "", plan);
                    let latest = (place, moment.clone());
                    let door = Door { times: 1, scopes: scopes.clone(), first, level, last: None, latest };
                    self.doors.insert(*atom, door);
                }
            }
        }
        let Some(ended) = moment.cause.map(|cause| cause.level()) else { return };
        let taken = moment.scopes.iter().find(|scope| scope.level == ended).and_then(|scope| scope.leads_to);
        if let Some(taken) = taken {
            self.doors.remove(&taken);
        }
        let closed = self.doors.iter().filter(|(_, door)| door.last.is_none() && ended < door.level);
        let closed: Vec<_> = closed.map(|(atom, _)| *atom).collect();
        for atom in closed {
            let last = self.stay(place, moment, cause, plan);
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
    fn answer(mut self, plan: &dyn Texts) -> Never {
        let before = self.wanted.iter().flat_map(|wanted| before(self.machine.element(*wanted)));
        let mut follows: Vec<_> = before.map(|atom| self.machine.atom(atom).law().text.clone()).collect();
        follows.dedup();
        self.answer.follows = follows;
        // What was asked for, or else the innermost enclosing scope that had a chance.
        let candidates = self.wanted.iter().flat_map(|wanted| {
            let element = self.machine.element(*wanted);
            let own = element.first().number();
            let around = element.outwards().map(|element| (element.first().number(), element.name()));
            around.map(move |(first, name)| (first, (first != own).then(|| name.to_owned())))
        });
        let candidates: Vec<_> = candidates.collect();
        let found = candidates.into_iter().find_map(|(first, begins)| Some((self.doors.remove(&first)?, begins)));
        if let Some((door, begins)) = found {
            let Door { times, scopes, first, last, latest: (place, moment), .. } = door;
            let last = last.unwrap_or_else(|| self.stay(place, &moment, "", plan));
            self.answer.chance = Some(Chance { begins, times, scopes, first, last });
        }
        self.answer
    }
}

/// Returns the last atoms of the elements that an element can follow: of the one before it, and of a loop of which it
/// is the first.
fn before(element: Element<'_>) -> Vec<u32> {
    let mut before = Vec::new();
    for inner in element.outwards() {
        if inner.first().number() != element.first().number() {
            break;
        }
        let Some(parent) = inner.parent() else { break };
        let is_before =
            |other: &Element<'_>| matches!(other.exit(), Exit::Next(next) if next.number() == inner.number());
        before.extend(parent.children().find(is_before).map(|other| other.last().number()));
        if parent.counter().is_some() && parent.first().number() == inner.first().number() {
            before.push(parent.last().number());
        }
    }
    before
}
