//! Inlay hints: units of numbers without a unit, laws that complete, and plans that never end.

use mdle_compiler::alphabet::DeclarationKind;
use mdle_compiler::syntax::tree::{Count, Element, Primary};

use crate::mentions::{Role, inside, mentions};
use crate::view::View;

/// A hint that an editor shows inside the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hint {
    /// Byte offset after which the hint is shown.
    pub byte: usize,
    /// Text of the hint.
    pub text: String,
}

/// Returns the hints of a document in order of position.
#[must_use]
pub fn hints(view: &View<'_>) -> Vec<Hint> {
    let mut hints = Vec::new();
    for mention in mentions(view.files, view.alphabet) {
        let Some(range) = view.range(mention.span) else { continue };
        let text = match mention.role {
            Role::Number(Some(unit)) if range.len() == mention.text.len() => unit.name.to_owned(),
            Role::Quark(DeclarationKind::Control) if completes(view, mention.text) => "completes".to_owned(),
            Role::Plan | Role::Parameter | Role::Label | Role::Quark(_) | Role::Type | Role::Number(_) | Role::Text => {
                continue;
            }
        };
        hints.push(Hint { byte: range.end, text });
    }
    view.own().iter().for_each(|plan| endless(view, plan.elements, &mut hints));
    hints.sort_by_key(|hint| hint.byte);
    hints
}

/// Returns `true` if every law with this name can complete by itself.
fn completes(view: &View<'_>, name: &str) -> bool {
    let mut laws =
        view.alphabet.declarations_of(name).filter(|found| found.kind == DeclarationKind::Control).peekable();
    laws.peek().is_some() && laws.all(|law| law.completes)
}

/// Appends a hint for each endless loop.
fn endless(view: &View<'_>, elements: &[Element<'_>], hints: &mut Vec<Hint>) {
    for element in elements {
        let of_exec = if let Primary::Exec(exec) = element.primary { Some(&exec.count) } else { None };
        for count in of_exec.into_iter().chain(element.power()) {
            if let Count::Infinity(span) = count
                && let Some(range) = view.range(*span)
            {
                hints.push(Hint { byte: range.end, text: "never ends".to_owned() });
            }
        }
        endless(view, inside(&element.primary), hints);
    }
}
