//! Definitions, references and rename for plans, parameters and labels.

use std::collections::BTreeSet;

use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::diagnostic::Span;
use mdle_compiler::syntax::tree::{Element, Primary};
use mdle_compiler::syntax::{Arena, parse};

use crate::diagnostics::{FileRange, place};
use crate::mentions::{Mention, Role, mentions};
use crate::view::View;

/// A plan, parameter or label at a byte offset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedItem {
    /// Place of the name in its definition.
    pub defined: FileRange,
    /// Place of the name at the byte offset.
    pub here: FileRange,
    /// Name of the plan, parameter or label.
    pub name: String,
}

/// Returns the plan, parameter or label at a byte offset; `None` if no plan defines the name at this offset.
#[must_use]
pub fn named(view: &View<'_>, byte: usize) -> Option<NamedItem> {
    let mentions = mentions(view.files, view.alphabet);
    let mention = mentions.iter().find(|mention| mention.defined.is_some() && view.contains(mention.span, byte))?;
    let at = |span: Span| place(view.sources, span);
    Some(NamedItem { defined: at(mention.defined?), here: at(mention.span), name: mention.text.to_owned() })
}

/// Returns the path in the `use` at a byte offset, as written in the document; `None` if there is none.
#[must_use]
pub fn used_file(view: &View<'_>, byte: usize) -> Option<String> {
    let used = view.file.uses.iter().find(|used| view.contains(used.span, byte))?;
    Some(used.node.to_owned())
}

/// Returns the places of all names in the document whose definition `is_meant` accepts.
#[must_use]
pub fn references(view: &View<'_>, is_meant: impl Fn(&FileRange) -> bool) -> Vec<FileRange> {
    let of_definition = |mention: &Mention<'_>| {
        view.range(mention.span).is_some() && mention.defined.is_some_and(|span| is_meant(&place(view.sources, span)))
    };
    let mentions = mentions(view.files, view.alphabet);
    let places: BTreeSet<_> =
        mentions.iter().filter(|mention| of_definition(mention)).map(|mention| mention.span).collect();
    places.into_iter().map(|span| place(view.sources, span)).collect()
}

/// Returns `true` if the parser accepts a text as the name of a plan.
#[must_use]
pub fn is_name(name: &str) -> bool {
    let text = format!("{{ {name} Other }}");
    let arena = Arena::new();
    let (file, found) = parse(SourceId(0), &text, &arena);
    let [plan] = file.plans.as_slice() else { return false };
    let is_other = |element: &Element<'_>| matches!(element.primary, Primary::Ref(call) if call.name == "Other");
    found.is_empty() && plan.name.node == name && matches!(plan.elements, [only] if is_other(only))
}

/// Returns, for each mention, a number for its role and the index of the mention that defines its name. If the list is
/// the same before and after a rename, the rename changes no meaning.
#[must_use]
pub fn meanings(view: &View<'_>) -> Vec<(u8, Option<usize>)> {
    let mentions = mentions(view.files, view.alphabet);
    let role = |role: Role| match role {
        Role::Plan => 0,
        Role::Parameter => 1,
        Role::Label => 2,
        Role::Quark(_) => 3,
        Role::Type => 4,
        Role::Number(_) => 5,
        Role::Text => 6,
    };
    let index = |span: Span| mentions.iter().position(|mention| mention.span == span);
    mentions.iter().map(|mention| (role(mention.role), mention.defined.and_then(index))).collect()
}

#[cfg(test)]
mod tests {
    use super::is_name;

    #[test]
    fn a_name_is_what_the_parser_reads_as_one() {
        assert!(["Leg", "größe", "x_1", "_"].into_iter().all(is_name));
        assert!(
            !["", "a b", "1a", "Atom", "OR", "inf", "a-b", "P } { Q", "a (b)", "//", "use"].into_iter().any(is_name)
        );
    }
}
