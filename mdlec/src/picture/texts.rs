//! What is written on atoms, scopes and loops in a picture.

use std::collections::BTreeMap;

use mdle_runtime::fsm::Kind;

use crate::fsm::{LawMeaning, Machine, ScopeMeaning};
use crate::plan::{Condition, Interrupt, Mark, frame_text};

/// The longest text that a tooltip holds, in characters: what is longer is no text for a person.
const TOOLTIP: usize = 4000;

/// What ends an atom or a scope, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Until {
    /// This condition.
    Fires(String),
    /// The law's completion.
    Done,
    /// Either.
    FiresOrDone(String),
    /// Nothing of its own: its condition was removed, for an outer scope repeats it.
    Removed(String),
    /// Nothing of its own.
    Never,
}

impl Until {
    /// What ends a scope, or an atom whose law may complete.
    pub(super) fn of(interrupt: &Interrupt, completes: bool) -> Self {
        let (text, fires) = (interrupt.text.clone(), interrupt.condition != Condition::Null);
        match (fires, completes, interrupt.removed) {
            (true, true, _) => Self::FiresOrDone(text),
            (true, false, _) => Self::Fires(text),
            (false, true, _) => Self::Done,
            (false, false, true) => Self::Removed(text),
            (false, false, false) => Self::Never,
        }
    }

    /// Whether there is anything that ends it.
    pub(super) fn ends(&self) -> bool {
        match self {
            Self::Fires(_) | Self::Done | Self::FiresOrDone(_) => true,
            Self::Removed(_) | Self::Never => false,
        }
    }

    /// In words, as they stand behind "until" in a picture.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Fires(text) => text.clone(),
            Self::Done => "done".into(),
            Self::FiresOrDone(text) => format!("{text} or done"),
            Self::Removed(text) => format!("{text} (removed: a scope around it has the same)"),
            Self::Never => "never".into(),
        }
    }
}

/// What is written on the brackets of a machine.
#[derive(Debug, Clone, Copy)]
pub(super) struct Texts<'l>(pub(super) &'l Machine);

/// What a bracket is.
#[derive(Debug, Clone, Copy)]
pub(super) enum What<'l> {
    /// An atom: its number, its scope and its law.
    Atom(usize, &'l ScopeMeaning, &'l LawMeaning),
    /// A behavior, or the plan.
    Scope(&'l ScopeMeaning),
    /// A loop: its passes, or for ever.
    Loop(Option<u64>),
}

impl<'l> Texts<'l> {
    /// What the bracket of this number is.
    pub(super) fn what(self, bracket: usize) -> What<'l> {
        let made = &self.0.brackets[bracket];
        let atom = made.first as usize;
        match (made.kind, &self.0.scopes[bracket]) {
            (Kind::Loop { times, .. }, _) => What::Loop((times > 0).then_some(times)),
            (Kind::Scope { .. }, None) => What::Loop(None),
            (Kind::Scope { .. }, Some(scope)) if self.0.atoms[atom].scope as usize == bracket => {
                What::Atom(atom, scope, &self.0.laws[atom])
            }
            (Kind::Scope { .. }, Some(scope)) => What::Scope(scope),
        }
    }

    /// What ends a bracket by itself; a loop has nothing that does.
    pub(super) fn until(self, bracket: usize) -> Until {
        match self.what(bracket) {
            What::Atom(_, scope, law) => Until::of(&scope.interrupt, self.0.quark(law.quark).completes),
            What::Scope(scope) => Until::of(&scope.interrupt, false),
            What::Loop(_) => Until::Never,
        }
    }

    /// The labels of what ends with a bracket: `s1: `, or nothing.
    pub(super) fn labels(self, bracket: usize) -> String {
        let marks: &BTreeMap<u32, Vec<Mark>> = &self.0.marks;
        let marks = u32::try_from(bracket).ok().and_then(|number| marks.get(&number));
        marks.into_iter().flatten().rev().map(|mark| format!("{}: ", mark.label)).collect()
    }

    /// The quark text of an atom's law.
    pub(super) fn law(self, law: &LawMeaning) -> &'l str {
        &self.0.quark(law.quark).text
    }

    /// The number of an atom's state, as a trace has it in the first pass of every loop.
    pub(super) fn state(self, atom: usize) -> u64 {
        self.0.atoms[atom].state
    }

    /// Everything about a bracket, for who asks for it.
    pub(super) fn tooltip(self, bracket: usize) -> String {
        let labels = self.labels(bracket);
        let text = match self.what(bracket) {
            What::Atom(atom, _, law) => {
                let until = self.until(bracket).text();
                format!("{labels}atom {}: {}{}\nuntil {until}", self.state(atom), frame_text(law.frame), self.law(law))
            }
            What::Scope(scope) => {
                let name = if scope.name.is_empty() { "a scope without a name" } else { &scope.name };
                match self.until(bracket) {
                    Until::Never => format!("{labels}{name}\nends with its last element"),
                    until @ (Until::Fires(_) | Until::Done | Until::FiresOrDone(_) | Until::Removed(_)) => {
                        format!("{labels}{name}\nuntil {}", until.text())
                    }
                }
            }
            What::Loop(times) => format!("{labels}{}", passes(times)),
        };
        bounded(&text)
    }
}

/// `^3`, or `^inf`.
pub(super) fn exponent(times: Option<u64>) -> String {
    times.map_or_else(|| "^inf".into(), |times| format!("^{times}"))
}

/// `3 passes`, `1 pass`, `for ever`.
pub(super) fn passes(times: Option<u64>) -> String {
    match times {
        None => "for ever".into(),
        Some(1) => "1 pass".into(),
        Some(times) => format!("{times} passes"),
    }
}

/// A text without what makes it longer than anybody reads.
pub(super) fn bounded(text: &str) -> String {
    match text.char_indices().nth(TOOLTIP) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}… and {} more characters", &text[..end], text[end..].chars().count()),
    }
}
