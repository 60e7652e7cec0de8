//! The causes of transitions and of the end of a plan, as tests name them.

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::fsm::ElementKind;
use mdle_host::is_operand;
use mdle_runtime::Printable;
use mdle_runtime::trace::COMPLETED;

use super::file::{At, TestFileError};
use super::subject::Subject;

/// A cause that a text names.
#[derive(Clone)]
pub(super) enum NamedCause {
    /// The completion of a law.
    Completed,
    /// Operands of interrupts, each as the number of its element and the number of the operand.
    Operands(Vec<(u32, u32)>),
    /// The interrupts of these scopes.
    Scopes(Vec<u32>),
}

/// Reads a cause: `completed`, an operand, or the name of a scope.
///
/// # Errors
/// Fails if the plan has no such cause.
pub(super) fn cause(text: &At<String>, subject: &Subject) -> Result<NamedCause, TestFileError> {
    let wanted = text.get_ref().trim();
    if wanted == COMPLETED {
        return Ok(NamedCause::Completed);
    }
    let operands = subject.operands().filter(|(.., operand)| is_operand(wanted, operand));
    let operands: Vec<_> = operands.map(|(element, number, _)| (element, number)).collect();
    if !operands.is_empty() {
        return Ok(NamedCause::Operands(operands));
    }
    let scopes = subject.machine().elements().filter(|element| !wanted.is_empty() && element.name() == wanted);
    let scopes: Vec<_> = scopes.map(|element| element.number()).collect();
    if !scopes.is_empty() {
        return Ok(NamedCause::Scopes(scopes));
    }
    let mut known: Vec<&str> = subject.operands().map(|(.., operand)| operand.written).collect();
    known.retain(|operand| *operand != "null");
    known.dedup();
    let near = did_you_mean(wanted, &known);
    let listed = known.iter().map(|operand| format!("`{operand}`")).collect::<Vec<_>>().join(", ");
    let message = format!("no interrupt of the plan has the operand `{}`{near}", Printable(wanted));
    Err(TestFileError::at(text.span(), message).help(format!("its operands are {listed}; a law ends by `{COMPLETED}`")))
}

/// Restricts a cause to the elements at the end of the plan, which end the plan when they end.
///
/// # Errors
/// Fails if no such element is left: the cause ends only a part of the plan.
pub(super) fn ending(text: &At<String>, cause: NamedCause, subject: &Subject) -> Result<NamedCause, TestFileError> {
    let (cause, is_left) = match cause {
        NamedCause::Completed => {
            let mut laws = subject.machine().elements().filter(|element| element.completes());
            if !laws.any(|element| ends_plan(subject, element.number())) {
                let message = "no law at the end of the plan completes";
                let help = "expect the operand that ends the plan, or `running`";
                return Err(TestFileError::at(text.span(), message).help(help));
            }
            (NamedCause::Completed, true)
        }
        NamedCause::Operands(mut operands) => {
            operands.retain(|(element, _)| ends_plan(subject, *element));
            let is_left = !operands.is_empty();
            (NamedCause::Operands(operands), is_left)
        }
        NamedCause::Scopes(mut scopes) => {
            scopes.retain(|scope| ends_plan(subject, *scope));
            let is_left = !scopes.is_empty();
            (NamedCause::Scopes(scopes), is_left)
        }
    };
    if is_left {
        return Ok(cause);
    }
    let message = format!("`{}` ends a part of the plan, and more follows", Printable(text.get_ref().trim()));
    let help = "expect a transition: `expect.transitions = [{ by = \"…\" }]`";
    Err(TestFileError::at(text.span(), message).help(help))
}

/// Returns `true` if nothing follows an element when it ends, at least in the last pass of the enclosing loops.
fn ends_plan(subject: &Subject, element: u32) -> bool {
    let last = subject.machine().root().last().number();
    subject
        .machine()
        .element(element)
        .outwards()
        .all(|element| element.last().number() == last && !matches!(element.kind(), ElementKind::Loop { times: None }))
}
