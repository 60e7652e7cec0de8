//! Checks the arguments with which a plan uses another plan by name (docs/src/reference/language.md, 3.4).

use super::arguments::{example, fit};
use super::parameters::Parameters;
use crate::alphabet::{Alphabet, Declaration, DeclarationKind, Origin, Param};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::tree::{self, Call};

/// Returns the parameters of `plan` with the arguments of `call`. `around` contains the parameters of the definition
/// that contains the call.
///
/// # Errors
/// Fails if the number, the type or the unit of the arguments differs from the declaration.
pub(super) fn with_arguments<'s>(
    plan: &tree::Plan<'s>,
    call: &Call<'s>,
    around: &Parameters<'s>,
    alphabet: &Alphabet,
) -> Result<Parameters<'s>, Vec<Diagnostic>> {
    // Unknown types were reported where the plan declares them.
    let mut parameters = Parameters::declared(plan, alphabet, &mut Vec::new());
    if parameters.len() < plan.params.len() {
        return Ok(parameters);
    }
    let declaration = declaration(plan, &parameters);
    if let Err(found) = fit(call, &declaration, "", around) {
        let at_call = |mut found: Diagnostic| {
            if found.code == Code::E0301 {
                found.help.clear();
                found = usage(found, call, &declaration);
            }
            found.also(plan.name.span, format!("`{}` is written here", plan.name.node))
        };
        return Err(found.into_iter().map(at_call).collect());
    }
    for (param, arg) in plan.params.iter().zip(call.args) {
        parameters.give(param.name.node, around.of(arg).map_or(Some(*arg), |outer| outer.given));
    }
    Ok(parameters)
}

/// Returns a declaration for a plan with parameters, in the form of a quark's declaration, so that arguments of plans
/// and quarks are checked in the same way.
fn declaration(plan: &tree::Plan<'_>, parameters: &Parameters<'_>) -> Declaration {
    let param = |param: &tree::Param<'_>| {
        let parameter = parameters.get(param.name.node)?;
        let (name, unit) = (param.name.node.to_owned(), parameter.unit());
        Some(Param { name, kind: parameter.kind, unit, default: None, range: None, except: None, with: Vec::new() })
    };
    Declaration {
        docs: String::new(),
        kind: DeclarationKind::Control,
        name: plan.name.node.to_owned(),
        params: plan.params.iter().filter_map(param).collect(),
        unit: None,
        completes: false,
        remembers: false,
        exclusive: false,
        needs: Vec::new(),
        origin: Origin::Target,
        span: plan.name.span,
    }
}

/// Appends help that shows how to use a plan with these parameters.
fn usage(found: Diagnostic, call: &Call<'_>, declaration: &Declaration) -> Diagnostic {
    let name = &declaration.name;
    if declaration.params.is_empty() {
        return found.fix("write it without parentheses: {}", call.span, name.as_str());
    }
    let params: Vec<_> = declaration.params.iter().map(|param| format!("<{}>", param.name)).collect();
    let found = found.help(format!("write it as `{name}({})`", params.join(", ")));
    match declaration.params.iter().map(example).collect::<Option<Vec<_>>>() {
        Some(examples) if call.args.is_empty() => {
            found.fix("for instance {}", call.span, format!("{name}({})", examples.join(", ")))
        }
        _ => found,
    }
}
