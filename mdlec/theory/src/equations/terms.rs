//! The terms of `Π(t) = Σ E_i ξ̄_i(t)` of a plan (paper, Eq. 2), and those of an interrupt that is counted once (Eq.
//! 3).
//!
//! They are numbered as in the FSM file: `x1`, `x2`, … in pre-order, and `completed` for laws that are done.

use std::collections::BTreeMap;

use mdle_compiler::diagnostic::Diagnostic;
use mdle_compiler::fsm::{Matrices, matrices};
use mdle_compiler::plan::{Condition, Functions, Nondegenerate, Plan};

/// The terms of a plan with `N` states.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms<'p> {
    /// The plan's name.
    pub source: &'p str,
    /// The quark text of each state's law, without the termination state.
    pub laws: Vec<&'p str>,
    /// Terms whose interrupt can fire, in pre-order, completion last.
    pub live: Vec<Term<'p>>,
    /// Terms whose interrupt never fires: null, or removed because an outer one repeats it.
    pub never: Vec<Term<'p>>,
    /// Set to `true` if equal interrupts are counted once.
    pub combined: bool,
}

/// An interrupt with its transition matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Term<'p> {
    /// Name of the interrupt: `x1`, `x2`, …, or `completed`. An interrupt in several places has the name of the first.
    pub name: String,
    /// Text of the interrupt's condition.
    pub text: &'p str,
    /// `true` if it asks for a time, which counts from the start of its scope.
    pub waits: bool,
    /// The scopes that have it, from left to right: no state is in two of them (Observation 1).
    pub places: Vec<Extent<'p>>,
}

/// A scope that has an interrupt, as columns and the row that they have their one in. They count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent<'p> {
    /// The number of the interrupt in pre-order, from 1: of those that fire at once, the lowest one decides.
    pub number: usize,
    /// The scope's name; empty for an atom.
    pub scope: &'p str,
    /// First column of the range.
    pub first: usize,
    /// Last column of the range.
    pub last: usize,
    /// The row.
    pub row: usize,
}

impl Terms<'_> {
    /// The number of states, the termination state included.
    #[must_use]
    pub fn states(&self) -> usize {
        self.laws.len() + 1
    }

    /// The transition matrix of a term: for each column the row of its one. It is `Σ E_ij − (n−1) I` over the term's
    /// places (Eq. 3): a column that one of them lists is taken from there, for in all others it is that of the
    /// identity.
    #[must_use]
    pub fn matrix(&self, term: &Term<'_>) -> Vec<usize> {
        let mut rows: Vec<_> = (0..self.states()).collect();
        for place in &term.places {
            rows[place.first..=place.last].fill(place.row);
        }
        rows
    }
}

/// The terms of a plan, its finite loops written out; `combined` counts equal interrupts once.
///
/// # Errors
/// Fails with E0501 or E0502 as [`expand`](mdle_compiler::fsm::expand) does.
pub fn terms(plan: &Nondegenerate, combined: bool) -> Result<Terms<'_>, Diagnostic> {
    let made = matrices(plan)?;
    let plan = plan.plan();
    let functions = Functions::new(&plan.quarks);
    let (mut live, mut never) = (Vec::<Term<'_>>::new(), Vec::new());
    let mut first_of = BTreeMap::new();
    for (number, transition) in (1..).zip(&made.transitions) {
        let columns = transition.matrix.columns();
        let (first, last, row) = (*columns.start(), *columns.end(), transition.matrix.row());
        let place = Extent { number, scope: transition.name, first, last, row };
        let condition = &transition.interrupt.condition;
        let (name, text, waits) = (format!("x{number}"), &transition.interrupt.text, condition.waits());
        let term = Term { name, text, waits, places: vec![place] };
        if *condition == Condition::Null {
            never.push(term);
            continue;
        }
        let function = functions.function(condition).filter(|_| combined && !condition.waits());
        let known = function.map(|function| *first_of.entry(function).or_insert(live.len()));
        match known.and_then(|known| live.get_mut(known)) {
            Some(first) => first.places.push(place),
            None => live.push(term),
        }
    }
    live.extend(completion(plan, &made));
    let laws = made.laws.iter().map(|law| plan.quark(*law).text.as_str()).collect();
    Ok(Terms { source: &plan.root.name, laws, live, never, combined })
}

/// The interrupt that laws raise when they are done: it counts as their atoms' own.
fn completion<'p>(plan: &'p Plan, made: &Matrices<'p>) -> Option<Term<'p>> {
    let places = made.completion(plan).map(|(number, matrix)| {
        let (scope, column) = (made.transitions[number].name, *matrix.columns().start());
        Extent { number: number + 1, scope, first: column, last: column, row: matrix.row() }
    });
    let places: Vec<_> = places.collect();
    (!places.is_empty()).then(|| Term { name: "completed".into(), text: "completed", waits: false, places })
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::samples::compiled;

    /// A matrix with all its zeros.
    fn dense(rows: &[usize]) -> DMatrix<i64> {
        DMatrix::from_fn(rows.len(), rows.len(), |row, column| i64::from(rows[column] == row))
    }

    #[test]
    fn an_interrupt_that_is_counted_once_has_the_matrix_of_equation_3() {
        let text = "{ P { Q (bumper OR r0 < 1) (Atom (r1 < 1) stop) (Atom (null) rotate 90) } (Atom (r1 < 1) stop)^2 \
                    (Atom (r0 < 1 OR bumper) turn 90) }";
        let plan = &compiled(text)[0].nondegenerate;
        let (apart, once) = (terms(plan, false).unwrap(), terms(plan, true).unwrap());
        let names = |terms: &Terms<'_>| terms.live.iter().map(|term| term.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&apart), ["x2", "x3", "x5", "x6", "x7", "completed"]);
        assert_eq!(names(&once), ["x2", "x3", "completed"]);
        assert_eq!(apart.never, once.never);
        for term in &once.live {
            let identity = DMatrix::identity(once.states(), once.states());
            let each =
                term.places.iter().map(|place| dense(&once.matrix(&Term { places: vec![*place], ..term.clone() })));
            let sum = each.fold(DMatrix::zeros(once.states(), once.states()), |sum, matrix| sum + matrix);
            let combined = sum - identity * (term.places.len() as i64 - 1);
            assert_eq!(dense(&once.matrix(term)), combined, "{term:?}");
        }
    }

    #[test]
    fn timers_of_other_lengths_and_memories_of_their_own_are_other_interrupts() {
        let text =
            "{ P (Atom (wait 1) stop) (Atom (wait 2) stop) (Atom (RISING bumper) stop) (Atom (RISING bumper) stop) }";
        let plan = &compiled(text)[0].nondegenerate;
        assert_eq!(terms(plan, true).unwrap().live, terms(plan, false).unwrap().live);
    }
}
