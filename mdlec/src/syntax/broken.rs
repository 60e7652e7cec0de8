//! Takes out of the tree what a defect has upset: where the parser has lost its way, it may have read names where none were meant,
//! and later stages must not complain about those. What stands beside a defect stays.

use super::regions::Regions;
use super::token::Token;
use super::tree::{ConditionNode, Element, File, Plan, Primary};
use crate::diagnostic::Span;

/// Takes out what stands where an error has been told, and plans without a name.
pub(super) fn take_out(file: &mut File, tokens: &[Token<'_>], regions: &Regions) {
    let defects = Defects { tokens, regions };
    file.plans.retain(|plan| !plan.name.node.is_empty());
    file.plans.iter_mut().for_each(|plan| defects.plan(plan));
}

struct Defects<'t, 's> {
    tokens: &'t [Token<'s>],
    regions: &'t Regions,
}

impl Defects<'_, '_> {
    fn plan(&self, plan: &mut Plan) {
        if let Some(condition) = plan.condition.as_mut().filter(|condition| self.are_at(condition.span)) {
            condition.node = ConditionNode::Broken;
        }
        plan.elements.iter_mut().for_each(|element| self.element(element));
    }

    fn element(&self, element: &mut Element) {
        let spoiled = self.are_at(element.span);
        match &mut element.primary {
            Primary::Plan(plan) if !plan.name.node.is_empty() => self.plan(plan),
            Primary::Exec { body, .. } => body.iter_mut().for_each(|element| self.element(element)),
            Primary::String(body) | Primary::Formal { body, .. } if !spoiled => {
                body.iter_mut().for_each(|element| self.element(element));
            }
            Primary::Atom { .. } | Primary::Ref(_) if !spoiled => {}
            broken @ (Primary::Plan(_)
            | Primary::String(_)
            | Primary::Formal { .. }
            | Primary::Atom { .. }
            | Primary::Ref(_)
            | Primary::Broken) => *broken = Primary::Broken,
        }
    }

    /// Whether an error has been told in the region where this begins.
    fn are_at(&self, span: Span) -> bool {
        let start = span.start as usize;
        self.regions.is_spoiled(self.tokens.partition_point(|token| token.place.start < start))
    }
}
