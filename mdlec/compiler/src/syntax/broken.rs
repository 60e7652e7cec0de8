//! Removes from the tree the elements that a syntax error has affected. In such an element, the parser may have read
//! other words as names, and later stages must not report these names. Elements outside the error's region remain.

use bumpalo::Bump;

use super::regions::Regions;
use super::source::FileText;
use super::token::{Tok, Token};
use super::tree::{Condition, ConditionNode, Element, Exec, File, Formal, Plan, Primary};
use crate::diagnostic::Span;

/// Removes nodes in regions with a reported error from the tree, and plans without a name.
pub(super) fn take_out<'s>(
    file: &mut File<'s>,
    source: FileText<'s>,
    arena: &'s Bump,
    tokens: &[Token<'_>],
    regions: &Regions,
) {
    let defects = Defects { source, arena, tokens, regions };
    let count = file.plans.len();
    // A brace after a name and a group in parentheses belongs to something other than a plan.
    let has_head = |plan: &Plan<'_>| {
        let name = tokens.partition_point(|token| token.place.start < plan.name.span.within(source.id).start);
        name.checked_sub(2).and_then(|before| tokens.get(before)).is_some_and(|before| before.kind == Tok::RParen)
    };
    file.plans.retain(|plan| !plan.name.node.is_empty() && !has_head(plan));
    file.is_incomplete |= file.plans.len() < count;
    file.plans.iter_mut().for_each(|plan| *plan = defects.plan(*plan));
}

struct Defects<'t, 's> {
    source: FileText<'s>,
    arena: &'s Bump,
    tokens: &'t [Token<'t>],
    regions: &'t Regions,
}

impl<'s> Defects<'_, 's> {
    fn plan(&self, plan: Plan<'s>) -> Plan<'s> {
        let condition = plan.condition.map(|condition| match self.are_at(condition.span) {
            true => Condition { node: ConditionNode::Broken, ..condition },
            false => condition,
        });
        Plan { condition, elements: self.elements(plan.elements), ..plan }
    }

    fn elements(&self, elements: &[Element<'s>]) -> &'s [Element<'s>] {
        self.arena.alloc_slice_fill_iter(elements.iter().map(|element| self.element(*element)))
    }

    fn element(&self, element: Element<'s>) -> Element<'s> {
        let spoiled = self.are_at(element.span);
        let primary = match element.primary {
            Primary::Plan(plan) if !plan.name.node.is_empty() => Primary::Plan(self.arena.alloc(self.plan(*plan))),
            Primary::Exec(exec) => {
                let body = self.elements(exec.body);
                Primary::Exec(self.arena.alloc(Exec { body, ..*exec }))
            }
            Primary::String(body) if !spoiled => Primary::String(self.arena.alloc(self.elements(body))),
            Primary::Formal(formal) if !spoiled => {
                let body = self.elements(formal.body);
                Primary::Formal(self.arena.alloc(Formal { body, ..*formal }))
            }
            sound @ (Primary::Atom(_) | Primary::Ref(_)) if !spoiled => sound,
            Primary::Plan(_)
            | Primary::String(_)
            | Primary::Formal(_)
            | Primary::Atom(_)
            | Primary::Ref(_)
            | Primary::Broken => Primary::Broken,
        };
        Element { primary, ..element }
    }

    /// Returns `true` if an error has been reported in the region where `span` begins.
    fn are_at(&self, span: Span) -> bool {
        let start = span.within(self.source.id).start;
        self.regions.is_spoiled(self.tokens.partition_point(|token| token.place.start < start))
    }
}
