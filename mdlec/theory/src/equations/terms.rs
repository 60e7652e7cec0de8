//! The terms of `Π(t) = Σ E_i ξ̄_i(t)` of a plan (paper, Eq. 2), or of the sum in which equal interrupts are combined
//! into one term (Eq. 3).
//!
//! Terms have the same names as in the FSM file: `x1`, `x2`, … in the order in which the scopes of the interrupts
//! begin, and `completed` for the completion of laws.

use std::collections::BTreeMap;

use mdle_compiler::diagnostic::Diagnostic;
use mdle_compiler::fsm::{Matrices, matrices};
use mdle_compiler::plan::{Condition, Functions, Nondegenerate, Plan};

/// Terms of a plan with `N` states.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms<'p> {
    /// Name of the plan.
    pub source: &'p str,
    /// Law of each state except the termination state, as the text of its quark.
    pub laws: Vec<&'p str>,
    /// Terms whose interrupt can fire, in the order of their numbers. The term for the completion of laws is last.
    pub live: Vec<Term<'p>>,
    /// Terms whose interrupt never fires: the interrupt is null, or was removed because it repeats an outer interrupt.
    pub never: Vec<Term<'p>>,
    /// `true` if equal interrupts are combined into one term.
    pub combined: bool,
}

/// An interrupt with its transition matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Term<'p> {
    /// Name of the interrupt: `x1`, `x2`, …, or `completed`. If several scopes have the interrupt, the name is that of
    /// the first occurrence.
    pub name: String,
    /// Text of the interrupt's condition.
    pub text: &'p str,
    /// `true` if the interrupt has a timer, which starts when its scope is entered.
    pub waits: bool,
    /// Scopes that have the interrupt, from left to right. No state is in two of them (Observation 1).
    pub places: Vec<Extent<'p>>,
}

/// A scope that has an interrupt. In the interrupt's matrix, it corresponds to a range of columns that have their 1 in
/// the same row. All indices are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent<'p> {
    /// Number of the interrupt, counted from 1 in the order in which the scopes begin. If several interrupts fire at
    /// the same time, the lowest number takes effect.
    pub number: usize,
    /// Name of the scope; empty for an atom.
    pub scope: &'p str,
    /// First column of the range.
    pub first: usize,
    /// Last column of the range.
    pub last: usize,
    /// Row of the 1 in each of these columns.
    pub row: usize,
}

impl Terms<'_> {
    /// Returns the number of states, including the termination state.
    #[must_use]
    pub fn states(&self) -> usize {
        self.laws.len() + 1
    }

    /// Returns the transition matrix of a term, given, for each column, by the row of its 1. The matrix is `Σ E_ij −
    /// (n−1) I` over the scopes of the term (Eq. 3). A column in the range of a scope equals the column of this scope's
    /// matrix, because the matrices of all other scopes have there a column of the identity.
    #[must_use]
    pub fn matrix(&self, term: &Term<'_>) -> Vec<usize> {
        let mut rows: Vec<_> = (0..self.states()).collect();
        for place in &term.places {
            rows[place.first..=place.last].fill(place.row);
        }
        rows
    }
}

/// Returns the terms of a plan with expanded finite loops; `combined` combines equal interrupts into one term.
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

/// Returns the term of the interrupt that fires when a law completes, which ends the atom in the same way as the atom's
/// own interrupt. Returns `None` if no law of the plan can complete.
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

    /// Returns the matrix, including its zeros, that has a 1 in row `rows[j]` of each column `j`.
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
