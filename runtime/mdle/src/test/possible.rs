//! Determines, from the text of a plan alone, the transitions that the plan can make. An expectation that no run can
//! meet is therefore refused before any run.

use std::collections::BTreeSet;

use mdle_compiler::fsm::{Atom, Element, ElementKind, Exit, Machine};
use mdle_compiler::plan::Condition;
use mdle_runtime::trace::COMPLETED;

use super::causes::NamedCause;
use super::expected::{AtomsNamed, ByteRange, Expected, ExpectedTransition};
use super::file::TestFileError;
use super::subject::Subject;

/// Checks that the plan can meet the expectations: make the transitions, and begin the atoms in their order.
///
/// # Errors
/// Fails with a message and a place if it cannot meet them.
pub(super) fn possible(expected: &Expected, subject: &Subject) -> Result<(), TestFileError> {
    let Expected { atoms, order, transitions, .. } = expected;
    [atoms, order].into_iter().flatten().try_for_each(|(_, atoms)| in_order(atoms, subject))?;
    transitions.iter().try_for_each(|(place, wanted)| can_be_made(wanted, place.clone(), subject))
}

/// Checks that each of the atoms can begin at some time after the previous one.
fn in_order(atoms: &[AtomsNamed], subject: &Subject) -> Result<(), TestFileError> {
    let possible = PossibleTransitions::new(subject.machine());
    let mut before: Option<&AtomsNamed> = None;
    for named in atoms {
        if let Some(before) =
            before.filter(|before| !possible.leads(|atom| before.holds(atom), |atom| named.holds(atom)))
        {
            let message = format!("`{}` never begins after `{}`", named.text, before.text);
            let follows = laws(subject, &possible.entered(|atom| before.holds(atom), None));
            let help = format!("`{}` is followed by {follows}", before.text);
            return Err(TestFileError::at(named.place.clone(), message).help(help));
        }
        before = Some(named);
    }
    Ok(())
}

/// Checks that the plan can make a transition.
fn can_be_made(wanted: &ExpectedTransition, place: ByteRange, subject: &Subject) -> Result<(), TestFileError> {
    let possible = PossibleTransitions::new(subject.machine());
    let is_from = |atom| wanted.from.as_ref().is_none_or(|from| from.holds(atom));
    let entered = possible.entered(is_from, wanted.by.as_ref().map(|(_, cause)| cause));
    let is_met = match &wanted.to {
        None => !entered.is_empty(),
        Some(None) => entered.contains(&None),
        Some(Some(to)) => entered.iter().flatten().any(|atom| to.holds(*atom)),
    };
    if is_met {
        return Ok(());
    }
    let words = ExpectedTransition { after: None, within: None, ..wanted.clone() }.words();
    let help = if entered.is_empty() {
        let known = possible.ending(is_from).into_iter().flat_map(|element| {
            let operands = subject.operands().filter(move |(scope, ..)| *scope == element.number());
            let operands = operands.map(|(.., operand)| operand.written.to_owned()).filter(|operand| operand != "null");
            operands.chain(element.completes().then(|| COMPLETED.to_owned()))
        });
        let from = wanted.from.as_ref().map_or("an atom".to_owned(), |from| format!("`{}`", from.text));
        format!("{from} is ended by {}", listed(known))
    } else {
        format!("such a transition leads to {}", laws(subject, &entered))
    };
    Err(TestFileError::at(place, format!("the plan cannot make {words}")).help(help))
}

/// Returns a list of the laws of `atoms` as part of a sentence; a `None` among the atoms means the end of the plan.
fn laws(subject: &Subject, atoms: &BTreeSet<Option<u32>>) -> String {
    let laws = listed(atoms.iter().flatten().map(|atom| subject.machine().atom(*atom).law().text.clone()));
    match (atoms.contains(&None), laws.is_empty()) {
        (true, true) => "the end of the plan".to_owned(),
        (true, false) => format!("{laws} and the end of the plan"),
        (false, true) => "nothing".to_owned(),
        (false, false) => laws,
    }
}

/// Returns a list of texts in quotes; each text is listed once.
fn listed(texts: impl Iterator<Item = String>) -> String {
    let mut known: Vec<String> = Vec::new();
    for text in texts.map(|text| format!("`{text}`")) {
        if !known.contains(&text) {
            known.push(text);
        }
    }
    known.join(", ")
}

/// The transitions that a plan can make between its atoms.
struct PossibleTransitions<'m> {
    machine: &'m Machine,
}

impl<'m> PossibleTransitions<'m> {
    fn new(machine: &'m Machine) -> Self {
        Self { machine }
    }

    /// Returns the atoms that can be entered by one transition with this cause from an atom for which `is_from`
    /// is true; `None` is the end of the plan.
    fn entered(&self, is_from: impl Fn(u32) -> bool, cause: Option<&NamedCause>) -> BTreeSet<Option<u32>> {
        let mut entered = BTreeSet::new();
        for atom in self.machine.atoms().filter(|atom| is_from(atom.number())) {
            for element in ending(atom).filter(|element| cause.is_none_or(|cause| is_by(*element, cause))) {
                follow(element, &mut entered);
            }
        }
        entered
    }

    /// Returns all elements that can end an atom accepted by `is_from`: the atom itself and enclosing elements.
    fn ending(&self, is_from: impl Fn(u32) -> bool) -> Vec<Element<'m>> {
        let atoms = self.machine.atoms().filter(|atom| is_from(atom.number()));
        let ending: BTreeSet<u32> = atoms.flat_map(|atom| ending(atom).map(Element::number)).collect();
        ending.into_iter().map(|number| self.machine.element(number)).collect()
    }

    /// Returns `true` if an atom for which `is_to` is true can begin at some time after an atom for which
    /// `is_from` is true.
    fn leads(&self, is_from: impl Fn(u32) -> bool, is_to: impl Fn(u32) -> bool) -> bool {
        let mut reached = vec![false; self.machine.atoms().len()];
        let mut next: Vec<u32> = self.entered(is_from, None).into_iter().flatten().collect();
        let mut entered = BTreeSet::new();
        while let Some(atom) = next.pop() {
            if is_to(atom) {
                return true;
            }
            let Some(is_known) = reached.get_mut(atom as usize) else { continue };
            if !std::mem::replace(is_known, true) {
                entered.clear();
                ending(self.machine.atom(atom)).for_each(|element| follow(element, &mut entered));
                next.extend(entered.iter().flatten());
            }
        }
        false
    }
}

/// Collects the atoms that can be entered when an element ends.
fn follow(element: Element<'_>, entered: &mut BTreeSet<Option<u32>>) {
    let mut element = element;
    loop {
        match element.exit() {
            Exit::Over => {
                entered.insert(None);
                return;
            }
            Exit::Next(next) => {
                entered.insert(Some(next.first().number()));
                return;
            }
            Exit::Last(parent) => {
                if let ElementKind::Loop { times } = parent.kind() {
                    entered.insert(Some(parent.first().number()));
                    if times.is_none() {
                        return;
                    }
                }
                element = parent;
            }
        }
    }
}

/// Returns the elements that can end an atom: the atom itself, and the enclosing scopes that have an interrupt.
fn ending(atom: Atom<'_>) -> impl Iterator<Item = Element<'_>> {
    atom.element().outwards().filter(|element| element.completes() || has_interrupt(*element))
}

fn has_interrupt(element: Element<'_>) -> bool {
    element.interrupt().is_some_and(|interrupt| !interrupt.removed && interrupt.condition != Condition::Null)
}

fn is_by(element: Element<'_>, cause: &NamedCause) -> bool {
    match cause {
        NamedCause::Completed => element.completes(),
        NamedCause::Operands(operands) => {
            has_interrupt(element) && operands.iter().any(|(scope, _)| *scope == element.number())
        }
        NamedCause::Scopes(scopes) => has_interrupt(element) && scopes.contains(&element.number()),
    }
}
