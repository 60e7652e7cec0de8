//! Computes and limits the size that a plan will have after all plans used by name have been copied in. This is done
//! before any copy is made.
//!
//! If plans use plans, their sizes multiply, so a short text may need more memory than any computer has. A file in
//! which all elements are written out is never too large.

use std::collections::BTreeMap;

use crate::diagnostic::Span;
use crate::syntax::tree::{Arg, Call, Condition, ConditionNode, Element, Frame, Operand, Plan, Primary};

/// Bounds on the size of a plan after all plans used by name have been copied in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bounds {
    /// Maximum number of atoms, scopes and loops in a plan; loops are not expanded.
    pub brackets: u64,
    /// Maximum total number of operands in all conditions of a plan.
    pub operands: u64,
    /// Maximum length, in bytes, of a plan's text as `--emit plan` prints it.
    pub text: u64,
    /// `true` if a plan that is not larger than its files as written is always accepted, regardless of its size.
    pub is_written_free: bool,
}

impl Bounds {
    /// The bounds for the user's own files. For a plan of this size, `check` takes half a second and `analyze` a
    /// second.
    pub const FILES: Self = Self { brackets: 1 << 18, operands: 1 << 19, text: 1 << 26, is_written_free: true };
}

/// Maximum nesting depth.
pub(super) const DEPTH: u32 = 512;

/// Number of additional bytes of printed text for each quark, atom or scope, for defaults, units and brackets.
const BESIDE: u64 = 16;

/// Size of a plan or of a part of a plan.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Size {
    /// Number of atoms, scopes and loops.
    brackets: u64,
    operands: u64,
    text: u64,
    pub(super) depth: u32,
}

/// A limit that a plan exceeds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Excess {
    of: fn(&Size) -> u64,
    /// Unit of the count, in the plural.
    pub(super) unit: &'static str,
    pub(super) limit: u64,
}

impl Excess {
    /// Returns the count in `size` that this limit restricts.
    pub(super) fn count(&self, size: &Size) -> u64 {
        (self.of)(size)
    }
}

impl Size {
    /// Returns the first limit that this size exceeds; `written` is the size of the files as written.
    pub(super) fn excess(&self, written: &Self, bounds: &Bounds) -> Option<Excess> {
        let limits: [Excess; 3] = [
            Excess { of: |size| size.brackets, unit: "atoms, scopes and loops", limit: bounds.brackets },
            Excess { of: |size| size.operands, unit: "operands of conditions", limit: bounds.operands },
            Excess { of: |size| size.text, unit: "bytes of text", limit: bounds.text },
        ];
        let free = |excess: &Excess| if bounds.is_written_free { excess.count(written) } else { 0 };
        limits.into_iter().find(|excess| excess.count(self) > excess.limit.max(free(excess)))
    }

    /// Returns the total size of two parts, one after the other.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            brackets: self.brackets.saturating_add(other.brackets),
            operands: self.operands.saturating_add(other.operands),
            text: self.text.saturating_add(other.text),
            depth: self.depth.max(other.depth),
        }
    }

    /// Returns the size of a scope or a loop that contains this part.
    fn nested(self) -> Self {
        let inside = self.indented();
        Self { brackets: inside.brackets.saturating_add(1), ..inside }
    }

    /// Returns the size of this part inside brackets, which indent each line.
    fn indented(self) -> Self {
        let text = self.text.saturating_add(self.brackets.saturating_mul(2)).saturating_add(BESIDE);
        Self { text, depth: self.depth.saturating_add(1), ..self }
    }

    fn of_text(bytes: u64) -> Self {
        Self { text: bytes.saturating_add(BESIDE), ..Self::default() }
    }
}

/// Measures plans; used plans are measured before the plans that use them.
pub(super) struct Measure<'m> {
    pub(super) by_name: &'m BTreeMap<&'m str, usize>,
    /// Sizes of the plans that have been measured so far.
    pub(super) sizes: &'m [Size],
    /// Length, in bytes, of the longest argument that is passed to a plan. It is an upper bound for the text of each
    /// parameter.
    pub(super) longest: u64,
}

impl Measure<'_> {
    /// Returns the size of a plan, including all plans that it uses.
    pub(super) fn plan(&self, plan: &Plan<'_>) -> Size {
        let own = plan.condition.as_ref().map_or(Size::default(), |condition| self.condition(condition));
        let name = Size::of_text(plan.name.node.len() as u64);
        own.and(name).and(self.elements(plan.elements)).nested()
    }

    fn elements(&self, elements: &[Element<'_>]) -> Size {
        elements.iter().fold(Size::default(), |sum, element| {
            let size = match &element.primary {
                Primary::Broken => Size { brackets: 1, depth: 1, ..Size::default() },
                Primary::Atom(atom) => self.condition(&atom.condition).and(self.atom(atom.control)),
                Primary::Plan(plan) => self.plan(plan),
                // In formal notation, a law is parsed as a plan used by name.
                Primary::Ref(call) => match self.by_name.get(call.name) {
                    Some(index) => self.sizes.get(*index).copied().unwrap_or_default(),
                    None => self.atom(call),
                },
                Primary::Exec(exec) => {
                    let size = self.elements(exec.body).nested();
                    // With `FRAME here`, each pass becomes a scope.
                    if element.frame() == Some(&Frame::Here) { size.nested() } else { size }
                }
                // An open string is not a scope of its own, except in `FRAME here`.
                Primary::String(body) if element.frame() == Some(&Frame::Here) => self.elements(body).nested(),
                Primary::String(body) => self.elements(body).indented(),
                Primary::Formal(formal) => {
                    let time = formal.time.map_or(Size::default(), |time| self.operand(length(time.span()), 1));
                    let size = self.condition(&formal.condition).and(time).and(self.elements(formal.body));
                    // A single law forms an atom, which has been counted already.
                    if self.is_law(formal.body) { size.indented() } else { size.nested() }
                }
            };
            sum.and(if element.power().is_some() { size.nested() } else { size })
        })
    }

    /// Returns `true` if the body of a scope in formal notation is a single law.
    fn is_law(&self, body: &[Element<'_>]) -> bool {
        matches!(body, [Element { primary: Primary::Ref(call), marks: None, .. }] if !self.by_name.contains_key(call.name))
    }

    fn atom(&self, law: &Call<'_>) -> Size {
        Size { brackets: 1, depth: 1, ..self.quark(law) }
    }

    fn condition(&self, condition: &Condition<'_>) -> Size {
        let one = Size { operands: 1, ..Size::default() };
        match condition.node {
            ConditionNode::Or(operands) | ConditionNode::And(operands) => {
                operands.iter().fold(Size::default(), |sum, operand| sum.and(self.condition(operand)))
            }
            ConditionNode::Not(operand) | ConditionNode::Rising(operand) => one.and(self.condition(operand)),
            ConditionNode::Call(call) => one.and(self.quark(call)),
            ConditionNode::Comparison(compared) => {
                let right = match compared.right {
                    Operand::Signal(call) => self.quark(call),
                    Operand::Number(_) | Operand::Infinity(_) => Size::default(),
                };
                self.operand(length(condition.span), 0).and(self.quark(compared.left)).and(right)
            }
            ConditionNode::After(_) | ConditionNode::Null | ConditionNode::Broken => {
                self.operand(length(condition.span), 0)
            }
        }
    }

    /// Returns the size of an operand, given its number of bytes and its number of arguments.
    fn operand(&self, bytes: u64, arguments: usize) -> Size {
        Size { operands: 1, ..Size::of_text(bytes.saturating_add(self.given(arguments))) }
    }

    fn quark(&self, call: &Call<'_>) -> Size {
        Size::of_text(length(call.span).saturating_add(self.given(call.args.len())))
    }

    fn given(&self, arguments: usize) -> u64 {
        self.longest.saturating_mul(arguments as u64)
    }
}

/// Returns the length, in bytes, of the longest argument in these calls.
pub(super) fn longest<'c>(calls: impl Iterator<Item = &'c Call<'c>>) -> u64 {
    calls.flat_map(|call| call.args).map(|arg: &Arg<'_>| length(arg.span())).max().unwrap_or(0)
}

fn length(span: Span) -> u64 {
    u64::from(span.end.saturating_sub(span.start))
}
