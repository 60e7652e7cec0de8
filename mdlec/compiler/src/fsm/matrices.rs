//! Computes the transition matrices of a plan whose finite loops are written out (paper, Eqs. 2 to 4;
//! docs/src/reference/semantics.md, 8.3).
//!
//! Every column of a matrix is a standard basis vector (Observation 1). Interrupts are in pre-order: among the
//! interrupts that list the same column, the outermost has the lowest number.

use std::ops::{Mul, RangeInclusive};

use super::expanded_states;
use crate::diagnostic::Diagnostic;
use crate::plan::{Atom, Interrupt, Mark, Node, Nondegenerate, Plan, QuarkId, Record, Scope};

/// The transition matrices of a plan with `N` states.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrices<'p> {
    /// Law of each state except the last state, which is the termination state.
    pub laws: Vec<QuarkId>,
    /// Angle, in radians, by which the frame of each law is turned.
    pub frames: Vec<f64>,
    /// Interrupts in pre-order, including the interrupts of atoms.
    pub transitions: Vec<Transition<'p>>,
}

impl<'p> Matrices<'p> {
    /// Returns, in order, an entry for each atom whose law may complete: the index of the atom's own interrupt in
    /// [`transitions`](Self::transitions), and the matrix of the transition that the completion causes.
    pub fn completion(&self, plan: &Plan) -> impl Iterator<Item = (usize, Matrix)> {
        let mut own = vec![None; self.laws.len()];
        // The interrupts of enclosing scopes come first, so the atom's own interrupt is the last that lists its column.
        for (number, Transition { matrix, .. }) in self.transitions.iter().enumerate() {
            if matrix.first == matrix.last {
                own[matrix.first] = Some((number, *matrix));
            }
        }
        let completes: Vec<_> = self.laws.iter().map(|law| plan.quark(*law).completes).collect();
        own.into_iter().zip(completes).filter_map(|(own, completes)| own.filter(|_| completes))
    }
}

/// An interrupt and its transition matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Transition<'p> {
    /// Interrupt that causes the transition.
    pub interrupt: &'p Interrupt,
    /// Name of the interrupt's scope; empty for an atom.
    pub name: &'p str,
    /// Number of scopes that enclose the interrupt's scope.
    pub level: usize,
    /// `true` if the scope has `FRAME here`.
    pub here: bool,
    /// Transition matrix of the interrupt.
    pub matrix: Matrix,
    /// Index, in pre-order, of the first interrupt whose scope restarts when this interrupt has fired. The scopes of
    /// later interrupts that list the new state restart too. This index is computed from the plan, because matrices do
    /// not express restarts.
    pub afresh: usize,
    /// Record that is kept with the interrupt's scope; `None` if the scope has no record.
    pub record: Option<Record>,
    /// Labels of the interrupt's scope.
    pub marks: &'p [Mark],
    /// Labels of the elements whose last element was the interrupt's scope. These elements end together with the scope.
    pub ends_with: Vec<&'p Mark>,
}

/// A transition matrix of size `N` by `N`. It equals the identity matrix, except for some neighboring columns that have
/// their 1 in the same row. Columns and rows are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Matrix {
    first: usize,
    last: usize,
    row: usize,
}

/// A standard basis vector, which represents the state of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitVector {
    /// Row of the 1 in the vector, counted from 0.
    pub row: usize,
}

impl Matrix {
    /// Returns the columns that the interrupt lists: the columns of the states in its scope.
    pub fn columns(&self) -> RangeInclusive<usize> {
        self.first..=self.last
    }

    /// Returns the row that contains the 1 of the listed columns.
    #[must_use]
    pub fn row(&self) -> usize {
        self.row
    }
}

impl Mul<UnitVector> for &Matrix {
    type Output = UnitVector;

    fn mul(self, vector: UnitVector) -> UnitVector {
        if (self.first..=self.last).contains(&vector.row) { UnitVector { row: self.row } } else { vector }
    }
}

/// Returns the transition matrices of a plan.
///
/// # Errors
/// Fails with E0501 or E0502 as [`expand`](super::expand) does.
pub fn matrices(plan: &Nondegenerate) -> Result<Matrices<'_>, Diagnostic> {
    expanded_states(plan)?;
    let mut brackets = Brackets { all: Vec::new(), laws: Vec::new(), frames: Vec::new(), interrupts: 0 };
    brackets.scope(&plan.plan().root, BracketPlace { around: None, level: 0 });
    let transitions = brackets.all.iter().filter_map(|bracket| {
        let BracketKind::Scope { interrupt, name, level, here, record } = bracket.kind else { return None };
        let MatrixDestination { row, afresh, ends_with } = brackets.destination(bracket);
        let matrix = Matrix { first: bracket.first, last: bracket.last, row };
        Some(Transition { interrupt, name, level, here, matrix, afresh, record, marks: bracket.marks, ends_with })
    });
    Ok(Matrices { transitions: transitions.collect(), laws: brackets.laws, frames: brackets.frames })
}

/// The scopes and the loops, in pre-order.
struct Brackets<'p> {
    all: Vec<MatrixBracket<'p>>,
    laws: Vec<QuarkId>,
    frames: Vec<f64>,
    /// Number of interrupts that have been added so far.
    interrupts: usize,
}

/// A scope or a loop.
struct MatrixBracket<'p> {
    kind: BracketKind<'p>,
    around: Option<usize>,
    /// Labels of the elements that end together with the bracket.
    marks: &'p [Mark],
    /// Index of the first state in the bracket, counted from 0.
    first: usize,
    /// Index of the last state in the bracket, counted from 0.
    last: usize,
    /// Index of the bracket's first interrupt.
    begins: usize,
    /// Index of the first interrupt after the bracket's last interrupt.
    ends: usize,
}

#[derive(Clone, Copy)]
enum BracketKind<'p> {
    Scope {
        interrupt: &'p Interrupt,
        name: &'p str,
        level: usize,
        here: bool,
        record: Option<Record>,
    },
    /// A finite loop, all passes of which are written out one after the other.
    WrittenOut,
    WithoutEnd,
}

/// Position of a bracket: the enclosing bracket, and the number of enclosing scopes.
#[derive(Clone, Copy)]
struct BracketPlace {
    around: Option<usize>,
    level: usize,
}

/// State to which an interrupt leads, and the consequences of entering it.
struct MatrixDestination<'p> {
    row: usize,
    /// Index of the first interrupt whose scope restarts at the destination.
    afresh: usize,
    /// Labels of the elements that end because their last element has ended.
    ends_with: Vec<&'p Mark>,
}

impl<'p> Brackets<'p> {
    fn scope(&mut self, scope: &'p Scope, place: BracketPlace) {
        let (interrupt, name) = (&scope.interrupt, scope.name.as_str());
        let kind = BracketKind::Scope { interrupt, name, level: place.level, here: scope.here, record: scope.record };
        let here = self.open(kind, place, &scope.marks);
        self.sequence(&scope.body, BracketPlace { around: Some(here), level: place.level + 1 });
        self.close(here);
    }

    fn sequence(&mut self, body: &'p [Node], place: BracketPlace) {
        for node in body {
            match node {
                Node::Atom(atom) => self.atom(atom, place),
                Node::Scope(scope) => self.scope(scope, place),
                Node::Loop(repeated) => {
                    let kind = if repeated.times.is_some() { BracketKind::WrittenOut } else { BracketKind::WithoutEnd };
                    let here = self.open(kind, place, &repeated.marks);
                    for _ in 0..repeated.times.unwrap_or(1) {
                        self.sequence(&repeated.body, BracketPlace { around: Some(here), ..place });
                    }
                    self.close(here);
                }
            }
        }
    }

    fn atom(&mut self, atom: &'p Atom, place: BracketPlace) {
        let (interrupt, level, here) = (&atom.interrupt, place.level, atom.here);
        let kind = BracketKind::Scope { interrupt, name: "", level, here, record: None };
        let here = self.open(kind, place, &atom.marks);
        self.laws.push(atom.law);
        self.frames.push(atom.frame);
        self.close(here);
    }

    fn open(&mut self, kind: BracketKind<'p>, place: BracketPlace, marks: &'p [Mark]) -> usize {
        let (first, begins) = (self.laws.len(), self.interrupts);
        self.interrupts += usize::from(matches!(kind, BracketKind::Scope { .. }));
        self.all.push(MatrixBracket { kind, around: place.around, marks, first, last: first, begins, ends: begins });
        self.all.len() - 1
    }

    fn close(&mut self, bracket: usize) {
        let bracket = &mut self.all[bracket];
        (bracket.last, bracket.ends) = (self.laws.len() - 1, self.interrupts);
    }

    /// Returns the destination of a scope's interrupt. If an enclosing loop without end has the same last state as the
    /// scope, the destination is the start of the innermost such loop; otherwise, it is the state after the scope's
    /// last state.
    fn destination(&self, scope: &MatrixBracket<'_>) -> MatrixDestination<'p> {
        let (mut outermost, mut ends_with) = (scope, Vec::new());
        while let Some(around) = outermost.around {
            let around = &self.all[around];
            if around.last > scope.last {
                break;
            }
            if matches!(around.kind, BracketKind::WithoutEnd) {
                return MatrixDestination { row: around.first, afresh: around.begins, ends_with };
            }
            ends_with.extend(around.marks);
            outermost = around;
        }
        MatrixDestination { row: scope.last + 1, afresh: outermost.ends, ends_with }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::samples::compiled;

    /// Returns the matrix, for `size` states, as a dense matrix that includes zeros.
    fn with_zeros(matrix: &Matrix, size: usize) -> DMatrix<u8> {
        let one = |row, column| u8::from((matrix * UnitVector { row: column }).row == row);
        DMatrix::from_fn(size, size, one)
    }

    /// Returns the dense matrices of a plan with their condition texts, and checks that every column is a
    /// standard basis vector.
    fn dense(plan: &str) -> Vec<(String, DMatrix<u8>)> {
        let plan = compiled(plan).swap_remove(0).nondegenerate;
        let Matrices { laws, transitions, .. } = matrices(&plan).unwrap();
        let dense = |one: &Transition<'_>| (one.interrupt.text.clone(), with_zeros(&one.matrix, laws.len() + 1));
        let dense: Vec<_> = transitions.iter().map(dense).collect();
        for (text, matrix) in &dense {
            assert!(is_proper(matrix), "{text}: {matrix}");
        }
        dense
    }

    fn is_proper(matrix: &DMatrix<u8>) -> bool {
        matrix.column_iter().all(|column| column.iter().all(|entry| *entry <= 1) && column.sum() == 1)
    }

    #[test]
    fn an_atom_a_behavior_and_a_loop_have_the_three_types_of_the_paper() {
        let matrices =
            dense("{ P (bumper) { Q (wait 9) (Atom (wait 1) stop) (Atom (wait 2) stop) } (Atom (wait 3) stop) }");
        let of_the_paper = [
            ("bumper", [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1]),
            ("wait 9", [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 1]),
            ("wait 1", [0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
            ("wait 2", [1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1]),
            ("wait 3", [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1]),
        ];
        let of_the_paper = of_the_paper.map(|(text, rows)| (text.to_owned(), DMatrix::from_row_slice(4, 4, &rows)));
        assert_eq!(matrices, of_the_paper);
        let looping = dense("{ P (Atom (wait 1) stop) ((Atom (wait 2) stop) (Atom (wait 3) stop))^inf }");
        let last = DMatrix::from_row_slice(4, 4, &[1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
        assert_eq!(looping[3], ("wait 3".to_owned(), last));
    }

    #[test]
    fn finite_loops_are_written_out() {
        let texts: Vec<_> =
            dense("{ P ({ Q (wait 9) (Atom (wait 1) stop) })^2 }").into_iter().map(|(text, _)| text).collect();
        assert_eq!(texts, ["null", "wait 9", "wait 1", "wait 9", "wait 1"]);
    }

    #[test]
    fn an_execution_is_a_product_of_matrices() {
        let plan = "{ P { Q (bumper) (Atom (wait 1) stop)^2 } ((Atom (wait 2) stop) (Atom (wait 3) stop))^inf }";
        let compiled = compiled(plan).swap_remove(0).nondegenerate;
        let matrices = matrices(&compiled).unwrap().transitions;
        // The interrupts of the first atom, its copy, the first atom of the loop, the second atom (which starts the
        // next pass), and again the first atom of the loop.
        let fired = [2, 3, 4, 5, 4];
        let sparse = fired.iter().fold(UnitVector { row: 0 }, |e, i| &matrices[*i].matrix * e);
        let product =
            fired.iter().fold(DMatrix::identity(5, 5), |product, i| with_zeros(&matrices[*i].matrix, 5) * product);
        assert_eq!((sparse.row, product[(sparse.row, 0)]), (3, 1));
        assert!(is_proper(&product));
    }

    #[test]
    fn an_interrupt_that_is_counted_once_has_the_matrix_of_equation_3() {
        let plan = "{ P { Q (bumper) (Atom (wait 1) stop) } (Atom (wait 2) stop) (Atom (bumper) stop) }";
        let bumper = dense(plan).into_iter().filter(|(text, _)| text == "bumper").map(|(_, matrix)| matrix);
        let (sum, n) = bumper.fold((DMatrix::zeros(4, 4), 0), |(sum, n), matrix| (sum + matrix, n + 1));
        let combined = sum - DMatrix::identity(4, 4) * (n - 1);
        assert_eq!(n, 2);
        assert_eq!(combined, DMatrix::from_row_slice(4, 4, &[0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1]));
    }
}
