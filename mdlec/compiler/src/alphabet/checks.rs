//! Checks an alphabet for errors that its grammar does not exclude.

use std::collections::BTreeSet;

use super::{AlphabetFile, Declaration, DeclarationKind, ParameterKind};
use crate::diagnostic::{Code, Diagnostic};

/// Returns a diagnostic for each error in the declarations.
pub(super) fn check(alphabet: &AlphabetFile) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut met = BTreeSet::new();
    for declaration in &alphabet.declarations {
        if !met.insert((declaration.name.as_str(), kinds_of(declaration))) {
            let message = format!("`{}` is declared twice with the same kinds of arguments", declaration.name);
            found.push(at(declaration, message));
        }
        check_params(declaration, &mut found);
        if declaration.name == "wait"
            && declaration.kind == DeclarationKind::Interrupt
            && kinds_of(declaration) != [ParameterKind::Time]
        {
            let message = "`wait` is the timer that each scope has: its one parameter is a time".into();
            found.push(
                at(declaration, message).help("write `interrupt wait(duration: time s)`, or choose another name"),
            );
        }
        let is_signal = declaration.kind == DeclarationKind::Signal;
        if is_signal != declaration.unit.is_some() {
            let message =
                if is_signal { "a signal needs `unit … tolerance …`" } else { "only a signal has a tolerance" };
            found.push(at(declaration, message.into()));
        }
        if declaration.completes && declaration.kind != DeclarationKind::Control {
            found.push(at(declaration, format!("only a law completes, and `{}` is not a law", declaration.name)));
        }
        if declaration.exclusive {
            found.extend(exclusive(declaration));
        }
    }
    found
}

/// Returns an error if the declaration is marked `exclusive` but must not be. An exclusive interrupt has at least one
/// parameter, and all its parameters are compared without rounding. It has no memory, because its value must be the
/// same in all scopes.
fn exclusive(declaration: &Declaration) -> Option<Diagnostic> {
    let name = &declaration.name;
    let because = |message: String| Some(at(declaration, message));
    if declaration.kind != DeclarationKind::Interrupt {
        return because(format!("`{name}` is `exclusive`, but only an interrupt can be"));
    }
    if declaration.remembers {
        return because(format!(
            "`{name}` cannot be both `remembers` and `exclusive`: each scope has a memory of its own"
        ));
    }
    if declaration.params.is_empty() {
        return because(format!("`{name}` is `exclusive`, but has no parameters in which two uses could differ"));
    }
    let measured = declaration.params.iter().find(|param| !param.kind.is_discrete())?;
    let kind = measured.kind.words();
    because(format!("`{}` is {kind}, which an exclusive interrupt cannot have as a parameter", measured.name))
        .map(|found| found.help("its parameters are of the types bits, integer, count, sonar, robot and module"))
}

fn kinds_of(declaration: &Declaration) -> Vec<ParameterKind> {
    declaration.params.iter().map(|param| param.kind).collect()
}

fn check_params(declaration: &Declaration, found: &mut Vec<Diagnostic>) {
    let mut names = BTreeSet::new();
    let mut has_default = false;
    for param in &declaration.params {
        let name = &param.name;
        if !names.insert(name) {
            found.push(at(declaration, format!("two parameters are called `{name}`")));
        }
        if has_default && param.default.is_none() {
            let message = format!("`{name}` needs a default, because a parameter before it has one");
            found.push(at(declaration, message));
        }
        has_default |= param.default.is_some();
        let default = param.default.as_ref().and_then(|default| default.parse::<f64>().ok());
        if param.except.is_some() && default == param.except {
            found.push(at(declaration, format!("the default of `{name}` is the value that it may not have")));
        }
        let Some((least, most)) = param.range else { continue };
        if least > most {
            found.push(at(declaration, format!("the range of `{name}` ends before it begins")));
        } else if default.is_some_and(|default| default < least || default > most) {
            found.push(at(declaration, format!("the default of `{name}` is out of its range")));
        }
    }
}

fn at(declaration: &Declaration, message: String) -> Diagnostic {
    Diagnostic::new(Code::E0601, message, declaration.span, "in this declaration")
}
