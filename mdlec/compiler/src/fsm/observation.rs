//! Checks Observation 1 of the paper on a machine: every column of its transition matrices is a standard basis vector.
//!
//! The matrix of a single scope has such columns by construction: the columns of its atoms have their 1 in the same
//! row. If an interrupt that belongs to several scopes is counted once, its matrix is a sum over these scopes (Eq. 3),
//! and a column that two of these scopes list would have two ones and a minus one. The intervals of scopes are nested
//! or disjoint, so this happens only if a scope has the same interrupt as an enclosing scope. Therefore, the function
//! checks that the plan of the machine is non-degenerate.

use std::collections::BTreeMap;

use super::{Machine, Visit};
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::{Function, Functions};

/// Checks that all columns of a machine's transition matrices are standard basis vectors, even if an interrupt that
/// belongs to several scopes is counted once. The brackets must be in pre-order and nested, which
/// [`validate`](super::validate) checks.
///
/// # Errors
/// Fails with E0901 for the first interrupt that is repeated inside its scope. This indicates a bug in the compiler.
pub fn observation1(machine: &Machine) -> Result<(), Diagnostic> {
    let functions = Functions::new(machine.quarks());
    let mut open: BTreeMap<Function, &str> = BTreeMap::new();
    for visit in machine.walk() {
        let (Visit::Enter(element) | Visit::Leave(element)) = visit;
        let (Some(interrupt), Some(function)) = (element.interrupt(), functions.function(element.condition())) else {
            continue;
        };
        if let Visit::Leave(_) = visit {
            open.remove(&function);
        } else if let Some(outer) = open.insert(function, element.name()) {
            let message = format!(
                "`{}` is repeated inside the scope `{outer}`, which has the same interrupt: its transition matrix would \
                 have a column that is no unit vector",
                interrupt.text
            );
            return Err(Diagnostic::new(Code::E0901, message, interrupt.span, "this one was to be removed")
                .help("this is a defect of mdlec, not of the plan: please report it with the plan"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fsm::lower;
    use crate::samples::compiled;

    #[test]
    fn a_plan_that_repeats_an_interrupt_is_not_lowered() {
        let texts = [
            "{ P (bumper) (Atom (bumper) stop) }",
            "{ P { Q (bumper OR wait 5) { R (Atom (wait 1) stop) (Atom (wait 5s OR bumper) stop) } } }",
            "{ P (wait 3) ((Atom (wait 1) stop) { Q (wait 3000ms) (Atom (wait 2) stop) })^2 }",
        ];
        for text in texts {
            let compiled = compiled(text).swap_remove(0);
            assert_eq!(observation1(&compiled.machine), Ok(()), "{text}");
            let degenerate = compiled.nondegenerate.map(|_| compiled.plan.root.clone());
            let error = lower(&degenerate).unwrap_err();
            assert!(error.code == Code::E0901 && error.message.contains("is repeated inside"), "{text}: {error:?}");
        }
    }

    #[test]
    fn an_interrupt_of_scopes_side_by_side_is_not_repeated() {
        let text =
            "{ P { Q (bumper) (Atom (wait 1) stop) (Atom (wait 2) stop) } (Atom (bumper) stop) (Atom (wait 1) stop) }";
        assert_eq!(observation1(&compiled(text)[0].machine), Ok(()));
    }

    #[test]
    fn what_is_another_function_in_each_place_may_stand_inside_itself() {
        let text = "{ P (RISING bumper) { Q (NOT wait 1) (Atom (RISING bumper) stop) (Atom (NOT wait 1) stop) } }";
        assert_eq!(observation1(&compiled(text)[0].machine), Ok(()));
    }
}
