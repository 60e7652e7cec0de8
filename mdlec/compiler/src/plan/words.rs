//! Finds interrupts and laws of a plan by the names that scripts use.

use std::collections::{BTreeMap, BTreeSet};

use super::size::Bounds;
use super::{Condition, Interrupt, Node, Plan, QuarkId, resolve};
use crate::alphabet::{self, Alphabet};
use crate::diagnostic::{SourceId, has_errors};
use crate::syntax::{Arena, NoFiles, parse_with};

/// Texts of the interrupts and laws in a plan, by which scripts name them.
pub(crate) struct Words<'p> {
    plan: &'p Plan,
    alphabet: &'p Alphabet,
    interrupts: BTreeSet<&'p str>,
    /// Conditions that a script must not list, with the reason for each.
    counted: BTreeMap<&'p str, &'static str>,
    laws: BTreeSet<&'p str>,
}

impl<'p> Words<'p> {
    /// Collects the texts of a plan; the plan was resolved against `alphabet`.
    pub(crate) fn new(plan: &'p Plan, alphabet: &'p Alphabet) -> Self {
        let (interrupts, counted, laws) = (BTreeSet::new(), BTreeMap::new(), BTreeSet::new());
        let mut words = Self { plan, alphabet, interrupts, counted, laws };
        for part in plan.parts() {
            part.interrupt().into_iter().for_each(|interrupt| words.condition(interrupt));
            words.laws.extend(part.atom().map(|atom| plan.quark(atom.law).text.as_str()));
        }
        words
    }

    fn condition(&mut self, interrupt: &'p Interrupt) {
        let plan = self.plan;
        interrupt.condition.each_quark(&mut |id| {
            self.interrupts.insert(&plan.quark(id).text);
        });
        interrupt.condition.fold((), &mut |(), part| {
            if let Some((id, reason)) = part.counted() {
                self.counted.insert(&plan.quark(id).text, reason);
            }
        });
    }

    /// Returns the text of the interrupt to which the script's word `written` refers.
    ///
    /// # Errors
    /// Returns a message if the plan has no such interrupt, or if a script must not name it.
    pub(crate) fn interrupt(&self, written: String) -> Result<String, String> {
        if self.interrupts.contains(written.as_str()) {
            return Ok(written);
        }
        let law = self.laws.first().copied().unwrap_or("stop");
        let read = self.read(&written, &format!("{{ Script ({written}) (Atom (null) {law}) }}"));
        let text = read.map(|plan| plan.root.interrupt.text).unwrap_or_else(|| written.clone());
        if let Some(reason) = self.counted.get(text.as_str()) {
            return Err(format!("`{written}` {reason}: leave it out"));
        }
        known(&written, text, &self.interrupts, ["interrupt", "interrupts"])
    }

    /// Returns the text of the law to which the script's word `written` refers.
    ///
    /// # Errors
    /// Returns a message if the plan has no such law.
    pub(crate) fn law(&self, written: String) -> Result<String, String> {
        if self.laws.contains(written.as_str()) {
            return Ok(written);
        }
        let read = self.read(&written, &format!("{{ Script (Atom (null) ({written})) }}"));
        let law = read.and_then(|plan| match plan.root.body.as_slice() {
            [Node::Atom(atom)] => Some(plan.quark(atom.law).text.clone()),
            _ => None,
        });
        known(&written, law.unwrap_or_else(|| written.clone()), &self.laws, ["law", "laws"])
    }

    /// Compiles the plan `text`, which contains the script's word `written`; `None` if it has errors.
    fn read(&self, written: &str, text: &str) -> Option<Plan> {
        // Text that closes a bracket or begins a comment could be read as more than one name.
        if written.contains(['{', '}', ';', '\n', '"']) || written.contains("//") || written.contains("/*") {
            return None;
        }
        let arena = Arena::new();
        let (files, found) = parse_with(SourceId(0), text, &arena, &mut NoFiles);
        let (mut plans, more) = resolve(&files, self.alphabet, None, Bounds::FILES);
        (!has_errors(&found) && !has_errors(&more) && plans.len() == 1).then(|| plans.remove(0))
    }
}

/// Returns `text` if the plan contains it. Otherwise, returns a message with the most similar text or with all texts.
fn known(written: &str, text: String, texts: &BTreeSet<&str>, [one, many]: [&str; 2]) -> Result<String, String> {
    if texts.contains(text.as_str()) {
        return Ok(text);
    }
    let message = format!("`{written}` is no {one} of the plan");
    if texts.is_empty() {
        return Err(format!("{message}, which has no {many} but timers"));
    }
    Err(match alphabet::nearest(&text, texts.iter().copied()) {
        Some(near) => format!("{message}; did you mean `{near}`?"),
        None => {
            let texts: Vec<_> = texts.iter().map(|text| format!("`{text}`")).collect();
            format!("{message}\nhelp: its {many} are {}", texts.join(", "))
        }
    })
}

impl Condition {
    /// Returns the quark that depends only on the time or on the length of the driven path, with the reason why scripts
    /// must omit it; `None` if the condition is not such a quark.
    fn counted(&self) -> Option<(QuarkId, &'static str)> {
        match self {
            Self::Wait { quark, .. } | Self::Elapsed { quark, .. } => {
                Some((*quark, "is a timer, which fires by the time `t` of the turns"))
            }
            Self::Driven { quark, .. } => Some((*quark, "fires by the `way` of the turns")),
            Self::Null | Self::Quark(_) | Self::After(_) => None,
            Self::Or(_) | Self::And(_) | Self::Not(_) | Self::Rising { .. } => None,
        }
    }
}
