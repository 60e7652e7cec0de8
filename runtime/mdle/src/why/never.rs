//! `mdle why --not`: finds the opportunities that an atom or a scope had to begin since it last began, and the reasons
//! why it did not begin.

use std::collections::BTreeMap;
use std::rc::Rc;

use mdle_compiler::fsm::{Element, Exit, Machine};
use mdle_files::Target;
use mdle_host::Texts;
use mdle_runtime::Nanos;

use super::explanation::{AtomWords, Explainer};
use super::operands::OperandFacts;
use super::scopes::{ScopeState, scopes};
use crate::elements_named::elements_named;
use crate::examined::{ExaminedPlan, ExaminedRun, ExaminedStop, ExaminedTurn, PlanMoment};

/// Number and time of a turn.
pub(crate) type Turned = (u64, Nanos);

/// The answer to the question why an atom or a scope did not begin.
#[derive(Debug)]
pub(crate) struct NeverAnswer {
    /// Text with which the question names the atom or the scope.
    pub(crate) asked: String,
    /// Turns in which the element began; `None` if it never began.
    pub(crate) began: Option<Beginnings>,
    /// `true` if the element ran in the last turn.
    pub(crate) runs: bool,
    /// Turns in which the element was entered and left immediately, after the turn in which it last began; `None` if
    /// there are none.
    pub(crate) skipped: Option<Skips>,
    /// Opportunities of the element to begin since it last began; `None` if there were none.
    pub(crate) chance: Option<Chance>,
    /// Laws of the atoms after which the element can begin.
    pub(crate) follows: Vec<String>,
    /// Name of the plan that contains the element; empty unless several plans were active.
    pub(crate) plan: String,
    /// Last turn in which the plan that contains the element was active.
    pub(crate) end: Turned,
    /// `true` if another plan was active at the end of the record.
    pub(crate) is_replaced: bool,
    /// The atom that ran last; `None` if the plan was over.
    pub(crate) last: Option<AtomWords>,
}

/// The turns in which an element began.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Beginnings {
    pub(crate) times: u64,
    /// The first of these turns, with the cause of the transition; the cause is empty for the start of the plan. `last`
    /// is the last of these turns, in the same form.
    pub(crate) first: (Turned, String),
    pub(crate) last: (Turned, String),
}

/// The turns in which an element was entered and left immediately.
#[derive(Debug)]
pub(crate) struct Skips {
    pub(crate) times: u64,
    pub(crate) first: Stay,
    /// Last turn in which the element was entered and left immediately.
    pub(crate) last: Turned,
}

/// A turn with its current atom and the enclosing scopes.
#[derive(Debug)]
pub(crate) struct Stay {
    pub(crate) turned: Turned,
    pub(crate) atom: AtomWords,
    pub(crate) scopes: Vec<ScopeState>,
    /// Cause of the transition; empty if there was no transition.
    pub(crate) cause: String,
}

/// The turns in which the end of a scope would have led to one of the atoms about which the question asks.
#[derive(Debug)]
pub(crate) struct Chance {
    /// Name of the scope that would have begun; `None` unless this scope encloses the element about which the question
    /// asks.
    pub(crate) begins: Option<String>,
    /// Number of periods of consecutive turns with such an opportunity. In a loop, there is one period for each pass.
    pub(crate) times: u64,
    /// Indices, in the list of scopes, of the scopes whose end would have led to the atom. In the first turn with such
    /// an opportunity, one of these scopes would have had to end.
    pub(crate) scopes: Vec<usize>,
    /// First turn with such an opportunity.
    pub(crate) first: Stay,
    /// Last turn with such an opportunity, and the scope that ended instead, if there was one.
    pub(crate) last: Stay,
}

/// The opportunities of an atom to begin, collected while the record is read.
struct Door {
    times: u64,
    scopes: Vec<usize>,
    first: Stay,
    /// Level of the outermost scope whose end would lead to the atom.
    level: u16,
    /// Last turn of the latest period of consecutive turns in which the atom could have begun; `None` while this
    /// period continues.
    last: Option<Stay>,
    /// The last turn in which there was an opportunity, and its moment.
    latest: (FactsOfTurn, PlanMoment),
}

/// A turn, and the facts that operands read in it.
#[derive(Clone, Copy)]
struct FactsOfTurn {
    turned: Turned,
    facts: OperandFacts,
}

/// Answers the question why the atom or the scope that `text` names did not begin. The answer is about the last plan of
/// the record that contains this element.
///
/// # Errors
/// Fails with a message if no plan of the record contains such an atom or scope.
pub(crate) fn never(
    target: &Target,
    text: &str,
    run: &mut ExaminedRun,
) -> Result<Result<NeverAnswer, ExaminedStop>, String> {
    let mut searches: BTreeMap<u64, Option<PlanSearch>> = BTreeMap::new();
    let (mut explainer, mut unknown, mut number) = (Explainer::default(), Vec::new(), 0);
    while let Some(turn) = run.turn() {
        let turn = match turn {
            Ok(turn) => turn,
            Err(stop) => return Ok(Err(stop)),
        };
        explainer.begin(&turn);
        number = turn.recorded.plan;
        let Some(plan) = run.plan() else { continue };
        let search = searches.entry(number).or_insert_with(|| {
            let wanted = wanted(&plan.machine, target, text, &*plan.texts);
            let wanted = wanted.map_err(|why| unknown.push((plan.texts.name(0).to_owned(), why)));
            wanted.ok().map(|wanted| PlanSearch::new(Rc::clone(plan), wanted, text))
        });
        match search {
            Some(search) => search.turn(&turn, &mut explainer),
            None => explainer.pass(&turn, &*plan.texts),
        }
    }
    let has_several = searches.len() > 1;
    let found = searches.into_iter().rev().find_map(|(own, search)| Some((own, search?)));
    let Some((own, search)) = found else {
        return Err(no_atom(text, unknown));
    };
    let plan = if has_several { search.plan.texts.name(0).to_owned() } else { String::new() };
    explainer.resume(own);
    let answer = search.answer(&mut explainer);
    Ok(Ok(NeverAnswer { plan, is_replaced: own != number, ..answer }))
}

/// Returns the message that no plan of the record has such an atom. `plans` contains the message and the help text for
/// each plan.
fn no_atom(text: &str, plans: Vec<(String, (String, String))>) -> String {
    match plans.as_slice() {
        [] => "the record has no turn of a plan".to_owned(),
        [(_, (sentence, help))] => format!("{sentence}\nhelp: {help}"),
        plans => {
            let helps: Vec<_> = plans.iter().map(|(name, (_, help))| format!("\nhelp: in `{name}`, {help}")).collect();
            format!("no plan of the record has an atom `{text}`{}", helps.concat())
        }
    }
}

impl NeverAnswer {
    /// Returns the answer in its state before the first turn.
    fn of(text: &str) -> Self {
        Self {
            asked: text.to_owned(),
            began: None,
            runs: false,
            skipped: None,
            chance: None,
            follows: Vec::new(),
            plan: String::new(),
            end: (0, Nanos::ZERO),
            is_replaced: false,
            last: None,
        }
    }
}

/// Returns the elements that a text names. They are the atoms of a line, or the elements that tests of plans would name
/// with this text.
///
/// # Errors
/// Fails with a message and a help text if there are no such elements.
fn wanted(machine: &Machine, target: &Target, text: &str, plan: &dyn Texts) -> Result<Vec<u32>, (String, String)> {
    let is_line = |element: &Element<'_>| {
        let at = plan.source().bracket(element.number()).map(|words| words.at);
        at.is_some_and(|at| text == at.line.to_string() || text == format!("{}:{}", plan.source().file(at), at.line))
    };
    let atoms = machine.elements().filter(|element| element.atom().is_some());
    let on_line: Vec<_> = atoms.filter(is_line).map(Element::number).collect();
    if !on_line.is_empty() {
        return Ok(on_line);
    }
    elements_named(machine, target, text)
}

/// The search for elements in one of the plans of a record.
struct PlanSearch {
    plan: Rc<ExaminedPlan>,
    /// Numbers of the elements about which the question is asked.
    wanted: Vec<u32>,
    /// Time at which each element in question last began.
    entries: BTreeMap<u32, Nanos>,
    /// Time at which each element in question was last skipped.
    skips: BTreeMap<u32, Nanos>,
    /// Opportunities of each atom since an element in question last began.
    doors: BTreeMap<u32, Door>,
    answer: NeverAnswer,
}

impl PlanSearch {
    fn new(plan: Rc<ExaminedPlan>, wanted: Vec<u32>, text: &str) -> Self {
        let (entries, skips, doors) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        Self { plan, wanted, entries, skips, doors, answer: NeverAnswer::of(text) }
    }

    fn turn(&mut self, turn: &ExaminedTurn, explainer: &mut Explainer) {
        let plan = Rc::clone(&self.plan);
        let plan = &*plan.texts;
        let turned = (turn.recorded.number, turn.recorded.t);
        let steps = Explainer::each(turn, plan);
        for (number, step) in steps.iter().enumerate() {
            let Some(moment) = turn.moments.get(number) else { continue };
            let place = FactsOfTurn { turned, facts: Explainer::facts(turn, moment) };
            self.chances(place, moment, &step.cause, explainer);
            self.skip(place, moment, &step.cause, explainer);
            explainer.step(&step.transition, plan);
        }
        self.answer.end = turned;
        (self.answer.last, self.answer.runs) = (None, false);
        let Some(moment) = turn.moments.get(steps.len()) else { return };
        self.answer.last = Some(explainer.atom(plan, moment.atom));
        let began = explainer.began();
        self.begin(turned, moment, steps.last().map_or(&*began, |step| &step.cause));
        let place = FactsOfTurn { turned, facts: Explainer::facts(turn, moment) };
        self.chances(place, moment, "", explainer);
    }

    /// Records that one of the elements in question was entered, and was left in the same turn.
    fn skip(&mut self, place: FactsOfTurn, moment: &PlanMoment, cause: &str, explainer: &mut Explainer) {
        let is_new =
            |bracket: &u32| moment.scopes.iter().any(|scope| scope.bracket == *bracket && scope.since == Nanos::ZERO);
        let Some(bracket) = self.wanted.iter().copied().find(is_new) else { return };
        let t = place.turned.1;
        // The first moment of the turn has the reason.
        if self.skips.insert(bracket, t) == Some(t) {
            return;
        }
        match &mut self.answer.skipped {
            Some(skips) => (skips.times, skips.last) = (skips.times + 1, place.turned),
            None => {
                let first = self.stay(place, moment, cause, explainer);
                self.answer.skipped = Some(Skips { times: 1, first, last: place.turned });
            }
        }
    }

    /// Records that an element in question runs or begins. Earlier skips and opportunities are then irrelevant.
    fn begin(&mut self, turned: Turned, moment: &PlanMoment, cause: &str) {
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

    /// Records the atoms to which the end of a scope would lead at this moment. Also records the atoms to which it
    /// would no longer lead.
    fn chances(&mut self, place: FactsOfTurn, moment: &PlanMoment, cause: &str, explainer: &mut Explainer) {
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
                    let first = self.stay(place, moment, "", explainer);
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
            let last = self.stay(place, moment, cause, explainer);
            if let Some(door) = self.doors.get_mut(&atom) {
                door.last = Some(last);
            }
        }
    }

    fn stay(&self, place: FactsOfTurn, moment: &PlanMoment, cause: &str, explainer: &mut Explainer) -> Stay {
        let scopes = scopes(&self.plan, moment, &place.facts);
        let atom = explainer.atom(&*self.plan.texts, moment.atom);
        Stay { turned: place.turned, atom, scopes, cause: cause.to_owned() }
    }

    /// Returns the answer after the last turn.
    fn answer(mut self, explainer: &mut Explainer) -> NeverAnswer {
        let machine = Rc::clone(&self.plan);
        let machine = &machine.machine;
        let before = self.wanted.iter().flat_map(|wanted| before(machine.element(*wanted)));
        let mut follows: Vec<_> = before.map(|atom| machine.atom(atom).law().text.clone()).collect();
        follows.dedup();
        self.answer.follows = follows;
        // Takes the element in question, or else the innermost enclosing scope that had a chance.
        let candidates = self.wanted.iter().flat_map(|wanted| {
            let element = machine.element(*wanted);
            let own = element.first().number();
            let around = element.outwards().map(|element| (element.first().number(), element.name()));
            around.map(move |(first, name)| (first, (first != own).then(|| name.to_owned())))
        });
        let candidates: Vec<_> = candidates.collect();
        let found = candidates.into_iter().find_map(|(first, begins)| Some((self.doors.remove(&first)?, begins)));
        if let Some((door, begins)) = found {
            let Door { times, scopes, first, last, latest: (place, moment), .. } = door;
            let last = last.unwrap_or_else(|| self.stay(place, &moment, "", explainer));
            self.answer.chance = Some(Chance { begins, times, scopes, first, last });
        }
        self.answer
    }
}

/// Returns the atoms after which an element can begin. These are the last atom of the previous element, and the last
/// atom of each loop whose first element this is.
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
