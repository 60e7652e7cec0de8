//! Removes degeneracy (paper, Definition 4; docs/src/reference/semantics.md, 7.1): after this step, no interrupt is
//! repeated inside its scope.
//!
//! The outer interrupt is evaluated first, so it always wins. Replacing the inner interrupts by the null interrupt
//! therefore changes no trace.

use std::collections::{BTreeMap, BTreeSet};

use super::{Atom, Condition, Function, Functions, Interrupt, Node, Plan, Quark, QuarkId, Scope};
use crate::diagnostic::{Code, Diagnostic, Span};

/// A plan without degeneracy. Only [`remove_degeneracy`] constructs this type.
#[derive(Debug, Clone, PartialEq)]
pub struct Nondegenerate(Plan);

impl Nondegenerate {
    /// Returns the plan itself.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.0
    }

    /// Rewrites the outermost scope. `rewrite` must not repeat an interrupt inside its scope; the expansion of loops,
    /// for example, does not.
    #[must_use]
    pub(crate) fn map(&self, rewrite: impl FnOnce(&Scope) -> Scope) -> Self {
        Self(Plan { root: rewrite(&self.0.root), quarks: self.0.quarks.clone() })
    }
}

/// Replaces all repeated interrupts by the null interrupt. Returns the plan, and a warning for each place in the text.
#[must_use]
pub fn remove_degeneracy(mut plan: Plan) -> (Nondegenerate, Vec<Diagnostic>) {
    let mut removal = Removal {
        functions: Functions::new(&plan.quarks),
        quarks: &plan.quarks,
        around: BTreeMap::new(),
        warned: BTreeSet::new(),
        warnings: Vec::new(),
    };
    removal.scope(&mut plan.root);
    let warnings = removal.warnings;
    (Nondegenerate(plan), warnings)
}

/// State of the pass that removes degeneracy. `around` contains the interrupts of the enclosing scopes, each with the
/// name of the scope and the span of the interrupt.
struct Removal<'a> {
    functions: Functions<'a>,
    quarks: &'a [Quark],
    around: BTreeMap<Function, (String, Span)>,
    warned: BTreeSet<(Span, Span)>,
    warnings: Vec<Diagnostic>,
}

impl Removal<'_> {
    fn scope(&mut self, scope: &mut Scope) {
        // This function is not in `around` yet, because a repeated interrupt is removed and returns `None`.
        let function = self.interrupt(&mut scope.interrupt, None);
        if let Some(function) = &function {
            self.around.insert(function.clone(), (scope.name.clone(), scope.interrupt.span));
        }
        self.sequence(&mut scope.body);
        if let Some(function) = &function {
            self.around.remove(function);
        }
    }

    fn sequence(&mut self, body: &mut [Node]) {
        for node in body {
            match node {
                Node::Atom(Atom { law, interrupt, .. }) => {
                    self.interrupt(interrupt, Some(*law));
                }
                Node::Scope(scope) => self.scope(scope),
                Node::Loop(repeated) => self.sequence(&mut repeated.body),
            }
        }
    }

    /// If an enclosing scope has the same interrupt, replaces the interrupt by null and returns `None`. Otherwise,
    /// returns the function of the interrupt; `None` if the function cannot be repeated.
    fn interrupt(&mut self, interrupt: &mut Interrupt, law: Option<QuarkId>) -> Option<Function> {
        let function = self.functions.function(&interrupt.condition)?;
        let Some((scope, outer)) = self.around.get(&function).cloned() else { return Some(function) };
        if self.warned.insert((interrupt.span, outer)) {
            self.warnings.push(self.warning(interrupt, law, &scope, outer));
        }
        interrupt.condition = Condition::Null;
        interrupt.removed = true;
        None
    }

    fn warning(&self, interrupt: &Interrupt, law: Option<QuarkId>, scope: &str, outer: Span) -> Diagnostic {
        let whose = if scope.is_empty() { "the enclosing scope".to_owned() } else { format!("`{scope}`") };
        let warning = Diagnostic::new(
            Code::W0101,
            format!("`{}` is repeated inside {whose}, which has the same interrupt", interrupt.text),
            interrupt.span,
            "removed: the outer one always fires first",
        )
        .also(outer, format!("{whose} ends by this first"));
        match law.and_then(|law| self.quarks.get(law.0 as usize)) {
            Some(law) if law.completes => warning.help(format!("the atom now ends when `{}` completes", law.text)),
            Some(law) => warning.help(format!(
                "`{}` never ends by itself: give the atom another condition if something is to follow it",
                law.text
            )),
            None => warning.help("write `(null)` if nothing else is to end this scope"),
        }
    }
}
