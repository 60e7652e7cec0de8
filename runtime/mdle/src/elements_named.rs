//! Finds the elements of a plan to which a text refers, for `mdle why --not` and for tests of plans.

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::compile;
use mdle_compiler::fsm::{Element, Machine};
use mdle_files::Target;

/// Returns the atoms or scopes to which `text` refers. These are the atoms with this law, in any units; if there are
/// none, the atoms whose law has this name; and if there are none either, the behaviors with this name.
///
/// # Errors
/// Fails with a message and a help text if `text` refers to nothing in the plan.
pub(crate) fn elements_named(machine: &Machine, target: &Target, text: &str) -> Result<Vec<u32>, (String, String)> {
    let text = text.trim();
    let law = law(target, text);
    let candidates: [&dyn Fn(Element<'_>) -> bool; 3] = [
        &|element| law_of(element).is_some_and(|own| own == text || Some(own) == law.as_deref()),
        &|element| law_of(element).is_some_and(|law| law.split(' ').next() == Some(text)),
        &|element| !text.is_empty() && element.is_scope() && element.name() == text,
    ];
    for is_named in candidates {
        let elements = machine.elements().filter(|element| is_named(*element));
        let elements: Vec<_> = elements.map(Element::number).collect();
        if !elements.is_empty() {
            return Ok(elements);
        }
    }
    Err(unnamed(machine, text))
}

/// Returns the text of the law of an atom; `None` for a scope.
fn law_of(element: Element<'_>) -> Option<&str> {
    element.atom().map(|atom| atom.law().text.as_str())
}

/// Returns the error message and the help text for a text that refers to no element.
fn unnamed(machine: &Machine, text: &str) -> (String, String) {
    let once = |names: Vec<&'_ str>| {
        let mut known: Vec<String> = Vec::new();
        for name in names {
            if !name.is_empty() && !known.iter().any(|known| known == name) {
                known.push(name.to_owned());
            }
        }
        known
    };
    let laws = once(machine.atoms().map(|atom| atom.law().text.as_str()).collect());
    let scopes = once(machine.elements().map(Element::name).collect());
    let names: Vec<_> = laws.iter().chain(&scopes).map(String::as_str).collect();
    let near = did_you_mean(text, &names);
    let listed = |names: &[String]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let scopes = if scopes.is_empty() { String::new() } else { format!("; its behaviors are {}", listed(&scopes)) };
    (format!("the plan has no atom `{text}`{near}"), format!("the laws of its atoms are {}{scopes}", listed(&laws)))
}

/// Converts the text of a law, in any units and with any spaces, to the form that a compiled plan has; `None` if the
/// text is not a law.
fn law(target: &Target, text: &str) -> Option<String> {
    let plan = format!("{{ Law (Atom (null) ({text})) }}");
    let mut sources = target.sources();
    let source = sources.add("law", plan.as_str());
    let (plans, _) = compile(source, &plan, &target.alphabet, None);
    let atom = plans.first().and_then(|plan| plan.machine.atoms().next().map(|atom| atom.law().text.clone()));
    atom.filter(|_| !text.contains(['(', ')', '{', '}', ';']))
}
